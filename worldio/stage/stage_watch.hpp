#pragma once

#include "engine/watch_spec.hpp"
#include "worldio/stage/stage_models.hpp"
#include "worldio/stage/stage_parser.hpp"
#include "worldio/stage/stage_text.hpp"
#include "worldio/stage/stage_values.hpp"

namespace troupe::worldio {

/// Reads the properties of the world that say how a run is watched: `show_clock`, `show_clock_interval`,
/// `speedup`, `paused`.
engine::WatchSpec read_stage_watch(const StageDocument& document, StageValues& values);
/// Writes the properties that read_stage_watch() reads, if they differ from their defaults.
void write_stage_watch(const engine::WatchSpec& watch, StageText& text);

/// Reads a `window` into a record of window_fields(). It ignores all other properties; StageLint warns of
/// them.
engine::Record read_stage_window(const StageModel& window, const StageDocument& document,
                                 StageValues& values);
/// Writes a `window`, for a file whose unit of length is the metre.
void write_stage_window(const engine::Record& window, StageText& text);

}  // namespace troupe::worldio
