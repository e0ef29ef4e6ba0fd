#include "worldio/json/spec_difference.hpp"

#include "worldio/json/fields_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

// Every struct is taken apart by a structured binding, so that a field that is added to one does not compile
// here until it is compared.

namespace troupe::worldio {
namespace {

using engine::WorldSpec;

bool same(double a, double b) { return same_bits(a, b); }
bool same(const Pose& a, const Pose& b) {
  return same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z) && same(a.heading, b.heading);
}
bool same(const Vec2& a, const Vec2& b) { return same(a.x(), b.x()) && same(a.y(), b.y()); }
bool same(const engine::Record& a, const engine::Record& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const engine::Value& x, const engine::Value& y) { return same_bits(x, y); });
}
bool same(const Solid& a, const Solid& b) {
  const auto same_ring = [](const Ring& r, const Ring& s) {
    return std::equal(r.begin(), r.end(), s.begin(), s.end(),
                      [](const Vec2& p, const Vec2& q) { return same(p, q); });
  };
  return same(a.z.min, b.z.min) && same(a.z.max, b.z.max) &&
         std::equal(a.contours.begin(), a.contours.end(), b.contours.begin(), b.contours.end(), same_ring);
}

/// The first of several things that is not the same; empty where all are.
class Difference {
 public:
  explicit Difference(std::string of) : of_(std::move(of)) {}

  Difference& is(bool same, std::string_view what) {
    if (!same && text_.empty())
      text_ = of_.empty() ? std::string(what) : fmt::format("{}: its {}", of_, what);
    return *this;
  }
  /// What is inside says itself what it is.
  Difference& is(const std::string& inside) {
    if (!inside.empty() && text_.empty()) text_ = of_.empty() ? inside : fmt::format("{}, {}", of_, inside);
    return *this;
  }
  const std::string& text() const { return text_; }

 private:
  std::string of_;
  std::string text_;
};

