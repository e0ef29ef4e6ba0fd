#pragma once

#include "engine/kinds/measure_kind.hpp"

/// Measures that are counts or means. All but `deaths` cover only robots that are in the world. A mean,
/// fraction or variance over no robots is NaN. `troupe describe NAME` prints the definition of a measure.
namespace troupe::models {

/// `stalls`: number of robots whose last motion was blocked, or would have left the world's bounds.
engine::MeasureKind stalls_measure();
/// `held`: number of robots whose last motion would have left the world's bounds.
engine::MeasureKind held_measure();
engine::MeasureKind alive_measure();  ///< `alive`: number of robots that are in the world
/// `deaths`: number of bodies of one type (the parameter `type`), with or without a drive, that have died
/// since tick 0.
engine::MeasureKind deaths_measure();
/// `displacement`, m: mean straight-line distance of the robots from where they started or were born; NaN
/// without robots.
engine::MeasureKind displacement_measure();
/// `path_length`, m: mean length of the robots' paths since measuring began; NaN without robots.
engine::MeasureKind path_length_measure();
/// `mean_speed`, m/s: mean speed of the robots in the last tick; a stalled or carried robot has the speed 0.
/// NaN without robots.
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
/// `state_mean`: mean, over the robots, of one variable of their state, such as a reading. The parameters
/// `component`, `field` and `column` select the variable. Robots that do not have the variable are left out.
/// If it is a reading, robots whose sensor does not run are also left out. NaN if no robot remains.
engine::MeasureKind state_mean_measure();
/// `state_variance`: variance, over the robots, of one variable of their state. It has the parameters of
/// `state_mean`, and the same robots are left out. NaN if no robot remains.
engine::MeasureKind state_variance_measure();

}  // namespace troupe::models
