#include "worldio/json/json_types.hpp"

#include "engine/add_device.hpp"
#include "worldio/json/fields_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>
#include <variant>
#include <vector>

namespace troupe::worldio {
namespace {

using engine::Unit;
using engine::Value;

constexpr double k_max_period_s = 1e6;

double read_period(JsonObject& object, const engine::FieldTable& params) {
  const Value period = read_field(object, period_field(params));
  return period.given() ? period.number() : 0;
}

/// Looks up the `kind` that an object names; null, and reported, where there is none of this name.
/// find: name -> a Result of a pointer to the kind.
template <class Find>
auto read_kind(JsonObject& object, std::string_view what, const std::vector<std::string_view>& known,
               Find find) -> std::remove_cvref_t<decltype(*find(std::string_view()))> {
  const JsonNode* node = object.require("kind", fmt::format("one of {}", comma_list(known)));
  if (!node) return nullptr;
  const JsonCursor cursor(object.at(), "kind", *node);
  const std::string* name = read_text(cursor, fmt::format("the name of a {}", what));
  if (!name) return nullptr;
  const auto kind = find(*name);
  if (kind) return *kind;
  cursor.error(kind.error().text);
  return nullptr;
}

template <class Kinds>
std::vector<std::string_view> names(const Kinds& kinds) {
  std::vector<std::string_view> known;
  for (const auto& kind : kinds) known.push_back(kind.name);
  std::ranges::sort(known);
  return known;
}

/// The text under a key; empty where it is absent or wrong.
std::string read_optional_text(JsonObject& object, std::string_view key, std::string_view what) {
  const JsonNode* node = object.find(key);
  const std::string* text = node ? read_text(JsonCursor(object.at(), key, *node), what) : nullptr;
  return text ? *text : std::string();
}

std::optional<engine::DriveSpec> read_drive(const JsonCursor& at, const engine::Registry& registry) {
  JsonObject object(at);
  const std::vector<std::string_view> known = names(registry.drives);
  const auto find = [&](std::string_view name) -> Result<const engine::DriveKind*> {
    if (const engine::DriveKind* kind = registry.drive(name)) return kind;
    return Error{unknown_name("drive", name, known)};
  };
  const engine::DriveKind* kind = read_kind(object, "drive", known, find);
  if (!kind) return std::nullopt;
  engine::DriveSpec drive{.kind = std::string(kind->name), .where = at.where()};
  drive.period_s = read_period(object, kind->params);
  drive.params = read_fields(object, kind->params);
  object.finish();
  return drive;
}

/// The kinds of a type's list: sensors only look, other devices are asked to do something. What a part is
/// itself may be of either.
enum class DeviceList : std::uint8_t { sensors, devices, both };

/// What a part is to all that it carries.
struct Stand {
  std::uint32_t part = 0;
  std::int32_t joint = engine::k_rigid;
};

/// A device that stands on another which may be read later: `on` names it, or its joint. A cursor would not
/// live as long.
struct Riding {
  std::size_t device;
  std::string on;
  bool names_joint;
  Where where;
  std::string pointer;
};

class TypeReader {
 public:
  TypeReader(const engine::Registry& registry, ImageFolder& images, engine::TypeSpec& type)
      : registry_(registry), images_(images), type_(type) {}

  void read_root(JsonObject& object, std::optional<Color>& color);

