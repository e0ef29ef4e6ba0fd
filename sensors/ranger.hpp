#pragma once

#include "engine/kinds.hpp"
#include "engine/sensor_params.hpp"

#include <cstdint>
#include <memory>

namespace troupe::sensors {

/// A ranger: transducers that each cast a fan of beams at one height and report the distance along each beam
/// to the first surface.
/// state   `ranges` [float32, beams], m: exactly range_max if nothing is hit. The beams of a transducer run
///         counter-clockwise from -fov/2 to +fov/2, both included (a single sample: straight ahead);
///         transducers are in the order of the parameters. With `intensity` also `intensities`: the
///         ranger_return of the surface hit, 0 for none.
/// noise   as the parameters of the transducers say (ranger_noise.hpp): of readings below range_max, and of
///         the headings of beams; a reading of exactly range_max stays as it is
/// hits    every surface with ranger_return >= 0 whose closed z interval contains the height of the beam,
///         from both sides, except those of the robot itself
/// ties    of two surfaces at one distance the larger intensity is reported
/// source  inverse-depth projection, partition/ranging.hpp; in worlds with the grid engine a walk through
///         cells, partition/ray_grid.hpp
engine::DeviceKind ranger_kind();

struct RangerBeams;

/// The implementation of a ranger (engine/device_kind.hpp), for kinds that extend it: these have its Params
/// as a part of their own.
struct Ranger {
  using Params = engine::RangerParams;  ///< its parameters

  std::shared_ptr<const RangerBeams> beams;  ///< the beams that it casts

  /// Returns the beams and percepts of a ranger; `data` is a Ranger.
  static engine::DeviceKind::Prepared prepare(const Params& params, const Pose& pose_body_sensor);
  /// Writes the readings of every row of the batch. Returns the number of rays cast.
  std::uint64_t sense(const engine::DeviceBatch& batch) const;
};

}  // namespace troupe::sensors
