#pragma once

#include "engine/measure_kind.hpp"

/// Measures that look at each robot by itself. Their definitions stand in the kinds (`troupe describe`).
namespace troupe::models {

engine::MeasureKind stalls_measure();
engine::MeasureKind held_measure();
engine::MeasureKind alive_measure();
engine::MeasureKind deaths_measure();
engine::MeasureKind displacement_measure();
engine::MeasureKind path_length_measure();
engine::MeasureKind mean_speed_measure();
engine::MeasureKind order_measure();
engine::MeasureKind spread_measure();
engine::MeasureKind share_within_measure();
engine::MeasureKind state_mean_measure();

}  // namespace troupe::models
