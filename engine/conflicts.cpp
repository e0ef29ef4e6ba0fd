#include "engine/conflicts.hpp"

#include "base/random.hpp"
#include "partition/placed_shape.hpp"
#include "partition/separation.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace troupe::engine {
namespace {

using partition::BodyCircle;
using partition::ObstacleShape;
using partition::PlacedShape;

constexpr std::size_t k_batch = 128;  // rows per task
// Largest number of dependencies that are stored for a row. For a row with more dependencies, the geometric
// tests are repeated in each round.
constexpr std::size_t k_listed = 64;
constexpr std::uint32_t k_unlisted = ~0u;

// A motion that is longer than this is called far. Bodies with far motions are not looked up in the index:
// each mover is tested against all of them, because they would otherwise widen the search of every mover. If
// there are more than k_max_far of them, they are looked up like all other bodies.
constexpr double k_far_m = 0.5;

template <class T>
std::atomic_ref<T> atomic(T& value) {
  return std::atomic_ref(value);
}

/// Sets `most`, the bits of a double, to those of `value` if that is larger. All values are non-negative, so
/// their bit patterns have the order of the values.
void raise_to(std::atomic<std::uint64_t>& most, double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  std::uint64_t known = most.load(std::memory_order_relaxed);
  while (known < bits && !most.compare_exchange_weak(known, bits, std::memory_order_relaxed)) {
  }
}
double value_of(const std::atomic<std::uint64_t>& most) {
  return std::bit_cast<double>(most.load(std::memory_order_relaxed));
}

std::size_t motion_samples(double displacement, double thinnest) {
  const double samples = displacement / (0.25 * thinnest);
  constexpr double k_most = 1e6;  // a very thin body at a very high speed must not stall the step
  const double n = samples < k_most ? samples : k_most;
  const auto whole = static_cast<std::size_t>(n);
  return std::max<std::size_t>(1, static_cast<double>(whole) < n ? whole + 1 : whole);
}

/// A row that proposes a motion. The number of samples and the placed shapes are computed on first use,
/// because only some rows need them.
class Mover {
 public:
  Mover(const Conflicts::Crowd& crowd, std::uint32_t r)
      : row(r), from(crowd.poses[r]), motion(crowd.motions[r]), shape(*crowd.shapes[r]), crowd_(crowd) {}

  double length() const { return (motion.to.position() - from.position()).norm(); }
  /// Upper bound on the distance of any vertex from its old position during the motion, m.
  double displacement() const { return length() + shape.radius * std::abs(motion.turn); }

  std::size_t samples() {
    if (samples_ == 0) samples_ = motion_samples(displacement(), shape.thinnest);
    return samples_;
  }
  /// Pose at sample k of the motion, 1 <= k < n, world frame. n is the number of samples.
  Pose between(std::size_t k) { return between(k, samples()); }
  Pose between(std::size_t k, std::size_t n) const {
    const double t = static_cast<double>(k) / static_cast<double>(n);
    const Pose& to = motion.to;
    return {from.x + t * (to.x - from.x), from.y + t * (to.y - from.y), from.z + t * (to.z - from.z),
            from.heading + t * motion.turn};
  }
  const PlacedShape& here() { return here_ ? *here_ : here_.emplace(shape, crowd_.transforms[row], from.z); }
  const PlacedShape& there() { return there_ ? *there_ : there_.emplace(shape, motion.there(), motion.to.z); }

  const std::uint32_t row;
  const Pose& from;
  const Motion& motion;
  const ObstacleShape& shape;

 private:
  const Conflicts::Crowd& crowd_;
  std::size_t samples_ = 0;
  std::optional<PlacedShape> here_;
  std::optional<PlacedShape> there_;
};

/// Returns the first and the last sample of a motion at which the mover's origin may lie within the distance
/// `reach` of a point, with a margin on both sides. If there is none, the first is greater than the last. If
/// the motion has only a few samples, returns all of them. (The motion of a fast body can have thousands.)
std::pair<std::size_t, std::size_t> samples_near(Mover& mover, const Vec2& point, double reach) {
  constexpr std::size_t k_few = 8;
  const std::size_t n = mover.samples();
  const Vec2 along = mover.motion.to.position() - mover.from.position();
  const double length2 = along.squaredNorm();
  if (n <= k_few || length2 == 0) return {1, n};
  const double samples = static_cast<double>(n);
  const double middle = along.dot(point - mover.from.position()) / length2 * samples;
  const double half = (reach + partition::k_rounding_m) / sqrt(length2) * samples + 2;
  const double first = std::clamp(middle - half, 1.0, samples);
  const double last = std::clamp(middle + half, 0.0, samples);
  return {static_cast<std::size_t>(first), static_cast<std::size_t>(last)};
}

/// A list of numbers that allocates memory only if it has more than 512 numbers, which is rare.
class Few {
 public:
  void add(std::uint32_t n) {
    if (count_ < few_.size()) {
      few_[count_] = n;
    } else {
      if (count_ == few_.size()) many_.assign(few_.begin(), few_.end());
      many_.push_back(n);
    }
    ++count_;
  }
  std::span<std::uint32_t> all() {
    return count_ <= few_.size() ? std::span(few_).first(count_) : std::span(many_);
  }
  void clear() { count_ = 0; }

