#include "engine/spec/body_type.hpp"

#include "base/split.hpp"
#include "engine/kinds/thrown_text.hpp"
#include "engine/spec/names.hpp"
#include "engine/spec/placement.hpp"
#include "engine/spec/prepared_check.hpp"
#include "engine/spec/ticks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <string>

namespace troupe::engine {
namespace {

constexpr double k_most_readings = 1e6;  // largest number of readings of one sensor

/// Returns, for each piece of shape_of(spec, counts) in order, the index of the joint that it is mounted on.
std::vector<std::int32_t> joints_of_pieces(const TypeSpec& spec, bool (*counts)(const PartSpec& part)) {
  std::vector<std::int32_t> joints;
  for (const PartSpec& part : spec.parts) {
    if (!counts(part)) continue;
    for (const Solid& solid : part.solids)
      joints.insert(joints.end(), convex_pieces(solid).size(), part.joint);
  }
  return joints;
}

/// Adds the outlines of the parts that rangers do not see (`hidden`), or of all others. Counts the solids of
/// all parts in `solids`.
void add_outlines(const TypeSpec& spec, bool hidden, std::uint32_t& solids, BodyType& type) {
  std::vector<RayOutline>& outlines = hidden ? type.hidden_outlines : type.outlines;
  for (std::uint32_t p = 0; p < spec.parts.size(); ++p) {
    const PartSpec& part = spec.parts[p];
    if ((part.returns.ranger < 0) != hidden) continue;
    for (const Solid& solid : part.solids) {
      for (const Ring& ring : solid.contours) {
        outlines.push_back({static_cast<std::uint32_t>(type.outline_vertices.size()),
                            static_cast<std::uint32_t>(ring.size()), solid.z, part.returns.ranger, p, solids,
                            part.joint});
        type.outline_vertices.insert(type.outline_vertices.end(), ring.begin(), ring.end());
      }
      ++solids;
    }
  }
}

/// Adds the shapes with which bodies of a type block others and are gripped.
void add_shapes(const TypeSpec& spec, BodyType& type) {
  type.obstacle = obstacle_shape(spec);
  const auto is_gripped = [](const PartSpec& part) { return part.returns.gripper; };
  type.grip = shape_of(spec, is_gripped);
  if (!spec.joints.empty())
    type.obstacle_joints = joints_of_pieces(spec, [](const PartSpec& part) { return part.returns.obstacle; });
  // Left empty where possible, because grippers then need not place each piece by its joint.
  const auto has_joint = [&](const PartSpec& part) { return is_gripped(part) && part.joint != k_rigid; };
  if (std::ranges::any_of(spec.parts, has_joint)) type.grip_joints = joints_of_pieces(spec, is_gripped);
}

void add_geometry(const TypeSpec& spec, BodyType& type, Diagnostics& diagnostics) {
  std::uint32_t solids = 0;
  for (const bool hidden : {false, true}) add_outlines(spec, hidden, solids, type);
  type.radius = solids_radius(spec);
  for (std::uint32_t p = 0; p < spec.parts.size(); ++p) {
    if (spec.parts[p].returns.fiducial == 0) continue;
    type.targets.push_back(p);
    type.radius = std::max(type.radius, sqrt(spec.parts[p].pose_body_part.position().squaredNorm()));
  }
  type.pushable = std::ranges::any_of(spec.parts, [](const PartSpec& part) { return part.returns.pushable; });
  if (!is_mobile(spec) && spec.devices.empty() && spec.controllers.empty() && !can_be_gripped(spec) &&
      !type.pushable)
    return;  // the type belongs to the static scene: BodyType::runs()
  try {
    add_shapes(spec, type);
  } catch (const std::length_error& error) {
    diagnostics.error(spec.parts.front().where,
                      fmt::format("a body of type \"{}\": {}", spec.name, error.what()));
  }
}

/// Names of the device kinds that supply power.
std::vector<std::string_view> supply_names(const Registry& registry) {
  std::vector<std::string_view> names;
  for (const DeviceKind& kind : registry.devices)
    if (kind.is_spent) names.push_back(kind.name);
  return names;
}

/// Assigns each device its power supply: the supply on its part or, if there is none, on the nearest part
/// that carries its part. The drive gets the supply of the root part.
void connect_supplies(const TypeSpec& spec, const Registry& registry, BodyType& type,
                      Diagnostics& diagnostics) {
  std::vector<std::optional<std::size_t>> supplies(spec.parts.size());  // by part
  for (std::size_t d = 0; d < type.devices.size(); ++d) {
    const BodyType::Device& device = type.devices[d];
    if (!device.kind->is_spent) continue;
    if (supplies[device.part])
      diagnostics.error(
          spec.parts[device.part].where,
          fmt::format(
              "the power supplies \"{}\" and \"{}\" are on the same part: move one of them to another part",
              type.devices[*supplies[device.part]].name, device.name));
    supplies[device.part] = d;
  }
  for (std::size_t p = 1; p < spec.parts.size(); ++p)  // parents come before their children
    if (!supplies[p]) supplies[p] = supplies[spec.parts[p].parent];
  for (BodyType::Device& device : type.devices) {
    if (!device.kind->is_spent) device.supply = supplies[device.part];
    if (device.kind->needs_supply && !device.supply)
      diagnostics.error(
          spec.parts[device.part].where,
          fmt::format(
              "device \"{}\" ({}) has no power supply: add a {} to the part of the device, or to a part that "
              "carries that part",
              device.name, device.kind->name, joined(supply_names(registry), " or a ")));
  }
  if (type.drive) type.drive->supply = supplies.front();
}

/// Index of the drive device (DeviceKind::drives) that controllers of a part command: the drive device on the
/// part itself or, if there is none, on the nearest part that carries the part. If the result is
/// std::nullopt, the controllers command the body's drive.
std::optional<std::size_t> drive_of(const TypeSpec& spec, const BodyType& type, std::uint32_t part) {
  for (;; part = spec.parts[part].parent) {
    for (std::size_t d = 0; d < type.devices.size(); ++d)
      if (type.devices[d].kind->drives && type.devices[d].part == part) return d;
    if (part == 0) return {};
  }
}

/// Compiles one type, see make_body_type(). Every error goes to the diagnostics, and the rest of the type is
/// still compiled, so that one run reports all of them.
class TypeCompiler {
 public:
  TypeCompiler(const TypeSpec& spec, const WorldSpec& world, const Registry& registry,
               Diagnostics& diagnostics)
      : spec_(spec), world_(world), registry_(registry), diagnostics_(diagnostics) {}

