#include "base/fp_environment.hpp"
#include "engine/kind_errors.hpp"
#include "engine/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

namespace troupe::engine {
namespace {

const partition::ObstacleShape k_no_shape;

bool is_finite(const Pose& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) && std::isfinite(p.heading);
}

}  // namespace

void World::build_lives() {
  const auto ends_lives = [](const BodyType& type) {
    return std::ranges::any_of(type.devices,
                               [](const BodyType::Device& device) { return device.prepared.ends_lives; });
  };
  const bool experiment_ends_them = std::ranges::any_of(
      spec_.experiment.at, [](const auto& at) { return at.action == InterventionSpec::Action::remove; });
  if (spec_.reserves.empty() && !spec_.mortal && !experiment_ends_them &&
      std::ranges::none_of(types_, ends_lives))
    return;
  life_table_ = tables_.size();
  tables_.emplace_back(
      "life", HashGroup::pose, StateTable::Layout::rows,
      sparse({{"birth", Element::u64, 1, "",
               "number of ticks completed at its birth; 0: present from the start", offsetof(Life, birth)},
              {"x", Element::f64, 1, "m", "position at birth, world frame; 0 if present from the start",
               offsetof(Life, x)},
              {"y", Element::f64, 1, "m", "position at birth, world frame", offsetof(Life, y)},
              {"presence", Element::u8, 1, "", "0: in the world, 1: not yet born, 2: dead",
               offsetof(Life, presence)}}),
      row_bodies_, sizeof(Life));
  next_born_.resize(spec_.reserves.size());
  std::size_t most = 0;
  for (const ReserveSpec& reserve : spec_.reserves) most += reserve.count;
  newborn_.reserve(most);
  if (spec_.ranging == RangingEngine::grid) not_drawn_.resize(rows());
}

/// Whether the rows of the component `life` are consistent with one another and with the tick.
bool World::lives_hold(std::uint64_t tick) const {
  if (!life_table_) return true;
  const StateTable& lives = tables_[*life_table_];
  for (std::size_t r = 0; r < rows(); ++r) {
    const Life& life = lives.as<Life>(r);
    if (life.birth > tick || life.presence > static_cast<std::uint8_t>(Presence::dead) ||
        !std::isfinite(life.x) || !std::isfinite(life.y))
      return false;
    if (life.presence == static_cast<std::uint8_t>(Presence::there)) continue;
    if (carrier_table_ && tables_[*carrier_table_].as<Carried>(r).carrier != 0) return false;
    if (presence(Row(r)) == Presence::unborn && spec_.starts(row_bodies_[r])) return false;
  }
  for (std::size_t r = 0; carrier_table_ && r < rows(); ++r) {
    const std::uint32_t id = tables_[*carrier_table_].as<Carried>(r).carrier;
    const Row by = id == 0 || id > body_rows_.size() ? Row() : body_rows_[id - 1];
    if (by.valid() && presence(by) != Presence::there) return false;
  }
  for (const ReserveSpec& reserve : spec_.reserves)  // bodies of a reserve are born in the order of their ids
    for (std::uint32_t i = 1; i < reserve.count; ++i) {
      const Row before = body_rows_[reserve.first.index() + i - 1];
      const Row row = body_rows_[reserve.first.index() + i];
      if (presence(before) == Presence::unborn && presence(row) != Presence::unborn) return false;
    }
  return true;
}

void World::derive_lives() {
  robots_ = robots_at_start_;
  absent_ = 0;
  newborn_.clear();
  if (!life_table_) return;
  robots_ = 0;
  for (std::size_t r = 0; r < rows(); ++r) {
    const bool there = presence(Row(r)) == Presence::there;
    absent_ += !there;
    robots_ += there && type(Row(r)).drive;
  }
  for (std::size_t i = 0; i < spec_.reserves.size(); ++i) {
    const ReserveSpec& reserve = spec_.reserves[i];
    std::uint32_t& next = next_born_[i];
    next = 0;
    while (next < reserve.count && presence(body_rows_[reserve.first.index() + next]) != Presence::unborn)
      ++next;
  }
}

/// Updates the shape and the radius of a row: those of its type, or none if the body is not in the world. For
/// bodies that have joints, carry or are carried, World::reshape() then computes the exact ones.
void World::update_presence(Row row) {
  const bool there = is_there(row);
  row_shapes_[row.index()] = there ? &type(row).obstacle : &k_no_shape;
  row_radii_[row.index()] = there ? type(row).radius : partition::k_not_there;
  if (!not_drawn_.empty()) not_drawn_[row.index()] = !there;
}

void World::clear(Row row) {
  for_tables_of(row, [this](std::size_t t, std::size_t at) { tables_[t].clear_row(at); });
}

