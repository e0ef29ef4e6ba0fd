#pragma once

#include "engine/spec/watch_spec.hpp"
#include "worldio/stage/stage_models.hpp"
#include "worldio/stage/stage_parser.hpp"
#include "worldio/stage/stage_text.hpp"
#include "worldio/stage/stage_values.hpp"

namespace troupe::worldio {

/// Reads the top-level properties of a `.world` file of Stage, an older robot simulator. They say whether and
/// how often a run prints the simulated time (`show_clock`, `show_clock_interval`), how fast the run is
/// (`speedup`) and whether Stage's window starts paused (`paused`). Missing or wrong properties have their
/// defaults, and wrong ones are reported. A `speedup` beyond the limits of WatchSpec::rate is replaced by the
/// nearest limit.
engine::WatchSpec read_stage_watch(const StageDocument& document, StageValues& values);
/// Writes the properties that read_stage_watch() reads, if they differ from their defaults.
void write_stage_watch(const engine::WatchSpec& watch, StageText& text);

/// Reads a `window`, the settings of the view of a run, into a record with one value for each field of
/// window_fields(). Missing or wrong properties have their defaults; wrong ones are reported. Properties that
/// are not in window_fields() are ignored; StageLint (stage_lint.hpp) warns of these properties.
engine::Record read_stage_window(const StageModel& window, const StageDocument& document,
                                 StageValues& values);
/// Writes a `window` with the properties that differ from their defaults, for a file whose unit of length is
/// the metre.
void write_stage_window(const engine::Record& window, StageText& text);

}  // namespace troupe::worldio
