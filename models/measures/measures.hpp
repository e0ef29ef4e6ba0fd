#pragma once

#include "engine/kinds/measure_kind.hpp"

/// Definitions of measures that are counts, means, fractions or variances. A measure is a number that is
/// computed from the state of the simulation after a tick (time step). A robot is a body that has a
/// drive. Bodies can be born and can die during a run. All measures but `deaths` cover only robots that are
/// in the world: those that have been born and have not died. The mean, fraction or variance over no robots
/// is NaN. The command `troupe describe NAME` prints the definition of a measure.
namespace troupe::models {

/// `stalls`: number of robots whose last motion did not happen, because another body or a wall blocked the
/// motion, or because the robot would have left the world's bounds.
engine::MeasureKind stalls_measure();
/// `held`: number of robots whose last motion did not happen because the robot would have left the world's
/// bounds.
engine::MeasureKind held_measure();
engine::MeasureKind alive_measure();  ///< `alive`: number of robots that are in the world
/// `deaths`: number of bodies of one type (the parameter `type`) that have died since the start of the run
/// (tick 0). The bodies of this type need not be robots.
engine::MeasureKind deaths_measure();
/// `displacement`, m: mean straight-line distance between the present position of a robot and the position
/// where it started or was born; NaN without robots.
engine::MeasureKind displacement_measure();
/// `path_length`, m: mean length of the paths along which the robots have moved since measuring began; NaN
/// without robots.
engine::MeasureKind path_length_measure();
/// `mean_speed`, m/s: mean speed of the robots in the last tick; NaN without robots. The speed is 0 for a
/// robot whose motion did not happen (see `stalls`), and for a robot that another body carries.
engine::MeasureKind mean_speed_measure();
/// `order`: agreement of the robots' headings, from 0 to 1: the length of the mean of their unit heading
/// vectors. It is 1 if all headings are equal; NaN without robots.
engine::MeasureKind order_measure();
/// `polarisation`: another name of `order`.
engine::MeasureKind polarisation_measure();
/// `spread`, m: mean distance of the robots from the mean of their positions; NaN without robots.
engine::MeasureKind spread_measure();
/// `share_within`: fraction of the robots whose origin is in a circle; NaN without robots. The parameters are
/// the centre of the circle, `center` (m, world frame), and its radius, `radius` (m).
engine::MeasureKind share_within_measure();
/// `state_mean`: mean, over the robots, of one variable of their state, such as a sensor reading or the x
/// coordinate of the pose. Three parameters select the variable. `component` is the name of a table of the
/// state, such as "pose". `field` is the name of a column of the table, such as "x". If each entry of this
/// column is an array, `column` is the index of an element, from 0. Robots that do not have the variable are
/// left out. If the variable is a sensor reading, robots whose sensor does not run because it is not in use
/// (CommittedView::senses()) are also left out; a sensor that has stopped counts with its last reading. NaN
/// if no robot remains.
engine::MeasureKind state_mean_measure();
/// `state_variance`: variance, over the robots, of one variable of their state: the mean of the squared
/// differences from the mean. The parameters are those of `state_mean`, and the same robots are left out. NaN
/// if no robot remains.
engine::MeasureKind state_variance_measure();

}  // namespace troupe::models