 private:
  std::array<std::uint32_t, 512> few_;
  std::vector<std::uint32_t> many_;
  std::size_t count_ = 0;
};

/// A body that a pusher pushes, and the positions of its origin, m, world frame.
struct Pushed {
  std::uint32_t row;
  Vec2 before;  // position before the pusher's motion
  Vec2 last;    // position at the previous sample of the pusher's motion
  Vec2 now;     // position at the present sample
};

}  // namespace

/// The resolution of the motions of one tick. All threads share one object.
class Conflicts::Resolver {
 public:
  Resolver(Conflicts& conflicts, const Crowd& crowd, const partition::StaticScene& scene,
           const partition::BodyIndex& index)
      : conflicts_(conflicts),
        crowd_(crowd),
        scene_(scene),
        index_(index),
        round_(conflicts.base_ + 1),
        mixture_(mix(crowd.seed, crowd.tick)) {}

  /// Called before the first round, for the rows [first, last): finds the longest motions. Their length
  /// determines how far to search for neighbours.
  void bound_motions(std::size_t first, std::size_t last) {
    double longest2 = 0;
    for (std::size_t row = first; row < last; ++row) {
      const Motion& motion = crowd_.motions[row];
      if (!motion.moves || crowd_.shapes[row]->empty() || leaves_world(motion)) continue;
      const double length2 = length2_of(row);
      if (length2 <= k_far_m * k_far_m) {
        longest2 = std::max(longest2, length2);
        continue;
      }
      raise_to(longest_far2_, length2);
      const std::size_t i = far_count_.fetch_add(1, std::memory_order_relaxed);
      if (i < k_max_far) conflicts_.far_[i] = static_cast<std::uint32_t>(row);
    }
    raise_to(longest2_, longest2);
  }
  void finish_bounds() {
    const bool all_listed = far_count_.load() <= k_max_far;
    far_ = std::span(conflicts_.far_).first(all_listed ? far_count_.load() : 0);
    const double longest2 = std::max(value_of(longest2_), all_listed ? 0.0 : value_of(longest_far2_));
    longest_ = sqrt(longest2) + partition::k_rounding_m;
    conflicts_.longest_ = sqrt(std::max(longest2, value_of(longest_far2_))) + partition::k_rounding_m;
  }

  /// First round, for one row: tests its motion against the static scene and all other bodies. If the outcome
  /// depends on whether certain bodies of higher priority move, the row is put on the list of waiting rows.
  /// Otherwise it is resolved.
  void propose_and_check(std::uint32_t row) {
    const Motion& motion = crowd_.motions[row];
    if (!motion.moves) return;
    if (leaves_world(motion)) return resolve(row, Outcome::out_of_bounds);
    if (crowd_.shapes[row]->empty()) return resolve(row, Outcome::moved);
    Mover mover(crowd_, row);
    if (scene_blocks(mover)) return resolve(row, Outcome::blocked);

    std::array<Dependency, k_listed> others;
    std::uint32_t count = 0;
    const bool blocked = blocked_by_others(mover, [&](std::uint32_t other, bool blocks_moved) {
      if (count < k_listed) others[count] = {other, blocks_moved};
      ++count;
      return false;
    });
    if (blocked) return resolve(row, Outcome::blocked);
    if (count == 0) return resolve(row, Outcome::moved);
    Waiting waiting{row, 0, k_unlisted};
    if (count <= k_listed) {
      const std::uint32_t first = others_count_.fetch_add(count, std::memory_order_relaxed);
      if (first + std::size_t{count} <= 2 * conflicts_.reserved_) {
        std::copy_n(others.begin(), count, conflicts_.others_.get() + first);
        waiting = {row, first, count};
      }
    }
    wait(conflicts_.waiting_.get(), waiting);
  }

