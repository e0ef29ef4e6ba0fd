#pragma once

#include "engine/kinds/measure_kind.hpp"

/// Definitions of measures that are counts or means. A measure is a number that is computed from the state of
/// the simulation after a tick (simulation step). Bodies, and so robots, can be born and die during a run.
/// All measures but `deaths` cover only robots that are in the world. A mean, fraction or variance over no
/// robots is NaN. `troupe describe NAME` prints the definition of a measure.
namespace troupe::models {

/// `stalls`: number of robots whose last motion did not happen, because another body or a wall blocked the
/// motion, or because the robot would have left the world's bounds.
engine::MeasureKind stalls_measure();
/// `held`: number of robots whose last motion did not happen because the robot would have left the world's
/// bounds.
engine::MeasureKind held_measure();
engine::MeasureKind alive_measure();  ///< `alive`: number of robots that are in the world
/// `deaths`: number of bodies of one type (the parameter `type`), with or without a drive, that have died
/// since the start of the run (tick 0).
engine::MeasureKind deaths_measure();
/// `displacement`, m: mean straight-line distance of the robots from where they started or were born; NaN
/// without robots.
engine::MeasureKind displacement_measure();
/// `path_length`, m: mean length of the robots' paths since measuring began; NaN without robots.
engine::MeasureKind path_length_measure();
/// `mean_speed`, m/s: mean speed of the robots in the last tick; a robot whose motion was blocked, or that
/// another body carries, has the speed 0. NaN without robots.
engine::MeasureKind mean_speed_measure();
/// `order`: agreement of the robots' headings: the length of the mean of their unit heading vectors, from 0
/// to 1. It is 1 if all headings are equal; NaN without robots.
engine::MeasureKind order_measure();
/// `polarisation`: another name of `order`.
engine::MeasureKind polarisation_measure();
/// `spread`, m: mean distance of the robots from the mean of their positions; NaN without robots.
engine::MeasureKind spread_measure();
/// `share_within`: fraction of the robots whose origin is in the circle with the parameters `center` and
/// `radius` (m); NaN without robots.
engine::MeasureKind share_within_measure();
/// `state_mean`: mean, over the robots, of one variable of their state, such as a reading. The state consists
/// of tables: the parameter `component` names the table, `field` the member, and `column` the element of a
/// member that is an array. Robots that do not have the variable are left out. If it is a reading, robots
/// whose sensor does not run are also left out. NaN if no robot remains.
engine::MeasureKind state_mean_measure();
/// `state_variance`: variance, over the robots, of one variable of their state. It has the parameters of
/// `state_mean`, and the same robots are left out. NaN if no robot remains.
engine::MeasureKind state_variance_measure();

}  // namespace troupe::models
