#include "worldio/stage/stage_round_trip.hpp"

#include "base/geometry.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/stage/stage_demos.hpp"
#include "worldio/stage/stage_power.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace troupe::worldio {
namespace {

using engine::DeviceSpec;
using engine::FieldTable;
using engine::PartSpec;
using engine::Record;
using engine::TypeSpec;
using engine::WorldSpec;

/// Largest difference of two coordinates, m, that counts as a rounding error. A larger difference is reported
/// as an error.
constexpr double k_rounding_m = 1e-9;

/// Returns the largest difference between corresponding coordinates of two lists of solids, m. Empty if the
/// lists do not have the same numbers of solids, contours and corners.
std::optional<double> distance(const std::vector<Solid>& a, const std::vector<Solid>& b) {
  if (a.size() != b.size()) return std::nullopt;
  double most = 0;
  for (std::size_t s = 0; s < a.size(); ++s) {
    most = std::max({most, std::abs(a[s].z.min - b[s].z.min), std::abs(a[s].z.max - b[s].z.max)});
    if (a[s].contours.size() != b[s].contours.size()) return std::nullopt;
    for (std::size_t c = 0; c < a[s].contours.size(); ++c) {
      const Ring& p = a[s].contours[c];
      const Ring& q = b[s].contours[c];
      if (p.size() != q.size()) return std::nullopt;
      for (std::size_t i = 0; i < p.size(); ++i)
        most = std::max({most, std::abs(p[i].x() - q[i].x()), std::abs(p[i].y() - q[i].y())});
    }
  }
  return most;
}

/// Returns solids whose contours are all counter-clockwise. This is the order of the corners of Stage's
/// blocks.
std::vector<Solid> counter_clockwise(std::vector<Solid> solids) {
  for (Solid& solid : solids)
    for (Ring& ring : solid.contours)
      if (signed_area(ring) < 0) std::ranges::reverse(ring);
  return solids;
}

/// Returns the name of a joint; empty for k_rigid.
std::string joint_name(const TypeSpec& type, std::int32_t joint) {
  return joint == engine::k_rigid ? std::string() : type.joints[static_cast<std::size_t>(joint)].name;
}

/// Returns the names of the devices of a part and of the parts mounted on it, sorted.
std::vector<std::string> devices_below(const TypeSpec& type, std::uint32_t part) {
  std::vector<std::string> names;
  for (const DeviceSpec& device : type.devices)
    if (engine::is_below(type, device.part, part)) names.push_back(device.name);
  std::ranges::sort(names);
  return names;
}

/// Returns, for each device or part of `list`, the one of the same name in `others`, or null if there is
/// none. If several have one name, the k-th of them in `list` gets the k-th of them in `others`.
template <class Named>
std::vector<const Named*> counterparts(const std::vector<Named>& list, const std::vector<Named>& others) {
  std::unordered_map<std::string_view, std::vector<const Named*>> named;
  for (const Named& other : others) named[other.name].push_back(&other);
  std::unordered_map<std::string_view, std::size_t> count;
  std::vector<const Named*> found;
  for (const Named& one : list) {
    const std::size_t k = count[one.name]++;
    found.push_back(k < named[one.name].size() ? named[one.name][k] : nullptr);
  }
  return found;
}

/// Whether two values of a field are numbers that differ only by rounding.
bool is_rounded(const engine::Value& a, const engine::Value& b, const engine::Field& field) {
  constexpr double k_rounding = 1e-12;
  if (field.type != engine::FieldType::number || !a.given() || !b.given()) return false;
  const double largest = std::max(std::abs(a.number()), std::abs(b.number()));
  return std::abs(a.number() - b.number()) <= k_rounding * largest;
}

class RoundTrip {
 public:
  RoundTrip(const TypeSpec& type, const TypeSpec& back, const engine::Registry& registry,
            Diagnostics& diagnostics)
      : type_(type), back_(back), registry_(registry), diagnostics_(diagnostics) {}

  void check() {
    check_drive();
    check_devices();
    check_controllers();
    check_joints();
    check_reach();
    check_aliases();
    check_bodies();
  }

