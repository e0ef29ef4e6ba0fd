#pragma once

#include "engine/measure_kind.hpp"

/// Counts and means over single robots. `troupe describe` prints their definitions.
namespace troupe::models {

engine::MeasureKind stalls_measure();        ///< `stalls`: number of stalled robots
engine::MeasureKind held_measure();          ///< `held`: number of robots stopped at the world's bounds
engine::MeasureKind alive_measure();         ///< `alive`: number of robots in the world
engine::MeasureKind deaths_measure();        ///< `deaths`: number of bodies of a type that have died
engine::MeasureKind displacement_measure();  ///< `displacement`, m: mean distance from the start
engine::MeasureKind path_length_measure();   ///< `path_length`, m: mean length of the paths
engine::MeasureKind mean_speed_measure();    ///< `mean_speed`, m/s: mean speed in the last tick
engine::MeasureKind order_measure();         ///< `order`: agreement of the headings, 0 to 1
engine::MeasureKind spread_measure();        ///< `spread`, m: mean distance from their centre
engine::MeasureKind share_within_measure();  ///< `share_within`: fraction of the robots in a circle
engine::MeasureKind state_mean_measure();    ///< `state_mean`: mean of a number in their state

}  // namespace troupe::models
