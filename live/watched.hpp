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

// The data that a viewer requests in addition to the poses and colours of all robots (docs/live.md).

/// Returns the state of a body as JSON: name, whether it is in the world (`alive`), pose, the fields of all
/// its components (state tables), the ranges of its rangers, and the commands to its devices. Each component
/// has the members `component`, `name`, `runs` and `fields`. `component` is its name in the state, such as
/// `ranger/ir`, and `name` the name that the world file gives the device (`ir`, see engine::given_name()).
/// `runs` is false for a sensor that does not run; its values are then NaN. At most the first 2048 columns of
/// a field are listed. Commands are listed only if the body is alive, and only their fields of at most 4
/// columns. Static geometry, such as a wall, has no row in the state tables: the result then has only the
/// name, the member `alive` with the value true, and an empty list of components. Throws std::out_of_range if
/// there is no body with this id.
nlohmann::ordered_json inspection(Simulation& simulation, BodyId id);

/// A value of the state by which a viewer colours robots.
struct ColorValue {
  /// Name of a component (a state table), such as `ranger/ir`. Its kind alone (`ranger`) or the name of its
  /// device alone (`ir`) also selects it.
  std::string component;
  std::string field;                    ///< name of a field of the component
  std::optional<std::uint32_t> column;  ///< column of the field; not set: the minimum of all columns
  /// The least and the largest value that take_shades() has found for any robot since the viewer chose this
  /// value; infinity and -infinity before its first call.
  double least = std::numeric_limits<double>::infinity();
  double most = -std::numeric_limits<double>::infinity();
};
/// Returns the fields by which robots can be coloured, as a JSON list of objects with the members component,
/// field, unit, text (a description) and columns. `columns` is the number of columns, or 0 if the field has
/// more than 4.
nlohmann::ordered_json color_values(const engine::World& world);
/// Whether the state has the component, field and column that `color` names.
bool has_value(const engine::World& world, const ColorValue& color);
/// Updates `least` and `most` of `color` with the present values, and then fills `shades` with one byte per
/// robot of the page: 1 for a value of `least`, 255 for a value of `most`, linear in between (1 for all if
/// `least` equals `most`), and 0 for a robot that does not have the value, has a value that is not finite, or
/// is not in the world. places: for each body id the index of the robot on the page, or an index of at least
/// `robots` if the page does not show the body.
void take_shades(const engine::World& world, std::span<const std::uint32_t> places, std::size_t robots,
                 ColorValue& color, std::vector<std::uint8_t>& shades);

/// Returns the names of the layers of lines that this world can have: "radio" (messages heard), "sights"
/// (bodies that fiducial finders detect), "grips" (bodies that grippers hold) and "carries" (from carriers to
/// carried bodies).
std::vector<std::string_view> layers_of(const engine::World& world);
/// Returns the lines of some layers as JSON: {layer: [x, y, z, x, y, z, ...]}, two points per line, world
/// frame, m, rounded to 1 mm; at most 20,000 lines per layer. A line of `radio` goes from a sender to a robot
/// that heard its message in the last tick in which the radio of this robot ran (a radio need not run in
/// every tick). A radio that does not run (engine::World::runs()), such as that of a disabled robot, has no
/// lines. An unknown layer gets an empty list.
nlohmann::ordered_json lines_of(const engine::World& world, std::span<const std::string> layers);

}  // namespace troupe::live
