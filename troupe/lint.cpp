#include "troupe/lint.hpp"

#include "base/fp_environment.hpp"
#include "base/number_text.hpp"
#include "engine/interventions/groups.hpp"
#include "engine/observing/measures.hpp"
#include "engine/observing/stop_conditions.hpp"
#include "engine/sensing/shown_color.hpp"
#include "engine/spec/ticks.hpp"
#include "engine/world/world.hpp"
#include "models/controllers/always_turns.hpp"
#include "models/controllers/waypoints.hpp"
#include "models/devices/power.hpp"
#include "sensors/blobfinder.hpp"
#include "sensors/ground.hpp"
#include "sensors/light_sensor.hpp"
#include "sensors/light_source.hpp"
#include "sensors/radio.hpp"
#include "sensors/ranger.hpp"
#include "sensors/ranger_beams.hpp"
#include "troupe/plugins.hpp"
#include "troupe/registry.hpp"
#include "troupe/script.hpp"
#include "worldio/colors.hpp"
#include "worldio/load.hpp"
#include "worldio/results/recording_fields.hpp"
#include "worldio/window_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <any>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <string_view>
#include <tuple>
#include <utility>

namespace troupe {
namespace {

constexpr std::size_t k_most_listed = 100;  // limit for findings that may concern every robot
constexpr double k_scene_cell_m = 0.5;

constexpr ZInterval k_no_heights{std::numeric_limits<double>::infinity(),
                                 -std::numeric_limits<double>::infinity()};

ZInterval united(const ZInterval& a, const ZInterval& b) {
  return {std::min(a.min, b.min), std::max(a.max, b.max)};
}

/// Returns the name of a device for a warning: `ranger "eye" of "bot"`, or `ranger of "bot"` if the body
/// itself is the device.
std::string device_text(std::string_view what, std::string_view name, std::string_view type) {
  return name.empty() ? fmt::format("{} of \"{}\"", what, type)
                      : fmt::format("{} \"{}\" of \"{}\"", what, name, type);
}

/// Counts the solids at each height: at(z) returns the number of solids whose z interval, including both
/// ends, contains z.
class Heights {
 public:
  void add(const ZInterval& z, std::size_t count) {
    begins_[z.min] += count;
    ends_[z.max] += count;
    extent_ = united(extent_, z);
  }
  /// Sums the counts. Call it after the last add() and before the first at().
  void sum() {
    for (auto* list : {&begins_, &ends_}) {
      std::size_t sum = 0;
      for (auto& [z, count] : *list) count = sum += count;
    }
  }
  std::size_t at(double z) const {
    const auto begun = begins_.upper_bound(z);
    const auto ended = ends_.lower_bound(z);
    return (begun == begins_.begin() ? 0 : std::prev(begun)->second) -
           (ended == ends_.begin() ? 0 : std::prev(ended)->second);
  }
  bool empty() const { return begins_.empty(); }
  const ZInterval& extent() const { return extent_; }

 private:
  // Per height: the number of solids that begin or end there; after sum() also of those below.
  std::map<double, std::size_t> begins_;
  std::map<double, std::size_t> ends_;
  ZInterval extent_ = k_no_heights;
};

bool is_in(const ConvexPrism& piece, const Vec2& point) {
  for (std::size_t i = 0; i < piece.outline.size(); ++i) {
    const Vec2& a = piece.outline[i];
    const Vec2& b = piece.outline[(i + 1) % piece.outline.size()];
    if (cross(b - a, point - a) < 0) return false;
  }
  return true;
}

/// Whether all beams of a ranger end inside `body`, the outline of the robot that carries the ranger. Such
/// beams detect only bodies that overlap the robot.
bool stays_inside(const sensors::RangerBeams& ranger, const partition::ObstacleShape& body) {
  const auto stays = [&](const sensors::BeamGroup& group, std::size_t beam) {
    const Vec2 from = ranger.reference + Vec2(group.ox[beam], group.oy[beam]);
    const Vec2 to = from + group.range_max[beam] * Vec2(group.dx[beam], group.dy[beam]);
    return std::ranges::any_of(body.pieces, [&](const ConvexPrism& piece) {
      return piece.z.contains(group.z) && is_in(piece, from) && is_in(piece, to);
    });
  };
  return std::ranges::all_of(ranger.groups, [&](const sensors::BeamGroup& group) {
    for (std::size_t beam = 0; beam < group.count; ++beam)
      if (!stays(group, beam)) return false;
    return true;
  });
}

class Lint {
 public:
  /// base_types: names of the types that other types extend.
  Lint(const engine::World& world, const std::vector<std::string>& base_types, Diagnostics& diagnostics)
      : world_(world),
        spec_(world.spec()),
        base_types_(base_types.begin(), base_types.end()),
        diagnostics_(diagnostics) {
    levels_.resize(spec_.types.size());
    bodies_.resize(spec_.types.size());
    for (const engine::BodySpec& body : spec_.bodies) {
      ++levels_[body.type.index()][body.pose_world_body.z];
      ++bodies_[body.type.index()];
    }
    add_levels_of_interventions();
    collect_set_params();
  }

  void check() {
    check_types();
    check_drives();
    check_periods();
    check_supplies();
    check_contacts();
    check_controllers();
    check_goals();
    check_sensors();
    check_lights();
    check_ground();
    check_blobs();
    check_hidden_colors();
    check_radios();
    check_grippers();
    check_floor_plans();
    check_window();
    check_interventions();
    check_selections();
    check_base_types();
  }

 private:
  /// The fiducial marks of one fiducial_key.
  struct Marks {
    Heights heights;
    std::vector<std::uint32_t> types;      ///< types of bodies that have such a mark; each once
    std::vector<std::uint32_t> on_joints;  ///< types of bodies that have such a mark on a joint; each once
  };

  void add_levels_of_interventions();
  void collect_set_params();
  bool is_set(const engine::Record& params, std::initializer_list<std::string_view> names) const;