  /// A further round, for one waiting row. The row is resolved if earlier rounds have resolved all bodies
  /// that it depends on, or if a resolved body blocks it. Each round resolves at least the waiting body of
  /// highest priority, so the rounds end. A round reads only outcomes of earlier rounds, so the number of
  /// rounds does not depend on the number of threads.
  void resolve_waiting(const Waiting& waiting) {
    if (waiting.count == k_in_zone) return resolve_in_zone(waiting.row, conflicts_.still_waiting_.get());
    bool open = false;
    const auto blocks = [&](std::uint32_t other, bool blocks_moved) {
      const Resolution found = resolution(other);
      const bool resolved = found.round() > conflicts_.base_ && found.round() < round_;
      open = open || !resolved;
      return resolved && (found.outcome() == Outcome::moved) == blocks_moved;
    };
    bool blocked = false;
    if (waiting.count == k_unlisted) {
      Mover mover(crowd_, waiting.row);
      blocked = blocked_by_others(mover, blocks);
    } else {
      for (std::uint32_t i = 0; i < waiting.count && !blocked; ++i) {
        const Dependency on = conflicts_.others_[waiting.first + i];
        blocked = blocks(on.row(), on.if_moved());
      }
    }
    if (blocked || !open)
      resolve(waiting.row, blocked ? Outcome::blocked : Outcome::moved);
    else
      wait(conflicts_.still_waiting_.get(), waiting);
  }
  std::size_t push_count() const { return push_count_; }
  /// Begins the next round. Returns the number of waiting rows.
  std::size_t next_round() {
    ++round_;
    return waiting_count_.exchange(0, std::memory_order_relaxed);
  }
  std::uint32_t round() const { return round_; }

  // ---- Only if the world has pushable bodies

