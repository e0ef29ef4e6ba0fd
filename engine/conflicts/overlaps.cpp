#include "engine/conflicts/overlaps.hpp"

#include "base/sort.hpp"
#include "partition/placed_shape.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

namespace troupe::engine {
namespace {

// Thousands of bodies at one place form millions of pairs, and counting them all would take a minute. The
// search therefore ends once it has found more pairs than k_most_counted. The pairs that it has found by then
// do not depend on the number of threads.
constexpr std::size_t k_most_counted = 10'000;
constexpr std::size_t k_most_listed = 100;  // most pairs with a warning of their own

/// The pairs of bodies that a search has found to overlap.
struct Pairs {
  std::size_t count = 0;                          ///< number of pairs
  std::vector<std::pair<BodyId, BodyId>> listed;  ///< the first pairs that were found

  bool are_too_many() const { return count > k_most_counted; }
};

/// Finds the pairs of bodies that overlap. `most_listed` is the largest length of Pairs::listed.
class OverlapSearch {
 public:
  OverlapSearch(const WorldState& state, std::size_t most_listed)
      : state_(state), poses_(state.poses()), most_listed_(most_listed) {}

  Pairs find(partition::Parallel& parallel) const {
    constexpr std::size_t k_bodies = 256;  // bodies per task
    constexpr std::size_t k_tasks = 64;    // tasks per parallel loop
    const std::size_t count = state_.rows.size();
    Pairs all;
    for (std::size_t first = 0; first < count && !all.are_too_many(); first += k_bodies * k_tasks) {
      const std::size_t end = std::min(count, first + k_bodies * k_tasks);
      std::vector<Pairs> found((end - first + k_bodies - 1) / k_bodies);  // one element per task
      parallel.for_batches(end - first, k_bodies, [&](std::size_t from, std::size_t to) {
        find_among(first + from, first + to, found[from / k_bodies]);
      });
      for (const Pairs& pairs : found) append(pairs, all);
    }
    return all;
  }

 private:
  /// Adds the pairs whose first body has an id of at least `first` and less than `end`. Stops when `found`
  /// has too many pairs.
  void find_among(std::size_t first, std::size_t end, Pairs& found) const {
    std::vector<BodyId> near;
    for (std::size_t b = first; b < end && !found.are_too_many(); ++b) add_pairs_of(BodyId(b), near, found);
  }

  /// Adds the pairs of a body with static bodies, and then those with bodies that have rows and higher ids.
  /// Both are in the order of ids, so that the result does not depend on the cells of the spatial index.
  /// `near` is scratch memory.
  void add_pairs_of(BodyId body, std::vector<BodyId>& near, Pairs& found) const {
    const Row row = state_.view.row(body);
    if (!row.valid() || shape(row).empty()) return;
    if (state_.scene.has_obstacles())
      for (const BodyId wall : state_.scene.overlapping(shape(row), poses_[row.index()]))
        add(body, wall, found);
    find_near(row, near);
    const partition::PlacedShape own = placed(row);
    for (const BodyId other : near) {
      if (found.are_too_many()) return;
      if (overlap(own, placed(state_.view.row(other)))) add(body, other, found);
    }
  }

  /// Sets `near` to the bodies with higher ids that may overlap the body of a row, in order of ids.
  void find_near(Row row, std::vector<BodyId>& near) const {
    near.clear();
    const ZInterval z = heights(row);
    state_.index.for_each_near(Box::around(state_.transforms[row.index()].position, shape(row).radius),
                               [&](const partition::BodyCircle& circle) {
                                 const Row other(circle.row);
                                 if (state_.bodies[other.index()] > state_.bodies[row.index()] &&
                                     !shape(other).empty() && z.overlaps(heights(other)))
                                   near.push_back(state_.bodies[other.index()]);
                               });
    sort_ids(near);
  }