  void check_types();
  void check_drives();
  void check_periods();
  void check_supplies();
  void check_contacts();
  void check_controllers();
  void check_goals();
  void check_sensors();
  template <class Visit>
  void for_devices(Visit&& visit) const;
  void check_lights();
  void check_ground();
  void check_blobs();
  void check_hidden_colors();
  std::vector<std::uint32_t> color_hiding_parts(std::uint32_t t) const;
  std::map<std::int32_t, Marks> marks() const;
  std::vector<std::uint32_t> lifting_types() const;
  bool has_others(std::span<const std::uint32_t> types, std::uint32_t type) const;
  void check_ranger(std::uint32_t type, const engine::BodyType::Device& sensor, Where where,
                    const Heights& visible, std::span<const std::uint32_t> lifting, bool changes);
  void check_finder(std::uint32_t type, const engine::DeviceSpec& sensor, const engine::SoughtMarks& sought,
                    const Marks& marks);
  std::size_t count_own(std::uint32_t type, std::span<const ZInterval> own, double level, double z) const;
  void check_radios();
  void check_grippers();
  void check_floor_plans();
  Result<> can_block(const engine::BodySpec& body, const engine::PartSpec& plan) const;
  void check_robots_in_walls(const std::vector<BodyId>& plans);
  void check_window();
  void check_interventions();
  void check_selections();
  void check_base_types();

