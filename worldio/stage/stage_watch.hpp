#pragma once

#include "engine/watch_spec.hpp"
#include "worldio/stage/stage_models.hpp"
#include "worldio/stage/stage_parser.hpp"
#include "worldio/stage/stage_text.hpp"
#include "worldio/stage/stage_values.hpp"

namespace troupe::worldio {

/// What a world says at its top level of how it is to be watched: `show_clock`, `show_clock_interval`,
/// `speedup`, `paused`.
engine::WatchSpec read_stage_watch(const StageDocument& document, StageValues& values);
/// The same properties, as far as they are not as usual.
void write_stage_watch(const engine::WatchSpec& watch, StageText& text);

/// A `window`, by window_fields(). What it says of other things is left to the warnings.
engine::Record read_stage_window(const StageModel& window, const StageDocument& document,
                                 StageValues& values);
/// In a file whose lengths are metres.
void write_stage_window(const engine::Record& window, StageText& text);

}  // namespace troupe::worldio
