#include "models/measures/nearness.hpp"

#include "engine/observing/robot_sums.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace troupe::models {
namespace {

using engine::Measure;
using engine::MeasuredWorld;
using engine::Unit;

constexpr std::size_t k_batch = 256;  // robots per task

/// Base of the measures that find the neighbours of robots through the spatial index.
class AmongRobots : public Measure {
 public:
  AmongRobots(const MeasuredWorld& world, std::vector<BodyId> robots)
      : robots_(std::move(robots)), measured_(world.rows(), 0) {}

 protected:
  std::span<const BodyId> robots() const { return robots_; }

  /// Calls work(row) for all robots of the list robots() that are in the world, on several threads. The
  /// robots are visited in the order of the spatial index, in which robots that are near each other follow
  /// one another. So the data of neighbours are in the cache.
  template <class Work>
  void for_each_robot(const MeasuredWorld& world, Work&& work) {
    std::ranges::fill(measured_, std::uint8_t{0});
    for (const BodyId id : robots_) measured_[world.row(id).index()] = 1;
    const std::span<const std::uint32_t> order = world.index().order();
    world.parallel().for_batches(order.size(), k_batch, [&](std::size_t first, std::size_t end) {
      for (const std::uint32_t row : order.subspan(first, end - first))
        if (measured_[row]) work(row);
    });
  }

  /// Calls visit(d2) for other robots of the list robots(), where d2 is the squared distance (m^2) from the
  /// robot in `row` to the other robot. It searches the box of half-width `radius` (m) around the robot in
  /// `row`. It visits all robots in this box that are within the distance `reach` (m), and may visit some
  /// that are farther away. `reach` is a reference because visit() may reduce it during the search. Only the
  /// function `work` of for_each_robot() may call it.
  template <class Visit>
  void for_each_other(const MeasuredWorld& world, std::uint32_t row, double radius, const double& reach,
                      Visit&& visit) const {
    constexpr double k_round = 1 + 1e-9;  // covers the rounding of the products compared below
    const Vec2 place = world.transform(Row(row)).position;
    // The index visits every body whose origin is in the box, once.
    world.index().for_each_near(Box::around(place, radius), [&](const partition::BodyCircle& other) {
      if (other.row == row || !measured_[other.row]) return;
      // `other` holds the position rounded to float. Its radius is large enough to cover the rounding.
      const double x = other.x - place.x();
      const double y = other.y - place.y();
      const double far = (reach + other.radius) * k_round;
      if (x * x + y * y > far * far) return;
      visit((world.transform(Row(other.row)).position - place).squaredNorm());
    });
  }

 private:
  std::vector<BodyId> robots_;
  std::vector<std::uint8_t> measured_;  // scratch memory of for_each_robot(): per row, 1: one of robots_
};

class MeanNearestDistance : public AmongRobots {
 public:
  MeanNearestDistance(const MeasuredWorld& world, std::vector<BodyId> robots)
      : AmongRobots(world, std::move(robots)), distances_(world.spec().bodies.size(), 0) {}

  double value(const MeasuredWorld& world) override {
    const std::size_t there = engine::count_there(world, robots());
    if (there < 2) return std::numeric_limits<double>::quiet_NaN();
    for_each_robot(world, [&](std::uint32_t row) {
      double& distance = distances_[world.body(Row(row)).index()];
      distance = nearest(world, row, distance);
    });
    const double sum = engine::exact_sum(world, robots().size(), [&](std::size_t i) {
      return world.is_there(world.row(robots()[i])) ? distances_[robots()[i].index()] : 0.0;
    });
    return sum / static_cast<double>(there);
  }

 private:
  /// Distance from the robot in `row` to the nearest other robot, m. Searches boxes of growing size, until
  /// the distance of the nearest robot found is at most the half-width of the box: then no robot outside the
  /// box is nearer. The search ends because the caller ensures that there is another robot. The first
  /// half-width is slightly more than the distance `last` at the last call. It affects only the computing
  /// time.
  double nearest(const MeasuredWorld& world, std::uint32_t row, double last) const {
    double radius = std::max(1.25 * last, 0.1 * world.geometry().cell_m);
    for (;;) {
      double best = std::numeric_limits<double>::infinity();
      for_each_other(world, row, radius, best,
                     [&](double squared) { best = std::min(best, std::sqrt(squared)); });
      if (best <= radius) return best;
      radius = std::min(best, 2 * radius);
    }
  }

  std::vector<double> distances_;  // per body, distance to the nearest other robot at the last value(), m
};

class Neighbours : public AmongRobots {
 public:
  struct Params {
    double radius = 1;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      d.member<&Params::radius>("radius", Unit::meters, above(0), at_most(1000),
                                "greatest distance between the origins of two neighbours");
    }
  };

  Neighbours(const MeasuredWorld& world, const Params& params, std::vector<BodyId> robots)
      : AmongRobots(world, std::move(robots)), radius_(params.radius), counts_(world.rows(), 0) {}

  double value(const MeasuredWorld& world) override {
    const std::size_t there = engine::count_there(world, robots());
    if (there == 0) return std::numeric_limits<double>::quiet_NaN();
    for_each_robot(world, [&](std::uint32_t row) {
      std::uint32_t count = 0;
      for_each_other(world, row, radius_, radius_,
                     [&](double squared) { count += squared <= radius_ * radius_; });
      counts_[row] = count;
    });
    std::uint64_t sum = 0;
    for (const BodyId id : robots())
      if (const Row row = world.row(id); world.is_there(row)) sum += counts_[row.index()];
    return static_cast<double>(sum) / static_cast<double>(there);
  }

 private:
  double radius_;
  std::vector<std::uint32_t> counts_;  // scratch memory of value(): per row, number of neighbours
};

}  // namespace

engine::MeasureKind mean_nearest_distance_measure() {
  return engine::make_measure_kind<MeanNearestDistance>(
      "mean_nearest_distance", Unit::meters, "mean distance to the nearest other robot",
      "The mean over the robots of the distance from a robot's origin to the origin of the nearest other "
      "robot, among the robots that the key `of` of the measure selects. Walls between two robots make no "
      "difference. The value is NaN for fewer than two robots. Source: Clark and Evans, Distance to nearest "
      "neighbor as a measure of spatial relationships in populations, Ecology 35, 1954.",
      "1/n sum_i min_(j != i) |x_i - x_j|");
}

engine::MeasureKind neighbours_measure() {
  return engine::make_measure_kind<Neighbours>(
      "neighbours", Unit::none, "mean number of other robots nearby",
      "The mean over the robots of the number of other robots, among those that the key `of` of the measure "
      "selects, whose origin is within `radius` of the robot's origin. Walls between two robots make no "
      "difference. The value is the mean degree of the graph that joins all pairs of robots within that "
      "distance. Source, for such graphs: Penrose, Random geometric graphs, Oxford University Press, 2003.",
      "1/n sum_i sum_(j != i) [|x_i - x_j| <= radius]");
}

}  // namespace troupe::models