 private:
  /// Reports that a `.world` file cannot express `what`, a property of the type. Reports each text only once.
  void lacks(Where where, const std::string& what) {
    if (!reported_.insert(what).second) return;
    diagnostics_.error(where,
                       fmt::format("a .world file cannot express this: type \"{}\": {}", type_.name, what));
  }
  /// Warns of a small difference from the original world. Reports each text only once.
  void warn(Where where, const std::string& what) {
    const std::string text = fmt::format("type \"{}\": {}", type_.name, what);
    if (reported_.insert(text).second) diagnostics_.warning(where, text);
  }
  /// Warns that a value of the type changes slightly, by the conversion between units or frames.
  void warn_rounded(Where where, const std::string& what) {
    warn(where, what + " is rounded; the state hashes of a run may differ from those of the original world");
  }
  /// Whether two headings, rad, differ by whole turns only, which Stage removes. If so, reports a warning.
  bool is_turned(Where where, const std::string& owner, double a, double b) {
    if (same_bits(a, b) || !same_bits(wrap_angle(a), b)) return false;
    warn(where, owner +
                    ": its heading is wrapped into [-pi, pi], as in Stage; the state hashes of a run may "
                    "differ from those of the original world");
    return true;
  }
  void check_params(Where where, std::string_view owner, const Record& a, const Record& b,
                    const FieldTable& table);
  void check_drive();
  void check_devices();
  void check_device(const DeviceSpec& a, const DeviceSpec& b);
  void check_controllers();
  void check_joints();
  void check_reach();
  void check_aliases();
  void check_bodies();
  void check_part(const PartSpec& a, const PartSpec& b);
  void check_outline(const PartSpec& a, const PartSpec& b, const std::string& owner);
  void check_floor_plan(const PartSpec& part, const std::string& owner);
  void check_pose(Where where, const std::string& owner, Pose a, const Pose& b);
  void check_size(const PartSpec& a, const PartSpec& b, const std::string& owner);

