#pragma once

#include "base/color.hpp"
#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"
#include "worldio/images/floor_image.hpp"
#include "worldio/stage/stage_text.hpp"

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace troupe::worldio {

/// The arguments of write_stage_type() that are the same for all types of a world. Holds references: the
/// objects must outlive it.
struct StagePlaces {
  const std::filesystem::path& folder;  ///< folder of the .world file
  const engine::Registry& registry;
  FloorImages& images;
  Diagnostics& diagnostics;
};

/// Returns, for each part of a type, whether it must be omitted from the file: a controller adds such a part
/// each time a `.world` file is read (worldio/stage/stage_demos.hpp).
std::vector<bool> added_parts(const engine::TypeSpec& type, std::uint64_t seed,
                              const engine::Registry& registry);

/// The macro that a type is written as.
struct StageMacro {
  std::string word;                    ///< name of the macro
  Color color;                         ///< colour of the bodies that do not have a colour of their own
  bool has_many_colors = false;        ///< the bodies differ in colour: `color` is then written as color_rgba
  std::vector<bool> added;             ///< for each part: whether it is omitted, from added_parts()
  std::set<std::string> global_parts;  ///< names of the parts that can be found without the body's name
};

/// Writes a type as a macro. The body of the macro is the root part of the type. Inside it are a model for
/// each other part, and a model for each device that is mounted on a part but is not the part itself.
void write_stage_type(const engine::TypeSpec& type, const StageMacro& macro, const StagePlaces& places,
                      StageText& text);

/// Writes `color` if the colour has an X11 name, else `color_rgba`. Stage reads `color_rgba` only if neither
/// the model nor its macros have a `color`.
void write_stage_color(const Color& color, StageText& text);

}  // namespace troupe::worldio
