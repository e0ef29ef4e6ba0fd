#pragma once

#include "engine/kinds/registry.hpp"

#include <string>

namespace troupe::worldio {

/// Returns the JSON Schema (draft 7) of JSON worlds, as text. Editors use the schema for completion and
/// checks, and programs that write worlds can check their output with it. `registry` lists the kinds (sorts)
/// of drives, devices, controllers, measures and faults that the worlds may use. The reader of worlds refuses
/// every world that the schema refuses. It also refuses worlds that the schema accepts, because a schema
/// cannot express all rules, for example that the type of a body must exist.
std::string world_schema(const engine::Registry& registry);

}  // namespace troupe::worldio