  const TypeSpec& type_;
  const TypeSpec& back_;
  const engine::Registry& registry_;
  Diagnostics& diagnostics_;
  std::set<std::string> reported_;
};

void RoundTrip::check_params(Where where, std::string_view owner, const Record& a, const Record& b,
                             const FieldTable& table) {
  for (std::size_t i = 0; i < table.fields.size() && i < a.size() && i < b.size(); ++i) {
    const engine::Field& field = table.fields[i];
    if (same_bits(a[i], b[i])) continue;
    const bool is_block = field.type == engine::FieldType::record || field.type == engine::FieldType::records;
    if (is_block && a[i].given() && b[i].given() && a[i].records().size() == b[i].records().size())
      for (std::size_t k = 0; k < a[i].records().size(); ++k)
        check_params(where, fmt::format("{} {}", owner, field.name), a[i].records()[k], b[i].records()[k],
                     *field.record);
    else if (is_rounded(a[i], b[i], field))
      warn_rounded(where, fmt::format("{}: the value of {}", owner, quoted_keys(field)));
    else
      lacks(where, fmt::format("{}: the value of {}", owner, quoted_keys(field)));
  }
}

void RoundTrip::check_drive() {
  const Where where = type_.drive ? type_.drive->where : type_.parts.front().where;
  if (type_.drive.has_value() != back_.drive.has_value() ||
      (type_.drive && type_.drive->kind != back_.drive->kind))
    return lacks(where, type_.drive ? fmt::format("its drive \"{}\"", type_.drive->kind)
                                    : "the lack of a drive; in Stage, every model of type position has one");
  if (!type_.drive) return;
  const std::string owner = fmt::format("drive \"{}\"", type_.drive->kind);
  if (!same_bits(type_.drive->period_s, back_.drive->period_s)) lacks(where, owner + ": its period");
  if (const engine::DriveKind* kind = registry_.drive(type_.drive->kind))
    check_params(where, owner, type_.drive->params, back_.drive->params, kind->params);
}

void RoundTrip::check_devices() {
  const std::vector<const DeviceSpec*> others = counterparts(type_.devices, back_.devices);
  for (std::size_t d = 0; d < others.size(); ++d) {
    const DeviceSpec& device = type_.devices[d];
    if (!others[d] || others[d]->kind != device.kind)
      lacks(device.where,
            fmt::format("its device \"{}\" of kind {}: Stage has no such device, or gives it another name",
                        device.name, device.kind));
    else
      check_device(device, *others[d]);
  }
  const std::vector<const DeviceSpec*> originals = counterparts(back_.devices, type_.devices);
  for (std::size_t d = 0; d < originals.size(); ++d)
    if (!originals[d])
      lacks(type_.parts.front().where,
            fmt::format("it has no device \"{}\" of kind {}, but in the written file it would have this "
                        "device",
                        back_.devices[d].name, back_.devices[d].kind));
  // The order of devices of one kind matters, because controllers choose among them in this order.
  for (const engine::DeviceKind& kind : registry_.devices) {
    const auto names = [&](const TypeSpec& type) {
      std::vector<std::string> list;
      for (const DeviceSpec& device : type.devices)
        if (device.kind == kind.name) list.push_back(device.name);
      return list;
    };
    std::vector<std::string> a = names(type_);
    std::vector<std::string> b = names(back_);
    const bool is_other_order = a != b;
    std::ranges::sort(a);
    std::ranges::sort(b);
    if (is_other_order && a == b)
      lacks(type_.parts.front().where, fmt::format("the order of its devices of kind {}", kind.name));
  }
}

void RoundTrip::check_device(const DeviceSpec& a, const DeviceSpec& b) {
  const std::string owner = fmt::format("device \"{}\"", a.name);
  const bool is_placeless = a.kind == "power_pack" || a.kind == "flags";  // pose and joint have no effect
  if (const engine::DeviceKind* kind = registry_.device(a.kind))
    check_params(a.where, owner, effective_params(type_, a, kind->params),
                 effective_params(back_, b, kind->params), kind->params);
  if (!is_placeless) check_pose(a.where, owner, a.pose_body_device, b.pose_body_device);
  if (!same_bits(a.period_s, b.period_s)) lacks(a.where, owner + ": its \"period_s\"");
  if (a.active != b.active) lacks(a.where, owner + ": its \"active\"");
  if (!is_placeless && joint_name(type_, a.joint) != joint_name(back_, b.joint))
    lacks(a.where, owner + ": the joint that it is mounted on");
}

void RoundTrip::check_controllers() {
  const Where whole = type_.parts.front().where;
  if (type_.controllers.size() != back_.controllers.size())
    return lacks(whole, "the number of its controllers");
  for (std::size_t i = 0; i < type_.controllers.size(); ++i) {
    const engine::ControllerSpec& a = type_.controllers[i];
    const engine::ControllerSpec& b = back_.controllers[i];
    const std::string owner = fmt::format("controller \"{}\"", a.kind);
    if (a.kind != b.kind) return lacks(a.where, owner + ": its place in the order of controllers");
    const engine::ControllerKind* kind = registry_.controller(a.kind);
    if (!kind) continue;
    check_params(a.where, owner, a.params, b.params, kind->params);
    // The period of a controller has an effect only without a drive: with a drive, the controller runs when
    // the drive does.
    if (!type_.drive && !same_bits(a.period_s, b.period_s)) lacks(a.where, owner + ": its \"period_s\"");
  }
}

void RoundTrip::check_joints() {
  bool is_same = type_.joints.size() == back_.joints.size();
  for (std::size_t j = 0; is_same && j < type_.joints.size(); ++j)
    is_same = type_.joints[j].name == back_.joints[j].name &&
              same_bits(type_.joints[j].pose_body_joint, back_.joints[j].pose_body_joint);
  if (!is_same) lacks(type_.parts.front().where, "the number, the names or the poses of its joints");
}

/// Compares the devices that a controller can use, and those that a power pack supplies. A part that the
/// joint of another part moves is written inside that other part, which can change these devices. The devices
/// of each pair of parts are compared only once.
void RoundTrip::check_reach() {
  std::map<std::pair<std::uint32_t, std::uint32_t>, bool> known;  // a part may have thousands of controllers
  const auto differ_below = [&](std::uint32_t part, std::uint32_t part_back) {
    const auto [differ, is_new] = known.try_emplace({part, part_back});
    if (is_new) differ->second = devices_below(type_, part) != devices_below(back_, part_back);
    return differ->second;
  };
  for (std::size_t i = 0; i < std::min(type_.controllers.size(), back_.controllers.size()); ++i) {
    const engine::ControllerSpec& a = type_.controllers[i];
    if (differ_below(a.part, back_.controllers[i].part))
      lacks(a.where, fmt::format("controller \"{}\": the devices that it can use", a.kind));
  }
  const std::vector<const DeviceSpec*> others = counterparts(type_.devices, back_.devices);
  for (std::size_t d = 0; d < others.size(); ++d) {
    const DeviceSpec& a = type_.devices[d];
    if (a.kind == "power_pack" && others[d] && differ_below(a.part, others[d]->part))
      lacks(a.where, fmt::format("device \"{}\": the devices that it supplies", a.name));
  }
}

void RoundTrip::check_aliases() {
  const std::vector<const PartSpec*> same_name = counterparts(type_.parts, back_.parts);
  for (std::size_t p = 0; p < same_name.size(); ++p) {
    const PartSpec& part = type_.parts[p];
    if (!part.alias.empty() && (!same_name[p] || same_name[p]->alias != part.alias))
      lacks(part.where, fmt::format("part \"{}\": its alias \"{}\"", part.name, part.alias));
  }
}

void RoundTrip::check_bodies() {
  const auto solid_parts = [](const TypeSpec& type) {
    std::vector<const PartSpec*> parts;
    for (const PartSpec& part : type.parts)
      if (!part.solids.empty()) parts.push_back(&part);
    return parts;
  };
  const std::vector<const PartSpec*> parts = solid_parts(type_);
  const std::vector<const PartSpec*> others = solid_parts(back_);
  if (parts.size() != others.size()) {
    for (const engine::ControllerSpec& controller : type_.controllers)
      if (stage_addition(controller.kind))
        return lacks(
            controller.where,
            fmt::format("controller \"{}\": the random parts that it has added to its model; with the seed "
                        "of this world, it would add other parts when the written file is read",
                        controller.kind));
    return lacks(
        type_.parts.front().where,
        fmt::format(
            "its number of parts with solids, which is {}: in the written file, the number would differ",
            parts.size()));
  }
  for (std::size_t p = 0; p < parts.size(); ++p) check_part(*parts[p], *others[p]);
}

void RoundTrip::check_part(const PartSpec& a, const PartSpec& b) {
  const std::string owner = a.name.empty() ? std::string("its body") : fmt::format("part \"{}\"", a.name);
  engine::Returns returns = b.returns;  // each body has its own fiducial number
  if (&a == &type_.parts.front() && a.returns.fiducial != 0 && returns.fiducial != 0)
    returns.fiducial = a.returns.fiducial;
  if (a.returns != returns)
    lacks(a.where, owner +
                       ": the value of its \"obstacle\", \"fiducial_key\", \"ranger_return\", "
                       "\"fiducial_return\", \"gripper_return\" or \"blob_return\"");
  check_size(a, b, owner);
  check_pose(a.where, owner, a.pose_body_part, b.pose_body_part);
  if (joint_name(type_, a.joint) != joint_name(back_, b.joint))
    lacks(a.where, owner + ": the joint that it is mounted on");
  if (a.floor_plan != b.floor_plan) check_floor_plan(a, owner);
  if (a.color && a.color != b.color) lacks(a.where, owner + ": its \"color\"");
  check_outline(a, b, owner);
}

void RoundTrip::check_outline(const PartSpec& a, const PartSpec& b, const std::string& owner) {
  std::optional<double> off = distance(a.solids, b.solids);
  if (!off || *off > k_rounding_m) {
    off = distance(counter_clockwise(a.solids), b.solids);
    if (!off || *off > k_rounding_m)
      return lacks(a.where, owner + ": its outline (Stage's blocks have no holes)");
    warn(a.where, owner +
                      ": the corners of its outline are written counter-clockwise, as in Stage; the state "
                      "hashes of a run may differ from those of the original world");
  }
  if (*off > 0)
    diagnostics_.warning(a.where,
                         fmt::format("type \"{}\": {}: its outline is rounded by at most {:.2g} m, because "
                                     "Stage moves the centre of an outline to the origin of its body; the "
                                     "state hashes of a run may differ from those of the original world",
                                     type_.name, owner, *off));
}

/// Compares the sizes of parts. They affect a run: fiducial finders report the size of their targets, and
/// foragers read the size of a zone.
void RoundTrip::check_size(const PartSpec& a, const PartSpec& b, const std::string& owner) {
  if (a.size == b.size) return;
  if ((a.size - b.size).cwiseAbs().maxCoeff() > k_rounding_m)
    lacks(a.where,
          fmt::format("{}: an extent of {:g} x {:g} x {:g} m around an outline of {:g} x {:g} x {:g} m",
                      owner, a.size.x(), a.size.y(), a.size.z(), b.size.x(), b.size.y(), b.size.z()));
  else
    warn_rounded(a.where, owner + ": its extent");
}

/// Reports that a part is no floor plan any more. Without an image, this changes only what `troupe lint`
/// checks.
void RoundTrip::check_floor_plan(const PartSpec& part, const std::string& owner) {
  if (part.image) return lacks(part.where, owner + ": its \"floor_plan\"");
  warn(part.where, owner +
                       ": its \"floor_plan\" is not written: `troupe lint` will not check that it blocks "
                       "robots, but runs are the same");
}

void RoundTrip::check_pose(Where where, const std::string& owner, Pose a, const Pose& b) {
  if (is_turned(where, owner, a.heading, b.heading)) a.heading = b.heading;
  if (same_bits(a, b)) return;
  const double off = std::max(
      {std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z), std::abs(a.heading - b.heading)});
  if (off > k_rounding_m) return lacks(where, owner + ": its \"pose\"");
  warn_rounded(where, owner + ": its pose");
}

