#include "worldio/json_types.hpp"

#include "engine/add_device.hpp"
#include "worldio/fields_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace troupe::worldio {
namespace {

using engine::Field;
using engine::FieldType;
using engine::Unit;
using engine::Value;

constexpr std::size_t k_max_points = 1000;  // of a block: the test for crossings is quadratic
constexpr double k_max_period_s = 1e6;

const Field k_size{.name = "size",
                   .type = FieldType::numbers,
                   .unit = Unit::meters,
                   .min = 0,
                   .max = k_max_size_m,
                   .columns = 3,
                   .above_min = true};

Ring rectangle(double x, double y) {
  return {{-x / 2, -y / 2}, {x / 2, -y / 2}, {x / 2, y / 2}, {-x / 2, y / 2}};
}

/// Sign of the turn a -> b -> c.
int turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  const double t = cross(b - a, c - a);
  return t > 0 ? 1 : t < 0 ? -1 : 0;
}

bool within_box(const Vec2& a, const Vec2& b, const Vec2& p) {
  return p.x() >= std::min(a.x(), b.x()) && p.x() <= std::max(a.x(), b.x()) &&
         p.y() >= std::min(a.y(), b.y()) && p.y() <= std::max(a.y(), b.y());
}

/// True when the closed segments share a point.
bool segments_meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const int abc = turn(a, b, c), abd = turn(a, b, d), cda = turn(c, d, a), cdb = turn(c, d, b);
  if (abc * abd < 0 && cda * cdb < 0) return true;
  return (abc == 0 && within_box(a, b, c)) || (abd == 0 && within_box(a, b, d)) ||
         (cda == 0 && within_box(c, d, a)) || (cdb == 0 && within_box(c, d, b));
}

void read_block(const JsonCursor& at, std::vector<Solid>& solids) {
  JsonObject object(at);
  std::vector<Vec2> points;
  if (const JsonNode* node = object.require("points_m", "the outline, [[x, y], ...]")) {
    const JsonCursor cursor(at, "points_m", *node);
    points = read_points(cursor, 3, k_max_points);
    if (!points.empty())
      if (const std::string fault = outline_fault(points); !fault.empty()) cursor.error(fault);
  }
  const Field z_field{.name = "z",
                      .type = FieldType::numbers,
                      .unit = Unit::meters,
                      .min = -k_max_size_m,
                      .max = k_max_size_m,
                      .text = "the heights between which the block stands, [min, max]",
                      .columns = 2};
  const engine::FieldTable z_table{{z_field}};
  const Value z = read_fields(object, z_table)[0];
  if (z.given() && z.numbers()[0] >= z.numbers()[1])
    at.error(fmt::format("\"z_m\" must rise from min to max, found {:.10g} and {:.10g}", z.numbers()[0],
                         z.numbers()[1]));
  object.finish();
  if (points.empty() || !z.given()) return;
  if (signed_area(points) < 0) std::ranges::reverse(points);
  solids.push_back({{std::move(points)}, {z.numbers()[0], z.numbers()[1]}});
}

double read_period(JsonObject& object) {
  const Field field{.name = "period", .unit = Unit::seconds, .min = 0, .max = k_max_period_s};
  const Value period = read_field(object, field);
  return period.given() ? period.number() : 0;
}

bool read_boolean(JsonObject& object, std::string_view name, bool fallback) {
  const Value value = read_field(object, {.name = name, .type = FieldType::boolean});
  return value.given() ? value.boolean() : fallback;
}

/// Looks up the `kind` that an object names; null, and reported, where there is none of this name. A `find`
/// that knows why says so in `fault`.
template <class Find>
auto read_kind(JsonObject& object, std::string_view what, const std::vector<std::string_view>& known,
               Find find, const std::string& fault = {}) -> decltype(find(std::string_view())) {
  const JsonNode* node = object.require("kind", fmt::format("one of {}", comma_list(known)));
  if (!node) return nullptr;
  const JsonCursor cursor(object.at(), "kind", *node);
  const std::string* name = read_text(cursor, fmt::format("the name of a {}", what));
  if (!name) return nullptr;
  const auto kind = find(*name);
  if (!kind) cursor.error(fault.empty() ? unknown_name(what, *name, known) : fault);
  return kind;
}

