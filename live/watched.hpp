#pragma once

#include "engine/world/world.hpp"
#include "troupe/simulation.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::live {

// The data that a viewer can request in addition to the poses and colours of all bodies
// (docs/live-protocol.md). A viewer is a page or program that is connected to a running world.
//
// The state of a world consists of components. A component is a table, such as `pose`, or `ranger/ir` for the
// readings of the rangers named `ir`. It has one row for each body that has the component, and fields, such
// as `x`. A field has one column or more: the field `ranges` of a ranger with 8 beams has 8 columns.
//
// The page shows all bodies except static ones; they are called shown bodies here.

/// Returns the state of a body as JSON, in the form of the key `inspected` in docs/live-protocol.md: its
/// name, whether it is in the world (`alive`), its pose, its components, the ranges of its rangers, and the
/// commands to its devices. Throws std::out_of_range if there is no body with this id.
///
/// The members of a component are:
/// - `component`: its whole name, such as `ranger/ir`
/// - `name`: its short name, such as `ir` (engine::given_name())
/// - `runs`: false if the component holds the readings of a sensor that is not in use; all values are then
///   NaN
/// - `fields`: its fields; of each field, at most the first 2048 columns
///
/// Commands are listed only if the body is in the world, and only their fields with at most 4 columns. For a
/// static body, such as a wall, the state has no row. The result then has only its name, `alive` (true) and
/// an empty list of components.
nlohmann::ordered_json inspection(Simulation& simulation, BodyId id);

/// The field of the state by which a viewer colours the shown bodies, for example their speed.
struct ColorValue {
  /// Selects a component: its name (`ranger/ir`), the part before the slash (`ranger`), or its short name
  /// (`ir`). If a body has several components that this text selects, the last of them in World::tables()
  /// counts.
  std::string component;
  std::string field;                    ///< name of a field of the component
  std::optional<std::uint32_t> column;  ///< index of a column, from 0; not set: minimum of all columns
  /// Smallest and largest value of the shown bodies since the viewer chose this field. take_shades() updates
  /// them; before its first call, they are infinity and -infinity.
  double least = std::numeric_limits<double>::infinity();
  double most = -std::numeric_limits<double>::infinity();
};
/// Returns the fields by which bodies can be coloured, as a JSON list. Each entry has the members
/// `component`, `field`, `unit`, `text` (a description of the field) and `columns` (the number of columns; 0
/// means more than 4).
nlohmann::ordered_json color_values(const engine::World& world);
/// Whether the state has the component, field and column that `color` names.
bool has_value(const engine::World& world, const ColorValue& color);
/// Computes the colours of the shown bodies from the field that `color` names. First lowers `color.least` and
/// raises `color.most` so that all present values lie between them. Then sets `shades` to one byte per shown
/// body:
/// - 1 for the value `least`, 255 for the value `most`, linear in between
/// - 1 if `least` equals `most`
/// - 0 if the body is not in the world or has no finite value of the field, for example because its sensor is
///   not in use
///
/// places: for each body id, the index of the body in `shades`; `robots` or more if the page does not show
///     the body
/// robots: number of shown bodies
void take_shades(const engine::World& world, std::span<const std::uint32_t> places, std::size_t robots,
                 ColorValue& color, std::vector<std::uint8_t>& shades);

/// Returns the names of the layers that this world can have. A layer is a set of lines that the page draws
/// over the picture of the world:
/// - "radio": from the sender of each message to the robots that heard it. These are robots with a radio or
///   with another device whose readings have the fields `count` and `sender` of a radio (u32)
/// - "sights": from fiducial finders (sensors that detect marked bodies) to the bodies that they detect
/// - "grips": the light beams of grippers, and lines from grippers to the bodies that they hold
/// - "carries": from each body that holds other bodies to these bodies
std::vector<std::string_view> layers_of(const engine::World& world);
/// Returns the lines of the layers with these names (see layers_of()) as JSON: {layer: [x, y, z, x, y, z,
/// ...]}. Six numbers give one line, its start and its end, in m, world frame, rounded to 1 mm. Each layer
/// has at most 20,000 lines; further lines are left out. An unknown layer gets an empty list.
///
/// The lines of "radio" show the messages that a robot heard when its radio ran last. A radio that does not
/// run (CommittedView::runs()), such as that of a disabled robot, has no lines.
nlohmann::ordered_json lines_of(const engine::World& world, std::span<const std::string> layers);

}  // namespace troupe::live