 private:
  void read_part(const JsonCursor& at, const Stand& below);
  /// `device`: what the part itself is. Then it stands on the part; where it moves, so does the part.
  void read_own_device(JsonObject& object, bool has_shape, Stand& stand);
  /// `sensors`, `devices`, `controller` or `controllers`, and `parts`.
  void read_contents(JsonObject& object, const Stand& stand);
  const engine::DeviceKind* read_device_kind(JsonObject& object, DeviceList list) const;
  void read_device(const JsonCursor& at, DeviceList list, const Stand& stand);
  engine::PartSpec read_device_part(JsonObject& object, const engine::DeviceSpec& device,
                                    const engine::DeviceKind& kind);
  void read_controller(const JsonCursor& at, std::uint32_t part);
  std::string read_model_kind(JsonObject& object, std::string fallback);
  /// `joint`: what else than the joint of the part around it something moves with; null: with none.
  void read_joint(JsonObject& object, std::int32_t& joint);
  /// These say what is wrong; nothing where all is right.
  Result<> find_joint(const std::string& name, std::int32_t& joint) const;
  Result<> put_on(engine::DeviceSpec& device, const std::string& on) const;
  void read_order(JsonObject& object);

  template <class Read>
  static void each_of(JsonObject& object, std::string_view key, Read read) {
    const JsonNode* node = object.find(key);
    if (!node) return;
    const JsonCursor cursor(object.at(), key, *node);
    const JsonNode::List* list = read_list(cursor);
    for (std::size_t i = 0; list && i < list->size(); ++i) read(JsonCursor(cursor, i, (*list)[i]));
  }