  const engine::World& world_;
  const engine::WorldSpec& spec_;
  std::set<std::string> base_types_;
  Diagnostics& diagnostics_;
  // Per type: z of bodies -> number of bodies. A body that an intervention moves has several z.
  std::vector<std::map<double, std::size_t>> levels_;
  std::vector<std::size_t> bodies_;  // per type: number of bodies
  /// The parameters of drives, devices and controllers that interventions change: the record, the name, and
  /// the new values.
  std::multimap<std::pair<const engine::Record*, std::string_view>, const engine::Value*> set_params_;
};

/// Adds the heights at which the interventions `move` and `add` put bodies, each once per body.
void Lint::add_levels_of_interventions() {
  using Action = engine::InterventionSpec::Action;
  engine::Groups groups(world_);
  std::set<std::pair<std::uint32_t, double>> known;  // bodies, of a reserve the first one, and their heights
  const auto add = [&](BodyId first, std::size_t count, double z) {
    const engine::BodySpec& body = spec_.bodies[first.index()];
    if (z != body.pose_world_body.z && known.emplace(first.value, z).second)
      levels_[body.type.index()][z] += count;
  };
  for (const engine::InterventionSpec& at : spec_.experiment.at) {
    if (!at.pose) continue;
    if (at.action == Action::move) {
      add(world_.find(at.whom.name), 1, at.pose->z);
    } else if (at.action == Action::add) {
      const engine::ReserveSpec& reserve = spec_.reserves.at(*groups.reserve(at.whom.name));
      add(reserve.first, reserve.count, at.pose->z);
    }
  }
}

/// Collects the parameters to which interventions `set` give new values.
void Lint::collect_set_params() {
  using Of = engine::SettingSpec::Of;
  for (const engine::InterventionSpec& at : spec_.experiment.at) {
    if (!at.setting) continue;
    const engine::TypeSpec& spec = spec_.types[at.setting->type.index()];
    const engine::BodyType& type = world_.types()[at.setting->type.index()];
    const std::size_t index = at.setting->index;
    const auto collect = [&](const engine::FieldTable& table, const engine::Record& params) {
      for (std::size_t i = 0; i < table.fields.size(); ++i)
        if (const engine::Value& value = at.setting->params[i]; value.given())
          set_params_.emplace(std::pair(&params, table.fields[i].name), &value);
    };
    switch (at.setting->of) {
      case Of::drive: collect(type.drive->kind->params, spec.drive->params); break;
      case Of::device: collect(type.devices[index].kind->params, spec.devices[index].params); break;
      case Of::controller:
        collect(type.controllers[index].kind->params, spec.controllers[index].params);
        break;
    }
  }
}

/// Whether an intervention `set` changes one of these parameters of a drive, device or controller, so that
/// the value in its type does not hold for the whole run. params: the parameters in the type
bool Lint::is_set(const engine::Record& params, std::initializer_list<std::string_view> names) const {
  return std::ranges::any_of(names, [&](std::string_view name) {
    return set_params_.contains({&params, name});
  });
}

void Lint::check_types() {
  const auto is_used = [&](std::size_t t) {
    return !levels_[t].empty() || base_types_.contains(spec_.types[t].name);
  };
  const auto file_of = [&](std::size_t t) { return spec_.types[t].parts.front().where.file; };
  std::set<std::uint32_t> used_files;
  for (std::size_t t = 0; t < spec_.types.size(); ++t)
    if (is_used(t) && file_of(t) != 0) used_files.insert(file_of(t));
  for (std::size_t t = 0; t < spec_.types.size(); ++t)
    if (!is_used(t) && !used_files.contains(file_of(t)))  // a world rarely uses all types of an included file
      diagnostics_.warning(spec_.types[t].parts.front().where,
                           fmt::format("type \"{}\" is never used", spec_.types[t].name));
}

/// Warns of drives whose limits exclude 0, so that the robot moves although its command is 0, and of drives
/// that drive backwards but never forwards.
void Lint::check_drives() {
  for (std::size_t t = 0; t < spec_.types.size(); ++t) {
    const engine::BodyType& type = world_.types()[t];
    if (!type.drive || levels_[t].empty()) continue;
    if (is_set(spec_.types[t].drive->params, {"velocity_min_x", "velocity_max_x", "velocity_min_y",
                                              "velocity_max_y", "turn_min", "turn_max"}))
      continue;
    const auto velocity_of = [&](const engine::Command& command) {
      engine::Velocity velocity;
      type.drive->kind->drive(
          type.drive->data,
          {.commands = {&command, 1}, .velocities = {&velocity, 1}, .elapsed_s = spec_.tick_s});
      return velocity;
    };
    const auto warn = [&](const std::string& what) {
      diagnostics_.warning(spec_.types[t].drive->where, fmt::format("the drive \"{}\" of \"{}\" {}",
                                                                    type.drive->kind->name, type.name, what));
    };
    const engine::Velocity rest = velocity_of({});
    std::string moves;
    const auto add = [&](std::string_view what, double speed, std::string_view unit) {
      if (speed != 0)
        moves += fmt::format("{}a {} of {:.10g} {}", moves.empty() ? "" : " and ", what, speed, unit);
    };
    add("forward speed", rest.x, "m/s");
    add("speed to the left", rest.y, "m/s");
    add("turn rate", rest.turn, "rad/s");
    constexpr double k_fast = 1e9;  // m/s
    if (!moves.empty())
      warn(fmt::format("cannot stand still: if the command is 0, its limits give {}", moves));
    else if (velocity_of({k_fast}).x == 0 && velocity_of({-k_fast}).x < 0)
      warn("can only drive backwards: its limits exclude forward speeds");
  }
}

/// Warns of drives and devices that never run because their first run, at the end of their first period, is
/// after the end of the run.
void Lint::check_periods() {
  if (!spec_.quit_time_s) return;
  const std::uint64_t end = std::max<std::uint64_t>(engine::ticks_until(*spec_.quit_time_s, spec_.tick_s), 1);
  for (std::size_t t = 0; t < spec_.types.size(); ++t) {
    if (levels_[t].empty()) continue;
    const engine::BodyType& type = world_.types()[t];
    const auto check = [&](std::string_view what, std::string_view name, std::uint64_t period, Where where) {
      if (period > end)
        diagnostics_.warning(
            where,
            fmt::format("the {} never runs unless --for makes the run longer: its period is {:.10g} s, but "
                        "\"quit_time_s\" ends the run at {:.10g} s",
                        device_text(what, name, type.name), static_cast<double>(period) * spec_.tick_s,
                        *spec_.quit_time_s));
    };
    if (type.drive) check("drive", type.drive->kind->name, type.drive->period, spec_.types[t].drive->where);
    for (std::size_t d = 0; d < type.devices.size(); ++d)
      check(type.devices[d].kind->name, type.devices[d].name, type.devices[d].period,
            spec_.types[t].devices[d].where);
  }
}

/// Warns of power supplies that can hold no energy and therefore stop everything that they serve.
void Lint::check_supplies() {
  for_devices([&](std::uint32_t t, const engine::DeviceSpec& given, const engine::BodyType::Device& device) {
    const engine::DeviceKind& kind = *device.kind;
    if (!kind.is_spent || !kind.energy) return;
    engine::StateTable state("", engine::HashGroup::sensor, engine::StateTable::Layout::rows,
                             device.prepared.percepts, {BodyId(0)}, device.prepared.percept_bytes);
    if (kind.start) kind.start(device.prepared.data, state, 0);
    if (!kind.is_spent(device.prepared.data, state, 0) || kind.energy(state, 0).capacity_j > 0) return;
    const std::string& type = world_.types()[t].name;
    const std::string called = device.name.empty() ? device_text(kind.name, device.name, type)
                                                   : fmt::format("\"{}\" of \"{}\"", device.name, type);
    diagnostics_.warning(given.where,
                         fmt::format("{} can hold no energy: its capacity is 0 J, so everything that it "
                                     "supplies is stopped for the whole run",
                                     called));
  });
}

/// Warns of power contacts that can exchange no energy.
void Lint::check_contacts() {
  std::set<std::uint32_t> changed;  // types with parameters that interventions change, such as `take`
  for (const engine::InterventionSpec& at : spec_.experiment.at)
    if (at.setting) changed.insert(at.setting->type.value);
  const auto for_contacts = [&](auto&& visit) {
    for_devices([&](std::uint32_t t, const engine::DeviceSpec& given,
                    const engine::BodyType::Device& device) {
      if (const std::optional<models::Contact> contact = models::power_contact(device.prepared.data))
        visit(t, given, contact->give > 0, contact->take > 0 || changed.contains(t), contact->has_outline);
    });
  };
  std::vector<std::uint32_t> givers;  // types with such a contact
  std::vector<std::uint32_t> takers;
  for_contacts([&](std::uint32_t t, const engine::DeviceSpec&, bool gives, bool takes, bool) {
    if (gives) givers.push_back(t);
    if (takes) takers.push_back(t);
  });
  for_contacts([&](std::uint32_t t, const engine::DeviceSpec& contact, bool gives, bool takes,
                   bool has_outline) {
    std::string_view why;
    if (!gives && !takes)
      why = "it has neither \"give_W\" nor \"take_W\"";
    else if (!has_outline)
      why =
          "the part that carries it has no shape, so that nothing touches it: give the part a size, or mount "
          "the contact on another part";
    else if (!(gives && has_others(takers, t)) && !(takes && has_others(givers, t)))
      why = gives && takes ? "no other body has a power contact"
            : gives        ? "no other body has a power contact with \"take_W\""
                           : "no other body has a power contact with \"give_W\"";
    if (!why.empty())
      diagnostics_.warning(contact.where,
                           fmt::format("{} exchanges no energy: {}",
                                       device_text("power contact", contact.name, spec_.types[t].name), why));
  });
}

/// Warns of controllers that have a period but run with another one: that of their first device or of the
/// drive. Warns of controllers that find an obstacle at every reading of their ranger.
void Lint::check_controllers() {
  for (std::size_t t = 0; t < spec_.types.size(); ++t) {
    const engine::BodyType& type = world_.types()[t];
    for (std::size_t c = 0; c < type.controllers.size(); ++c) {
      const engine::ControllerSpec& given = spec_.types[t].controllers[c];
      const engine::BodyType::Controller& controller = type.controllers[c];
      const bool changes = is_set(given.params, {"min_front", "stop", "clearance", "clearances"}) ||
                           std::ranges::any_of(controller.devices, [&](std::size_t d) {
                             return is_set(spec_.types[t].devices[d].params, {"transducers"});
                           });
      for (const auto always_turns : models::k_always_turns)
        if (const std::string text = always_turns(controller.data);
            !text.empty() && !changes && !levels_[t].empty())
          diagnostics_.warning(
              given.where, fmt::format("the controller \"{}\" of \"{}\" {}", given.kind, type.name, text));
      if (!(given.period_s > 0) || engine::period_ticks(given.period_s, spec_.tick_s) == controller.period)
        continue;
      const std::string with =
          controller.devices.empty()
              ? std::string("the drive")
              : fmt::format("its first device \"{}\"", type.devices[controller.devices.front()].name);
      diagnostics_.warning(
          given.where,
          fmt::format(
              "the period of {:.10g} s of the controller \"{}\" of \"{}\" has no effect: the controller runs "
              "whenever {} has run, every {:.10g} s",
              given.period_s, given.kind, spec_.types[t].name, with,
              static_cast<double>(controller.period) * spec_.tick_s));
    }
  }
}

/// Warns of goals that are outside of the bounds of the world. Odometry may place a goal anywhere, a part
/// with `wheels` may leave the bounds, and an intervention may give other goals before the robot is to reach
/// these.
void Lint::check_goals() {
  if (!spec_.bounds) return;
  for (std::size_t t = 0; t < spec_.types.size(); ++t) {
    const engine::BodyType& type = world_.types()[t];
    if (levels_[t].empty() || !type.drive || type.drive->localization.kind != engine::Localization::Kind::gps)
      continue;
    const Pose origin = type.drive->localization.origin.value_or(Pose());
    for (std::size_t c = 0; c < type.controllers.size(); ++c) {
      if (type.controllers[c].drive) continue;  // it commands `wheels`
      if (is_set(spec_.types[t].controllers[c].params, {"goals", "near"})) continue;
      if (const std::string text = models::goal_outside(type.controllers[c].data, origin, *spec_.bounds);
          !text.empty())
        diagnostics_.warning(spec_.types[t].controllers[c].where,
                             fmt::format("the controller \"{}\" of \"{}\" {}",
                                         spec_.types[t].controllers[c].kind, type.name, text));
    }
  }
}

void Lint::check_sensors() {
  Heights visible;
  for (std::size_t t = 0; t < spec_.types.size(); ++t)
    for (const auto& [z, count] : levels_[t])
      for (const engine::RayOutline& outline : world_.types()[t].outlines)
        visible.add(outline.z.shifted(z), count);
  visible.sum();
  const std::vector<std::uint32_t> lifting = lifting_types();
  std::map<std::int32_t, Marks> marks = this->marks();
  for_devices([&](std::uint32_t t, const engine::DeviceSpec& given, const engine::BodyType::Device& device) {
    check_ranger(t, device, given.where, visible, lifting, is_set(given.params, {"transducers"}));
    if (const auto& sought = device.prepared.seeks; sought && !is_set(given.params, {"key", "ignore_zloc"}))
      check_finder(t, given, *sought, marks[sought->key]);
  });
}

/// Returns the fiducial marks of all bodies, by their fiducial_key.
std::map<std::int32_t, Lint::Marks> Lint::marks() const {
  std::map<std::int32_t, Marks> marks;
  for (std::uint32_t t = 0; t < spec_.types.size(); ++t)
    for (const engine::PartSpec& part : spec_.types[t].parts) {
      if (part.returns.fiducial == 0 || levels_[t].empty()) continue;
      Marks& of_key = marks[part.returns.fiducial_key];
      for (const Solid& solid : part.solids)
        for (const auto& [z, count] : levels_[t]) of_key.heights.add(solid.z.shifted(z), count);
      if (of_key.types.empty() || of_key.types.back() != t) of_key.types.push_back(t);
      if (part.joint != engine::k_rigid && (of_key.on_joints.empty() || of_key.on_joints.back() != t))
        of_key.on_joints.push_back(t);
    }
  for (auto& [key, of_key] : marks) of_key.heights.sum();
  return marks;
}

/// Calls visit(type, given, device) for each device of each type that has bodies. given: the device in the
/// spec
template <class Visit>
void Lint::for_devices(Visit&& visit) const {
  for (std::uint32_t t = 0; t < spec_.types.size(); ++t)
    for (std::size_t d = 0; d < spec_.types[t].devices.size() && !levels_[t].empty(); ++d)
      visit(t, spec_.types[t].devices[d], world_.types()[t].devices[d]);
}

/// Returns the types of bodies with an outline that a joint, such as a lift, may raise.
std::vector<std::uint32_t> Lint::lifting_types() const {
  std::vector<std::uint32_t> types;
  for (std::uint32_t t = 0; t < spec_.types.size(); ++t)
    if (!levels_[t].empty() && std::ranges::any_of(world_.types()[t].outlines, [](const auto& outline) {
          return outline.joint != engine::k_rigid;
        }))
      types.push_back(t);
  return types;
}

/// Whether there is a body of one of these types, besides one body of type `type`, whose sensors cannot see
/// the body itself. Each of the types must have a body.
bool Lint::has_others(std::span<const std::uint32_t> types, std::uint32_t type) const {
  return std::ranges::any_of(types, [&](std::uint32_t t) { return t != type || bodies_[t] > 1; });
}

/// Returns heights as text: "0.5 m", "0 to 1 m".
std::string heights_text(const ZInterval& z) {
  return z.min == z.max ? fmt::format("{:.4g} m", z.min) : fmt::format("{:.4g} to {:.4g} m", z.min, z.max);
}

/// Returns the second half of a warning, which states why a sensor at the heights `looks` detects none of the
/// solids at the heights `there`. nothing, what: how the text names these solids, such as "no other body that
/// rangers see" and "bodies that rangers see".
std::string missed_text(const Heights& there, const ZInterval& looks, std::string_view nothing,
                        std::string_view what) {
  if (there.empty() || there.extent().contains(looks.min))
    return fmt::format("{} is at the height of the sensor, {}", nothing, heights_text(looks));
  return fmt::format("it is at a height of {}, but {} are at {}", heights_text(looks), what,
                     heights_text(there.extent()));
}

/// Returns the first half of a warning, which says that a sensor sees nothing. type: name of the type of body
/// that has the sensor. sensor: name of the sensor; empty if the body is only a sensor, as models of Stage
/// worlds may be.
std::string called_text(std::string_view sensor, std::string_view type) {
  return sensor.empty() ? fmt::format("sensor \"{}\" sees nothing: ", type)
                        : fmt::format("sensor \"{}\" of \"{}\" sees nothing: ", sensor, type);
}

/// Returns how many of the solids at the height z are those of the body whose sensor looks at this height. A
/// body that is the only one of its type counts at each height to which interventions move it. own: the
/// solids of one body of type `type`, in its frame. level: the height of the body
std::size_t Lint::count_own(std::uint32_t type, std::span<const ZInterval> own, double level,
                            double z) const {
  std::ptrdiff_t count = 0;
  for (const auto& other : levels_[type])
    if (other.first == level || bodies_[type] == 1)
      count += std::ranges::count_if(
          own, [&](const ZInterval& solid) { return solid.shifted(other.first).contains(z); });
  return static_cast<std::size_t>(count);
}

/// Warns if no other body has a fiducial mark whose fiducial_key is that of the finder, or if all such marks
/// are at other heights than the finder. Heights are not compared if the finder or a mark is on a joint,
/// which may move it to another height.
void Lint::check_finder(std::uint32_t type, const engine::DeviceSpec& sensor,
                        const engine::SoughtMarks& sought, const Marks& marks) {
  const std::string called = called_text(sensor.name, spec_.types[type].name);
  if (!has_others(marks.types, type)) {
    diagnostics_.warning(
        sensor.where,
        called + fmt::format("no other body with a fiducial_return has the fiducial_key of the finder, {}",
                             sought.key));
    return;
  }
  if (sought.at_any_height || sensor.joint != engine::k_rigid || has_others(marks.on_joints, type)) return;
  std::vector<ZInterval> own;  // of the marks of one body of type `type`, in its frame
  for (const engine::PartSpec& part : spec_.types[type].parts)
    if (part.returns.fiducial != 0 && part.returns.fiducial_key == sought.key)
      for (const Solid& solid : part.solids) own.push_back(solid.z);
  ZInterval looks = k_no_heights;
  for (const auto& level : levels_[type]) {
    const double z = sensor.pose_body_device.z + level.first;
    if (marks.heights.at(z) > count_own(type, own, level.first, z)) return;
    looks = united(looks, {z, z});
  }
  diagnostics_.warning(sensor.where,
                       called + missed_text(marks.heights, looks, "no other body with a fiducial_return",
                                            "bodies with a fiducial_return"));
}

/// Warns if a ranger has no beams, if its beams end inside its own body, or if no other body is at their
/// height. A ranger on a joint may move out of its body and to other heights, and a ranger whose transducers
/// an intervention changes may get other beams (`changes`), so that only the number of their beams is
/// checked.
void Lint::check_ranger(std::uint32_t type, const engine::BodyType::Device& sensor, Where where,
                        const Heights& visible, std::span<const std::uint32_t> lifting, bool changes) {
  const auto* its_ranger = std::any_cast<sensors::Ranger>(&sensor.prepared.data);
  if (!its_ranger) return;
  const sensors::RangerBeams* ranger = its_ranger->beams.get();
  const engine::BodyType& body = world_.types()[type];
  const std::string called = called_text(sensor.name, body.name);
  if (ranger->count == 0) {
    diagnostics_.warning(where, called + "it has no beams");
    return;
  }
  if (sensor.joint != engine::k_rigid || changes) return;
  if (stays_inside(*ranger, body.obstacle)) {
    float longest = 0;
    for (const sensors::BeamGroup& group : ranger->groups)
      longest = std::max(longest, *std::ranges::max_element(group.range_max));
    diagnostics_.warning(
        where, called + fmt::format("its beams of at most {:.4g} m end inside its own body", longest));
    return;
  }
  if (has_others(lifting, type)) return;
  std::vector<ZInterval> own;  // of one body of type `type`, in its frame: beams ignore their own robot
  for (const engine::RayOutline& outline : body.outlines) own.push_back(outline.z);
  ZInterval looks = k_no_heights;
  for (const auto& level : levels_[type])
    for (const sensors::BeamGroup& group : ranger->groups) {
      const double z = group.z + level.first;
      if (visible.at(z) > count_own(type, own, level.first, z)) return;
      looks = united(looks, {z, z});
    }
  diagnostics_.warning(where, called + missed_text(visible, looks, "no other body that rangers see",
                                                   "bodies that rangers see"));
}

/// Warns of light sensors in worlds in which no other body has a light.
void Lint::check_lights() {
  const auto is_light = [](const engine::BodyType::Device& device) {
    return sensors::light_source(device.prepared) != nullptr;
  };
  std::vector<std::uint32_t> lit;  // types with a light
  for (std::uint32_t t = 0; t < spec_.types.size(); ++t)
    if (bodies_[t] > 0 && std::ranges::any_of(world_.types()[t].devices, is_light)) lit.push_back(t);
  for_devices([&](std::uint32_t t, const engine::DeviceSpec& given, const engine::BodyType::Device& device) {
    if (sensors::is_light_sensor(device.prepared.data) && !has_others(lit, t))
      diagnostics_.warning(given.where, called_text(given.name, spec_.types[t].name) +
                                            "no other body has a light, such as a \"blinkenlight\"");
  });
}

/// Warns of ground sensors in worlds in which no part of another body can be ground. A joint may lower a
/// part.
void Lint::check_ground() {
  const auto is_ground = [&](std::uint32_t t, double height) {
    return !levels_[t].empty() &&
           std::ranges::any_of(spec_.types[t].parts, [&](const engine::PartSpec& part) {
             return std::ranges::any_of(part.solids, [&](const Solid& solid) {
               return part.joint != engine::k_rigid || solid.z.max + levels_[t].begin()->first <= height;
             });
           });
  };
  std::map<double, std::vector<std::uint32_t>> zones;  // per height: the types that can be ground
  for_devices([&](std::uint32_t t, const engine::DeviceSpec& given, const engine::BodyType::Device& device) {
    const std::optional<double> height = sensors::ground_height(device.prepared.data);
    if (!height || is_set(given.params, {"height"})) return;
    const auto [found, is_new] = zones.try_emplace(*height);
    for (std::uint32_t other = 0; is_new && other < spec_.types.size(); ++other)
      if (is_ground(other, *height)) found->second.push_back(other);
    if (!has_others(found->second, t))
      diagnostics_.warning(
          given.where,
          fmt::format(
              "{} sees only the bare floor: no other body has a part whose top is at most {:.4g} m above the "
              "floor, its \"height\"",
              device_text("sensor", given.name, spec_.types[t].name), *height));
  });
}

/// Warns of blob finders that look for colours that no body has. LEDs and similar devices may show any
/// colour.
void Lint::check_blobs() {
  for (std::size_t t = 0; t < spec_.types.size(); ++t)
    for (const engine::BodyType::Device& device : world_.types()[t].devices)
      if (device.kind->shows_color && !levels_[t].empty()) return;
  const auto is_less = [](const Color& a, const Color& b) {
    return std::tie(a.r, a.g, a.b) < std::tie(b.r, b.g, b.b);
  };
  std::set<Color, decltype(is_less)> shown(is_less);
  for (const engine::BodySpec& body : spec_.bodies)
    for (const engine::PartSpec& part : spec_.types[body.type.index()].parts)
      if (!part.solids.empty()) shown.insert(part.color.value_or(body.color));
  for_devices([&](std::uint32_t t, const engine::DeviceSpec& given, const engine::BodyType::Device& device) {
    const std::vector<Color>* sought = sensors::sought_colors(device.prepared.data);
    if (sought == nullptr || sought->empty() || is_set(given.params, {"colors"})) return;
    const auto is_sought = [&](const Color& color) {
      return std::ranges::any_of(*sought,
                                 [&](const Color& one) { return sensors::is_same_color(one, color); });
    };
    if (std::ranges::none_of(shown, is_sought))
      diagnostics_.warning(given.where, called_text(given.name, spec_.types[t].name) +
                                            "no body has one of the colours in its \"colors\"");
  });
}

/// Returns the parts of a type that never show the colour of the world file, because a device sets their
/// colour, such as an LED. A device whose parameters are not the default ones has a chosen colour: its part
/// is left out. So is a part without a colour of its own if another part shows the body's colour.
std::vector<std::uint32_t> Lint::color_hiding_parts(std::uint32_t t) const {
  const engine::TypeSpec& type = spec_.types[t];
  const engine::BodyType& built = world_.types()[t];
  std::vector<std::uint32_t> parts;
  bool shows_color_of_body = false;
  for (std::uint32_t p = 0; p < type.parts.size(); ++p) {
    if (type.parts[p].solids.empty()) continue;
    const engine::BodyType::Device* device = engine::color_device(built, p);
    if (device == nullptr)
      shows_color_of_body = shows_color_of_body || !type.parts[p].color;
    else if (type.devices[static_cast<std::size_t>(device - built.devices.data())].params ==
             device->kind->params.defaults())
      parts.push_back(p);
  }
  if (shows_color_of_body) std::erase_if(parts, [&](std::uint32_t p) { return !type.parts[p].color; });
  return parts;
}

/// Warns of colours that are not the default ones, but that no part shows (color_hiding_parts()).
void Lint::check_hidden_colors() {
  const std::vector<Color> default_colors = worldio::default_colors(spec_.types);
  std::vector<std::vector<std::uint32_t>> hiding(spec_.types.size());
  for (std::uint32_t t = 0; t < spec_.types.size(); ++t) hiding[t] = color_hiding_parts(t);
  const auto text = [](const Color& color) {
    return fmt::format("[{:.3g}, {:.3g}, {:.3g}]", color.r, color.g, color.b);
  };
  for (std::size_t b = 0; b < spec_.bodies.size(); ++b) {
    const std::uint32_t t = spec_.bodies[b].type.value;
    const Row row = world_.row(BodyId(b));
    if (hiding[t].empty() || !row.valid()) continue;
    std::erase_if(hiding[t], [&](std::uint32_t p) {
      const std::optional<Color>& own = spec_.types[t].parts[p].color;
      const Color color = own.value_or(spec_.bodies[b].color);
      const Color shown = engine::shown_color(world_.view(), row, p).value_or(color);
      if (sensors::is_same_color(shown, color) || (!own && color == default_colors[t])) return false;
      const engine::BodyType& built = world_.types()[t];
      const auto d = static_cast<std::size_t>(engine::color_device(built, p) - built.devices.data());
      const engine::DeviceSpec& device = spec_.types[t].devices[d];
      diagnostics_.warning(
          device.where,
          fmt::format("the \"color\" {} has no effect on the part with {}, which gives the part its own "
                      "colour, {} at the start: give the device the colour, or a part of its own",
                      text(color), device_text(device.kind, device.name, spec_.types[t].name), text(shown)));
      return true;
    });
  }
}

/// Warns of radios on channels on which no other body has a radio.
void Lint::check_radios() {
  std::map<std::string, std::vector<std::uint32_t>> channels;  // the types with a radio on each channel
  const auto for_each_radio = [&](auto&& visit) {
    for_devices(
        [&](std::uint32_t t, const engine::DeviceSpec& given, const engine::BodyType::Device& device) {
          if (const std::string* channel = sensors::radio_channel(device.prepared.data))
            visit(t, given, *channel);
        });
  };
  for_each_radio([&](std::uint32_t t, const engine::DeviceSpec& radio, const std::string& channel) {
    channels[channel].push_back(t);
    const auto [first, last] = set_params_.equal_range({&radio.params, "channel"});
    for (auto it = first; it != last; ++it) channels[it->second->text()].push_back(t);
  });
  for_each_radio([&](std::uint32_t t, const engine::DeviceSpec& radio, const std::string& channel) {
    if (has_others(channels[channel], t) || is_set(radio.params, {"channel"})) return;
    std::string known;
    for (const auto& [name, types] : channels)
      if (name != channel)
        known += fmt::format("{}\"{}\"", known.empty() ? "; other channels: " : ", ", name);
    diagnostics_.warning(
        radio.where, fmt::format("{} hears nothing: no other body has a radio on the channel \"{}\"{}",
                                 device_text(radio.kind, radio.name, spec_.types[t].name), channel, known));
  });
}

/// Warns of grippers in worlds in which they can hold no body.
void Lint::check_grippers() {
  std::size_t held = 0;  // number of bodies that some gripper can hold
  for (std::size_t t = 0; t < spec_.types.size(); ++t)
    if (engine::can_be_gripped(spec_.types[t])) held += bodies_[t];
  for_devices([&](std::uint32_t t, const engine::DeviceSpec& given, const engine::BodyType::Device& device) {
    const std::size_t own = engine::can_be_gripped(spec_.types[t]) ? 1 : 0;
    if (device.kind->carries && held == own)
      diagnostics_.warning(given.where,
                           fmt::format("{} can hold nothing: no other body has \"gripper_return\"",
                                       device_text(device.kind->name, device.name, world_.types()[t].name)));
  });
}

/// Returns success if a floor plan can block a robot, else an error that states why it cannot. body: the
/// floor plan; plan: its part with the walls.
Result<> Lint::can_block(const engine::BodySpec& body, const engine::PartSpec& plan) const {
  if (!plan.returns.obstacle) return Error{"it is not an obstacle"};
  const double height = body.pose_world_body.z;
  ZInterval robots = k_no_heights;
  for (std::size_t t = 0; t < spec_.types.size(); ++t) {
    const engine::BodyType& type = world_.types()[t];
    if (!type.drive) continue;
    for (const auto& level : levels_[t])
      for (const ConvexPrism& piece : type.obstacle.pieces) {
        const ZInterval z = piece.z.shifted(level.first);
        for (const Solid& solid : plan.solids)
          if (z.overlaps(solid.z.shifted(height))) return {};
        robots = united(robots, z);
      }
  }
  if (robots == k_no_heights) return Error{"no robot is an obstacle, and only obstacles block one another"};
  ZInterval walls = robots;
  if (!plan.solids.empty()) walls = plan.solids.front().z.shifted(height);
  return Error{
      fmt::format("its walls are at a height of {:.4g} to {:.4g} m, but the robots are at {:.4g} to {:.4g} m",
                  walls.min, walls.max, robots.min, robots.max)};
}

void Lint::check_floor_plans() {
  if (world_.robots() == 0) return;
  std::vector<BodyId> open;  // floor plans that robots drive through
  for (std::size_t b = 0; b < spec_.bodies.size(); ++b) {
    const engine::BodySpec& body = spec_.bodies[b];
    if (world_.row(BodyId(b)).valid()) continue;
    for (const engine::PartSpec& part : spec_.types[body.type.index()].parts) {
      if (!part.floor_plan) continue;
      const Result<> blocks = can_block(body, part);
      if (blocks) continue;
      diagnostics_.warning(body.where, fmt::format("floor plan \"{}\" blocks no robot: {}",
                                                   spec_.name(BodyId(b)), blocks.error().text));
      if (!part.returns.obstacle) open.push_back(BodyId(b));
      break;
    }
  }
  if (!open.empty()) check_robots_in_walls(open);
}

/// Warns of robots that start inside the walls of the floor plans `plans`, which are not obstacles.
/// engine::World gives this warning for floor plans that are obstacles.
void Lint::check_robots_in_walls(const std::vector<BodyId>& plans) {
  std::vector<partition::FixedSolid> solids;
  for (const BodyId plan : plans) {
    const engine::BodySpec& body = spec_.bodies[plan.index()];
    for (const engine::PartSpec& part : spec_.types[body.type.index()].parts)
      for (const Solid& solid : part.solids)
        if (part.floor_plan) solids.push_back({placed(solid, body.pose_world_body), plan, true, -1});
  }
  const partition::StaticScene scene(std::move(solids), k_scene_cell_m);
  std::size_t found = 0;
  Where last;
  for (std::size_t b = 0; b < spec_.bodies.size(); ++b) {
    const engine::BodySpec& body = spec_.bodies[b];
    const engine::BodyType& type = world_.types()[body.type.index()];
    if (!type.drive || type.obstacle.empty() || !spec_.starts(BodyId(b))) continue;
    for (const BodyId plan : scene.overlapping(type.obstacle, body.pose_world_body)) {
      if (found++ >= k_most_listed) continue;
      last = body.where;
      diagnostics_.warning(last, fmt::format("\"{}\" overlaps a wall of floor plan \"{}\" at the start, and "
                                             "can drive through the wall, because the plan "
                                             "is no obstacle: move the robot, or make the plan an obstacle",
                                             spec_.name(BodyId(b)), spec_.name(plan)));
    }
  }
  if (found > k_most_listed)
    diagnostics_.warning(last,
                         fmt::format("{} more robot{} inside walls of floor plans", found - k_most_listed,
                                     found - k_most_listed == 1 ? " starts" : "s start"));
}

/// Warns of a window that follows a body that the world does not have.
void Lint::check_window() {
  if (!spec_.window) return;
  const std::string& name = get(worldio::window_fields(), *spec_.window, "follow").text();
  if (name.empty() || world_.find(name).valid()) return;
  diagnostics_.warning(
      {spec_.resolution_where.file, 0},
      fmt::format("the window follows the model \"{}\", but there is no such model: correct the name", name));
}

/// Warns of interventions that add several bodies at one pose, and of interventions and faults that are later
/// than the end of a run. Those exactly at the end are not reported.
void Lint::check_interventions() {
  engine::Groups groups(world_);
  for (const engine::InterventionSpec& intervention : spec_.experiment.at) {
    if (intervention.action != engine::InterventionSpec::Action::add || !intervention.pose) continue;
    const engine::ReserveSpec& reserve = spec_.reserves.at(*groups.reserve(intervention.whom.name));
    const auto count = std::min<std::int64_t>(intervention.whom.count.value_or(reserve.count), reserve.count);
    if (count > 1 && !world_.type(reserve.first).obstacle.empty())
      diagnostics_.warning(
          intervention.where,
          fmt::format("this entry of \"at\" would add {} bodies at the same pose, where only one has room: "
                      "give \"count\": 1, or \"region_m\" in place of \"pose\"",
                      count));
  }
  if (!spec_.quit_time_s) return;
  const auto check_time = [&](std::string_view key, std::string_view what, double time_s, Where where) {
    if (engine::ticks_until(time_s, spec_.tick_s) > engine::ticks_until(*spec_.quit_time_s, spec_.tick_s))
      diagnostics_.warning(
          where,
          fmt::format("this entry of \"{}\" has no effect unless --for makes the run longer: {} {:.10g} "
                      "s, but \"quit_time_s\" ends the run at {:.10g} s",
                      key, what, time_s, *spec_.quit_time_s));
  };
  for (const engine::InterventionSpec& intervention : spec_.experiment.at)
    check_time("at", "its time is", intervention.time_s, intervention.where);
  for (const engine::FaultSpec& fault : spec_.experiment.faults)
    check_time("faults", "it begins at", fault.from_s, fault.where);
}

/// Warns of interventions and faults whose `count` or `share` is so small that they select no body of their
/// group. An intervention selects among at most all bodies of the group, a fault among those that are in the
/// world at the start.
void Lint::check_selections() {
  engine::Groups groups(world_);
  const auto check = [&](std::string_view key, const engine::GroupSpec& whom, std::size_t size, Where where) {
    if (size == 0 || whom.selected_of(size) > 0) return;
    const std::string why = whom.count == 0
                                ? std::string("its \"count\" is 0")
                                : fmt::format(
                                      "its \"share\" of {:.10g} selects none of {} {}: the least share that "
                                      "selects a body is {}",
                                      *whom.share, size, size == 1 ? "body" : "bodies",
                                      plain_number(0.5 / static_cast<double>(size)));
    diagnostics_.warning(where, fmt::format("this entry of \"{}\" has no effect: {}", key, why));
  };
  using Action = engine::InterventionSpec::Action;
  for (const engine::InterventionSpec& at : spec_.experiment.at)
    if (at.action == Action::remove || at.action == Action::disable || at.action == Action::enable)
      check("at", at.whom, groups.find(at.whom, at.where, diagnostics_)->size(), at.where);
  for (const engine::FaultSpec& fault : spec_.experiment.faults) {
    const engine::Groups::Bodies bodies = groups.find(fault.whom, fault.where, diagnostics_);
    const auto starts = [&](BodyId body) { return spec_.starts(body); };
    check("faults", fault.whom, static_cast<std::size_t>(std::ranges::count_if(*bodies, starts)),
          fault.where);
  }
}

/// Warns of interventions, faults, measures and conditions that name a type without bodies that other types
/// extend: they do not refer to the bodies of those types.
void Lint::check_base_types() {
  const auto warn = [&](const std::string& what, std::string_view name, Where where) {
    if (!base_types_.contains(std::string(name))) return;
    for (std::size_t t = 0; t < spec_.types.size(); ++t)
      if (spec_.types[t].name == name && !levels_[t].empty()) return;
    diagnostics_.warning(where,
                         fmt::format("{}: no body has the type \"{}\"; bodies of a type that extends it "
                                     "do not count",
                                     what, name));
  };
  for (const engine::InterventionSpec& at : spec_.experiment.at)
    if (at.setting)
      warn("this entry of \"at\" has no effect", spec_.types[at.setting->type.index()].name, at.where);
    else if (at.whom.by == engine::GroupSpec::By::type)
      warn("this entry of \"at\" has no effect", at.whom.name, at.where);
  for (const engine::FaultSpec& fault : spec_.experiment.faults)
    if (fault.whom.by == engine::GroupSpec::By::type)
      warn("this entry of \"faults\" has no effect", fault.whom.name, fault.where);
  const auto check = [&](std::string_view what, const engine::MeasureSpec& measure) {
    if (engine::robots_of(world_, measure.of).empty())  // else a population or a robot has this name
      warn(fmt::format("the {} \"{}\" covers no robot", what, engine::measure_name(measure)), measure.of,
           measure.where);
  };
  for (const engine::MeasureSpec& measure : spec_.measures) check("measure", measure);
  for (const engine::StopSpec& condition : spec_.experiment.stop_when)
    check("condition on", condition.measure);
}

/// Warns of conditions with the default parameters of a measure to which the world's list of measures gives
/// others: such a condition and the column of its name differ.
void check_conditions(const engine::WorldSpec& spec, const engine::Registry& registry,
                      Diagnostics& diagnostics) {
  for (const engine::StopSpec& condition : spec.experiment.stop_when) {
    const engine::MeasureSpec& measure = condition.measure;
    const std::string name = engine::measure_name(measure);
    const auto kind = registry.find_measure(measure.kind);
    if (!kind || measure.params != (*kind)->params.defaults()) continue;
    for (std::size_t i = 0; i < spec.measures.size(); ++i) {
      const engine::MeasureSpec& listed = spec.measures[i];
      if (engine::measure_name(listed) != name || listed.kind != measure.kind || listed.of != measure.of ||
          listed.params == measure.params)
        continue;
      diagnostics.warning(
          measure.where,
          fmt::format("the condition on \"{}\" has the default parameters, not those of /measures/{}: to "
                      "give it the same parameters, give that entry a \"name\" of its own, and use the name "
                      "in the condition",
                      name, i));
    }
  }
}

/// Reports the errors that a run with the measures, the stop conditions and the recording of the world would
/// report.
void check_outputs(engine::World& world, const engine::Registry& registry, Diagnostics& diagnostics) {
  const engine::WorldSpec& spec = world.spec();
  std::vector<std::string> paths;
  for (std::size_t i = 0; i < spec.measures.size(); ++i) paths.push_back(fmt::format("/measures/{}", i));
  const engine::MeasureSet measures(world, registry, spec.measures, diagnostics, paths);
  const engine::StopConditions conditions(world, registry, spec.experiment.stop_when, diagnostics);
  if (!spec.record) return;
  worldio::check_recording_file(*spec.record, diagnostics);
  if (spec.record->fields.empty()) return;
  try {
    worldio::recorded_components(world, spec.record->fields);
  } catch (const std::invalid_argument& error) {
    diagnostics.error(spec.record->where_fields, fmt::format("/record/fields: {}", error.what()));
  }
}

}  // namespace

std::vector<std::string> lint(const std::filesystem::path& file, const SimulationOptions& options) {
  restore_fp_environment();  // before anything is computed from the file
  Diagnostics diagnostics(true);
  engine::Registry registry = make_registry();
  const std::shared_ptr<const Plugins> plugins = add_plugins(registry, options.plugin_path, options.scripts);
  std::vector<std::string> base_types;
  const worldio::LoadOptions load{.seed = options.seed,
                                  .robots = options.robots,
                                  .set = options.set,
                                  .search_path = options.search_path,
                                  .threads = options.threads,
                                  .base_types = &base_types};
  engine::WorldSpec spec = worldio::load_world(file, registry, load, diagnostics);
  diagnostics.throw_if_errors();
  assign_controllers(options.scripts, spec, diagnostics);
  diagnostics.throw_if_errors();
  engine::World world(std::move(spec), registry, {options.threads, options.tile_size_m}, diagnostics);
  check_outputs(world, registry, diagnostics);
  diagnostics.throw_if_errors();
  Lint(world, base_types, diagnostics).check();
  check_conditions(world.spec(), registry, diagnostics);

  // By file and line. Findings about one line keep their order.
  std::multimap<std::pair<std::uint32_t, std::uint32_t>, std::string> texts;
  for (const Finding& finding : diagnostics.findings())
    texts.emplace(std::pair(finding.where.file, finding.where.line), diagnostics.text(finding));
  std::vector<std::string> lines;
  for (auto& [place, text] : texts) lines.push_back(std::move(text));
  for (const std::string& warning : plugins->warnings()) lines.push_back(warning);
  return lines;
}

}  // namespace troupe
