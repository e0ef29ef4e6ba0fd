#pragma once

#include "engine/world.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace troupe::worldio {

/// A component of the state as a recording holds it: /state/pose, /sensors/minibot/eye. Its rows are bodies
/// in the order of their ids, whatever the order of rows in memory; a component that only some bodies have
/// lies in several tables, one a type.
struct RecordedComponent {
  std::vector<std::string> path;  ///< steps from the root: {"state", "pose"}
  std::string name;               ///< of the component, or of the sensor
  std::string frame;              ///< that values are given in: "world", "body", "sensor", "joint" (at rest),
                                  ///< "carrier"; empty: none
  std::size_t rows = 0;
  bool everywhere = true;  ///< no row lacks it
  std::vector<engine::StateField> fields;
  std::vector<std::size_t> columns;  ///< beside `fields`: which field of the tables it is
  struct Source {
    std::size_t table;                    ///< of World::tables()
    std::vector<std::uint32_t> recorded;  ///< row of the table -> row here
  };
  std::vector<Source> sources;

  /// Bytes of one field of all rows.
  std::size_t bytes(std::size_t field) const;
};

/// The bodies that can move, sense or decide, in the order of their ids: the rows of /state.
std::vector<BodyId> recorded_bodies(const engine::World& world);

/// What each type is called in a recording, by TypeId: its name as one step of a path, made unique by "~2".
std::vector<std::string> recorded_type_names(const engine::World& world);

/// What `--record-fields` takes in this world, the short names first: components of every robot (pose),
/// fields of sensors (ranges), kinds (wander), single components (ranger/eye).
std::vector<std::string> recordable_names(const engine::World& world);

/// The components that the names choose, each once, in the order of the tables; "all" chooses all.
/// Throws std::invalid_argument: `unknown field "posse"; known: pose, velocity, ... (did you mean "pose"?)`.
std::vector<RecordedComponent> recorded_components(const engine::World& world,
                                                   std::span<const std::string> names);

/// What bytes of a field are where a body has it not: NaN, of which every byte is 0xff, or 0 where the
/// element has no such number.
std::byte absent(const engine::StateField& field);

/// Copies one component of the world's state, a field each buffer, row-major; rows without it are left alone,
/// those of bodies that are not in the world absent().
void gather(const engine::World& world, const RecordedComponent& component,
            std::span<const std::span<std::byte>> fields);

}  // namespace troupe::worldio
