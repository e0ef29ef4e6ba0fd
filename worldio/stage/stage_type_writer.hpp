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

/// What the types of one world are written with.
struct StagePlaces {
  const std::filesystem::path& folder;  ///< of the file
  const engine::Registry& registry;
  FloorImages& images;
  Diagnostics& diagnostics;
};

/// Which parts of a type its controllers add to it whenever a `.world` is read
/// (worldio/stage/stage_demos.hpp), so that they are not written.
std::vector<bool> added_parts(const engine::TypeSpec& type, std::uint64_t seed,
                              const engine::Registry& registry);

/// How a type is written, as a macro.
struct StageMacro {
  std::string word;              ///< its name
  Color color;                   ///< of its bodies, unless they say another
  bool has_many_colors = false;  ///< some do: theirs must count, so that this one is not written by name
  std::vector<bool> added;       ///< of each part, whether it is left out
};

/// A type as a macro: its root, and below it a model for each part, and for each device that stands on a part
/// but is not the part itself.
void write_stage_type(const engine::TypeSpec& type, const StageMacro& macro, const StagePlaces& places,
                      StageText& text);

/// `color`, an X11 name where there is one, else `color_rgba`, which counts only where there is no `color`,
/// not even in a macro.
void write_stage_color(const Color& color, StageText& text);

}  // namespace troupe::worldio
