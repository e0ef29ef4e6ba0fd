#pragma once

#include "engine/watch_spec.hpp"
#include "worldio/stage_models.hpp"
#include "worldio/stage_parser.hpp"
#include "worldio/stage_values.hpp"

namespace troupe::worldio {

/// What a world says at its top level of how it is to be watched: `show_clock`, `show_clock_interval`,
/// `speedup`, `paused`.
engine::WatchSpec read_stage_watch(const StageDocument& document, StageValues& values);

/// A `window`, by engine::window_fields(). What it says of other things is left to the warnings.
engine::Record read_stage_window(const StageModel& window, const StageDocument& document,
                                 StageValues& values);

}  // namespace troupe::worldio
