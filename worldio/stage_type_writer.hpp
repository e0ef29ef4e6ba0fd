#pragma once

#include "base/color.hpp"
#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"
#include "worldio/floor_image.hpp"
#include "worldio/stage_text.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace troupe::worldio {

/// What the types of one world are written with.
struct StagePlaces {
  const std::filesystem::path& folder;  ///< of the file
  const engine::Registry& registry;
  FloorImages& images;
  Diagnostics& diagnostics;
};

/// Which parts of a type its controllers add to it whenever a `.world` is read (ControllerKind::furnish), so
/// that they are not written.
std::vector<bool> furnished_parts(const engine::TypeSpec& type, std::uint64_t seed,
                                  const engine::Registry& registry);

/// A type as a macro of this name: its root, and below it a model for each part that is not `furnished`, and
/// for each device that stands on a part but is not the part itself. `color`: of its bodies, unless they say
/// another.
void write_stage_type(const engine::TypeSpec& type, const std::vector<bool>& furnished,
                      const std::string& macro, const Color& color, const StagePlaces& places,
                      StageText& text);

/// `color`, an X11 name where there is one, else `color_rgba`.
void write_stage_color(const Color& color, StageText& text);

}  // namespace troupe::worldio
