#pragma once

#include "base/diagnostics.hpp"
#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"

namespace troupe::worldio {

/// Reports all that no world can have: values beyond the limits of engine/spec_description.cpp, parameters
/// that are not those of their kind, unknown kinds, and what engine::check_rules() finds. Messages begin with
/// the path of the value, `types[0].parts[2].size: must be from -1000000 to 1000000 m, found nan`, at the
/// place in a file that the spec has for it, if any. World's constructor then finds what kinds themselves
/// refuse.
void check_spec(const engine::WorldSpec& spec, const engine::Registry& registry, Diagnostics& diagnostics);

}  // namespace troupe::worldio
