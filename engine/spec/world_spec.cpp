#include "engine/spec/world_spec.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>

namespace troupe::engine {
namespace {

using Report = std::function<void(Where, const std::string&)>;

/// Checks that the part and joint indices in a type are valid and that parents come before their children.
class TypeRules {
 public:
  TypeRules(const TypeSpec& type, std::size_t index, const Report& report)
      : type_(type), path_(fmt::format("types[{}]", index)), report_(report) {}

  void check() {
    if (type_.parts.empty()) return report_({}, path_ + ".parts: empty; a type needs at least one part");
    for (std::size_t p = 0; p < type_.parts.size(); ++p) {
      const PartSpec& part = type_.parts[p];
      if (part.parent >= std::max<std::size_t>(p, 1))
        error(part.where, fmt::format("parts[{}].parent", p), part.parent,
              p == 0 ? "must be 0 for the first part" : "must be the index of an earlier part");
      check_joint(part.where, fmt::format("parts[{}].joint", p), part.joint);
    }
    for (std::size_t j = 0; j < type_.joints.size(); ++j)
      if (type_.joints[j].parent < k_rigid || type_.joints[j].parent >= static_cast<std::int32_t>(j))
        error(type_.parts.front().where, fmt::format("joints[{}].parent", j), type_.joints[j].parent,
              "must be -1 (no parent) or the index of an earlier joint");
    for (std::size_t d = 0; d < type_.devices.size(); ++d) {
      const DeviceSpec& device = type_.devices[d];
      check_part(device.where, fmt::format("sensors[{}].part", d), device.part);
      check_joint(device.where, fmt::format("sensors[{}].joint", d), device.joint);
      check_joint(device.where, fmt::format("sensors[{}].moves", d), device.moves);
    }
    for (std::size_t c = 0; c < type_.controllers.size(); ++c)
      check_part(type_.controllers[c].where, fmt::format("controllers[{}].part", c),
                 type_.controllers[c].part);
  }

 private:
  template <class Index>
  void error(Where where, const std::string& member, Index found, std::string_view rule) const {
    report_(where, fmt::format("{}.{}: {}, found index {} (counted from 0)", path_, member, rule, found));
  }
  void check_joint(Where where, const std::string& member, std::int32_t joint) const {
    if (joint < k_rigid || joint >= static_cast<std::int32_t>(type_.joints.size()))
      error(where, member, joint,
            fmt::format("must be -1 (no joint) or the index of a joint; the type has {} joint{}",
                        type_.joints.size(), type_.joints.size() == 1 ? "" : "s"));
  }
  void check_part(Where where, const std::string& member, std::uint32_t part) const {
    if (part >= type_.parts.size())
      error(where, member, part,
            fmt::format("the type has {} part{}", type_.parts.size(), type_.parts.size() == 1 ? "" : "s"));
  }

