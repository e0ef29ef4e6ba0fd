#pragma once

#include "engine/world/world.hpp"

namespace troupe::engine {

/// Tells which rows of a state table have meaningful values. A state table holds one component of the state,
/// such as the readings of a sensor, with one row per body. Only the readings of sensors that never run are
/// meaningless, because the engine does not compute them. The sensor of a body runs if at least one of these
/// conditions holds: the world file makes it active (DeviceSpec::active), a controller uses it, or a program
/// has subscribed to the body (World::subscribe()).
class SensedRows {
 public:
  /// `table` must be one of World::tables() of `world`. Both must outlive the object. Throws std::logic_error
  /// if the last step of the world threw (World::require_whole()).
  SensedRows(const World& world, const StateTable& table);

  /// Whether a row of the table has meaningful values. row: index in the table, below StateTable::rows()
  bool exist(std::size_t row) const {
    return !sensor_ || world_.senses(world_.row(table_.ids()[row]), *sensor_);
  }
  /// Whether all rows of the table have meaningful values; true for a table without rows.
  bool all_exist() const;
  /// Whether the table has rows, but none of them has meaningful values.
  bool none_exists() const;

 private:
  const World& world_;
  const StateTable& table_;
  const BodyType::Device* sensor_ = nullptr;  // the sensor that writes the table; null if all its rows exist
};

}  // namespace troupe::engine