template <class Kinds>
std::vector<std::string_view> names(const Kinds& kinds) {
  std::vector<std::string_view> known;
  for (const auto& kind : kinds) known.push_back(kind.name);
  std::ranges::sort(known);
  return known;
}

std::optional<engine::DriveSpec> read_drive(const JsonCursor& at, const engine::Registry& registry) {
  JsonObject object(at);
  const engine::DriveKind* kind = read_kind(object, "drive", names(registry.drives),
                                            [&](std::string_view name) { return registry.drive(name); });
  if (!kind) return std::nullopt;
  engine::DriveSpec drive{.kind = std::string(kind->name), .where = at.where()};
  drive.period_s = read_period(object);
  drive.params = read_fields(object, kind->params);
  object.finish();
  return drive;
}

/// The kinds of a type's list: sensors only look, other devices are asked to do something.
enum class DeviceList : std::uint8_t { sensors, devices };

/// A sensor that stands on a device read after it.
struct Riding {
  std::size_t device;
  std::string on;
  JsonCursor at;
};

/// Puts a device on another, which moves what stands on it.
bool put_on(engine::TypeSpec& type, const engine::Registry& registry, engine::DeviceSpec& device,
            const std::string& on, const JsonCursor& at) {
  std::vector<std::string_view> known;
  for (const engine::DeviceSpec& other : type.devices) {
    const engine::DeviceKind* kind = registry.device(other.kind);
    if (kind == nullptr || kind->joints.size() != 1) continue;
    known.push_back(other.name);
    if (other.name != on) continue;
    device.part = other.part;
    device.joint = other.moves;
    device.pose_body_sensor = compose(other.pose_body_sensor, device.pose_body_sensor);
    return true;
  }
  if (known.empty())
    at.error(fmt::format("\"{}\" is no device before it that moves what stands on it; there is none", on));
  else
    at.error(unknown_name("device that moves what stands on it", on, known));
  return false;
}

/// What a device shows of itself: the body of its kind, or one given by `size_m` or `blocks`.
engine::PartSpec read_device_part(JsonObject& object, const engine::DeviceSpec& device,
                                  const engine::DeviceKind& kind) {
  engine::PartSpec part{.name = device.name, .kind = device.kind, .where = device.where};
  part.pose_body_part = device.pose_body_sensor;
  if (const JsonNode* node = object.find("color"))
    part.color = read_color(JsonCursor(object.at(), "color", *node));
  part.returns = read_returns(object);
  if (kind.body) return part;
  std::vector<Solid> solids;
  if (const Value size = read_field(object, k_size); size.given())
    solids.push_back({{rectangle(size.numbers()[0], size.numbers()[1])}, {0, size.numbers()[2]}});
  if (const JsonNode* node = object.find("blocks")) {
    const JsonCursor cursor(object.at(), "blocks", *node);
    const JsonNode::List* blocks = read_list(cursor);
    for (std::size_t i = 0; blocks && i < blocks->size(); ++i)
      read_block(JsonCursor(cursor, i, (*blocks)[i]), solids);
  }
  for (Solid& solid : solids) part.solids.push_back(placed(std::move(solid), device.pose_body_sensor));
  return part;
}

/// The extent of a part's solids is its size.
void measure_part(engine::PartSpec& part) {
  Box extent;
  ZInterval z;
  for (const Solid& solid : part.solids) {
    extent.extend(bounds(solid.contours[0]));
    z = {std::min(z.min, solid.z.min), std::max(z.max, solid.z.max)};
  }
  if (!extent.empty()) part.size = {extent.size().x(), extent.size().y(), z.max - z.min};
}

