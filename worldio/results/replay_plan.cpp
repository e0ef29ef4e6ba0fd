#include "worldio/results/replay_plan.hpp"

#include "base/diagnostics.hpp"
#include "engine/sensing/shown_color.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string_view>

namespace troupe::worldio {
namespace {

using Array = RecordingReader::Array;
using engine::Element;

constexpr double k_levels = 4095;    // number of steps of a field: enough for a colour or a reading
constexpr double k_endless = 1e150;  // larger numbers are treated as NaN, so that differences stay finite
constexpr double k_most_whole = 100000000;  // most steps; integers with a larger range are rounded
constexpr std::size_t k_block_bytes = std::size_t{1} << 20;  // of the frames that FrameReader reads at once

[[noreturn]] void refuse(const RecordingReader& recording, const std::string& message) {
  throw InputError(fmt::format("{}: error: {}", recording.file().string(), message));
}

const Array* find_pose(const RecordingReader& recording, std::string_view field) {
  for (const Array& array : recording.arrays())
    if (array.component == "pose" && array.field.name == field && array.field.columns == 1) return &array;
  return nullptr;
}

std::string name_of(const Array& array) {
  return fmt::format("{}.{}", engine::given_name(array.component), array.field.name);
}

/// Whether an array has the displacements of a joint, which a page needs to draw the parts that it moves.
bool is_joint(const Array& array) { return array.component.starts_with("joint/"); }

/// Whether a page needs an array, besides those of the component "pose", to draw the bodies.
bool is_appearance(const Array& array) {
  return is_joint(array) || array.field.name == engine::k_shown_color;
}

/// Whether a name of --fields chooses an array.
bool chooses(std::string_view name, const Array& array, const RecordingReader& recording) {
  if (name == "all" || name == array.field.name || selects(name, array, recording)) return true;
  const std::size_t end = name.find_last_of("./");  // COMPONENT.FIELD, or COMPONENT/FIELD of earlier versions
  return end != name.npos && name.substr(end + 1) == array.field.name &&
         selects(name.substr(0, end), array, recording);
}

/// Returns the arrays that --fields chooses, and those that are needed to draw the bodies. Throws InputError
/// for a name that chooses no array.
std::vector<const Array*> chosen_arrays(const RecordingReader& recording,
                                        std::span<const std::string> names) {
  for (const std::string& name : names) {
    if (std::ranges::any_of(recording.arrays(),
                            [&](const Array& array) { return chooses(name, array, recording); }) ||
        name == "all")
      continue;
    std::vector<std::string> known;
    for (const Array& array : recording.arrays()) known.push_back(name_of(array));
    refuse(recording, fmt::format("{}; troupe run --record-fields chooses what is recorded",
                                  unknown_name("field", name, {known.begin(), known.end()})));
  }
  std::vector<const Array*> arrays;
  for (const Array& array : recording.arrays())
    if (array.component != "pose" && array.field.columns > 0 &&
        (names.empty() || is_appearance(array) || std::ranges::any_of(names, [&](const std::string& name) {
           return chooses(name, array, recording);
         })))
      arrays.push_back(&array);
  return arrays;
}

/// Returns the field of a page that shows an array. Its rows are in the order of the page. The range of its
/// values is still empty: survey() finds it.
ReplayField field_of(const RecordingReader& recording, const Array& array,
                     std::span<const std::uint32_t> order) {
  constexpr std::uint32_t k_none = std::numeric_limits<std::uint32_t>::max();
  const std::vector<std::uint8_t> has = recording.has(array);
  std::vector<std::uint32_t> places(order.size(),
                                    k_none);  // for each row of the recording, its row in the array
  for (std::size_t r = 0; r < array.bodies.size(); ++r)
    if (has[r] != 0) places[array.bodies[r]] = static_cast<std::uint32_t>(r);
  ReplayField field{.array = &array};
  for (std::uint32_t row = 0; row < order.size(); ++row) {
    if (places[order[row]] == k_none) continue;
    if (field.runs.empty() || field.runs.back().first + field.runs.back().count != row)
      field.runs.push_back({row, 0});
    ++field.runs.back().count;
    field.rows.push_back(places[order[row]]);
  }
  field.min = std::numeric_limits<double>::infinity();
  field.max = -field.min;
  return field;
}

/// Returns the smallest number of the form 1, 2 or 5 times a power of ten that is at least x. x must be above
/// 0.
double round_step(double x) {
  double power = 1;
  while (power < x && power < 1e300) power *= 10;
  while (power >= x * 10 && power > 1e-300) power /= 10;  // now x <= power < 10 x, apart from rounding
  if (power / 5 >= x) return power / 5;
  return power / 2 >= x ? power / 2 : power;
}

/// Sets the rounding step of a field and the number of steps, from the range of its values.
void choose_steps(ReplayField& field) {
  if (field.min > field.max) {  // the field has no finite number in any frame
    field.min = field.max = 0;
    return;
  }
  const Element element = field.array->field.element;
  const double span = field.max - field.min;
  const bool is_whole = element != Element::f64 && element != Element::f32;
  if (span == 0) return;
  if (is_whole && span <= k_most_whole) {
    field.steps = static_cast<std::uint32_t>(span);
    return;
  }
  const std::string& unit = field.array->field.unit;
  const double finest = unit == "m" || unit == "rad" ? 0.001 : 0.0;
  field.step = is_joint(*field.array) && finest > 0 ? finest : std::max(round_step(span / k_levels), finest);
  if (span / field.step > k_most_whole) field.step = round_step(span / k_most_whole);
  field.min = std::floor(field.min / field.step) * field.step;  // so that the page shows round numbers
  field.steps = static_cast<std::uint32_t>(std::ceil((field.max - field.min) / field.step));
}

/// Reads all frames and finds the smallest and the largest number of each field.
void survey(const RecordingReader& recording, ReplayPlan& plan) {
  FrameReader reader(recording);
  std::vector<double> values;
  const auto frames = recording.frames();
  for (const std::size_t axis : {std::size_t{0}, std::size_t{1}})
    for (std::size_t frame = 0; frame < frames; ++frame) {
      reader.read(*plan.pose[axis], frame, values);
      for (const double x : values) {
        if (!std::isfinite(x)) continue;
        plan.bounds.min[static_cast<Eigen::Index>(axis)] =
            std::min(plan.bounds.min[static_cast<Eigen::Index>(axis)], x);
        plan.bounds.max[static_cast<Eigen::Index>(axis)] =
            std::max(plan.bounds.max[static_cast<Eigen::Index>(axis)], x);
      }
    }
  for (ReplayField& field : plan.fields) {
    const std::size_t columns = field.array->field.columns;
    for (std::size_t frame = 0; frame < frames; ++frame) {
      reader.read(*field.array, frame, values);
      for (const std::uint32_t row : field.rows)
        for (std::size_t column = 0; column < columns; ++column) {
          const double x = values[row * columns + column];
          if (!std::isfinite(x)) continue;
          field.min = std::min(field.min, x);
          field.max = std::max(field.max, x);
        }
    }
    choose_steps(field);
  }
}

/// Whether robots have joints whose displacements were not recorded.
bool lacks_joints(const ReplayPlan& plan, const RecordingReader& recording) {
  std::vector<std::uint8_t> seen(plan.scene.types.size(), 0);
  for (const std::uint32_t row : plan.order) seen[plan.scene.bodies[recording.ids()[row]].type] = 1;
  for (std::size_t t = 0; t < seen.size(); ++t)
    for (const RecordedScene::Joint& joint : plan.scene.types[t].joints)
      if (seen[t] != 0 && std::ranges::none_of(plan.fields, [&joint](const ReplayField& field) {
            return field.array->component == joint.component;
          }))
        return true;
  return false;
}

/// If no height ever changes, stores the heights once in the plan and drops the array of z.
void survey_heights(const RecordingReader& recording, ReplayPlan& plan) {
  plan.heights.assign(plan.order.size(), 0.0);
  const Array* const z = plan.pose[3];
  if (!z) return;
  FrameReader reader(recording);
  std::vector<double> first;
  std::vector<double> now;
  reader.read(*z, 0, first);
  for (std::size_t frame = 1; frame < recording.frames(); ++frame) {
    reader.read(*z, frame, now);
    for (std::size_t row = 0; row < now.size(); ++row) {
      if (!std::isfinite(first[row])) first[row] = now[row];
      if (std::isfinite(now[row]) && now[row] != first[row]) return;
    }
  }
  for (std::size_t row = 0; row < plan.order.size(); ++row)
    if (std::isfinite(first[plan.order[row]])) plan.heights[row] = first[plan.order[row]];
  plan.pose[3] = nullptr;
}

}  // namespace

/// Reads a frame of an array and, if the frame before it was the last one that was read, frames after it.
void FrameReader::load(const Array& array, std::size_t frame) {
  const std::size_t frame_bytes = array.bodies.size() * array.row_bytes();
  const std::size_t most = 1 + k_block_bytes / (1 + frame_bytes + recording_.ids().size());
  const bool is_next = array_ == &array && frame == first_ + count_;
  array_ = &array;
  first_ = frame;
  count_ = is_next ? std::min({2 * count_, most, recording_.frames() - frame}) : 1;
  bytes_.resize(count_ * frame_bytes);
  recording_.read(array, frame, bytes_);
  alive_ = recording_.alive(frame, count_);
}

void FrameReader::read(const Array& array, std::size_t frame, std::vector<double>& into) {
  if (array_ != &array || frame < first_ || frame >= first_ + count_) load(array, frame);
  const std::size_t frame_bytes = bytes_.size() / count_;
  const std::size_t bodies = recording_.ids().size();
  const auto bytes = std::span(bytes_).subspan((frame - first_) * frame_bytes, frame_bytes);
  const auto alive = std::span(alive_).subspan((frame - first_) * bodies, bodies);
  into.resize(array.bodies.size() * array.field.columns);
  engine::to_doubles(array.field.element, bytes, into);
  if (array.field.element == Element::f64)
    for (double& x : into)
      if (!(std::abs(x) <= k_endless)) x = std::numeric_limits<double>::quiet_NaN();
  if (std::ranges::find(alive, std::uint8_t{0}) == alive.end()) return;
  for (std::size_t row = 0; row < array.bodies.size(); ++row)
    if (alive[array.bodies[row]] == 0)
      std::fill_n(into.begin() + static_cast<std::ptrdiff_t>(row * array.field.columns), array.field.columns,
                  std::numeric_limits<double>::quiet_NaN());
}

ReplayPlan plan_replay(const RecordingReader& recording, std::span<const std::string> fields) {
  ReplayPlan plan;
  plan.pose = {find_pose(recording, "x"), find_pose(recording, "y"), find_pose(recording, "heading"),
               find_pose(recording, "z")};
  if (!plan.pose[0] || !plan.pose[1] || !plan.pose[2])
    refuse(recording,
           "has no poses, so there is nothing to show: record the run with --record-fields pose,...");
  if (recording.frames() == 0)
    refuse(recording, "has no complete frame, so there is nothing to show: record the run again");
  if (recording.ids().empty()) refuse(recording, "has only static bodies, so there is nothing to show");
  plan.scene = recorded_scene(recording);

  plan.order.resize(recording.ids().size());
  std::iota(plan.order.begin(), plan.order.end(), 0u);
  const auto type_of = [&](std::uint32_t row) { return plan.scene.bodies[recording.ids()[row]].type; };
  std::ranges::stable_sort(plan.order, {}, type_of);
  for (const Array* array : chosen_arrays(recording, fields))
    plan.fields.push_back(field_of(recording, *array, plan.order));

  plan.at_rest = lacks_joints(plan, recording);
  survey(recording, plan);
  survey_heights(recording, plan);
  if (plan.bounds.empty())
    plan.bounds = Box::around(Vec2::Zero(), 1);  // no robot is in the world in any frame
  std::vector<std::uint8_t> moves(plan.scene.bodies.size(), 0);
  for (const std::uint32_t id : recording.ids()) moves[id] = 1;
  double robot_radius = 0;
  for (std::size_t b = 0; b < plan.scene.bodies.size(); ++b) {
    const RecordedScene::Body& body = plan.scene.bodies[b];
    const engine::FrameType& look = plan.scene.types[body.type].look;
    if (moves[b] != 0) {
      robot_radius = std::max(robot_radius, look.radius);
      continue;
    }
    for (const engine::FrameShape& shape : look.shapes)
      for (const Ring& ring : placed(shape.solid, body.pose_world_body).contours)
        plan.bounds.extend(troupe::bounds(ring));
  }
  plan.bounds = plan.bounds.expanded(robot_radius);
  return plan;
}

}  // namespace troupe::worldio