  /// Finds the radius of the largest zone of the rows [first, last). It determines how far to search for
  /// overlapping zones.
  void bound_zones(std::size_t first, std::size_t last) {
    double largest = 0;
    for (std::size_t row = first; row < last; ++row)
      if (is_mover(row)) largest = std::max(largest, zone_radius(row));
    raise_to(largest_zone_, largest);
  }
  /// Sets the row's zone to Zone::pushes if the row can push and a pushable body is in the zone, otherwise to
  /// Zone::plain.
  void find_zone(std::uint32_t row) {
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
  /// Changes the row's zone from Zone::plain to Zone::may_push if it overlaps a zone of kind Zone::pushes: a
  /// pushable body of that zone may be pushed into this one.
  void widen_zone(std::uint32_t row) {
    Zone& zone = conflicts_.zones_[row];
    if (zone != Zone::plain || !is_mover(row)) return;
    bool meets = false;
    for_each_zone(row, [&](std::uint32_t other) {
      meets =
          meets || std::atomic_ref(conflicts_.zones_[other]).load(std::memory_order_relaxed) == Zone::pushes;
    });
    if (meets) std::atomic_ref(zone).store(Zone::may_push, std::memory_order_relaxed);
  }
  bool is_plain(std::uint32_t row) const { return conflicts_.zones_[row] == Zone::plain; }

  void propose_and_check_in_zone(std::uint32_t row) {
    if (leaves_world(crowd_.motions[row])) return resolve(row, Outcome::out_of_bounds);
    Mover mover(crowd_, row);
    if (scene_blocks(mover)) return resolve(row, Outcome::blocked);
    resolve_in_zone(row, conflicts_.waiting_.get());
  }
  /// Resolves the row if all movers of higher priority whose zones overlap its zone are resolved. Otherwise
  /// appends it to `list`, the list of waiting rows.
  void resolve_in_zone(std::uint32_t row, Waiting* list) {
    bool open = false;
    for_each_zone(row, [&](std::uint32_t other) {
      open = open || (goes_before(other, row) && !is_resolved_before(other));
    });
    if (open) return wait(list, {row, 0, k_in_zone});
    Mover mover(crowd_, row);
    resolve(row, push(mover) ? Outcome::moved : Outcome::blocked);
  }

 private:
  static constexpr std::uint32_t k_in_zone = k_unlisted - 1;

  bool is_pushable(std::uint32_t row) const {
    return crowd_.pushables.is_pushable[row] != 0 && !crowd_.shapes[row]->empty();
  }
  bool is_mover(std::size_t row) const {
    return crowd_.motions[row].moves && !crowd_.shapes[row]->empty() && !leaves_world(crowd_.motions[row]);
  }
  /// Radius of the row's zone, m. The zone is a circle about the row's old position that contains its whole
  /// motion, and every body that it may push, wherever that body is pushed. This radius suffices because each
  /// pushed body touches the mover or a body that was pushed before it.
  double zone_radius(std::size_t row) const {
    constexpr double k_slack_m = 1e-6;  // each shift adds k_rounding_m
    const double length = sqrt(length2_of(row));
    return length + crowd_.shapes[row]->radius + 2 * crowd_.pushables.limits[row] * crowd_.pushables.radius +
           k_slack_m;
  }
  /// Calls visit(other) for all other movers whose zones overlap the zone of the row.
  template <class Visit>
  void for_each_zone(std::uint32_t row, Visit&& visit) const {
    const Vec2 at = crowd_.poses[row].position();
    const double reach = zone_radius(row);
    index_.for_each_near(Box::around(at, reach + value_of(largest_zone_)), [&](const BodyCircle& circle) {
      if (circle.row != row && is_mover(circle.row) &&
          partition::in_reach(at, reach, crowd_.poses[circle.row].position(), zone_radius(circle.row)))
        visit(circle.row);
    });
  }
  Resolution resolution(std::uint32_t row) const {
    return atomic(conflicts_.resolutions_[row]).load(std::memory_order_acquire);
  }
  bool is_resolved_before(std::uint32_t row) const {
    const Resolution found = resolution(row);
    return found.round() > conflicts_.base_ && found.round() < round_;
  }

  /// Place of a body when it is the turn of `mover`. All bodies of higher priority that may affect the mover
  /// are resolved before that.
  struct Place {
    Transform at;
    double z;
  };
  Place place_now(const Mover& mover, std::uint32_t row) const {
    if (is_pushable(row)) return {pushed_to(row, position_now(row)), crowd_.poses[row].z};
    if (has_moved_before(mover, row)) return {crowd_.motions[row].there(), crowd_.motions[row].to.z};
    return {crowd_.transforms[row], crowd_.poses[row].z};
  }
  bool has_moved_before(const Mover& mover, std::uint32_t row) const {
    if (!is_mover(row) || !goes_before(row, mover.row)) return false;
    const Resolution found = resolution(row);
    return found.round() > conflicts_.base_ && found.outcome() == Outcome::moved;
  }
  std::span<const Push> pushes_before(const Mover& mover, std::uint32_t row) const {
    if (is_plain(row) || !has_moved_before(mover, row)) return {};
    // If the zones of the row and the mover do not overlap, another thread may be resolving the row right
    // now.
    if (!partition::in_reach(mover.from.position(), zone_radius(mover.row), crowd_.poses[row].position(),
                             zone_radius(row)))
      return {};
    const PushesOf& of = conflicts_.pushes_of_[row];
    return {conflicts_.pushes_.data() + of.first, of.count};
  }
  /// Number of the row's last push, counted from 1; 0: none.
  std::uint32_t last_push(std::uint32_t row) const {
    return atomic(conflicts_.pushed_last_[row]).load(std::memory_order_acquire);
  }
  /// Position of a pushable body after the pushes so far, m, world frame.
  Vec2 position_now(std::uint32_t row) const {
    const std::uint32_t push = last_push(row);
    return push == 0 ? crowd_.transforms[row].position : conflicts_.pushes_[push - 1].position;
  }
  Transform pushed_to(std::uint32_t row, const Vec2& position) const {
    return {position, crowd_.transforms[row].rotation};
  }
  bool goes_first(std::uint32_t a, std::uint32_t b) const { return crowd_.ids[a] < crowd_.ids[b]; }
  bool meet(std::uint32_t a, const PlacedShape& at_a, std::uint32_t b, const PlacedShape& at_b) const {
    return goes_first(a, b) ? overlap(at_a, at_b) : overlap(at_b, at_a);
  }

  /// Returns whether the motion of the mover is free, or becomes free by pushing other bodies. In the second
  /// case, records the pushes.
  bool push(Mover& mover) {
    const std::size_t limit = crowd_.pushables.limits[mover.row];
    const Vec2 from = mover.from.position();
    const double reach = zone_radius(mover.row);
    conflicts_.pushes_of_[mover.row] = {};
    Few bodies;  // rows near the mover that it cannot push
    Few others;  // rows near the mover that it can push
    const auto add = [&](std::uint32_t row) {
      const Place now = place_now(mover, row);
      if (!partition::in_reach(from, reach, now.at.position, crowd_.shapes[row]->radius)) return;
      const bool gives_way =
          limit > 0 && is_pushable(row) &&
          !meet(mover.row, mover.here(), row, PlacedShape(*crowd_.shapes[row], now.at, now.z));
      (gives_way ? others : bodies).add(row);
    };
    // A body that was already pushed in this tick is found through the row that pushed it last: the index
    // contains its old position, which may be far away.
    index_.for_each_near(Box::around(from, reach + value_of(largest_zone_)), [&](const BodyCircle& circle) {
      const std::uint32_t row = circle.row;
      if (row == mover.row || crowd_.shapes[row]->empty()) return;
      if (!is_pushable(row)) {
        add(row);
        for (const Push& push : pushes_before(mover, row))
          if (last_push(push.row) == static_cast<std::size_t>(&push - conflicts_.pushes_.data()) + 1)
            add(push.row);
      } else if (last_push(row) == 0) {
        add(row);
      }
    });
    for (const std::uint32_t row : bodies.all()) {
      const Place now = place_now(mover, row);
      if (blocks(mover, row, now.z, now.at)) return false;
    }
    const std::span<std::uint32_t> pushable = others.all();
    if (pushable.empty()) return true;
    std::ranges::sort(pushable, {}, [&](std::uint32_t row) { return crowd_.ids[row]; });

    std::array<Pushed, k_most_pushed> set;
    std::size_t count = 0;
    const std::size_t n =
        motion_samples(mover.displacement(), std::min(mover.shape.thinnest, crowd_.pushables.thinnest));
    for (std::size_t k = 1; k <= n; ++k) {
      const Pose pose = k < n ? mover.between(k, n) : mover.motion.to;
      const Transform at = k < n ? Transform(pose) : mover.motion.there();
      if (!make_way(mover.row, PlacedShape(mover.shape, at, pose.z), pushable, limit, set, count))
        return false;
      for (Pushed& pushed : std::span(set).first(count)) {
        if (pushed.now == pushed.last) continue;
        if (!can_stand(mover, pushed, bodies.all())) return false;
        pushed.last = pushed.now;
      }
    }
    if (count == 0) return true;
    const std::size_t first = push_count_.fetch_add(count, std::memory_order_relaxed);
    conflicts_.pushes_of_[mover.row] = {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count)};
    for (std::size_t i = 0; i < count; ++i) {
      conflicts_.pushes_[first + i] = {set[i].row, set[i].now};
      atomic(conflicts_.pushed_last_[set[i].row])
          .store(static_cast<std::uint32_t>(first + i + 1), std::memory_order_release);
    }
    return true;
  }