  BodyType compile() {
    type_.name = spec_.name;
    add_geometry(spec_, type_, diagnostics_);
    add_joints();
    if (spec_.drive) {
      check_thickness();
      add_drive(*spec_.drive);
    }
    for (const DeviceSpec& device : spec_.devices) add_device(device);
    check_joint_reach();
    connect_supplies(spec_, registry_, type_, diagnostics_);
    claimed_.assign(type_.devices.size(), false);
    for (std::size_t c = 0; c < spec_.controllers.size(); ++c) add_controller(c);
    return std::move(type_);
  }

 private:
  void add_joints() {
    for (const JointSpec& joint : spec_.joints) {
      const Mount at_rest(joint.pose_body_joint);
      type_.joints.push_back({joint.name, joint.parent, at_rest, inverse(at_rest)});
    }
  }

  void check_thickness() {
    if (!type_.obstacle.empty() && type_.obstacle.thinnest < k_thin_m)
      diagnostics_.warning(
          where(),
          fmt::format("a part of type \"{}\" is only {:.3g} m thick: each motion is tested in steps of a "
                      "quarter of this thickness, which is slow; make the part at least {} m thick",
                      spec_.name, type_.obstacle.thinnest, k_thin_m));
  }

  void add_drive(const DriveSpec& drive) {
    const DriveKind* kind = registry_.drive(drive.kind);
    if (!kind) {
      diagnostics_.error(drive.where, unknown_name("drive", drive.kind, name_list(registry_.drives)));
      return;
    }
    const auto report = [&](const Result<>& checked) {
      if (!checked)
        diagnostics_.error(drive.where, fmt::format("drive \"{}\": {}", drive.kind, checked.error().text));
    };
    type_.drive = {kind, {}, period_ticks(drive.period_s, world_.tick_s), {}};
    try {
      report(kind->check(drive.params));
      type_.drive->data = kind->prepare(drive.params);
      if (kind->localization) {
        if (const Result<Localization> how = kind->localization(drive.params))
          type_.drive->localization = *how;
        else
          report(how.error());
      }
      if (kind->pushes)
        type_.drive->pushes =
            static_cast<std::uint8_t>(std::clamp<std::int64_t>(kind->pushes(drive.params), 0, k_most_pushed));
      if (kind->turns_when_blocked) type_.drive->turns_when_blocked = kind->turns_when_blocked(drive.params);
    } catch (...) {
      diagnostics_.error(drive.where, fmt::format("drive \"{}\" {}", drive.kind, thrown_text()));
    }
    if (type_.pushable)
      diagnostics_.error(
          drive.where,
          fmt::format("type \"{}\" has a drive and is pushable, but robots push only bodies without a drive: "
                      "remove the drive or \"pushable\"",
                      spec_.name));
  }

