#include "engine/conflicts.hpp"

#include "base/random.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <utility>

namespace troupe::engine {
namespace {

using partition::BodyCircle;
using partition::ObstacleShape;

constexpr std::size_t k_batch = 64;  // rows a task

// A motion that is longer than this is far. A few bodies with far motions are looked at one by one, so that
// they do not widen everybody's search.
constexpr double k_far_m = 0.5;
constexpr std::size_t k_few_far = 64;

// A row's state while motions settle. A round reads only what earlier rounds settled, so that the number of
// rounds, too, is the same on any number of threads.
constexpr std::uint32_t k_open = 0;
constexpr std::uint32_t k_stays = 1;
constexpr std::uint32_t k_moves = 2;
constexpr std::uint32_t k_state = 3;

double length2(const Motion& m) { return (m.to.position() - m.from.position()).squaredNorm(); }

bool is_far(const Motion& m) { return m.moves && length2(m) > k_far_m * k_far_m; }

Box swept(const Motion& m, double radius) {
  Box box = Box::around(m.from.position(), radius);
  if (m.moves) box.extend(Box::around(m.to.position(), radius));
  return box;
}

/// The samples of a motion at which its origin may lie within `reach` of a point, and some to either side;
/// none: first > last. For slow motions that is all of them; a fast one takes thousands.
std::pair<std::size_t, std::size_t> samples_near(const Motion& m, std::size_t n, const Vec2& point,
                                                 double reach) {
  constexpr std::size_t k_few = 8;
  const Vec2 along = m.to.position() - m.from.position();
  const double length2 = along.squaredNorm();
  if (n <= k_few || length2 == 0) return {1, n};
  const double samples = static_cast<double>(n);
  const double middle = along.dot(point - m.from.position()) / length2 * samples;
  const double half = (reach + partition::k_rounding_m) / sqrt(length2) * samples + 2;
  const double first = std::clamp(middle - half, 1.0, samples);
  const double last = std::clamp(middle + half, 0.0, samples);
  return {static_cast<std::size_t>(first), static_cast<std::size_t>(last)};
}

class Rule {
 public:
  Rule(const Conflicts::Crowd& crowd, const partition::StaticScene& scene) : crowd_(crowd), scene_(scene) {}

  bool leaves_world(const Motion& m) const { return !crowd_.bounds.contains(m.to.position()); }

  bool scene_refuses(std::size_t row) const {
    if (!scene_.has_obstacles()) return false;
    const Motion& m = crowd_.motions[row];
    const ObstacleShape& shape = *crowd_.shapes[row];
    const std::size_t n = motion_samples(m, shape);
    // A body in a floor plan crosses many of its edges: one answer for all of them.
    std::uint32_t known = ~0u;
    const auto already_in = [&](std::uint32_t solid) {
      if (solid == known) return true;
      if (!scene_.overlaps_solid(solid, shape, m.from)) return false;
      known = solid;
      return true;
    };
    for (std::size_t k = 1; k <= n; ++k)
      if (scene_.crossed(shape, motion_pose(m, k, n), already_in) >= 0) return true;
    return false;
  }

  /// Does `other`, standing at this pose, refuse the row's motion?
  bool body_refuses(std::size_t row, std::size_t other, const Pose& other_pose) const {
    const Motion& m = crowd_.motions[row];
    const std::size_t n = motion_samples(m, *crowd_.shapes[row]);
    const auto [first, last] =
        samples_near(m, n, other_pose.position(), crowd_.shapes[row]->radius + crowd_.shapes[other]->radius);
    for (std::size_t k = first; k <= last; ++k) {
      if (!meet(row, motion_pose(m, k, n), other, other_pose)) continue;
      const Vec2 there = other_pose.position();
      const bool apart = (m.to.position() - there).squaredNorm() > (m.from.position() - there).squaredNorm();
      return !(apart && meet(row, m.from, other, other_pose));
    }
    return false;
  }

 private:
  bool meet(std::size_t a, const Pose& pose_a, std::size_t b, const Pose& pose_b) const {
    return crowd_.ids[a] < crowd_.ids[b] ? overlap(*crowd_.shapes[a], pose_a, *crowd_.shapes[b], pose_b)
                                         : overlap(*crowd_.shapes[b], pose_b, *crowd_.shapes[a], pose_a);
  }

