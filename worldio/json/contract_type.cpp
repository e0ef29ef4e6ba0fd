#include "engine/spec/add_device.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/json/spec_difference.hpp"
#include "worldio/json/type_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

namespace troupe::worldio {
namespace {

using engine::DeviceKind;
using engine::DeviceSpec;
using engine::PartSpec;

template <class Kind>
const Kind& known(const Kind* kind, const std::string& name) {
  if (!kind)
    throw std::runtime_error(
        fmt::format("the world uses the kind \"{}\", which is neither built in nor defined by a loaded "
                    "plug-in: load its plug-in first",
                    name));
  return *kind;
}

/// Makes the document of a type. It omits every value that expand_type() would assume anyway, such as the
/// pose of a device that is at the origin of its part.
class TypeContractor {
 public:
  TypeContractor(const engine::TypeSpec& type, const engine::Registry& registry,
                 const std::filesystem::path* folder)
      : type_(type), registry_(registry), folder_(folder) {}

  TypeDocument contract(const std::string& key, const std::optional<Color>& color) {
    TypeDocument document;
    if (type_.name != key) document.name = type_.name;
    color_ = color;
    if (type_.drive) {
      const engine::DriveSpec& drive = *type_.drive;
      document.drive.emplace();
      document.drive->where = drive.where;
      document.drive->kind = drive.kind;
      document.drive->period = drive.period_s;
      document.drive->params = drive.params;
    }
    contract_part(0, engine::k_rigid, document);
    if (!std::ranges::is_sorted(order_)) {
      document.device_order.emplace();
      for (const DeviceSpec& device : type_.devices) document.device_order->push_back(device.name);
    }
    return document;
  }

 private:
  /// The parts and the size that expand_type() gives a part because the part is itself a device. The document
  /// omits these parts and this size.
  struct Brought {
    std::size_t parts = 0;          ///< number of added parts, which directly follow this one
    Eigen::Vector3d size{0, 0, 0};  ///< size of this part after expansion, m
    bool needs_extent = false;      ///< whether the document also has the key `extent`
  };

  const DeviceKind& kind_of(std::size_t device) const {
    const std::string& name = type_.devices[device].kind;
    return known(registry_.device(name), name);
  }

  void contract_part(std::uint32_t p, std::int32_t joint, PartDocument& document);
  void contract_contents(std::uint32_t p, const std::optional<std::size_t>& own, std::int32_t joint,
                         const std::vector<bool>& is_brought, PartDocument& document);
  std::optional<std::size_t> own_device(std::uint32_t p) const;
  std::optional<Brought> brought(std::uint32_t p, std::size_t device) const;
  OwnDeviceDocument contract_own_device(std::size_t device, std::int32_t joint);
  /// Sets the members that all devices have. A pose or joint that equals `usual_pose` or `usual_joint` is
  /// left out of the document.
  void contract_device(std::size_t d, const Pose& usual_pose, std::int32_t usual_joint,
                       DeviceDocument& document);
  std::optional<JointName> joint_name(std::int32_t joint, std::int32_t usual) const;