  void add_device(const DeviceSpec& device) {
    const DeviceKind* kind = registry_.device(device.kind);
    if (!kind) {
      diagnostics_.error(device.where, unknown_name("sensor", device.kind, name_list(registry_.devices)));
      return;
    }
    if (const double samples = samples_asked_for(kind->params, device.params); samples > k_most_readings) {
      diagnostics_.error(
          device.where, fmt::format("too large: sensor \"{}\" has {:.0f} samples, at most {:.0f} are allowed",
                                    device.name, samples, k_most_readings));
      return;
    }
    if (!has_joints_of(device, *kind)) {
      diagnostics_.error(
          device.where,
          fmt::format("device \"{}\" of kind \"{}\" needs a joint that type \"{}\" does not have: add the "
                      "device with engine::add_device(), which also adds its joints",
                      device.name, device.kind, spec_.name));
      return;
    }
    const std::string name = unique_name(device);
    Result<DeviceKind::Prepared> prepared = prepare_device(*kind, device, world_, spec_);
    if (!prepared) {
      diagnostics_.error(device.where, fmt::format("device \"{}\" {}", device.name, prepared.error().text));
      return;
    }
    type_.devices.push_back({name,
                             kind,
                             *std::move(prepared),
                             period_ticks(device.period_s, world_.tick_s),
                             device.active,
                             device.part,
                             device.joint,
                             device.moves,
                             stream_id(kind->name, name),
                             {}});
    type_.carries = type_.carries || kind->carries;
    type_.joint_reach += type_.devices.back().prepared.joint_reach_m;
    if (moves_joints(device, *kind)) type_.joint_devices.push_back(type_.devices.size() - 1);
    if (type_.devices.back().prepared.feels_collisions && kind->collide != nullptr)
      type_.collision_devices.push_back(type_.devices.size() - 1);
  }

  static bool moves_joints(const DeviceSpec& device, const DeviceKind& kind) {
    return !kind.joints.empty() && device.moves != k_rigid;
  }

  /// Whether the type has all joints that a device moves.
  bool has_joints_of(const DeviceSpec& device, const DeviceKind& kind) const {
    const auto known = static_cast<std::int64_t>(spec_.joints.size());
    const auto moved = static_cast<std::int64_t>(kind.joints.size());
    return moves_joints(device, kind) ? device.moves + moved <= known : moved == 0;
  }

  /// Returns the name of a device, or a new name with a warning if a device before it has that name: readings
  /// are looked up and hashed by the name of the device.
  std::string unique_name(const DeviceSpec& device) {
    std::string name = device_names_.add(device.name);
    if (name != device.name)
      diagnostics_.warning(
          device.where,
          fmt::format("the type already has a sensor or device \"{}\": this one is renamed \"{}\"",
                      device.name, name));
    return name;
  }

