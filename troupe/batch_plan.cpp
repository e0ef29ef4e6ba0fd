#include "base/diagnostics.hpp"
#include "engine/spec/names.hpp"
#include "engine/spec/ticks.hpp"
#include "engine/world/world.hpp"
#include "troupe/batch_impl.hpp"
#include "troupe/model_place.hpp"
#include "troupe/swarm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <stdexcept>
#include <string_view>

// The start of a BatchEnv: checks the spec, and looks up what its names refer to.

namespace troupe {
namespace {

constexpr std::size_t k_most_copies = 1'000'000;
constexpr std::size_t k_most_neighbours = 1000;

template <class Named>
void check_names(const std::vector<Named>& all, std::string_view what) {
  std::set<std::string_view> taken;
  for (const Named& each : all)
    if (!taken.insert(each.name).second)
      throw std::invalid_argument(
          fmt::format("{} \"{}\" occurs twice: names must be unique", what, each.name));
}

}  // namespace

void BatchEnv::Impl::refuse(const std::string& text) { throw std::invalid_argument(text); }

void BatchEnv::Impl::check_spec() const {
  if (spec.copies < 1 || spec.copies > k_most_copies)
    refuse(fmt::format("the batch has {} copies of the world: give 1 to {}", spec.copies, k_most_copies));
  if (spec.ticks < 1) refuse("a step of the batch has 0 ticks: give 1 or more");
  if (!(spec.seconds > 0 && spec.seconds <= engine::k_longest_run_s))
    refuse(fmt::format("episodes are {} s long: give a length above 0 s and at most {} s", spec.seconds,
                       engine::k_longest_run_s));
  if (spec.teams.empty()) refuse("the batch has no teams: give one or more");
  check_names(spec.teams, "team");
  for (const BatchTeam& team : spec.teams) check_team(team);
}

void BatchEnv::Impl::check_team(const BatchTeam& team) {
  check_names(team.arrays, fmt::format("team \"{}\": array", team.name));
  for (const BatchArraySpec& array : team.arrays) check_array(team, array);
  for (const BatchAction& action : team.actions)
    if (!std::isfinite(action.low) || !std::isfinite(action.high - action.low))
      refuse(
          fmt::format("action \"{}\" of team \"{}\": low is {}, high is {}: give finite numbers whose "
                      "difference is finite",
                      action.command, team.name, action.low, action.high));
  for (std::size_t a = 0; a < team.actions.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      if (team.actions[a].device == team.actions[b].device &&
          team.actions[a].command == team.actions[b].command)
        refuse(fmt::format(
            "actions {} and {} of team \"{}\" (counted from 0) both set the command \"{}\"{}: give each "
            "command one action",
            b, a, team.name, team.actions[a].command,
            team.actions[a].device.empty() ? " of the drive"
                                           : " of device \"" + team.actions[a].device + "\""));
  for (const BatchReward& reward : team.rewards)
    if (!std::isfinite(reward.weight))
      refuse(
          fmt::format("reward of team \"{}\": weight is {}: give a finite number", team.name, reward.weight));
  for (const BatchEnd& end : team.ends)
    if (std::isnan(end.below) || !std::isfinite(end.reward))
      refuse(
          fmt::format("end of team \"{}\": the threshold is {}, reward is {}: give a threshold that is a "
                      "number, and a finite reward",
                      team.name, end.below, end.reward));
}

void BatchEnv::Impl::check_array(const BatchTeam& team, const BatchArraySpec& array) {
  if (array.parts.empty())
    refuse(fmt::format("array \"{}\" of team \"{}\" has no parts: give one or more", array.name, team.name));
  if (array.raw && (array.parts.size() != 1 || array.parts.front().of != Of::reading))
    refuse(
        fmt::format("array \"{}\" of team \"{}\": an array with \"raw\" must have exactly one part, "
                    "whose source is reading",
                    array.name, team.name));
  for (const BatchPart& part : array.parts) {
    if (part.of == Of::nearest && (part.count < 1 || part.count > k_most_neighbours))
      refuse(fmt::format("array \"{}\" of team \"{}\": the part \"nearest\" has the count {}: give 1 to {}",
                         array.name, team.name, part.count, k_most_neighbours));
    if (!(part.range_m > 0))
      refuse(fmt::format("array \"{}\" of team \"{}\": range_m is {}: give a distance above 0", array.name,
                         team.name, part.range_m));
    if (!std::isfinite(part.scale))
      refuse(fmt::format("array \"{}\" of team \"{}\": scale is {}: give a finite number", array.name,
                         team.name, part.scale));
  }
}

/// Finds the bodies of each entry of BatchSpec::starts.
void BatchEnv::Impl::plan_starts(const engine::World& world) {
  const engine::WorldSpec& own = world.spec();
  std::set<BodyId> taken;
  for (const std::string& name : spec.starts) {
    StartData& start = starts.emplace_back();
    start.name = name;
    // If "goal1" is a model (of population "goal"), the name does not also stand for goal10 to goal19.
    const BodyId one = world.state().names.find(name);
    for (std::size_t b = 0; b < own.bodies.size(); ++b) {
      const bool is_meant = one.valid() ? BodyId(b) == one
                                        : world.view().type(BodyId(b)).name == name ||
                                              engine::is_of_population(own.names, own.bodies[b].name, name);
      if (is_meant) start.bodies.emplace_back(b);
    }
    if (start.bodies.empty())
      throw std::out_of_range(
          fmt::format("starts: the world has no model, population or type \"{}\" with bodies", name));
    for (const BodyId body : start.bodies)
      if (!taken.insert(body).second)
        refuse(fmt::format("starts: \"{}\" is in two entries: list each body once", own.name(body)));
    start.poses.resize(spec.copies * start.bodies.size() * k_start_columns,
                       std::numeric_limits<double>::quiet_NaN());
  }
}

/// Determines the columns, actions, rewards and ends of a team from its first robot. `first` is the first
/// copy. The other robots may have other types if their observed fields and commands are the same; bind()
/// checks this.
void BatchEnv::Impl::plan(TeamData& team, Copy& first) {
  const BatchTeam& own = *team.spec;
  Simulation& simulation = first.simulation;
  const BodyId robot = first.teams.back().ids.front();
  std::array<std::size_t, 3> of_kind{};
  for (const BatchArraySpec& wanted : own.arrays) {
    ArrayData& array = team.arrays.emplace_back();
    array.name = wanted.name;
    for (const BatchPart& each : wanted.parts) {
      Part part = plan(each, simulation, robot);
      if (each.of == Of::reading) part.of_kind = of_kind[0]++;
      if (each.of == Of::nearest) part.of_kind = of_kind[1]++;
      if (each.of == Of::target) part.of_kind = of_kind[2]++;
      array.columns += part.columns;
      if (wanted.raw) array.element = part.element;
      array.parts.push_back(part);
    }
    array.bytes.resize(spec.copies * team.robots * array.row_bytes());
  }
  plan_actions(team, simulation, robot);
  for (const BatchReward& reward : own.rewards) team.rewards_of.push_back(find(team, reward.of, "reward"));
  for (const BatchEnd& end : own.ends) team.ends_of.push_back(find(team, end.of, "end"));
  const std::size_t robots = spec.copies * team.robots;
  team.actions.resize(robots * own.actions.size());
  team.rewards.resize(robots);
  team.terminated.resize(robots);
  team.alive.resize(robots);
}

BatchEnv::Impl::Part BatchEnv::Impl::plan(const BatchPart& part, Simulation& simulation, BodyId robot) const {
  Part out{.spec = &part};
  switch (part.of) {
    case Of::reading: {
      const engine::StateField& field = *simulation.model(robot).reading(part.field, part.device).field;
      out.columns = field.columns;
      out.element = field.element;
      break;
    }
    case Of::pose:
    case Of::estimate: out.columns = 4; break;
    case Of::speed: out.columns = 3; break;
    case Of::stalled:
    case Of::time_left: out.columns = 1; break;
    case Of::nearest: out.columns = BatchPart::k_neighbour * part.count; break;
    case Of::target: out.columns = 3; break;
  }
  return out;
}

void BatchEnv::Impl::plan_actions(TeamData& team, Simulation& simulation, BodyId robot) const {
  const bool has_drive =
      simulation.world().view().type(simulation.world().view().row(robot)).drive.has_value();
  for (const BatchAction& action : team.spec->actions) {
    if (action.device.empty())
      plan_drive_action(action, has_drive, team);
    else
      plan_device_action(action, simulation.model(robot).command_fields(action.device), team);
  }
}

void BatchEnv::Impl::plan_drive_action(const BatchAction& action, bool has_drive, TeamData& team) {
  constexpr std::array<std::string_view, k_drive> k_commands{"forward", "left", "turn"};
  const auto found = std::ranges::find(k_commands, action.command);
  if (found == k_commands.end())
    throw std::out_of_range(
        fmt::format("team \"{}\": an action without a device commands the drive: {}", team.spec->name,
                    unknown_name("command", action.command, {k_commands.begin(), k_commands.end()})));
  if (!has_drive)
    refuse(
        fmt::format("team \"{}\": an action without a device commands the drive, but the robots have "
                    "no drive: give the action a device",
                    team.spec->name));
  team.drives = true;
  team.actions_plan.push_back({.command = static_cast<std::size_t>(found - k_commands.begin()),
                               .low = action.low,
                               .span = action.high - action.low});
}

/// Appends to TeamData::actions_plan an action that sets a field of the command of a device. fields: the
/// fields of this command.
void BatchEnv::Impl::plan_device_action(const BatchAction& action, std::span<const engine::StateField> fields,
                                        TeamData& team) {
  const engine::StateField& field =
      command_field(fields, action.command, fmt::format("device \"{}\"", action.device));
  if (field.columns != 1)
    refuse(
        fmt::format("command \"{}\" of device \"{}\" has {} numbers, but an action sets only one: give "
                    "a command with one number",
                    action.command, action.device, field.columns));
  const auto of_devices = std::ranges::count_if(
      team.actions_plan, [](const Action& before) { return before.command >= k_drive; });
  team.actions_plan.push_back({.command = k_drive + static_cast<std::size_t>(of_devices),
                               .element = field.element,
                               .is_bool = field.is_bool,
                               .low = action.low,
                               .span = action.high - action.low});
}

BatchEnv::Impl::Column BatchEnv::Impl::find(const TeamData& team, const BatchColumn& column,
                                            std::string_view what) const {
  if (column.array.empty()) {
    if (const std::optional<Measures>& known = copies.front()->measures)
      if (const std::optional<std::size_t> m = known->find(column.measure))
        return {.column = *m, .of_measure = true};
    if (column.measure.empty())
      refuse(
          fmt::format("{} of team \"{}\": has neither an array nor a measure: give the name of an array and "
                      "a column, or the name of a measure",
                      what, team.spec->name));
    const std::vector<std::string_view> listed(measure_columns.begin(), measure_columns.end());
    throw std::out_of_range(fmt::format(
        "{} of team \"{}\": the measure \"{}\" is not in the list `measures` of the task, which {}{}: add it "
        "there",
        what, team.spec->name, column.measure, listed.empty() ? "is empty" : "contains " + comma_list(listed),
        did_you_mean(column.measure, listed)));
  }
  const std::size_t index = array_index(team, column.array);
  const ArrayData& array = team.arrays[index];
  if (column.column >= array.columns)
    refuse(fmt::format(
        "{} of team \"{}\": there is no column {} in array \"{}\", which has {} columns, counted from 0",
        what, team.spec->name, column.column, column.array, array.columns));
  return {index, column.column, false};
}

std::size_t BatchEnv::Impl::array_index(const TeamData& team, std::string_view name) {
  const auto found = std::ranges::find(team.arrays, name, &ArrayData::name);
  if (found == team.arrays.end())
    throw std::out_of_range(
        fmt::format("team \"{}\": {}", team.spec->name, unknown_name("array", name, name_list(team.arrays))));
  return static_cast<std::size_t>(found - team.arrays.begin());
}

/// Looks up what the columns and actions of a team refer to in one copy of the world, and stores the result
/// in `bound`: the fields of readings and commands, and the ids of possible neighbours and targets. Throws if
/// a name is unknown, if a robot cannot carry out an action, or if a field differs from robot to robot.
void BatchEnv::Impl::bind(const TeamData& team, Copy& copy, TeamCopy& bound) {
  engine::World& world = copy.simulation.world();
  std::vector<Model> robots;
  for (const BodyId id : bound.ids) robots.push_back(copy.simulation.model(id));
  for (const ArrayData& array : team.arrays)
    for (const Part& part : array.parts) {
      if (part.spec->of == Of::reading) bind_readings(team, part, robots, world, bound);
      if (part.spec->of == Of::nearest) {
        const Swarm swarm = copy.simulation.swarm(part.spec->name);  // throws for an unknown name
        bound.groups.emplace_back(swarm.ids().begin(), swarm.ids().end());
      }
      if (part.spec->of == Of::target) bound.targets.push_back(targets_of(team, *part.spec, robots, world));
    }
  bind_commands(team, robots, world, bound);
  for (const BodyId id : bound.ids)
    if (team.drives && !world.view().type(world.view().row(id)).drive)
      refuse(
          fmt::format("robot \"{}\" of team \"{}\" has no drive, but an action of the team commands the "
                      "drive: put the robot in another team",
                      world.spec().name(id), team.spec->name));
  bound.before.resize(team.rewards_of.size() * robots.size());
  bound.was_terminated.resize(robots.size());
  bound.was_alive.resize(robots.size());
}

void BatchEnv::Impl::bind_readings(const TeamData& team, const Part& part, const std::vector<Model>& robots,
                                   const engine::World& world, TeamCopy& bound) {
  for (const Model& robot : robots) {
    const Model::Reading reading = robot.reading(part.spec->field, part.spec->device);
    if (reading.field->columns != part.columns || reading.field->element != part.element)
      refuse(
          fmt::format("robots of team \"{0}\" differ in field \"{1}\": \"{4}\" has {2} values of type "
                      "{3}, \"{7}\" has {5} of type {6}; make two teams",
                      team.spec->name, part.spec->field, part.columns, engine::element_name(part.element),
                      team.names.front(), reading.field->columns,
                      engine::element_name(reading.field->element), robot.name()));
    // The device is the one whose table of readings has this field.
    const std::size_t before = bound.readings.size();
    for (const engine::BodyType::Device& device : world.view().type(world.view().row(robot.id())).devices) {
      const std::span<const engine::StateField> fields = world.tables()[device.table].fields();
      for (std::size_t f = 0; f < fields.size(); ++f)
        if (&fields[f] == reading.field) bound.readings.push_back({&device, f});
    }
    if (bound.readings.size() == before)
      refuse(
          fmt::format("team \"{}\" observes \"{}\", the memory of a controller, but the controllers of its "
                      "robots do not run: give the name of a device",
                      team.spec->name, part.spec->device));
  }
}

/// Returns the targets of a part `target` (BatchPart::name): the body of this name, as the only element, or,
/// if there is no such body, one body per robot, whose name ends in the number of the robot.
std::vector<BodyId> BatchEnv::Impl::targets_of(const TeamData& team, const BatchPart& part,
                                               const std::vector<Model>& robots, const engine::World& world) {
  if (const BodyId one = world.state().names.find(part.name); one.valid()) return {one};
  std::vector<BodyId> targets;
  for (const Model& robot : robots) {
    const std::string& name = robot.name();
    const std::size_t digits = engine::without_number(name).size();
    const std::string target = part.name + name.substr(digits);
    const BodyId own = digits < name.size() ? world.state().names.find(target) : BodyId();
    if (!own.valid() && part.name.empty())
      refuse(fmt::format("team \"{}\": a part \"target\" has no name: give the name of its target",
                         team.spec->name));
    if (!own.valid())
      throw std::out_of_range(fmt::format(
          "team \"{}\": there is no model \"{}\", which would be the target of robot \"{}\"; give the "
          "name of one model for all robots, or the name without its number, such as \"goal\" if robot "
          "0 has the target goal0, robot 1 the target goal1, ...",
          team.spec->name, target, name));
    targets.push_back(own);
  }
  return targets;
}

void BatchEnv::Impl::bind_commands(const TeamData& team, std::vector<Model>& robots,
                                   const engine::World& world, TeamCopy& bound) {
  for (std::size_t a = 0; a < team.actions_plan.size(); ++a) {
    const BatchAction& action = team.spec->actions[a];
    if (team.actions_plan[a].command < k_drive) continue;
    for (Model& robot : robots) {
      const std::span<const engine::StateField> fields = robot.command_fields(action.device);
      const engine::StateField* const field = engine::field_named(fields, action.command);
      if (field == nullptr || field->element != team.actions_plan[a].element)
        refuse(fmt::format(
            "robots of team \"{}\" differ: each robot must have the command \"{}\" of device \"{}\", "
            "and the numbers of this command must be of the same type in all robots; make two teams",
            team.spec->name, action.command, action.device));
      // Find the device to whose command `fields` belongs.
      for (const engine::BodyType::Device& device : world.view().type(world.view().row(robot.id())).devices)
        if (device.prepared.commands.data() == fields.data())
          bound.commands.push_back({&device, field->offset});
    }
  }
}

}  // namespace troupe
