#include "worldio/stage_writer.hpp"

#include "worldio/fields_json.hpp"
#include "worldio/floor_image.hpp"
#include "worldio/json_types.hpp"
#include "worldio/load.hpp"
#include "worldio/stage_devices.hpp"
#include "worldio/stage_round_trip.hpp"
#include "worldio/stage_text.hpp"
#include "worldio/stage_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace troupe::worldio {
namespace {

using engine::DeviceKind;
using engine::DeviceSpec;
using engine::FieldTable;
using engine::FieldType;
using engine::PartSpec;
using engine::Record;
using engine::TypeSpec;
using engine::Value;
using engine::WorldSpec;

double milliseconds(double seconds) {
  return solved(seconds, seconds * 1000, [](double ms) { return ms / 1000; });
}

std::vector<double> list_of(const Pose& pose) { return {pose.x, pose.y, pose.z, pose.heading}; }

Box extent_of(const std::vector<Solid>& solids) {
  Box box;
  for (const Solid& solid : solids)
    for (const Ring& ring : solid.contours) box.extend(bounds(ring));
  return box;
}

/// What a color property says; X11 names where there is one.
void write_color(const Color& color, StageText& text) {
  const JsonNode node = color_node(color);
  if (const std::string* name = node.text()) return text.text("color", *name);
  text.numbers("color_rgba", std::array{short_number(color.r), short_number(color.g), short_number(color.b),
                                        short_number(color.a)});
}

/// One type as a macro: its root, and below it a model for each part, and for each device that stands on a
/// part that is no such device itself.
class TypeText {
 public:
  TypeText(const TypeSpec& type, const std::filesystem::path& folder, const engine::Registry& registry,
           FloorImages& images, Diagnostics& diagnostics, StageText& text)
      : type_(type),
        folder_(folder),
        registry_(registry),
        images_(images),
        diagnostics_(diagnostics),
        text_(text) {}

  void write(const std::string& macro, const Color& color);

 private:
  void lacks(Where where, const std::string& what) {
    diagnostics_.error(where, fmt::format("a .world file cannot say this: type \"{}\": {}", type_.name, what));
  }
  const DeviceKind* kind_of(const DeviceSpec& device) const { return registry_.device(device.kind); }
  bool is_property(const DeviceSpec& device) const {
    return device.kind == "power_pack" || device.kind == "power_contact" || device.kind == "flags";
  }
  const DeviceSpec* own_device(std::uint32_t p) const;
  /// The joint that what stands on a part moves with.
  std::int32_t joint_of(std::uint32_t p) const;
  /// The part that carries what moves with this joint, which should be `part`.
  std::uint32_t carrier(std::uint32_t part, std::int32_t joint) const;
  bool is_brought(std::uint32_t p) const;

  void write_part(std::uint32_t p);
  void write_body(const PartSpec& part, const DeviceSpec* own);
  static bool is_default_box(const PartSpec& part, const engine::ModelKind& kind);
  bool write_image(const PartSpec& part);
  void write_blocks(const PartSpec& part);
  void write_block(const Solid& block, Where where);
  void write_size(const Eigen::Vector3d& size, const engine::ModelKind* kind, Where where);
  void write_returns(const engine::Returns& returns);
  void write_drive(const engine::DriveSpec& drive);
  void write_controllers(std::uint32_t p);
  void write_power(std::uint32_t p);
  void write_children(std::uint32_t p);
  void write_device(const DeviceSpec& device);
  void write_ranger(const DeviceSpec& device, const DeviceKind& kind);
  void write_parameters(const DeviceSpec& device, const DeviceKind& kind);
  void write_bumpers(const DeviceSpec& device, const DeviceKind& kind);
  /// Below a part; `generated` counts the children of each kind that it has had.
  void write_name(std::uint32_t parent, const std::string& name, const std::string& kind,
                  std::map<std::string, std::size_t>& generated);

