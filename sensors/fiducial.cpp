#include "sensors/fiducial.hpp"

#include "engine/kinds/make_device_kind.hpp"
#include "engine/observing/frame.hpp"
#include "engine/observing/lint_view.hpp"
#include "engine/sensing/visibility_query.hpp"
#include "sensors/heights.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <tuple>
#include <vector>

namespace troupe::sensors {
namespace {

using engine::DeviceBatch;
using engine::DeviceKind;
using engine::Element;
using engine::PartSpec;
using engine::SensingView;
using engine::TypeSpec;

constexpr double k_rounding = 1e-9;  // margin for cosines, above the rounding errors of sines and cosines

struct FiducialFinder {
  struct Params {
    double range_min = 0;
    bool apply_range_min = false;
    double range_max = 8;
    double range_max_id = 5;
    double fov = k_pi;
    std::int32_t key = 0;
    bool ignore_zloc = false;
    std::uint32_t most_targets = 16;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      using enum engine::Unit;
      constexpr double k_farthest = 10000;  // m
      d.member<&Params::range_min>(
          "range_min", meters, within(0, k_farthest), used_if("apply_range_min", "true"),
          "if apply_range_min is true, targets with an origin nearer than this are not found");
      d.member<&Params::apply_range_min>("apply_range_min",
                                         "true: targets nearer than range_min are not found");
      d.member<&Params::range_max>("range_max", meters, above(0), at_most(k_farthest),
                                   "only targets with an origin nearer than this are found");
      d.member<&Params::range_max_id>(
          "range_max_id", meters, within(0, k_farthest),
          "at this distance or farther a target is found, but its `id` is reported as 0");
      d.member<&Params::fov>(
          "fov", radians, within(0, 2 * k_pi),
          "field of view: half of it is to the left and half to the right of the finder's heading");
      d.member<&Params::key>("key", "only models with this `fiducial_key` are found");
      d.member<&Params::ignore_zloc>(
          "ignore_zloc", "true: targets that are wholly above or below the finder's height are found too");
      d.member<&Params::most_targets>(
          "most_targets", within(1, 1000),
          "greatest number of targets that the readings list, the nearest first; `count` counts all targets "
          "in sight");
    }
  };

  Params params;
  Pose pose_body_sensor;
  Vec2 ahead = Vec2::UnitX();  // axis of view, body frame
  double range_min = 0;        // nearer targets are not found
  double least_cos = 0;        // cosine of half the field of view

  static DeviceKind::Prepared prepare(const Params& params, const Pose& pose_body_sensor);
  /// Returns an error if the finder cannot find anything.
  Result<> bind_part(const TypeSpec&, std::uint32_t) const;
  std::uint64_t sense(const DeviceBatch& batch) const;

