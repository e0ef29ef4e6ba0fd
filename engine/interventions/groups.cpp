#include "engine/interventions/groups.hpp"

#include "base/sort.hpp"
#include "engine/spec/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <set>

namespace troupe::engine {

using By = GroupSpec::By;

Groups::Bodies Groups::find(const GroupSpec& group, Where where, Diagnostics& diagnostics) {
  Found& found = found_[{group.by, group.name}];
  if (!found.bodies) {
    found.bodies = std::make_shared<const std::vector<BodyId>>(bodies_of(group));
    if (found.bodies->empty() && !may_be_empty(group)) found.error = text_of_unknown(group);
  }
  if (!found.error.empty()) diagnostics.error(where, found.error);
  return found.bodies;
}

std::optional<std::size_t> Groups::reserve(std::string_view population) {
  const std::vector<ReserveSpec>& reserves = state_.spec.reserves;
  if (reserves_.empty())
    for (std::size_t i = 0; i < reserves.size(); ++i) reserves_.emplace(reserves[i].population, i);
  const auto found = reserves_.find(population);
  return found == reserves_.end() ? std::nullopt : std::optional(found->second);
}

/// Whether a body, which may be static, belongs to a group.
bool Groups::is_in(const GroupSpec& group, BodyId body) const {
  const WorldSpec& spec = state_.spec;
  switch (group.by) {
    case By::population: return is_of_population(spec.names, spec.bodies[body.index()].name, group.name);
    case By::type: return state_.type(body).name == group.name;
    case By::model: break;
  }
  return state_.names.find(group.name) == body;
}

std::vector<BodyId> Groups::bodies_of(const GroupSpec& group) {
  const auto has_row = [&](BodyId body) { return state_.view.location(body) != RowLocation::none; };
  std::vector<BodyId> bodies;
  if (group.by == By::model) {
    if (const BodyId body = state_.names.find(group.name); body.valid() && has_row(body))
      bodies.push_back(body);
    return bodies;
  }
  const WorldSpec& spec = state_.spec;
  Index& index = indices_[group.by];
  if (index.empty())
    for (std::size_t b = 1; b < spec.bodies.size(); ++b)  // body 0 is the ground
      if (has_row(BodyId(b)))
        index[group.by == By::type ? std::string_view(state_.type(BodyId(b)).name)
                                   : spec.names.words()[spec.bodies[b].name.word]]
            .push_back(BodyId(b));
  const auto add = [&](const std::vector<BodyId>& some) {
    std::ranges::copy_if(some, std::back_inserter(bodies), [&](BodyId body) { return is_in(group, body); });
  };
  if (const auto same = index.find(group.name); same != index.end()) add(same->second);
  if (group.by == By::type) return bodies;
  // The word of a body is its name without its number, which has at most nine digits (Names). The word may
  // therefore lack digits of the population's name, or have digits of the body's number in the population.
  for (std::string_view word = group.name; without_number(word) != word;) {
    word.remove_suffix(1);
    if (const auto shorter = index.find(word); shorter != index.end()) add(shorter->second);
  }
  for (auto longer = index.upper_bound(group.name);
       longer != index.end() && longer->first.starts_with(group.name); ++longer)
    add(longer->second);
  sort_ids(bodies);
  return bodies;
}

/// Whether a group without bodies is no error. The option --robots, for example, can remove all bodies of a
/// type.
bool Groups::may_be_empty(const GroupSpec& group) const {
  if (group.by == By::type)
    return std::ranges::any_of(state_.types,
                               [&](const BodyType& type) { return type.runs() && type.name == group.name; });
  return group.by == By::population &&
         std::ranges::count(state_.spec.empty_populations, group.name, &EmptyPopulation::name) > 0;
}

/// Whether a group in which all bodies are static has any bodies.
bool Groups::is_static(const GroupSpec& group) const {
  std::size_t first = 1;  // body 0 is the ground
  if (group.by == By::model) {
    const BodyId body = state_.names.find(group.name);
    return body.valid() && body.index() >= first;
  }
  const std::size_t bodies = state_.spec.bodies.size();
  while (first < bodies && !is_in(group, BodyId(first))) ++first;
  return first < bodies;
}

/// The names of the populations, types or models that have bodies that are not static, and of the populations
/// that may be empty.
const std::vector<std::string>& Groups::known_names(By by) {
  const auto [place, is_new] = known_.try_emplace(by);
  if (!is_new) return place->second;
  const WorldSpec& spec = state_.spec;
  std::set<std::string, std::less<>> known;
  if (by == By::population)
    for (const EmptyPopulation& population : spec.empty_populations) known.insert(population.name);
  for (std::size_t b = 1; b < spec.bodies.size(); ++b) {
    if (state_.view.location(BodyId(b)) == RowLocation::none) continue;
    const std::string name = spec.name(BodyId(b));
    if (by == By::type) known.insert(state_.type(BodyId(b)).name);
    if (by == By::model) known.insert(name);
    const std::string_view population = without_number(name);  // empty if the name is a number
    if (by == By::population && !population.empty() && population.size() < name.size())
      known.emplace(population);
  }
  place->second.assign(known.begin(), known.end());
  return place->second;
}

std::string Groups::text_of_unknown(const GroupSpec& group) {
  constexpr std::array<std::string_view, 3> k_what{"population", "type", "model"};
  const std::string_view what = k_what[static_cast<std::size_t>(group.by)];
  if (is_static(group))
    return fmt::format(
        "{}: interventions and faults can only act on bodies that can move, sense, decide, be gripped or be "
        "pushed",
        group.by == By::model ? fmt::format("\"{}\" is a static body", group.name)
                              : fmt::format("the bodies of the {} \"{}\" are static", what, group.name));
  const std::vector<std::string>& known = known_names(group.by);
  return unknown_name(what, group.name, std::vector<std::string_view>(known.begin(), known.end()));
}

}  // namespace troupe::engine