  void check_joint_reach() {
    // Limit of joint_reach, m. The cells of the spatial index and the searches about moving joints grow with
    // it, so that each search would visit nearly all bodies.
    constexpr double k_most_reach = 1000;
    if (type_.joint_reach <= k_most_reach) return;  // false for NaN, which is an error
    diagnostics_.error(
        where(),
        fmt::format("too large: the joints of type \"{}\" can move by {:g} m in total, at most {:g} m are "
                    "allowed",
                    spec_.name, type_.joint_reach, k_most_reach));
  }

  /// Compiles the controller with the index `c` in the type.
  void add_controller(std::size_t c) {
    const ControllerSpec& controller = spec_.controllers[c];
    const ControllerKind* kind = registry_.controller(controller.kind);
    if (!kind) {
      diagnostics_.error(controller.where,
                         unknown_name("controller", controller.kind, name_list(registry_.controllers)));
      return;
    }
    const std::optional<std::size_t> drive = drive_of(spec_, type_, controller.part);
    if (kind->needs_drive && !type_.drive && !drive) {
      diagnostics_.error(controller.where,
                         fmt::format("controller \"{}\" needs a drive, but type \"{}\" has none: add a "
                                     "drive to the type",
                                     controller.kind, spec_.name));
      return;
    }
    Result<ControllerKind::Prepared> prepared =
        prepare_controller(*kind, controller, world_, spec_, type_, claimed_);
    if (!prepared) {
      // A controller may lack a device only because this device has an error, which is already reported.
      if (type_.devices.size() == spec_.devices.size())
        diagnostics_.error(controller.where,
                           fmt::format("controller \"{}\" {}", controller.kind, prepared.error().text));
      return;
    }
    if (prepared->devices.size() > k_most_devices_read) {
      diagnostics_.error(
          controller.where,
          fmt::format("controller \"{}\" uses {} sensors and other devices; at most {} are allowed",
                      controller.kind, prepared->devices.size(), k_most_devices_read));
      return;
    }
    for (const std::size_t d : prepared->devices) {
      type_.devices[d].active = true;
      if (kind->switches && d < 32) type_.devices[d].switch_bit = std::uint32_t{1} << d;
    }
    const std::uint64_t period = period_of(controller, prepared->devices);
    type_.controllers.push_back({kind, std::move(prepared->data), std::move(prepared->devices), period,
                                 stream_id(kind->name, std::to_string(c)), std::nullopt, drive});
  }

  /// Ticks from one decision of a controller to the next: the period of the first of its `devices`. If there
  /// are none, it is the period of the drive; without a drive, it is ControllerSpec::period_s.
  std::uint64_t period_of(const ControllerSpec& controller, const std::vector<std::size_t>& devices) const {
    if (!devices.empty()) return type_.devices[devices.front()].period;
    if (type_.drive) return type_.drive->period;
    return period_ticks(controller.period_s, world_.tick_s);
  }

  /// The file position of findings that concern the type as a whole.
  Where where() const { return spec_.parts.front().where; }

