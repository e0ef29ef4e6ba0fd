#include "troupe/recorded_run.hpp"

#include "base/diagnostics.hpp"
#include "base/number_text.hpp"
#include "engine/kinds/energy.hpp"
#include "engine/kinds/mount.hpp"
#include "engine/sensing/shown_color.hpp"
#include "troupe/value_names.hpp"
#include "worldio/results/hdf5_file.hpp"
#include "worldio/results/recorded_scene.hpp"
#include "worldio/results/recording_fields.hpp"
#include "worldio/results/recording_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe {
namespace {

using engine::Frame;
using engine::FrameScene;
using worldio::RecordedScene;
using worldio::RecordingReader;
using Array = RecordingReader::Array;

/// Returns by how much a time may differ from `time_s` and still count as equal, s: because of rounding, 3
/// ticks of 0.1 s may end slightly later than 0.3 s. Above 10 days, neighbouring doubles differ by up to
/// 1e-9.
double tolerance_s(double time_s) {
  constexpr double k_share = 1e-15;  // of `time_s`: 4 to 9 neighbouring doubles
  return std::max(1e-9, k_share * std::abs(time_s));
}

template <class T>
T number_in(const RecordingReader& reader, const std::string& key, T fallback) {
  const auto found = reader.meta().find(key);
  if (found == reader.meta().end()) return fallback;
  return number_of<T>(found->second).value_or(fallback);
}

}  // namespace

struct RecordedRun::Impl {
  RecordingReader reader;
  RecordedScene world;
  std::optional<engine::Record> window;
  std::map<std::pair<std::string_view, std::string_view>, const Array*> by_name;  // by component and field
  std::array<const Array*, 4> pose{};  // x, y, z, heading; z may be null
  const Array* stalled = nullptr;
  /// Per ranger, in the order of FrameScene::rangers: the array of its readings; null if they were not
  /// recorded.
  std::vector<const Array*> readings;
  std::vector<std::uint32_t> rows;                    // per body id: its row in the recording, or k_none
  std::vector<std::vector<std::uint32_t>> type_rows;  // per type: the rows of its bodies in the recording
  std::vector<const Array*> shown_colors;             // per type; null if not recorded
  /// Per type and part: the array of the colours that a device gives the part; null if not recorded.
  std::vector<std::vector<const Array*>> part_colors;
  /// Displacements of the joints of each type: per joint four arrays (x, y, z, heading). Empty for a type
  /// whose joints were not recorded.
  std::vector<std::vector<std::array<const Array*, 4>>> joints;
  std::size_t frame = 0;

  static constexpr std::uint32_t k_none = std::numeric_limits<std::uint32_t>::max();

  explicit Impl(const std::filesystem::path& file)
      : reader(file), world(worldio::recorded_scene(reader)), window(worldio::recorded_window(reader)) {
    if (reader.frames() == 0) refuse("the recording has no frames to draw: record the run again");
    for (const Array& array : reader.arrays())
      by_name.try_emplace({array.component, array.field.name}, &array);
    pose = find_pose("pose");
    rows.assign(world.bodies.size(), k_none);
    type_rows.resize(world.types.size());
    for (std::uint32_t row = 0; row < reader.ids().size(); ++row) {
      rows[reader.ids()[row]] = row;
      type_rows[world.bodies[reader.ids()[row]].type].push_back(row);
    }
    if (!pose[0] || !pose[1] || !pose[3])
      refuse(
          "the recording has no poses: record the run with pose in --record-fields (in C++ and Python: "
          "fields)");
    stalled = find("stall", "stalled");
    for (std::size_t t = 0; t < world.types.size(); ++t) {
      const RecordedScene::Type& type = world.types[t];
      // If two types have the same name, recordings append "~2" to the second one. Hence the name in
      // /bodies/type is used.
      const std::string name = type_rows[t].empty() ? "" : reader.types()[type_rows[t].front()];
      for (const RecordedScene::Ranger& ranger : type.rangers) {
        const Array* ranges = find(fmt::format("sensors/{}/{}", name, ranger.name), "ranges");
        std::size_t beams = 0;
        for (const RecordedScene::Transducer& each : ranger.transducers) beams += each.beams;
        readings.push_back(ranges && ranges->field.columns == beams ? ranges : nullptr);
      }
      shown_colors.push_back(type.shown_color.empty() ? nullptr
                                                      : find(type.shown_color, engine::k_shown_color));
      auto& colors = part_colors.emplace_back();
      for (const std::string& component : type.part_colors)
        colors.push_back(component.empty() ? nullptr : find(component, engine::k_shown_color));
      auto& of_type = joints.emplace_back();
      for (const RecordedScene::Joint& joint : type.joints) of_type.push_back(find_pose(joint.component));
      const auto is_whole = [](const auto& arrays) {
        return std::ranges::all_of(arrays, [](const Array* array) { return array != nullptr; });
      };
      if (!std::ranges::all_of(of_type, is_whole)) of_type.clear();
    }
  }

