#pragma once

#include "base/diagnostics.hpp"
#include "engine/kinds/registry.hpp"
#include "engine/spec/world_spec.hpp"

namespace troupe::worldio {

/// Reports an error for each invalid value of a spec. A spec is the description of a world that the engine
/// uses. A kind is a sort of drive, device, controller, measure or fault; `registry` lists all kinds. These
/// values are invalid:
/// - numbers beyond the limits in engine/spec/spec_description.cpp; only one error is reported for each list
///   of numbers
/// - names of unknown kinds
/// - parameters that are not in the table of parameters of their kind, or have the wrong type or a value
///   beyond their limits
/// - values that contradict one another, such as an index beyond the end of a list (engine::check_rules())
///
/// The message begins with the path of the value, such as `types[0].parts[2].size`. The error is reported at
/// a place in a file (Where): the member `where` of the innermost enclosing struct that has such a member.
///
/// The function does not call the code of kinds. The constructor of World does so, and makes the remaining
/// checks, for example whether the parameters of a kind are consistent.
void check_spec(const engine::WorldSpec& spec, const engine::Registry& registry, Diagnostics& diagnostics);

}  // namespace troupe::worldio
