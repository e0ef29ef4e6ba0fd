#include "engine/add_device.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/json/json_text.hpp"
#include "worldio/json/json_types.hpp"
#include "worldio/json/spec_difference.hpp"

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
    throw std::runtime_error(fmt::format("the world uses a kind \"{}\" that nobody registered", name));
  return *kind;
}

void write_period(double period_s, const engine::FieldTable& params, JsonNode::Object& object) {
  if (!worldio::same_bits(period_s, 0)) write_field(period_field(params), period_s, object);
}

/// Says how a type was read, key by key, and so must know what a reader takes for granted: the part, the
/// joint and the pose of what is not told otherwise.
class TypeWriter {
 public:
  TypeWriter(const engine::TypeSpec& type, const engine::Registry& registry,
             const std::filesystem::path* folder)
      : type_(type), registry_(registry), folder_(folder) {}

  JsonNode node(const std::string& key, const std::optional<Color>& color) {
    JsonNode::Object object;
    if (type_.name != key) add_member(object, "name", type_.name);
    color_ = color;
    write_part(0, engine::k_rigid, object);
    if (!std::ranges::is_sorted(order_)) {
      JsonNode::List names;
      for (const DeviceSpec& device : type_.devices) names.push_back(json_node(device.name));
      add_member(object, "device_order", std::move(names));
    }
    return json_node(std::move(object), type_.parts.front().where);
  }

 private:
  /// What the device that a part is brings along, and so need not be said.
  struct Brought {
    std::size_t parts = 0;          ///< that follow the part itself
    Eigen::Vector3d size{0, 0, 0};  ///< of the part, once it is read
    bool needs_extent = false;
  };

  const DeviceKind& kind_of(std::size_t device) const {
    const std::string& name = type_.devices[device].kind;
    return known(registry_.device(name), name);
  }

  void write_part(std::uint32_t p, std::int32_t joint, JsonNode::Object& object);
  void write_contents(std::uint32_t p, const std::optional<std::size_t>& own, std::int32_t joint,
                      const std::vector<bool>& is_brought, JsonNode::Object& object);
  std::optional<std::size_t> own_device(std::uint32_t p) const;
  std::optional<Brought> brought(std::uint32_t p, std::size_t device) const;
  JsonNode own_device_node(std::size_t device, std::int32_t joint);
  JsonNode device_node(std::size_t device, std::int32_t joint);
  JsonNode drive_node(const engine::DriveSpec& drive) const;
  JsonNode controller_node(const engine::ControllerSpec& controller) const;
  void write_joint(std::int32_t joint, std::int32_t expected, JsonNode::Object& object) const;

  const engine::TypeSpec& type_;
  const engine::Registry& registry_;
  const std::filesystem::path* folder_;
  std::optional<Color> color_;
  std::vector<std::size_t> order_;  // of the devices, as they are read
};

void TypeWriter::write_part(std::uint32_t p, std::int32_t joint, JsonNode::Object& object) {
  const PartSpec& part = type_.parts[p];
  const bool is_root = p == 0;
  const std::optional<std::size_t> own = own_device(p);
  const bool is_moved_by_itself = own && moves_itself(kind_of(*own));
  if (!is_root) {
    add_member(object, "name", part.name);
    if (!part.alias.empty()) add_member(object, "alias", part.alias);
  }
  if (part.kind != (is_root && type_.drive ? "position" : "model")) add_member(object, "kind", part.kind);
  if (!is_root) {
    write_pose(part.pose_body_part, object);
    if (!is_moved_by_itself) {
      write_joint(part.joint, joint, object);
      joint = part.joint;
    }
  }

  const std::optional<Brought> made = own ? brought(p, *own) : std::nullopt;
  Eigen::Vector3d size_read = PartSpec().size;
  if (made)
    size_read = made->size;
  else if (is_root || !part.solids.empty() || part.floor_plan || (own && kind_of(*own).body))
    size_read = write_shape(part, folder_, object);
  if (made && made->needs_extent)
    write_extent(part, -part.size, object);
  else
    write_extent(part, size_read, object);
  const std::optional<Color> color = is_root ? color_ : part.color;
  if (color) add_node(object, "color", color_node(*color));
  write_returns(part.returns, object);
  if (is_root && type_.drive) add_node(object, "drive", drive_node(*type_.drive));
  if (own) {
    add_node(object, "device", own_device_node(*own, joint));
    if (is_moved_by_itself) joint = type_.devices[*own].moves;
  }
  std::vector<bool> is_brought(type_.parts.size(), false);
  if (made) std::fill_n(is_brought.begin() + p + 1, made->parts, true);
  write_contents(p, own, joint, is_brought, object);
}

