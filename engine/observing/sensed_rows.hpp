#pragma once

#include "engine/world/world.hpp"

namespace troupe::engine {

/// Tells which rows of a state table have values. A state table holds one component of the state, such as the
/// readings of a sensor, with one row per body. The only rows without values are the readings of sensors that
/// never run, because the world file does not make them active (DeviceSpec::active), no controller uses them
/// and no program has subscribed to their body (World::senses()). The engine does not compute these readings,
/// so their bytes mean nothing.
class SensedRows {
 public:
  /// table: one of World::tables() of `world`. Both must outlive the object. Throws std::logic_error if the
  /// last step of the world threw (World::require_whole()).
  SensedRows(const World& world, const StateTable& table);

  /// Whether a row of the table has values. row: index in the table, below StateTable::rows()
  bool exist(std::size_t row) const {
    return !sensor_ || world_.senses(world_.row(table_.ids()[row]), *sensor_);
  }
  /// Whether all rows of the table have values; true for a table without rows.
  bool all_exist() const;
  /// Whether the table has rows, but no row has values.
  bool none_exists() const;

 private:
  const World& world_;
  const StateTable& table_;
  const BodyType::Device* sensor_ = nullptr;  // the sensor that writes the table; null if all its rows exist
};

}  // namespace troupe::engine
