#pragma once

#include "engine/sensing/sensing_view.hpp"

#include <cstddef>

namespace troupe::engine {

/// Tells which rows of a state table have meaningful values. A state table holds one component of the state,
/// such as the readings of a sensor, with one row per body. Only the readings of sensors that never run are
/// meaningless, because the engine does not compute them. The sensor of a body runs if at least one of these
/// conditions holds: the world file makes it active (DeviceSpec::active), a controller uses it, or a program
/// has subscribed to the body (World::subscribe()).
class SensedRows {
 public:
  /// `table` must be one of the tables of `world`, and must outlive the object.
  SensedRows(const CommittedView& world, const StateTable& table);

  /// Whether a row of the table has meaningful values. `world` is the present view of the same world, here
  /// and below. row: index in the table, below StateTable::rows()
  bool exist(const CommittedView& world, std::size_t row) const {
    return !sensor_ || world.senses(world.row(table_.ids()[row]), *sensor_);
  }
  /// Whether all rows of the table have meaningful values; true for a table without rows.
  bool all_exist(const CommittedView& world) const;
  /// Whether the table has rows, but none of them has meaningful values.
  bool none_exists(const CommittedView& world) const;

 private:
  const StateTable& table_;
  const BodyType::Device* sensor_ = nullptr;  // the sensor that writes the table; null if all its rows exist
};

}  // namespace troupe::engine