  [[noreturn]] void refuse(const std::string& message) const {
    throw InputError(fmt::format("{}: error: {}", reader.file().string(), message));
  }

  const Array* find(std::string_view component, std::string_view field) const {
    const auto found = by_name.find({component, field});
    return found == by_name.end() ? nullptr : found->second;
  }

  /// Returns the arrays of a pose. An array without exactly one value per body, as damaged files may have it,
  /// counts as not recorded.
  std::array<const Array*, 4> find_pose(std::string_view component) const {
    std::array<const Array*, 4> arrays = {find(component, "x"), find(component, "y"), find(component, "z"),
                                          find(component, "heading")};
    for (const Array*& array : arrays)
      if (array && array->field.columns != 1) array = nullptr;
    return arrays;
  }

  /// Returns the values of an array in the current frame, row-major, with one row per body of the array.
  std::vector<double> read(const Array& array) const {
    std::vector<std::byte> bytes(array.bodies.size() * array.row_bytes());
    std::vector<double> values(array.bodies.size() * array.field.columns);
    reader.read(array, frame, bytes);
    engine::to_doubles(array.field.element, bytes, values);
    return values;
  }

  /// The poses that a component stores in the current frame, one per row of the recording. of() returns the
  /// pose of a row, with the given z if z was not recorded.
  class Poses {
   public:
    Poses(const Impl& run, const std::array<const Array*, 4>& arrays) {
      for (std::size_t f = 0; f < arrays.size(); ++f)
        if (arrays[f]) values_[f] = run.read(*arrays[f]);
    }
    Pose of(std::size_t row, double z) const {
      return {values_[0][row], values_[1][row], values_[2].empty() ? z : values_[2][row], values_[3][row]};
    }

   private:
    std::array<std::vector<double>, 4> values_;
  };

  Frame bodies() const {
    Frame shown{reader.times_s()[frame], reader.ticks()[frame], {}};
    const std::vector<std::uint8_t> alive = reader.alive(frame);
    const Poses poses(*this, pose);
    const std::vector<double> stalls = stalled ? read(*stalled) : std::vector<double>();
    for (std::size_t row = 0; row < reader.ids().size(); ++row) {
      const std::uint32_t id = reader.ids()[row];
      const RecordedScene::Body& body = world.bodies[id];
      const Pose at = poses.of(row, body.pose_world_body.z);
      if (alive[row] == 0 || !std::isfinite(at.x) || !std::isfinite(at.y) || !std::isfinite(at.heading))
        continue;  // not in the world at that time
      shown.mobile.push_back({body.type, at, body.color, row < stalls.size() && stalls[row] > 0, id});
    }
    color(shown);
    return shown;
  }

  /// Sets the colours of bodies that have a device which shows a colour, such as an LED.
  void color(Frame& shown) const {
    const std::vector<std::uint32_t> places = places_in(shown);
    for (const Array* array : shown_colors) {
      if (!array) continue;
      const std::vector<double> colors = read(*array);
      for (std::size_t r = 0; r < array->bodies.size(); ++r) {
        const std::uint32_t place = places[array->bodies[r]];
        if (place == k_none) continue;
        Color& own = shown.mobile[place].color;
        own = worldio::shown_color(std::span(colors).subspan(3 * r, 3), own);
      }
    }
  }