void TypeWriter::write_contents(std::uint32_t p, const std::optional<std::size_t>& own, std::int32_t joint,
                                const std::vector<bool>& is_brought, JsonNode::Object& object) {
  JsonNode::List controllers;
  JsonNode::List parts;
  for (const bool is_sensor : {true, false}) {
    JsonNode::List list;
    for (std::size_t d = 0; d < type_.devices.size(); ++d)
      if (type_.devices[d].part == p && d != own && kind_of(d).is_sensor() == is_sensor)
        list.push_back(device_node(d, joint));
    if (!list.empty()) add_member(object, is_sensor ? "sensors" : "devices", std::move(list));
  }
  for (const engine::ControllerSpec& controller : type_.controllers)
    if (controller.part == p) controllers.push_back(controller_node(controller));
  if (controllers.size() == 1)
    add_node(object, "controller", std::move(controllers.front()));
  else if (!controllers.empty())
    add_member(object, "controllers", std::move(controllers));
  for (std::uint32_t q = p + 1; q < type_.parts.size(); ++q) {
    if (type_.parts[q].parent != p || is_brought[q]) continue;
    JsonNode::Object part;
    write_part(q, joint, part);
    parts.push_back(json_node(std::move(part), type_.parts[q].where));
  }
  if (!parts.empty()) add_member(object, "parts", std::move(parts));
}

/// The device that a part itself is: the one that moves it or something of it, or that models of its kind
/// are.
std::optional<std::size_t> TypeWriter::own_device(std::uint32_t p) const {
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

/// Empty where the part and those behind it are not what the device would bring along.
std::optional<TypeWriter::Brought> TypeWriter::brought(std::uint32_t p, std::size_t device) const {
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

JsonNode TypeWriter::own_device_node(std::size_t d, std::int32_t joint) {
  const DeviceSpec& device = type_.devices[d];
  const DeviceKind& kind = kind_of(d);
  const PartSpec& part = type_.parts[device.part];
  const engine::ModelKind* model = registry_.model(part.kind);
  JsonNode::Object object;
  if (!model || model->device != device.kind) add_member(object, "kind", device.kind);
  if (device.name != part.name) add_member(object, "name", device.name);
  write_pose(device.pose_body_sensor, object, part.pose_body_part);
  write_joint(device.joint, joint, object);
  if (!device.active) add_member(object, "active", false);
  write_period(device.period_s, kind.params, object);
  write_fields(device.params, kind.params, object);
  order_.push_back(d);
  return json_node(std::move(object), device.where);
}

JsonNode TypeWriter::device_node(std::size_t d, std::int32_t joint) {
  const DeviceSpec& device = type_.devices[d];
  const DeviceKind& kind = kind_of(d);
  JsonNode::Object object;
  add_member(object, "name", device.name);
  add_member(object, "kind", device.kind);
  write_pose(device.pose_body_sensor, object);
  write_joint(device.joint, joint, object);
  if (!device.active) add_member(object, "active", false);
  write_period(device.period_s, kind.params, object);
  write_fields(device.params, kind.params, object);
  order_.push_back(d);
  return json_node(std::move(object), device.where);
}

JsonNode TypeWriter::drive_node(const engine::DriveSpec& drive) const {
  const engine::DriveKind& kind = known(registry_.drive(drive.kind), drive.kind);
  JsonNode::Object object;
  add_member(object, "kind", drive.kind);
  write_period(drive.period_s, kind.params, object);
  write_fields(drive.params, kind.params, object);
  return json_node(std::move(object), drive.where);
}

JsonNode TypeWriter::controller_node(const engine::ControllerSpec& controller) const {
  const engine::ControllerKind& kind = known(registry_.controller(controller.kind), controller.kind);
  JsonNode::Object object;
  add_member(object, "kind", controller.kind);
  write_period(controller.period_s, kind.params, object);
  write_fields(controller.params, kind.params, object);
  return json_node(std::move(object), controller.where);
}

void TypeWriter::write_joint(std::int32_t joint, std::int32_t expected, JsonNode::Object& object) const {
  if (joint == expected) return;
  if (joint == engine::k_rigid)
    add_member(object, "joint", std::monostate());
  else
    add_member(object, "joint", type_.joints[static_cast<std::size_t>(joint)].name);
}

}  // namespace

JsonNode type_node(const engine::TypeSpec& type, const std::string& key, const std::optional<Color>& color,
                   const engine::Registry& registry, const std::filesystem::path* folder) {
  return TypeWriter(type, registry, folder).node(key, color);
}

}  // namespace troupe::worldio