  /// Shifts the bodies that overlap the mover at this pose, then in a further pass those that overlap the
  /// shifted bodies, and so on until no bodies overlap. The first `count` entries of `set` are the bodies
  /// that the mover has pushed so far; both are updated. Returns false if more than `limit` bodies would have
  /// to be pushed, or if bodies still overlap after the last allowed pass.
  bool make_way(std::uint32_t row, const PlacedShape& mover, std::span<const std::uint32_t> pushable,
                std::size_t limit, std::array<Pushed, k_most_pushed>& set, std::size_t& count) const {
    /// Shifts the bodies that row `by` at the place `at` overlaps, except the first `after` entries of `set`:
    /// these were met before `by`, or are `by`. Sets `shifted` if it shifts any.
    const auto shift = [&](std::uint32_t by, const PlacedShape& at, std::size_t after, bool& shifted) {
      for (const std::uint32_t other : pushable) {
        if (other == by) continue;
        std::size_t i = 0;
        while (i < count && set[i].row != other) ++i;
        if (i < after && i < count) continue;
        const Vec2 now = i < count ? set[i].now : position_now(other);
        const ObstacleShape& shape = *crowd_.shapes[other];
        if (!partition::in_reach(at.position(), at.shape().radius, now, shape.radius)) continue;
        const PlacedShape theirs(shape, pushed_to(other, now), crowd_.poses[other].z);
        if (!meet(by, at, other, theirs)) continue;
        const std::optional<Vec2> way = partition::way_out(at, theirs);
        if (!way || (i == count && count == limit)) return false;
        if (i == count) set[count++] = {other, now, now, now};
        const double length = sqrt(way->squaredNorm());
        const Vec2 to = now + (length + partition::k_rounding_m) / length * *way;
        set[i].now = Vec2(to.x() + 0.0, to.y() + 0.0);  // no -0
        shifted = true;
      }
      return true;
    };
    for (int pass = 0; pass < k_push_passes; ++pass) {
      bool shifted = false;
      if (!shift(row, mover, 0, shifted)) return false;
      for (std::size_t b = 0; b < count; ++b) {
        const std::uint32_t by = set[b].row;
        const PlacedShape at(*crowd_.shapes[by], pushed_to(by, set[b].now), crowd_.poses[by].z);
        if (!shift(by, at, b + 1, shifted)) return false;
      }
      if (!shifted) return true;
    }
    return false;
  }

  bool can_stand(Mover& mover, const Pushed& pushed, std::span<const std::uint32_t> bodies) const {
    const ObstacleShape& shape = *crowd_.shapes[pushed.row];
    if ((pushed.now - pushed.last).squaredNorm() > 0.25 * shape.thinnest * shape.thinnest) return false;
    if (!crowd_.bounds.contains(pushed.now)) return false;
    const double z = crowd_.poses[pushed.row].z;
    const PlacedShape there(shape, pushed_to(pushed.row, pushed.now), z);
    std::optional<PlacedShape> here;
    const auto before = [&]() -> const PlacedShape& {
      return here ? *here : here.emplace(shape, pushed_to(pushed.row, pushed.before), z);
    };
    if (scene_.has_obstacles() && scene_.crossed(there, [&](std::uint32_t solid) {
          return scene_.overlaps_solid(solid, before());
        }) >= 0)
      return false;
    return std::ranges::none_of(bodies, [&](std::uint32_t row) {
      const Place now = place_now(mover, row);
      const ObstacleShape& theirs = *crowd_.shapes[row];
      if (!partition::in_reach(pushed.now, shape.radius, now.at.position, theirs.radius)) return false;
      const PlacedShape placed(theirs, now.at, now.z);
      if (!meet(pushed.row, there, row, placed)) return false;
      const bool apart =
          (pushed.now - now.at.position).squaredNorm() > (pushed.before - now.at.position).squaredNorm();
      return !(apart && meet(pushed.row, before(), row, placed));
    });
  }

