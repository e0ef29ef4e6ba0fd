#include "worldio/stage/stage_type_writer.hpp"

#include "worldio/json/fields_json.hpp"
#include "worldio/json/json_parts.hpp"
#include "worldio/json/spec_difference.hpp"
#include "worldio/json/type_document.hpp"
#include "worldio/stage/stage_demos.hpp"
#include "worldio/stage/stage_device_writer.hpp"
#include "worldio/stage/stage_power.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <unordered_map>
#include <vector>

namespace troupe::worldio {
namespace {

using engine::DeviceKind;
using engine::DeviceSpec;
using engine::PartSpec;
using engine::TypeSpec;

void write_rgba(const Color& color, StageText& text) {
  text.numbers("color_rgba", std::array{short_number(color.r), short_number(color.g), short_number(color.b),
                                        short_number(color.a)});
}

Box extent_of(const std::vector<Solid>& solids) {
  Box box;
  for (const Solid& solid : solids)
    for (const Ring& ring : solid.contours) box.extend(bounds(ring));
  return box;
}

/// Writes one type; see write_stage_type().
class TypeText {
 public:
  TypeText(const TypeSpec& type, const StageMacro& macro, const StagePlaces& places, StageText& text)
      : type_(type),
        macro_(macro),
        folder_(places.folder),
        registry_(places.registry),
        images_(places.images),
        diagnostics_(places.diagnostics),
        text_(text),
        own_devices_(type.parts.size()),
        inside_(type.parts.size()) {}

  void write();

 private:
  void lacks(Where where, const std::string& what) {
    diagnostics_.error(where,
                       fmt::format("a .world file cannot express this: type \"{}\": {}", type_.name, what));
  }
  const DeviceKind* kind_of(const DeviceSpec& device) const { return registry_.device(device.kind); }
  bool is_property(const DeviceSpec& device) const {
    return device.kind == "power_pack" || device.kind == "power_contact" || device.kind == "flags";
  }
  /// Whether this device is the drive of a position model that is inside another model.
  bool is_wheels(const DeviceSpec& device) const {
    return device.kind == "wheels" && device.part != 0 && type_.parts[device.part].kind == "position";
  }
  /// The devices and the parts that are written inside the model of a part, as children of this model.
  struct Inside {
    std::vector<const DeviceSpec*> devices;
    std::vector<std::uint32_t> parts;
  };

  /// Sets own_devices_ and inside_. A search for each part would take hours for a type with thousands of
  /// parts and devices.
  void find_models();
  /// Returns the device that a part itself is; null if the part is no device.
  const DeviceSpec* own_device(std::uint32_t p) const { return own_devices_[p]; }
  /// Returns the joint that moves the children of a part.
  std::int32_t joint_of(std::uint32_t p) const;
  bool is_brought(std::uint32_t p) const;

  void write_part(std::uint32_t p);
  void write_body(std::uint32_t p, const DeviceSpec* own);
  static bool is_default_box(const PartSpec& part, const engine::ModelKind& kind);
  bool write_image(const PartSpec& part);
  void write_blocks(const PartSpec& part, const DeviceSpec* own);
  void write_block(const Solid& block, Where where);
  void write_size(const Eigen::Vector3d& size, const engine::ModelKind* kind);
  void write_returns(const engine::Returns& returns);
  void write_controllers(std::uint32_t p);
  /// Whether the property `watts` of a part counts: in Stage, only the watts of running models count, and not
  /// those of models whose power Troupe determines.
  bool may_draw(std::uint32_t p) const;
  void find_draws();
  void write_power(std::uint32_t p);
  void write_children(std::uint32_t p);
  /// Writes the name of a child of `parent`, unless it is the name that the reader generates. `generated`
  /// counts the children of each kind that were written before.
  void write_name(std::uint32_t parent, const std::string& name, const std::string& kind,
                  std::map<std::string, std::size_t>& generated);