/// Reports the aliases (second names) of bodies, and the global names of parts, that a `.world` file cannot
/// express. Stage generates aliases itself, and no property sets one.
void check_names(const WorldSpec& spec, const WorldSpec& back, Diagnostics& diagnostics) {
  std::unordered_map<std::string, BodyId> others;
  for (const engine::NamedBody& alias : back.aliases) others.emplace(back.names.text(alias.name), alias.body);
  const auto lacks = [&](BodyId body, const std::string& what, const std::string& name) {
    diagnostics.error(
        spec.bodies[body.index()].where,
        fmt::format("a .world file cannot express this: \"{}\": {} \"{}\"", spec.name(body), what, name));
  };
  for (const engine::NamedBody& alias : spec.aliases) {
    const std::string name = spec.names.text(alias.name);
    const auto found = others.find(name);
    if (found == others.end() || found->second != alias.body) lacks(alias.body, "its alias", name);
  }
  const std::map<std::string, engine::PartName> parts(spec.part_aliases.begin(), spec.part_aliases.end());
  for (const auto& [name, place] : parts) {
    const auto found = back.part_aliases.find(name);
    if (found == back.part_aliases.end() || found->second.body != place.body ||
        found->second.part != place.part)
      lacks(place.body, "its \"global_parts\" entry", name);
  }
}

}  // namespace

