#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// The kinds of models that a Stage world file may create, with their default sizes and colours, and whether
/// a model of the kind that declares no blocks gets a box as its solid.
std::vector<engine::ModelKind> model_kinds();

}  // namespace troupe::models
