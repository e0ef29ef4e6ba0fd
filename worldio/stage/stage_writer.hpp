#pragma once

#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"
#include "worldio/json/world_document.hpp"

#include <filesystem>
#include <string>

namespace troupe::worldio {

/// The text of a `.world` that is this world where it lies in `file`: a macro for each type, a model for each
/// body. It is read to make sure that it does the same: what Stage has no word for is an error at its place;
/// outlines that come out otherwise in their last bits, since Stage centres bodies, are warnings.
/// `document`: the JSON that the world was read from, for the lines of its keys; may be null.
std::string write_stage_world(const engine::WorldSpec& spec, const std::filesystem::path& file,
                              const WorldDocument* document, const engine::Registry& registry,
                              Diagnostics& diagnostics);

}  // namespace troupe::worldio
