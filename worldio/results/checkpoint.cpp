#include "worldio/results/checkpoint.hpp"

#include "base/hash.hpp"
#include "engine/observing/displacement.hpp"
#include "engine/spec/names.hpp"
#include "engine/spec/ticks.hpp"
#include "worldio/json/spec_json.hpp"
#include "worldio/results/hdf5_metadata.hpp"
#include "worldio/results/sealed_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <numeric>

namespace troupe::worldio {
namespace fs = std::filesystem;
namespace {

using engine::Element;
using engine::StateField;
using engine::StateTable;

constexpr std::string_view k_id = "bodies";  // the dataset with the ids of the rows; no field has this name

/// Returns the rows of a table, sorted by the ids of their bodies, so that the file does not depend on the
/// order of the rows in memory.
std::vector<std::size_t> rows_by_id(const StateTable& table) {
  std::vector<std::size_t> rows(table.rows());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  std::ranges::sort(rows, {}, [&table](std::size_t row) { return table.ids()[row]; });
  return rows;
}

std::vector<std::uint32_t> ids_of(const StateTable& table, std::span<const std::size_t> rows) {
  std::vector<std::uint32_t> ids;
  ids.reserve(rows.size());
  for (const std::size_t row : rows) ids.push_back(table.ids()[row].value);
  return ids;
}

/// Returns the group of each table, as steps of the path below /tables: the component "ranger/eye" is stored
/// in the group eye in the group ranger. If several types have a component of the same name, all but the
/// first get a number: "ranger/eye#2".
std::vector<std::vector<std::string>> places_of(std::span<const StateTable> tables) {
  std::vector<std::vector<std::string>> places;
  engine::UniqueNames unique("#");
  for (const StateTable& table : tables) {
    const std::string component = unique.add(table.component());
    const std::size_t slash = component.find('/');
    places.push_back({hdf5_name(component.substr(0, slash))});
    if (slash != component.npos) places.back().push_back(hdf5_name(component.substr(slash + 1)));
  }
  return places;
}

Hdf5Group group_for(const Hdf5Group& tables, const std::vector<std::string>& place) {
  Hdf5Group group = tables.group(place.front());
  return place.size() == 1 ? std::move(group) : group.group(place.back());
}

Hdf5Group make_group_for(Hdf5Group& tables, const std::vector<std::string>& place) {
  if (place.size() == 1) return tables.create_group(place.front());
  return (tables.has(place.front()) ? tables.group(place.front()) : tables.create_group(place.front()))
      .create_group(place.back());
}

void write_meta(Hdf5File& file, engine::World& world, const FileHeader& header) {
  Hdf5Group meta = file.create_group("meta");
  // If a key is repeated, the last value is stored.
  std::map<std::string, std::string> last;
  for (const auto& [key, value] : header) last[key] = value;
  for (const auto& [key, value] : last) meta.set_text(key, value);
  const engine::World::Counters counters = world.counters();
  meta.set_integer("layout", k_checkpoint_layout);
  meta.set_integer("tick", static_cast<std::int64_t>(world.tick()));
  meta.set_number("time_s", world.view().time_s());
  meta.set_text("state_hash", hex(world.hashes().state));
  meta.set_integer("beams", static_cast<std::int64_t>(counters.beams));
  meta.set_integer("conflict_rounds", static_cast<std::int64_t>(counters.conflict_rounds));
  // Left out if 0, so that the bytes of most files are those of former versions.
  if (counters.settings > 0) meta.set_integer("settings", static_cast<std::int64_t>(counters.settings));
  meta.set_integer("stalled", static_cast<std::int64_t>(world.view().counts().stalled));
  meta.set_integer("held_at_bounds", static_cast<std::int64_t>(world.view().counts().out_of_bounds));
  meta.set_number("mean_displacement_m", engine::mean_displacement(world));
}

/// A dataset with a column of BodyColumns.
struct NamedColumn {
  const char* name;
  std::vector<std::uint32_t> BodyColumns::*column;
};
constexpr std::array k_body_columns{
    NamedColumn{"word", &BodyColumns::word}, NamedColumn{"number", &BodyColumns::number},
    NamedColumn{"type", &BodyColumns::type}, NamedColumn{"file", &BodyColumns::file},
    NamedColumn{"line", &BodyColumns::line}};
constexpr std::array k_alias_columns{NamedColumn{"word", &BodyColumns::alias_word},
                                     NamedColumn{"number", &BodyColumns::alias_number},
                                     NamedColumn{"body", &BodyColumns::alias_body}};

void write_spec(Hdf5File& file, const StoredSpec& spec) {
  file.write_text("world", spec.json);
  const BodyColumns& c = spec.bodies;
  const auto write = [&c](Hdf5Group& group, std::span<const NamedColumn> columns) {
    for (const auto& [name, column] : columns) group.write(name, std::span(c.*column));
  };
  Hdf5Group bodies = file.create_group("bodies");
  write(bodies, k_body_columns);
  bodies.create_dataset("pose", Element::f64, {c.type.size(), 4}).write(std::span(c.pose));
  bodies.create_dataset("color", Element::f32, {c.type.size(), 4}).write(std::span(c.color));
  if (!c.fiducial.empty())
    bodies.create_dataset("fiducial", Element::i32, {c.type.size()}).write(std::span(c.fiducial));
  Hdf5Group aliases = file.create_group("aliases");
  write(aliases, k_alias_columns);
}

BodyColumns read_columns(const Hdf5File& file) {
  BodyColumns c;
  const auto read = [&c](const Hdf5Group& group, std::span<const NamedColumn> columns) {
    for (const auto& [name, column] : columns) c.*column = group.dataset(name).read<std::uint32_t>();
  };
  const Hdf5Group bodies = file.group("bodies");
  read(bodies, k_body_columns);
  c.pose = bodies.dataset("pose").read<double>();
  c.color = bodies.dataset("color").read<float>();
  if (bodies.has("fiducial")) c.fiducial = bodies.dataset("fiducial").read<std::int32_t>();
  read(file.group("aliases"), k_alias_columns);
  return c;
}

void write_table(Hdf5Group group, const StateTable& table) {
  group.set_text("component", table.component());
  const std::vector<std::size_t> rows = rows_by_id(table);
  const std::vector<std::uint32_t> ids = ids_of(table, rows);
  group.write(std::string(k_id), std::span(ids));
  for (std::size_t f = 0; f < table.fields().size(); ++f) {
    const StateField& field = table.fields()[f];
    const std::size_t width = field.bytes();
    std::vector<std::byte> values(rows.size() * width);
    for (std::size_t i = 0; i < rows.size() && width > 0; ++i)
      std::memcpy(values.data() + i * width, table.cell<std::byte>(rows[i], f).data(), width);
    Hdf5Dataset dataset =
        group.create_dataset(hdf5_name(field.name), field.element, {rows.size(), field.columns});
    dataset.set_text("unit", field.unit);
    dataset.set_text("text", field.text);
    dataset.write_bytes(values);
  }
}

void read_table(const Hdf5Group& group, StateTable& table) {
  const std::vector<std::size_t> rows = rows_by_id(table);
  if (group.dataset(std::string(k_id)).read<std::uint32_t>() != ids_of(table, rows))
    group.fail("does not list the same bodies as the world in this file: the file is damaged");
  const std::vector<std::string> names = group.names();
  std::vector<std::string> unknown = names;
  std::erase(unknown, std::string(k_id));
  for (std::size_t f = 0; f < table.fields().size(); ++f) {
    const StateField& field = table.fields()[f];
    // An older checkpoint may lack a sparse field that was added to Troupe later. The field is then zero.
    const bool is_there = std::ranges::find(names, hdf5_name(field.name)) != names.end();
    if (!is_there && field.sparse) continue;
    std::erase(unknown, hdf5_name(field.name));
    const Hdf5Dataset dataset = group.dataset(hdf5_name(field.name));
    if (dataset.row_values() != field.columns || dataset.element() != field.element)
      dataset.fail(fmt::format(
          "has {} values of type {} per body, but this run needs {} values of type {}: remove the --set that "
          "causes the difference (for example by changing the number of beams), or resume with the version "
          "of Troupe and the plug-ins that saved the checkpoint",
          dataset.row_values(), engine::element_name(dataset.element()), field.columns,
          engine::element_name(field.element)));
    if (dataset.extent() != std::vector<std::size_t>{rows.size(), field.columns})
      dataset.fail(
          fmt::format("does not have one row for each of the {} bodies: the file is damaged", rows.size()));
    const std::size_t width = field.bytes();
    if (width == 0) continue;
    std::vector<std::byte> values(dataset.values() * engine::element_size(field.element));
    dataset.read_bytes(0, values);
    for (std::size_t i = 0; i < rows.size(); ++i)
      std::memcpy(table.cell<std::byte>(rows[i], f).data(), values.data() + i * width, width);
  }
  if (!unknown.empty())
    group.fail(fmt::format(
        "has the field \"{}\", which this run does not have: resume with the version of Troupe and the "
        "plug-ins that saved the checkpoint",
        unknown.front()));
}

std::uint64_t hash_of(const std::string& text) {
  std::uint64_t hash = 0;
  std::from_chars(text.data(), text.data() + text.size(), hash, 16);
  return hash;
}

/// Turns errors of HDF5 into InputError: a file that cannot be read is bad input.
template <class Work>
auto reading(Work&& work) {
  try {
    return work();
  } catch (const Hdf5Error& error) {
    throw InputError(error.what());
  }
}

std::vector<std::byte> bytes_of(const fs::path& name, engine::World& world, const StoredSpec& spec,
                                const FileHeader& header, const Memories& memories) {
  Hdf5File file = Hdf5File::create_in_memory(name, k_seal_bytes);
  write_meta(file, world, header);
  write_spec(file, spec);
  Hdf5Group tables = file.create_group("tables");
  const auto places = places_of(world.tables());
  for (std::size_t t = 0; t < places.size(); ++t)
    write_table(make_group_for(tables, places[t]), world.tables()[t]);
  std::vector<std::uint32_t> subscribed;
  for (const BodyId body : world.view().subscribed()) subscribed.push_back(body.value);
  file.group("bodies").write("subscribed", std::span<const std::uint32_t>(subscribed));
  Hdf5Group group = file.create_group("memories");
  for (const auto& [key, memory] : memories) {
    Hdf5Dataset dataset = group.create_dataset(hdf5_name(key), Element::u8, {memory.size()});
    dataset.set_text("name", key);
    dataset.write_bytes(memory);
  }
  return file.image();
}

}  // namespace

void write_checkpoint(const fs::path& file, engine::World& world, const engine::Registry& registry,
                      const FileHeader& header, const Memories& memories) {
  const StoredSpec spec = [&] {
    try {
      return store_spec(world.spec(), registry);
    } catch (const std::runtime_error& error) {
      throw std::runtime_error(fmt::format("{}: error: cannot be written: {}", file.string(), error.what()));
    }
  }();
  // The file is built in memory: HDF5 does not always survive a full disk, but the state must survive it.
  write_sealed(file, k_checkpoint_kind, k_checkpoint_layout, bytes_of(file, world, spec, header, memories));
}

Checkpoint::Checkpoint(const fs::path& file)
    : file_(file), hdf5_(reading([&file] {
        // Before HDF5 reads any byte of the file. The seal tells accidents; it can be recomputed.
        check_seal(file, k_checkpoint_kind, k_checkpoint_layout);
        if (const auto blocks = check_metadata(file, k_seal_bytes); !blocks)
          throw InputError(fmt::format("{}: error: {}", file.string(), blocks.error().text));
        return Hdf5File::open(file);
      })) {
  reading([this] {
    const Hdf5Group meta = hdf5_.group("meta");
    constexpr std::array<std::string_view, 9> k_numbers{"layout",
                                                        "tick",
                                                        "time_s",
                                                        "beams",
                                                        "conflict_rounds",
                                                        "settings",
                                                        "stalled",
                                                        "held_at_bounds",
                                                        "mean_displacement_m"};
    for (const std::string& key : meta.attributes()) {
      if (key == "settings") counters_.settings = static_cast<std::uint64_t>(meta.integer(key));
      if (std::ranges::find(k_numbers, key) == k_numbers.end()) header_[key] = meta.text(key);
    }
    tick_ = static_cast<std::uint64_t>(meta.integer("tick"));  // a negative number becomes very large
    if (tick_ > engine::k_most_ticks)
      meta.fail(fmt::format(
          "has the attribute \"tick\" {}, but must have a number from 0 to {}: the file is damaged",
          meta.integer("tick"), engine::k_most_ticks));
    time_s_ = meta.number("time_s");
    counters_.beams = static_cast<std::uint64_t>(meta.integer("beams"));
    counters_.conflict_rounds = static_cast<std::uint64_t>(meta.integer("conflict_rounds"));
    state_hash_ = hash_of(meta.text("state_hash"));
  });
}

std::string Checkpoint::header(const std::string& key) const {
  const auto found = header_.find(key);
  return found == header_.end() ? "" : found->second;
}

engine::WorldSpec Checkpoint::spec(const engine::Registry& registry,
                                   std::span<const std::pair<std::string, std::string>> changes,
                                   Diagnostics& diagnostics, std::vector<ParameterChange>& parameters) const {
  const StoredSpec stored = reading([this] {
    return StoredSpec{hdf5_.read_text("world"), read_columns(hdf5_)};
  });
  return restore_spec(stored, registry, changes, {diagnostics.files()->add(file_.string()), 0}, diagnostics,
                      parameters);
}

Memories Checkpoint::memories() const {
  return reading([this] {
    Memories memories;
    if (!hdf5_.has_group("memories")) return memories;
    const Hdf5Group group = hdf5_.group("memories");
    for (const std::string& name : group.names()) {
      const Hdf5Dataset dataset = group.dataset(name);
      if (dataset.element() != Element::u8)
        dataset.fail(fmt::format("holds values of type {}, but must hold bytes: the file is damaged",
                                 engine::element_name(dataset.element())));
      std::vector<std::byte>& memory = memories[dataset.text("name")];
      memory.resize(dataset.values());
      dataset.read_bytes(0, memory);
    }
    return memories;
  });
}

void Checkpoint::restore(engine::World& world) const {
  reading([&] {
    for (const std::uint32_t id : hdf5_.group("bodies").dataset("subscribed").read<std::uint32_t>()) {
      if (id >= world.spec().bodies.size() || world.view().location(BodyId(id)) == engine::RowLocation::none)
        throw InputError(fmt::format(
            "{}: error: /bodies/subscribed contains the body {}, which does not exist or is static, so that "
            "it has no sensor: the file is damaged",
            file_.string(), id));
      world.subscribe(BodyId(id));
    }
    const auto fill = [this](std::span<StateTable> tables) { restore_tables(tables); };
    if (!world.restore(tick_, counters_, state_hash_, fill))
      throw InputError(fmt::format(
          "{}: error: the restored state does not have the hash {} that was saved with it: the file "
          "is damaged, or another version of Troupe or of a plug-in wrote the file",
          file_.string(), hex(state_hash_)));
  });
}

void Checkpoint::restore_tables(std::span<StateTable> tables) const {
  const Hdf5Group groups = hdf5_.group("tables");
  const auto places = places_of(tables);
  for (std::size_t t = 0; t < tables.size(); ++t) read_table(group_for(groups, places[t]), tables[t]);
}

bool is_checkpoint(const fs::path& file) { return has_seal(file, k_checkpoint_kind); }

}  // namespace troupe::worldio
