#include "engine/kinds/step_error.hpp"
#include "engine/world/world.hpp"
#include "troupe/batch_impl.hpp"

#include <fmt/format.h>

#include <cmath>

// Rewards of the robots of a BatchEnv, and the ends of their episodes.

namespace troupe {

/// Computes the rewards of copy c, and which of its robots are finished, from the arrays that observe() has
/// filled. has_stepped: false at the beginning of an episode; the rewards are then 0 and no end is tested.
void BatchEnv::Impl::judge(std::size_t c, bool has_stepped) {
  Copy& copy = *copies[c];
  const engine::World& world = copy.simulation.world();
  const bool has_stopped = has_stepped && copy.simulation.stopped().has_value();
  for (std::size_t t = 0; t < teams.size(); ++t) {
    TeamData& team = teams[t];
    TeamCopy& bound = copy.teams[t];
    for (std::size_t i = 0; i < team.robots; ++i) {
      const std::size_t at = c * team.robots + i;
      const bool is_alive = team.alive[at] != 0;
      const bool is_dead = world.view().presence(world.view().row(bound.ids[i])) == engine::Presence::dead;
      const bool was_finished = has_stepped && bound.was_terminated[i] != 0;
      const bool counts = has_stepped && is_alive && !was_finished;
      const double reward = take_reward(team, bound, c, i, counts);
      const std::optional<double> end =
          has_stepped && is_alive ? end_reward(team, reward, c, i) : std::nullopt;
      team.rewards[at] = counts ? end.value_or(reward) : 0;
      team.terminated[at] = has_stopped || is_dead || end || was_finished;
      bound.was_alive[i] = is_alive;
    }
  }
  truncated[c] = copy.simulation.tick() >= copy.last_tick;
}

/// Returns the sum of the reward terms of a team for its robot i in copy c. Stores the rewarded numbers,
/// because the next step may reward their changes. counts: whether the robot gets the sum. Throws
/// engine::StepError if it does and a term is not finite.
double BatchEnv::Impl::take_reward(const TeamData& team, TeamCopy& bound, std::size_t c, std::size_t i,
                                   bool counts) const {
  double reward = 0;
  for (std::size_t r = 0; r < team.rewards_of.size(); ++r) {
    const BatchReward& term = team.spec->rewards[r];
    const double now = value(team, team.rewards_of[r], c, i);
    double& before = bound.before[r * team.robots + i];
    const double change = bound.was_alive[i] != 0 ? now - before : 0;
    const double rewarded = term.change ? change : now;
    if (counts && !std::isfinite(rewarded)) refuse_reward(team, r, c, i, rewarded);
    reward += term.weight * rewarded;
    before = now;
  }
  return reward;
}

/// Throws engine::StepError for the reward term r of a team, which has no finite value for robot i in copy c.
void BatchEnv::Impl::refuse_reward(const TeamData& team, std::size_t r, std::size_t c, std::size_t i,
                                   double value) const {
  const BatchReward& term = team.spec->rewards[r];
  const std::string of = term.of.array.empty()
                             ? fmt::format("measure \"{}\"", measure_columns[team.rewards_of[r].column])
                             : fmt::format("column {} of array \"{}\"", term.of.column, term.of.array);
  throw engine::StepError(
      fmt::format("reward {} of team \"{}\": {} {} is {} for robot \"{}\" in copy {} at tick {} (reward, "
                  "column and copy are counted from 0): reward a number that is finite in every step",
                  r, team.spec->name, term.change ? "the change of" : "the value of", of, value,
                  team.names[i], c, copies[c]->simulation.tick()));
}

/// Returns `reward` plus the rewards of all ends (BatchEnd) that hold for robot i of a team in copy c;
/// std::nullopt if no end holds.
std::optional<double> BatchEnv::Impl::end_reward(const TeamData& team, double reward, std::size_t c,
                                                 std::size_t i) const {
  bool has_ended = false;
  for (std::size_t e = 0; e < team.ends_of.size(); ++e) {
    const BatchEnd& end = team.spec->ends[e];
    const double now = value(team, team.ends_of[e], c, i);
    if (!(end.is_above ? now > end.below : now < end.below)) continue;
    has_ended = true;
    reward += end.reward;
  }
  return has_ended ? std::optional(reward) : std::nullopt;
}

}  // namespace troupe
