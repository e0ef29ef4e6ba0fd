#include "worldio/results/recording_reader.hpp"

#include "base/split.hpp"
#include "worldio/files.hpp"
#include "worldio/results/hdf5_superblock.hpp"
#include "worldio/results/recording_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::worldio {
namespace {

/// Returns the position of an array in the order in which a tick computes the arrays. Arrays are sorted by
/// this position, so that a comparison of two recordings finds the earliest difference first.
int phase_order(const RecordingReader::Array& array) {
  const std::string& component = array.component;
  if (component.starts_with("sensors/")) return 0;
  if (component == "pose") return 3;
  return component == "velocity" || component == "command" || component == "stall" ? 2 : 1;
}

bool is_unfinished(const std::filesystem::path& file) {
  const std::optional<Hdf5Superblock> head = read_superblock(file);
  return head && head->writing();
}

/// Opens a recording. A file that is not in HDF5 gets an error that says so in plain words, because the text
/// of the HDF5 library does not.
Hdf5File opened(const std::filesystem::path& file, bool unfinished) {
  std::array<char, k_hdf5_signature.size()> start{};
  std::ifstream stream;
  if (check_readable(file)) stream.open(file, std::ios::binary);
  if (stream.read(start.data(), start.size()) && !std::ranges::equal(start, k_hdf5_signature))
    throw Hdf5Error(fmt::format("{}: error: this is not a recording (troupe run --record): not an HDF5 file",
                                file.string()));
  return unfinished ? Hdf5File::open_swmr(file) : Hdf5File::open(file);
}

/// Returns the extent of an array as text: "12 x 3".
std::string extent_text(const std::vector<std::size_t>& extent) {
  std::vector<std::string> sizes;
  for (const std::size_t size : extent) sizes.push_back(std::to_string(size));
  return joined(sizes, " x ");
}

}  // namespace

RecordingReader::RecordingReader(const std::filesystem::path& file)
    : unfinished_(is_unfinished(file)), hdf5_(opened(file, unfinished_)) {
  const Hdf5Group meta = checked_meta(hdf5_);
  for (const std::string& name : meta.attributes())
    meta_[name] = name == "layout" || name == "record_every_ticks" ? std::to_string(meta.integer(name))
                                                                   : meta.text(name);
  const std::int64_t every = meta.integer("record_every_ticks");
  if (every < 1)
    meta.fail(
        fmt::format("has a record_every_ticks of {}, which must be at least 1: the file is damaged", every));
  every_ticks_ = static_cast<std::uint64_t>(every);

  const Hdf5Group bodies = hdf5_.group("bodies");
  ids_ = bodies.dataset("id").read<std::uint32_t>();
  types_ = bodies.read_texts("type");
  names_ = bodies.read_texts("name");
  if (types_.size() != ids_.size() || names_.size() != ids_.size())
    bodies.fail(
        fmt::format("has {} ids, {} types and {} names, but needs the same number of each: the file is "
                    "damaged",
                    ids_.size(), types_.size(), names_.size()));
  if (const auto id = std::ranges::adjacent_find(ids_, std::greater_equal()); id != ids_.end())
    bodies.fail(
        fmt::format("has id {} after id {}, but ids must increase: the file is damaged", id[1], id[0]));

  std::vector<std::uint32_t> all(ids_.size());
  std::iota(all.begin(), all.end(), 0u);
  find_arrays(hdf5_.group("state"), "", all);
  if (hdf5_.has_group("sensors")) {
    const Hdf5Group sensors = hdf5_.group("sensors");
    std::map<std::string_view, std::vector<std::uint32_t>> of_types;  // bodies by the name of their type
    for (const std::uint32_t body : all) of_types[types_[body]].push_back(body);
    for (const std::string& type : sensors.names())
      find_arrays(sensors.group(type), "sensors/" + type, of_types[type]);
  }
  std::ranges::stable_sort(arrays_, {}, phase_order);
  read_frames();
}

