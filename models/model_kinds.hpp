#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// The kinds of models that a Stage world file may create, with their default sizes, colours and bodies.
std::vector<engine::ModelKind> model_kinds();

}  // namespace troupe::models
