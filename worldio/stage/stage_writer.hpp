#pragma once

#include "engine/kinds/kinds.hpp"
#include "engine/spec/world_spec.hpp"
#include "worldio/json/world_document.hpp"

#include <filesystem>
#include <string>

namespace troupe::worldio {

/// Returns a world as the text of a `.world` file, the world file of Stage (an older robot simulator). The
/// text has a macro for each type (description of bodies of the same construction) that has bodies, and a
/// model for each body. The text is read again and compared with `spec` (check_stage_round_trip()).
/// Everything that Stage's syntax cannot express is an error, at its place in `spec`. Values that are only
/// rounded or wrapped are warnings, and so are bounds (the box in which bodies must stay) that follow from
/// the floor plans, because a `.world` file has no bounds. Do not use the result if there are errors.
/// file      where the text will be stored: the paths of images are relative to its folder
/// document  the JSON document that the world was read from, for the lines of its keys in errors; may be null
std::string write_stage_world(const engine::WorldSpec& spec, const std::filesystem::path& file,
                              const WorldDocument* document, const engine::Registry& registry,
                              Diagnostics& diagnostics);

}  // namespace troupe::worldio
