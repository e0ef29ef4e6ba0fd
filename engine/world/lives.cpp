#include "base/fp_environment.hpp"
#include "base/sort.hpp"
#include "engine/kinds/finite.hpp"
#include "engine/ranks/replica.hpp"
#include "engine/world/kind_errors.hpp"
#include "engine/world/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <stdexcept>

namespace troupe::engine {

void World::build_lives() {
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
  newborn_.reserve(most);
  if (state_.spec.ranging == RangingEngine::grid) state_.not_drawn.resize(rows());
}

/// Whether the component `life` is consistent with itself, with the tick and with the component `carrier`.
bool World::lives_hold(std::uint64_t tick) const {
  if (!state_.life_table) return true;
  const StateTable& lives = state_.tables[*state_.life_table];
  for (std::size_t r = 0; r < rows(); ++r) {
    const Life& life = lives.as<Life>(r);
    if (life.birth > tick || life.presence > static_cast<std::uint8_t>(Presence::dead) ||
        !std::isfinite(life.x) || !std::isfinite(life.y))
      return false;
    if (life.presence == static_cast<std::uint8_t>(Presence::there)) continue;
    if (state_.carrier_table && state_.tables[*state_.carrier_table].as<Carried>(r).carrier != 0)
      return false;
    if (presence(Row(r)) == Presence::unborn && state_.spec.starts(state_.bodies[r])) return false;
  }
  for (std::size_t r = 0; state_.carrier_table && r < rows(); ++r) {
    const std::uint32_t id = state_.tables[*state_.carrier_table].as<Carried>(r).carrier;
    const Row by = id == 0 || id > state_.rows.size() ? Row() : row(BodyId(id - 1));
    if (by.valid() && presence(by) != Presence::there) return false;
  }
  // Bodies of a reserve are born in the order of their ids.
  for (const ReserveSpec& reserve : state_.spec.reserves)
    for (std::uint32_t i = 1; i < reserve.count; ++i) {
      const BodyId id(reserve.first.index() + i);
      if (presence(row(BodyId(id.index() - 1))) == Presence::unborn && presence(row(id)) != Presence::unborn)
        return false;
    }
  return true;
}

void World::derive_lives() {
  newborn_.clear();
  count_present();
  for (std::size_t i = 0; i < state_.spec.reserves.size(); ++i) {
    const ReserveSpec& reserve = state_.spec.reserves[i];
    const auto is_born = [&](std::uint32_t number) {
      const BodyId id(reserve.first.index() + number);
      return location(id) == RowLocation::here && presence(row(id)) != Presence::unborn;
    };
    std::uint32_t& next = next_born_[i];
    next = 0;
    while (next < reserve.count && is_born(next)) ++next;
  }
}

/// Counts the rows whose bodies are unborn or dead, and the robots in the world that have own rows
/// (WorldState::own_rows). In a world without births and deaths, all robots count, whether their rows are
/// here or not.
void World::count_present() {
  state_.now.absent = 0;
  robots_ = robots_at_start_;
  if (!state_.life_table) return;
  robots_ = 0;
  for (std::size_t r = 0; r < rows(); ++r) {
    const bool there = presence(Row(r)) == Presence::there;
    state_.now.absent += !there;
    robots_ += there && r < state_.own_rows && type(Row(r)).drive;
  }
}

void World::set_births(std::span<const std::uint32_t> births) {
  std::ranges::copy(births, next_born_.begin());
}

std::size_t World::robots() const {
  gather_distributed();
  return robots_;
}

Vec2 World::origin(Row row) const {
  const BodyId id = body(row);
  if (state_.spec.starts(id)) return state_.spec.bodies[id.index()].pose_world_body.position();
  const Life& life = state_.tables[*state_.life_table].as<Life>(row.index());
  return {life.x, life.y};
}

std::optional<std::size_t> World::reserve(std::string_view population) const {
  const auto found = std::ranges::find(state_.spec.reserves, population, &ReserveSpec::population);
  if (found == state_.spec.reserves.end()) return {};
  return static_cast<std::size_t>(found - state_.spec.reserves.begin());
}

/// The body of a reserve that is born next. Not all bodies of the reserve may have been born.
BodyId World::next_unborn(std::size_t reserve) const {
  return BodyId(state_.spec.reserves[reserve].first.index() + next_born_[reserve]);
}

/// Calls work(). If it throws in the phase move of a distributed world, the exception is thrown later, by
/// Replica::end_attempts(), on all ranks.
template <class Work>
void World::attempt(Work&& work) {
  if (replica_)
    replica_->attempt(std::ref(work));  // a reference, so that std::function allocates no memory
  else
    work();
}

/// Spawns the next body of a reserve, if there is one, at the first free pose of place(0), place(1), ...,
/// place(trials - 1). Before the call, the spatial index must contain the present poses of all bodies in the
/// world, except the bodies of newborn_, which were born since the index was built.
///
/// If the rows are distributed among ranks, all ranks make the same calls in the same order. The row of the
/// new body stays on the rank that had the row of the unborn body, until the ranks distribute the rows again.
Birth World::give_birth(std::size_t reserve, std::uint32_t trials,
                        const std::function<Pose(std::uint32_t)>& place) {
  if (unborn(reserve) == 0) return {BirthStatus::used_up, {}};
  const BodyId id = next_unborn(reserve);
  const BodyType& type = state_.type(id);
  // If bodies with joints can be born, no row is elsewhere (why_replicated()), so a body with joints has a
  // valid row. Its shape depends on the poses of its joints at birth, so it enters the world before its shape
  // is used.
  const Row row = location(id) == RowLocation::here ? this->row(id) : Row();
  if (!type.joints.empty()) enter(row, {});
  const partition::ObstacleShape& shape = type.joints.empty() ? type.obstacle : *state_.shapes[row.index()];
  const std::uint32_t trial = first_free(id, shape, trials, place);
  if (!type.joints.empty()) leave(row);
  if (trial == trials) return {BirthStatus::occupied, {}};
  const Pose pose = at_start(place(trial));
  attempt([&] {
    if (!row.valid()) return;
    enter(row, pose);
    Life& life = state_.life(row);
    life.birth = state_.now.tick;
    life.x = pose.x;
    life.y = pose.y;
    if (row.index() < state_.own_rows) robots_ += type.drive.has_value();
  });
  newborn_.push_back({id, pose});
  ++next_born_[reserve];
  return {BirthStatus::born, id};
}

/// Whether so many bodies were born since the spatial index was built that it should be rebuilt: each birth
/// is tested one by one against these bodies. The sum of the times for these tests and for rebuilding the
/// index is lowest if their number is near the square root of the number of bodies. In a distributed world,
/// the result is the same on all ranks.
bool World::has_many_newborn() const {
  const double bodies = static_cast<double>(state_.rows.size());
  return static_cast<double>(newborn_.size()) >= std::max(64.0, 2 * std::sqrt(bodies));
}

/// Adds the bodies of newborn_ to the spatial index. Their rows must be here; in a distributed world,
/// Replica::follow_jumps() must have distributed the rows since the births.
void World::index_newborn() {
  state_.index.rebuild(state_.transforms, state_.radii, parallel_);
  newborn_.clear();
}

/// Brings the rows of bodies that were born or moved since the last tick to the ranks that own the ground
/// there, if the rows are distributed among ranks, and adds the bodies of newborn_ to the spatial index. All
/// ranks make this call.
void World::follow_newborn() {
  if (replica_) replica_->follow_jumps();
  index_newborn();
}

/// Returns the lowest trial whose pose place(trial) is free for an unborn body with this shape; `trials` if
/// there is none. If the rows are distributed among ranks, each rank tests only the poses in its own part of
/// the plane, and all ranks return the lowest trial that any rank has found.
std::uint32_t World::first_free(BodyId id, const partition::ObstacleShape& shape, std::uint32_t trials,
                                const std::function<Pose(std::uint32_t)>& place) const {
  std::uint32_t first = trials;
  for (std::uint32_t trial = 0; trial < trials && first == trials; ++trial) {
    const Pose pose = place(trial);
    const bool is_tested = is_finite(pose) && (!replica_ || replica_->tests_places_at(pose.position()));
    if (is_tested && is_free(id, shape, at_start(pose))) first = trial;
  }
  return replica_ ? replica_->lowest_trial(first, trials) : first;
}

/// Puts an unborn body into the world at this pose, with the state that a body has at tick 0.
void World::enter(Row row, const Pose& pose) {
  // A program may have set the commands of the unborn body.
  state_.tables[WorldState::k_command].clear_row(row.index());
  for (const BodyType::Device& device : type(row).devices)
    if (device.command_table) state_.tables[*device.command_table].clear_row(slot(row));
  state_.life(row).presence = static_cast<std::uint8_t>(Presence::there);
  --state_.now.absent;
  start(row, pose);
  derive(row);
}

/// Undoes enter(): the body is unborn again.
void World::leave(Row row) {
  state_.clear(row);
  state_.life(row).presence = static_cast<std::uint8_t>(Presence::unborn);
  ++state_.now.absent;
  derive(row);
}

/// Removes a body from the world; does nothing if the body is not in the world. The carrier of the body
/// releases it, and the body releases its cargo. The row keeps the pose at death and the component `life`;
/// the rest of its state becomes 0.
void World::die(Row row) {
  if (!is_there(row)) return;
  if (links_.any()) {
    links_.release(row);
    while (links_.first_cargo(row) != Links::k_none) links_.release(Row(links_.first_cargo(row)));
  }
  const Pose pose = poses()[row.index()];
  const Life life = state_.life(row);
  if (state_.now.impaired > 0) state_.now.impaired -= !state_.condition(row).is_sound();
  state_.clear(row);
  state_.poses()[row.index()] = pose;
  state_.life(row) = life;
  state_.life(row).presence = static_cast<std::uint8_t>(Presence::dead);
  ++state_.now.absent;
  if (row.index() < state_.own_rows) robots_ -= type(row).drive.has_value();
  derive(row);
}

/// Carries out the deaths and births that devices requested in this tick. Deaths come first, so that a body
/// can be born where another body died in the same tick. has_lives() must be true. If the rows are
/// distributed among ranks, `effects` must have the effects of all ranks.
void World::resolve_lives(std::span<const Effect> effects) {
  const auto is_here = [&](BodyId body) { return location(body) == RowLocation::here; };
  for (const Effect& effect : effects)
    if (effect.verb == k_death && effect.target.index() < state_.rows.size() && is_here(effect.target))
      die(row(effect.target));
  std::optional<std::vector<BodyId>> dead;  // sorted; needed only for bodies whose rows are elsewhere
  const auto has_died = [&](BodyId source) {
    if (is_here(source)) return !is_there(row(source));
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
    const bool is_distributed = replica_ && replica_->halo() != nullptr;
    if (unborn(effect.reserve) > 0 && (!is_indexed || (!is_distributed && has_many_newborn()))) {
      index_newborn();
      is_indexed = true;
    }
    const auto [x, y, z, heading] = effect.payload;
    const Pose pose{x, y, z, heading};
    const Birth birth = give_birth(effect.reserve, 1, [&pose](std::uint32_t) { return pose; });
    attempt([&] {
      if (!is_here(effect.source)) return;
      const Row source = row(effect.source);
      const BodyType::Device& device = type(source).devices[effect.device];
      if (!device.kind->born) return;
      call_kind(*this, {&source, 1}, device,
                [&] { device.kind->born(*this, device.prepared.data, effect, birth); });
    });
  }
  if (replica_) replica_->end_attempts();
  movement_.count_stalls();
}

Birth World::spawn(std::size_t reserve, const Pose& pose) {
  require_whole();
  require_between_steps("spawn()");
  if (reserve >= state_.spec.reserves.size())
    throw std::out_of_range(
        fmt::format("spawn(): found reserve {}, but the world has {} reserves, counted from 0", reserve,
                    state_.spec.reserves.size()));
  restore_fp_environment();  // a library may have changed it: see World::step()
  if (!is_finite(pose))
    throw std::invalid_argument(
        fmt::format("a body of population \"{}\" cannot be placed at x {}, y {}, z {} (m), heading {} (rad): "
                    "the numbers must be finite",
                    state_.spec.reserves[reserve].population, pose.x, pose.y, pose.z, pose.heading));
  touch();
  const Completion completion(*this);
  const Birth birth = give_birth(reserve, 1, [&pose](std::uint32_t) { return pose; });
  if (birth.status == BirthStatus::born) index_bodies();
  return birth;
}

void World::remove(Row row) {
  require_whole();
  require_between_steps("remove()");
  require_row(row, "remove()");
  restore_fp_environment();  // a library may have changed it: see World::step()
  if (!state_.life_table)
    throw std::logic_error(
        "programs cannot remove bodies of this world: add \"mortal\": true to the world file, or set this "
        "key when you load the world (in C++: SimulationOptions::mortal; in Python: "
        "set={\"/mortal\": True}); worlds with a \"reserve\", a device that removes bodies, or an "
        "intervention \"remove\" need neither");
  if (!is_there(row)) return;
  touch();
  die(row);
  movement_.count_stalls();
  index_bodies();
}

}  // namespace troupe::engine