  /// Returns, for each row of the recording and each joint of the row's type, the motion in the body frame
  /// that takes a part on this joint from its rest pose to its pose in the current frame. Empty for types
  /// whose joints were not recorded.
  std::vector<std::vector<engine::Mount>> mounts() const {
    std::map<const Array*, std::vector<double>> values;  // many types may share the arrays of a joint
    const auto values_of = [&](const Array* array) -> const std::vector<double>& {
      const auto [entry, is_new] = values.try_emplace(array);
      if (is_new) entry->second = read(*array);
      return entry->second;
    };
    std::vector<std::vector<engine::Mount>> mounts(reader.ids().size());
    for (std::size_t type = 0; type < world.types.size(); ++type) {
      for (std::size_t j = 0; j < joints[type].size(); ++j) {
        const RecordedScene::Joint& joint = world.types[type].joints[j];
        std::array<const std::vector<double>*, 4> q{};  // x, y, z, heading
        for (std::size_t i = 0; i < q.size(); ++i) q[i] = &values_of(joints[type][j][i]);
        const engine::Mount at_rest(joint.pose_body_joint);
        for (const std::uint32_t row : type_rows[type]) {
          const Pose state{(*q[0])[row], (*q[1])[row], (*q[2])[row], (*q[3])[row]};
          const engine::Mount parent =
              joint.parent < 0 ? engine::Mount() : mounts[row][static_cast<std::size_t>(joint.parent)];
          // At rest, rounding could make the mount differ from that of the run (Links::move_to_joints()).
          const bool is_moved = std::isfinite(state.x) && std::isfinite(state.heading) && state != Pose{};
          mounts[row].push_back(
              is_moved ? compose(compose(compose(parent, at_rest), engine::Mount(state)), inverse(at_rest))
                       : parent);
        }
      }
    }
    return mounts;
  }

  /// Returns, for each row of the recording, the colours that devices give the parts of its body in the
  /// current frame: three numbers for each part of the type; -1: not known. Empty if no device gives a part a
  /// colour.
  std::vector<std::vector<double>> colors_of_parts() const {
    std::vector<std::vector<double>> colors(reader.ids().size());
    for (std::uint32_t type = 0; type < world.types.size(); ++type) {
      for (std::size_t part = 0; part < part_colors[type].size(); ++part) {
        const Array* const array = part_colors[type][part];
        if (!array) continue;
        const std::vector<double> shown = read(*array);
        for (std::size_t r = 0; r < array->bodies.size(); ++r) {
          const std::uint32_t row = array->bodies[r];
          if (world.bodies[reader.ids()[row]].type != type) continue;
          colors[row].resize(3 * part_colors[type].size(), -1);
          for (std::size_t c = 0; c < 3; ++c)
            if (std::isfinite(shown[3 * r + c])) colors[row][3 * part + c] = shown[3 * r + c];
        }
      }
    }
    return colors;
  }

  /// Returns the shapes of a body: those of its type at rest, moved by joints, and with the colours of parts.
  /// parts: entry of the body in colors_of_parts(); moved: its entry in mounts(); own: colour of the body
  static engine::FrameType look_of(const RecordedScene::Type& at_rest, std::span<const double> parts,
                                   std::span<const engine::Mount> moved, const Color& own) {
    engine::FrameType look = at_rest.look;
    look.name = at_rest.name;
    for (std::size_t k = 0; k < look.shapes.size(); ++k) {
      if (!parts.empty()) {
        const std::span<const double> color = parts.subspan(3 * at_rest.shape_parts[k], 3);
        if (color[0] >= 0) look.shapes[k].color = worldio::shown_color(color, own);
      }
      if (moved.empty() || at_rest.shape_joints[k] < 0) continue;
      const engine::Mount& now = moved[static_cast<std::size_t>(at_rest.shape_joints[k])];
      Solid& solid = look.shapes[k].solid;
      for (Ring& ring : solid.contours)
        for (Vec2& point : ring) point = now.transform * point;
      solid.z = solid.z.shifted(now.z);
    }
    look.radius = engine::enclosing_radius(look.shapes);
    return look;
  }

  /// Gives the bodies looks of their own (Frame::types) in the cases in which make_frame() does, and in the
  /// same order, in which viewers draw them: bodies whose joints are not at rest, and bodies whose parts show
  /// colours. Bodies of one type with joints at rest and the same colours share a look.
  void change_parts(Frame& shown) const {
    const std::vector<std::vector<engine::Mount>> moved = mounts();
    const std::vector<std::vector<double>> colors = colors_of_parts();
    std::map<std::pair<std::uint32_t, std::vector<double>>, std::uint32_t> looks;  // by type and colours
    for (engine::FrameBody& body : shown.mobile) {
      const std::uint32_t row = rows[body.id];
      const std::uint32_t type = body.type;
      const auto next = static_cast<std::uint32_t>(world.types.size() + shown.types.size());
      std::uint32_t look = next;
      if (std::ranges::all_of(moved[row], engine::is_identity)) {
        if (colors[row].empty()) continue;
        look = looks.try_emplace({type, colors[row]}, next).first->second;
      }
      body.type = look;
      if (look == next)
        shown.types.push_back(look_of(world.types[type], colors[row], moved[row], body.color));
    }
  }