void check_stage_round_trip(const WorldSpec& spec, const WorldSpec& back, const engine::Registry& registry,
                            Diagnostics& diagnostics) {
  const Where whole{spec.resolution_where.file, 0};
  const auto lacks = [&](Where where, const std::string& what) {
    diagnostics.error(where, fmt::format("a .world file cannot express this: {}", what));
  };
  if (!same_bits(spec.tick_s, back.tick_s))
    lacks(whole,
          "\"tick_s\": Stage's clock counts whole microseconds, so the value must be a multiple of "
          "1e-6 s");
  if (spec.bodies.size() != back.bodies.size())
    return lacks(
        whole, fmt::format("the number of bodies, which is {}: in the written file, the number would differ",
                           spec.bodies.size()));
  check_names(spec, back, diagnostics);
  std::set<std::pair<std::uint32_t, std::uint32_t>> types;
  for (std::size_t b = 1; b < spec.bodies.size(); ++b) {
    const engine::BodySpec& body = spec.bodies[b];
    const engine::BodySpec& other = back.bodies[b];
    const std::string name = spec.names.text(body.name);
    if (name != back.names.text(other.name)) lacks(body.where, fmt::format("the name \"{}\"", name));
    if (!same_bits(body.pose_world_body, other.pose_world_body))
      lacks(body.where, fmt::format("\"{}\": its exact \"pose\"; the last bits would change", name));
    if (body.color != other.color) lacks(body.where, fmt::format("\"{}\": its color", name));
    if (fiducial_of(spec, BodyId(b), 0) != fiducial_of(back, BodyId(b), 0))
      lacks(body.where, fmt::format("\"{}\": its \"fiducial_return\"", name));
    if (!types.emplace(body.type.value, other.type.value).second) continue;
    const TypeSpec& type = spec.types[body.type.index()];
    const TypeSpec& other_type = back.types[other.type.index()];
    if (type.name != other_type.name)
      diagnostics.warning(body.where,
                          fmt::format("type \"{}\" is called \"{}\" when the written file is read", type.name,
                                      other_type.name));
    RoundTrip(type, other_type, registry, diagnostics).check();
  }
}

}  // namespace troupe::worldio
