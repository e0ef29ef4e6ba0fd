#include "tests/fuzz/targets.hpp"

#include "base/hash.hpp"
#include "engine/world/world.hpp"
#include "tests/fuzz/hdf5_text.hpp"
#include "tests/support/paths.hpp"
#include "troupe/registry.hpp"
#include "troupe/simulation.hpp"
#include "worldio/images/bitmap.hpp"
#include "worldio/images/ros_map.hpp"
#include "worldio/json/json_world.hpp"
#include "worldio/json/study.hpp"
#include "worldio/load.hpp"
#include "worldio/results/checkpoint.hpp"
#include "worldio/results/hdf5_file.hpp"
#include "worldio/results/hdf5_metadata.hpp"
#include "worldio/results/little_endian.hpp"
#include "worldio/results/recording_reader.hpp"
#include "worldio/results/recording_repair.hpp"
#include "worldio/results/replay_data.hpp"
#include "worldio/results/sealed_file.hpp"

#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace troupe::fuzz {
namespace {

// The folder of the files that worlds may include, and of the images that they may use. Worlds are read as if
// they were files in this folder.
const std::filesystem::path k_folder = test::source_dir() / "tests/fuzz/files";

constexpr int k_ticks = 5;
constexpr double k_most_bodies = 200;

const engine::Registry& registry() {
  static const engine::Registry all = make_registry();
  return all;
}

/// Aborts the process, which libFuzzer reports as a crash, unless `ok` is true.
void check(bool ok) {
  if (!ok) std::abort();
}

/// The number of rays that a device casts in a tick, estimated from its parameters: the beams of rangers, the
/// image columns of blob finders, the pixels of cameras.
double rays_of(const engine::FieldTable& table, const engine::Record& params) {
  double rays = 0;
  double pixels = 1;
  for (std::size_t f = 0; f < table.fields.size() && f < params.size(); ++f) {
    const engine::Field& field = table.fields[f];
    if (!params[f].given()) continue;
    if (field.type == engine::FieldType::records && field.record)
      for (const engine::Record& record : params[f].records()) rays += rays_of(*field.record, record);
    if (field.type != engine::FieldType::integer) continue;
    const auto count = static_cast<double>(params[f].integer());
    if (field.name == "samples" || field.name == "image_width") rays += count;
    if (field.name == "width" || field.name == "height") pixels *= count;
  }
  return rays + pixels;
}

/// Whether a world is small enough to be run. A large world takes long; that would not be an error of Troupe.
bool is_small(const engine::WorldSpec& spec) {
  std::size_t vertices = 0;
  double readings = 0;
  for (const engine::BodySpec& body : spec.bodies) {
    const engine::TypeSpec& type = spec.types[body.type.index()];
    for (const engine::PartSpec& part : type.parts)
      for (const Solid& solid : part.solids)
        for (const Ring& ring : solid.contours) vertices += ring.size();
    for (const engine::DeviceSpec& device : type.devices)
      if (const engine::DeviceKind* kind = registry().device(device.kind))
        readings += rays_of(kind->params, device.params);
    if (vertices > 5000 || readings > 5000) return false;
  }
  return static_cast<double>(spec.bodies.size()) <= k_most_bodies;
}

/// Checks that a world that was read can be written as JSON, or that the writer reports an error. The writer
/// itself checks that its output can be read again.
void write(const engine::WorldSpec& spec, const Diagnostics& diagnostics) {
  if (!is_small(spec)) return;
  Diagnostics found(diagnostics.files());
  const auto document = worldio::write_json_world(spec, k_folder / "written.json", registry(), found);
  check(document.has_value() != found.has_errors());
}

/// Whether an InputError or StepError reports that a kind, such as a sensor or a controller, threw another
/// exception. Troupe's own kinds must not do this.
bool tells_of_a_throw(const std::exception& error) {
  const std::string_view text = error.what();
  return text.find(" threw: ") != text.npos || text.find(" threw an exception") != text.npos;
}

/// Makes several ticks, because a command moves a body only in the tick after it was given, and interventions
/// happen still later.
void make_ticks(engine::World& world) {
  for (int tick = 0; tick < k_ticks; ++tick) world.step();
  world.hashes();
}

void run(engine::WorldSpec spec, Diagnostics& diagnostics) {
  if (!is_small(spec)) return;
  spec.ranging = engine::RangingEngine::exact;  // the grid may take 2 GiB, by design
  try {
    const std::size_t bodies = spec.bodies.size();
    engine::World world(std::move(spec), registry(), {.threads = 1, .tile_size_m = 0}, diagnostics);
    for (std::uint32_t body = 0; body < bodies; ++body)
      if (world.view().row(BodyId(body)).valid()) world.subscribe(BodyId(body));
    make_ticks(world);
  } catch (const InputError& error) {
    check(!tells_of_a_throw(error));
  } catch (const engine::StepError& error) {
    check(!tells_of_a_throw(error));
  }
}

template <class Load>
void read(Load load) {
  for (const bool thorough : {false, true}) {
    Diagnostics diagnostics(thorough);
    worldio::LoadOptions options;
    options.threads = 1;
    options.most_bodies = k_most_bodies;
    try {
      engine::WorldSpec spec = load(options, diagnostics);
      if (diagnostics.has_errors()) continue;
      check(!spec.bodies.empty());
      if (thorough) continue;
      write(spec, diagnostics);
      run(std::move(spec), diagnostics);
    } catch (const InputError&) {
      check(diagnostics.has_errors());
    }
  }
}

void decode(std::string_view bytes) {
  Diagnostics diagnostics;
  const auto bitmap = worldio::decode_bitmap(bytes, "image", {}, diagnostics, 1e5);
  check(bitmap.has_value() != diagnostics.has_errors());
  if (!bitmap) return;
  std::vector<Solid> solids{{worldio::bitmap_contours(*bitmap), {0, 1}}};
  worldio::normalise(solids, {4, 4, 1});
  std::size_t vertices = 0;
  for (const Ring& ring : solids[0].contours) vertices += ring.size();
  if (vertices <= 1000) convex_pieces(solids[0]);  // a robot of this shape
}

/// A PNG whose checksums fit again after a mutation: nothing behind them would be tried otherwise.
std::string with_right_checksums(std::string_view bytes) {
  std::string png(bytes);
  if (!png.starts_with("\x89PNG\r\n\x1a\n")) return png;
  const auto byte = [&](std::size_t at) { return std::size_t{static_cast<unsigned char>(png[at])}; };
  for (std::size_t at = 8; at + 12 <= png.size();) {
    const std::size_t length = byte(at) << 24 | byte(at + 1) << 16 | byte(at + 2) << 8 | byte(at + 3);
    if (length > png.size() - at - 12) break;
    const auto sum =
        crc32(0, reinterpret_cast<const Bytef*>(png.data() + at + 4), static_cast<uInt>(length + 4));
    for (std::size_t i = 0; i < 4; ++i) png[at + 8 + length + i] = static_cast<char>(sum >> (24 - 8 * i));
    at += 12 + length;
  }
  return png;
}

/// The name of a file of this process in the folder for temporary files.
std::filesystem::path temporary_file(const std::string& name) {
  return std::filesystem::temp_directory_path() / ("troupe-fuzz-" + std::to_string(getpid()) + "." + name);
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Reads a checkpoint whose content is `bytes`, which begin with a user block of k_seal_bytes. Computes its
/// seal. Returns whether the checkpoint was restored.
bool read_checkpoint_bytes(std::string_view bytes) {
  const std::filesystem::path file = temporary_file("checkpoint.h5");
  const std::string_view rest = bytes.substr(worldio::k_seal_bytes);
  std::string head = fmt::format("troupe {}\nlayout {}\nbytes {}\nxxh3 {}\n", worldio::k_checkpoint_kind,
                                 worldio::k_checkpoint_layout, rest.size(), hex(hash_text(rest)));
  head.resize(worldio::k_seal_bytes - 1, ' ');
  // Not by write_sealed(), which waits for the disk.
  std::ofstream(file, std::ios::binary) << head << '\n' << rest;
  bool is_restored = false;
  try {
    const worldio::Checkpoint checkpoint(file);
    static_cast<void>(checkpoint.memories());
    Diagnostics diagnostics;
    std::vector<worldio::ParameterChange> none;
    engine::WorldSpec spec = checkpoint.spec(registry(), {}, diagnostics, none);
    if (!diagnostics.has_errors() && is_small(spec)) {
      spec.ranging = engine::RangingEngine::exact;
      engine::World world(std::move(spec), registry(), {.threads = 1, .tile_size_m = 0}, diagnostics);
      checkpoint.restore(world);
      is_restored = true;
      make_ticks(world);
    }
  } catch (const InputError& error) {
    check(!tells_of_a_throw(error));
  } catch (const engine::StepError& error) {
    check(!tells_of_a_throw(error));
  }
  std::filesystem::remove(file);
  return is_restored;
}

/// A checkpoint of a small world, and its blocks of metadata.
struct SavedCheckpoint {
  std::string bytes;
  std::vector<worldio::FileBlock> metadata;
};

const SavedCheckpoint& saved_checkpoint() {
  static const SavedCheckpoint saved = [] {
    const std::filesystem::path file = temporary_file("saved.h5");
    Simulation simulation(k_folder / "study_room.json", {.threads = 1});
    for (int tick = 0; tick < k_ticks; ++tick) simulation.step();
    simulation.save(file);
    const auto blocks = worldio::check_metadata(file, worldio::k_seal_bytes);
    check(static_cast<bool>(blocks));
    SavedCheckpoint read{bytes_of(file), *blocks};
    std::filesystem::remove(file);
    return read;
  }();
  return saved;
}

/// A change of a number of 1, 2, 4 or 8 bytes in a block of metadata.
struct Edit {
  std::uint64_t block;
  std::uint64_t at;  ///< in the block: the byte of this index if even, else the byte that is not 0
  std::uint64_t width;
  std::uint64_t change;
  std::uint64_t by;
};

void edit(std::string& bytes, const std::vector<worldio::FileBlock>& metadata, const Edit& edit) {
  const worldio::FileBlock& block = metadata[edit.block % metadata.size()];
  const std::span<std::uint8_t> all(reinterpret_cast<std::uint8_t*>(bytes.data()), bytes.size());
  const std::span<std::uint8_t> own = all.subspan(block.at, block.bytes);
  std::vector<std::size_t> used;
  for (std::size_t i = 0; i < own.size(); ++i)
    if (edit.at % 2 == 0 || own[i] != 0) used.push_back(i);
  const std::size_t at = used.empty() ? 0 : used[edit.at / 2 % used.size()];
  const std::span<std::uint8_t> field =
      own.subspan(at, std::min<std::size_t>(std::size_t{1} << edit.width % 4, own.size() - at));
  const worldio::FileBlock& other = metadata[edit.by % metadata.size()];
  const std::uint64_t value = worldio::little_endian(field);
  switch (edit.change % 8) {
    case 0: worldio::put_little_endian(edit.by, field); break;
    case 1: worldio::put_little_endian(std::numeric_limits<std::uint64_t>::max(), field); break;
    case 2: worldio::put_little_endian(value + edit.by % 64 - 32, field); break;
    case 3: worldio::put_little_endian(other.at - worldio::k_seal_bytes, field); break;
    case 4: worldio::put_little_endian(value ^ std::uint64_t{1} << edit.by % 64, field); break;
    case 5: worldio::put_little_endian(std::uint64_t{1} << edit.by % 64, field); break;
    case 6: worldio::put_little_endian(0, field); break;
    default:  // the bytes at this place of another block
      std::copy_n(all.begin() + static_cast<std::ptrdiff_t>(other.at),
                  std::min<std::size_t>(other.bytes, own.size()), own.begin());
  }
}

}  // namespace

void read_stage(std::string_view text) {
  read([text](const worldio::LoadOptions& options, Diagnostics& diagnostics) {
    return worldio::load_stage_world(k_folder / "fuzz.world", std::string(text), registry(), options,
                                     diagnostics);
  });
}

void read_json(std::string_view text) {
  read([text](const worldio::LoadOptions& options, Diagnostics& diagnostics) {
    return worldio::load_json_world(k_folder / "fuzz.json", std::string(text), registry(), options,
                                    diagnostics);
  });
}

void read_bitmap(std::string_view bytes) {
  decode(bytes);
  if (const std::string repaired = with_right_checksums(bytes); repaired != bytes) decode(repaired);
}

void read_map(std::string_view text) {
  Diagnostics diagnostics;
  std::optional<worldio::RosMap> map;
  try {
    map = worldio::parse_ros_map("map.yaml", text, diagnostics);
  } catch (const InputError&) {  // too many errors
    return;
  }
  check(map.has_value() != diagnostics.has_errors());
  if (!map) return;
  check(map->resolution_m > 0 && map->free_thresh <= map->occupied_thresh);
  for (const bool unknown_is_solid : {false, true}) {
    const worldio::PixelRule is_solid = worldio::solid_cells(*map, unknown_is_solid);
    const std::array<std::uint8_t, 4> pixel{0, 100, 205, 254};
    for (std::size_t channels = 1; channels <= pixel.size(); ++channels)
      static_cast<void>(is_solid(std::span(pixel).first(channels)));
  }
}

void read_recording(std::string_view text) {
  const std::filesystem::path file = temporary_file("h5");
  if (!worldio::has_hdf5() || !make_hdf5(text, file, Hdf5Format::recording)) return;
  try {
    const worldio::RecordingReader recording(file);
    static_cast<void>(recording.world_json());
    for (const worldio::RecordingReader::Array& array : recording.arrays()) {
      std::vector<std::byte> frame(array.bodies.size() * array.row_bytes());
      for (std::size_t f = 0; f < std::min<std::size_t>(recording.frames(), 4); ++f)
        recording.read(array, f, frame);
    }
    check(recording.frames() == recording.ticks().size());
    try {
      check(worldio::replay_data(recording, {.most_bytes = 1000000, .fields = {}}).bytes.size() <= 1000000);
    } catch (const InputError& error) {
      check(std::string_view(error.what()).starts_with(file.string() + ": error: "));
    }
    check(worldio::repair_recording(file).frames == recording.frames());
    const worldio::Hdf5File repaired = worldio::Hdf5File::open(file);
    check(repaired.unused_bytes() <= std::filesystem::file_size(file));
    worldio::Hdf5File::create_in_memory(file).copy_content(repaired);
  } catch (const worldio::Hdf5Error& error) {
    check(std::string_view(error.what()).starts_with(file.string() + ": error: "));
  }
  std::filesystem::remove(file);
}

void read_checkpoint(std::string_view text) {
  const std::filesystem::path content = temporary_file("content.h5");
  if (!worldio::has_hdf5() || !make_hdf5(text, content, Hdf5Format::checkpoint)) return;
  read_checkpoint_bytes(bytes_of(content));
  std::filesystem::remove(content);
}

void read_sealed(std::string_view edits) {
  if (!worldio::has_hdf5()) return;
  const SavedCheckpoint& saved = saved_checkpoint();
  std::string bytes = saved.bytes;
  constexpr std::size_t k_edit_bytes = 10;
  constexpr std::size_t k_most_edits = 8;
  for (std::size_t e = 0; e < k_most_edits && edits.size() >= k_edit_bytes; ++e) {
    const auto number = [&edits](std::size_t at, std::size_t size) {
      return worldio::little_endian(
          std::span(reinterpret_cast<const std::uint8_t*>(edits.data()) + at, size));
    };
    edit(bytes, saved.metadata, {number(0, 2), number(2, 2), number(4, 1), number(5, 1), number(6, 4)});
    edits.remove_prefix(k_edit_bytes);
  }
  const bool is_restored = read_checkpoint_bytes(bytes);
  check(is_restored || bytes != saved.bytes);
}

void read_study(std::string_view text) {
  Diagnostics diagnostics;
  worldio::Study study;
  try {
    study = worldio::load_study_text(k_folder / "study.json", text, registry(), diagnostics);
  } catch (const InputError&) {
    check(diagnostics.has_errors());
  }
  if (diagnostics.has_errors()) return;
  const std::size_t runs = study.run_count();
  check(runs >= 1 && runs <= worldio::k_most_runs);
  for (const std::size_t index : {std::size_t{0}, runs / 2, runs - 1}) {
    worldio::LoadOptions options;
    options.threads = 1;
    options.most_bodies = k_most_bodies;
    options.set = study.settings(study.run(index));
    check(options.set.size() == study.parameters.size());
    if (study.world != k_folder / "study_room.json") continue;
    Diagnostics found;
    try {
      engine::WorldSpec spec = worldio::load_world(study.world, registry(), options, found);
      if (!found.has_errors()) run(std::move(spec), found);
    } catch (const InputError&) {
      check(found.has_errors());
    }
  }
}

}  // namespace troupe::fuzz
