#pragma once

#include "base/diagnostics.hpp"
#include "engine/kinds/kinds.hpp"
#include "engine/spec/world_spec.hpp"

namespace troupe::worldio {

/// Reports an error for each invalid value of a spec, which is the description of a world that the engine
/// uses. Invalid are: values beyond the limits in engine/spec/spec_description.cpp (at most one error for
/// each list of numbers), unknown kinds, parameters that do not match their kind, and values that contradict
/// one another (engine::check_rules()). A kind is a sort of drive, device, controller or measure; `registry`
/// lists all kinds. A message begins with the path of the value, such as `types[0].parts[2].size`. The error
/// is reported at the place in a file (Where) of the innermost struct that contains the value and has a
/// place. Some checks need the code of a kind, such as whether its parameters are consistent: the constructor
/// of World makes these checks later.
void check_spec(const engine::WorldSpec& spec, const engine::Registry& registry, Diagnostics& diagnostics);

}  // namespace troupe::worldio
