#pragma once

#include "engine/kinds/registry.hpp"
#include "engine/spec/world_spec.hpp"
#include "worldio/json/world_document.hpp"

#include <filesystem>
#include <string>

namespace troupe::worldio {

/// Returns a world as the text of a `.world` file, the world file of Stage (an older robot simulator). The
/// text has a macro for each type (description of bodies of the same construction) that has bodies, and a
/// model for each body.
/// file      path under which the text will be stored: the paths of images are relative to its folder
/// document  the JSON document that the world was read from, for the lines of its keys in errors; may be null
/// Reports an error for every value of `spec` that Stage's syntax cannot express. Do not use the result if
/// there are errors. To find such values, the function reads the text again and compares the world with
/// `spec` (check_stage_round_trip()). A value that is only rounded or wrapped is a warning.
///
/// A `.world` file has no bounds (the box in which bodies must stay). Bounds that follow from floor plans or
/// from an arena with walls are a warning; all other bounds in `document` are an error.
std::string write_stage_world(const engine::WorldSpec& spec, const std::filesystem::path& file,
                              const WorldDocument* document, const engine::Registry& registry,
                              Diagnostics& diagnostics);

}  // namespace troupe::worldio