  static constexpr engine::FrameLayer layer = engine::FrameLayer::sights;
  void draw(const engine::DeviceView& view, engine::Frame& frame) const;
  void lint(const engine::LintView& view) const;
};

/// A model in sight.
struct Target {
  double range = 0;
  BodyId body;
  std::uint32_t part = 0;
  double bearing = 0;
  const PartSpec* spec = nullptr;
  Pose pose_world_part;
};

/// Finds the targets of finders. Each thread keeps one object of this class, which keeps its buffers, so that
/// only the first searches allocate memory.
class Search {
 public:
  /// Returns the targets that the finder on the body with the row (index in the state tables) `own` finds,
  /// the nearest first; valid until the next call. Adds the number of rays that it casts to rays(). mount:
  /// the frame in which the finder's pose is given.
  std::span<const Target> find(const SensingView& view, const FiducialFinder& finder, Row own,
                               const engine::Mount& mount) {
    view_ = &view;
    finder_ = &finder;
    sensor_ = compose(mount, finder.pose_body_sensor);
    ahead_ = mount.transform.rotation * finder.ahead;
    found_.clear();
    lines_.clear();
    constexpr std::size_t k_dense_crowd = 1024;  // candidates
    const std::size_t room = std::min(view.rows(), k_dense_crowd);
    found_.reserve(room);
    lines_.reserve(room);
    first_.resize(std::max(first_.size(), room));

    visible_.stand(view, sensor_.position(), finder.params.range_max, own, sensor_.z);
    const std::vector<TypeSpec>& types = view.spec().types;
    const Box box = Box::around(sensor_.position(), finder.params.range_max);
    view.fixed_targets().for_each_near(box, [&](const engine::FixedTargets::Target& target) {
      const TypeSpec& type = view.spec().type(target.body);
      consider(target.body, target.part, type.parts[target.part], target.pose_world_part, 0);
    });
    for (const std::uint32_t r : visible_.bodies()) {
      const Row row(r);
      const engine::BodyType& type = view.type(row);
      for (const std::uint32_t part : type.targets) {
        const PartSpec& spec = types[static_cast<std::size_t>(&type - view.types().data())].parts[part];
        consider(view.body(row), part, spec, compose(view.mount(row, spec.joint), spec.pose_body_part),
                 2 * view.radius(row));
      }
    }
    keep_seen();
    std::ranges::sort(found_, {}, [](const Target& t) { return std::tuple(t.range, t.body, t.part); });
    return found_;
  }
  std::uint64_t rays() const { return rays_; }
  const Pose& sensor() const { return sensor_; }
  std::int32_t fiducial_of(const Target& target) const {
    return engine::fiducial_of(view_->spec(), target.body, target.part);
  }

 private:
  /// Adds a model to the candidates if its fiducial_key is that of the finder and its origin is within range
  /// and field of view. extent: upper bound on the distance of the model's surfaces from its origin, m; 0 if
  /// unknown.
  void consider(BodyId body, std::uint32_t part, const PartSpec& spec, const Pose& pose_world_part,
                double extent) {
    if (spec.returns.fiducial_key != finder_->params.key) return;
    const Vec2 way = pose_world_part.position() - sensor_.position();
    const double range = way.norm();
    if (!(range < finder_->params.range_max) || range < finder_->range_min) return;
    if (way.dot(ahead_) < (finder_->least_cos - k_rounding) * range) return;  // saves most calls of atan2()
    const double bearing = range > 0 ? wrap_angle(atan2(way.y(), way.x()) - sensor_.heading) : 0;
    if (std::abs(bearing) > finder_->params.fov / 2) return;
    const Vec2 direction = range > 0 ? Vec2(way / range) : Rotation(sensor_.heading) * Vec2::UnitX();
    const double length =
        extent > 0 ? std::min(finder_->params.range_max, range + extent) : finder_->params.range_max;
    lines_.push_back({direction, length});
    found_.push_back({range, body, part, bearing, &spec, pose_world_part});
  }

  /// Casts a ray towards each candidate and removes the candidates that are not in sight, see
  /// fiducial_kind().
  void keep_seen() {
    rays_ += lines_.size();
    first_.resize(std::max(first_.size(), lines_.size()));
    visible_.first_met(lines_, std::span(first_).first(lines_.size()));
    std::size_t kept = 0;
    for (std::size_t i = 0; i < found_.size(); ++i) {
      const engine::RayHit& first = first_[i];
      const Target& target = found_[i];
      const bool is_itself = first.met() && first.body == target.body && first.part == target.part;
      const bool passed_by = finder_->params.ignore_zloc && (!first.met() || first.range_m >= target.range);
      if (is_itself || passed_by) found_[kept++] = target;
    }
    found_.resize(kept);
  }

