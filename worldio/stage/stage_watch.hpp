#pragma once

#include "engine/spec/watch_spec.hpp"
#include "worldio/stage/stage_models.hpp"
#include "worldio/stage/stage_parser.hpp"
#include "worldio/stage/stage_text.hpp"
#include "worldio/stage/stage_values.hpp"

namespace troupe::worldio {

/// Reads the settings for watching a run from the top-level properties of a `.world` file of Stage, an older
/// robot simulator. `show_clock` and `show_clock_interval` say whether and how often the run prints the
/// simulated time. `speedup` is the speed of the run as a multiple of real time. `paused` says whether
/// Stage's window starts paused. A missing property has its default value. A wrong value is reported and
/// replaced by the default. A `speedup` outside the limits of WatchSpec::rate is replaced by the nearest
/// limit, without an error.
engine::WatchSpec read_stage_watch(const StageDocument& document, StageValues& values);
/// Writes the properties that read_stage_watch() reads, if they differ from their defaults.
void write_stage_watch(const engine::WatchSpec& watch, StageText& text);

/// Reads a `window` of a `.world` file: the settings of Stage's view of a run. The result has one value for
/// each field of window_fields(). A missing or wrong property has its default value, and a wrong one is
/// reported. Properties that are not in window_fields() are ignored; StageLint (stage_lint.hpp) warns of
/// them.
engine::Record read_stage_window(const StageModel& window, const StageDocument& document,
                                 StageValues& values);
/// Writes a `window` with the properties that differ from their defaults. Lengths are written in metres.
void write_stage_window(const engine::Record& window, StageText& text);

}  // namespace troupe::worldio