  const TypeSpec& type_;
  const std::filesystem::path& folder_;
  const engine::Registry& registry_;
  FloorImages& images_;
  Diagnostics& diagnostics_;
  StageText& text_;
};

void TypeText::write(const std::string& macro, const Color& color) {
  const PartSpec& root = type_.parts.front();
  text_.at(root.where);
  text_.define(macro, root.kind);
  write_color(color, text_);
  write_part(0);
  text_.close();
}

const DeviceSpec* TypeText::own_device(std::uint32_t p) const {
  const engine::ModelKind* model = registry_.model(type_.parts[p].kind);
  for (const DeviceSpec& device : type_.devices)
    if (device.part == p && model && model->device == device.kind && device.name == type_.parts[p].name)
      return &device;
  return nullptr;
}

std::int32_t TypeText::joint_of(std::uint32_t p) const {
  const DeviceSpec* own = own_device(p);
  const DeviceKind* kind = own ? kind_of(*own) : nullptr;
  return kind && moves_itself(*kind) ? own->moves : type_.parts[p].joint;
}

std::uint32_t TypeText::carrier(std::uint32_t part, std::int32_t joint) const {
  if (joint_of(part) == joint) return part;
  for (std::uint32_t p = 0; p < type_.parts.size(); ++p)
    if (const DeviceSpec* own = own_device(p); own && own->moves == joint && joint_of(p) == joint) return p;
  return part;
}

/// A part that the device of the part around it brings along: a gripper's paddle.
bool TypeText::is_brought(std::uint32_t p) const {
  const PartSpec& part = type_.parts[p];
  if (p == 0 || part.solids.empty()) return false;
  const DeviceSpec* around = own_device(part.parent);
  const DeviceKind* kind = around ? kind_of(*around) : nullptr;
  if (!kind || !kind->body || part.kind != type_.parts[part.parent].kind) return false;
  const auto joints = static_cast<std::int32_t>(kind->joints.size());
  return part.joint >= around->moves && part.joint < around->moves + joints && !own_device(p);
}

void TypeText::write_part(std::uint32_t p) {
  const PartSpec& part = type_.parts[p];
  const DeviceSpec* own = own_device(p);
  text_.at(part.where);
  if (!registry_.model(part.kind)) return lacks(part.where, fmt::format("a part of kind \"{}\"", part.kind));
  if ((part.kind == "position") != (p == 0 && type_.drive))
    lacks(part.where, p == 0 ? "only a model of kind \"position\" has a drive, and it always has one"
                             : "a part of kind \"position\", which drives by itself");
  write_body(part, own);
  write_returns(part.returns);
  if (p == 0 && type_.drive) write_drive(*type_.drive);
  write_power(p);
  write_controllers(p);
  if (own) write_device(*own);
  write_children(p);
}

void TypeText::write_body(const PartSpec& part, const DeviceSpec* own) {
  const engine::ModelKind* kind = registry_.model(part.kind);
  const DeviceKind* device = own ? kind_of(*own) : nullptr;
  if (write_image(part)) return;
  const bool is_brought_along = device && device->body && !part.fitted && !part.solids.empty();
  if (is_brought_along || is_default_box(part, *kind)) return write_size(part.size, kind, part.where);
  if (!part.solids.empty()) return write_blocks(part);
  if (kind->has_default_body || (device && device->body)) text_.flag("noblocks", true);
  write_size(part.size, kind, part.where);
}

bool TypeText::is_default_box(const PartSpec& part, const engine::ModelKind& kind) {
  if (!kind.has_default_body || part.size.minCoeff() <= 0) return false;
  const double x = part.size.x() / 2;
  const double y = part.size.y() / 2;
  const Solid box{{{{-x, -y}, {x, -y}, {x, y}, {-x, y}}}, {0, part.size.z()}};
  return part.solids == std::vector{placed(box, part.pose_body_part)};
}

/// True where an image, of this size or as large as what is there, makes just this.
bool TypeText::write_image(const PartSpec& part) {
  if (!part.image) return false;
  const FloorImage* image = images_.read(part.image->file, part.image->unknown_is_solid, {});
  if (!image || image->contours.empty()) return false;
  const Box extent = extent_of(part.solids);
  const std::array sizes{part.size, Eigen::Vector3d(extent.size().x(), extent.size().y(), part.size.z())};
  for (const Eigen::Vector3d& size : sizes) {
    PartSpec made = part;
    made.size = size;
    if (image_solids(*image, made) != part.solids) continue;
    JsonNode::Object path;
    worldio::write_image(*part.image, size, folder_, path);
    text_.text("bitmap", *path.front().node.text());
    text_.numbers("size", std::array{size.x(), size.y(), size.z()});
    if (part.image->origin != Pose()) text_.pose("origin", part.image->origin);
    if (part.image->keeps_margins) text_.flag("bitmap_margins", true);
    if (part.image->unknown_is_solid) text_.flag("bitmap_unknown", true);
    if (part.image->boundary) text_.flag("boundary", true);
    return true;
  }
  return false;
}

/// Stage scales the blocks of a model to its size and centres them, which `origin` undoes.
void TypeText::write_blocks(const PartSpec& part) {
  if (part.fitted) {
    write_size(part.size, nullptr, part.where);
    if (part.fitted->origin != Pose()) text_.pose("origin", part.fitted->origin);
    for (const Solid& block : part.fitted->blocks) write_block(block, part.where);
    return;
  }
  const Transform frame(part.pose_body_part);
  const Box whole = extent_of(part.solids);
  const Vec2 middle = whole.center() - frame.position;
  const Rotation& turn = frame.rotation;
  Pose origin{middle.x() * turn.cos + middle.y() * turn.sin, middle.y() * turn.cos - middle.x() * turn.sin, 0, 0};
  constexpr double k_centred = 1e-9;  // of the extent: less is rounding
  if (origin.position().norm() <= k_centred * whole.size().norm()) origin = Pose();
  const Pose pose_body_blocks = compose(part.pose_body_part, origin);
  std::vector<Solid> solids = part.solids;
  for (Solid& solid : solids) {
    for (Ring& ring : solid.contours)
      for (Vec2& point : ring)
        point = relative_pose(pose_body_blocks, {point.x(), point.y(), 0, pose_body_blocks.heading}).position();
    const auto lowered = [&](double z) {
      return solved(z, z - pose_body_blocks.z, [&](double x) { return x + pose_body_blocks.z; });
    };
    solid.z = {lowered(solid.z.min), lowered(solid.z.max)};
  }
  const Box extent = extent_of(solids);
  ZInterval z = solids.front().z;
  for (const Solid& solid : solids) z = {std::min(z.min, solid.z.min), std::max(z.max, solid.z.max)};
  write_size({extent.size().x(), extent.size().y(), z.max - z.min}, nullptr, part.where);
  if (origin != Pose()) text_.pose("origin", origin);
  for (const Solid& solid : solids) write_block(solid, part.where);
}

void TypeText::write_block(const Solid& block, Where where) {
  if (block.contours.size() != 1) return lacks(where, "a body with holes: Stage's blocks have none");
  const Ring& ring = block.contours.front();
  text_.open("block");
  text_.number("points", static_cast<double>(ring.size()));
  for (std::size_t i = 0; i < ring.size(); ++i)
    text_.numbers(fmt::format("point[{}]", i), std::array{ring[i].x(), ring[i].y()});
  text_.numbers("z", std::array{block.z.min, block.z.max});
  text_.close();
}

void TypeText::write_size(const Eigen::Vector3d& size, const engine::ModelKind* kind, Where where) {
  if (kind && size == kind->size) return;
  if (size.minCoeff() <= 0) return lacks(where, "a size of 0");
  text_.numbers("size", std::array{size.x(), size.y(), size.z()});
}

void TypeText::write_returns(const engine::Returns& returns) {
  const engine::Returns usual;
  const auto& [obstacle, ranger, fiducial, fiducial_key, gripper, blob] = returns;
  if (obstacle != usual.obstacle) text_.flag("obstacle_return", obstacle);
  if (ranger != usual.ranger) text_.number("ranger_return", short_number(ranger));
  if (fiducial != usual.fiducial) text_.number("fiducial_return", fiducial);
  if (fiducial_key != usual.fiducial_key) text_.number("fiducial_key", fiducial_key);
  if (gripper != usual.gripper) text_.flag("gripper_return", gripper);
  if (blob != usual.blob) text_.flag("blob_return", blob);
}

void TypeText::write_drive(const engine::DriveSpec& drive) {
  const engine::DriveKind* kind = registry_.drive(drive.kind);
  if (!kind) return;
  const auto value = [&](std::string_view name, double fallback) {
    const int at = kind->params.find(name);
    return at < 0 ? fallback : drive.params[static_cast<std::size_t>(at)].number();
  };
  text_.text("drive", drive.kind);
  text_.number("update_interval", milliseconds(drive.period_s));
  const double quarter_turn = radians(90);
  text_.numbers("velocity_bounds",
                std::array{value("velocity_min_x", -1), value("velocity_max_x", 1), value("velocity_min_y", -1),
                           value("velocity_max_y", 1), -1.0, 1.0, value("turn_min", -quarter_turn),
                           value("turn_max", quarter_turn)});
  text_.numbers("acceleration_bounds",
                std::array{value("acceleration_min_x", -1), value("acceleration_max_x", 1),
                           value("acceleration_min_y", -1), value("acceleration_max_y", 1), -1.0, 1.0,
                           value("turn_acceleration_min", -quarter_turn),
                           value("turn_acceleration_max", quarter_turn)});
  if (kind->params.find("wheelbase") >= 0) text_.number("wheelbase", value("wheelbase", 1));
  const std::array start{value("start_x", 0), value("start_y", 0), 0.0, value("start_turn", 0)};
  if (start != std::array{0.0, 0.0, 0.0, 0.0}) text_.numbers("velocity", start);
  if (kind->params.find("localization") < 0) return;
  const std::string& localization = get(kind->params, drive.params, "localization").text();
  text_.text("localization", localization);
  text_.text("odom_heading", get(kind->params, drive.params, "odom_heading").text());
  const std::vector<double>& origin = get(kind->params, drive.params, "localization_origin").numbers();
  if (origin.size() == 2) {
    text_.numbers("localization_origin",
                  std::array{origin[0], origin[1], 0.0, value("localization_origin_heading", 0)});
    if (localization == "gps") text_.flag("gps_origin", true);
  }
  const std::vector<double>& error = get(kind->params, drive.params, "odom_error").numbers();
  if (error.size() == 3) text_.numbers("odom_error", std::array{error[0], error[1], 0.0, error[2]});
}

/// The calls of a part's controllers: `"script law=wave"`.
void TypeText::write_controllers(std::uint32_t p) {
  const auto argument = [](const Value& value) -> std::optional<std::string> {
    if (const bool* x = std::get_if<bool>(&value.v)) return *x ? "1" : "0";
    if (const auto* x = std::get_if<std::int64_t>(&value.v)) return fmt::format("{}", *x);
    if (const auto* x = std::get_if<double>(&value.v)) return fmt::format("{}", *x);
    if (const auto* x = std::get_if<std::string>(&value.v))
      return x->find_first_of(" \t") == x->npos ? std::optional(*x) : std::nullopt;
    if (const auto* x = std::get_if<std::vector<double>>(&value.v); x && !x->empty())
      return fmt::format("{}", fmt::join(*x, ","));
    return std::nullopt;
  };
  std::vector<std::string> calls;
  for (const engine::ControllerSpec& controller : type_.controllers) {
    const engine::ControllerKind* kind = registry_.controller(controller.kind);
    if (controller.part != p || !kind) continue;
    std::string call = controller.kind;
    const Record defaults = kind->params.defaults();
    for (std::size_t i = 0; i < defaults.size(); ++i) {
      if (same_bits(controller.params[i], defaults[i])) continue;
      if (const auto text = argument(controller.params[i]))
        call += fmt::format(" {}={}", kind->params.fields[i].name, *text);  // in SI units
    }
    calls.push_back(std::move(call));
  }
  if (calls.empty()) return;
  const auto first = std::ranges::find(type_.controllers, p, &engine::ControllerSpec::part);
  if (!(p == 0 && type_.drive) && !own_device(p)) text_.number("update_interval", milliseconds(first->period_s));
  if (calls.size() == 1) text_.text("ctrl", calls.front());
  if (calls.size() > 1) text_.texts("ctrl", calls);
}

/// Packs and contacts are properties of the model that they belong to.
void TypeText::write_power(std::uint32_t p) {
  for (const DeviceSpec& device : type_.devices) {
    const DeviceKind* kind = kind_of(device);
    if (device.part != p || !kind) continue;
    const auto value = [&](std::string_view name) { return get(kind->params, device.params, name); };
    if (device.kind == "power_pack") {
      const double capacity = value("capacity").number();
      const double stored = std::min(value("stored").number(), capacity);
      text_.number("joules", value("infinite").boolean() ? -1 : stored);
      if (!value("infinite").boolean() && stored != capacity) text_.number("joules_capacity", capacity);
      if (value("mass").number() > 0) text_.number("mass", value("mass").number());
      if (value("draw").number() > 0) text_.number("watts", value("draw").number());
      if (value("when_empty").text() != "stop") text_.text("when_empty", value("when_empty").text());
      if (p == 0 && type_.drive && value("idle").number() > 0 && type_.controllers.empty())
        text_.flag("alwayson", true);
    } else if (device.kind == "power_contact") {
      if (value("give").number() > 0) text_.number("give_watts", value("give").number());
      if (value("take").number() > 0) text_.number("take_watts", value("take").number());
      if (device.active && !own_device(p)) text_.flag("alwayson", true);
    }
  }
}

void TypeText::write_children(std::uint32_t p) {
  std::vector<const DeviceSpec*> devices;
  for (const DeviceSpec& device : type_.devices)
    if (&device != own_device(device.part) && !is_property(device) && carrier(device.part, device.joint) == p)
      devices.push_back(&device);
  std::vector<std::uint32_t> parts;
  for (std::uint32_t q = 1; q < type_.parts.size(); ++q) {
    const DeviceSpec* own = own_device(q);
    const DeviceKind* kind = own ? kind_of(*own) : nullptr;
    const std::int32_t joint = kind && moves_itself(*kind) ? own->joint : type_.parts[q].joint;
    if (!is_brought(q) && carrier(type_.parts[q].parent, joint) == p) parts.push_back(q);
  }
  if (devices.empty() && parts.empty()) return;
  text_.flag("stack_children", false);
  std::map<std::string, std::size_t> generated;
  const Pose& pose_body_part = type_.parts[p].pose_body_part;
  for (const DeviceSpec* device : devices) {
    const engine::ModelKind* model = registry_.model(device->kind);
    text_.at(device->where);
    if (!model || model->device != device->kind) {
      lacks(device->where, fmt::format("device \"{}\": there is no model of kind {}", device->name, device->kind));
      continue;
    }
    text_.open(device->kind);
    write_name(p, device->name, device->kind, generated);
    text_.pose("pose", relative_pose(pose_body_part, device->pose_body_sensor));
    if (model->has_default_body) text_.flag("noblocks", true);
    write_device(*device);
    text_.close();
  }
  for (const std::uint32_t q : parts) {
    const PartSpec& part = type_.parts[q];
    text_.at(part.where);
    text_.open(part.kind);
    write_name(p, part.name, part.kind, generated);
    text_.pose("pose", relative_pose(pose_body_part, part.pose_body_part));
    if (part.color) write_color(*part.color, text_);
    write_part(q);
    text_.close();
  }
}

void TypeText::write_name(std::uint32_t parent, const std::string& name, const std::string& kind,
                          std::map<std::string, std::size_t>& generated) {
  const std::string& above = type_.parts[parent].name;
  const std::string prefix = above.empty() ? "" : above + ".";
  const std::string given = fmt::format("{}{}:{}", prefix, kind, generated[kind]++);
  if (name == given) return;
  const bool is_below = name.size() > prefix.size() && name.starts_with(prefix) && name[prefix.size()] != '/';
  text_.text("name", is_below ? name.substr(prefix.size()) : "/" + name);
}

/// What the model of a device says of it.
void TypeText::write_device(const DeviceSpec& device) {
  const DeviceKind* kind = kind_of(device);
  if (!kind) return;
  if (device.active) text_.flag("alwayson", true);
  if (device.part != 0 || !type_.drive || &device != own_device(0))
    text_.number("update_interval", milliseconds(device.period_s));
  if (device.kind == "ranger") return write_ranger(device, *kind);
  write_parameters(device, *kind);
  if (device.kind == "bumper") write_bumpers(device, *kind);
  if (device.kind == "blobfinder") {
    const std::vector<double>& parts = get(kind->params, device.params, "colors").numbers();
    std::vector<std::string> names;
    for (std::size_t i = 0; i + 2 < parts.size(); i += 3) {
      const JsonNode node = color_node({static_cast<float>(parts[i]), static_cast<float>(parts[i + 1]),
                                        static_cast<float>(parts[i + 2]), 1});
      names.push_back(node.text() ? *node.text() : "red");  // a colour without a name is told afterwards
    }
    if (!names.empty()) {
      text_.number("colors_count", static_cast<double>(names.size()));
      text_.texts("colors", names);
    }
  }
  if (device.kind == "gripper") {
    text_.numbers("paddle_size", get(kind->params, device.params, "paddle_size").numbers());
    text_.texts("paddle_state", std::array{get(kind->params, device.params, "paddles").text(),
                                           get(kind->params, device.params, "lift").text()});
  }
}

void TypeText::write_parameters(const DeviceSpec& device, const DeviceKind& kind) {
  const Record defaults = kind.params.defaults();
  for (const StageParameter& parameter : stage_parameters()) {
    if (parameter.model != device.kind || parameter.column > 0) continue;
    const double to_si = parameter.unit == StageUnit::degrees        ? radians(1)
                         : parameter.unit == StageUnit::milliseconds ? 1e-3
                                                                     : 1.0;  // metres and radians
    const auto written = [to_si](double si) {
      return solved(si, si / to_si, [to_si](double x) { return x * to_si; });
    };
    const auto as_number = [&](const Value& value) {
      const auto* whole = std::get_if<std::int64_t>(&value.v);
      return whole ? static_cast<double>(*whole) : written(value.number());
    };
    const auto at = static_cast<std::size_t>(kind.params.find(parameter.field));
    const Value& value = device.params[at];
    if (parameter.column == 0) {  // of a tuple [a b], whose other number is a field of its own
      const auto other = std::ranges::find_if(stage_parameters(), [&](const StageParameter& one) {
        return one.model == parameter.model && one.property == parameter.property && one.column == 1;
      });
      text_.numbers(parameter.property,
                    std::array{as_number(value), as_number(get(kind.params, device.params, other->field))});
    } else if (!same_bits(value, defaults[at])) {
      switch (kind.params.fields[at].type) {
        case FieldType::boolean: text_.flag(parameter.property, value.boolean()); break;
        case FieldType::text: text_.text(parameter.property, value.text()); break;
        case FieldType::numbers: text_.numbers(parameter.property, value.numbers()); break;
        default: text_.number(parameter.property, as_number(value));
      }
    }
  }
}

void TypeText::write_ranger(const DeviceSpec& device, const DeviceKind& kind) {
  const int at = kind.params.find("transducers");
  const FieldTable& table = *kind.params.fields[static_cast<std::size_t>(at)].record;
  if (get(kind.params, device.params, "intensity").boolean()) text_.flag("intensity", true);
  for (const Record& transducer : device.params[static_cast<std::size_t>(at)].records()) {
    const auto number = [&](std::string_view name) { return get(table, transducer, name).number(); };
    const Record& pose = get(table, transducer, "pose").records().front();
    constexpr double k_middle = 0.02 / 2;  // m: of the height of Stage's transducers, where their beams leave
    const double z = solved(pose[2].number(), pose[2].number() - k_middle,
                            [](double x) { return x + k_middle; });
    text_.open("sensor");
    text_.numbers("pose", list_of({pose[0].number(), pose[1].number(), z, pose[3].number()}));
    text_.numbers("range", std::array{number("range_min"), number("range_max")});
    text_.number("fov", number("fov"));
    const std::int64_t samples = get(table, transducer, "samples").integer();
    text_.number("samples", static_cast<double>(samples));
    const double stddev = number("noise_stddev");
    const double angular = number("noise_angular");
    if (stddev > 0 || angular > 0 || number("noise_proportional") > 0) {
      const double step = number("fov") / static_cast<double>(std::max<std::int64_t>(samples - 1, 1));
      const double variance = solved(stddev, stddev * stddev, [](double x) { return sqrt(x); });
      const double share = angular == 0 || step == 0
                               ? 0
                               : solved(angular, angular / (0.5 * step), [step](double x) { return 0.5 * step * x; });
      text_.numbers("noise", std::array{variance, number("noise_proportional"), share});
    }
    if (number("beam_width") > 0) text_.number("beam_width", number("beam_width"));
    if (get(table, transducer, "apply_range_min").boolean()) text_.flag("apply_range_min", true);
    text_.close();
  }
}

void TypeText::write_bumpers(const DeviceSpec& device, const DeviceKind& kind) {
  const FieldTable& table = *kind.params.fields[0].record;
  const std::vector<Record>& bumpers = device.params[0].records();
  if (bumpers.empty()) return;
  text_.number("bcount", static_cast<double>(bumpers.size()));
  for (std::size_t k = 0; k < bumpers.size(); ++k) {
    const Record& pose = get(table, bumpers[k], "pose").records().front();
    text_.numbers(fmt::format("bpose[{}]", k),
                  std::array{pose[0].number(), pose[1].number(), pose[2].number(), pose[3].number()});
    text_.number(fmt::format("blength[{}]", k), get(table, bumpers[k], "length").number());
  }
}

/// Words of Stage's syntax, beginning with a letter.
std::string word_of(const std::string& name) {
  std::string word;
  for (const char c : name) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    const bool is_other = (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
    if (word.empty() && !is_letter) word = "type_";
    word += is_letter || is_other ? c : '_';
  }
  return word.empty() ? "type" : word;
}

class WorldText {
 public:
  WorldText(const WorldSpec& spec, const std::filesystem::path& file, const JsonNode* document,
            const engine::Registry& registry, Diagnostics& diagnostics)
      : spec_(spec),
        file_(file),
        folder_(file.parent_path()),
        document_(document),
        registry_(registry),
        diagnostics_(diagnostics),
        images_(image_findings_),
        text_(diagnostics) {}