  const engine::Registry& registry_;
  ImageFolder& images_;
  engine::TypeSpec& type_;
  std::vector<Riding> riding_;
};

void TypeReader::read_root(JsonObject& object, std::optional<Color>& color) {
  const JsonCursor& at = object.at();
  const std::size_t findings_before = at.diagnostics().findings().size();
  if (const std::string name = read_optional_text(object, "name", "what the type is called"); !name.empty())
    type_.name = name;
  engine::PartSpec root{.where = at.where()};
  const bool has_shape = read_shape(object, images_, root);
  if (object.is_object() && !has_shape && !object.find("device") &&
      at.diagnostics().findings().size() == findings_before)
    at.error("has no body: give \"size_m\" (a box) or \"blocks\"");
  if (const JsonNode* node = object.find("color")) color = read_color(JsonCursor(at, "color", *node));
  root.returns = read_returns(object);
  if (const JsonNode* node = object.find("drive"))
    type_.drive = read_drive(JsonCursor(at, "drive", *node), registry_);
  root.kind = read_model_kind(object, type_.drive ? "position" : "model");
  type_.parts.push_back(std::move(root));

  Stand stand;
  read_own_device(object, has_shape, stand);
  read_contents(object, stand);
  for (const Riding& rider : riding_) {
    engine::DeviceSpec& device = type_.devices[rider.device];
    const Result<> stands = rider.names_joint ? find_joint(rider.on, device.joint) : put_on(device, rider.on);
    if (!stands)
      at.diagnostics().error(rider.where, fmt::format("{}: {}", rider.pointer, stands.error().text));
  }
  read_order(object);
  const auto needs_drive = [&](const engine::ControllerSpec& controller) {  // those of parts may have wheels
    const engine::ControllerKind* kind = registry_.controller(controller.kind);
    return controller.part == 0 && (kind == nullptr || kind->needs_drive);
  };
  const JsonNode* one = object.find("controller");
  if (const JsonNode* moved = one ? one : object.find("controllers");
      moved && object.is_object() && !object.find("drive") &&
      std::ranges::any_of(type_.controllers, needs_drive))
    at.error_at(moved->where, "a controller needs a \"drive\" to command");
}

void TypeReader::read_part(const JsonCursor& at, const Stand& below) {
  JsonObject object(at);
  engine::PartSpec part{.parent = below.part, .joint = below.joint, .where = at.where()};
  if (object.require("name", "the part's name"))
    part.name = read_optional_text(object, "name", "the part's name");
  part.alias = read_optional_text(object, "alias", "another name of the part");
  part.kind = read_model_kind(object, "model");
  part.pose_body_part = read_pose(object);
  const bool has_shape = read_shape(object, images_, part);
  if (const JsonNode* node = object.find("color")) part.color = read_color(JsonCursor(at, "color", *node));
  part.returns = read_returns(object);
  read_joint(object, part.joint);
  Stand stand{static_cast<std::uint32_t>(type_.parts.size()), part.joint};
  type_.parts.push_back(std::move(part));
  read_own_device(object, has_shape, stand);
  read_contents(object, stand);
  object.finish();
}

void TypeReader::read_own_device(JsonObject& object, bool has_shape, Stand& stand) {
  // What moves of a gripper is declared to be as large as the gripper itself.
  const bool has_extent = read_extent(object, type_.parts[stand.part]);
  const JsonNode* node = object.find("device");
  if (!node) return;
  const engine::PartSpec& part = type_.parts[stand.part];
  const JsonCursor at(object.at(), "device", *node);
  JsonObject own(at);
  const engine::ModelKind* model = registry_.model(part.kind);
  const engine::DeviceKind* kind =
      model && !model->device.empty() ? registry_.device(model->device) : nullptr;
  if (!kind || own.find("kind")) kind = read_device_kind(own, DeviceList::both);
  if (!kind) return;
  engine::DeviceSpec device{.name = part.name, .kind = std::string(kind->name), .part = stand.part};
  device.joint = stand.joint;
  device.where = at.where();
  if (const std::string name = read_optional_text(own, "name", "the device's name"); !name.empty())
    device.name = name;
  device.pose_body_sensor = read_pose(own, part.pose_body_part);
  device.active = read_boolean(own, "active", true);
  device.period_s = read_period(own, kind->params);
  device.params = read_fields(own, kind->params);
  read_joint(own, device.joint);
  own.finish();
  const std::size_t d = engine::add_device(type_, std::move(device), *kind);
  if (moves_itself(*kind)) type_.parts[stand.part].joint = stand.joint = type_.devices[d].moves;
  if (!kind->body || has_shape) return;
  engine::add_device_body(type_, d, *kind);
  if (!has_extent) measure_part(type_.parts[stand.part]);
}

void TypeReader::read_contents(JsonObject& object, const Stand& stand) {
  each_of(object, "sensors", [&](const JsonCursor& at) { read_device(at, DeviceList::sensors, stand); });
  each_of(object, "devices", [&](const JsonCursor& at) { read_device(at, DeviceList::devices, stand); });
  const JsonNode* one = object.find("controller");
  if (one) read_controller(JsonCursor(object.at(), "controller", *one), stand.part);
  if (const JsonNode* many = object.find("controllers"); one && many)
    object.at().error_at(many->where, "give \"controller\" or \"controllers\", not both");
  each_of(object, "controllers", [&](const JsonCursor& at) { read_controller(at, stand.part); });
  each_of(object, "parts", [&](const JsonCursor& at) { read_part(at, stand); });
}

/// Puts a device on another, which moves what stands on it.
Result<> TypeReader::put_on(engine::DeviceSpec& device, const std::string& on) const {
  std::vector<std::string_view> known;
  for (const engine::DeviceSpec& other : type_.devices) {
    const engine::DeviceKind* kind = registry_.device(other.kind);
    if (kind == nullptr || kind->joints.size() != 1) continue;
    known.push_back(other.name);
    if (other.name != on) continue;
    device.part = other.part;
    device.joint = other.moves;
    device.pose_body_sensor = compose(other.pose_body_sensor, device.pose_body_sensor);
    return {};
  }
  if (known.empty())
    return Error{
        fmt::format("\"{}\" is no device before it that moves what stands on it; there is none", on)};
  return Error{unknown_name("device that moves what stands on it", on, known)};
}

/// What a device shows of itself: the body of its kind, or one given by `size_m` or `blocks`.
engine::PartSpec TypeReader::read_device_part(JsonObject& object, const engine::DeviceSpec& device,
                                              const engine::DeviceKind& kind) {
  // Parts are of model kinds, and not every device that moves something ("wheels") is one.
  engine::PartSpec part{.name = device.name,
                        .kind = registry_.model(device.kind) ? device.kind : "model",
                        .where = device.where};
  part.pose_body_part = device.pose_body_sensor;
  if (const JsonNode* node = object.find("color"))
    part.color = read_color(JsonCursor(object.at(), "color", *node));
  part.returns = read_returns(object);
  if (!kind.body) part.solids = read_solids(object, device.pose_body_sensor);
  return part;
}

/// The kind that a device names, of Troupe's own or of a plug-in.
const engine::DeviceKind* TypeReader::read_device_kind(JsonObject& object, DeviceList list) const {
  const std::string_view what = list == DeviceList::sensors ? "sensor" : "device";
  const std::vector<std::string_view> known = names(list == DeviceList::sensors   ? registry_.sensors()
                                                    : list == DeviceList::devices ? registry_.other_devices()
                                                                                  : registry_.devices);
  const auto find = [&](std::string_view name) -> Result<const engine::DeviceKind*> {
    auto kind = registry_.find_device(name, unknown_name(what, name, known));
    if (!kind || list == DeviceList::both || (*kind)->is_sensor() == (list == DeviceList::sensors))
      return kind;
    return Error{fmt::format("\"{}\" {}", name,
                             (*kind)->is_sensor() ? "only looks: it belongs under \"sensors\""
                                                  : "does something: it belongs under \"devices\"")};
  };
  return read_kind(object, what, known, find);
}

void TypeReader::read_device(const JsonCursor& at, DeviceList list, const Stand& stand) {
  std::vector<engine::DeviceSpec>& devices = type_.devices;
  const std::string_view what = list == DeviceList::sensors ? "sensor" : "device";
  JsonObject object(at);
  const JsonNode* name_node = object.find("name");
  const engine::DeviceKind* kind = read_device_kind(object, list);
  if (!kind) return;
  engine::DeviceSpec device{.kind = std::string(kind->name), .part = stand.part, .where = at.where()};
  device.joint = stand.joint;
  if (name_node) {
    const JsonCursor cursor(at, "name", *name_node);
    const std::string* name = read_text(cursor, fmt::format("the {}'s name", what));
    if (name) device.name = *name;
    if (name && std::ranges::find(devices, *name, &engine::DeviceSpec::name) != devices.end())
      cursor.error(fmt::format("the type has a {} \"{}\" already", what, *name));
  } else {  // as Stage names a robot's second ranger: "ranger:1"
    const auto before = std::ranges::count(devices, device.kind, &engine::DeviceSpec::kind);
    device.name = fmt::format("{}:{}", device.kind, before);
  }
  device.pose_body_sensor = read_pose(object);
  device.active = read_boolean(object, "active", true);
  device.period_s = read_period(object, kind->params);
  device.params = read_fields(object, kind->params);
  const bool has_part = !kind->joints.empty();
  bool stands = true;
  if (const JsonNode* node = object.find("on")) {
    const JsonCursor cursor(at, "on", *node);
    const std::string* on = read_text(cursor, "the name of a device that moves what stands on it");
    const Result<> put = !on || list == DeviceList::sensors ? Result<>() : put_on(device, *on);
    if (!put) cursor.error(put.error().text);
    stands = on && put;
    if (on && list == DeviceList::sensors)
      riding_.push_back({devices.size(), *on, false, cursor.where(), cursor.pointer()});
  }
  if (const JsonNode* node = object.find("joint"); node && !has_part && node->text())
    riding_.push_back({devices.size(), *node->text(), true, node->where, at.pointer() + "/joint"});
  else
    read_joint(object, device.joint);
  if (has_part) {
    engine::PartSpec part = read_device_part(object, device, *kind);
    part.parent = device.part;
    part.joint = kind->body ? device.joint : static_cast<std::int32_t>(type_.joints.size());
    device.part = static_cast<std::uint32_t>(type_.parts.size());
    type_.parts.push_back(std::move(part));
  }
  object.finish();
  if (!stands) return;
  const std::size_t part = device.part;
  const std::size_t d = engine::add_device(type_, std::move(device), *kind);
  if (has_part) {
    engine::add_device_body(type_, d, *kind);
    measure_part(type_.parts[part]);
  }
}

void TypeReader::read_controller(const JsonCursor& at, std::uint32_t part) {
  JsonObject object(at);
  const engine::Registry::Preset* preset = nullptr;
  const auto find = [&](std::string_view name) {
    preset = registry_.preset(name);
    return registry_.find_controller(preset ? preset->kind : name);
  };
  const engine::ControllerKind* kind = read_kind(object, "controller", registry_.controller_names(), find);
  if (!kind) return;
  engine::ControllerSpec controller{.kind = std::string(kind->name), .part = part, .where = at.where()};
  using Params = std::span<const std::pair<std::string_view, Value>>;
  controller.period_s = read_period(object, kind->params);
  controller.params = read_fields(object, kind->params, preset ? Params(preset->params) : Params());
  object.finish();
  type_.controllers.push_back(std::move(controller));
}

std::string TypeReader::read_model_kind(JsonObject& object, std::string fallback) {
  const JsonNode* node = object.find("kind");
  if (!node) return fallback;
  const JsonCursor at(object.at(), "kind", *node);
  const std::string* name = read_text(at, "the name of a model kind");
  if (!name) return fallback;
  if (!registry_.model(*name)) at.error(unknown_name("model kind", *name, names(registry_.models)));
  return *name;
}

void TypeReader::read_joint(JsonObject& object, std::int32_t& joint) {
  const JsonNode* node = object.find("joint");
  if (!node) return;
  const JsonCursor at(object.at(), "joint", *node);
  if (std::holds_alternative<std::monostate>(node->value))
    joint = engine::k_rigid;
  else if (const std::string* name = read_text(at, "the name of a joint, or null: none"))
    if (const Result<> found = find_joint(*name, joint); !found) at.error(found.error().text);
}

Result<> TypeReader::find_joint(const std::string& name, std::int32_t& joint) const {
  const auto found = std::ranges::find(type_.joints, name, &engine::JointSpec::name);
  if (found == type_.joints.end()) {
    std::vector<std::string_view> known;
    for (const engine::JointSpec& one : type_.joints) known.push_back(one.name);
    return Error{unknown_name("joint", name, std::move(known))};
  }
  joint = static_cast<std::int32_t>(found - type_.joints.begin());
  return {};
}

void TypeReader::read_order(JsonObject& object) {
  const JsonNode* node = object.find("device_order");
  if (!node) return;
  const JsonCursor at(object.at(), "device_order", *node);
  const JsonNode::List* list = read_list(at);
  if (!list) return;
  std::vector<engine::DeviceSpec> ordered;
  for (const JsonNode& entry : *list) {
    const auto found = entry.text()
                           ? std::ranges::find(type_.devices, *entry.text(), &engine::DeviceSpec::name)
                           : type_.devices.end();
    if (found == type_.devices.end()) continue;
    ordered.push_back(std::move(*found));
    type_.devices.erase(found);
  }
  if (!type_.devices.empty() || ordered.size() != list->size())
    at.expected("the names of all devices of the type, each once");
  else
    type_.devices = std::move(ordered);
}

}  // namespace

engine::Field period_field(const engine::FieldTable& params) {
  return {.name = params.find("period") < 0 ? "period" : "update_period",
          .unit = Unit::seconds,
          .min = 0,
          .max = k_max_period_s};
}

JsonType read_type(const JsonCursor& at, const std::string& name, const engine::Registry& registry,
                   ImageFolder& images) {
  JsonType type;
  type.spec.name = name;
  JsonObject object(at);
  TypeReader(registry, images, type.spec).read_root(object, type.color);
  object.finish();
  return type;
}

}  // namespace troupe::worldio