void read_device(const JsonCursor& at, DeviceList list, const engine::Registry& registry,
                 engine::TypeSpec& type, std::vector<Riding>& riding) {
  std::vector<engine::DeviceSpec>& devices = type.devices;
  const auto belongs = [list](const engine::DeviceKind& kind) {
    return kind.is_sensor() == (list == DeviceList::sensors);
  };
  const std::string_view what = list == DeviceList::sensors ? "sensor" : "device";
  const std::vector<std::string_view> known =
      names(list == DeviceList::sensors ? registry.sensors() : registry.other_devices());

  JsonObject object(at);
  const JsonNode* name_node = object.find("name");
  const engine::DeviceKind* kind =
      read_kind(object, what, known, [&](std::string_view name) -> const engine::DeviceKind* {
        const engine::DeviceKind* found = registry.device(name);
        return found != nullptr && belongs(*found) ? found : nullptr;
      });
  if (!kind) return;
  engine::DeviceSpec device{.kind = std::string(kind->name), .where = at.where()};
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
  device.period_s = read_period(object);
  device.params = read_fields(object, kind->params);
  bool stands = true;
  if (const JsonNode* node = object.find("on")) {
    const JsonCursor cursor(at, "on", *node);
    const std::string* on = read_text(cursor, "the name of a device that moves what stands on it");
    if (on && list == DeviceList::sensors)
      riding.push_back({devices.size(), *on, cursor});
    else
      stands = on && put_on(type, registry, device, *on, cursor);
  }
  const bool has_part = !kind->joints.empty();
  if (has_part) {
    engine::PartSpec part = read_device_part(object, device, *kind);
    part.parent = device.part;
    part.joint = kind->body ? device.joint : static_cast<std::int32_t>(type.joints.size());
    device.part = static_cast<std::uint32_t>(type.parts.size());
    type.parts.push_back(std::move(part));
  }
  object.finish();
  if (!stands) return;
  const std::size_t part = device.part;
  const std::size_t d = engine::add_device(type, std::move(device), *kind);
  if (has_part) {
    engine::add_device_body(type, d, *kind);
    measure_part(type.parts[part]);
  }
}

void read_controller(const JsonCursor& at, const engine::Registry& registry,
                     std::vector<engine::ControllerSpec>& controllers) {
  JsonObject object(at);
  const engine::Registry::Preset* preset = nullptr;
  std::string fault;
  const auto find = [&](std::string_view name) {
    preset = registry.preset(name);
    return registry.controller(preset ? preset->kind : name, fault);
  };
  const engine::ControllerKind* kind =
      read_kind(object, "controller", registry.controller_names(), find, fault);
  if (!kind) return;
  engine::ControllerSpec controller{.kind = std::string(kind->name), .where = at.where()};
  using Params = std::span<const std::pair<std::string_view, Value>>;
  controller.params = read_fields(object, kind->params, preset ? Params(preset->params) : Params());
  object.finish();
  controllers.push_back(std::move(controller));
}

}  // namespace

JsonType read_type(const JsonCursor& at, const std::string& name, const engine::Registry& registry) {
  const std::size_t findings_before = at.diagnostics().findings().size();
  JsonType type;
  type.spec.name = name;
  engine::PartSpec root{.where = at.where()};

  JsonObject object(at);
  const Value size = read_field(object, k_size);
  if (size.given())
    root.solids.push_back({{rectangle(size.numbers()[0], size.numbers()[1])}, {0, size.numbers()[2]}});
  const auto each_of = [&](std::string_view key, auto read) {
    const JsonNode* node = object.find(key);
    if (!node) return;
    const JsonCursor cursor(at, key, *node);
    const JsonNode::List* list = read_list(cursor);
    for (std::size_t i = 0; list && i < list->size(); ++i) read(JsonCursor(cursor, i, (*list)[i]));
  };
  each_of("blocks", [&](const JsonCursor& cursor) { read_block(cursor, root.solids); });
  if (object.is_object() && root.solids.empty() && at.diagnostics().findings().size() == findings_before)
    at.error("has no body: give \"size_m\" (a box) or \"blocks\"");

  if (const JsonNode* node = object.find("color")) type.color = read_color(JsonCursor(at, "color", *node));
  root.returns = read_returns(object);

  if (const JsonNode* node = object.find("drive"))
    type.spec.drive = read_drive(JsonCursor(at, "drive", *node), registry);
  measure_part(root);
  root.kind = type.spec.drive ? "position" : "model";
  type.spec.parts.push_back(std::move(root));
  std::vector<Riding> riding;
  const auto read_devices = [&](std::string_view key, DeviceList list) {
    each_of(key, [&](const JsonCursor& cursor) { read_device(cursor, list, registry, type.spec, riding); });
  };
  read_devices("sensors", DeviceList::sensors);
  read_devices("devices", DeviceList::devices);
  for (const Riding& sensor : riding)
    put_on(type.spec, registry, type.spec.devices[sensor.device], sensor.on, sensor.at);

  const JsonNode* one = object.find("controller");
  if (one) read_controller(JsonCursor(at, "controller", *one), registry, type.spec.controllers);
  const JsonNode* many = object.find("controllers");
  if (one && many) at.error_at(many->where, "give \"controller\" or \"controllers\", not both");
  each_of("controllers",
          [&](const JsonCursor& cursor) { read_controller(cursor, registry, type.spec.controllers); });
  const auto needs_drive = [&](const engine::ControllerSpec& controller) {
    const engine::ControllerKind* kind = registry.controller(controller.kind);
    return kind == nullptr || kind->needs_drive;
  };
  if (const JsonNode* moved = one ? one : many; moved && object.is_object() && !object.find("drive") &&
                                                std::ranges::any_of(type.spec.controllers, needs_drive))
    at.error_at(moved->where, "a controller needs a \"drive\" to command");
  object.finish();
  return type;
}