  const SensingView* view_ = nullptr;
  const FiducialFinder* finder_ = nullptr;
  Pose sensor_;  // world frame
  Vec2 ahead_ = Vec2::UnitX();
  engine::VisibilityQuery visible_;
  std::vector<Target> found_;             // candidates, until keep_seen()
  std::vector<engine::SightLine> lines_;  // per candidate: the ray towards it
  std::vector<engine::RayHit> first_;     // per candidate: the first surface along that ray
  std::uint64_t rays_ = 0;
};

void write(const Search& search, const FiducialFinder& finder, std::span<const Target> targets,
           engine::StateTable& state, std::size_t slot) {
  std::uint32_t& count = state.cell<std::uint32_t>(slot, k_fiducial_count)[0];
  // Entries after those of the previous tick are already 0.
  const std::size_t last =
      std::min<std::size_t>(finder.params.most_targets, std::max<std::size_t>(targets.size(), count));
  count = static_cast<std::uint32_t>(targets.size());
  for (std::size_t i = 0; i < last; ++i) {
    const bool is_there = i < targets.size();
    const Target target = is_there ? targets[i] : Target();
    Eigen::Vector3d size = Eigen::Vector3d::Zero();
    std::int32_t id = 0;
    double heading = 0;
    if (is_there) {
      const PartSpec& part = *target.spec;
      size = part.size;
      id = target.range < finder.params.range_max_id ? search.fiducial_of(target) : 0;
      heading = wrap_angle(target.pose_world_part.heading - search.sensor().heading);
    }
    const auto set = [&](std::size_t field, double value) {
      state.cell<float>(slot, field)[i] = static_cast<float>(value + 0.0);  // + 0.0 turns -0 into 0
    };
    state.cell<std::int32_t>(slot, k_fiducial_id)[i] = id;
    state.cell<std::uint32_t>(slot, k_fiducial_body)[i] = is_there ? target.body.value : 0;
    set(k_fiducial_range, target.range);
    set(k_fiducial_bearing, target.bearing);
    set(k_fiducial_heading, heading);
    const auto sizes = state.cell<float>(slot, k_fiducial_size).subspan(3 * i, 3);
    for (std::size_t k = 0; k < 3; ++k) sizes[k] = static_cast<float>(size[static_cast<Eigen::Index>(k)]);
    const Pose& pose = target.pose_world_part;
    const auto poses = state.cell<double>(slot, k_fiducial_pose).subspan(4 * i, 4);
    poses[0] = pose.x + 0.0;
    poses[1] = pose.y + 0.0;
    poses[2] = pose.z + 0.0;
    poses[3] = pose.heading + 0.0;
  }
}

DeviceKind::Prepared FiducialFinder::prepare(const Params& params, const Pose& pose_body_sensor) {
  const std::uint32_t n = params.most_targets;
  return {
      .data = FiducialFinder{.params = params,
                             .pose_body_sensor = pose_body_sensor,
                             .ahead = Rotation(pose_body_sensor.heading) * Vec2::UnitX(),
                             .range_min = params.apply_range_min ? params.range_min : 0,
                             .least_cos = cos(params.fov / 2)},
      .percepts = {{"count", Element::u32, 1, "", "number of targets in sight"},
                   {"id", Element::i32, n, "", "fiducial_return of each target; 0: too far to read"},
                   {"body", Element::u32, n, "", "id of the body of each target"},
                   {"range", Element::f32, n, "m", "horizontal distance to the origin of each target"},
                   {"bearing", Element::f32, n, "rad", "bearing of the origin of each target, sensor frame"},
                   {"heading", Element::f32, n, "rad", "heading of each target, sensor frame"},
                   {"size", Element::f32, 3 * n, "m", "size of each target: x, y, z"},
                   {"pose", Element::f64, 4 * n, "m, rad",
                    "pose of each target: x, y, z, heading, world frame"}},
      .reach_m = pose_body_sensor.position().norm() + params.range_max};
}

Result<> FiducialFinder::bind_part(const TypeSpec&, std::uint32_t) const {
  if (range_min < params.range_max) return {};
  return Error{
      fmt::format("has a range_min of {:g} m, which must be below its range_max of {:g} m, because "
                  "apply_range_min is true",
                  params.range_min, params.range_max)};
}

std::uint64_t FiducialFinder::sense(const DeviceBatch& batch) const {
  thread_local const auto search = std::make_unique<Search>();
  const std::uint64_t rays_before = search->rays();
  for (std::size_t i = 0; i < batch.rows.size(); ++i) {
    // The readings of a robot take about a kilobyte. They are prefetched while the finder searches.
    __builtin_prefetch(batch.state.cell<std::uint32_t>(batch.slot(i), k_fiducial_count).data(), 1);
    write(*search, *this, search->find(batch.view, *this, batch.rows[i], batch.mount(i)), batch.state,
          batch.slot(i));
  }
  return search->rays() - rays_before;
}

void FiducialFinder::draw(const engine::DeviceView& view, engine::Frame& frame) const {
  const std::span<const double> poses = view.state.cell<double>(view.slot, k_fiducial_pose);
  const std::size_t count =
      std::min<std::size_t>(view.state.cell<std::uint32_t>(view.slot, k_fiducial_count)[0], poses.size() / 4);
  for (std::size_t k = 0; k < count; ++k)
    frame.sights.push_back({view.body, view.at(0, 0, 0), {poses[4 * k], poses[4 * k + 1], poses[4 * k + 2]}});
}

/// The marked parts of all bodies, by their fiducial_key.
struct Marks {
  struct OfKey {
    Heights heights;
    std::vector<std::uint32_t> types;      // types of bodies that have such a mark; each once
    std::vector<std::uint32_t> on_joints;  // types of bodies that have such a mark on a joint; each once
  };
  std::map<std::int32_t, OfKey> of_key;

