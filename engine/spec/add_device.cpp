#include "engine/spec/add_device.hpp"

#include "engine/kinds/thrown_text.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>
#include <vector>

namespace troupe::engine {

std::size_t add_device(TypeSpec& type, DeviceSpec device, const DeviceKind& kind) {
  UniqueNames joint_names(k_device_mark);
  for (const JointSpec& joint : type.joints) joint_names.add(joint.name);
  return add_device(type, std::move(device), kind, joint_names);
}

std::size_t add_device(TypeSpec& type, DeviceSpec device, const DeviceKind& kind, UniqueNames& joint_names) {
  if (!kind.joints.empty()) device.moves = static_cast<std::int32_t>(type.joints.size());
  for (const std::string_view joint : kind.joints) {
    const std::string stem = device.name.empty() ? std::string(kind.name) : device.name;
    const std::string base = kind.joints.size() == 1 ? stem : fmt::format("{}/{}", stem, joint);
    type.joints.push_back({joint_names.add(base), device.joint, device.pose_body_device});
  }
  type.devices.push_back(std::move(device));
  return type.devices.size() - 1;
}

void add_device_body(TypeSpec& type, std::size_t d, const DeviceKind& kind) {
  if (!kind.body) return;
  const DeviceSpec& device = type.devices[d];
  std::vector<PartSpec> moving;
  for (std::size_t j = 0; j < kind.joints.size(); ++j) {
    PartSpec part = type.parts[device.part];
    part.name =
        part.name.empty() ? std::string(kind.joints[j]) : fmt::format("{}.{}", part.name, kind.joints[j]);
    part.alias.clear();
    part.parent = device.part;
    part.joint = device.moves + static_cast<std::int32_t>(j);
    part.solids.clear();
    moving.push_back(std::move(part));
  }
  std::vector<DeviceKind::Fixture> fixtures;
  try {
    fixtures = kind.body(device.params);
  } catch (...) {
    throw std::runtime_error(fmt::format("device \"{}\" ({}) {}", device.name, kind.name, thrown_text()));
  }
  for (const DeviceKind::Fixture& fixture : fixtures)
    if (fixture.joint >= static_cast<std::int32_t>(moving.size()))
      throw std::runtime_error(fmt::format(
          "device \"{}\" ({}) has a solid on the joint {} (DeviceKind::Fixture::joint), but only {} joints",
          device.name, kind.name, fixture.joint, moving.size()));
  for (DeviceKind::Fixture& fixture : fixtures) {
    PartSpec& part =
        fixture.joint < 0 ? type.parts[device.part] : moving[static_cast<std::size_t>(fixture.joint)];
    part.solids.push_back(placed(std::move(fixture.solid), device.pose_body_device));
  }
  for (PartSpec& part : moving)
    if (!part.solids.empty()) type.parts.push_back(std::move(part));
}

}  // namespace troupe::engine
