#pragma once

#include "engine/kinds/kinds.hpp"

#include <string>

namespace troupe::worldio {

/// Returns the JSON Schema (draft 7) of JSON worlds, as text. The worlds may use the kinds (sorts) of drives,
/// devices, controllers, measures and faults in `registry`. Editors use the schema for completion and checks,
/// and programs that write worlds can check their output with it. The schema is made from the tables of keys
/// and parameters that the reader and docs/world-format.md also use. The reader refuses every world that the
/// schema refuses, and some others: a schema cannot express that names must exist or that outlines must not
/// cross themselves.
std::string world_schema(const engine::Registry& registry);

}  // namespace troupe::worldio
