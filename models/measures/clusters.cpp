#include "models/measures/clusters.hpp"

#include "engine/rows/measured_world.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string_view>

namespace troupe::models {
namespace {

using engine::Measure;
using engine::MeasuredWorld;
using engine::Unit;

/// The bodies whose clusters are counted.
enum class Bodies : std::uint8_t { pushable, robots };
constexpr std::array<std::string_view, 2> names_of(Bodies) { return {"pushable", "robots"}; }

/// Base of the measures of clusters of bodies. It finds the clusters by union-find.
class Clusters : public Measure {
 public:
  struct Params {
    double distance = 0;
    Bodies bodies = Bodies::pushable;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      d.member<&Params::distance>(
          "distance", Unit::meters, above(0), at_most(1000), required,
          "two bodies are in one cluster if their origins are at most this far apart, or if a chain of such "
          "bodies connects them");
      d.member<&Params::bodies>("bodies",
                                "the bodies that form clusters. pushable: all pushable bodies; robots: the "
                                "robots that the key `of` of the measure selects");
    }
  };

  Clusters(const MeasuredWorld& world, const Params& params, const std::vector<BodyId>& robots)
      : distance_(params.distance),
        parents_(world.rows()),
        sizes_(world.rows()),
        is_member_(world.spec().bodies.size()),
        counts_(world.rows()) {
    const auto is_pushable = [](const engine::BodyType& type) { return type.pushable; };
    if (params.bodies == Bodies::pushable && std::ranges::none_of(world.types(), is_pushable))
      throw std::invalid_argument(
          "the world has no pushable bodies: for clusters of robots, give \"bodies\": \"robots\"");
    for (std::size_t row = 0; row < world.rows(); ++row)
      is_member_[world.body(Row(row)).index()] =
          params.bodies == Bodies::pushable && world.type(Row(row)).pushable;
    if (params.bodies == Bodies::robots)
      for (const BodyId id : robots) is_member_[id.index()] = true;
  }

 protected:
  struct Count {
    std::size_t bodies = 0;
    std::size_t clusters = 0;
    std::size_t largest = 0;
  };
  Count count(const MeasuredWorld& world) {
    std::iota(parents_.begin(), parents_.end(), 0u);
    std::ranges::fill(sizes_, 0u);
    for (std::size_t row = 0; row < world.rows(); ++row)
      counts_[row] = is_member_[world.body(Row(row)).index()] && world.is_there(Row(row));
    Count found;
    for (std::uint32_t row = 0; row < world.rows(); ++row) {
      if (!counts_[row]) continue;
      ++found.bodies;
      const Vec2 here = world.transform(Row(row)).position;
      world.index().for_each_near(Box::around(here, distance_), [&](const partition::BodyCircle& circle) {
        if (circle.row >= row || !counts_[circle.row]) return;
        if ((world.transform(Row(circle.row)).position - here).squaredNorm() <= distance_ * distance_)
          parents_[root(row)] = root(circle.row);
      });
    }
    for (std::uint32_t row = 0; row < world.rows(); ++row)
      if (counts_[row]) ++sizes_[root(row)];
    for (const std::uint32_t size : sizes_) {
      found.clusters += size > 0;
      found.largest = std::max<std::size_t>(found.largest, size);
    }
    return found;
  }

 private:
  std::uint32_t root(std::uint32_t row) {
    while (parents_[row] != row) row = parents_[row] = parents_[parents_[row]];
    return row;
  }

  double distance_;
  // Scratch memory of count(), except is_member_.
  std::vector<std::uint32_t> parents_;  // union-find forest, per row
  std::vector<std::uint32_t> sizes_;    // number of bodies in the cluster, at the row that is its root
  std::vector<bool> is_member_;         // per body: whether it is of the sort that `bodies` selects
  std::vector<bool> counts_;            // per row: whether its body is such a body, and in the world
};

class ClusterCount : public Clusters {
 public:
  using Clusters::Clusters;
  double value(const MeasuredWorld& world) override { return static_cast<double>(count(world).clusters); }
};

class LargestCluster : public Clusters {
 public:
  using Clusters::Clusters;
  double value(const MeasuredWorld& world) override {
    const Count found = count(world);
    if (found.bodies == 0) return std::numeric_limits<double>::quiet_NaN();
    return static_cast<double>(found.largest) / static_cast<double>(found.bodies);
  }
};

}  // namespace

engine::MeasureKind clusters_measure() {
  return engine::make_measure_kind<ClusterCount>(
      "clusters", Unit::none, "number of clusters of pushable bodies or of robots",
      "The number of connected components of the graph that joins all pairs of bodies whose origins are at "
      "most `distance` apart. By default the bodies are all pushable bodies, and the key `of` of the measure "
      "has no effect; it is an error if the world has no pushable type. With `bodies`: \"robots\" they are "
      "the robots that `of` selects. A body without neighbours is a cluster of one. Source, for aggregates "
      "of robots: Garnier et al., The embodiment of cockroach aggregation behavior in a group of "
      "micro-robots, Artificial Life 14, 2008.",
      "number of components of the graph {(i, j): |x_i - x_j| <= distance}");
}

engine::MeasureKind largest_cluster_measure() {
  return engine::make_measure_kind<LargestCluster>(
      "largest_cluster", Unit::none,
      "fraction of the pushable bodies or of the robots that are in the largest cluster",
      "The number of bodies in the largest cluster, divided by the number of bodies in all clusters. "
      "Clusters are defined as for the measure `clusters`. The value is NaN if there are no bodies that can "
      "form clusters. Source, for aggregates of robots: Gauci et al., Self-organized aggregation without "
      "computation, International Journal of Robotics Research 33, 2014.",
      "max_c |c| / sum_c |c|, over the clusters c");
}

}  // namespace troupe::models
