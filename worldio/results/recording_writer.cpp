#include "worldio/results/recording_writer.hpp"

#include "worldio/json/spec_json.hpp"
#include "worldio/results/hdf5_superblock.hpp"
#include "worldio/results/recording_repair.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

namespace troupe::worldio {
namespace {

using engine::Element;
using engine::World;

// The size of a batch. A batch is so large that the calls of HDF5 take little time compared with copying the
// bytes, and so small that it stays in the caches of the CPU. A chunk of an array holds the array's frames of
// one batch. If a batch has only one frame, a chunk has at most k_chunk_bytes.
constexpr std::size_t k_batch_bytes = std::size_t{2} << 20;
constexpr std::size_t k_chunk_bytes = std::size_t{1} << 20;
constexpr std::size_t k_most_batch_frames = 256;
constexpr std::size_t k_frame_chunk = 1024;  // rows per chunk of an array in /frames

/// The number of arrays of the state after which the whole file is flushed. A flush of one array goes through
/// the changed metadata of all arrays, and a flush of the file does so more than once. Flushing each array,
/// or the file only after all arrays, would therefore take a time proportional to the square of their number.
constexpr std::size_t k_flushed_arrays = 1000;

std::size_t bytes_of(const std::vector<RecordedComponent>& components, std::size_t rows) {
  std::size_t bytes = rows;  // bytes of /state/alive in a frame
  for (const RecordedComponent& component : components)
    for (std::size_t f = 0; f < component.fields.size(); ++f) bytes += component.bytes(f);
  return bytes;
}

std::size_t batch_frames(std::size_t frame_bytes) {
  return std::clamp(k_batch_bytes / std::max<std::size_t>(frame_bytes, 1), std::size_t{1},
                    k_most_batch_frames);
}

/// Returns the size of the HDF5 chunks of an array of the state. `frames` is the number of frames in a batch,
/// and `row` the extent of the array in one frame. A chunk holds the frames of a batch or, if a batch has
/// only one frame, a part of this frame.
Hdf5Chunks chunks(std::size_t frames, const std::vector<std::size_t>& row, std::size_t element_bytes) {
  Hdf5Chunks chunks{.extent = {frames}};
  std::size_t inner = element_bytes;
  for (std::size_t d = 1; d < row.size(); ++d) inner *= std::max<std::size_t>(row[d], 1);
  for (std::size_t d = 0; d < row.size(); ++d) chunks.extent.push_back(std::max<std::size_t>(row[d], 1));
  if (frames == 1 && !row.empty())
    chunks.extent[1] = std::clamp<std::size_t>(k_chunk_bytes / inner, 1, chunks.extent[1]);
  return chunks;
}

/// Attribute of /frames: the tick of the world when the recording was created. Recordings of older versions
/// do not have it.
constexpr const char* k_first_tick = "first_tick";

/// Returns the group at a path below `root`. Creates the groups on the path that do not exist.
Hdf5Group group_at(Hdf5Group& root, std::span<const std::string> path) {
  Hdf5Group group = root.has_group(path[0]) ? root.group(path[0]) : root.create_group(path[0]);
  return path.size() == 1 ? std::move(group) : group_at(group, path.subspan(1));
}

/// Returns the group at a path below `root`, which must exist.
Hdf5Group existing_group_at(const Hdf5Group& root, std::span<const std::string> path) {
  Hdf5Group group = root.group(path[0]);
  return path.size() == 1 ? std::move(group) : existing_group_at(group, path.subspan(1));
}

void describe(Hdf5Dataset& dataset, std::string_view unit, std::string_view frame, std::string_view text) {
  dataset.set_text("unit", unit);
  dataset.set_text("frame", frame);
  dataset.set_text("text", text);
}

void write_scene(Hdf5File& file, const engine::WorldSpec& spec) {
  const BodyColumns columns = body_columns(spec);
  Hdf5Group scene = file.create_group("scene");
  scene.write("word", std::span<const std::uint32_t>(columns.word));
  scene.write("number", std::span<const std::uint32_t>(columns.number));
  scene.write("type", std::span<const std::uint32_t>(columns.type));
  scene.create_dataset("pose", Element::f64, {columns.type.size(), 4})
      .write(std::span<const double>(columns.pose));
  scene.create_dataset("color", Element::f32, {columns.type.size(), 4})
      .write(std::span<const float>(columns.color));
}

}  // namespace

RecordingWriter::RecordingWriter(const std::filesystem::path& file, const World& world,
                                 std::vector<RecordedComponent> components, const RecordingHead& head,
                                 bool in_background)
    : file_(Hdf5File::create(file)),
      bodies_(recorded_bodies(world)),
      components_(std::move(components)),
      every_ticks_(head.every_ticks),
      batch_frames_(batch_frames(bytes_of(components_, bodies_.size()))) {
  open_ = true;
  try {
    guarded([&] {
      write_head(world, head);
      create_outputs(world.tick());
      start(in_background);
    });
  } catch (...) {
    std::error_code ignored;  // the first error is reported
    std::filesystem::remove(file, ignored);
    throw;
  }
}

RecordingWriter::RecordingWriter(Hdf5File file, const World& world)
    : file_(std::move(file)), bodies_(recorded_bodies(world)) {
  read_head(world);
  open_outputs();
}

RecordingWriter::RecordingWriter(const std::filesystem::path& file, const World& world, bool in_background)
    : RecordingWriter((repair_recording(file), Hdf5File::open_to_write(file)), world) {
  const std::size_t frames = find_next_tick(frame_outputs_[0].read<std::uint64_t>(), world.tick());
  for (Hdf5Dataset& output : frame_outputs_) output.resize(frames);
  for (Output& output : outputs_) output.dataset.resize(frames);
  if (has_much_unused_space(file_)) {
    outputs_.clear();
    frame_outputs_.clear();
    file_.close();
    remove_unused_space(file);
    file_ = Hdf5File::open_to_write(file);
    open_outputs();
  }
  open_ = true;
  guarded([&] { start(in_background); });
}

void RecordingWriter::check(const RecordingReader& recording, const World& world) {
  const std::filesystem::path& file = recording.file();
  RecordingWriter writer(recording.unfinished() ? Hdf5File::open_swmr(file) : Hdf5File::open(file), world);
  writer.find_next_tick(recording.ticks(), world.tick());
}

RecordingWriter::~RecordingWriter() {
  try {
    close();
  } catch (const Hdf5Error&) {
    // A destructor cannot report an error; close() does.
  }
}

/// Calls `work`, unless the file is closed or was given up. If `work` throws, gives up the file and rethrows.
template <class Work>
void RecordingWriter::guarded(Work&& work) {
  if (!open_) return;
  try {
    work();
  } catch (...) {
    give_up();
    throw;
  }
}

void RecordingWriter::give_up() noexcept {
  open_ = false;
  thread_.reset();  // waits for the thread, which may still be writing
  outputs_.clear();
  frame_outputs_.clear();
  file_.abandon();
  try {
    close_superblock(file_.file_name());
  } catch (const std::exception&) {
    // This second error is ignored, because the first one is reported. `troupe repair` can close the file
    // later.
  }
}

void RecordingWriter::write_head(const World& world, const RecordingHead& head) {
  Hdf5Group meta = file_.create_group("meta");
  meta.set_text("kind", "troupe recording");
  meta.set_integer("layout", k_recording_layout);
  meta.set_integer("record_every_ticks", static_cast<std::int64_t>(head.every_ticks));
  meta.set_text("record_fields", join_field_names(head.fields));
  for (const auto& [key, value] : head.meta) meta.set_text(key, value);
  file_.write_text("world", head.world_json);
  write_scene(file_, world.spec());

  Hdf5Group bodies = file_.create_group("bodies");
  const std::vector<std::string> type_names = recorded_type_names(world);
  std::vector<std::uint32_t> ids;
  std::vector<std::string> types;
  std::vector<std::string> names;
  for (const BodyId body : bodies_) {
    ids.push_back(body.value);
    types.push_back(type_names[world.spec().bodies[body.index()].type.index()]);
    names.push_back(world.spec().name(body));
  }
  bodies.write("id", std::span<const std::uint32_t>(ids));
  bodies.write_texts("type", types);
  bodies.write_texts("name", names);
}

/// Reads what a continued recording records. Throws if it is a recording of another world.
void RecordingWriter::read_head(const World& world) {
  const Hdf5Group meta = RecordingReader::checked_meta(file_);
  every_ticks_ = static_cast<std::uint64_t>(std::max<std::int64_t>(meta.integer("record_every_ticks"), 1));
  try {
    components_ = recorded_components(world, split_field_names(meta.text("record_fields")));
  } catch (const std::invalid_argument& error) {
    meta.fail(fmt::format("belongs to another world: {}; choose another file", error.what()));
  }
  batch_frames_ = batch_frames(bytes_of(components_, bodies_.size()));
  std::vector<std::uint32_t> ids;
  for (const BodyId body : bodies_) ids.push_back(body.value);
  if (file_.group("bodies").dataset("id").read<std::uint32_t>() != ids)
    file_.group("bodies").fail(
        "belongs to another world: its bodies are not those of this run; choose another file");
}

void RecordingWriter::create_outputs(std::uint64_t first_tick) {
  for (const RecordedComponent& component : components_) {
    Hdf5Group group = group_at(file_, component.path);
    for (std::size_t f = 0; f < component.fields.size(); ++f) {
      const engine::StateField& field = component.fields[f];
      const std::vector<std::size_t> row = {component.rows, field.columns};
      Hdf5Dataset dataset =
          group.create_extendible(hdf5_name(field.name), field.element, row,
                                  chunks(batch_frames_, row, engine::element_size(field.element)));
      describe(dataset, field.unit, frame_of(component, field), field.text);
      add_output(std::move(dataset), component.bytes(f), absent(field));
    }
    if (component.has.empty()) continue;
    std::vector<std::string> path = component.path;
    path.front() = "has";
    path.insert(path.begin(), "bodies");
    group_at(file_, std::span(path).first(path.size() - 1))
        .write(path.back(), std::span<const std::uint8_t>(component.has));
  }
  const std::vector<std::string> state{"state"};
  Hdf5Dataset alive = group_at(file_, state)
                          .create_extendible("alive", Element::u8, {bodies_.size()},
                                             chunks(batch_frames_, {bodies_.size()}, 1));
  describe(alive, "", "", "1: the body is in the world; 0: it is not yet born, or dead");
  add_output(std::move(alive), bodies_.size(), std::byte{1});

  Hdf5Group frames = file_.create_group("frames");
  frames.set_integer(k_first_tick, static_cast<std::int64_t>(first_tick));
  const auto add = [&](const char* name, Element element, const char* unit, const char* text) {
    Hdf5Chunks chunks{.extent = {k_frame_chunk}};
    if (element == Element::u64) chunks.fill = k_no_tick;
    frame_outputs_.push_back(frames.create_extendible(name, element, {}, chunks));
    describe(frame_outputs_.back(), unit, "", text);
  };
  add("tick", Element::u64, "",
      "tick of the world at which the frame was recorded; 2^64 - 1: the frame is incomplete");
  add("time_s", Element::f64, "s", "simulated time of the frame");
  add("hash", Element::u64, "", "hash of the whole state");
}

void RecordingWriter::open_outputs() {
  const auto open = [&](const Hdf5Group& group, const std::string& name, Element element,
                        std::vector<std::size_t> row) {
    Hdf5Dataset dataset = group.dataset(name);
    const std::vector<std::size_t>& extent = dataset.extent();
    if (dataset.element() != element ||
        !std::equal(extent.begin() + !extent.empty(), extent.end(), row.begin(), row.end()))
      dataset.fail(
          "belongs to another world: its rows differ in size or type from those of this run; choose another "
          "file");
    return dataset;
  };
  for (const RecordedComponent& component : components_) {
    const Hdf5Group group = existing_group_at(file_, component.path);
    for (std::size_t f = 0; f < component.fields.size(); ++f) {
      const engine::StateField& field = component.fields[f];
      add_output(open(group, hdf5_name(field.name), field.element, {component.rows, field.columns}),
                 component.bytes(f), absent(field));
    }
  }
  add_output(open(file_.group("state"), "alive", Element::u8, {bodies_.size()}), bodies_.size(),
             std::byte{1});
  const Hdf5Group frames = file_.group("frames");
  frame_outputs_.push_back(open(frames, "tick", Element::u64, {}));
  frame_outputs_.push_back(open(frames, "time_s", Element::f64, {}));
  frame_outputs_.push_back(open(frames, "hash", Element::u64, {}));
}

void RecordingWriter::add_output(Hdf5Dataset dataset, std::size_t frame_bytes, std::byte absent) {
  outputs_.push_back({std::move(dataset), frame_bytes, absent});
}

/// Sets next_tick_ for a recording with frames of these ticks that continues at the tick `tick`. Returns how
/// many of the frames remain; the later ones are recorded again. Throws Hdf5Error if frames would be missing.
std::size_t RecordingWriter::find_next_tick(std::span<const std::uint64_t> ticks, std::uint64_t tick) {
  const auto frames = static_cast<std::size_t>(std::ranges::upper_bound(ticks, tick) - ticks.begin());
  const Hdf5Group group = file_.group("frames");
  const std::int64_t first_tick = group.has_attribute(k_first_tick) ? group.integer(k_first_tick) : 0;
  next_tick_ = frames == 0 ? static_cast<std::uint64_t>(first_tick) : ticks[frames - 1] + 1;
  if (frames == 0 && next_tick_ > tick)
    frame_outputs_[0].fail(fmt::format(
        "begins at tick {}, after tick {}, at which the run continues: give --record a new file, or resume a "
        "checkpoint saved at or after the beginning of this recording",
        next_tick_, tick));
  // The next frame that is due after the last recorded one must not be before the tick of the world.
  const std::uint64_t due = (next_tick_ + every_ticks_ - 1) / every_ticks_ * every_ticks_;
  if (due < tick)
    frame_outputs_[0].fail(fmt::format(
        "ends before tick {}, but the run continues at tick {}, so frames would be missing: give --record a "
        "new file, or resume a checkpoint saved at or before the end of this recording",
        due, tick));
  return frames;
}

void RecordingWriter::start(bool in_background) {
  file_.flush();
  file_.start_swmr();
  for (const Output& output : outputs_)
    gathered_.state.emplace_back(output.frame_bytes * batch_frames_, output.absent);
  if (in_background) {
    written_ = gathered_;  // so that, in both batches, a byte that no frame overwrites has the value absent()
    written_.reserve(batch_frames_);
    try {
      thread_.emplace(1);
    } catch (const std::system_error& error) {
      throw Hdf5Error(
          fmt::format("{}: error: cannot be written: {}", file_.file_name().string(), error.what()));
    }
  }
  gathered_.reserve(batch_frames_);
}

void RecordingWriter::Batch::reserve(std::size_t frames) {
  ticks.reserve(frames);
  times_s.reserve(frames);
  hashes.reserve(frames);
}

bool RecordingWriter::due(std::uint64_t tick) const {
  return open_ && tick >= next_tick_ && tick % every_ticks_ == 0;
}

void RecordingWriter::record(const World& world, std::uint64_t state_hash) {
  guarded([&] {
    if (thread_) thread_->rethrow();
  });
  if (!open_) return;
  next_tick_ = world.tick() + 1;
  const auto frame_of = [&](std::size_t output) {
    const std::size_t bytes = outputs_[output].frame_bytes;
    return std::span(gathered_.state[output]).subspan(gathered_.ticks.size() * bytes, bytes);
  };
  std::size_t output = 0;
  std::vector<std::span<std::byte>> fields;
  for (const RecordedComponent& component : components_) {
    fields.clear();
    for (std::size_t f = 0; f < component.fields.size(); ++f) fields.push_back(frame_of(output++));
    gather(world, component, fields);
  }
  if (world.view().has_lives()) {
    const std::span<std::byte> alive = frame_of(output);
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      alive[b] = std::byte{world.view().is_there(world.view().row(bodies_[b]))};
  }
  gathered_.ticks.push_back(world.tick());
  gathered_.times_s.push_back(world.view().time_s());
  gathered_.hashes.push_back(state_hash);
  if (gathered_.ticks.size() == batch_frames_) start_flush();
}

void RecordingWriter::start_flush() {
  guarded([&] {
    if (!thread_) {
      write(gathered_);
      return;
    }
    thread_->finish();  // wait until the other batch is written and can be used again
    std::swap(gathered_, written_);
    thread_->add([this] { write(written_); });
  });
}

void RecordingWriter::flush() {
  start_flush();
  guarded([&] {
    if (thread_) thread_->finish();
  });
}

void RecordingWriter::close() {
  flush();
  guarded([&] {
    thread_.reset();
    outputs_.clear();
    frame_outputs_.clear();
    file_.flush();
    file_.close();
    open_ = false;
  });
}

void RecordingWriter::write(Batch& batch) {
  const std::size_t frames = batch.ticks.size();
  if (frames == 0) return;
  for (std::size_t o = 0; o < outputs_.size(); ++o) {
    Output& output = outputs_[o];
    if (output.frame_bytes == 0)
      output.dataset.resize(output.dataset.rows() + frames);
    else
      output.dataset.append_bytes(std::span(batch.state[o]).first(frames * output.frame_bytes));
    if ((o + 1) % k_flushed_arrays == 0) file_.flush();
  }
  file_.flush();
  frame_outputs_[1].append(std::span<const double>(batch.times_s));
  frame_outputs_[1].flush();
  frame_outputs_[2].append(std::span<const std::uint64_t>(batch.hashes));
  frame_outputs_[2].flush();
  frame_outputs_[0].append(std::span<const std::uint64_t>(batch.ticks));
  frame_outputs_[0].flush();
  batch.ticks.clear();
  batch.times_s.clear();
  batch.hashes.clear();
}

}  // namespace troupe::worldio