Vec2 World::origin(Row row) const {
  const BodyId id = body(row);
  if (spec_.starts(id)) return spec_.bodies[id.index()].pose_world_body.position();
  const Life& life = tables_[*life_table_].as<Life>(row.index());
  return {life.x, life.y};
}

std::optional<std::size_t> World::reserve(std::string_view population) const {
  const auto found = std::ranges::find(spec_.reserves, population, &ReserveSpec::population);
  if (found == spec_.reserves.end()) return {};
  return static_cast<std::size_t>(found - spec_.reserves.begin());
}

/// Spawns the next body of a reserve, if there is one and `pose` is free. The spatial index must contain the
/// present poses of all bodies in the world, except those that were born since it was built; newborn_ lists
/// these.
Birth World::give_birth(std::size_t reserve, const Pose& pose) {
  if (unborn(reserve) == 0) return {BirthStatus::used_up, {}};
  const BodyId id(spec_.reserves[reserve].first.index() + next_born_[reserve]);
  const Row row = this->row(id);
  life(row).presence = static_cast<std::uint8_t>(Presence::there);
  --absent_;
  start(row, pose);
  derive(row);
  if (!is_free(row, poses()[row.index()])) {
    clear(row);
    life(row).presence = static_cast<std::uint8_t>(Presence::unborn);
    ++absent_;
    derive(row);
    return {BirthStatus::occupied, {}};
  }
  const Pose& at = poses()[row.index()];
  Life& life = this->life(row);
  life.birth = tick_;
  life.x = at.x;
  life.y = at.y;
  robots_ += type(row).drive.has_value();
  newborn_.push_back(row);
  ++next_born_[reserve];
  return {BirthStatus::born, id};
}

/// Removes a body from the world, if it is there. Its carrier releases it, and it releases its cargo. Its row
/// keeps the pose at death and the component `life`; the rest of its state becomes 0.
void World::die(Row row) {
  if (!is_there(row)) return;
  if (links_.any()) {
    release(row);
    while (links_.first_cargo[row.index()] != Links::k_none) release(Row(links_.first_cargo[row.index()]));
  }
  const Pose pose = poses()[row.index()];
  const Life life = this->life(row);
  if (impaired_ > 0) impaired_ -= !condition(row).is_sound();
  clear(row);
  as<Pose>(k_pose)[row.index()] = pose;
  this->life(row) = life;
  this->life(row).presence = static_cast<std::uint8_t>(Presence::dead);
  ++absent_;
  robots_ -= type(row).drive.has_value();
  derive(row);
}

/// Carries out the deaths and births that devices requested in this tick. Deaths come first, so that a body
/// can be born where another body died in the same tick. Throws std::logic_error if the world has neither
/// reserves nor deaths.
void World::resolve_lives(std::span<const Effect> effects) {
  if (!life_table_)
    throw std::logic_error(
        "a device requested a birth or a death, but the world has no reserve and no device kind declares "
        "ends_lives");
  for (const Effect& effect : effects)
    if (effect.verb == k_death && effect.target.index() < body_rows_.size() && row(effect.target).valid())
      die(row(effect.target));
  bool is_indexed = false;
  for (const Effect& effect : effects) {
    if (effect.verb != k_birth || !is_there(row(effect.source))) continue;
    if (!is_indexed) index_.rebuild(transforms_, row_radii_, parallel_);  // it has the poses before this tick
    is_indexed = true;
    const BodyType::Device& device = type(row(effect.source)).devices[effect.device];
    const auto [x, y, z, heading] = effect.payload;
    const Birth birth = give_birth(effect.reserve, {x, y, z, heading});
    if (const Row source = row(effect.source); device.kind->born)
      call_kind(*this, {&source, 1}, device,
                [&] { device.kind->born(*this, device.prepared.data, effect, birth); });
  }
  count_stalls();
}

Birth World::spawn(std::size_t reserve, const Pose& pose) {
  require_whole();
  restore_fp_environment();  // a library may have changed it, see World::step()
  if (!is_finite(pose))
    throw std::invalid_argument(fmt::format("cannot spawn a body of \"{}\": the pose is not finite",
                                            spec_.reserves[reserve].population));
  const Completion completion(*this);
  const Birth birth = give_birth(reserve, pose);
  if (birth.status == BirthStatus::born) index_bodies();
  return birth;
}

void World::remove(Row row) {
  require_whole();
  restore_fp_environment();  // a library may have changed it, see World::step()
  if (!life_table_)
    throw std::logic_error(
        "bodies of this world cannot be removed: the world needs \"mortal\": true or a reserve");
  if (!is_there(row)) return;
  die(row);
  count_stalls();
  index_bodies();
}

}  // namespace troupe::engine
