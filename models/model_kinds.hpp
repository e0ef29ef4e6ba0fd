#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// What a Stage world file may create, with its default size, colour and body.
std::vector<engine::ModelKind> model_kinds();

}  // namespace troupe::models
