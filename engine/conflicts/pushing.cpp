#include "engine/conflicts/conflict_resolver.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <optional>
#include <span>
#include <vector>

/// The parts of conflict resolution that worlds with pushable bodies need.

namespace troupe::engine {

/// A list of rows that allocates memory only for more than 512 rows, which are rare.
class Conflicts::Resolver::RowList {
 public:
  void add(std::uint32_t row) {
    if (count_ < first_.size()) {
      first_[count_] = row;
    } else {
      if (count_ == first_.size()) all_.assign(first_.begin(), first_.end());
      all_.push_back(row);
    }
    ++count_;
  }
  std::span<std::uint32_t> all() {
    return count_ <= first_.size() ? std::span(first_).first(count_) : std::span(all_);
  }

 private:
  std::array<std::uint32_t, 512> first_;
  std::vector<std::uint32_t> all_;
  std::size_t count_ = 0;
};

/// A body that a pusher cannot push on.
struct Conflicts::Resolver::Halt {
  std::uint32_t row;
  BodyId behind;  // the body that stops it; not valid() if there is none. BodyId::value + 1 is then 0
};

/// A body that a pusher pushes, and positions of the origin of the pushed body, m, world frame.
struct Conflicts::Resolver::Pushed {
  std::uint32_t row;
  Vec2 last;  // position at the previous sample of the pusher's motion
  Vec2 now;   // position at the present sample
};

bool Conflicts::Resolver::is_pushable(std::uint32_t row) const {
  return crowd_.pushables.is_pushable[row] != 0 && !crowd_.shapes[row]->empty();
}

/// Radius of the row's zone, m. The zone is a circle about the row's old position. It contains the whole
/// motion of the row's body, and every body that this body may push, before and after the push. Each pushed
/// body touches the mover or another pushed body, so each adds at most the diameter of the largest pushable
/// body.
double Conflicts::Resolver::zone_radius(std::size_t row) const {
  constexpr double k_slack_m = 1e-6;  // covers the distance k_rounding_m that each push adds
  const double length = sqrt(length2_of(row));
  return length + crowd_.shapes[row]->radius + 2 * crowd_.pushables.limits[row] * crowd_.pushables.radius +
         k_slack_m;
}

/// Calls visit(other) for the row of each other mover whose zone overlaps the zone of the row.
template <class Visit>
void Conflicts::Resolver::for_each_zone(std::uint32_t row, Visit&& visit) const {
  const Vec2 at = crowd_.poses[row].position();
  const double reach = zone_radius(row);
  index_.for_each_near(Box::around(at, reach + value_of(largest_zone_)), [&](const BodyCircle& circle) {
    if (circle.row != row && is_mover(circle.row) &&
        partition::in_reach(at, reach, crowd_.poses[circle.row].position(), zone_radius(circle.row)))
      visit(circle.row);
  });
}

void Conflicts::Resolver::bound_zones(std::size_t first, std::size_t last) {
  double largest = 0;
  for (std::size_t row = first; row < last; ++row)
    if (is_mover(row)) largest = std::max(largest, zone_radius(row));
  raise_to(largest_zone_, largest);
}

void Conflicts::Resolver::find_zone(std::uint32_t row) {
  Zone& zone = conflicts_.zones_[row];
  zone = Zone::plain;
  if (!is_mover(row) || crowd_.pushables.limits[row] == 0) return;
  const Vec2 at = crowd_.poses[row].position();
  const double reach = zone_radius(row);
  index_.for_each_near(Box::around(at, reach), [&](const BodyCircle& circle) {
    if (zone == Zone::plain && is_pushable(circle.row) &&
        partition::in_reach(at, reach, crowd_.poses[circle.row].position(),
                            crowd_.shapes[circle.row]->radius))
      zone = Zone::pushes;
  });
}

void Conflicts::Resolver::widen_zone(std::uint32_t row) {
  Zone& zone = conflicts_.zones_[row];
  if (zone != Zone::plain || !is_mover(row)) return;
  bool meets = false;
  for_each_zone(row, [&](std::uint32_t other) {
    meets =
        meets || std::atomic_ref(conflicts_.zones_[other]).load(std::memory_order_relaxed) == Zone::pushes;
  });
  if (meets) std::atomic_ref(zone).store(Zone::may_push, std::memory_order_relaxed);
}

void Conflicts::Resolver::propose_and_check_in_zone(std::uint32_t row) {
  if (leaves_world(crowd_.motions[row])) return resolve(row, Outcome::out_of_bounds);
  Mover mover(crowd_, row);
  if (!may_turn(row) && scene_blocks(mover)) return resolve(row, Outcome::blocked);
  resolve_in_zone(row, conflicts_.waiting_.get());
}

void Conflicts::Resolver::resolve_in_zone(std::uint32_t row, Waiting* list) {
  // Of the movers for which it waits, the one with the lowest priority is most likely resolved last.
  std::uint32_t last = row;
  for_each_zone(row, [&](std::uint32_t other) {
    if (goes_before(other, row) && !is_resolved_before(other) && (last == row || goes_before(last, other)))
      last = other;
  });
  if (last != row) return wait(list, {row, last, k_in_zone});
  Mover mover(crowd_, row);
  if (!may_turn(row)) return resolve(row, push(mover) ? Outcome::moved : Outcome::blocked);
  if (!scene_blocks(mover) && push(mover)) return resolve(row, Outcome::moved);
  conflicts_.pushes_of_[row] = {};
  const Motion turn = turn_of(row);
  Mover turning(crowd_, row, turn);
  RowList pushable;  // stays empty, because a turn pushes nothing
  RowList others;
  find_near(turning, 0, pushable, others);
  const bool blocked = scene_blocks(turning) || std::ranges::any_of(others.all(), [&](std::uint32_t other) {
                         const Place now = place_now(turning, other);
                         return blocks(turning, other, now.z, now.at);
                       });
  resolve(row, blocked ? Outcome::blocked : Outcome::turned);
}

/// All bodies of higher priority that may affect the mover are resolved before the turn of the mover.
Conflicts::Resolver::Place Conflicts::Resolver::place_now(const Mover& mover, std::uint32_t row) const {
  if (is_pushable(row)) return {pushed_to(row, position_now(mover, row)), crowd_.poses[row].z};
  return place_at_turn(mover, row);
}

/// The place of a body that nothing pushes.
Conflicts::Resolver::Place Conflicts::Resolver::place_at_turn(const Mover& mover, std::uint32_t row) const {
  switch (outcome_before(mover, row)) {
    case Outcome::moved: return {crowd_.motions[row].there(), crowd_.motions[row].to.z};
    case Outcome::turned: return {turned(row), crowd_.poses[row].z};
    default: return {crowd_.transforms[row], crowd_.poses[row].z};
  }
}

/// Outcome of the row if its turn was before that of the mover, otherwise Outcome::stands.
Conflicts::Outcome Conflicts::Resolver::outcome_before(const Mover& mover, std::uint32_t row) const {
  if (!is_mover(row) || !goes_before(row, mover.row)) return Outcome::stands;
  const Resolution found = resolution(row);
  return found.round() > conflicts_.base_ ? found.outcome() : Outcome::stands;
}

std::span<const Conflicts::Push> Conflicts::Resolver::pushes_before(const Mover& mover,
                                                                    std::uint32_t row) const {
  if (is_plain(row) || outcome_before(mover, row) != Outcome::moved) return {};
  // If the zones of the row and the mover do not overlap, the pushes of the row do not affect the mover, and
  // another thread may be writing them right now.
  if (!partition::in_reach(mover.from.position(), zone_radius(mover.row), crowd_.poses[row].position(),
                           zone_radius(row)))
    return {};
  const PushesOf& of = conflicts_.pushes_of_[row];
  return {conflicts_.pushes_.data() + of.first, of.count};
}

/// The last push of the row before the turn of the mover; null: the row was not pushed. At its turn, the
/// mover has no push after it in its zone. Afterwards (Mover::is_past), the pushes of the movers that had
/// their turns before it count.
const Conflicts::Push* Conflicts::Resolver::last_push(const Mover& mover, std::uint32_t row) const {
  if (!mover.is_past) {
    const std::uint32_t last = atomic(conflicts_.pushed_last_[row]).load(std::memory_order_acquire);
    return last == 0 ? nullptr : &conflicts_.pushes_[last - 1];
  }
  const Push* found = nullptr;
  std::uint32_t by = mover.row;
  for_each_zone(mover.row, [&](std::uint32_t other) {
    for (const Push& push : pushes_before(mover, other)) {
      if (push.row != row || (found != nullptr && goes_before(other, by))) continue;
      found = &push;
      by = other;
    }
  });
  return found;
}

/// Position of a pushable body at the turn of the mover, m, world frame.
Vec2 Conflicts::Resolver::position_now(const Mover& mover, std::uint32_t row) const {
  const Push* const push = last_push(mover, row);
  return push == nullptr ? crowd_.transforms[row].position : push->position;
}

Transform Conflicts::Resolver::pushed_to(std::uint32_t row, const Vec2& position) const {
  return {position, crowd_.transforms[row].rotation};
}

bool Conflicts::Resolver::goes_first(std::uint32_t a, std::uint32_t b) const {
  return crowd_.ids[a] < crowd_.ids[b];
}

bool Conflicts::Resolver::meet(std::uint32_t a, const PlacedShape& at_a, std::uint32_t b,
                               const PlacedShape& at_b) const {
  return goes_first(a, b) ? overlap(at_a, at_b) : overlap(at_b, at_a);
}

/// Lists the rows near the mover: those that it can push, and all others, which may therefore block it.
void Conflicts::Resolver::find_near(Mover& mover, std::size_t limit, RowList& pushable,
                                    RowList& others) const {
  const Vec2 from = mover.from.position();
  const double reach = zone_radius(mover.row);
  const auto add = [&](std::uint32_t row) {
    const Place now = place_now(mover, row);
    if (!partition::in_reach(from, reach, now.at.position, crowd_.shapes[row]->radius)) return;
    const bool gives_way =
        limit > 0 && is_pushable(row) &&
        !meet(mover.row, mover.here(), row, PlacedShape(*crowd_.shapes[row], now.at, now.z));
    (gives_way ? pushable : others).add(row);
  };
  // A body that was already pushed in this tick is found through the row that pushed it last, because the
  // index contains only the old position of the body, which may be far from the present one.
  index_.for_each_near(Box::around(from, reach + value_of(largest_zone_)), [&](const BodyCircle& circle) {
    const std::uint32_t row = circle.row;
    if (row == mover.row || crowd_.shapes[row]->empty()) return;
    if (!is_pushable(row)) {
      add(row);
      for (const Push& push : pushes_before(mover, row))
        if (last_push(mover, push.row) == &push) add(push.row);
    } else if (last_push(mover, row) == nullptr) {
      add(row);
    }
  });
}

/// Number of bodies that the row may push in this tick.
std::size_t Conflicts::Resolver::push_limit(std::uint32_t row) const {
  return conflicts_.zones_[row] == Zone::pushes ? crowd_.pushables.limits[row] : 0;
}

/// Returns whether the motion of the mover is free, or becomes free by pushing other bodies. In the second
/// case, records the pushes.
bool Conflicts::Resolver::push(Mover& mover) {
  const std::size_t limit = push_limit(mover.row);
  conflicts_.pushes_of_[mover.row] = {};
  RowList near_pushable;
  RowList near_others;
  find_near(mover, limit, near_pushable, near_others);
  for (const std::uint32_t row : near_others.all()) {
    const Place now = place_now(mover, row);
    if (blocks(mover, row, now.z, now.at)) return false;
  }
  const std::span<std::uint32_t> pushable = near_pushable.all();
  if (pushable.empty()) return true;
  std::ranges::sort(pushable, {}, [&](std::uint32_t row) { return crowd_.ids[row]; });

  std::array<Pushed, k_most_pushed> set;
  std::size_t count = 0;
  const std::size_t n =
      motion_samples(mover.displacement(), std::min(mover.shape.thinnest, crowd_.pushables.thinnest));
  for (std::size_t k = 1; k <= n; ++k) {
    const Pose pose = k < n ? mover.between(k, n) : mover.motion.to;
    const Transform at = k < n ? Transform(pose) : mover.motion.there();
    if (!make_way(mover, PlacedShape(mover.shape, at, pose.z), pushable, limit, set, count)) return false;
    for (Pushed& pushed : std::span(set).first(count)) {
      if (pushed.now == pushed.last) continue;
      if (!can_stand(mover, pushed, near_others.all())) return false;
      pushed.last = pushed.now;
    }
  }
  if (count > 0) record(mover.row, std::span(set).first(count));
  return true;
}

void Conflicts::Resolver::record(std::uint32_t row, std::span<const Pushed> pushed) {
  const std::size_t first =
      atomic(conflicts_.push_count_).fetch_add(pushed.size(), std::memory_order_relaxed);
  conflicts_.pushes_of_[row] = {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(pushed.size())};
  for (std::size_t i = 0; i < pushed.size(); ++i) {
    conflicts_.pushes_[first + i] = {pushed[i].row, pushed[i].now};
    atomic(conflicts_.pushed_last_[pushed[i].row])
        .store(static_cast<std::uint32_t>(first + i + 1), std::memory_order_release);
  }
}

/// Makes passes (class Conflicts, `pushing`) until no bodies overlap. In a pass, first the mover at this
/// pose, and then each body that the mover has pushed so far, shifts the bodies that it overlaps. The pushed
/// bodies are the first `count` entries of `set`, in the order in which they were first met; `set` and
/// `count` are updated. Returns false if more than `limit` bodies would have to be pushed, or if the last
/// allowed pass still shifts a body.
///
/// placed: the shape of the mover at this pose
/// pushable: rows near the mover that it can push, in the order of their ids
/// halt: if not null, is set to the last body that had to give way, and to the body that it met
bool Conflicts::Resolver::make_way(const Mover& mover, const PlacedShape& placed,
                                   std::span<const std::uint32_t> pushable, std::size_t limit,
                                   std::array<Pushed, k_most_pushed>& set, std::size_t& count,
                                   Halt* halt) const {
  /// Shifts the bodies that row `by` at the place `at` overlaps, except the first `after` entries of `set`,
  /// which were met before `by` or are `by` itself. Sets `shifted` if it shifts any body. Returns false if
  /// more than `limit` bodies would have to be pushed.
  const auto shift = [&](std::uint32_t by, const PlacedShape& at, std::size_t after, bool& shifted) {
    for (const std::uint32_t other : pushable) {
      if (other == by) continue;
      std::size_t i = 0;
      while (i < count && set[i].row != other) ++i;
      if (i < after && i < count) continue;
      const Vec2 now = i < count ? set[i].now : position_now(mover, other);
      const ObstacleShape& shape = *crowd_.shapes[other];
      if (!partition::in_reach(at.position(), at.shape().radius, now, shape.radius)) continue;
      const PlacedShape theirs(shape, pushed_to(other, now), crowd_.poses[other].z);
      if (!meet(by, at, other, theirs)) continue;
      if (halt != nullptr)
        *halt = by == mover.row ? Halt{other, BodyId()} : Halt{by, BodyId(crowd_.ids[other])};
      const std::optional<Vec2> way = partition::way_out(at, theirs);
      if (!way || (i == count && count == limit)) return false;
      if (i == count) set[count++] = {other, now, now};
      const double length = sqrt(way->squaredNorm());
      const Vec2 to = now + (length + partition::k_rounding_m) / length * *way;
      set[i].now = Vec2(to.x() + 0.0, to.y() + 0.0);  // no -0
      shifted = true;
    }
    return true;
  };
  for (int pass = 0; pass < k_push_passes; ++pass) {
    bool shifted = false;
    if (!shift(mover.row, placed, 0, shifted)) return false;
    for (std::size_t b = 0; b < count; ++b) {
      const std::uint32_t by = set[b].row;
      const PlacedShape at(*crowd_.shapes[by], pushed_to(by, set[b].now), crowd_.poses[by].z);
      if (!shift(by, at, b + 1, shifted)) return false;
    }
    if (!shifted) return true;
  }
  return false;
}

/// Whether a body that is not pushed is in the way of a body that the mover pushes, at the shape `there`;
/// before() returns its shape at the sample before.
template <class Before>
bool Conflicts::Resolver::holds(const Mover& mover, std::uint32_t pushed, const PlacedShape& there,
                                Before&& before, std::uint32_t row) const {
  const Place now = place_now(mover, row);
  const ObstacleShape& theirs = *crowd_.shapes[row];
  if (!partition::in_reach(there.position(), there.shape().radius, now.at.position, theirs.radius))
    return false;
  const PlacedShape placed(theirs, now.at, now.z);
  return meet(pushed, there, row, placed) &&
         (!meet(pushed, before(), row, placed) || partition::deepens(before(), there, placed));
}

/// What stops a pushed body that cannot stand at its new position (can_stand()): a static body if there is
/// one, otherwise the body with the lowest id. Not valid() if it is a bound of the world, or if the body was
/// pushed too far.
BodyId Conflicts::Resolver::stopper(const Mover& mover, const Pushed& pushed,
                                    std::span<const std::uint32_t> bodies) const {
  if (!crowd_.bounds.contains(pushed.now)) return {};
  const ObstacleShape& shape = *crowd_.shapes[pushed.row];
  const double z = crowd_.poses[pushed.row].z;
  const PlacedShape before(shape, pushed_to(pushed.row, pushed.last), z);
  const PlacedShape there(shape, pushed_to(pushed.row, pushed.now), z);
  if (scene_.has_obstacles())
    if (const BodyId body = scene_.blocker(before, there); body.valid()) return body;
  BodyId lowest;
  for (const std::uint32_t row : bodies) {
    const BodyId body(crowd_.ids[row]);
    if (body < lowest && holds(
                             mover, pushed.row, there, [&]() -> const PlacedShape& { return before; }, row))
      lowest = body;
  }
  return lowest;
}

/// What blocks a pusher, or a mover near one, at its turn, which is over: `earliest` has the static scene.
void Conflicts::Resolver::explain_in_zone(Mover& mover, Earliest& earliest) const {
  mover.is_past = true;
  RowList near_pushable;
  RowList near_others;
  const std::size_t limit = push_limit(mover.row);
  find_near(mover, limit, near_pushable, near_others);
  for (const std::uint32_t row : near_others.all()) take(earliest, mover, row, place_now(mover, row));
  set_block(earliest, mover);
  const std::span<std::uint32_t> pushable = near_pushable.all();
  std::ranges::sort(pushable, {}, [&](std::uint32_t row) { return crowd_.ids[row]; });
  std::array<Pushed, k_most_pushed> set;
  std::size_t count = 0;
  const std::size_t n =
      motion_samples(mover.displacement(), std::min(mover.shape.thinnest, crowd_.pushables.thinnest));
  // A push counts only if it fails before the mover's own way is blocked.
  const std::size_t last_k = earliest.sample == 0 ? n : (earliest.sample * n - 1) / mover.samples();
  for (std::size_t k = 1; k <= last_k && !pushable.empty(); ++k) {
    const Pose pose = k < n ? mover.between(k, n) : mover.motion.to;
    const Transform at = k < n ? Transform(pose) : mover.motion.there();
    Halt halt;
    const PlacedShape placed(mover.shape, at, pose.z);
    bool is_free = make_way(mover, placed, pushable, limit, set, count, &halt);
    for (std::size_t i = 0; is_free && i < count; ++i) {
      is_free = set[i].now == set[i].last || can_stand(mover, set[i], near_others.all());
      if (!is_free) halt = {set[i].row, stopper(mover, set[i], near_others.all())};
      set[i].last = set[i].now;
    }
    if (is_free) continue;
    const Place place = place_now(mover, halt.row);
    crowd_.blocks[mover.row] = {{Contact::k_pushed, crowd_.ids[halt.row] + 1, halt.behind.value + 1},
                                static_cast<std::uint32_t>(k),
                                static_cast<std::uint32_t>(n),
                                place.at,
                                place.z};
    return;
  }
}

bool Conflicts::Resolver::can_stand(const Mover& mover, const Pushed& pushed,
                                    std::span<const std::uint32_t> bodies) const {
  const ObstacleShape& shape = *crowd_.shapes[pushed.row];
  if ((pushed.now - pushed.last).squaredNorm() > 0.25 * shape.thinnest * shape.thinnest) return false;
  if (!crowd_.bounds.contains(pushed.now)) return false;
  const double z = crowd_.poses[pushed.row].z;
  const PlacedShape there(shape, pushed_to(pushed.row, pushed.now), z);
  std::optional<PlacedShape> here;
  const auto before = [&]() -> const PlacedShape& {
    return here ? *here : here.emplace(shape, pushed_to(pushed.row, pushed.last), z);
  };
  if (scene_.has_obstacles() && scene_.overlaps(there) &&
      (!scene_.overlaps(before()) || scene_.deepens(before(), there)))
    return false;
  return std::ranges::none_of(
      bodies, [&](std::uint32_t row) { return holds(mover, pushed.row, there, before, row); });
}

}  // namespace troupe::engine
