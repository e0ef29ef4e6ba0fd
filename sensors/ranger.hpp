#pragma once

#include "engine/kinds.hpp"
#include "engine/sensor_params.hpp"

#include <cstdint>
#include <memory>

namespace troupe::sensors {

/// A ranger: transducers that each cast a fan of beams at one height and report the distance along each to
/// the first surface.
/// state   `ranges` [float32, beams], m: exactly range_max where nothing is met; beams of a transducer run
///         counter-clockwise from -fov/2 to +fov/2, both included (one sample: straight ahead); transducers
///         follow one another in their order. With `intensity`, `intensities` beside them: the ranger_return
///         of what was met, 0 for nothing.
/// noise   as the transducers ask for (ranger_noise.hpp): of the readings of what is met, and of the beams'
///         headings; nothing met stays exactly range_max
/// meets   every surface with ranger_return >= 0 whose closed z interval holds the beam's height, from both
///         sides, but none of the robot's own
/// ties    two surfaces at one distance: the larger intensity is reported
/// source  inverse-depth projection, partition/ranging.hpp; in worlds that ask for the grid engine a walk
///         through cells, partition/ray_grid.hpp
engine::DeviceKind ranger_kind();

struct RangerBeams;

/// What a ranger is made of (engine/device_kind.hpp): for kinds that make more of it, which have its Params
/// as a part of their own.
struct Ranger {
  using Params = engine::RangerParams;  ///< its parameters

  std::shared_ptr<const RangerBeams> beams;  ///< what it casts

  /// What the kind declares: its beams and percepts; `data` is a Ranger.
  static engine::DeviceKind::Prepared prepare(const Params& params, const Pose& pose_body_sensor);
  /// Writes the readings of every row of the batch. Returns the rays it cast.
  std::uint64_t sense(const engine::DeviceBatch& batch) const;
};

}  // namespace troupe::sensors
