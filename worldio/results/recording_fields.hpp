#pragma once

#include "engine/world.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace troupe::worldio {

/// A component of the state as a recording stores it: /state/pose, /sensors/minibot/eye. Its rows are bodies
/// in the order of their ids, whatever the order of rows in memory. A component that only some bodies have
/// comes from several tables, one per type.
struct RecordedComponent {
  std::vector<std::string> path;  ///< steps from the root: {"state", "pose"}
  std::string name;               ///< of the component, or of the sensor
  std::string frame;              ///< of the values: "world", "body", "sensor", "joint" (at rest), "carrier";
                                  ///< empty: none
  std::size_t rows = 0;
  bool everywhere = true;  ///< every row has it
  std::vector<engine::StateField> fields;
  std::vector<std::size_t> columns;  ///< per field: its index in the tables
  struct Source {
    std::size_t table;                    ///< index into World::tables()
    std::vector<std::uint32_t> recorded;  ///< row of the table -> row here
  };
  std::vector<Source> sources;

  /// Size of one field in all rows, bytes.
  std::size_t bytes(std::size_t field) const;
};

/// The bodies that can move, sense or decide, in the order of their ids: the rows of /state.
std::vector<BodyId> recorded_bodies(const engine::World& world);

/// The name of each type in a recording, by TypeId: one step of a path, made unique by "~2".
std::vector<std::string> recorded_type_names(const engine::World& world);

/// The names that `--record-fields` accepts in this world, the short ones first: components of every robot
/// (pose), fields of sensors (ranges), kinds (wander), single components (ranger/eye).
std::vector<std::string> recordable_names(const engine::World& world);

/// The components that the names choose, each once, in the order of the tables; "all" chooses all.
/// Throws std::invalid_argument: `unknown field "posse"; known: pose, velocity, ... (did you mean "pose"?)`.
std::vector<RecordedComponent> recorded_components(const engine::World& world,
                                                   std::span<const std::string> names);

/// The value of each byte of a field in rows without a value: 0xff for floats, which makes a NaN, else 0.
std::byte absent(const engine::StateField& field);

/// Copies one component of the world's state, row-major, each field into its buffer. Does not write rows that
/// lack the component; fills rows of bodies that are not in the world with absent().
void gather(const engine::World& world, const RecordedComponent& component,
            std::span<const std::span<std::byte>> fields);

}  // namespace troupe::worldio