  const Conflicts::Crowd& crowd_;
  const partition::StaticScene& scene_;
};

}  // namespace

std::size_t motion_samples(const Motion& m, const ObstacleShape& shape) {
  const double displacement = (m.to.position() - m.from.position()).norm() + shape.radius * std::abs(m.turn);
  const double samples = displacement / (0.25 * shape.thinnest);
  constexpr double k_most = 1e6;  // a needle at absurd speed must not hang the step
  const double n = samples < k_most ? samples : k_most;
  const auto whole = static_cast<std::size_t>(n);
  return std::max<std::size_t>(1, static_cast<double>(whole) < n ? whole + 1 : whole);
}

Pose motion_pose(const Motion& m, std::size_t k, std::size_t n) {
  if (k == n) return m.to;
  const double t = static_cast<double>(k) / static_cast<double>(n);
  return {m.from.x + t * (m.to.x - m.from.x), m.from.y + t * (m.to.y - m.from.y),
          m.from.z + t * (m.to.z - m.from.z), m.from.heading + t * m.turn};
}

void Conflicts::settle(const Crowd& crowd, const partition::StaticScene& scene,
                       const partition::BodyIndex& index, partition::Parallel& parallel,
                       std::span<Outcome> outcomes) {
  const std::size_t rows = crowd.motions.size();
  const std::size_t batches = (rows + k_batch - 1) / k_batch;
  const Rule rule(crowd, scene);
  work_.resize(batches);
  priority_.resize(rows);
  settled_.resize(rows);
  const auto before = [&](std::size_t a, std::size_t b) {
    return priority_[a] != priority_[b] ? priority_[a] < priority_[b] : crowd.ids[a] < crowd.ids[b];
  };
  const auto state_of = [&](std::size_t row) { return std::atomic_ref(settled_[row]); };

  // Nobody's motion is longer than this: how far out to look for those who may come near.
  parallel.for_each(batches, [&](std::size_t b) {
    Work& work = work_[b];
    work.longest = 0;
    work.far.clear();
    for (std::size_t r = b * k_batch; r < std::min(rows, (b + 1) * k_batch); ++r) {
      const Motion& m = crowd.motions[r];
      settled_[r] = k_open;
      if (!m.moves) continue;
      priority_[r] = mix(crowd.seed, crowd.tick, crowd.ids[r]);
      if (crowd.shapes[r]->empty() || rule.leaves_world(m)) continue;
      if (is_far(m))
        work.far.push_back(static_cast<std::uint32_t>(r));
      else
        work.longest = std::max(work.longest, length2(m));
    }
  });
  double longest = 0;
  far_.clear();
  for (const Work& work : work_) {
    longest = std::max(longest, work.longest);
    far_.insert(far_.end(), work.far.begin(), work.far.end());
  }
  const bool few_far = far_.size() <= k_few_far;
  if (!few_far)
    for (const std::uint32_t row : far_) longest = std::max(longest, length2(crowd.motions[row]));
  longest = sqrt(longest) + partition::k_rounding_m;

  // First round: the static scene, and all who are sure to stand where they are when this body's turn comes.
  // What is left are bodies of higher priority that move too.
  const std::span<const std::uint32_t> order = index.order();
  parallel.for_each(batches, [&](std::size_t b) {
    Work& work = work_[b];
    work.waiting.clear();
    work.others.clear();
    for (std::size_t i = b * k_batch; i < std::min(rows, (b + 1) * k_batch); ++i) {
      const std::uint32_t row = order[i];
      const Motion& m = crowd.motions[row];
      const auto settle = [&](Outcome outcome) {
        outcomes[row] = outcome;
        state_of(row).store(4 + (outcome == Outcome::moved ? k_moves : k_stays), std::memory_order_release);
      };
      if (!m.moves) {
        settle(Outcome::stands);
        continue;
      }
      if (rule.leaves_world(m)) {
        settle(Outcome::held);
        continue;
      }
      const ObstacleShape& shape = *crowd.shapes[row];
      if (shape.empty()) {
        settle(Outcome::moved);
        continue;
      }
      if (rule.scene_refuses(row)) {
        settle(Outcome::refused);
        continue;
      }
      const auto first = static_cast<std::uint32_t>(work.others.size());
      const Box mine = swept(m, shape.radius + partition::k_rounding_m);
      bool refused = false;
      const auto consider = [&](std::uint32_t other) {
        if (refused || other == row || crowd.shapes[other]->empty()) return;
        const Motion& theirs = crowd.motions[other];
        if (!mine.touches(swept(theirs, crowd.shapes[other]->radius))) return;
        if (theirs.moves && before(other, row))
          work.others.push_back(other);
        else
          refused = rule.body_refuses(row, other, theirs.from);
      };
      index.for_each_near(mine.expanded(longest), [&](const BodyCircle& circle) {
        const Motion& theirs = crowd.motions[circle.row];
        const bool one_by_one = few_far && is_far(theirs) && !rule.leaves_world(theirs);
        if (!one_by_one) consider(circle.row);
      });
      if (few_far)
        for (const std::uint32_t other : far_) consider(other);
      if (refused) {
        settle(Outcome::refused);
        work.others.resize(first);
      } else if (work.others.size() == first) {
        settle(Outcome::moved);
      } else {
        work.waiting.push_back({row, first, static_cast<std::uint32_t>(work.others.size()) - first});
      }
    }
  });

  // Further rounds: whoever waits only for bodies that earlier rounds settled is settled now. The body of
  // highest priority among those who wait always is, so this ends.
  rounds_ = 1;
  for (bool anyone_waits = true; anyone_waits;) {
    anyone_waits = std::ranges::any_of(work_, [](const Work& work) { return !work.waiting.empty(); });
    if (!anyone_waits) break;
    const auto round = static_cast<std::uint32_t>(++rounds_);
    parallel.for_each(batches, [&](std::size_t b) {
      Work& work = work_[b];
      std::erase_if(work.waiting, [&](const Waiting& waiting) {
        const std::span<const std::uint32_t> others(&work.others[waiting.first], waiting.count);
        const auto settled_before = [&](std::uint32_t other) {
          const std::uint32_t s = state_of(other).load(std::memory_order_acquire);
          return s != k_open && s / 4 < round;
        };
        if (!std::ranges::all_of(others, settled_before)) return false;
        const bool refused = std::ranges::any_of(others, [&](std::uint32_t other) {
          const bool moved = (state_of(other).load(std::memory_order_relaxed) & k_state) == k_moves;
          return rule.body_refuses(waiting.row, other,
                                   moved ? crowd.motions[other].to : crowd.motions[other].from);
        });
        outcomes[waiting.row] = refused ? Outcome::refused : Outcome::moved;
        state_of(waiting.row).store(round * 4 + (refused ? k_stays : k_moves), std::memory_order_release);
        return true;
      });
    });
  }
}

}  // namespace troupe::engine