  const TypeSpec& type_;
  std::string path_;
  const Report& report_;
};

/// Groups, scripts and converted files leave out body 0, so a robot or a wall must not be in its place.
void check_ground(const WorldSpec& spec, const Report& report) {
  const TypeSpec& type = spec.type(BodyId(0));
  const bool has_shape =
      std::ranges::any_of(type.parts, [](const PartSpec& part) { return !part.solids.empty(); });
  if (!type.drive && type.devices.empty() && type.controllers.empty() && !has_shape) return;
  report(spec.bodies.front().where,
         fmt::format("bodies[0]: must be the ground, which has no shape and does nothing: call add_ground() "
                     "before the first body is added; found \"{}\" of type \"{}\"",
                     spec.name(BodyId(0)), type.name));
}

void check_bodies(const WorldSpec& spec, const Report& report) {
  if (spec.bodies.empty()) report({}, "bodies: empty; body 0 of every world is the ground");
  const std::size_t words = spec.names.words().size();
  const std::size_t types = spec.types.size();
  const auto bad = std::ranges::find_if(spec.bodies, [types, words](const BodySpec& body) {
    return body.type.value >= types || body.name.word >= words;
  });
  if (bad != spec.bodies.end()) {
    const auto b = bad - spec.bodies.begin();
    return report(
        bad->where,
        bad->type.value >= types
            ? fmt::format("bodies[{}].type: the world has {} types, found index {} (counted from 0)", b,
                          types, bad->type.value)
            : fmt::format(
                  "bodies[{}].name: the list of name words has {} entries, found index {} (counted from 0)",
                  b, words, bad->name.word));
  }
  if (!spec.bodies.empty()) check_ground(spec, report);
  for (std::size_t a = 0; a < spec.aliases.size(); ++a) {
    if (spec.aliases[a].name.word >= words)
      return report(
          {}, fmt::format(
                  "aliases[{}].name: the list of name words has {} entries, found index {} (counted from 0)",
                  a, words, spec.aliases[a].name.word));
    if (spec.aliases[a].body.index() >= spec.bodies.size())
      return report(
          {}, fmt::format("aliases[{}].body: the world has {} bodies, found index {} (counted from 0)", a,
                          spec.bodies.size(), spec.aliases[a].body.value));
  }
}

void check_empty_populations(const WorldSpec& spec, const Report& report) {
  for (std::size_t p = 0; p < spec.empty_populations.size(); ++p)
    if (const TypeId type = spec.empty_populations[p].type; type.value >= spec.types.size())
      report({}, fmt::format("empty_populations[{}].type: the world has {} types, found index {} (counted "
                             "from 0)",
                             p, spec.types.size(), type.value));
}

void check_part_names(const WorldSpec& spec, const Report& report) {
  const auto has_part = [&](const PartName& place) {
    if (place.body.index() >= spec.bodies.size()) return false;
    const auto& parts = spec.type(place.body).parts;
    return std::ranges::find(parts, place.part, &PartSpec::name) != parts.end();
  };
  // The order of the map is not specified, so the error gives the alphabetically first name.
  const std::string* first = nullptr;
  for (const auto& [name, place] : spec.part_aliases)
    if (!has_part(place) && (!first || name < *first)) first = &name;
  if (first) report({}, fmt::format("part_names: \"{}\" refers to a part that does not exist", *first));
}

void check_reserves(const WorldSpec& spec, const Report& report) {
  std::size_t end = 1;  // the ground is always there
  for (std::size_t r = 0; r < spec.reserves.size(); ++r) {
    const ReserveSpec& reserve = spec.reserves[r];
    const std::size_t first = reserve.first.index();
    const std::size_t last = first + reserve.count;
    const auto error = [&](std::string_view what) {
      report({}, fmt::format("reserves[{}]: reserve \"{}\" {}", r, reserve.population, what));
    };
    if (reserve.count == 0) return error("has no bodies: give a `count` of 1 or more");
    if (last > spec.bodies.size())
      return error(fmt::format("refers to bodies {} to {}, but the world has {} bodies, counted from 0",
                               first, last - 1, spec.bodies.size()));
    if (first < end)
      return error(
          fmt::format("begins at body {}, but must begin at body {} or later (counted from 0): body 0 is the "
                      "ground, and each reserve must follow the bodies of the reserve before it",
                      first, end));
    for (std::size_t b = first; b < last; ++b)
      if (spec.bodies[b].type != spec.bodies[first].type)
        return error(fmt::format(
            "has bodies of the types \"{}\" and \"{}\"; all bodies of a reserve must have the same type",
            spec.type(BodyId(first)).name, spec.type(BodyId(b)).name));
    end = last;
  }
}

void check_interventions(const WorldSpec& spec, const Report& report) {
  for (std::size_t i = 0; i < spec.experiment.at.size(); ++i) {
    const InterventionSpec& at = spec.experiment.at[i];
    const auto error = [&](std::string_view what) {
      report(at.where, fmt::format("experiment.at[{}]{}", i, what));
    };
    if (at.action == InterventionSpec::Action::move && !at.pose)
      error(".pose: missing, but the action `move` needs the new pose of the body");
    if (at.action == InterventionSpec::Action::set && !at.setting)
      error(".setting: missing, but the action `set` needs the new parameters");
    if (!at.setting) continue;
    if (!has_params(spec.types, *at.setting))
      error(".setting: refers to a type, or to a drive, device or controller of a type, that does not exist");
  }
}

}  // namespace

bool has_params(std::span<const TypeSpec> types, const SettingSpec& setting) {
  if (setting.type.index() >= types.size()) return false;
  const TypeSpec& type = types[setting.type.index()];
  switch (setting.of) {
    case SettingSpec::Of::drive: return type.drive.has_value();
    case SettingSpec::Of::device: return setting.index < type.devices.size();
    case SettingSpec::Of::controller: break;
  }
  return setting.index < type.controllers.size();
}

Record& params_of(TypeSpec& type, const SettingSpec& setting) {
  switch (setting.of) {
    case SettingSpec::Of::drive: return type.drive->params;
    case SettingSpec::Of::device: return type.devices[setting.index].params;
    case SettingSpec::Of::controller: break;
  }
  return type.controllers[setting.index].params;
}

void check_rules(const WorldSpec& spec, const Report& report) {
  bool is_right = true;
  const Report note = [&](Where where, const std::string& message) {
    is_right = false;
    report(where, message);
  };
  for (std::size_t t = 0; t < spec.types.size(); ++t) TypeRules(spec.types[t], t, note).check();
  if (spec.bounds && spec.bounds->empty())
    note({}, fmt::format(
                 "bounds_m: found [{}, {}, {}, {}], where x_min exceeds x_max or y_min exceeds y_max; the "
                 "order is [x_min, y_min, x_max, y_max]",
                 spec.bounds->min.x(), spec.bounds->min.y(), spec.bounds->max.x(), spec.bounds->max.y()));
  check_bodies(spec, note);
  check_empty_populations(spec, note);
  if (!is_right) return;  // the following checks use the indices of bodies and types
  check_part_names(spec, note);
  check_reserves(spec, note);
  check_interventions(spec, note);
}

void add_ground(WorldSpec& spec) {
  TypeSpec type;
  type.name = "ground";
  type.parts.push_back(
      {.name = "", .kind = "model", .size = {0, 0, 0}, .returns = {.obstacle = false, .ranger = -1}});
  spec.types.push_back(std::move(type));
  spec.bodies.push_back({.name = spec.names.add("_ground_model"), .type = TypeId(spec.types.size() - 1)});
}

bool can_be_gripped(const TypeSpec& type) {
  return std::ranges::any_of(
      type.parts, [](const PartSpec& part) { return part.returns.gripper && !part.solids.empty(); });
}

bool is_static(const TypeSpec& type) {
  return !is_mobile(type) && !can_be_gripped(type) &&
         std::ranges::none_of(type.parts, [](const PartSpec& part) { return part.returns.pushable; });
}

double solids_radius(const TypeSpec& type) {
  double radius2 = 0;
  for (const PartSpec& part : type.parts)
    for (const Solid& solid : part.solids)
      for (const Ring& ring : solid.contours)
        for (const Vec2& v : ring) radius2 = std::max(radius2, v.squaredNorm());
  return sqrt(radius2);
}

bool is_below(const TypeSpec& type, std::uint32_t below, std::uint32_t part) {
  while (below > part) below = type.parts[below].parent;  // parents come before their children
  return below == part;
}

namespace {

/// The population that a body belongs to, and the number of the body in it.
struct Member {
  std::string population;
  std::uint32_t number = 0;
};

/// Returns the population of a body whose name has a number. The longest of `names` with which the name of
/// the body begins is the population, if only a number follows; else it is the word of the name.
Member member_of(const Names& table, Name name, const std::set<std::string, std::less<>>& names) {
  const std::string& word = table.words()[name.word];
  if (names.empty()) return {word, name.number};
  const std::string text = table.text(name);
  for (std::size_t end = text.size() - 1; end > word.size(); --end) {
    const bool is_number = text[end] != '0' || end + 1 == text.size();
    if (is_number && names.contains(text.substr(0, end)))
      return {text.substr(0, end), static_cast<std::uint32_t>(std::stoul(text.substr(end)))};
  }
  return {word, name.number};
}

}  // namespace

void add_spare(WorldSpec& spec, std::uint32_t count, std::span<const std::string> names) {
  struct Population {
    BodySpec like;           // its first body in the file
    std::uint32_t next = 0;  // number of the next body
    bool is_of_one_type = true;
  };
  const std::set<std::string, std::less<>> known(names.begin(), names.end());
  // By word, in the order in which words were added, and by name.
  std::map<std::pair<std::uint32_t, std::string>, Population> populations;
  NameMap taken;
  for (std::size_t b = 0; b < spec.bodies.size(); ++b) {
    const BodySpec& body = spec.bodies[b];
    taken.add(body.name, BodyId(b));
    if (body.name.number == Name::k_no_number || !is_mobile(spec.types[body.type.index()])) continue;
    const Member member = member_of(spec.names, body.name, known);
    Population& population =
        populations.try_emplace({body.name.word, member.population}, Population{.like = body}).first->second;
    population.is_of_one_type = population.is_of_one_type && population.like.type == body.type;
    population.next = std::max(population.next, member.number + 1);
  }
  std::set<std::string, std::less<>> reserved;  // populations with a reserve
  for (const ReserveSpec& reserve : spec.reserves) reserved.insert(reserve.population);
  for (const auto& [key, population] : populations) {
    const std::string& name = key.second;
    if (!population.is_of_one_type || !reserved.insert(name).second) continue;
    const std::size_t end = spec.bodies.size() + count;
    spec.reserves.push_back({name, BodyId(spec.bodies.size()), count});
    for (std::uint32_t number = population.next; spec.bodies.size() < end; ++number) {
      const Name added = spec.names.add(name, number);
      const BodyId id(spec.bodies.size());
      if (taken.add(added, id) != id) continue;  // another body has this name
      BodySpec& body = spec.bodies.emplace_back(population.like);
      body.name = added;
      body.pose_world_body = {0, 0, population.like.pose_world_body.z, 0};
    }
  }
}

}  // namespace troupe::engine
