#pragma once

#include "engine/kinds/device_kind.hpp"
#include "engine/kinds/sensor_params.hpp"

#include <cstdint>
#include <memory>

namespace troupe::sensors {

/// Returns the implementation of the sensor `ranger`, a range sensor with one or more transducers. A
/// transducer casts a fan of beams at one height and reports the distance along each beam to the first
/// surface.
/// state    The field `ranges` [float32, one per beam], m. A beam that hits nothing has the reading range_max
///          (a parameter of its transducer), rounded to float32. With the parameter `intensity`, there is
///          also the field `intensities` [float32, one per beam]. It contains the ranger_return (a number
///          without unit) of the surface that the beam hits, or 0 if the beam hits nothing.
/// order    Transducers are in the order of the parameters. The beams of a transducer run counter-clockwise
///          from -fov/2 to +fov/2 about its heading, both included. If a transducer has only one beam, the
///          beam points along the heading.
/// noise    A transducer may have noise on its readings and noise on the headings of its beams
///          (ranger_noise.hpp). A reading of exactly range_max gets no noise.
/// hits     A beam hits surfaces with ranger_return >= 0 whose z interval, ends included, contains the height
///          of the beam. It hits surfaces from both sides. It passes through the ranger's own robot, and
///          through all bodies that move together with this robot (one of the two carries the other, or a
///          third body carries both).
/// ties     If a beam hits two surfaces at the same distance, the larger of their intensities is reported.
/// engines  A world uses one of two ray engines (docs/sensing.md). The exact engine intersects beams with the
///          outlines of bodies (partition/ranging.hpp). The grid engine follows rays through the cells of a
///          grid (partition/ray_grid.hpp).
engine::DeviceKind ranger_kind();

struct RangerBeams;

/// A ranger (range sensor) that has been prepared from its parameters. ranger_kind() makes its functions the
/// hooks of a device kind, that is, the functions that the engine calls (engine/kinds/device_kind.hpp). Other
/// device kinds can extend the ranger, for example by noise of their own. They include Ranger::Params in
/// their own parameters, contain a Ranger, and call its functions.
struct Ranger {
  using Params = engine::RangerParams;  ///< the parameters of a ranger in a world file

  std::shared_ptr<const RangerBeams> beams;  ///< the beams that the ranger casts; shared by copies
  /// Result of a check of the parameters. It is an error if, for any transducer (fan of beams),
  /// apply_range_min is true and range_min exceeds range_max. Otherwise it is a success.
  Result<> limits = {};

  /// Makes a ranger from its parameters. Returns the description of the device; its member `data` holds the
  /// Ranger, and its member `percepts` lists the fields of the readings. pose_body_sensor: pose of the ranger
  /// in the frame of the body or joint that carries the ranger, m and rad.
  static engine::DeviceKind::Prepared prepare(const Params& params, const Pose& pose_body_sensor);
  /// Returns `limits`. The arguments are not used. The engine calls this function while it loads a world, and
  /// reports the error, if any. Device kinds that extend the ranger must call it in their own bind_part().
  /// Without this check, a range_min above range_max would raise readings above range_max.
  Result<> bind_part(const engine::TypeSpec&, std::uint32_t) const { return limits; }
  /// Computes the readings of the ranger for every body of the batch (the bodies that one task of a parallel
  /// loop handles), and writes them to batch.state. Returns the number of rays cast.
  std::uint64_t sense(const engine::DeviceBatch& batch) const;
  /// Warns if the ranger has no beams, if its beams end inside its own body, or if no other body is at their
  /// height. A ranger on a joint may move out of its body and to other heights, and a ranger whose
  /// transducers an intervention changes may get other beams: of these, only the number of beams is checked.
  void lint(const engine::LintView& view) const;
};

}  // namespace troupe::sensors
