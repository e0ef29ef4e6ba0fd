#pragma once

#include "base/math.hpp"
#include "base/pose.hpp"
#include "engine/kinds/controller_kind.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace troupe::models {

/// Direction and start point of one beam of a ranger (range sensor). They are in the frame of the drive that
/// the controller commands: x points straight ahead, y to the left.
struct Beam {
  std::size_t reading = 0;     ///< index of the reading of this beam in Percept::ranges()
  std::size_t transducer = 0;  ///< index of its transducer (fan of beams) in the ranger
  double bearing = 0;          ///< bearing, rad, counter-clockwise from straight ahead, in [-pi, pi]
  SinCos direction;            ///< cosine and sine of the bearing
  Vec2 origin = Vec2::Zero();  ///< point at which the beam starts, m
  float range_max = 0;         ///< greatest reading of the beam, m
};

/// Returns the beams of the ranger (range sensor) `device`, in the order of its readings. If the ranger is
/// mounted on a joint (a part that a device moves), the result is computed for the pose of the joint in the
/// world file, and is wrong after the joint has moved. The result is empty if `device` is not a ranger.
inline std::vector<Beam> beams_of(const engine::DeviceInfo& device) {
  const engine::DeviceKind::Prepared& layout = device.prepared;
  const Transform pose_drive_sensor(device.pose);
  std::vector<Beam> beams(layout.bearings.size());
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const auto next = std::ranges::upper_bound(layout.transducers, i, {}, &engine::Transducer::first);
    const auto after = static_cast<std::size_t>(next - layout.transducers.begin());
    const std::size_t transducer = after > 0 ? after - 1 : 0;
    const double heading = device.pose.heading + layout.bearings[i];
    const bool has_transducer = transducer < layout.transducers.size();
    beams[i] = {
        .reading = i,
        .transducer = transducer,
        .bearing = wrap_angle(heading),
        .direction = sincos(heading),
        .origin = has_transducer
                      ? pose_drive_sensor * layout.transducers[transducer].pose_sensor_transducer.position()
                      : pose_drive_sensor.position,
        .range_max = has_transducer ? static_cast<float>(layout.transducers[transducer].range_max) : 0.0f};
  }
  return beams;
}

}  // namespace troupe::models