  const TypeSpec& type_;
  const StageMacro& macro_;
  const std::filesystem::path& folder_;
  const engine::Registry& registry_;
  FloorImages& images_;
  Diagnostics& diagnostics_;
  StageText& text_;
  std::vector<const DeviceSpec*> own_devices_;  // per part: see own_device()
  std::vector<Inside> inside_;                  // per part: see struct Inside
  std::map<std::uint32_t, double> draws_;       // parts with the property `watts`, and its value
};

void TypeText::write() {
  find_models();
  find_draws();
  const PartSpec& root = type_.parts.front();
  text_.at(root.where);
  text_.define(macro_.word, root.kind);
  if (macro_.has_many_colors)
    write_rgba(macro_.color, text_);
  else
    write_stage_color(macro_.color, text_);
  write_part(0);
  text_.close();
}

void TypeText::find_models() {
  for (const DeviceSpec& device : type_.devices) {
    const PartSpec& part = type_.parts[device.part];
    const engine::ModelKind* model = registry_.model(part.kind);
    const DeviceSpec*& own = own_devices_[device.part];
    if (!own && model && device.name == part.name && (model->device == device.kind || is_wheels(device)))
      own = &device;
  }
  std::unordered_map<std::int32_t, std::uint32_t> moving;  // joint -> the part that is itself its device
  for (std::uint32_t p = 0; p < type_.parts.size(); ++p)
    if (const DeviceSpec* own = own_device(p); own && own->moves == joint_of(p))
      moving.try_emplace(own->moves, p);
  // Returns the part in whose model a child of `part` must be written so that the child moves with `joint`.
  // This is `part` if the joint moves its children, else the part that is itself the device with this joint.
  // If there is no such part, it is `part`.
  const auto carrier = [&](std::uint32_t part, std::int32_t joint) {
    const auto found = joint_of(part) == joint ? moving.end() : moving.find(joint);
    return found == moving.end() ? part : found->second;
  };
  for (const DeviceSpec& device : type_.devices)
    if (&device != own_device(device.part) && !is_property(device))
      inside_[carrier(device.part, device.joint)].devices.push_back(&device);
  for (std::uint32_t p = 1; p < type_.parts.size(); ++p) {
    if (macro_.added[p] || is_brought(p)) continue;
    const DeviceSpec* own = own_device(p);
    const DeviceKind* kind = own ? kind_of(*own) : nullptr;
    const std::int32_t joint = kind && moves_itself(*kind) ? own->joint : type_.parts[p].joint;
    inside_[carrier(type_.parts[p].parent, joint)].parts.push_back(p);
  }
}

std::int32_t TypeText::joint_of(std::uint32_t p) const {
  const DeviceSpec* own = own_device(p);
  const DeviceKind* kind = own ? kind_of(*own) : nullptr;
  return kind && moves_itself(*kind) ? own->moves : type_.parts[p].joint;
}

/// Whether the reader adds this part by itself because of the device of the parent part, as a gripper adds
/// its paddles.
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
  if ((part.kind == "position") != (p == 0 ? type_.drive.has_value() : own && is_wheels(*own)))
    lacks(part.where, part.kind == "position" ? std::string("a part of kind \"position\" without a drive")
                                              : fmt::format("a drive in a part of kind \"{}\"", part.kind));
  write_body(p, own);
  write_returns(part.returns);
  if (part.returns.pushable) lacks(part.where, "a \"pushable\" body");
  const engine::DriveKind* drive = p == 0 && type_.drive ? registry_.drive(type_.drive->kind) : nullptr;
  if (drive) write_stage_drive(*type_.drive, *drive, text_);
  write_power(p);
  write_controllers(p);
  if (own && is_wheels(*own)) {
    const auto controller = std::ranges::find(type_.controllers, p, &engine::ControllerSpec::part);
    write_stage_wheels(*own, controller == type_.controllers.end() ? 0 : controller->period_s, registry_,
                       text_);
  } else if (own && kind_of(*own))
    write_stage_device(*own, *kind_of(*own), text_);
  write_children(p);
}

void TypeText::write_body(std::uint32_t p, const DeviceSpec* own) {
  const PartSpec& part = type_.parts[p];
  const engine::ModelKind* kind = registry_.model(part.kind);
  const DeviceKind* device = own ? kind_of(*own) : nullptr;
  if (write_image(part)) return;
  // The reader gives a gripper its base and its paddles, unless its model has blocks or walls.
  bool is_brought_along = false;
  if (device && device->body)
    for (std::uint32_t q = p + 1; q < type_.parts.size(); ++q)
      is_brought_along = is_brought_along || (type_.parts[q].parent == p && is_brought(q));
  if (!is_brought_along) {
    if (is_default_box(part, *kind)) return write_size(part.size, kind);
    if (!part.solids.empty()) return write_blocks(part, own);
    if (kind->has_default_body || (device && device->body)) text_.flag("noblocks", true);
  }
  write_size(part.size, kind);
  if (own && !is_wheels(*own) && own->pose_body_device != part.pose_body_part)  // `origin` moves the device
    text_.pose("origin", relative_pose(part.pose_body_part, own->pose_body_device));
}

bool TypeText::is_default_box(const PartSpec& part, const engine::ModelKind& kind) {
  if (!kind.has_default_body || part.size.minCoeff() <= 0) return false;
  const double x = part.size.x() / 2;
  const double y = part.size.y() / 2;
  const Solid box{{{{-x, -y}, {x, -y}, {x, y}, {-x, y}}}, {0, part.size.z()}};
  return part.solids == std::vector{placed(box, part.pose_body_part)};
}

/// Writes the image of a part. Writes nothing and returns false if the image, stretched to the size of the
/// part or to the extent of its solids, does not give exactly its solids.
bool TypeText::write_image(const PartSpec& part) {
  if (!part.image) return false;
  const FloorImage* image = images_.read(part.image->file, part.image->unknown_is_solid, {});
  if (!image) return false;
  const Box extent = extent_of(part.solids);
  const std::array sizes{part.size, Eigen::Vector3d(extent.size().x(), extent.size().y(), part.size.z())};
  for (const Eigen::Vector3d& size : sizes) {
    PartSpec made = part;
    made.size = size;
    if (image_solids(*image, made) != part.solids) continue;
    text_.text("bitmap", contract_image(*part.image, size, folder_).bitmap);
    text_.numbers("size", std::array{size.x(), size.y(), size.z()});
    if (part.image->origin != Pose()) text_.pose("origin", part.image->origin);
    if (part.image->keeps_margins) text_.flag("bitmap_margins", true);
    if (part.image->unknown_is_solid) text_.flag("bitmap_unknown", true);
    if (part.image->boundary) text_.flag("boundary", true);
    return true;
  }
  return false;
}

/// Writes the solids of a part as blocks. Stage scales the blocks of a model to the size of the model and
/// centres them. The property `origin` is therefore written, to undo the centring. If the part is also a
/// device, the blocks are written in the frame of the device, because `origin` moves both.
void TypeText::write_blocks(const PartSpec& part, const DeviceSpec* own) {
  if (part.fitted) {
    write_size(part.size, nullptr);
    if (part.fitted->origin != Pose()) text_.pose("origin", part.fitted->origin);
    for (const Solid& block : part.fitted->blocks) write_block(block, part.where);
    return;
  }
  const bool is_moved = own && !is_wheels(*own) && own->pose_body_device != part.pose_body_part;
  const Transform frame(is_moved ? own->pose_body_device : part.pose_body_part);
  const auto along_axes = [&turn = frame.rotation](const Vec2& p) {
    return Vec2(p.x() * turn.cos + p.y() * turn.sin, p.y() * turn.cos - p.x() * turn.sin);
  };
  Box whole;  // along the axes of the frame
  for (const Solid& solid : part.solids)
    for (const Ring& ring : solid.contours)
      for (const Vec2& point : ring) whole.extend(along_axes(point));
  const Vec2 middle = whole.center() - along_axes(frame.position);
  Pose origin = is_moved ? relative_pose(part.pose_body_part, own->pose_body_device) : Pose();
  constexpr double k_centred = 1e-9;  // fraction of the extent; smaller offsets are rounding errors
  if (middle.norm() > k_centred * whole.size().norm())
    origin = compose(origin, Pose{middle.x(), middle.y(), 0, 0});
  const Pose pose_body_blocks = compose(part.pose_body_part, origin);
  std::vector<Solid> solids = part.solids;
  for (Solid& solid : solids) {
    for (Ring& ring : solid.contours)
      for (Vec2& point : ring)
        point =
            relative_pose(pose_body_blocks, {point.x(), point.y(), 0, pose_body_blocks.heading}).position();
    const auto lowered = [&](double z) {
      return solved(z, z - pose_body_blocks.z, [&](double x) { return x + pose_body_blocks.z; });
    };
    solid.z = {lowered(solid.z.min), lowered(solid.z.max)};
  }
  const Box extent = extent_of(solids);
  if (extent.size().minCoeff() <= 0) return lacks(part.where, "an outline whose extent along x or y is 0");
  ZInterval z = solids.front().z;
  for (const Solid& solid : solids) z = {std::min(z.min, solid.z.min), std::max(z.max, solid.z.max)};
  write_size({extent.size().x(), extent.size().y(), z.max - z.min}, nullptr);
  if (origin != Pose()) text_.pose("origin", origin);
  for (const Solid& solid : solids) write_block(solid, part.where);
}

void TypeText::write_block(const Solid& block, Where where) {
  if (block.contours.size() != 1) return lacks(where, "a body with holes: Stage's blocks have no holes");
  const Ring& ring = block.contours.front();
  text_.open("block");
  text_.number("points", static_cast<double>(ring.size()));
  for (std::size_t i = 0; i < ring.size(); ++i)
    text_.numbers(fmt::format("point[{}]", i), std::array{ring[i].x(), ring[i].y()});
  text_.numbers("z", std::array{block.z.min, block.z.max});
  text_.close();
}

void TypeText::write_size(const Eigen::Vector3d& size, const engine::ModelKind* kind) {
  if (kind && size == kind->size) return;
  text_.numbers("size", std::array{size.x(), size.y(), size.z()});
}

// check_stage_round_trip() reports members that Stage lacks and that have unusual values.
void TypeText::write_returns(const engine::Returns& returns) {
  const engine::Returns usual;
  if (returns.obstacle != usual.obstacle) text_.flag("obstacle_return", returns.obstacle);
  if (returns.ranger != usual.ranger) text_.number("ranger_return", short_number(returns.ranger));
  if (returns.fiducial != usual.fiducial) text_.number("fiducial_return", returns.fiducial);
  if (returns.fiducial_key != usual.fiducial_key) text_.number("fiducial_key", returns.fiducial_key);
  if (returns.gripper != usual.gripper) text_.flag("gripper_return", returns.gripper);
  if (returns.blob != usual.blob) text_.flag("blob_return", returns.blob);
}

void TypeText::write_controllers(std::uint32_t p) {
  std::vector<std::string> calls;
  double period_s = 0;
  for (const engine::ControllerSpec& controller : type_.controllers) {
    if (controller.part != p) continue;
    const engine::ControllerKind* kind = registry_.controller(controller.kind);
    if (!kind) continue;
    const Result<std::string> call = stage_call(controller, *kind);
    if (!call)
      return lacks(controller.where,
                   fmt::format("controller \"{}\": {}", controller.kind, call.error().text));
    calls.push_back(*call);
    period_s = controller.period_s;
  }
  if (calls.empty()) return;
  if (!(p == 0 && type_.drive) && !own_device(p))
    text_.number("update_interval", stage_milliseconds(period_s));
  if (calls.size() == 1) text_.text("ctrl", calls.front());
  if (calls.size() > 1) text_.texts("ctrl", calls);
}

bool TypeText::may_draw(std::uint32_t p) const {
  if (has_own_draw(type_.parts[p].kind) || macro_.added[p] || is_brought(p)) return false;
  // `alwayson` must not switch on the device or the contact of the model.
  const DeviceSpec* own = own_device(p);
  return std::ranges::none_of(type_.devices, [&](const DeviceSpec& device) {
    return device.part == p && !device.active && (&device == own || device.kind == "power_contact");
  });
}

/// Finds the models in which the constant draws of the power packs are written: for each pack, the first part
/// that it supplies and that may draw. The draw of a pack without such a part is left out.
void TypeText::find_draws() {
  std::map<std::size_t, double> watts_of_packs;
  for (std::size_t d = 0; d < type_.devices.size(); ++d) {
    const DeviceKind* kind = kind_of(type_.devices[d]);
    if (!kind || kind->name != "power_pack") continue;
    const double watts = get(kind->params, type_.devices[d].params, "draw").number();
    if (watts > 0) watts_of_packs[d] = watts;
  }
  for (std::uint32_t p = 0; p < type_.parts.size() && !watts_of_packs.empty(); ++p) {
    if (!may_draw(p)) continue;
    const std::optional<std::size_t> pack = pack_of(type_, p);
    const auto found = pack ? watts_of_packs.find(*pack) : watts_of_packs.end();
    if (found == watts_of_packs.end()) continue;
    draws_[p] = found->second;
    watts_of_packs.erase(found);
  }
}

/// Writes power packs, power contacts and constant draws. In Stage, they are properties of the model that has
/// them.
void TypeText::write_power(std::uint32_t p) {
  const auto draw = draws_.find(p);
  bool is_on = draw != draws_.end();
  if (is_on) text_.number("watts", draw->second);
  for (const DeviceSpec& device : type_.devices) {
    if (device.part != p) continue;
    const DeviceKind* kind = kind_of(device);
    if (!kind) continue;
    const engine::Record params = effective_params(type_, device, kind->params);
    const auto value = [&](std::string_view name) { return get(kind->params, params, name); };
    if (device.kind == "power_pack") {
      const double capacity = value("capacity").number();
      const double stored = value("stored").number();
      text_.number("joules", value("infinite").boolean() ? -1 : stored);
      if (stored != capacity) text_.number("joules_capacity", capacity);
      if (value("mass").number() > 0) text_.number("mass", value("mass").number());
      if (value("when_empty").text() != "stop") text_.text("when_empty", value("when_empty").text());
      is_on = is_on || (value("idle").number() > 0 && type_.controllers.empty());
    } else if (device.kind == "power_contact") {
      if (value("give").number() > 0) text_.number("give_watts", value("give").number());
      if (value("take").number() > 0) text_.number("take_watts", value("take").number());
      is_on = is_on || device.active;
    }
  }
  if (is_on && !own_device(p)) text_.flag("alwayson", true);  // a device is written with its own `alwayson`
}

void TypeText::write_children(std::uint32_t p) {
  const auto& [devices, parts] = inside_[p];
  if (devices.empty() && parts.empty()) return;
  text_.flag("stack_children", false);
  std::map<std::string, std::size_t> generated;
  const Pose& pose_body_part = type_.parts[p].pose_body_part;
  for (const DeviceSpec* device : devices) {
    const engine::ModelKind* model = registry_.model(device->kind);
    text_.at(device->where);
    if (!model || model->device != device->kind || !kind_of(*device)) {
      lacks(device->where,
            fmt::format("device \"{}\": Stage has no model of kind {}", device->name, device->kind));
      continue;
    }
    text_.open(device->kind);
    write_name(p, device->name, device->kind, generated);
    text_.pose("pose", relative_pose(pose_body_part, device->pose_body_device));
    if (model->has_default_body) text_.flag("noblocks", true);
    write_stage_device(*device, *kind_of(*device), text_);
    text_.close();
  }
  for (const std::uint32_t q : parts) {
    const PartSpec& part = type_.parts[q];
    text_.at(part.where);
    text_.open(part.kind);
    write_name(p, part.name, part.kind, generated);
    text_.pose("pose", relative_pose(pose_body_part, part.pose_body_part));
    if (part.color) write_stage_color(*part.color, text_);
    write_part(q);
    text_.close();
  }
}

void TypeText::write_name(std::uint32_t parent, const std::string& name, const std::string& kind,
                          std::map<std::string, std::size_t>& generated) {
  const std::string& above = type_.parts[parent].name;
  const std::string prefix = above.empty() ? "" : above + ".";
  const std::string given = fmt::format("{}{}:{}", prefix, kind, generated[kind]++);
  if (macro_.global_parts.contains(name)) return text_.text("name", "/" + name);
  if (name == given) return;
  const bool is_below = name.size() > prefix.size() && name.starts_with(prefix) && name[prefix.size()] != '/';
  text_.text("name", is_below ? name.substr(prefix.size()) : "/" + name);
}

}  // namespace