  /// Returns Frame::charges, which are NaN for bodies without a recorded power pack.
  std::vector<double> charges(const Frame& shown) const {
    const std::vector<double> stored = values(shown, "sensors", "stored", 0);
    const std::vector<double> capacity = values(shown, "sensors", "capacity", 0);
    const std::vector<double> infinite = values(shown, "sensors", "infinite", 0);
    std::vector<double> charges;
    for (std::size_t i = 0; i < stored.size(); ++i) {
      const engine::Energy pack{
          .stored_j = stored[i], .capacity_j = capacity[i], .infinite = infinite[i] == 1};
      charges.push_back(std::isnan(stored[i]) ? k_nan : pack.proportion_remaining());
    }
    return charges;
  }

  /// Returns for each row of the recording the index of its body in Frame::mobile; k_none if the frame does
  /// not contain the body.
  std::vector<std::uint32_t> places_in(const Frame& shown) const {
    std::vector<std::uint32_t> places(reader.ids().size(), k_none);
    for (std::size_t row = 0, i = 0; row < places.size() && i < shown.mobile.size(); ++row)
      if (reader.ids()[row] == shown.mobile[i].id) places[row] = static_cast<std::uint32_t>(i++);
    return places;
  }

  void add_scans(Frame& shown) const {
    const std::vector<std::uint32_t> places = places_in(shown);
    const std::vector<std::vector<engine::Mount>> moved = mounts();
    std::size_t rangers = 0;  // so far
    for (std::size_t type = 0; type < world.types.size(); ++type) {
      for (const RecordedScene::Ranger& ranger : world.types[type].rangers) {
        const std::size_t index = rangers++;
        if (!readings[index]) continue;
        const Array& array = *readings[index];
        const std::vector<double> ranges = read(array);
        const std::size_t columns = array.field.columns;
        for (std::size_t r = 0; r < array.bodies.size(); ++r) {
          const std::uint32_t place = places[array.bodies[r]];
          const auto of_body = std::span(ranges).subspan(r * columns, columns);
          // The readings of a ranger that did not run are NaN; at tick 0 they are 0. A single 0 is the
          // reading of a beam that begins on an edge.
          if (place == k_none || std::ranges::none_of(of_body, [](double range) { return range > 0; }))
            continue;
          const std::vector<engine::Mount>& joints_of_body = moved[array.bodies[r]];
          Pose by_joint;
          if (ranger.joint >= 0 && static_cast<std::size_t>(ranger.joint) < joints_of_body.size())
            by_joint = joints_of_body[static_cast<std::size_t>(ranger.joint)].pose();
          shown.scans.push_back({place, static_cast<std::uint32_t>(index), shown.ranges.size(), by_joint});
          for (const double range : of_body) shown.ranges.push_back(static_cast<float>(range));
        }
      }
    }
    // The scans of one robot are consecutive, as in frames of a simulation.
    std::ranges::stable_sort(shown.scans, {}, &engine::FrameScan::body);
  }

  /// Whether only types without bodies have a device or controller of this name. Their fields are unknown,
  /// because a recording has no arrays of them.
  bool is_of_absent_types(std::string_view component) const {
    const auto has_it = [&](const RecordedScene::Type& type) {
      return std::ranges::any_of(
                 type.devices,
                 [&](const auto& device) { return worldio::text_of_hdf5_name(device.name) == component; }) ||
             std::ranges::any_of(type.memories,
                                 [&](const auto& memory) { return engine::selects(component, memory); });
    };
    bool is_absent = false;
    for (std::size_t t = 0; t < world.types.size(); ++t) {
      if (!has_it(world.types[t])) continue;
      if (!type_rows[t].empty()) return false;
      is_absent = true;
    }
    return is_absent;
  }