  double length2_of(std::size_t row) const {
    return (crowd_.motions[row].to.position() - crowd_.poses[row].position()).squaredNorm();
  }
  bool leaves_world(const Motion& motion) const { return !crowd_.bounds.contains(motion.to.position()); }
  bool goes_before(std::uint32_t a, std::uint32_t b) const {
    const std::uint64_t pa = mix_in(mixture_, crowd_.ids[a]);
    const std::uint64_t pb = mix_in(mixture_, crowd_.ids[b]);
    return pa != pb ? pa < pb : crowd_.ids[a] < crowd_.ids[b];
  }
  Box swept(std::size_t row, double radius) const {
    Box box = Box::around(crowd_.poses[row].position(), radius);
    if (crowd_.motions[row].moves) box.extend(Box::around(crowd_.motions[row].to.position(), radius));
    return box;
  }

  void resolve(std::uint32_t row, Outcome outcome) {
    atomic(conflicts_.resolutions_[row]).store({round_, outcome}, std::memory_order_release);
  }
  void wait(Waiting* list, const Waiting& waiting) {
    list[waiting_count_.fetch_add(1, std::memory_order_relaxed)] = waiting;
  }

  /// Whether the mover's free circle contains the whole motion, so that the static scene cannot block it.
  /// Computes a new circle if the present one is too small and a new one may suffice.
  bool clear_of_scene(Mover& mover) const {
    FreeCircle& free = crowd_.free[mover.row];
    const auto holds = [&](const Vec2& p) {
      const double reach = free.radius - mover.shape.radius - partition::k_rounding_m;
      return reach > 0 && (p - Vec2(free.x, free.y)).squaredNorm() <= reach * reach;
    };
    const Vec2 from = mover.from.position();
    const Vec2 to = mover.motion.to.position();
    if (holds(from) && holds(to)) return true;
    // Since the circle was computed, the distance to the scene has grown by at most the distance travelled.
    // If the radius would be too small even then, a new circle would be too small as well.
    const double needed = mover.shape.radius + mover.length();
    const double gone = (from - Vec2(free.x, free.y)).norm();
    if (free.radius > 0 && free.radius + gone < needed) return false;
    // Number of ticks for which the new circle should suffice. A larger circle takes longer to compute.
    constexpr double k_ticks = 32;
    const double clearance = scene_.clearance(from, 2 * mover.shape.radius + k_ticks * mover.length());
    const double rounding = 0x1p-23 * (std::abs(from.x()) + std::abs(from.y()) + clearance) + 1e-9;
    free = {static_cast<float>(from.x()), static_cast<float>(from.y()),
            static_cast<float>(std::max(clearance - rounding, 0x1p-120))};
    return holds(from) && holds(to);
  }

  bool scene_blocks(Mover& mover) const {
    if (!scene_.has_obstacles() || clear_of_scene(mover)) return false;
    // A body in a floor plan crosses many edges of one solid. `known` is the last solid that the mover
    // already overlaps, so that the test against a solid is not repeated for each edge.
    std::uint32_t known = ~0u;
    const auto already_in = [&](std::uint32_t solid) {
      if (solid == known) return true;
      if (!scene_.overlaps_solid(solid, mover.here())) return false;
      known = solid;
      return true;
    };
    const std::size_t n = mover.samples();
    for (std::size_t k = 1; k < n; ++k)
      if (scene_.crossed(PlacedShape(mover.shape, mover.between(k)), already_in) >= 0) return true;
    return scene_.crossed(mover.there(), already_in) >= 0;
  }

