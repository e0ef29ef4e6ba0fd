#pragma once

#include "engine/measure_kind.hpp"

/// Measures that are counts or means. All but `deaths` cover only robots that are in the world. A mean,
/// fraction or variance over no robots is NaN. `troupe describe NAME` prints the definition of a measure.
namespace troupe::models {

/// `stalls`: number of robots whose last motion was blocked, or would have left the world's bounds.
engine::MeasureKind stalls_measure();
engine::MeasureKind held_measure();          ///< `held`: number of robots stopped at the world's bounds
engine::MeasureKind alive_measure();         ///< `alive`: number of robots that are in the world
engine::MeasureKind deaths_measure();        ///< `deaths`: number of bodies of a type that have died
engine::MeasureKind displacement_measure();  ///< `displacement`, m: mean distance of robots from their start
engine::MeasureKind path_length_measure();   ///< `path_length`, m: mean length of the robots' paths
engine::MeasureKind mean_speed_measure();    ///< `mean_speed`, m/s: mean speed of the robots in the last tick
/// `order`: agreement of the robots' headings, the length of the mean of their unit vectors, from 0 to 1 (all
/// headings are equal).
engine::MeasureKind order_measure();
/// `polarisation`: another name of `order`.
engine::MeasureKind polarisation_measure();
/// `spread`, m: mean distance of the robots from the mean of their positions.
engine::MeasureKind spread_measure();
engine::MeasureKind share_within_measure();  ///< `share_within`: fraction of the robots in a given circle
/// `state_mean`: mean of one number of the state, such as a reading, over the robots that have this number.
engine::MeasureKind state_mean_measure();
/// `state_variance`: variance of the number of which `state_mean` is the mean, over the same robots.
engine::MeasureKind state_variance_measure();

}  // namespace troupe::models