  const engine::TypeSpec& type_;
  const engine::Registry& registry_;
  const std::filesystem::path* folder_;
  std::optional<Color> color_;
  std::vector<std::size_t> order_;  // indices of the devices in the order that they have after expansion
};

void TypeContractor::contract_part(std::uint32_t p, std::int32_t joint, PartDocument& document) {
  const PartSpec& part = type_.parts[p];
  document.where = part.where;
  const bool is_root = p == 0;
  const std::optional<std::size_t> own = own_device(p);
  const bool is_moved_by_itself = own && moves_itself(kind_of(*own));
  if (!is_root) {
    document.name = part.name;
    document.alias = part.alias;
  }
  if (part.kind != (is_root && type_.drive ? "position" : "model")) document.kind = part.kind;
  if (!is_root) {
    if (!same_bits(part.pose_body_part, Pose())) document.pose = part.pose_body_part;
    if (!is_moved_by_itself) {
      document.joint = joint_name(part.joint, joint);
      joint = part.joint;
    }
  }

  const std::optional<Brought> made = own ? brought(p, *own) : std::nullopt;
  Eigen::Vector3d size_expanded = PartSpec().size;
  if (made)
    size_expanded = made->size;
  else if (is_root || !part.solids.empty() || part.floor_plan || (own && kind_of(*own).body))
    size_expanded = contract_shape(part, folder_, document);
  contract_extent(part, made && made->needs_extent ? Eigen::Vector3d(-part.size) : size_expanded, document);
  document.color = is_root ? color_ : part.color;
  document.returns = part.returns;
  if (own) {
    document.device = contract_own_device(*own, joint);
    if (is_moved_by_itself) joint = type_.devices[*own].moves;
  }
  std::vector<bool> is_brought(type_.parts.size(), false);
  if (made) std::fill_n(is_brought.begin() + p + 1, made->parts, true);
  contract_contents(p, own, joint, is_brought, document);
}

void TypeContractor::contract_contents(std::uint32_t p, const std::optional<std::size_t>& own,
                                       std::int32_t joint, const std::vector<bool>& is_brought,
                                       PartDocument& document) {
  for (const bool is_sensor : {true, false})
    for (std::size_t d = 0; d < type_.devices.size(); ++d) {
      if (type_.devices[d].part != p || d == own || kind_of(d).is_sensor() != is_sensor) continue;
      DeviceDocument& device = is_sensor ? document.sensors.emplace_back() : document.devices.emplace_back();
      device.name = type_.devices[d].name;
      contract_device(d, Pose(), joint, device);
    }
  std::vector<ControllerDocument> controllers;
  for (const engine::ControllerSpec& spec : type_.controllers) {
    if (spec.part != p) continue;
    ControllerDocument& controller = controllers.emplace_back();
    controller.where = spec.where;
    controller.kind = spec.kind;
    controller.period = spec.period_s;
    controller.params = spec.params;
  }
  if (controllers.size() == 1)
    document.controller = std::move(controllers.front());
  else
    document.controllers = std::move(controllers);
  for (std::uint32_t q = p + 1; q < type_.parts.size(); ++q)
    if (type_.parts[q].parent == p && !is_brought[q]) contract_part(q, joint, document.parts.emplace_back());
}

/// Returns the index of the device that a part itself is: the first of its devices that has a joint, or else
/// the first that has the name of the part and the kind ModelKind::device of the part's model kind. Empty if
/// the part has neither.
std::optional<std::size_t> TypeContractor::own_device(std::uint32_t p) const {
  const PartSpec& part = type_.parts[p];
  const engine::ModelKind* model = registry_.model(part.kind);
  std::optional<std::size_t> own;
  for (std::size_t d = 0; d < type_.devices.size(); ++d) {
    const DeviceSpec& device = type_.devices[d];
    if (device.part != p) continue;
    if (!kind_of(d).joints.empty()) return d;
    if (!own && model && model->device == device.kind && device.name == part.name) own = d;
  }
  return own;
}

/// Returns what expand_type() would make of part `p` if the document said only that the part itself is the
/// device with index `device`: the size of the part, and the number of parts added directly after it. Empty
/// if part `p` or these parts differ from what expand_type() would make, if the kind of the device has no
/// body, or if the part has an image.
std::optional<TypeContractor::Brought> TypeContractor::brought(std::uint32_t p, std::size_t device) const {
  if (!kind_of(device).body || type_.parts[p].image) return std::nullopt;
  for (const bool needs_extent : {true, false}) {
    engine::TypeSpec read = type_;
    read.parts.resize(p + 1);
    read.parts[p].solids.clear();
    if (!needs_extent) read.parts[p].size = PartSpec().size;
    engine::add_device_body(read, device, kind_of(device));
    if (!needs_extent) measure_part(read.parts[p]);
    const std::size_t parts = read.parts.size() - p - 1;
    bool is_same = read.parts.size() <= type_.parts.size();
    for (std::size_t q = p; is_same && q < read.parts.size(); ++q)
      is_same = same_part(read.parts[q], type_.parts[q]);
    if (is_same) return Brought{parts, read.parts[p].size, needs_extent};
  }
  return std::nullopt;
}

OwnDeviceDocument TypeContractor::contract_own_device(std::size_t d, std::int32_t joint) {
  const DeviceSpec& device = type_.devices[d];
  const PartSpec& part = type_.parts[device.part];
  const engine::ModelKind* model = registry_.model(part.kind);
  OwnDeviceDocument document;
  document.is_kind_implied = model && model->device == device.kind;
  if (device.name != part.name) document.name = device.name;
  contract_device(d, part.pose_body_part, joint, document);
  return document;
}

void TypeContractor::contract_device(std::size_t d, const Pose& usual_pose, std::int32_t usual_joint,
                                     DeviceDocument& document) {
  const DeviceSpec& device = type_.devices[d];
  document.where = device.where;
  document.kind = device.kind;
  if (!same_bits(device.pose_body_device, usual_pose)) document.pose = device.pose_body_device;
  document.joint = joint_name(device.joint, usual_joint);
  document.active = device.active;
  document.period = device.period_s;
  document.params = device.params;
  order_.push_back(d);
}

std::optional<JointName> TypeContractor::joint_name(std::int32_t joint, std::int32_t usual) const {
  if (joint == usual) return std::nullopt;
  JointName name;
  if (joint != engine::k_rigid) name.name = type_.joints[static_cast<std::size_t>(joint)].name;
  return name;
}

}  // namespace

TypeDocument contract_type(const engine::TypeSpec& type, const std::string& key,
                           const std::optional<Color>& color, const engine::Registry& registry,
                           const std::filesystem::path* folder) {
  return TypeContractor(type, registry, folder).contract(key, color);
}

}  // namespace troupe::worldio
