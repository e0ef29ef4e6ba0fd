#pragma once

#include "base/atomic_extremes.hpp"
#include "base/random.hpp"
#include "engine/conflicts/conflicts.hpp"
#include "partition/placed_shape.hpp"
#include "partition/separation.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

/// Conflict resolution: finds out which of the motions that bodies propose for one tick (time step) happen.
/// engine/conflicts/conflicts.hpp describes the rules; conflicts.cpp and pushing.cpp use this header. Terms:
///
/// - row: the index of a body in the state tables; also used for the body itself.
/// - mover: a body whose motion is tested.
/// - sample: one of the poses at which a motion is tested. The last sample is the proposed pose.
/// - static scene: the geometry of all bodies that never move.
/// - free circle: a circle into which the static scene does not reach (Crowd::free).
/// - priority: a random number for each body and tick. The outcomes are those that result if the bodies move
///   one after another, in the order of their priorities.
/// - outcome: whether the body moves to its proposed pose, or keeps its old pose because its motion is
///   blocked or would leave the world.
/// - resolved: a row is resolved if its outcome is known.
/// - waiting: a row waits if its outcome depends on rows that are not resolved yet.
/// - round: in the first round, all motions are tested; in each further round, only those of waiting rows.
/// - zone: a circle that contains everything that the motion of a row could touch or push. A zone of kind
///   Zone::pushes contains a body that the row can push. A zone of kind Zone::may_push contains no such body,
///   but another mover may push a body into it. All other zones are of kind Zone::plain.

namespace troupe::engine {

using partition::BodyCircle;
using partition::ObstacleShape;
using partition::PlacedShape;

// Largest number of dependencies that are stored for a row. For a row with more dependencies, the geometric
// tests are repeated in each round.
inline constexpr std::size_t k_listed = 64;
inline constexpr std::uint32_t k_unlisted = ~0u;  // Waiting::count if no dependencies are stored

// A motion that is longer than this is called far. Bodies with far motions are not looked up in the spatial
// index. Instead, each mover is tested against all of them, because a lookup would have to widen the search
// of every mover by the longest motion. If there are more than k_max_far far motions, these bodies are looked
// up like all others.
inline constexpr double k_far_m = 0.5;

template <class T>
std::atomic_ref<T> atomic(T& value) {
  return std::atomic_ref(value);
}

/// Returns the number of samples of the motion of a body, or of the joints of a body: `displacement` divided
/// by a quarter of `thinnest`, rounded up. The result is at least 1 and at most 10,000.
///
/// displacement: upper bound on the distance that any vertex moves, m
/// thinnest: width of the thinnest part that moves, m
inline std::size_t motion_samples(double displacement, double thinnest) {
  const double samples = displacement / (0.25 * thinnest);
  // A very thin body at a very high speed must not stall the step. A motion of 10 m still has a sample for
  // each millimetre.
  constexpr double k_most = 1e4;
  const double n = samples < k_most ? samples : k_most;
  const auto whole = static_cast<std::size_t>(n);
  return std::max<std::size_t>(1, static_cast<double>(whole) < n ? whole + 1 : whole);
}

/// A row that proposes a motion, with its old pose `from`, its `motion` and its `shape`. here() returns the
/// shape at the old pose, and there() the shape at the proposed pose. samples() returns the number of
/// samples. These results are computed on first use, because only some rows need them. Not thread-safe.
///
/// crowd: the bodies of the tick; must outlive the object
/// r: the row
class Mover {
 public:
  Mover(const Conflicts::Crowd& crowd, std::uint32_t r) : Mover(crowd, r, crowd.motions[r]) {}
  /// For another motion than the proposed one; `m` must outlive the object.
  Mover(const Conflicts::Crowd& crowd, std::uint32_t r, const Motion& m)
      : row(r), from(crowd.poses[r]), motion(m), shape(*crowd.shapes[r]), crowd_(crowd) {}

  double length() const { return (motion.to.position() - from.position()).norm(); }
  /// Upper bound on the horizontal distance that any vertex moves during the motion, m.
  double displacement() const { return length() + shape.radius * std::abs(motion.turn); }

