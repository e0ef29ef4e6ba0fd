#pragma once

#include "engine/world/world.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::worldio {

/// A component of the state (a set of fields that bodies have, such as the pose), as a recording stores it. A
/// recording has one group for each component, such as /state/pose or /sensors/minibot/eye, and in it one
/// array for each field. At each recorded time, the array has one row per body, in the order of the ids of
/// the bodies. A row has one or more values. A component in /state has a row for each of recorded_bodies(),
/// a component in /sensors for each body of one type (a type describes bodies of the same construction).
///
/// In memory, the values of a component in /state may be in several tables: the memory of a controller, for
/// example, has a table for each type with this controller. `sources` lists these tables. If a field has
/// different numbers of values per row in these tables, as the messages of radios may have, the recorded
/// field has the largest of these numbers.
struct RecordedComponent {
  std::vector<std::string> path;  ///< names of the groups from the root of the file: {"state", "pose"}
  std::string name;               ///< name of the component in the state: "pose", "ranger/eye"
  /// Frame of the values: "world", "body", "sensor", "joint" (the frame of the joint at rest) or "carrier"
  /// (the frame of the body that carries the body of the row). Empty: the values have no frame.
  std::string frame;
  std::size_t rows = 0;  ///< number of rows
  /// For each row, 1 if its body has the component, else 0; empty: all bodies have it.
  std::vector<std::uint8_t> has;
  std::vector<engine::StateField> fields;  ///< the recorded fields of the component
  /// For each entry of `fields`, the index of the field in each of the tables that `sources` lists.
  std::vector<std::size_t> columns;
  /// One table of the state from which the component is copied.
  struct Source {
    std::size_t table;  ///< index into World::tables()
    /// For each body of the world, by BodyId (the number of the body), its row in the recorded component,
    /// from 0. The entries for bodies that are not in the table have no meaning.
    std::shared_ptr<const std::vector<std::uint32_t>> recorded;
    /// The sensor whose readings the table stores; null for other tables.
    const engine::BodyType::Device* sensor = nullptr;
  };
  std::vector<Source> sources;  ///< the tables, in the order of World::tables()

  /// Returns the size, in bytes, of the values that the field with this index has at one recorded time, in
  /// all rows together.
  std::size_t bytes(std::size_t field) const;
};

/// Returns the bodies that have a row in the state tables (World::rows()), in the order of their ids. These
/// are the bodies that have a drive, a device or a controller, or that can be gripped or pushed. The arrays
/// in /state have one row for each of these bodies.
std::vector<BodyId> recorded_bodies(const engine::World& world);

/// Returns the name that each type has in a recording, by TypeId (the number of the type). The name is that
/// of an HDF5 group, so it has no "/". If several types have the same name, the second is called "NAME~2".
std::vector<std::string> recorded_type_names(const engine::World& world);

/// Returns the names that messages suggest for the option `--record-fields`, which selects what a recording
/// of this world stores. Each name occurs once. The names are "all", components that every robot has (pose),
/// fields of devices (ranges), kinds (sorts) of controllers and devices (wander, ranger), single controllers
/// (wander/0) and names of devices (eye). `--record-fields` also accepts names of components (ranger/eye) and
/// COMPONENT.FIELD (eye.ranges).
std::vector<std::string> recordable_names(const engine::World& world);

/// If `name` is the path of a device or of one of its fields in a recording, returns the name that
/// --record-fields and --color-by accept instead: "eye.ranges" for "sensors/minibot/eye/ranges",
/// "minibot/eye/ranges" or "sensors/minibot/eye.ranges". The result is empty for all other names.
std::optional<std::string> name_for_path(const engine::World& world, std::string_view name);

/// Returns the message about a name in a spelling that is not accepted, although its meaning is clear:
/// `unknown field "minibot/eye/ranges": write "eye.ranges" instead`. `what` is a word for the named thing,
/// here "field"; `right` is the accepted name.
std::string wrong_spelling(std::string_view what, std::string_view name, std::string_view right);

/// Returns the components that the names select, each once: first those in /state, in the order of the tables
/// of the state, then those in /sensors, by type. recordable_names() describes the names. The name "pose"
/// also selects the displacements of joints and the colours that devices show, which are needed to draw
/// bodies. Throws std::invalid_argument for an unknown name, with a message such as `unknown field "posse"`
/// and the known names. For a path, the message has the right name (name_for_path()).
std::vector<RecordedComponent> recorded_components(const engine::World& world,
                                                   std::span<const std::string> names);

/// Joins names of fields with commas, as recordings store them in the attribute `record_fields`. A comma or a
/// backslash inside a name is preceded by a backslash.
std::string join_field_names(std::span<const std::string> names);
/// Returns the names from which join_field_names() made `text`.
std::vector<std::string> split_field_names(std::string_view text);

/// Returns the byte with which all bytes of a row without a value are filled: 0xff for floating-point fields,
/// which gives NaN, else 0.
std::byte absent(const engine::StateField& field);

/// Copies one component of the state of the world into buffers. `fields` has one buffer, in row-major order,
/// for each of component.fields; its size must be component.bytes(). Rows of bodies that lack the component
/// are not written, nor are the last columns of a row that has fewer columns than the component. Rows of
/// bodies that are not in the world at present are filled with absent(), except in the component `life`,
/// which itself says that a body is absent. A sensor that is inactive and that no controller or program reads
/// does not run: World::senses() is false, and its row is also filled with absent().
void gather(const engine::World& world, const RecordedComponent& component,
            std::span<const std::span<std::byte>> fields);

}  // namespace troupe::worldio
