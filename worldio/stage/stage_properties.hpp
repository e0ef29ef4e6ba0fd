#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::worldio {

/// What becomes of a property of Stage's world files.
enum class StageSupport {
  honoured,
  fixed,        ///< honoured, but not as in Stage 4.3: the note says how
  no_effect,    ///< accepted; the note says why it changes nothing
  window_only,  ///< accepted; it shapes Stage's window
  obsolete,     ///< accepted; Stage 4.3 ignores it too
};

struct StageRow {
  std::string_view type;  ///< "world", "block", "sensor", "window", a model type, or "model" for every model
  std::string_view name;  ///< numbered ones as `point[k]`
  StageSupport support;
  std::string_view note;
};

/// Every property that Stage 4.3 or the files written for it know, in the order of the documentation.
std::span<const StageRow> stage_rows();

/// The row of a property in an entity of this type; a model's own rows come before those of every model.
/// Null when there is none. `name` is as written, with its numbers.
const StageRow* find_stage_row(std::string_view type, std::string_view name);

/// True when no property of this name, in whatever entity, has an effect here: bodies may differ in it and
/// still be alike. `name` is as written.
bool is_without_effect(std::string_view name);

/// The names that an entity of this type knows, obsolete ones left out, for suggestions.
std::vector<std::string_view> stage_property_names(std::string_view type);

/// The rows as a Markdown table: the reference in docs/stage-worlds.md.
std::string stage_property_table();

}  // namespace troupe::worldio