void write_stage_color(const Color& color, StageText& text) {
  const JsonNode node = color_node(color);
  if (const std::string* name = node.text()) return text.text("color", *name);
  write_rgba(color, text);
}

std::vector<bool> added_parts(const TypeSpec& type, std::uint64_t seed, const engine::Registry& registry) {
  std::vector<bool> added(type.parts.size(), false);
  for (const engine::ControllerSpec& controller : type.controllers) {
    const StageAddition add = stage_addition(controller.kind);
    if (!add) continue;
    // The parts that a controller adds are consecutive, somewhere after its own part.
    TypeSpec read = type;
    read.parts.resize(controller.part + 1);
    static_cast<void>(add(controller.params, seed, registry, read, controller.part));
    const auto begin = read.parts.begin() + controller.part + 1;
    const auto count = read.parts.end() - begin;
    for (auto at = type.parts.begin() + controller.part + 1; count > 0 && type.parts.end() - at >= count;
         ++at) {
      const auto flag = added.begin() + (at - type.parts.begin());
      if (*flag || !std::equal(begin, read.parts.end(), at, same_part)) continue;
      std::fill_n(flag, count, true);
      break;
    }
  }
  return added;
}

void write_stage_type(const TypeSpec& type, const StageMacro& macro, const StagePlaces& places,
                      StageText& text) {
  TypeText(type, macro, places, text).write();
}

}  // namespace troupe::worldio
