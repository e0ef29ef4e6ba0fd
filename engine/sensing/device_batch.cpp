#include "engine/kinds/device_kind.hpp"
#include "engine/sensing/sensing_view.hpp"

#include <cstddef>
#include <stdexcept>
#include <string_view>

// The functions of DeviceBatch and DeviceView that read the world.

namespace troupe::engine {
namespace {

const BodyType::Device& device_of(const DeviceBatch& batch, Row row, std::size_t its_device) {
  const std::vector<BodyType::Device>& devices = batch.view.type(row).devices;
  if (its_device >= devices.size())
    throw std::out_of_range("uses the device with the index " + std::to_string(its_device) +
                            " (counted from 0) of its body, which has only " +
                            std::to_string(devices.size()) + " devices");
  return devices[its_device];
}

}  // namespace

BodyId DeviceBatch::body(std::size_t i) const { return view.body(row(i)); }
std::size_t DeviceBatch::slot(std::size_t i) const { return view.slot(row(i)); }
Random DeviceBatch::random(std::size_t i) const {
  return {view.spec().seed, stream, body(i).value, static_cast<std::uint32_t>(view.tick())};
}
Random DeviceBatch::random(std::size_t i, std::string_view name) const {
  const auto own = static_cast<std::uint32_t>(mix(stream, stream_id("device", name)));
  return {view.spec().seed, own, body(i).value, static_cast<std::uint32_t>(view.tick())};
}
Mount DeviceBatch::mount(std::size_t i) const {
  return view.mount(row(i), view.type(row(i)).devices[device].joint);
}
const Velocity& DeviceBatch::velocity(std::size_t i) const { return view.velocity(row(i)); }
const Command& DeviceBatch::command(std::size_t i) const { return view.command(row(i)); }
bool DeviceBatch::senses(std::size_t i, std::size_t its_device) const {
  return view.senses(row(i), device_of(*this, row(i), its_device));
}
bool DeviceBatch::is_on(std::size_t i, std::size_t its_device) const {
  return view.is_on(row(i), device_of(*this, row(i), its_device));
}
bool DeviceBatch::runs(std::size_t i, std::size_t its_device) const {
  return view.runs(row(i), device_of(*this, row(i), its_device));
}
const StateTable& DeviceBatch::percepts(std::size_t its_device) const {
  return view.percepts(device_of(*this, row(0), its_device));
}

Eigen::Vector3d DeviceView::at(double x, double y, double z) const {
  const Vec2 p = Transform(pose_world_device) * Vec2(x, y);
  return {p.x(), p.y(), pose_world_device.z + z};
}

}  // namespace troupe::engine
