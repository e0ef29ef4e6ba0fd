#pragma once

#include "engine/kinds.hpp"

#include <string>

namespace troupe::worldio {

/// JSON Schema (draft 7) of the worlds that load_json_world() reads, as text: for editors, which complete and
/// check as one types, and for programs that write worlds. Made from the same field tables as the reader and
/// docs/world-format.md. What the schema refuses the reader refuses; what it lets pass may still be wrong in
/// ways that no schema can say (names that no body has, outlines that cross themselves).
std::string world_schema(const engine::Registry& registry);

}  // namespace troupe::worldio
