#pragma once

#include "engine/measure_kind.hpp"

/// Measures that look at each robot by itself. Their definitions stand in the kinds (`troupe describe`).
namespace troupe::models {

engine::MeasureKind stalls_measure();        ///< `stalls`: robots whose last motion was refused
engine::MeasureKind held_measure();          ///< `held`: those that would have left the world
engine::MeasureKind alive_measure();         ///< `alive`: robots that are in the world
engine::MeasureKind deaths_measure();        ///< `deaths`: bodies of a type that are no more
engine::MeasureKind displacement_measure();  ///< `displacement`, m: mean distance from where they started
engine::MeasureKind path_length_measure();   ///< `path_length`, m: mean length of their paths
engine::MeasureKind mean_speed_measure();    ///< `mean_speed`, m/s: in the last tick
engine::MeasureKind order_measure();         ///< `order`: how far headings agree, 0 to 1
engine::MeasureKind spread_measure();        ///< `spread`, m: mean distance from their centre
engine::MeasureKind share_within_measure();  ///< `share_within`: share of them in a circle
engine::MeasureKind state_mean_measure();    ///< `state_mean`: mean of a number of their state

}  // namespace troupe::models
