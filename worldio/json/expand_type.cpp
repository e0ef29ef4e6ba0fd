#include "engine/spec/add_device.hpp"
#include "worldio/json/json_parts.hpp"
#include "worldio/json/type_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

namespace troupe::worldio {
namespace {

/// A part on which devices and other parts are mounted, and the joint that moves this part.
struct Stand {
  std::uint32_t part = 0;
  std::int32_t joint = engine::k_rigid;
};

/// A device whose mount is found only after all devices of the type are read, because the mount may come
/// later in the file. The mount is another device or, if `names_joint`, a joint that moves the device; `on`
/// is the name of the mount. `pointer` is the JSON pointer to this name, for errors; it is stored as text
/// because a DocumentPath lives only on the stack.
struct Riding {
  std::size_t device;
  std::string on;
  bool names_joint;
  Where where;
  std::string pointer;
};

/// Makes a type from its document.
class TypeExpander {
 public:
  TypeExpander(const engine::Registry& registry, ImageFolder& images, engine::TypeSpec& type, bool is_whole)
      : registry_(registry), images_(images), type_(type), is_whole_(is_whole) {}

  void expand_root(const TypeDocument& document, const DocumentPath& at);

 private:
  void expand_part(const PartDocument& document, const DocumentPath& at, const Stand& below);
  /// Adds the device that the part itself is. If the device has a joint that moves the part, changes the
  /// joint of the part and of `stand`. If the document gives the part no shape (`has_shape` is false), the
  /// part gets the shape of the device.
  void expand_own_device(const PartDocument& document, const DocumentPath& around, bool has_shape,
                         Stand& stand);
  void expand_contents(const PartDocument& document, const DocumentPath& at, const Stand& stand);
  void expand_device(const DeviceDocument& document, const DocumentPath& at, bool is_sensor,
                     const Stand& stand);
  engine::PartSpec device_part(const DeviceDocument& document, const engine::DeviceSpec& device,
                               const engine::DeviceKind& kind) const;
  std::size_t add_device(engine::DeviceSpec device, const engine::DeviceKind& kind);
  void expand_controller(const ControllerDocument& document, std::uint32_t part);
  /// Sets `joint` if the document names a joint or says that there is none (null). Otherwise `joint` keeps
  /// its value, such as the joint of the enclosing part.
  void expand_joint(const std::optional<JointName>& name, Where where, const DocumentPath& at,
                    std::int32_t& joint);
  Result<> find_joint(const std::string& name, std::int32_t& joint) const;
  Result<> put_on(engine::DeviceSpec& device, const std::string& on) const;
  void order_devices(const TypeDocument& document, const DocumentPath& at);