  /// Calls visit(row) for all bodies whose motions may come near the motion of the mover, and for some
  /// others. If there are more than 32 such bodies, a row may be visited more than once.
  template <class Visit>
  void for_each_near(const Mover& mover, Visit&& visit) const {
    const Vec2 from = mover.from.position();
    const Vec2 to = mover.motion.to.position();
    const Vec2 middle = 0.5 * (from + to);
    // The circle about the whole motion is widened by the longest motion of other bodies and by a rounding
    // bound.
    const double around = 0.5 * (to - from).norm() + mover.shape.radius + longest_;
    const double rounding = 0x1p-23 * (std::abs(middle.x()) + std::abs(middle.y()));
    const auto reach = static_cast<float>((around + rounding) * (1 + 0x1p-20));
    const auto x = static_cast<float>(middle.x());
    const auto y = static_cast<float>(middle.y());
    const bool has_wide = index_.has_wide();  // a wide body is listed in several cells
    std::array<std::uint32_t, 32> visited;
    std::size_t visits = 0;
    const auto is_repeat = [&](std::uint32_t row) {
      if (std::find(visited.begin(), visited.begin() + visits, row) != visited.begin() + visits) return true;
      if (visits < visited.size()) visited[visits++] = row;
      return false;
    };
    index_.for_each_run(Box::around(middle, around), [&](std::span<const BodyCircle> run) {
      // The filter has no branches, because they would be unpredictable. Few circles pass it.
      std::array<std::uint32_t, 64> near;
      while (!run.empty()) {
        const std::size_t some = std::min(run.size(), near.size());
        std::size_t count = 0;
        for (const BodyCircle& circle : run.first(some)) {
          const float dx = circle.x - x;
          const float dy = circle.y - y;
          const float touching = circle.radius + reach;
          near[count] = circle.row;
          count += dx * dx + dy * dy <= touching * touching;
        }
        run = run.subspan(some);
        for (std::size_t i = 0; i < count; ++i)
          if ((far_.empty() || !goes_far(near[i])) && !(has_wide && is_repeat(near[i]))) visit(near[i]);
      }
    });
    for (const std::uint32_t row : far_) visit(row);
  }
  bool goes_far(std::uint32_t row) const {
    const Motion& motion = crowd_.motions[row];
    return motion.moves && length2_of(row) > k_far_m * k_far_m && !leaves_world(motion);
  }

  /// Whether another body blocks the mover. Some bodies of higher priority propose a motion and would block
  /// the mover at only one of their two poses. For each of them, depends(row, blocks_at_new_pose) is called,
  /// which must return true if that body is known to block the mover.
  template <class Depends>
  bool blocked_by_others(Mover& mover, Depends&& depends) const {
    const Box mine = swept(mover.row, mover.shape.radius + partition::k_rounding_m);
    bool blocked = false;
    for_each_near(mover, [&](std::uint32_t other) {
      if (blocked || other == mover.row || crowd_.shapes[other]->empty()) return;
      const Motion& theirs = crowd_.motions[other];
      if (!mine.touches(swept(other, crowd_.shapes[other]->radius))) return;
      const bool if_it_stays = blocks(mover, other, crowd_.poses[other].z, crowd_.transforms[other]);
      if (!theirs.moves || leaves_world(theirs) || !goes_before(other, mover.row)) {
        blocked = if_it_stays;
        return;
      }
      const bool if_it_moved = blocks(mover, other, theirs.to.z, theirs.there());
      blocked = if_it_stays && if_it_moved;
      if (if_it_stays != if_it_moved) blocked = depends(other, if_it_moved);
    });
    return blocked;
  }

  /// Returns false only if no piece of the mover comes near any piece of another shape, placed at `at`,
  /// during the whole motion. This saves exact tests: most bodies near a shape of many pieces are not near
  /// any single piece.
  bool parts_come_near(const Mover& mover, const ObstacleShape& shape, const Transform& at) const {
    if (mover.shape.pieces.size() == 1 && shape.pieces.size() == 1) return true;
    return partition::pieces_in_reach(mover.shape, crowd_.transforms[mover.row], shape, at,
                                      mover.displacement() + partition::k_rounding_m);
  }

  /// Whether the row `other`, at height z and transform `at`, blocks the motion of the mover.
  bool blocks(Mover& mover, std::uint32_t other, double z, const Transform& at) const {
    const ObstacleShape& shape = *crowd_.shapes[other];
    const bool first = crowd_.ids[mover.row] < crowd_.ids[other];
    std::optional<PlacedShape> theirs;
    const auto meet = [&](const PlacedShape& mine) {
      if (!theirs) theirs.emplace(shape, at, z);
      return first ? overlap(mine, *theirs) : overlap(*theirs, mine);
    };
    const std::size_t n = mover.samples();
    const auto [first_k, last_k] = samples_near(mover, at.position, mover.shape.radius + shape.radius);
    for (std::size_t k = first_k; k <= last_k; ++k) {
      const Pose between = k < n ? mover.between(k) : mover.motion.to;
      if (!partition::in_reach(between.position(), mover.shape.radius, at.position, shape.radius)) continue;
      if (!theirs && !parts_come_near(mover, shape, at)) return false;
      if (!(k < n ? meet(PlacedShape(mover.shape, between)) : meet(mover.there()))) continue;
      const bool apart = (mover.motion.to.position() - at.position).squaredNorm() >
                         (mover.from.position() - at.position).squaredNorm();
      return !(apart && meet(mover.here()));
    }
    return false;
  }