Pose read_pose(JsonObject& object) {
  const Value value =
      read_field(object, {.name = "pose", .type = FieldType::record, .record = &engine::pose_fields()});
  if (!value.given()) return {};
  const engine::Record& fields = value.records()[0];
  const auto number = [&](std::string_view name) {
    return engine::get(engine::pose_fields(), fields, name).number();
  };
  return {number("x"), number("y"), number("z"), number("heading")};
}

engine::Returns read_returns(JsonObject& object) {
  engine::Returns returns;
  returns.obstacle = read_boolean(object, "obstacle", returns.obstacle);
  const Value ranger = read_field(object, {.name = "ranger_return", .min = -1e6, .max = 1e6});
  if (ranger.given()) returns.ranger = static_cast<float>(ranger.number());
  const auto mark = [&](std::string_view name, std::int32_t& member) {
    using Limits = std::numeric_limits<std::int32_t>;
    const Value value = read_field(
        object, {.name = name, .type = FieldType::integer, .min = Limits::min(), .max = Limits::max()});
    if (value.given()) member = static_cast<std::int32_t>(value.integer());
  };
  mark("fiducial_return", returns.fiducial);
  mark("fiducial_key", returns.fiducial_key);
  returns.gripper = read_boolean(object, "gripper_return", returns.gripper);
  returns.blob = read_boolean(object, "blob_return", returns.blob);
  return returns;
}

std::vector<Vec2> read_points(const JsonCursor& at, std::size_t least, std::size_t most) {
  const JsonNode::List* list = read_list(at);
  if (!list) return {};
  if (list->size() < least || list->size() > most) {
    at.error(least == most ? fmt::format("expected {} points, found {}", least, list->size())
                           : fmt::format("expected {} to {} points, found {}", least, most, list->size()));
    return {};
  }
  const Field field{.name = "point",
                    .type = FieldType::numbers,
                    .unit = Unit::meters,
                    .min = -k_max_size_m,
                    .max = k_max_size_m,
                    .columns = 2};
  std::vector<Vec2> points;
  for (std::size_t i = 0; i < list->size(); ++i) {
    const Value xy = read_value(JsonCursor(at, i, (*list)[i]), field);
    if (xy.given()) points.emplace_back(xy.numbers()[0], xy.numbers()[1]);
  }
  if (points.size() < list->size()) points.clear();
  return points;
}

std::string outline_fault(const Ring& ring) {
  const std::size_t n = ring.size();
  const auto at = [&](std::size_t i) -> const Vec2& { return ring[i % n]; };
  for (std::size_t i = 0; i < n; ++i)
    if (at(i) == at(i + 1))
      return i + 1 < n ? fmt::format("point {} repeats point {}", i + 1, i)
                       : std::string("the last point repeats the first: the outline is closed anyway");
  constexpr double k_flat = 1e-12;  // rounding, relative to the extent
  const double widest = bounds(ring).size().maxCoeff();
  if (std::ranges::all_of(ring, [&](const Vec2& p) {
        return std::abs(cross(ring[1] - ring[0], p - ring[0])) <= k_flat * widest * widest;
      }))
    return "the outline has no area";
  for (std::size_t i = 0; i < n; ++i)
    if (turn(at(i), at(i + 1), at(i + 2)) == 0 && (at(i + 1) - at(i)).dot(at(i + 2) - at(i + 1)) < 0)
      return fmt::format("the outline turns back on itself at point {}", (i + 1) % n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n && j + 1 < n + i; ++j)
      if (segments_meet(at(i), at(i + 1), at(j), at(j + 1)))
        return fmt::format("the outline crosses or touches itself: the edges from points {} and {}", i, j);
  return {};
}

}  // namespace troupe::worldio
