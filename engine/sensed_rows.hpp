#pragma once

#include "engine/world.hpp"

namespace troupe::engine {

/// Tells which rows of a state table have values. All rows have, except the readings of sensors that never
/// run (World::senses()): the engine does not compute these readings, so their bytes mean nothing.
class SensedRows {
 public:
  /// table: one of the tables of `world`. Both must outlive the object.
  SensedRows(const World& world, const StateTable& table);

  /// Whether the values of a row of the table exist. row: its number in the table, below rows().
  bool exist(std::size_t row) const {
    return !sensor_ || world_.senses(world_.row(table_.ids()[row]), *sensor_);
  }
  /// Whether the values of all rows exist.
  bool all_exist() const;
  /// Whether the table has rows, but the values of none of them exist.
  bool none_exists() const;

 private:
  const World& world_;
  const StateTable& table_;
  const BodyType::Device* sensor_ = nullptr;  // the sensor that writes the table; null if all its rows exist
};

}  // namespace troupe::engine
