#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::worldio {

/// How Troupe treats a property of Stage's world files.
enum class StageSupport {
  honoured,
  fixed,        ///< honoured, but differs from Stage 4.3: the note says how
  no_effect,    ///< accepted and ignored: the note says why
  window_only,  ///< accepted; it only affects Stage's window
  obsolete,     ///< accepted and ignored, as by Stage 4.3
};

struct StageRow {
  std::string_view type;  ///< "world", "block", "sensor", "window", a model type, or "model" for every model
  std::string_view name;  ///< numbers are written [k]: `point[k]`
  StageSupport support;
  std::string_view note;
};

/// Every property that Stage 4.3 knows or that files written for it have, in the order of the documentation.
std::span<const StageRow> stage_rows();

/// The row of a property in an entity of this type: a row of that type, else a row of "model". Null if there
/// is none. `name` is as in the file, with its numbers.
const StageRow* find_stage_row(std::string_view type, std::string_view name);

/// True if no property of this name has an effect in any entity: bodies that differ only in it share a type.
/// `name` is as in the file.
bool is_without_effect(std::string_view name);

/// The names of properties that an entity of this type can have, without obsolete ones: for suggestions.
std::vector<std::string_view> stage_property_names(std::string_view type);

/// The rows as the Markdown table in docs/stage-worlds.md.
std::string stage_property_table();

}  // namespace troupe::worldio
