#pragma once

#include "base/diagnostics.hpp"
#include "engine/kinds/kinds.hpp"
#include "engine/spec/measure_spec.hpp"
#include "worldio/json/json_reader.hpp"

#include <optional>
#include <string>

namespace troupe::worldio {

/// Reads an entry of the list `measures` of a world. A measure is a number that is computed from the state of
/// a run, such as the number of robots that cannot move. The entry is a text or an object. The text
/// `"stalls"` names a measure. The text `"stalls:leaders"` applies this measure only to the body type,
/// population (group of bodies that a rule places) or robot named "leaders". An object has the form {`kind`,
/// `name`, `of`, parameters}. Empty, with errors, if the entry has another form, names an unknown measure or
/// has wrong parameters. Whether "leaders" exists is checked later, when the world is built.
std::optional<engine::MeasureSpec> read_measure(const JsonCursor& at, const engine::Registry& registry);

/// Like read_measure(), but reads the measure from `text`, an argument of the command line: `stalls` or
/// `stalls:leaders` without quotes, or a JSON object, which begins with `{`. `source` is the place that
/// errors name, such as "--measure".
std::optional<engine::MeasureSpec> parse_measure(const std::string& text, const std::string& source,
                                                 const engine::Registry& registry, Diagnostics& diagnostics);

}  // namespace troupe::worldio
