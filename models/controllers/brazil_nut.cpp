#include "models/controllers/brazil_nut.hpp"

#include "base/geometry.hpp"
#include "base/math.hpp"
#include "engine/kinds/controller.hpp"
#include "models/controllers/decisions.hpp"
#include "models/controllers/device_choice.hpp"
#include "sensors/light_sensor.hpp"
#include "sensors/radio.hpp"

#include <algorithm>
#include <vector>

namespace troupe::models {
namespace {

using sensors::k_light_brightness;
using sensors::RadioPort;

constexpr std::size_t k_least_directions = 3;  // fewer cannot give the direction of a light

struct BrazilNut {
  struct Params {
    double radius = 0;
    double speed = 0.1;
    double gain = 2;
    double taxis = 0.6;
    double noise = 1;
    double push = 8;
    double shake = 1;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      using enum engine::Unit;
      d.member<&Params::radius>("radius", meters, required, above(0), at_most(1000),
                                "radius of the disc that the robot behaves like: robots keep apart by about "
                                "the sum of their radii");
      d.member<&Params::speed>("speed", meters_per_second, at_least(0), "greatest forward speed");
      d.member<&Params::gain>(
          "gain", per_second, at_least(0),
          "turn rate per radian of the angle from the heading to the vector sum that the robot follows");
      d.member<&Params::taxis>(
          "taxis", at_least(0),
          "weight of the unit vector towards the light in the vector sum that the robot follows");
      d.member<&Params::noise>(
          "noise", at_least(0),
          "weight of a unit vector of random direction in the vector sum that the robot follows");
      d.member<&Params::push>("push", at_least(0),
                              "largest weight of the repulsion by another robot, in the vector sum that the "
                              "robot follows; the weight falls linearly with the distance between the "
                              "robots, from this value at 0 m to 0 at the sum of both radii");
      d.member<&Params::shake>("shake", seconds, within(0, 1e6),
                               "time after which the robot chooses a new random direction");
    }
  };
  /// Durations are in decisions; a decision is one call of the controller.
  struct Memory {
    std::uint32_t updates_left = 0;  ///< decisions until the robot chooses a new random direction
    double heading = 0;              ///< present random direction, rad, in the frame of the estimated pose
    TROUPE_FIELDS(updates_left, heading)
  };
  static constexpr std::size_t k_light = 0, k_radio = 1;

  Params params;
  double radio_heading = 0;        // heading of the radio in the frame of the drive, rad
  std::vector<SinCos> directions;  // directions of the light sensor's readings, in the frame of the drive

  Result<std::vector<std::size_t>> choose(std::span<const engine::DeviceInfo> devices,
                                          std::vector<bool>& claimed) {
    DeviceChoice choice(devices, claimed);
    std::size_t count = 0;
    const bool has_eye = choice.take([&](const engine::DeviceInfo& device) {
      if (device.kind != "light_sensor") return false;
      count = device.prepared.percepts[k_light_brightness].columns;
      return count >= k_least_directions;
    });
    if (!has_eye) return choice.missing("light_sensor", "needs a light sensor with three directions or more");
    const double heading = devices[choice.chosen().front()].pose.heading;
    for (std::size_t k = 0; k < count; ++k)
      directions.push_back(sincos(heading + 2 * k_pi * static_cast<double>(k) / static_cast<double>(count)));
    if (const Result<> radio = choice.take_radio(sizeof(float)); !radio) return radio.error();
    radio_heading = devices[choice.chosen().back()].pose.heading;
    return choice.chosen();
  }

  void operator()(Memory& memory, const engine::Percept& percept, Random& random,
                  engine::Actions& actions) const {
    const RadioPort radio(percept.devices[k_radio], actions.devices[k_radio]);
    radio.say(static_cast<float>(params.radius));
    if (memory.updates_left == 0) {
      memory.heading = random.uniform(-k_pi, k_pi);
      memory.updates_left = std::max(1u, whole_decisions(params.shake, percept.period_s));
    }
    --memory.updates_left;
    const SinCos shaken = sincos(memory.heading - percept.estimate.heading);
    const Vec2 aim =
        params.taxis * way_to_light(percept) + params.noise * Vec2(shaken.cos, shaken.sin) + repulsion(radio);
    const double angle = aim == Vec2::Zero() ? 0 : atan2(aim.y(), aim.x());
    actions.command = {params.speed * std::min(aim.norm(), 1.0) * cos(angle), 0, params.gain * angle};
  }

  Vec2 way_to_light(const engine::Percept& percept) const {
    const std::span<const float> brightness = percept.devices[k_light].field<float>(k_light_brightness);
    Vec2 sum(0, 0);
    for (std::size_t k = 0; k < directions.size(); ++k)
      sum += static_cast<double>(brightness[k]) * Vec2(directions[k].cos, directions[k].sin);
    const double norm = sum.norm();
    return norm > 0 ? Vec2(sum / norm) : sum;
  }

  Vec2 repulsion(const RadioPort& radio) const {
    Vec2 sum(0, 0);
    for (std::size_t i = 0; i < radio.count(); ++i) {
      const RadioPort::Message message = radio[i];
      float theirs = 0;
      if (!message.read(theirs)) continue;
      const double both = params.radius + std::max<double>(theirs, 0);
      if (message.range >= both) continue;
      const SinCos way = sincos(radio_heading + message.bearing);
      sum -= params.push * (1 - message.range / both) * Vec2(way.cos, way.sin);
    }
    return sum;
  }
};

}  // namespace

engine::ControllerKind brazil_nut_controller() {
  return engine::make_controller_kind<BrazilNut>(
      "brazil_nut",
      "sort by size: robots act as shaken discs that a light attracts and that repel one another");
}

}  // namespace troupe::models