template <class List, class Compare>
std::string first_of(const List& a, const List& b, std::string_view what, Compare compare) {
  if (a.size() != b.size()) return fmt::format("{} {}, and not {}", a.size(), what, b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    if (std::string text = compare(a[i], b[i]); !text.empty()) return text;
  return {};
}

std::string difference(const engine::PartSpec& a, const engine::PartSpec& b) {
  const auto& [name, alias, kind, parent, joint, pose, size, solids, returns, floor_plan, image, fitted,
               color, where] = a;
  static_cast<void>(image);  // what they make is here
  static_cast<void>(fitted);
  static_cast<void>(where);
  return Difference(fmt::format("part \"{}\"", name))
      .is(name == b.name, "name")
      .is(alias == b.alias, "alias")
      .is(kind == b.kind, "kind")
      .is(parent == b.parent, "place in the tree")
      .is(joint == b.joint, "joint")
      .is(same(pose, b.pose_body_part), "pose")
      .is(same(size.x(), b.size.x()) && same(size.y(), b.size.y()) && same(size.z(), b.size.z()), "size")
      .is(std::equal(solids.begin(), solids.end(), b.solids.begin(), b.solids.end(),
                     [](const Solid& s, const Solid& t) { return same(s, t); }),
          "solids")
      .is(returns == b.returns, "returns")
      .is(floor_plan == b.floor_plan, "being a floor plan")
      .is(color == b.color, "color")
      .text();
}

std::string difference(const engine::JointSpec& a, const engine::JointSpec& b) {
  const auto& [name, parent, pose] = a;
  return Difference(fmt::format("joint \"{}\"", name))
      .is(name == b.name, "name")
      .is(parent == b.parent, "place in the tree")
      .is(same(pose, b.pose_body_joint), "pose")
      .text();
}

std::string difference(const engine::DriveSpec& a, const engine::DriveSpec& b) {
  const auto& [kind, params, period_s, where] = a;
  static_cast<void>(where);
  return Difference(fmt::format("drive \"{}\"", kind))
      .is(kind == b.kind, "kind")
      .is(same(params, b.params), "parameters")
      .is(same(period_s, b.period_s), "period")
      .text();
}

std::string difference(const engine::DeviceSpec& a, const engine::DeviceSpec& b) {
  const auto& [name, kind, part, joint, moves, params, pose, period_s, active, where] = a;
  static_cast<void>(where);
  return Difference(fmt::format("device \"{}\"", name))
      .is(name == b.name, "name")
      .is(kind == b.kind, "kind")
      .is(part == b.part, "part")
      .is(joint == b.joint, "joint")
      .is(moves == b.moves, "own joints")
      .is(same(params, b.params), "parameters")
      .is(same(pose, b.pose_body_sensor), "pose")
      .is(same(period_s, b.period_s), "period")
      .is(active == b.active, "being active")
      .text();
}

std::string difference(const engine::ControllerSpec& a, const engine::ControllerSpec& b) {
  const auto& [kind, part, params, period_s, where] = a;
  static_cast<void>(where);
  return Difference(fmt::format("controller \"{}\"", kind))
      .is(kind == b.kind, "kind")
      .is(part == b.part, "part")
      .is(same(params, b.params), "parameters")
      .is(same(period_s, b.period_s), "period")
      .text();
}

std::string difference(const engine::TypeSpec& a, const engine::TypeSpec& b) {
  const auto& [name, parts, joints, drive, devices, controllers] = a;
  const auto compare = [](const auto& x, const auto& y) { return difference(x, y); };
  return Difference(fmt::format("type \"{}\"", name))
      .is(name == b.name, "name")
      .is(first_of(parts, b.parts, "parts", compare))
      .is(first_of(joints, b.joints, "joints", compare))
      .is(drive.has_value() == b.drive.has_value(), "drive")
      .is(drive && b.drive ? difference(*drive, *b.drive) : std::string())
      .is(first_of(devices, b.devices, "devices", compare))
      .is(first_of(controllers, b.controllers, "controllers", compare))
      .text();
}

std::string difference(const engine::MeasureSpec& a, const engine::MeasureSpec& b) {
  const auto& [kind, name, of, params, where] = a;
  static_cast<void>(where);
  return Difference(fmt::format("measure \"{}\"", kind))
      .is(kind == b.kind, "kind")
      .is(name == b.name, "name")
      .is(of == b.of, "robots")
      .is(same(params, b.params), "parameters")
      .text();
}

std::string difference(const engine::ReserveSpec& a, const engine::ReserveSpec& b) {
  const auto& [population, first, count] = a;
  return Difference(fmt::format("reserve of \"{}\"", population))
      .is(population == b.population, "population")
      .is(first == b.first && count == b.count, "bodies")
      .text();
}

bool same(const engine::GroupSpec& a, const engine::GroupSpec& b) {
  const auto& [by, name, count, share] = a;
  return by == b.by && name == b.name && count == b.count && share == b.share;
}

bool same(const std::optional<engine::SettingSpec>& a, const std::optional<engine::SettingSpec>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  const auto& [type, of, index, params] = *a;
  return type == b->type && of == b->of && index == b->index && same(params, b->params);
}

std::string difference(const engine::StopSpec& a, const engine::StopSpec& b) {
  const auto& [measure, comparison, value] = a;
  return Difference(fmt::format("\"{}\"", engine::text_of(a)))
      .is(difference(measure, b.measure))
      .is(comparison == b.comparison && same(value, b.value), "comparison")
      .text();
}

std::string difference(const engine::InterventionSpec& a, const engine::InterventionSpec& b) {
  const auto& [time_s, action, whom, pose, region, setting, where] = a;
  static_cast<void>(where);
  const bool same_pose = pose && b.pose ? same(*pose, *b.pose) : pose.has_value() == b.pose.has_value();
  const bool same_region = region && b.region
                               ? same(region->min, b.region->min) && same(region->max, b.region->max)
                               : region.has_value() == b.region.has_value();
  return Difference(fmt::format("what is done at {:g} s", time_s))
      .is(same(time_s, b.time_s), "time")
      .is(action == b.action, "action")
      .is(same(whom, b.whom), "bodies")
      .is(same_pose, "pose")
      .is(same_region, "region")
      .is(same(setting, b.setting), "parameters")
      .text();
}

std::string difference(const engine::FaultSpec& a, const engine::FaultSpec& b) {
  const auto& [whom, from_s, ailments, where] = a;
  static_cast<void>(where);
  const auto compare = [](const engine::FaultSpec::Ailment& x, const engine::FaultSpec::Ailment& y) {
    const auto& [kind, params] = x;
    return Difference(fmt::format("fault \"{}\"", kind))
        .is(kind == y.kind, "kind")
        .is(same(params, y.params), "parameters")
        .text();
  };
  return Difference("a fault")
      .is(same(whom, b.whom), "bodies")
      .is(same(from_s, b.from_s), "time")
      .is(first_of(ailments, b.ailments, "kinds of it", compare))
      .text();
}

std::string difference(const engine::ExperimentSpec& a, const engine::ExperimentSpec& b) {
  const auto& [stop_when, at, faults] = a;
  const auto compare = [](const auto& x, const auto& y) { return difference(x, y); };
  return Difference({})
      .is(first_of(stop_when, b.stop_when, "conditions", compare))
      .is(first_of(at, b.at, "interventions", compare))
      .is(first_of(faults, b.faults, "faults", compare))
      .text();
}

bool same(const std::optional<engine::RecordSpec>& a, const std::optional<engine::RecordSpec>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  const auto& [file, fields, every_s, where, where_fields] = *a;
  static_cast<void>(where);
  static_cast<void>(where_fields);
  return file == b->file && fields == b->fields && every_s == b->every_s;
}

std::string bodies_difference(const WorldSpec& a, const WorldSpec& b) {
  if (a.bodies.size() != b.bodies.size())
    return fmt::format("{} bodies, and not {}", a.bodies.size(), b.bodies.size());
  for (std::size_t i = 0; i < a.bodies.size(); ++i) {
    const auto& [name, type, pose, color, fiducial, where] = a.bodies[i];
    static_cast<void>(where);
    const engine::BodySpec& other = b.bodies[i];
    const std::string text = a.names.text(name);
    std::string found = Difference(fmt::format("body \"{}\"", text))
                            .is(text == b.names.text(other.name), "name")
                            .is(type == other.type, "type")
                            .is(same(pose, other.pose_world_body), "pose")
                            .is(color == other.color, "color")
                            .is(fiducial == other.fiducial, "number for fiducial finders")
                            .text();
    if (!found.empty()) return found;
  }
  return {};
}

bool same_names(const WorldSpec& a, const WorldSpec& b) {
  const auto same_alias = [&](const engine::NamedBody& x, const engine::NamedBody& y) {
    return x.body == y.body && a.names.text(x.name) == b.names.text(y.name);
  };
  return std::equal(a.aliases.begin(), a.aliases.end(), b.aliases.begin(), b.aliases.end(), same_alias);
}

bool same_part_names(const WorldSpec& a, const WorldSpec& b) {
  return a.part_aliases.size() == b.part_aliases.size() &&
         std::ranges::all_of(a.part_aliases, [&](const auto& entry) {
           const auto found = b.part_aliases.find(entry.first);
           return found != b.part_aliases.end() && found->second.body == entry.second.body &&
                  found->second.part == entry.second.part;
         });
}

}  // namespace