Hdf5Group RecordingReader::checked_meta(const Hdf5File& file) {
  constexpr std::string_view k_kind = "troupe recording";
  if (!file.has_group("meta") || !file.group("meta").has_attribute("kind") ||
      file.group("meta").text("kind") != k_kind)
    file.fail(
        fmt::format("has no group \"meta\" whose attribute \"kind\" is \"{}\": the file is not a "
                    "recording",
                    k_kind));
  Hdf5Group meta = file.group("meta");
  if (const std::int64_t layout = meta.integer("layout"); layout != k_recording_layout)
    meta.fail(fmt::format(
        "has layout {}, which another version of Troupe wrote; this program reads layout {}: record the run "
        "again with this program",
        layout, k_recording_layout));
  return meta;
}

void RecordingReader::find_arrays(const Hdf5Group& group, const std::filesystem::path& place,
                                  const std::vector<std::uint32_t>& bodies) {
  for (const std::string& path : group.paths()) {
    if (group.has_group(path)) continue;
    Hdf5Dataset dataset = group.dataset(path);
    dataset.values();  // throws if the file is too small for so many values
    const std::vector<std::size_t>& extent = dataset.extent();
    const std::string name = (place / path).filename();
    const std::string component = (place / path).parent_path();
    if (component.empty()) {  // /state/alive belongs to no component
      if (name != "alive") continue;
      if (extent.size() != 2 || extent[1] != bodies.size() || dataset.element() != engine::Element::u8)
        dataset.fail(
            fmt::format("has the shape [{}] and values of type {}, but must have the shape [frames x {}] and "
                        "values of type {}: the file is damaged",
                        extent_text(extent), engine::element_name(dataset.element()), bodies.size(),
                        engine::element_name(engine::Element::u8)));
      alive_ = std::move(dataset);
      continue;
    }
    if (extent.size() != 3 || extent[1] != bodies.size())
      dataset.fail(
          fmt::format("has the shape [{0}], but must have the shape [frames x {1} x values], because "
                      "its group has data of {1} bodies: the file is damaged",
                      extent_text(extent), bodies.size()));
    Array array;
    array.component = component;
    array.frame = dataset.text("frame");
    array.bodies = bodies;
    array.field.name = name;
    array.field.element = dataset.element();
    array.field.columns = static_cast<std::uint32_t>(extent[2]);
    array.field.unit = dataset.text("unit");
    array.field.text = dataset.text("text");
    array.dataset = std::move(dataset);
    arrays_.push_back(std::move(array));
  }
}

void RecordingReader::read_frames() {
  const Hdf5Group frames = hdf5_.group("frames");
  ticks_ = frames.dataset("tick").read<std::uint64_t>();
  times_s_ = frames.dataset("time_s").read<double>();
  hashes_ = frames.dataset("hash").read<std::uint64_t>();
  // The tick of a frame is written last: a frame that has a tick is complete.
  std::size_t whole = std::min({ticks_.size(), times_s_.size(), hashes_.size()});
  whole = static_cast<std::size_t>(
      std::find(ticks_.begin(), ticks_.begin() + static_cast<std::ptrdiff_t>(whole), k_no_tick) -
      ticks_.begin());
  for (const Array& array : arrays_) whole = std::min(whole, array.dataset.rows());
  if (alive_) whole = std::min(whole, alive_->rows());
  ticks_.resize(whole);
  times_s_.resize(whole);
  hashes_.resize(whole);
  if (const auto tick = std::ranges::adjacent_find(ticks_, std::greater_equal()); tick != ticks_.end())
    frames.fail(fmt::format("has tick {} after tick {}, but ticks must increase: the file is damaged",
                            tick[1], tick[0]));
  double last_s = -std::numeric_limits<double>::infinity();
  for (std::size_t f = 0; f < whole; last_s = times_s_[f++])
    if (!std::isfinite(times_s_[f]) || times_s_[f] < last_s)
      frames.fail(
          fmt::format("has the time {} s at tick {}, after {} s, but times must be finite and must not "
                      "decrease: the file is damaged",
                      times_s_[f], ticks_[f], last_s));
}

