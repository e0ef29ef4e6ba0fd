#pragma once

#include "engine/kinds/kinds.hpp"

namespace troupe::models {

/// Returns the kinds of models that a Stage world file may create. Each kind states the default size and
/// colour of its models, and whether a model that declares no blocks (polygons that form its shape) gets a
/// box as its shape.
std::vector<engine::ModelKind> model_kinds();

}  // namespace troupe::models