  /// Returns one number per body of Frame::mobile, from all arrays of this component (or kind) and field. NaN
  /// for bodies without such an array.
  std::vector<double> values(const Frame& shown, std::string_view component, std::string_view field,
                             std::size_t column) const {
    const std::vector<std::uint32_t> places = places_in(shown);
    std::vector<double> values(shown.mobile.size(), k_nan);
    for (const Array& array : reader.arrays()) {
      if (array.field.name != field || column >= array.field.columns || !selects(component, array, reader))
        continue;
      const std::vector<std::uint8_t> has = reader.has(array);
      const std::vector<double> all = read(array);
      for (std::size_t r = 0; r < array.bodies.size(); ++r)
        if (const std::uint32_t place = places[array.bodies[r]]; place != k_none && has[r] != 0)
          values[place] = all[r * array.field.columns + column];
    }
    return values;
  }
};

namespace {

/// Returns the result of work(). Converts errors of HDF5, which occur in damaged files, to InputError.
template <class Work>
auto checked(Work&& work) {
  try {
    return work();
  } catch (const worldio::Hdf5Error& error) {
    throw InputError(error.what());
  }
}

}  // namespace

RecordedRun::RecordedRun(const std::filesystem::path& recording)
    : impl_(checked([&] { return std::make_unique<Impl>(recording); })) {
  go_to_frame(impl_->reader.frames() - 1);
}

RecordedRun::~RecordedRun() = default;
RecordedRun::RecordedRun(RecordedRun&&) noexcept = default;
RecordedRun& RecordedRun::operator=(RecordedRun&&) noexcept = default;

std::span<const double> RecordedRun::times_s() const { return impl_->reader.times_s(); }
std::size_t RecordedRun::frame_index() const { return impl_->frame; }
void RecordedRun::go_to_frame(std::size_t frame) { impl_->frame = std::min(frame, times_s().size() - 1); }

std::size_t RecordedRun::first_within(double history_s) const {
  const std::span<const double> times = times_s();
  const auto first = std::ranges::lower_bound(times, time_s() - history_s - tolerance_s(time_s()));
  return std::min(static_cast<std::size_t>(first - times.begin()), frame_index());
}

void RecordedRun::go_to(double time_s) {
  const std::span<const double> times = impl_->reader.times_s();
  const double tolerance = tolerance_s(time_s);
  const bool is_recorded = times.front() <= time_s + tolerance && times.back() >= time_s - tolerance;
  if (!is_recorded)  // also for NaN
    impl_->refuse(fmt::format("{:.10g} s is not recorded: the recording contains {:.10g} s to {:.10g} s",
                              time_s, times.front(), times.back()));
  const auto later = std::ranges::upper_bound(times, time_s + tolerance);
  go_to_frame(static_cast<std::size_t>(later - times.begin()) - 1);
}

std::string RecordedRun::file() const { return impl_->reader.file().string(); }
std::string RecordedRun::world() const {
  const auto found = impl_->reader.meta().find("world");
  return found == impl_->reader.meta().end() ? file() : found->second;
}
std::uint64_t RecordedRun::seed() const { return number_in(impl_->reader, "seed", std::uint64_t{0}); }
double RecordedRun::tick_s() const { return number_in(impl_->reader, "tick_s", 0.1); }
const engine::Record* RecordedRun::window() const { return impl_->window ? &*impl_->window : nullptr; }

FrameScene RecordedRun::scene() const {
  FrameScene scene;
  scene.title = impl_->world.title;
  scene.limits = impl_->world.limits;
  std::vector<std::uint8_t> moves(impl_->world.bodies.size(), 0);
  for (const std::uint32_t id : impl_->reader.ids()) moves[id] = 1;
  for (std::size_t t = 0; t < impl_->world.types.size(); ++t) {
    const RecordedScene::Type& type = impl_->world.types[t];
    scene.types.push_back(type.look);
    scene.types.back().name = type.name;
    for (const RecordedScene::Ranger& ranger : type.rangers) {
      engine::FrameRanger shown{static_cast<std::uint32_t>(t), 0, {}};
      for (const RecordedScene::Transducer& each : ranger.transducers) {
        shown.transducers.push_back(
            {each.pose_body_transducer, each.range_max_m, each.fov_rad, shown.readings, each.beams});
        shown.readings += each.beams;
      }
      scene.rangers.push_back(std::move(shown));
    }
  }
  const std::vector<std::uint8_t> alive = checked([&] { return impl_->reader.alive(0); });
  std::vector<std::uint8_t> starts(impl_->world.bodies.size(), 0);
  for (std::size_t row = 0; row < alive.size(); ++row) starts[impl_->reader.ids()[row]] = alive[row];
  for (std::size_t b = 0; b < impl_->world.bodies.size(); ++b) {
    const RecordedScene::Body& body = impl_->world.bodies[b];
    const engine::FrameType& look = impl_->world.types[body.type].look;
    if (moves[b] != 0) {
      if (starts[b] != 0) scene.bounds.extend(Box::around(body.pose_world_body.position(), look.radius));
      continue;
    }
    scene.fixed.push_back(
        {body.type, body.pose_world_body, body.color, false, static_cast<std::uint32_t>(b)});
    for (const engine::FrameShape& shape : look.shapes)
      for (const Ring& ring : placed(shape.solid, body.pose_world_body).contours)
        scene.bounds.extend(bounds(ring));
  }
  return scene;
}

