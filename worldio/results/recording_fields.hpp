#pragma once

#include "base/diagnostics.hpp"
#include "engine/spec/world_spec.hpp"
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

/// A component of the state of the world, as a recording stores it. A component is a set of fields that
/// bodies have, such as the pose. A recording is an HDF5 file with one group for each component, such as
/// /state/pose or /sensors/minibot/eye. The group has one array for each field. At each recorded time, the
/// array has one row per body, in the order of the ids of the bodies. A row has one or more values (columns).
///
/// A component in /state has one row for each body that recorded_bodies() returns. A component in
/// /sensors/TYPE has one row for each body of this type. A type describes bodies of the same construction.
///
/// In memory, the values of a component in /state may be in several tables, which `sources` lists. For
/// example, the memory of a controller has one table for each type with this controller. These tables may
/// have different numbers of columns for a field, as for the messages of radios. The recorded field then has
/// the largest of these numbers.
struct RecordedComponent {
  std::vector<std::string> path;  ///< names of the groups from the root of the file: {"state", "pose"}
  std::string name;               ///< name of the component in the state: "pose", "ranger/eye"
  /// Reference frame of the fields, except those for which frame_of() returns another: "world", "body",
  /// "sensor", "joint" (the frame of the joint at rest) or "carrier" (the frame of the body that carries the
  /// row's body). Empty if the values need no reference frame.
  std::string frame;
  std::size_t rows = 0;  ///< number of rows of each field at one recorded time
  /// For each row, 1 if its body has the component, else 0. An empty list means that all bodies have it.
  std::vector<std::uint8_t> has;
  std::vector<engine::StateField> fields;  ///< the recorded fields of the component
  /// For each entry of `fields`, its index in StateTable::fields(). This index is the same in all tables that
  /// `sources` lists.
  std::vector<std::size_t> columns;
  /// A table of the state that holds rows of the component.
  struct Source {
    std::size_t table;  ///< index into World::tables()
    /// For each body of the world, its row in the recorded component, from 0. The index into this list is the
    /// BodyId (the number of the body). Entries of bodies that are not in the table have no meaning.
    std::shared_ptr<const std::vector<std::uint32_t>> recorded;
    /// The sensor whose readings the table stores; null if the table does not store readings.
    const engine::BodyType::Device* sensor = nullptr;
  };
  std::vector<Source> sources;  ///< the tables, in the order of World::tables()

  /// Returns the size, in bytes, of all rows of fields[field] at one recorded time.
  std::size_t bytes(std::size_t field) const;
};

/// Returns the bodies that have a row in the state tables (SensingView::rows()), in the order of their ids.
/// These are the bodies that have a drive, a device or a controller, or that can be gripped or pushed. The
/// arrays in /state have one row for each of these bodies.
std::vector<BodyId> recorded_bodies(const engine::World& world);

/// Returns, for each type, its name in a recording, in the order of TypeIds (the numbers of the types). The
/// name is that of the type in the world, in which hdf5_name() replaces characters such as "/". If several
/// types have the same name, the second is called "NAME~2", the third "NAME~3".
std::vector<std::string> recorded_type_names(const engine::World& world);

/// Returns the names that error messages suggest for the option `--record-fields`, each once. The option
/// selects what a recording of this world stores. A kind is a sort of controller or device. The suggested
/// names are:
/// - "all",
/// - components of the state ("pose"),
/// - fields of devices ("ranges"),
/// - kinds of controllers and devices ("wander", "ranger"),
/// - single controllers ("wander/0"),
/// - devices ("eye").
///
/// The option also accepts KIND/DEVICE ("ranger/eye") and NAME.FIELD ("eye.ranges"), where NAME is a
/// component, kind, controller or device. The names include those of types without bodies
/// (unused_tables()).
std::vector<std::string> recordable_names(const engine::World& world);

/// Converts the path that a device or a field of a device has in a recording to the name that the options
/// `--record-fields` and `--color-by` accept. For example, returns "eye.ranges" for
/// "sensors/minibot/eye/ranges", "minibot/eye/ranges" and "sensors/minibot/eye.ranges". Returns std::nullopt
/// if `name` is not such a path.
std::optional<std::string> name_for_path(const engine::World& world, std::string_view name);

/// Returns the error message for a name that must be written in another way, such as `unknown field
/// "minibot/eye/ranges": write "eye.ranges" instead`. In this example, `what` is "field", `name` is
/// "minibot/eye/ranges" and `right` is "eye.ranges".
std::string wrong_spelling(std::string_view what, std::string_view name, std::string_view right);

/// Returns the components and fields that `names` selects. Each name is one that `--record-fields` accepts
/// (see recordable_names()). The result has first the components in /state, in the order of World::tables(),
/// and then those in /sensors, in the order of the types. A name that only types without bodies have selects
/// nothing.
///
/// The name "pose" also selects the displacements of joints and the colours that devices show, because both
/// are needed to draw bodies.
///
/// Throws std::invalid_argument for an unknown name, with a message that lists the known names, such as
/// `unknown field "posse"...`. If the unknown name is a path in a recording, the message has the accepted
/// name instead (name_for_path()).
std::vector<RecordedComponent> recorded_components(const engine::World& world,
                                                   std::span<const std::string> names);

/// Returns the reference frame of the values of a field of a component. It is the world frame if the text of
/// the field says so, as for the poses that a fiducial finder reads, and otherwise RecordedComponent::frame.
std::string_view frame_of(const RecordedComponent& component, const engine::StateField& field);

/// Reports an error if a world file names a recording outside the working folder, also through a symbolic
/// link, or with the ending of another format (has_ending_of_other_format()). A world file from an unknown
/// source must not create files elsewhere, nor replace them with --force.
void check_recording_file(const engine::RecordSpec& record, Diagnostics& diagnostics);

/// Joins names of fields with commas. Recordings store the result in the attribute `record_fields`. A comma
/// or a backslash inside a name is preceded by a backslash.
std::string join_field_names(std::span<const std::string> names);
/// Returns the names from which join_field_names() made `text`.
std::vector<std::string> split_field_names(std::string_view text);

/// Returns the byte that fills the values of a field for a body without such values, such as an absent body.
/// The byte is 0xff for floating-point fields, so that the values are NaN. For all other fields it is 0.
std::byte absent(const engine::StateField& field);

/// Copies the current values of a component into buffers. `fields` has one buffer for each entry of
/// component.fields. The buffer of entry f has component.bytes(f) bytes, in row-major order.
///
/// Two parts of a buffer are not written: the rows of bodies that do not have the component, and the last
/// columns of a row whose table has fewer columns than the recorded field.
///
/// Two kinds of rows are filled with absent(). The first are the rows of bodies that are not in the world at
/// present. The component `life` is an exception: its values say that these bodies are absent. The second are
/// the rows of sensors that do not run, which means that the sensor is inactive and that no controller or
/// program reads it (CommittedView::senses() is false).
void gather(const engine::World& world, const RecordedComponent& component,
            std::span<const std::span<std::byte>> fields);

}  // namespace troupe::worldio
