#pragma once

#include "base/diagnostics.hpp"
#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"

namespace troupe::worldio {

/// Reports all values that no world can have: beyond the limits of engine/spec_description.cpp, parameters
/// that do not match their kind, unknown kinds, and errors of engine::check_rules(). A message begins with
/// the path of the value, `types[0].parts[2].size: must be from -1000000 to 1000000 m, found nan`, and has
/// the spec's place for it, if any. Kinds check their own parameters later, in World's constructor.
void check_spec(const engine::WorldSpec& spec, const engine::Registry& registry, Diagnostics& diagnostics);

}  // namespace troupe::worldio