  std::size_t samples() {
    if (samples_ == 0) samples_ = motion_samples(displacement(), shape.thinnest);
    return samples_;
  }
  /// Returns the pose at sample k of the motion, world frame. k must be at least 1 and less than the number
  /// of samples, n; sample n is Motion::to.
  Pose between(std::size_t k) { return between(k, samples()); }
  Pose between(std::size_t k, std::size_t n) const {
    const double t = static_cast<double>(k) / static_cast<double>(n);
    const Pose& to = motion.to;
    return {from.x + t * (to.x - from.x), from.y + t * (to.y - from.y), from.z + t * (to.z - from.z),
            from.heading + t * motion.turn};
  }
  /// The shape at sample k; 0: at the old pose.
  PlacedShape at_sample(std::size_t k) {
    if (k == 0) return {shape, crowd_.transforms[row], from.z};
    if (k < samples()) return {shape, between(k)};
    return {shape, motion.there(), motion.to.z};
  }
  const PlacedShape& here() { return here_ ? *here_ : here_.emplace(shape, crowd_.transforms[row], from.z); }
  const PlacedShape& there() { return there_ ? *there_ : there_.emplace(shape, motion.there(), motion.to.z); }

  const std::uint32_t row;
  const Pose& from;
  const Motion& motion;
  const ObstacleShape& shape;
  bool is_past = false;  // whether the turn of the mover is over: see Resolver::last_push()