  const partition::ObstacleShape& shape(Row row) const { return *state_.shapes[row.index()]; }
  ZInterval heights(Row row) const { return shape(row).z.shifted(poses_[row.index()].z); }
  partition::PlacedShape placed(Row row) const {
    return {shape(row), state_.transforms[row.index()], poses_[row.index()].z};
  }

  void add(BodyId body, BodyId other, Pairs& pairs) const {
    ++pairs.count;
    if (pairs.listed.size() < most_listed_) pairs.listed.emplace_back(body, other);
  }

  void append(const Pairs& pairs, Pairs& all) const {
    all.count += pairs.count;
    const std::size_t taken = std::min(pairs.listed.size(), most_listed_ - all.listed.size());
    all.listed.insert(all.listed.end(), pairs.listed.begin(),
                      pairs.listed.begin() + static_cast<std::ptrdiff_t>(taken));
  }

  const WorldState& state_;
  std::span<const Pose> poses_;
  std::size_t most_listed_;
};

void report_below_floor(const WorldState& state, Diagnostics& diagnostics) {
  const std::span<const Pose> poses = state.poses();
  for (const Row row : state.rows) {
    if (!row.valid() || state.shapes[row.index()]->empty()) continue;
    if (state.shapes[row.index()]->z.min + poses[row.index()].z < 0)
      diagnostics.warning_once(state.spec.bodies[state.bodies[row.index()].index()].where,
                               "a body extends below the floor (z = 0), which is not an obstacle: raise the "
                               "body, if this is not intended");
  }
}

/// Returns the beginning of a warning about `count` pairs.
///
/// what: empty, or a word that describes the pairs, followed by a space
/// is_least: whether there are further pairs, which were not counted
std::string count_text(std::size_t count, std::string_view what, bool is_least) {
  if (is_least) return fmt::format("more than {} {}pairs of bodies overlap", count, what);
  if (count == 1) return fmt::format("1 {}pair of bodies overlaps", what);
  return fmt::format("{} {}pairs of bodies overlap", count, what);
}

/// Adds one warning about all pairs, which names the first pair.
void report_count(const WorldSpec& spec, const Pairs& pairs, Diagnostics& diagnostics) {
  const std::size_t counted = std::min(pairs.count, k_most_counted);
  const auto [first, second] = pairs.listed.front();
  diagnostics.warning(
      spec.bodies[first.index()].where,
      fmt::format("{} at the start{} \"{}\" and \"{}\"; bodies that overlap may move apart, but "
                  "not deeper into each other",
                  count_text(counted, "", pairs.are_too_many()), counted == 1 ? ":" : ", for example",
                  spec.name(first), spec.name(second)));
}

/// Adds one warning for each pair in Pairs::listed, and one for all other pairs together.
void report_each(const WorldState& state, const Pairs& pairs, Diagnostics& diagnostics) {
  const WorldSpec& spec = state.spec;
  const auto where = [&](BodyId body) { return spec.bodies[body.index()].where; };
  for (const auto& [first, second] : pairs.listed)
    diagnostics.warning(where(first), fmt::format("\"{}\" {} \"{}\" at the start", spec.name(first),
                                                  state.view.location(second) != RowLocation::none
                                                      ? "overlaps"
                                                      : "overlaps the static body",
                                                  spec.name(second)));
  const std::size_t more = std::min(pairs.count, k_most_counted) - pairs.listed.size();
  if (more > 0)
    diagnostics.warning(where(pairs.listed.back().first),
                        fmt::format("{} at the start", count_text(more, "more ", pairs.are_too_many())));
}

}  // namespace

void report_overlaps(const WorldState& state, partition::Parallel& parallel, Diagnostics& diagnostics) {
  report_below_floor(state, diagnostics);
  const Pairs pairs = OverlapSearch(state, diagnostics.thorough() ? k_most_listed : 1).find(parallel);
  if (pairs.count == 0) return;
  if (diagnostics.thorough())
    report_each(state, pairs, diagnostics);
  else
    report_count(state.spec, pairs, diagnostics);
}

}  // namespace troupe::engine