  const TypeSpec& spec_;
  const WorldSpec& world_;
  const Registry& registry_;
  Diagnostics& diagnostics_;
  BodyType type_;
  UniqueNames device_names_{k_device_mark};  ///< of all devices of type_
  std::vector<bool> claimed_;                ///< by device: a controller has reserved it for itself
};

}  // namespace

double BodyType::row_bytes() const {
  double sum = static_cast<double>(outline_vertices.size() * sizeof(Vec2) + joints.size() * sizeof(Pose));
  for (const Device& device : devices) {
    for (const StateField& field : device.prepared.percepts) sum += static_cast<double>(field.bytes());
    sum += static_cast<double>(device.prepared.command_bytes);
  }
  for (const Controller& controller : controllers) sum += static_cast<double>(controller.kind->memory_bytes);
  return sum;
}

double samples_asked_for(const FieldTable& table, const Record& params) {
  double sum = 0;
  for (std::size_t f = 0; f < table.fields.size() && f < params.size(); ++f) {
    const Field& field = table.fields[f];
    if (field.counts_readings && params[f].given()) sum += static_cast<double>(params[f].integer());
    if (field.type == FieldType::records && field.record && params[f].given())
      for (const Record& record : params[f].records()) sum += samples_asked_for(*field.record, record);
  }
  return sum;
}

Result<DeviceKind::Prepared> prepare_device(const DeviceKind& kind, const DeviceSpec& device,
                                            const WorldSpec& world, const TypeSpec& spec) try {
  DeviceKind::Prepared prepared = kind.prepare(device.params, device.pose_body_device);
  if (kind.bind_part)
    if (const Result<> bound = kind.bind_part(prepared.data, spec, device.part); !bound) return bound.error();
  if (kind.bind_world)
    if (const Result<> bound = kind.bind_world(prepared.data, world); !bound) return bound.error();
  if (kind.reach_m) prepared.reach_m = kind.reach_m(prepared.data);
  if (const Result<> fits = check_prepared(kind, prepared); !fits)
    return Error{fmt::format("({}) {}", kind.name, fits.error().text)};
  return prepared;
} catch (...) {
  return Error{fmt::format("({}) {}", kind.name, thrown_text())};
}

Result<ControllerKind::Prepared> prepare_controller(const ControllerKind& kind,
                                                    const ControllerSpec& controller, const WorldSpec& world,
                                                    const TypeSpec& spec, const BodyType& type,
                                                    std::vector<bool>& claimed) try {
  std::vector<std::size_t> shown;
  for (std::size_t s = 0; s < type.devices.size(); ++s)
    if (is_below(spec, type.devices[s].part, controller.part) && !type.devices[s].kind->drives)
      shown.push_back(s);
  std::vector<DeviceInfo> infos;
  std::vector<bool> claimed_shown;
  const std::optional<std::size_t> drive = drive_of(spec, type, controller.part);
  const Mount pose_drive_body = drive ? inverse(Mount(spec.devices[*drive].pose_body_device)) : Mount();
  for (const std::size_t s : shown) {
    const BodyType::Device& sensor = type.devices[s];
    infos.push_back({sensor.name, sensor.kind->name, sensor.prepared,
                     compose(pose_drive_body, spec.devices[s].pose_body_device)});
    claimed_shown.push_back(claimed[s]);
  }
  Result<ControllerKind::Prepared> prepared = kind.prepare(controller.params, infos, claimed_shown);
  if (claimed_shown.size() != shown.size())  // a bug in the kind
    return Error{
        fmt::format("changed the length of the list of reserved devices (`claimed`) from {} to {}: its code "
                    "must only set elements of the list",
                    shown.size(), claimed_shown.size())};
  for (std::size_t i = 0; i < shown.size(); ++i) claimed[shown[i]] = claimed_shown[i];
  if (!prepared) return prepared;
  // Not before `prepare`: ControllerCheck leaves junk on the stack for this call.
  if (const Result<> fits = check_memory(kind); !fits) return fits.error();
  for (std::size_t& s : prepared->devices) {
    if (s >= shown.size())  // a bug in the kind
      return Error{fmt::format(
          "chose the device with index {} (counted from 0), but was given only {} devices: correct "
          "the code of the controller",
          s, shown.size())};
    s = shown[s];
  }
  if (kind.bind_world)
    if (const Result<> bound = kind.bind_world(prepared->data, world, spec, controller.part); !bound)
      return bound.error();
  return prepared;
} catch (...) {
  return Error{thrown_text()};
}

BodyType make_body_type(const TypeSpec& spec, const WorldSpec& world, const Registry& registry,
                        Diagnostics& diagnostics) {
  return TypeCompiler(spec, world, registry, diagnostics).compile();
}

}  // namespace troupe::engine