 private:
  const Conflicts::Crowd& crowd_;
  std::size_t samples_ = 0;
  std::optional<PlacedShape> here_;
  std::optional<PlacedShape> there_;
};

/// Returns the first and the last sample of the motion that may be near a point. At all other samples, the
/// distance between the mover's origin and the point is greater than `reach`. If the first sample is greater
/// than the last, there is no sample near the point. Returns all samples if the motion has at most eight
/// samples or does not change the position.
///
/// point: world frame, m
/// reach: a distance, m
inline std::pair<std::size_t, std::size_t> samples_near(Mover& mover, const Vec2& point, double reach) {
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

/// Resolves the motions of one tick. All threads share one object. Conflicts::resolve() calls its functions
/// in this order:
///
/// 1. bound_motions() for all rows, then finish_bounds() once;
/// 2. propose_and_check() for each row in the spatial index (the first round);
/// 3. next_round(), and then resolve_waiting() for each waiting row (a further round). This step is repeated
///    until no row waits.
///
/// Then explain() for each row, if Crowd::blocks is wanted.
///
/// If the world has pushable bodies, bound_zones(), find_zone() and widen_zone() are called before the first
/// round, each for all rows. Functions that take rows may be called by several threads at the same time, for
/// different rows.
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

  /// Finds the longest motion of the rows [first, last), and lists the far motions, which are longer than
  /// k_far_m. Later, each mover is tested against all listed rows. Of the other rows, it is tested only
  /// against those nearby; how near depends on the longest motion that is not listed.
  void bound_motions(std::size_t first, std::size_t last) {
    double longest2 = 0;
    for (std::size_t row = first; row < last; ++row) {
      bool& may_overlap = crowd_.free[row].may_overlap;
      may_overlap = may_overlap && overlaps_another(static_cast<std::uint32_t>(row));
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
  /// Combines the results of all calls of bound_motions(). If there are more than k_max_far far motions, none
  /// of them stays on the list.
  void finish_bounds() {
    const bool all_listed = far_count_.load() <= k_max_far;
    far_ = std::span(conflicts_.far_).first(all_listed ? far_count_.load() : 0);
    const double longest2 = std::max(value_of(longest2_), all_listed ? 0.0 : value_of(longest_far2_));
    longest_ = sqrt(longest2) + partition::k_rounding_m;
    conflicts_.longest_ = sqrt(std::max(longest2, value_of(longest_far2_))) + partition::k_rounding_m;
  }

  /// Tests the motion of a row against the static scene and all other bodies, in the first round. If the
  /// outcome depends on whether bodies of higher priority move, the row is put on the list of waiting rows.
  /// Otherwise it is resolved. Does nothing if the row proposes no motion.
  void propose_and_check(std::uint32_t row) {
    const Motion& motion = crowd_.motions[row];
    if (!motion.moves) return;
    if (leaves_world(motion)) return resolve(row, Outcome::out_of_bounds);
    if (crowd_.shapes[row]->empty()) return resolve(row, Outcome::moved);
    if (may_turn(row)) return resolve_turning(row, conflicts_.waiting_.get());
    Mover mover(crowd_, row);
    if (scene_blocks(mover)) return resolve(row, Outcome::blocked);

    std::array<Dependency, k_listed> others;
    std::uint32_t count = 0;
    const bool blocked = blocked_by_others(mover, [&](std::uint32_t other, const InWay& in_way) {
      if (may_turn(other)) count = k_listed;  // too many
      if (count < k_listed) others[count] = {other, in_way.if_moved};
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

  /// Tries to resolve a waiting row, in a round after the first. The row is blocked if one of the bodies on
  /// which it depends has been resolved and is in its way. The row moves if all these bodies have been
  /// resolved and none is in its way. Otherwise it waits for the next round. The function uses only outcomes
  /// of earlier rounds, so the number of rounds does not depend on the number of threads.
  void resolve_waiting(const Waiting& waiting) {
    if (waiting.count == k_in_zone) {
      // A search among all movers with overlapping zones is only worth its time if this one is resolved.
      if (!is_resolved_before(waiting.first)) return wait(conflicts_.still_waiting_.get(), waiting);
      return resolve_in_zone(waiting.row, conflicts_.still_waiting_.get());
    }
    if (may_turn(waiting.row)) return resolve_turning(waiting.row, conflicts_.still_waiting_.get());
    Answer answer = Answer::free;
    if (waiting.count == k_unlisted) {
      Mover mover(crowd_, waiting.row);
      answer = answer_of_others(mover);
    } else {
      for (std::uint32_t i = 0; i < waiting.count && answer != Answer::blocked; ++i) {
        const Dependency on = conflicts_.others_[waiting.first + i];
        if (!is_resolved_before(on.row()))
          answer = Answer::open;
        else if ((resolution(on.row()).outcome() == Outcome::moved) == on.if_moved())
          answer = Answer::blocked;
      }
    }
    if (answer == Answer::open) return wait(conflicts_.still_waiting_.get(), waiting);
    resolve(waiting.row, answer == Answer::blocked ? Outcome::blocked : Outcome::moved);
  }
  /// Begins the next round. Returns the number of rows that still wait after the previous round; 0: all rows
  /// are resolved.
  std::size_t next_round() {
    ++round_;
    return waiting_count_.exchange(0, std::memory_order_relaxed);
  }
  std::uint32_t round() const { return round_; }
  /// Sets the row's element of Crowd::blocks, after all rows are resolved.
  void explain(std::uint32_t row) const;

  // ---- Only if the world has pushable bodies: engine/conflicts/pushing.cpp. The *zone* of a row is a circle
  // that contains everything that its motion could touch or push (class Conflicts, `source`).

  /// Finds the largest radius of the zones of the rows [first, last). The maximum over all rows determines
  /// how far to search for overlapping zones. Call it for all rows before find_zone().
  void bound_zones(std::size_t first, std::size_t last);
  /// Sets the kind of the row's zone: Zone::pushes if the row can push and a pushable body is in the zone,
  /// otherwise Zone::plain. Call it for all rows before widen_zone().
  void find_zone(std::uint32_t row);
  /// Changes the kind of the row's zone from Zone::plain to Zone::may_push if the zone overlaps a zone of
  /// kind Zone::pushes: the row of that other zone may push a body into this row's zone.
  void widen_zone(std::uint32_t row);
  bool is_plain(std::uint32_t row) const { return conflicts_.zones_[row] == Zone::plain; }
  /// Does the work of propose_and_check() for a row whose zone is of kind Zone::pushes or Zone::may_push.
  void propose_and_check_in_zone(std::uint32_t row);
  /// Resolves the row if earlier rounds have resolved all movers of higher priority whose zones overlap the
  /// row's zone. Otherwise appends the row to `list`, a list of waiting rows.
  void resolve_in_zone(std::uint32_t row, Waiting* list);

 private:
  static constexpr std::uint32_t k_in_zone = k_unlisted - 1;

  /// Whether the body of the row overlaps another mobile body, both at their old poses.
  [[gnu::noinline]] bool overlaps_another(std::uint32_t row) const {
    const ObstacleShape& shape = *crowd_.shapes[row];
    if (shape.empty()) return false;
    const PlacedShape here(shape, crowd_.transforms[row], crowd_.poses[row].z);
    bool overlaps = false;
    index_.for_each_near(Box::around(here.position(), shape.radius), [&](const BodyCircle& circle) {
      if (overlaps || circle.row == row || crowd_.shapes[circle.row]->empty()) return;
      const PlacedShape there(*crowd_.shapes[circle.row], crowd_.transforms[circle.row],
                              crowd_.poses[circle.row].z);
      overlaps = meet(row, here, circle.row, there);
    });
    return overlaps;
  }
  bool is_mover(std::size_t row) const {
    return crowd_.motions[row].moves && !crowd_.shapes[row]->empty() && !leaves_world(crowd_.motions[row]);
  }
  Resolution resolution(std::uint32_t row) const {
    return atomic(conflicts_.resolutions_[row]).load(std::memory_order_acquire);
  }
  /// Place of a body at the turn of the mover (class Conflicts, `rule`), world frame: transform `at` and
  /// height `z`, m.
  struct Place {
    Transform at;
    double z;
  };
  /// Whether a body is in the way of a mover, at each of the places where it may be at the turn of the mover.
  struct InWay {
    bool if_stays, if_moved, if_turned;

    bool if_it(Outcome outcome) const {
      return outcome == Outcome::moved ? if_moved : outcome == Outcome::turned ? if_turned : if_stays;
    }
  };
  enum class Answer : std::uint8_t { free, blocked, open };  // open: it depends on rows that are not resolved

  /// Whether the row turns on the spot if its motion is blocked (class Conflicts, `turning`).
  bool may_turn(std::uint32_t row) const {
    if (crowd_.turns.empty() || crowd_.turns[row] == 0) return false;
    const Motion& motion = crowd_.motions[row];
    return motion.moves && motion.turn != 0 && motion.to.position() != crowd_.poses[row].position();
  }
  Motion turn_of(std::uint32_t row) const {
    const Motion& motion = crowd_.motions[row];
    const Pose& from = crowd_.poses[row];
    return {{from.x, from.y, from.z, motion.to.heading}, motion.rotation, motion.turn, true};
  }
  /// Whether other bodies block the mover, as far as earlier rounds have resolved those on which this
  /// depends.
  Answer answer_of_others(Mover& mover) const {
    bool open = false;
    const bool blocked = blocked_by_others(mover, [&](std::uint32_t other, const InWay& in_way) {
      const bool resolved = is_resolved_before(other);
      open = open || !resolved;
      return resolved && in_way.if_it(resolution(other).outcome());
    });
    return blocked ? Answer::blocked : open ? Answer::open : Answer::free;
  }
  Answer answer_of(Mover& mover) const {
    return scene_blocks(mover) ? Answer::blocked : answer_of_others(mover);
  }
  /// Tries to resolve a row that may turn. Appends it to `list`, a list of waiting rows, if it depends on
  /// rows that are not resolved.
  void resolve_turning(std::uint32_t row, Waiting* list) {
    Mover mover(crowd_, row);
    Answer answer = answer_of(mover);
    if (answer == Answer::free) return resolve(row, Outcome::moved);
    if (answer == Answer::blocked) {
      const Motion turn = turn_of(row);
      Mover turning(crowd_, row, turn);
      answer = answer_of(turning);
      if (answer != Answer::open)
        return resolve(row, answer == Answer::free ? Outcome::turned : Outcome::blocked);
    }
    wait(list, {row, 0, k_unlisted});
  }
  bool is_resolved_before(std::uint32_t row) const {
    const Resolution found = resolution(row);
    return found.round() > conflicts_.base_ && found.round() < round_;
  }

  /// The earliest sample at which the motion of a mover is blocked, and the body that blocks it there: a
  /// static one if there is any, and of several the one with the lowest id.
  struct Earliest {
    std::size_t sample = 0;  // 0: not blocked
    bool is_static = false;
    BodyId body;
    Place place;  // of the body, unless it is static

    /// Notes that a body blocks the motion at sample `at`, unless that is 0 or comes later.
    void take(std::size_t at, bool is_static_body, BodyId by, const Place& its_place);
  };
  void take(Earliest& earliest, Mover& mover, std::uint32_t other, const Place& place) const;
  void set_block(const Earliest& earliest, Mover& mover) const;

  // ---- Pushing: engine/conflicts/pushing.cpp
  class RowList;
  struct Pushed;
  struct Halt;
  bool is_pushable(std::uint32_t row) const;
  double zone_radius(std::size_t row) const;
  template <class Visit>
  void for_each_zone(std::uint32_t row, Visit&& visit) const;
  Place place_now(const Mover& mover, std::uint32_t row) const;
  Place place_at_turn(const Mover& mover, std::uint32_t row) const;
  Outcome outcome_before(const Mover& mover, std::uint32_t row) const;
  std::span<const Push> pushes_before(const Mover& mover, std::uint32_t row) const;
  const Push* last_push(const Mover& mover, std::uint32_t row) const;
  Vec2 position_now(const Mover& mover, std::uint32_t row) const;
  Transform pushed_to(std::uint32_t row, const Vec2& position) const;
  bool goes_first(std::uint32_t a, std::uint32_t b) const;
  bool meet(std::uint32_t a, const PlacedShape& at_a, std::uint32_t b, const PlacedShape& at_b) const;
  void find_near(Mover& mover, std::size_t limit, RowList& pushable, RowList& others) const;
  bool push(Mover& mover);
  void explain_in_zone(Mover& mover, Earliest& earliest) const;
  std::size_t push_limit(std::uint32_t row) const;
  BodyId stopper(const Mover& mover, const Pushed& pushed, std::span<const std::uint32_t> bodies) const;
  void record(std::uint32_t row, std::span<const Pushed> pushed);
  bool make_way(const Mover& mover, const PlacedShape& placed, std::span<const std::uint32_t> pushable,
                std::size_t limit, std::array<Pushed, k_most_pushed>& set, std::size_t& count,
                Halt* halt = nullptr) const;
  template <class Before>
  bool holds(const Mover& mover, std::uint32_t pushed, const PlacedShape& there, Before&& before,
             std::uint32_t row) const;
  bool can_stand(const Mover& mover, const Pushed& pushed, std::span<const std::uint32_t> bodies) const;

  Transform turned(std::uint32_t row) const {
    return {crowd_.transforms[row].position, crowd_.motions[row].rotation};
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

  /// Whether the mover's free circle contains the whole motion, so that the static scene cannot block the
  /// motion. If the stored circle does not contain the motion, the function computes and stores a new circle,
  /// unless that would certainly be too small as well.
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

  bool scene_blocks(Mover& mover) const { return blocked_by_scene_at(mover) != 0; }
  /// The earliest sample at which the static scene blocks the mover (class Conflicts, `rule`); 0: none. A
  /// body with a free circle did not overlap the scene when the circle was computed, and no motion makes it
  /// overlap the scene. So only a body without one may overlap the scene at its old pose.
  std::size_t blocked_by_scene_at(Mover& mover) const {
    if (!scene_.has_obstacles()) return 0;
    const bool overlaps = crowd_.free[mover.row].radius == 0 && scene_.overlaps(mover.here());
    if (!overlaps && clear_of_scene(mover)) return 0;
    const std::size_t n = mover.samples();
    if (overlaps) {
      for (std::size_t k = 1; k <= n; ++k)
        if (scene_.deepens(mover.at_sample(k - 1), mover.at_sample(k))) return k;
      return 0;
    }
    const auto crosses = [&](const PlacedShape& placed) {
      return scene_.crossed(placed, [](std::uint32_t) { return false; }) >= 0;
    };
    for (std::size_t k = 1; k < n; ++k)
      if (crosses(PlacedShape(mover.shape, mover.between(k)))) return k;
    return crosses(mover.there()) ? n : 0;
  }

  /// Calls visit(row) for the row of every body that may come near the mover during the tick. Some visited
  /// bodies may be farther away, and the mover itself is also visited.
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
    std::vector<std::uint32_t> more;  // sorted; visited rows beyond the first 32, which few movers have
    const auto is_repeat = [&](std::uint32_t row) {
      if (std::find(visited.begin(), visited.begin() + visits, row) != visited.begin() + visits) return true;
      if (visits < visited.size()) {
        visited[visits++] = row;
        return false;
      }
      const auto place = std::ranges::lower_bound(more, row);
      if (place != more.end() && *place == row) return true;
      more.insert(place, row);
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

  /// Whether another body blocks the mover in any case. A body of higher priority that proposes a motion may
  /// be at its old or at its new pose when the mover moves, or may have turned at its old position. If it is
  /// in the mover's way at all these poses, it blocks the mover. If it is in the way at only some of them,
  /// the function calls depends(row, in_way) with the row of the body. depends() must return true if it is
  /// already known that the body blocks the mover.
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
      InWay in_way{if_it_stays, blocks(mover, other, theirs.to.z, theirs.there()), if_it_stays};
      if (may_turn(other)) in_way.if_turned = blocks(mover, other, crowd_.poses[other].z, turned(other));
      blocked = in_way.if_stays;
      if (in_way.if_stays != in_way.if_moved || in_way.if_stays != in_way.if_turned)
        blocked = depends(other, in_way);
    });
    return blocked;
  }

  /// A fast test of whether pieces (convex prisms) of two bodies may come near each other. If it returns
  /// false, no piece of the mover comes near a piece of the other body during the whole motion, and no exact
  /// test is needed. If it returns true, they may.
  ///
  /// shape: shape of the other body
  /// at: transform of the other body, world frame
  bool parts_come_near(const Mover& mover, const ObstacleShape& shape, const Transform& at) const {
    if (mover.shape.pieces.size() == 1 && shape.pieces.size() == 1) return true;
    return partition::pieces_in_reach(mover.shape, crowd_.transforms[mover.row], shape, at,
                                      mover.displacement() + partition::k_rounding_m);
  }

  bool blocks(Mover& mover, std::uint32_t other, double z, const Transform& at) const {
    return blocked_at(mover, other, z, at) != 0;
  }
  /// The earliest sample at which another body is in the way of the mover: at which the two overlap, and did
  /// not overlap at the sample before, or less deeply (class Conflicts, `rule`). 0: there is none.
  ///
  /// other: row of the other body
  /// z: height of the other body, m
  /// at: transform of the other body, world frame
  std::size_t blocked_at(Mover& mover, std::uint32_t other, double z, const Transform& at) const {
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
      if (!theirs && !parts_come_near(mover, shape, at)) return 0;
      if (!(k < n ? meet(PlacedShape(mover.shape, between)) : meet(mover.there()))) continue;
      if (!crowd_.free[mover.row].may_overlap && !crowd_.free[other].may_overlap) return k;
      return deepens_at(mover, k, last_k, other, *theirs);
    }
    return 0;
  }
  /// The earliest sample at which the motion takes the mover deeper into another body, in which it is for the
  /// first time at sample k; 0: there is none.
  [[gnu::noinline]] std::size_t deepens_at(Mover& mover, std::size_t k, std::size_t last_k,
                                           std::uint32_t other, const PlacedShape& theirs) const {
    for (; k <= last_k; ++k) {
      const PlacedShape after = mover.at_sample(k);
      if (!meet(mover.row, after, other, theirs)) continue;
      const PlacedShape before = mover.at_sample(k - 1);
      if (!meet(mover.row, before, other, theirs) || partition::deepens(before, after, theirs)) return k;
    }
    return 0;
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
};

}  // namespace troupe::engine