  const engine::Registry& registry_;
  ImageFolder& images_;
  engine::TypeSpec& type_;
  const bool is_whole_;  // whether the document was read without errors
  std::vector<Riding> riding_;
  // The names and the kinds of the devices of the type, and those devices, by name, on which others can be
  // mounted. A search through the devices for each new device would take an hour for the many devices that
  // rings can add.
  std::unordered_set<std::string> device_names_;
  std::unordered_map<std::string, std::size_t> devices_of_kind_;
  std::unordered_map<std::string, std::size_t> carriers_;
  engine::UniqueNames joint_names_{engine::k_device_mark};
};

void TypeExpander::expand_root(const TypeDocument& document, const DocumentPath& at) {
  if (!document.name.empty()) type_.name = document.name;
  engine::PartSpec root{.where = document.where};
  const bool has_shape = expand_shape(document, at, images_, root);
  root.returns = document.returns;
  if (document.drive && !document.drive->kind.empty())
    type_.drive = engine::DriveSpec{.kind = document.drive->kind,
                                    .params = document.drive->params,
                                    .period_s = document.drive->period,
                                    .where = document.drive->where};
  root.kind = !document.kind.empty() ? document.kind : type_.drive ? "position" : "model";
  type_.parts.push_back(std::move(root));

  Stand stand;
  expand_own_device(document, at, has_shape, stand);
  expand_contents(document, at, stand);
  for (const Riding& rider : riding_) {
    engine::DeviceSpec& device = type_.devices[rider.device];
    const Result<> stands = rider.names_joint ? find_joint(rider.on, device.joint) : put_on(device, rider.on);
    if (!stands && is_whole_)
      at.diagnostics().error(rider.where, fmt::format("{}: {}", rider.pointer, stands.error().text));
  }
  order_devices(document, at);
  // Only controllers of the root part are checked: those of other parts may command wheels, which are
  // devices.
  const auto needs_drive = [&](const engine::ControllerSpec& controller) {
    const engine::ControllerKind* kind = registry_.controller(controller.kind);
    return controller.part == 0 && (kind == nullptr || kind->needs_drive);
  };
  if (!document.drive && std::ranges::any_of(type_.controllers, needs_drive))
    at.error_at(document.where_of(document.controller ? "controller" : "controllers"),
                "the controller commands a drive, but the type has none: add a \"drive\"");
}

void TypeExpander::expand_part(const PartDocument& document, const DocumentPath& at, const Stand& below) {
  engine::PartSpec part{.name = document.name,
                        .alias = document.alias,
                        .kind = document.kind.empty() ? "model" : document.kind,
                        .parent = below.part,
                        .joint = below.joint,
                        .pose_body_part = document.pose.value_or(Pose()),
                        .returns = document.returns,
                        .color = document.color,
                        .where = document.where};
  const bool has_shape = expand_shape(document, at, images_, part);
  expand_joint(document.joint, document.where_of("joint"), at, part.joint);
  Stand stand{static_cast<std::uint32_t>(type_.parts.size()), part.joint};
  type_.parts.push_back(std::move(part));
  expand_own_device(document, at, has_shape, stand);
  expand_contents(document, at, stand);
}

void TypeExpander::expand_own_device(const PartDocument& document, const DocumentPath& around, bool has_shape,
                                     Stand& stand) {
  // The size is set before the body of the device is added, because the moving parts of that body copy the
  // size.
  if (document.extent) type_.parts[stand.part].size = *document.extent;
  if (!document.device) return;
  const OwnDeviceDocument& own = *document.device;
  const engine::DeviceKind* kind = registry_.device(own.kind);
  if (!kind) return;
  const DocumentPath at(around, "device", own.where);
  const engine::PartSpec& part = type_.parts[stand.part];
  engine::DeviceSpec device{.name = own.name.empty() ? part.name : own.name,
                            .kind = own.kind,
                            .part = stand.part,
                            .joint = stand.joint,
                            .params = own.params,
                            .pose_body_device = own.pose.value_or(part.pose_body_part),
                            .period_s = own.period,
                            .active = own.active,
                            .where = own.where};
  expand_joint(own.joint, own.where_of("joint"), at, device.joint);
  const std::size_t d = add_device(std::move(device), *kind);
  if (moves_itself(*kind)) type_.parts[stand.part].joint = stand.joint = type_.devices[d].moves;
  if (!kind->body || has_shape) return;
  engine::add_device_body(type_, d, *kind);
  if (!document.extent) measure_part(type_.parts[stand.part]);
}

void TypeExpander::expand_contents(const PartDocument& document, const DocumentPath& at, const Stand& stand) {
  const auto each = [&](std::string_view key, const auto& list, auto expand) {
    const DocumentPath all(at, key, document.where_of(key));
    for (std::size_t i = 0; i < list.size(); ++i) expand(list[i], DocumentPath(all, i, list[i].where));
  };
  each("sensors", document.sensors, [&](const SensorDocument& sensor, const DocumentPath& path) {
    expand_device(sensor, path, true, stand);
  });
  each("devices", document.devices, [&](const DeviceDocument& device, const DocumentPath& path) {
    expand_device(device, path, false, stand);
  });
  if (document.controller) expand_controller(*document.controller, stand.part);
  for (const ControllerDocument& controller : document.controllers) expand_controller(controller, stand.part);
  each("parts", document.parts,
       [&](const PartDocument& part, const DocumentPath& path) { expand_part(part, path, stand); });
}

/// Mounts `device` on the device named `on`. Returns an error if the type has no such device yet, or if that
/// device does not have exactly one joint.
Result<> TypeExpander::put_on(engine::DeviceSpec& device, const std::string& on) const {
  if (const auto found = carriers_.find(on); found != carriers_.end()) {
    const engine::DeviceSpec& carrier = type_.devices[found->second];
    device.part = carrier.part;
    device.joint = carrier.moves;
    device.pose_body_device = compose(carrier.pose_body_device, device.pose_body_device);
    return {};
  }
  if (carriers_.empty())
    return Error{fmt::format(
        "expected the name of a device with a joint, such as an actuator, found \"{}\": add such a device to "
        "\"devices\"; an entry of \"devices\" must come after the device on which it is mounted",
        on)};
  std::vector<std::string_view> known;
  for (const engine::DeviceSpec& each : type_.devices)
    if (carriers_.contains(each.name)) known.push_back(each.name);
  return Error{unknown_name("device with a joint", on, known)};
}

/// Returns the part that a device with a joint adds to the type. Its solids come from the size and blocks in
/// the document, unless the kind of the device has a body of its own: the caller adds such a body later.
engine::PartSpec TypeExpander::device_part(const DeviceDocument& document, const engine::DeviceSpec& device,
                                           const engine::DeviceKind& kind) const {
  // The kind of a part must be a model kind. Some kinds of devices with a joint, such as "wheels", are not.
  engine::PartSpec part{.name = device.name,
                        .kind = registry_.model(device.kind) ? device.kind : "model",
                        .pose_body_part = device.pose_body_device,
                        .returns = document.returns,
                        .color = document.color,
                        .where = device.where};
  if (!kind.body) part.solids = expand_solids(document.size, document.blocks, device.pose_body_device);
  return part;
}

/// Adds a device to the type. Returns its index.
std::size_t TypeExpander::add_device(engine::DeviceSpec device, const engine::DeviceKind& kind) {
  device_names_.insert(device.name);
  ++devices_of_kind_[device.kind];
  if (kind.joints.size() == 1) carriers_.try_emplace(device.name, type_.devices.size());
  return engine::add_device(type_, std::move(device), kind, joint_names_);
}

void TypeExpander::expand_device(const DeviceDocument& document, const DocumentPath& at, bool is_sensor,
                                 const Stand& stand) {
  const engine::DeviceKind* kind = registry_.device(document.kind);
  if (!kind) return;
  engine::DeviceSpec device{.name = document.name,
                            .kind = document.kind,
                            .part = stand.part,
                            .joint = stand.joint,
                            .params = document.params,
                            .pose_body_device = document.pose.value_or(Pose()),
                            .period_s = document.period,
                            .active = document.active,
                            .where = document.where};
  if (device.name.empty()) {  // "ranger:1", as Stage names the second ranger of a robot
    device.name = fmt::format("{}:{}", device.kind, devices_of_kind_[device.kind]);
  } else if (device_names_.contains(device.name)) {
    DocumentPath(at, "name", document.where_of("name"))
        .error(fmt::format("the type already has a {} \"{}\": choose another name",
                           is_sensor ? "sensor" : "device", device.name));
  }
  const bool has_part = !kind->joints.empty();
  if (!document.on.empty()) {
    const DocumentPath on(at, "on", document.where_of("on"));
    if (is_sensor) {
      riding_.push_back({type_.devices.size(), document.on, false, on.where(), on.pointer()});
    } else if (const Result<> put = put_on(device, document.on); !put) {
      if (is_whole_) on.error(put.error().text);
      return;
    }
  }
  if (!has_part && document.joint && document.joint->name) {
    const DocumentPath joint(at, "joint", document.where_of("joint"));
    riding_.push_back({type_.devices.size(), *document.joint->name, true, joint.where(), joint.pointer()});
  } else {
    expand_joint(document.joint, document.where_of("joint"), at, device.joint);
  }
  if (has_part) {
    engine::PartSpec part = device_part(document, device, *kind);
    part.parent = device.part;
    part.joint = kind->body ? device.joint : static_cast<std::int32_t>(type_.joints.size());
    device.part = static_cast<std::uint32_t>(type_.parts.size());
    type_.parts.push_back(std::move(part));
  }
  const std::size_t part = device.part;
  const std::size_t d = add_device(std::move(device), *kind);
  if (has_part) {
    engine::add_device_body(type_, d, *kind);
    measure_part(type_.parts[part]);
  }
}

void TypeExpander::expand_controller(const ControllerDocument& document, std::uint32_t part) {
  if (document.kind.empty()) return;
  type_.controllers.push_back({.kind = document.kind,
                               .part = part,
                               .params = document.params,
                               .period_s = document.period,
                               .where = document.where});
}

void TypeExpander::expand_joint(const std::optional<JointName>& name, Where where, const DocumentPath& at,
                                std::int32_t& joint) {
  if (!name) return;
  if (!name->name)
    joint = engine::k_rigid;
  else if (const Result<> found = find_joint(*name->name, joint); !found && is_whole_)
    DocumentPath(at, "joint", where).error(found.error().text);
}

Result<> TypeExpander::find_joint(const std::string& name, std::int32_t& joint) const {
  const auto found = std::ranges::find(type_.joints, name, &engine::JointSpec::name);
  if (found == type_.joints.end()) return Error{unknown_name("joint", name, name_list(type_.joints))};
  joint = static_cast<std::int32_t>(found - type_.joints.begin());
  return {};
}

void TypeExpander::order_devices(const TypeDocument& document, const DocumentPath& at) {
  if (!document.device_order || !is_whole_) return;
  const auto error = [&](const std::string& what) {
    DocumentPath(at, "device_order", document.where_of("device_order"))
        .error(what + ": list every device of the type exactly once");
  };
  std::unordered_map<std::string_view, std::size_t> index_of;
  for (std::size_t d = 0; d < type_.devices.size(); ++d) index_of.try_emplace(type_.devices[d].name, d);
  std::vector<bool> listed(type_.devices.size(), false);
  std::vector<std::size_t> order;
  for (const std::string& name : *document.device_order) {
    const auto found = index_of.find(name);
    if (found == index_of.end()) return error(fmt::format("\"{}\" is not a device of the type", name));
    if (listed[found->second]) return error(fmt::format("\"{}\" is listed twice", name));
    listed[found->second] = true;
    order.push_back(found->second);
  }
  if (const auto missing = std::ranges::find(listed, false); missing != listed.end())
    return error(fmt::format("the device \"{}\" is missing",
                             type_.devices[static_cast<std::size_t>(missing - listed.begin())].name));
  std::vector<engine::DeviceSpec> ordered;
  for (const std::size_t d : order) ordered.push_back(std::move(type_.devices[d]));
  type_.devices = std::move(ordered);
}

}  // namespace

engine::TypeSpec expand_type(const TypeDocument& document, const std::string& key, const DocumentPath& at,
                             const engine::Registry& registry, ImageFolder& images, bool is_whole) {
  engine::TypeSpec type{.name = key};
  TypeExpander(registry, images, type, is_whole).expand_root(document, at);
  return type;
}

}  // namespace troupe::worldio
