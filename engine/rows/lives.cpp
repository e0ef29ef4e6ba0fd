#include "engine/rows/lives.hpp"

#include "base/sort.hpp"
#include "engine/kinds/finite.hpp"
#include "engine/rows/starting.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

namespace troupe::engine {

void Lives::build() {
  for (std::size_t b = 0; b < state_.spec.bodies.size(); ++b)
    robots_at_start_ += state_.type(BodyId(b)).drive.has_value() && state_.spec.starts(BodyId(b));
  const auto ends_lives = [](const BodyType& type) {
    return std::ranges::any_of(type.devices,
                               [](const BodyType::Device& device) { return device.prepared.ends_lives; });
  };
  const bool experiment_ends_them = std::ranges::any_of(state_.spec.experiment.at, [](const auto& at) {
    return at.action == InterventionSpec::Action::remove;
  });
  if (state_.spec.reserves.empty() && !state_.spec.mortal && !experiment_ends_them &&
      std::ranges::none_of(state_.types, ends_lives))
    return;
  state_.life_table = state_.tables.size();
  state_.tables.emplace_back(
      "life", HashGroup::pose, StateTable::Layout::rows,
      sparse({{"birth", Element::u64, 1, "",
               "number of ticks completed when the body was born; 0: present from the start or not yet born",
               offsetof(Life, birth)},
              {"x", Element::f64, 1, "m", "position at birth, world frame; 0 if present from the start",
               offsetof(Life, x)},
              {"y", Element::f64, 1, "m", "position at birth, world frame; 0 if present from the start",
               offsetof(Life, y)},
              {"presence", Element::u8, 1, "", "0: in the world, 1: not yet born, 2: dead",
               offsetof(Life, presence)}}),
      state_.bodies, sizeof(Life));
  next_born_.resize(state_.spec.reserves.size());
  std::size_t most = 0;
  for (const ReserveSpec& reserve : state_.spec.reserves) most += reserve.count;
  places_.newborn().reserve(most);
  if (state_.spec.ranging == RangingEngine::grid) state_.not_drawn.resize(state_.row_count());
}

void Lives::start() {
  for (std::size_t r = 0; r < state_.row_count(); ++r) {
    const BodyId body = state_.bodies[r];
    if (state_.spec.starts(body))
      engine::start(state_, Row(r), state_.spec.bodies[body.index()].pose_world_body);
    else
      state_.life(Row(r)).presence = static_cast<std::uint8_t>(Presence::unborn);
  }
}

bool Lives::hold(std::uint64_t tick) const {
  if (!state_.life_table) return true;
  const StateTable& lives = state_.tables[*state_.life_table];
  for (std::size_t r = 0; r < state_.row_count(); ++r) {
    const Life& life = lives.as<Life>(r);
    if (life.birth > tick || life.presence > static_cast<std::uint8_t>(Presence::dead) ||
        !std::isfinite(life.x) || !std::isfinite(life.y))
      return false;
    if (life.presence == static_cast<std::uint8_t>(Presence::there)) continue;
    if (state_.carrier_table && state_.tables[*state_.carrier_table].as<Carried>(r).carrier != 0)
      return false;
    if (state_.view.presence(Row(r)) == Presence::unborn && state_.spec.starts(state_.bodies[r]))
      return false;
  }
  for (std::size_t r = 0; state_.carrier_table && r < state_.row_count(); ++r) {
    const std::uint32_t id = state_.tables[*state_.carrier_table].as<Carried>(r).carrier;
    const Row by = id == 0 || id > state_.rows.size() ? Row() : state_.view.row(BodyId(id - 1));
    if (by.valid() && state_.view.presence(by) != Presence::there) return false;
  }
  // Bodies of a reserve are born in the order of their ids.
  for (const ReserveSpec& reserve : state_.spec.reserves)
    for (std::uint32_t i = 1; i < reserve.count; ++i) {
      const BodyId id(reserve.first.index() + i);
      if (state_.view.presence(state_.view.row(BodyId(id.index() - 1))) == Presence::unborn &&
          state_.view.presence(state_.view.row(id)) != Presence::unborn)
        return false;
    }
  return true;
}

void Lives::derive() {
  places_.newborn().clear();
  count_present();
  for (std::size_t i = 0; i < state_.spec.reserves.size(); ++i) {
    const ReserveSpec& reserve = state_.spec.reserves[i];
    const auto is_born = [&](std::uint32_t number) {
      const BodyId id(reserve.first.index() + number);
      return state_.view.location(id) == RowLocation::here &&
             state_.view.presence(state_.view.row(id)) != Presence::unborn;
    };
    std::uint32_t& next = next_born_[i];
    next = 0;
    while (next < reserve.count && is_born(next)) ++next;
  }
}

void Lives::count_present() {
  state_.now.absent = 0;
  robots_ = robots_at_start_;
  if (!state_.life_table) return;
  robots_ = 0;
  for (std::size_t r = 0; r < state_.row_count(); ++r) {
    const bool there = state_.view.presence(Row(r)) == Presence::there;
    state_.now.absent += !there;
    robots_ += there && r < state_.own_rows && state_.type(Row(r)).drive;
  }
}

void Lives::forget() {
  constexpr std::uint32_t k_junk = 0x5a5a5a5a;
  std::ranges::fill(next_born_, k_junk);
  robots_ = state_.now.absent = k_junk;
}

void Lives::set_births(std::span<const std::uint32_t> births) {
  std::ranges::copy(births, next_born_.begin());
}

BodyId Lives::next_unborn(std::size_t reserve) const {
  return BodyId(state_.spec.reserves[reserve].first.index() + next_born_[reserve]);
}

Birth Lives::give_birth(std::size_t reserve, std::uint32_t trials, const Place& place) {
  if (unborn(reserve) == 0) return {BirthStatus::used_up, {}};
  const BodyId id = next_unborn(reserve);
  const BodyType& type = state_.type(id);
  // If bodies with joints can be born, no row is elsewhere (why_replicated()), so a body with joints has a
  // valid row. Its shape depends on the poses of its joints at birth, so it enters the world before its shape
  // is used.
  const Row row = state_.view.location(id) == RowLocation::here ? state_.view.row(id) : Row();
  if (!type.joints.empty()) enter(row, {});
  const partition::ObstacleShape& shape = type.joints.empty() ? type.obstacle : *state_.shapes[row.index()];
  const std::uint32_t trial = first_free(id, shape, trials, place);
  if (!type.joints.empty()) leave(row);
  if (trial == trials) return {BirthStatus::occupied, {}};
  const Pose pose = canonical(place(trial));
  const auto enter_here = [&] {
    if (!row.valid()) return;
    enter(row, pose);
    Life& life = state_.life(row);
    life.birth = state_.now.tick;
    life.x = pose.x;
    life.y = pose.y;
    if (row.index() < state_.own_rows) robots_ += type.drive.has_value();
  };
  ranks_->attempt(std::ref(enter_here));  // a reference, so that std::function allocates no memory
  places_.newborn().push_back({id, pose});
  ++next_born_[reserve];
  return {BirthStatus::born, id};
}

void Lives::follow_newborn() {
  ranks_->follow_jumps();
  places_.index_newborn();
}

/// Returns the lowest trial whose pose place(trial) is free for an unborn body with this shape; `trials` if
/// there is none. If the rows are distributed among ranks, each rank tests only the poses in its own part of
/// the plane, and all ranks return the lowest trial that any rank has found.
std::uint32_t Lives::first_free(BodyId id, const partition::ObstacleShape& shape, std::uint32_t trials,
                                const Place& place) const {
  std::uint32_t first = trials;
  for (std::uint32_t trial = 0; trial < trials && first == trials; ++trial) {
    const Pose pose = place(trial);
    const bool is_tested = is_finite(pose) && ranks_->tests_places_at(pose.position());
    if (is_tested && places_.is_free(id, shape, canonical(pose))) first = trial;
  }
  return ranks_->lowest_trial(first, trials);
}

/// Puts an unborn body into the world at this pose, with the state that a body has at tick 0.
void Lives::enter(Row row, const Pose& pose) {
  // A program may have set the commands of the unborn body.
  state_.tables[WorldState::k_command].clear_row(row.index());
  for (const BodyType::Device& device : state_.type(row).devices)
    if (device.command_table) state_.tables[*device.command_table].clear_row(state_.slots[row.index()]);
  state_.life(row).presence = static_cast<std::uint8_t>(Presence::there);
  --state_.now.absent;
  engine::start(state_, row, pose);
  places_.derive(row);
}

/// Undoes enter(): the body is unborn again.
void Lives::leave(Row row) {
  state_.clear(row);
  state_.life(row).presence = static_cast<std::uint8_t>(Presence::unborn);
  ++state_.now.absent;
  places_.derive(row);
}

void Lives::die(Row row) {
  if (!state_.view.is_there(row)) return;
  if (links_.any()) {
    links_.release(row);
    while (links_.first_cargo(row) != Links::k_none) links_.release(Row(links_.first_cargo(row)));
  }
  const Pose pose = state_.poses()[row.index()];
  const Life life = state_.life(row);
  if (state_.now.impaired > 0) state_.now.impaired -= !state_.condition(row).is_sound();
  state_.clear(row);
  state_.poses()[row.index()] = pose;
  state_.life(row) = life;
  state_.life(row).presence = static_cast<std::uint8_t>(Presence::dead);
  ++state_.now.absent;
  if (row.index() < state_.own_rows) robots_ -= state_.type(row).drive.has_value();
  places_.derive(row);
}

void Lives::resolve(std::span<const Effect> effects, const Born& born) {
  const auto is_here = [&](BodyId body) { return state_.view.location(body) == RowLocation::here; };
  for (const Effect& effect : effects)
    if (effect.verb == k_death && effect.target.index() < state_.rows.size() && is_here(effect.target))
      die(state_.view.row(effect.target));
  std::optional<std::vector<BodyId>> dead;  // sorted; needed only for bodies whose rows are elsewhere
  const auto has_died = [&](BodyId source) {
    if (is_here(source)) return !state_.view.is_there(state_.view.row(source));
    if (!dead) {
      dead.emplace();
      for (const Effect& effect : effects)
        if (effect.verb == k_death) dead->push_back(effect.target);
      sort_ids(*dead);
    }
    return std::ranges::binary_search(*dead, source);
  };
  bool is_indexed = false;
  for (const Effect& effect : effects) {
    if (effect.verb != k_birth || has_died(effect.source)) continue;
    // The index still has the poses from before the motions of this tick, and the bodies that have died.
    // In a distributed world, the rows of newborn_ may be on other ranks, so they stay out of the index.
    if (unborn(effect.reserve) > 0 &&
        (!is_indexed || (!ranks_->are_distributed() && places_.has_many_newborn()))) {
      places_.index_newborn();
      is_indexed = true;
    }
    const auto [x, y, z, heading] = effect.payload;
    const Pose pose{x, y, z, heading};
    const Birth birth = give_birth(effect.reserve, 1, [&pose](std::uint32_t) { return pose; });
    const auto tell = [&] {
      if (is_here(effect.source)) born(effect, birth);
    };
    ranks_->attempt(std::ref(tell));
  }
  ranks_->end_attempts();
  movement_.count_stalls();
}

}  // namespace troupe::engine
