#include "sensors/light_sensor.hpp"

#include "base/math.hpp"
#include "engine/kinds/make_device_kind.hpp"
#include "engine/observing/lint_view.hpp"
#include "engine/sensing/sensing_view.hpp"
#include "engine/sensing/visibility_query.hpp"
#include "sensors/light_source.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <tuple>
#include <vector>

namespace troupe::sensors {
namespace {

using engine::BodyType;
using engine::CommittedView;
using engine::DeviceKind;
using engine::Element;
using engine::SenseBatch;

struct LightSensor {
  struct Params {
    std::uint32_t directions = 8;
    double range_max = 10;
    bool occlusion = true;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      d.member<&Params::directions>("directions", within(1, 360),
                                    "number of directions: the first is straight ahead, the others follow "
                                    "counter-clockwise at equal angles");
      d.member<&Params::range_max>("range_max", engine::Unit::meters, above(0), at_most(10000),
                                   "lights farther away than this are not seen");
      d.member<&Params::occlusion>("occlusion", "true: lights behind walls and bodies are not seen");
    }
  };

  static constexpr std::array reads{k_lit};

  Params params;
  Pose pose_body_sensor;
  std::vector<SinCos> directions;  // sensor frame

  static DeviceKind::Prepared prepare(const Params& params, const Pose& pose_body_sensor);
  std::uint64_t sense(const SenseBatch& batch) const;
  void lint(const engine::LintView& view) const;
};

/// A light in sight.
struct Seen {
  BodyId body;
  std::size_t device = 0;
  Vec2 way = Vec2::Zero();  // horizontal displacement to the light, sensor frame, m
  double distance = 0;
  double intensity = 0;
};

/// Finds the lights in sight. Each thread keeps one object of this class, which keeps its buffers, so that
/// only the first searches allocate memory.
class Eyes {
 public:
  Eyes() {
    constexpr std::size_t k_room = 256;
    seen_.reserve(k_room);
    lines_.reserve(k_room);
    first_.resize(k_room);
  }

  /// Returns the lights that the sensor on the body with the row (index in the state tables) `own` sees,
  /// sorted by body id and then by device; valid until the next call. Adds the number of rays that it casts
  /// to rays(). mount: the frame in which the sensor's pose is given.
  std::span<const Seen> find(const CommittedView& view, const LightSensor& sensor, Row own,
                             const engine::Mount& mount) {
    seen_.clear();
    lines_.clear();
    const Pose here = compose(mount, sensor.pose_body_sensor);
    const Rotation turned(-here.heading);
    visible_.stand(view, here.position(), sensor.params.range_max, own, here.z);
    for (const std::uint32_t r : visible_.bodies()) {
      const Row row(r);
      const BodyType& type = view.type(row);
      for (std::size_t d = 0; d < type.devices.size(); ++d) {
        const BodyType::Device& device = type.devices[d];
        const LightSource* light = light_source(device.prepared);
        if (light == nullptr || view.percepts(device).as<LightState>(view.slot(row)).lit == 0) continue;
        const Pose there = compose(view.mount(row, device.joint), light->pose_body_light);
        const Vec2 way = there.position() - here.position();
        const double range = way.norm();
        if (range > sensor.params.range_max) continue;
        const double up = there.z - here.z;
        seen_.push_back({view.body(row), d, turned * way, sqrt(range * range + up * up), light->intensity});
        lines_.push_back({range > 0 ? Vec2(way / range) : Vec2::UnitX(), range, row});
      }
    }
    if (sensor.params.occlusion) keep_visible();
    std::ranges::sort(seen_, {}, [](const Seen& seen) { return std::tuple(seen.body, seen.device); });
    return seen_;
  }
  std::uint64_t rays() const { return rays_; }

 private:
  /// Casts a ray towards each light and removes the lights that are hidden. Each ray passes through the body
  /// of its light, so that a wall behind a part of this body hides the light, but the body itself does not.
  /// A light at the place of the sensor is not hidden: its ray has no length, so it hits nothing.
  void keep_visible() {
    rays_ += static_cast<std::uint64_t>(
        std::ranges::count_if(lines_, [](const engine::SightLine& line) { return line.length > 0; }));
    first_.resize(std::max(first_.size(), lines_.size()));
    visible_.first_met(lines_, std::span(first_).first(lines_.size()));
    std::size_t kept = 0;
    for (std::size_t i = 0; i < seen_.size(); ++i)
      if (!first_[i].met()) seen_[kept++] = seen_[i];
    seen_.resize(kept);
  }

  engine::VisibilityQuery visible_;
  std::vector<Seen> seen_;                // candidates, until keep_visible()
  std::vector<engine::SightLine> lines_;  // per candidate: the ray towards it
  std::vector<engine::RayHit> first_;     // per candidate: the first surface along that ray
  std::uint64_t rays_ = 0;
};

DeviceKind::Prepared LightSensor::prepare(const Params& params, const Pose& pose_body_sensor) {
  LightSensor sensor{.params = params, .pose_body_sensor = pose_body_sensor};
  const std::uint32_t n = params.directions;
  for (std::uint32_t k = 0; k < n; ++k) sensor.directions.push_back(sincos(2 * k_pi * k / n));
  return {.data = std::move(sensor),
          .percepts = {{"brightness", Element::f32, n, "", "brightness in each direction"},
                       {"sources", Element::u32, 1, "", "number of lights in sight"}},
          .reach_m = pose_body_sensor.position().norm() + params.range_max,
          .cell_hint_m = 0};
}

std::uint64_t LightSensor::sense(const SenseBatch& batch) const {
  thread_local const auto eyes = std::make_unique<Eyes>();
  const std::uint64_t rays_before = eyes->rays();
  for (std::size_t i = 0; i < batch.rows.size(); ++i) {
    const std::span<const Seen> lights = eyes->find(batch.committed, *this, batch.rows[i], batch.mount(i));
    const auto brightness = batch.state.cell<float>(batch.slot(i), k_light_brightness);
    for (std::size_t k = 0; k < directions.size(); ++k) {
      double sum = 0;
      for (const Seen& light : lights) {
        if (light.distance == 0) continue;
        const double ahead = light.way.x() * directions[k].cos + light.way.y() * directions[k].sin;
        const double d2 = light.distance * light.distance;
        sum += light.intensity * std::max(0.0, ahead / light.distance) / d2;
      }
      brightness[k] = static_cast<float>(sum);
    }
    batch.state.cell<std::uint32_t>(batch.slot(i), k_light_sources)[0] =
        static_cast<std::uint32_t>(lights.size());
  }
  return eyes->rays() - rays_before;
}

/// The types of bodies with a light.
struct LitTypes {
  std::vector<std::uint32_t> types;

  explicit LitTypes(const engine::LintWorld& world) {
    world.for_devices<LightSource>(
        [&](std::uint32_t type, std::size_t, const LightSource&) { types.push_back(type); });
  }
};

/// Warns if no other body has a light.
void LightSensor::lint(const engine::LintView& view) const {
  if (!view.has_other_of(view.world.shared<LitTypes>().types))
    view.warn(engine::LintTopic::light,
              engine::sees_nothing_text(view.device_spec().name, view.type_spec().name) +
                  "no other body has a light, such as a \"blinkenlight\"");
}

}  // namespace

DeviceKind light_sensor_kind() {
  return engine::make_device_kind<LightSensor>(
      "light_sensor", "a ring of light sensors: reads the brightness in several directions");
}

}  // namespace troupe::sensors