std::optional<BodyColumns> RecordingReader::scene() const {
  if (!hdf5_.has_group("scene")) return std::nullopt;
  const Hdf5Group group = hdf5_.group("scene");
  BodyColumns scene{.word = group.dataset("word").read<std::uint32_t>(),
                    .number = group.dataset("number").read<std::uint32_t>(),
                    .type = group.dataset("type").read<std::uint32_t>(),
                    .pose = group.dataset("pose").read<double>(),
                    .color = group.dataset("color").read<float>()};
  const std::size_t bodies = scene.type.size();
  if (scene.word.size() != bodies || scene.number.size() != bodies || scene.pose.size() != 4 * bodies ||
      scene.color.size() != 4 * bodies || (!ids_.empty() && std::ranges::max(ids_) >= bodies))
    group.fail("does not have one type, name, pose and color for each body: the file is damaged");
  return scene;
}

std::vector<std::uint8_t> RecordingReader::has(const Array& array) const {
  std::vector<std::uint8_t> all(array.bodies.size(), 1);
  if (array.component.starts_with("sensors/") || !hdf5_.group("bodies").has_group("has")) return all;
  Hdf5Group group = hdf5_.group("bodies").group("has");
  std::string_view path = array.component;
  for (std::size_t slash = path.find('/'); slash != path.npos; slash = path.find('/')) {
    const std::string step(path.substr(0, slash));
    if (!group.has_group(step)) return all;
    group = group.group(step);
    path.remove_prefix(slash + 1);
  }
  const std::string name(path);
  if (!group.has(name) || group.has_group(name)) return all;
  std::vector<std::uint8_t> has = group.dataset(name).read<std::uint8_t>();
  if (has.size() != all.size())
    group.fail(fmt::format("has {} values in {}, but needs one for each of {} bodies: the file is damaged",
                           has.size(), name, all.size()));
  return has;
}

std::vector<std::uint8_t> RecordingReader::alive(std::size_t frame, std::size_t count) const {
  std::vector<std::uint8_t> alive(count * ids_.size(), 1);
  if (alive_) alive_->read_rows(frame, std::span(alive));
  return alive;
}

void RecordingReader::read(const Array& array, std::size_t frame, std::span<std::byte> into) const {
  array.dataset.read_bytes(frame, into);
}

bool selects(std::string_view name, const RecordingReader::Array& array, const RecordingReader& recording) {
  constexpr std::string_view k_sensors = "sensors/";
  const std::string_view component = array.component;
  if (engine::selects(name, component)) return true;
  const std::size_t slash = name.find('/');
  if (!component.starts_with(k_sensors) || slash == name.npos ||
      name.substr(slash + 1) != engine::given_name(component))
    return false;
  const std::string_view first = name.substr(0, slash);
  const std::string_view rest = component.substr(k_sensors.size());
  return first == rest.substr(0, rest.find('/')) ||
         std::ranges::find(recording.types(), first) == recording.types().end();
}

std::optional<std::string> present_name(std::string_view name, const RecordingReader& recording) {
  const auto given = [&](const RecordingReader::Array& array) -> std::string {
    const std::string_view component = array.component;
    const std::string_view own = engine::given_name(component);
    const bool is_sole = std::ranges::none_of(recording.arrays(), [&](const RecordingReader::Array& other) {
      return other.component != component && engine::given_name(other.component) == own;
    });
    return std::string(is_sole ? own : component.substr(component.find('/') + 1));
  };
  for (const RecordingReader::Array& array : recording.arrays()) {
    const std::string& component = array.component;
    const bool is_path = component.starts_with("sensors/");
    if (is_path && name == component) return given(array);
    const std::size_t end = component.size();
    if (!name.starts_with(component) || name.size() == end) {
      if (name == fmt::format("{}/{}", engine::given_name(component), array.field.name))
        return fmt::format("{}.{}", given(array), array.field.name);
      continue;
    }
    const std::string_view field = name.substr(end + 1);
    const bool has_separator = name[end] == '/' || (is_path && name[end] == '.');
    if (has_separator && field.substr(0, field.find('.')) == array.field.name)
      return fmt::format("{}.{}", given(array), field);
  }
  return std::nullopt;
}

std::string shown_name(std::string_view component) {
  constexpr std::string_view k_sensors = "sensors/";
  std::string given = text_of_hdf5_name(engine::given_name(component));
  if (!component.starts_with(k_sensors)) return given;
  const std::string_view rest = component.substr(k_sensors.size());
  return fmt::format("{} ({})", given, text_of_hdf5_name(rest.substr(0, rest.find('/'))));
}

}  // namespace troupe::worldio
