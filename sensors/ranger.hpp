#pragma once

#include "engine/kinds/kinds.hpp"
#include "engine/kinds/sensor_params.hpp"

#include <cstdint>
#include <memory>

namespace troupe::sensors {

/// Returns the implementation of the sensor `ranger`, a range sensor. It has one or more transducers. Each
/// transducer casts a fan of beams at one height and reports the distance along each beam to the first
/// surface.
/// state   `ranges` [float32, beams], m: range_max, rounded to float32, if nothing is hit. The beams of a
///         transducer run counter-clockwise from -fov/2 to +fov/2 about its heading, both included; a single
///         beam points along its heading. Transducers are in the order of the parameters. With `intensity`
///         there is also `intensities` [float32, beams]: the ranger_return (an intensity without unit) of the
///         surface hit, 0 if nothing is hit.
/// noise   The parameters of the transducers define two sorts of noise (ranger_noise.hpp): on readings below
///         range_max, and on the headings of beams. A reading of exactly range_max gets no noise.
/// hits    A beam can hit surfaces with ranger_return >= 0 whose z interval, ends included, contains the
///         height of the beam. Both sides of a surface count. The beam passes through the robot of the ranger
///         and through all bodies that move with this robot (one carries the other, or a third body carries
///         both).
/// ties    Of two surfaces at one distance, the larger intensity is reported.
/// source  In worlds with the grid engine, rays walk through the cells of a grid (partition/ray_grid.hpp). In
///         all other worlds, the exact engine computes the inverse of the distance at which each beam hits
///         the edges of outlines (partition/ranging.hpp).
engine::DeviceKind ranger_kind();

struct RangerBeams;

/// The data and functions of a ranger. ranger_kind() makes a device kind from them: a table of functions that
/// the engine calls (engine/kinds/device_kind.hpp). Kinds that extend the ranger include its Params in their
/// own parameters.
struct Ranger {
  using Params = engine::RangerParams;  ///< the parameters of a ranger in a world file

  std::shared_ptr<const RangerBeams> beams;  ///< the beams that the ranger casts; shared by copies
  /// An error if a transducer applies a lower limit of readings (range_min) that exceeds its range_max.
  Result<> limits = {};

  /// Prepares the beams of a ranger and the fields of its readings from its parameters. pose_body_sensor:
  /// pose of the ranger in the frame of the body or joint that carries the ranger, m and rad. The member
  /// `data` of the result holds a Ranger.
  static engine::DeviceKind::Prepared prepare(const Params& params, const Pose& pose_body_sensor);
  /// Returns `limits`. The engine calls this function while it loads a world and reports the error. Kinds
  /// that extend the ranger must call it in their own bind_part(). Without this check, a range_min above
  /// range_max would raise readings to more than range_max, which is the reading of a beam that hits nothing.
  Result<> bind_part(const engine::TypeSpec&, std::uint32_t) const { return limits; }
  /// Computes the readings of the ranger for every body of the batch (the bodies that one task of a parallel
  /// loop handles), and writes them to batch.state. Returns the number of rays cast.
  std::uint64_t sense(const engine::DeviceBatch& batch) const;
};

}  // namespace troupe::sensors
