#pragma once

#include "base/color.hpp"
#include "engine/kinds/registry.hpp"
#include "engine/spec/world_spec.hpp"
#include "worldio/images/floor_image.hpp"
#include "worldio/stage/stage_text.hpp"

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

/// Writes body types as macros of a `.world` file, the world file of Stage. Stage is an older robot
/// simulator. A type describes bodies of the same construction. Its parts are rigid pieces, and form a tree;
/// the root part (part 0) is the body itself.
namespace troupe::worldio {

/// The arguments of write_stage_type() that are the same for all types of a world. The struct holds
/// references to objects that must outlive it.
struct StagePlaces {
  const std::filesystem::path& folder;  ///< folder of the .world file
  const engine::Registry& registry;     ///< the kinds (sorts) of drives, devices and controllers
  FloorImages& images;                  ///< reads the images of bodies again, to compare them with the solids
  Diagnostics& diagnostics;             ///< receives an error for each value that Stage cannot express
};

/// Returns, for each part of a type, whether the file must not contain the part. These are the parts that a
/// controller of the type adds each time the file is read (worldio/stage/stage_demos.hpp). `seed` is the seed
/// of the world.
std::vector<bool> added_parts(const engine::TypeSpec& type, std::uint64_t seed,
                              const engine::Registry& registry);

/// The macro that write_stage_type() writes for a type.
struct StageMacro {
  std::string word;                    ///< name of the macro
  Color color;                         ///< colour of bodies whose own model has no colour
  bool has_many_colors = false;        ///< true: bodies differ in colour; the macro then has `color_rgba`
  std::vector<bool> added;             ///< result of added_parts() for the type
  std::set<std::string> global_parts;  ///< names of parts that programs can look up without the body's name
};

/// Writes a type as a macro. The content of the macro is the root part of the type. The macro contains a
/// model for each other part, and a model for each device. A part that is itself a device, such as a ranger,
/// is only one model. Three kinds of devices have no models, but become properties of the model of their
/// part: power packs, power contacts and devices of kind `flags` (tokens that bodies exchange).
void write_stage_type(const engine::TypeSpec& type, const StageMacro& macro, const StagePlaces& places,
                      StageText& text);

/// Writes the property `color` if the colour has an X11 name, else the property `color_rgba`. Do not use this
/// function for a macro whose bodies differ in colour: Stage ignores the `color_rgba` of a model if its macro
/// has a `color`.
void write_stage_color(const Color& color, StageText& text);

}  // namespace troupe::worldio
