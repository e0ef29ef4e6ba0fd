#include "models/controllers/radio_flocking.hpp"

#include "base/geometry.hpp"
#include "base/math.hpp"
#include "engine/kinds/controller.hpp"
#include "models/controllers/beams.hpp"
#include "models/controllers/device_choice.hpp"
#include "sensors/radio.hpp"

#include <algorithm>
#include <vector>

namespace troupe::models {
namespace {

using sensors::RadioPort;

// Weights. The mean heading has the weight 1.
constexpr double k_push = 3;       // repulsion by an obstacle at contact
constexpr double k_repulsion = 5;  // greatest repulsion by another robot
// Greatest attraction by another robot. It is small, so that many distant robots do not outweigh a near one.
constexpr double k_attraction = 0.3;

constexpr double k_least_range = 1e-3;  // m: replaces smaller distances, so that no divisor is 0
constexpr double k_backwards = 0.5;     // greatest speed backwards, as a fraction of the speed

struct RadioFlocking {
  struct Params {
    double speed = 0.2;
    double distance = 0.6;
    double spacing_weight = 1;
    double gain = 1;
    double clearance = 0.8;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      using enum engine::Unit;
      d.member<&Params::speed>("speed", meters_per_second, at_least(0), "forward speed");
      d.member<&Params::distance>("distance", meters, above(0),
                                  "distance that the robot tries to keep from the robots that it hears");
      d.member<&Params::spacing_weight>(
          "spacing_weight", at_least(0),
          "weight, in the vector sum that the robot follows, of the term that keeps the distance to other "
          "robots; the term of their mean heading has the weight 1");
      d.member<&Params::gain>(
          "gain", per_second, at_least(0),
          "turn rate per radian of the angle from the heading to the vector sum that the robot follows");
      d.member<&Params::clearance>("clearance", meters, at_least(0),
                                   "obstacles that the ranger sees nearer than this repel the robot");
    }
  };
  Params params;
  double radio_heading = 0;  // heading of the radio in the frame of the drive, rad
  std::vector<Beam> beams;

  Result<std::vector<std::size_t>> choose(std::span<const engine::DeviceInfo> devices,
                                          std::vector<bool>& claimed) {
    DeviceChoice choice(devices, claimed);
    if (const Result<> radio = choice.take_radio(sizeof(float)); !radio) return radio.error();
    radio_heading = devices[choice.chosen().front()].pose.heading;
    if (choice.take([](const engine::DeviceInfo& device) { return !device.prepared.bearings.empty(); }))
      beams = beams_of(devices[choice.chosen().back()]);
    return choice.chosen();
  }

  void operator()(const engine::Percept& percept, Random&, engine::Actions& actions) const {
    const RadioPort radio(percept.devices[0], actions.devices[0]);
    const double own = percept.estimate.heading;
    Vec2 headings(1, 0);
    Vec2 spacing(0, 0);
    std::size_t heard = 0;
    for (std::size_t i = 0; i < radio.count(); ++i) {
      const RadioPort::Message message = radio[i];
      float heading = 0;
      if (!message.read(heading)) continue;
      ++heard;
      const SinCos theirs = sincos(heading - own);
      headings += Vec2(theirs.cos, theirs.sin);
      const SinCos way = sincos(radio_heading + message.bearing);
      const double near = params.distance / std::max<double>(message.range, k_least_range);
      spacing += std::clamp(1 - near * near, -k_repulsion, k_attraction) * Vec2(way.cos, way.sin);
    }
    Vec2 aim = headings.squaredNorm() > 0 ? Vec2(headings / headings.norm()) : Vec2(1, 0);
    if (heard > 0) aim += params.spacing_weight / static_cast<double>(heard) * spacing;
    aim += push(percept);
    const double angle = aim == Vec2::Zero() ? 0 : atan2(aim.y(), aim.x());
    actions.command = {params.speed * std::max(-k_backwards, cos(angle)), 0, params.gain * angle};
    radio.say(static_cast<float>(own));
  }

  /// Repulsion by obstacles, robot frame. Each beam whose reading is below `clearance` gives a vector of
  /// the length k_push (1 - reading / clearance), opposite to the beam. Returns the mean of these vectors.
  Vec2 push(const engine::Percept& percept) const {
    Vec2 sum(0, 0);
    std::size_t count = 0;
    for (const Beam& beam : beams) {
      const double range = percept.ranges(1)[beam.reading];
      if (!(range < params.clearance)) continue;
      sum -= (1 - range / params.clearance) * Vec2(beam.direction.cos, beam.direction.sin);
      ++count;
    }
    return count > 0 ? Vec2(k_push / static_cast<double>(count) * sum) : sum;
  }
};

}  // namespace

engine::ControllerKind radio_flocking_controller() {
  return engine::make_controller_kind<RadioFlocking>(
      "radio_flocking",
      "flock by radio: broadcast the heading, turn to the mean of the headings received, keep a distance");
}

}  // namespace troupe::models
