#pragma once

#include "engine/kinds/registry.hpp"

namespace troupe::models {

/// Returns the definition of the controller `expand`: robots disperse by means of their range readings.
///
/// Names in backquotes are parameters. The sum is the sum of one vector per beam: the vector points along the
/// beam, and its length is the reading of the beam. So the sum points to the side with more free space.
///
/// turns    The robot turns towards the sum. With `invert`, it turns in the opposite direction, so that
///          robots gather.
/// drives   The robot drives while the way is clear and the direction to which it turns is less than `cone`
///          (rad) from straight ahead. The way is clear if every reading exceeds the clearance of its beam.
///          The clearance of a beam at the angle a from straight ahead is `clearance` (m) times cos(a). The
///          list `clearances`, if it is given, replaces this formula: it has one clearance (m) per transducer
///          (fan of beams).
/// edges    If the sum is almost zero (at most 1e-6 times the sum of the readings), as with a ring of beams
///          in open space, it has no direction. The robot then treats it as if it pointed straight ahead. If
///          the sum points straight ahead (within 1e-6 rad) but the way is not clear, the robot turns left;
///          with `invert`, this rule does not apply.
/// on axis  With `hold_on_axis`, the rules of "edges" do not apply. Instead, as in Stage, the robot repeats
///          its last command while the sum lies exactly on the x or y axis of the robot.
/// needs    a drive, and a ranger that no other controller of the robot has reserved. The controller uses all
///          beams of the first such ranger. The sum of these beams must be able to point ahead or, with
///          `invert`, behind
/// source   Vaughan, Massively multi-robot simulation in Stage, section 6.1; `invert` is the clustering
///          variant in the paper
engine::ControllerKind expand_controller();

/// Return two presets of `expand`. A preset is a controller with a name and default parameters of its own.
/// Their parameters are those of two examples of Stage:
/// - `expand_pioneer`: Stage's cave benchmark (16 sonars)
/// - `expand_swarm`: Stage's hospital benchmark (a ring of 12 infrared rangers)
///@{
engine::Registry::Preset expand_pioneer_preset();
engine::Registry::Preset expand_swarm_preset();
///@}

}  // namespace troupe::models