  Conflicts& conflicts_;
  const Crowd& crowd_;
  const partition::StaticScene& scene_;
  const partition::BodyIndex& index_;
  std::uint32_t round_;
  std::uint64_t mixture_;
  // Bits of the largest squared length of the motions that are not far, and of those that are far, m^2.
  std::atomic<std::uint64_t> longest2_ = 0;
  std::atomic<std::uint64_t> longest_far2_ = 0;
  std::atomic<std::size_t> far_count_ = 0;
  std::span<const std::uint32_t> far_;  // rows with far motions, against which each mover is tested
  double longest_ = 0;                  // length of the longest motion found through the index, m
  std::atomic<std::size_t> waiting_count_ = 0;
  std::atomic<std::uint32_t> others_count_ = 0;
  std::atomic<std::uint64_t> largest_zone_ = 0;  // bits of a radius, m
  std::atomic<std::size_t> push_count_ = 0;
};

void Conflicts::reserve(std::size_t rows, const Pushables& pushables) {
  resolutions_.resize(rows);
  if (pushables.any()) {
    zones_.resize(rows);
    pushes_of_.resize(rows);
    pushed_last_.resize(rows);
    pushes_.resize(std::max(pushes_.size(), pushables.most));
  }
  if (rows <= reserved_) return;
  reserved_ = rows;
  waiting_ = std::make_unique_for_overwrite<Waiting[]>(rows);
  still_waiting_ = std::make_unique_for_overwrite<Waiting[]>(rows);
  others_ = std::make_unique_for_overwrite<Dependency[]>(2 * rows);
}

void Conflicts::forget() {
  constexpr std::uint32_t k_junk = 0x5a5a5a5a;
  base_ += static_cast<std::uint32_t>(rounds_);
  rounds_ = 0;
  std::ranges::fill(resolutions_, Resolution(base_, Outcome::out_of_bounds));
  longest_ = std::numeric_limits<double>::quiet_NaN();
  far_.fill(k_junk);
  std::fill_n(waiting_.get(), reserved_, Waiting{k_junk, k_junk, k_junk});
  std::fill_n(still_waiting_.get(), reserved_, Waiting{k_junk, k_junk, k_junk});
  std::fill_n(others_.get(), 2 * reserved_, Dependency(k_junk / 2, true));
  std::ranges::fill(zones_, Zone::may_push);
  std::ranges::fill(pushes_of_, PushesOf{k_junk, k_junk});
  std::ranges::fill(pushes_, Push{k_junk, Vec2::Constant(longest_)});
  std::ranges::fill(pushed_last_, 0u);
  push_count_ = 0;
}

void Conflicts::resolve(const Crowd& crowd, const partition::StaticScene& scene,
                        const partition::BodyIndex& index, partition::Parallel& parallel) {
  const std::size_t rows = crowd.motions.size();
  reserve(rows, crowd.pushables);
  for (const Push& push : pushes()) pushed_last_[push.row] = 0;
  push_count_ = 0;
  constexpr std::uint32_t k_last_round = 1u << 29;  // reached after some years
  if (base_ + rounds_ > k_last_round) {
    std::ranges::fill(resolutions_, Resolution());
    base_ = 0;
    rounds_ = 0;
  }
  base_ += static_cast<std::uint32_t>(rounds_);
  Resolver resolver(*this, crowd, scene, index);
  const auto for_each = [&](std::size_t count, std::size_t batch, auto&& work) {
    parallel.for_each((count + batch - 1) / batch,
                      [&](std::size_t b) { work(b * batch, std::min(count, (b + 1) * batch)); });
  };
  for_each(rows, 16 * k_batch,
           [&](std::size_t first, std::size_t last) { resolver.bound_motions(first, last); });
  resolver.finish_bounds();
  const std::span<const std::uint32_t> order = index.order();
  if (crowd.pushables.any()) {
    for_each(rows, 16 * k_batch,
             [&](std::size_t first, std::size_t last) { resolver.bound_zones(first, last); });
    for_each(order.size(), k_batch, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) resolver.find_zone(order[i]);
    });
    for_each(order.size(), k_batch, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) resolver.widen_zone(order[i]);
    });
    for_each(order.size(), k_batch, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i)
        resolver.is_plain(order[i]) ? resolver.propose_and_check(order[i])
                                    : resolver.propose_and_check_in_zone(order[i]);
    });
  } else {
    for_each(order.size(), k_batch, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) resolver.propose_and_check(order[i]);
    });
  }
  while (const std::size_t waiting = resolver.next_round()) {
    for_each(waiting, 4 * k_batch, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) resolver.resolve_waiting(waiting_[i]);
    });
    std::swap(waiting_, still_waiting_);
  }
  rounds_ = resolver.round() - base_ - 1;
  push_count_ = resolver.push_count();
  for (const Push& push : pushes())
    longest_ = std::max(longest_, (push.position - crowd.transforms[push.row].position).norm());
}

}  // namespace troupe::engine
