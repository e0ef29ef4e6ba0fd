#pragma once

#include "engine/kinds/registry.hpp"

namespace troupe::models {

/// Returns the kinds of models that a Stage world file may create, such as `position` (a robot) and `ranger`.
/// A kind states the default size and the default colour of its models. It also states whether a model for
/// which the file gives no shape gets a box as its shape, or has no shape.
std::vector<engine::ModelKind> model_kinds();

}  // namespace troupe::models
