#pragma once

#include "base/color.hpp"
#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"
#include "worldio/images/floor_image.hpp"
#include "worldio/stage/stage_text.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace troupe::worldio {

/// What all types of a world share when they are written.
struct StagePlaces {
  const std::filesystem::path& folder;  ///< of the .world file
  const engine::Registry& registry;
  FloorImages& images;
  Diagnostics& diagnostics;
};

/// Which parts of a type are not written, because its controllers add them when a `.world` file is read
/// (worldio/stage/stage_demos.hpp). One element per part.
std::vector<bool> added_parts(const engine::TypeSpec& type, std::uint64_t seed,
                              const engine::Registry& registry);

/// The macro that a type is written as.
struct StageMacro {
  std::string word;              ///< its name
  Color color;                   ///< of the bodies that do not have another
  bool has_many_colors = false;  ///< some bodies have another: then `color` must not be written by name
  std::vector<bool> added;       ///< per part: whether it is omitted (added_parts())
};

/// Writes a type as a macro: its root, and in it a model for each part and for each device that is mounted on
/// a part but is not the part itself.
void write_stage_type(const engine::TypeSpec& type, const StageMacro& macro, const StagePlaces& places,
                      StageText& text);

/// Writes `color` if the colour has an X11 name, else `color_rgba`. Stage reads `color_rgba` only if neither
/// the model nor its macros have a `color`.
void write_stage_color(const Color& color, StageText& text);

}  // namespace troupe::worldio
