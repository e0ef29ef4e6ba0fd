#include "engine/observing/sensed_rows.hpp"

namespace troupe::engine {

SensedRows::SensedRows(const CommittedView& world, const StateTable& table) : table_(table) {
  const auto index = static_cast<std::size_t>(&table - world.tables().data());
  if (index == 0 || table.rows() == 0) return;  // BodyType::Device::table is 0 for a type without bodies
  // All rows of a device's table are bodies of one type. A search through all types would take most of the
  // time of a picture of thousands of types.
  for (const BodyType::Device& device : world.type(table.ids().front()).devices)
    if (device.table == index && device.kind->is_sensor() && !device.active) sensor_ = &device;
}

bool SensedRows::all_exist(const CommittedView& world) const {
  for (std::size_t row = 0; row < table_.rows(); ++row)
    if (!exist(world, row)) return false;
  return true;
}

bool SensedRows::none_exists(const CommittedView& world) const {
  for (std::size_t row = 0; row < table_.rows(); ++row)
    if (exist(world, row)) return false;
  return table_.rows() > 0;
}

}  // namespace troupe::engine
