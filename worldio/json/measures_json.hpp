#pragma once

#include "base/diagnostics.hpp"
#include "engine/kinds.hpp"
#include "engine/measure_spec.hpp"
#include "worldio/json/json_reader.hpp"

#include <optional>
#include <string>

namespace troupe::worldio {

/// Reads an entry of the list `measures` of a world. It is `"stalls"`, or `"stalls:leaders"` to measure only
/// the type, population or robot named "leaders", or an object {`kind`, `name`, `of`, parameters}. Empty,
/// with errors, if it is none of these or names an unknown measure.
std::optional<engine::MeasureSpec> read_measure(const JsonCursor& at, const engine::Registry& registry);

/// Reads a measure from `text`, an argument of the command line: the name of a measure without quotes, or a
/// JSON object. `source` is the place that errors name, such as "--measure".
std::optional<engine::MeasureSpec> parse_measure(const std::string& text, const std::string& source,
                                                 const engine::Registry& registry, Diagnostics& diagnostics);

}  // namespace troupe::worldio