bool same_part(const engine::PartSpec& a, const engine::PartSpec& b) { return difference(a, b).empty(); }

std::string spec_difference(const WorldSpec& a, const WorldSpec& b) {
  const auto& [title, files, seed, tick_s, quit_time_s, record, ranging, resolution_m, resolution_where,
               bounds, types, names, bodies, reserves, mortal, aliases, part_aliases, measures,
               measure_every_s, watch, window, experiment] = a;
  static_cast<void>(files);
  static_cast<void>(resolution_where);
  static_cast<void>(names);
  static_cast<void>(bodies);
  static_cast<void>(aliases);
  static_cast<void>(part_aliases);
  const bool same_bounds = bounds && b.bounds
                               ? same(bounds->min, b.bounds->min) && same(bounds->max, b.bounds->max)
                               : bounds.has_value() == b.bounds.has_value();
  const bool same_window =
      window && b.window ? same(*window, *b.window) : window.has_value() == b.window.has_value();
  const auto compare = [](const auto& x, const auto& y) { return difference(x, y); };
  return Difference({})
      .is(title.empty() || title == b.title, "the title")
      .is(seed == b.seed, "the seed")
      .is(same(tick_s, b.tick_s), "the tick")
      .is(quit_time_s == b.quit_time_s, "the quit time")
      .is(same(record, b.record), "what is recorded")
      .is(ranging == b.ranging, "the ray engine")
      .is(same(resolution_m, b.resolution_m), "the resolution")
      .is(same_bounds, "the bounds")
      .is(first_of(types, b.types, "types", compare))
      .is(bodies_difference(a, b))
      .is(first_of(reserves, b.reserves, "reserves", compare))
      .is(mortal == b.mortal, "whether bodies may be removed")
      .is(same_names(a, b), "other names of bodies")
      .is(same_part_names(a, b), "names of parts")
      .is(first_of(measures, b.measures, "measures", compare))
      .is(same(measure_every_s, b.measure_every_s), "how often is measured")
      .is(watch == b.watch, "how it is watched")
      .is(same_window, "the window")
      .is(difference(experiment, b.experiment))
      .text();
}

}  // namespace troupe::worldio