std::optional<std::uint32_t> RecordedRun::find_body(std::string_view name) const {
  for (std::size_t b = impl_->world.bodies.size(); b-- > 0;)  // the last of several bodies of one name
    if (impl_->world.bodies[b].name == name) return static_cast<std::uint32_t>(b);
  return std::nullopt;
}

Result<ChosenValue> RecordedRun::find_value(const std::string& name) const {
  for (ChosenValue& reading : readings_of(name)) {
    for (const Array& array : impl_->reader.arrays()) {
      if (array.field.name != reading.field || !selects(reading.component, array, impl_->reader)) continue;
      if (reading.column >= array.field.columns) return no_such_column(reading, array.field.columns);
      reading.text = with_unit(name, array.field.unit);
      return reading;
    }
  }
  for (ChosenValue& reading : readings_of(name)) {
    if (!impl_->is_of_absent_types(reading.component)) continue;
    reading.text = fmt::format("{}: no robot has the value", name);
    return reading;
  }
  if (const auto present = present_name(name)) return Error{worldio::wrong_spelling("value", name, *present)};
  std::vector<std::string> known;
  for (const Array& array : impl_->reader.arrays())
    known.push_back(fmt::format("{}.{}", engine::given_name(array.component), array.field.name));
  return Error{
      fmt::format("{}; the option --record-fields of the run (in C++ and Python: fields) selects what "
                  "is recorded",
                  unknown_name("value", name, {known.begin(), known.end()}))};
}

std::optional<std::string> RecordedRun::present_name(std::string_view name) const {
  return worldio::present_name(name, impl_->reader);
}

Result<> RecordedRun::check(const FrameWishes& wishes) const {
  const auto not_recorded = [](std::string_view what, std::string_view field) {
    return Error{fmt::format(
        "the recording has no {}: record the run with --record-fields pose,{} (in C++ and Python: "
        "fields)",
        what, field)};
  };
  const bool has_ranges = std::ranges::any_of(impl_->readings, [](const Array* a) { return a != nullptr; });
  if (wishes.scans && !has_ranges) return not_recorded("ranges", "ranges");
  const auto has = [&](std::string_view component, std::string_view field) {
    return std::ranges::any_of(impl_->reader.arrays(), [&](const Array& array) {
      return array.field.name == field && selects(component, array, impl_->reader);
    });
  };
  if (wishes.charges && !has("sensors", "stored")) return not_recorded("power packs", "power_pack");
  for (const auto& [wished, layer] : {std::pair(wishes.sights, "sights"), std::pair(wishes.blobs, "blobs"),
                                      std::pair(wishes.grips, "grips"), std::pair(wishes.links, "links"),
                                      std::pair(wishes.tiles, "tiles"), std::pair(wishes.cells, "cells")})
    if (wished)
      return Error{fmt::format(
          "the layer \"{}\" can be drawn for worlds and checkpoints, but not for recordings: omit this layer",
          layer)};
  return {};
}

double RecordedRun::time_s() const { return impl_->reader.times_s()[impl_->frame]; }
std::uint64_t RecordedRun::state_hash() const { return impl_->reader.hashes()[impl_->frame]; }

Frame RecordedRun::frame(const FrameWishes& wishes) const {
  return checked([&] {
    Frame shown = impl_->bodies();
    if (wishes.scans) impl_->add_scans(shown);
    if (wishes.charges) shown.charges = impl_->charges(shown);
    if (wishes.names)
      for (const engine::FrameBody& body : shown.mobile)
        shown.names.push_back(impl_->world.bodies[body.id].name);
    impl_->change_parts(shown);
    if (wishes.value) {
      shown.values = impl_->values(shown, wishes.value->component, wishes.value->field, wishes.value->column);
      shown.value_name = wishes.value->text;
    }
    return shown;
  });
}

}  // namespace troupe
