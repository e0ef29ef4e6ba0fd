#pragma once

#include "engine/kinds/controller_kind.hpp"

namespace troupe::models {

/// Returns the definition of the controller `collector`: a robot searches for pucks, grips one, carries it to
/// a sink and releases it there. If its power pack (battery) runs low while it searches, the robot charges
/// the pack at a charger.
///
/// Pucks, sinks and chargers are bodies of the world. The robot knows pucks and chargers by their
/// fiducial_return, which is the number that a fiducial finder (a sensor that detects marked objects) reads
/// from a body. Names in backquotes are parameters.
///
/// pucks     bodies whose fiducial_return is `puck`
/// sinks     bodies whose name is `sink`, or `sink` followed by digits, such as sink2 if `sink` is "sink". A
///           world without sinks is an error
/// chargers  bodies with a fiducial_return of `charger`. If only a part of a body has it, the part is the
///           charger
/// places    Only bodies that are in the world from the start are sinks and chargers. The robot uses their
///           positions in the world file, even if the bodies move during the run.
///
/// seeks     The robot drives straight on and turns away from obstacles ahead, until its fiducial finder sees
///           a puck that is 0.8 m or more away from every sink. The robot drives up to this puck, slowly for
///           the last half metre. When the puck breaks the inner light beam of the gripper, the gripper
///           closes.
/// carries   The robot carries the puck to within 0.5 m of the nearest sink and opens the gripper there. If
///           the paddles are not open after 3 s, for example because those of another robot block them, the
///           robot backs off all the same.
/// charges   If the power pack holds less than 25 % of its capacity while the robot searches, the robot goes
///           to the nearest charger and stands there until the pack holds 95 %. A robot without a pack, or in
///           a world without chargers, never charges.
/// needs     a drive, a ranger with more than 8 beams that sees ahead, a fiducial finder, a gripper, a sink
/// source    none: written for Troupe. Stage has the devices, but no example that combines them
engine::ControllerKind collector_controller();

}  // namespace troupe::models