  std::string write() {
    write_settings();
    write_types();
    for (std::size_t b = 1; b < spec_.bodies.size(); ++b) write_body(spec_.bodies[b]);
    return text_.str();
  }

 private:
  Where where_of(std::string_view key) const {
    const JsonNode* node = document_ ? document_->find(key) : nullptr;
    return node ? node->where : Where{spec_.resolution_where.file, 0};
  }
  void lacks(std::string_view key, std::string_view why) {
    diagnostics_.error(where_of(key), fmt::format("a .world file cannot say this: \"{}\": {}", key, why));
  }
  void refuse_what_stage_lacks();
  void write_settings();
  void write_types();
  void write_body(const engine::BodySpec& body);

  const WorldSpec& spec_;
  const std::filesystem::path& file_;
  std::filesystem::path folder_;
  const JsonNode* document_;
  const engine::Registry& registry_;
  Diagnostics& diagnostics_;
  Diagnostics image_findings_;  // of images that are outlines then
  FloorImages images_;
  StageText text_;
  std::vector<std::string> macros_;  // of the types
  std::vector<Color> colors_;        // of the types: of their first bodies
};

void WorldText::refuse_what_stage_lacks() {
  if (spec_.ranging != engine::RangingEngine::exact)
    lacks("ranging", "which engine finds ranges is an option of the run, --raytracer");
  if (spec_.record) lacks("record", "what is recorded is an option of the run, --record");
  if (!spec_.measures.empty()) lacks("measures", "they are options of the run, --measure");
  if (spec_.measure_every_s != WorldSpec().measure_every_s)
    lacks("measure_every_s", "it is an option of the run, --measure-every");
  if (document_ && document_->find("bounds_m"))
    lacks("bounds_m", "it reaches 100 km in each direction");
  else if (spec_.bounds)
    diagnostics_.warning(where_of("floorplans"),
                         "a .world reaches 100 km in each direction: robots that leave the floor plans are held "
                         "no more");
}

void WorldText::write_settings() {
  refuse_what_stage_lacks();
  text_.comment("Written by troupe convert.");
  text_.at(where_of("title"));
  if (!spec_.title.empty()) text_.text("name", spec_.title);
  text_.text("unit_length", "m");
  text_.text("unit_angle", "radians");
  const auto clock = [](double ms) { return std::floor(ms * 1000) / 1e6; };  // whole microseconds
  text_.number("interval_sim", solved(spec_.tick_s, spec_.tick_s * 1000, clock));
  text_.at(where_of("quit_time_s"));
  if (spec_.quit_time_s) text_.number("quit_time", *spec_.quit_time_s);
  if (spec_.resolution_m != WorldSpec().resolution_m) text_.number("resolution", spec_.resolution_m);
  text_.at(where_of("seed"));
  text_.number("seed", static_cast<double>(spec_.seed));
  write_stage_watch(spec_.watch, text_);
  text_.at(where_of("window"));
  if (spec_.window) write_stage_window(*spec_.window, text_);
}

/// A macro for each type that has bodies, called as the type is where that is no word of Stage's already.
void WorldText::write_types() {
  std::vector<bool> is_used(spec_.types.size(), false);
  std::vector<bool> has_many_colors(spec_.types.size(), false);
  colors_.resize(spec_.types.size());
  for (std::size_t b = 1; b < spec_.bodies.size(); ++b) {
    const std::size_t t = spec_.bodies[b].type.index();
    if (!is_used[t]) colors_[t] = spec_.bodies[b].color;
    if (spec_.bodies[b].color != colors_[t]) has_many_colors[t] = true;
    is_used[t] = true;
  }
  std::set<std::string> taken{"define", "include", "block", "sensor", "window", "laser", "sonar"};
  for (const engine::ModelKind& kind : registry_.models) taken.emplace(kind.name);
  macros_.resize(spec_.types.size());
  for (std::size_t t = 1; t < spec_.types.size(); ++t) {
    if (!is_used[t]) continue;
    const TypeSpec& type = spec_.types[t];
    macros_[t] = word_of(type.name);
    for (int n = 2; !taken.insert(macros_[t]).second; ++n) macros_[t] = fmt::format("{}_{}", word_of(type.name), n);
    TypeSpec colored = type;  // a part without a colour of its own has its body's
    for (std::size_t p = 1; p < colored.parts.size(); ++p) {
      if (colored.parts[p].color || colored.parts[p].solids.empty()) continue;
      colored.parts[p].color = colors_[t];
      if (has_many_colors[t])
        diagnostics_.error(colored.parts[p].where,
                           fmt::format("a .world file cannot say this: type \"{}\": part \"{}\" takes the color "
                                       "of its body",
                                       type.name, colored.parts[p].name));
    }
    TypeText(colored, folder_, registry_, images_, diagnostics_, text_).write(macros_[t], colors_[t]);
  }
}

void WorldText::write_body(const engine::BodySpec& body) {
  const std::size_t type = body.type.index();
  const std::string name = spec_.names.text(body.name);
  text_.at(body.where);
  text_.open(macros_[type]);
  text_.text("name", name.starts_with('/') ? "/" + name : name);
  text_.pose("pose", body.pose_world_body);
  if (body.color != colors_[type]) write_color(body.color, text_);
  text_.close();
}

}  // namespace

std::string write_stage_world(const WorldSpec& spec, const std::filesystem::path& file, const JsonNode* document,
                              const engine::Registry& registry, Diagnostics& diagnostics) {
  std::string text = WorldText(spec, file, document, registry, diagnostics).write();
  if (diagnostics.has_errors()) return text;
  Diagnostics found;
  const WorldSpec back = load_stage_world(file, text, registry, {}, found);
  for (const Finding& finding : found.findings())
    if (finding.severity == Severity::error)
      diagnostics.error({spec.resolution_where.file, 0},
                        fmt::format("a .world file cannot say this: {}", finding.message));
  if (!diagnostics.has_errors()) check_stage_round_trip(spec, back, registry, diagnostics);
  return text;
}

}  // namespace troupe::worldio
