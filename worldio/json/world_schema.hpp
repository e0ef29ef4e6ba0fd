#pragma once

#include "engine/kinds.hpp"

#include <string>

namespace troupe::worldio {

/// The JSON Schema (draft 7) of the worlds that load_json_world() reads, as text: for completion and checks
/// in editors, and for programs that write worlds. Made from the same field tables as the reader and
/// docs/world-format.md. The reader refuses every world that the schema refuses, and some others: a schema
/// cannot express that names must exist or that outlines must not cross themselves.
std::string world_schema(const engine::Registry& registry);

}  // namespace troupe::worldio