  explicit Marks(const engine::LintWorld& world) {
    for (std::uint32_t t = 0; t < world.types.size(); ++t)
      for (const PartSpec& part : world.spec.types[t].parts) {
        if (part.returns.fiducial == 0 || world.bodies[t] == 0) continue;
        OfKey& marks = of_key[part.returns.fiducial_key];
        for (const Solid& solid : part.solids)
          for (const auto& [z, count] : world.levels[t]) marks.heights.add(solid.z.shifted(z), count);
        if (marks.types.empty() || marks.types.back() != t) marks.types.push_back(t);
        if (part.joint != engine::k_rigid && (marks.on_joints.empty() || marks.on_joints.back() != t))
          marks.on_joints.push_back(t);
      }
    for (auto& [key, marks] : of_key) marks.heights.sum();
  }
};

/// Warns if no other body has a mark with the key of the finder, or if all such marks are at other heights
/// than the finder. Heights are not compared if the finder or a mark is on a joint, which may move it to
/// another height.
void FiducialFinder::lint(const engine::LintView& view) const {
  if (view.is_set({"key", "ignore_zloc"})) return;
  const engine::DeviceSpec& finder = view.device_spec();
  const std::string beginning = engine::sees_nothing_text(finder.name, view.type_spec().name);
  const auto& all = view.world.shared<Marks>().of_key;
  const auto marks = all.find(params.key);
  if (marks == all.end() || !view.has_other_of(marks->second.types))
    return view.warn(
        engine::LintTopic::sight,
        beginning + fmt::format("no other body with a fiducial_return has the fiducial_key of the finder, {}",
                                params.key));
  if (params.ignore_zloc || finder.joint != engine::k_rigid || view.has_other_of(marks->second.on_joints))
    return;
  std::vector<ZInterval> own;
  for (const PartSpec& part : view.type_spec().parts)
    if (part.returns.fiducial != 0 && part.returns.fiducial_key == params.key)
      for (const Solid& solid : part.solids) own.push_back(solid.z);
  if (const std::string why = why_at_no_height(view,
                                               {.all = marks->second.heights,
                                                .own = own,
                                                .none = "no other body with a fiducial_return",
                                                .name = "bodies with a fiducial_return"},
                                               {&finder.pose_body_device.z, 1});
      !why.empty())
    view.warn(engine::LintTopic::sight, beginning + why);
}

}  // namespace

DeviceKind fiducial_kind() {
  return engine::make_device_kind<FiducialFinder>(
      "fiducial", "finds models in sight that have a `fiducial_return`, and reads their ids and poses");
}

}  // namespace troupe::sensors
