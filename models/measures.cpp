#include "models/measures.hpp"

#include "engine/measures.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace troupe::models {
namespace {

using engine::Measure;
using engine::Record;
using engine::Unit;
using engine::World;

/// A measure of the state alone.
class OfRobots : public Measure {
 public:
  OfRobots(const World&, const Record&, std::vector<Row> robots) : robots_(std::move(robots)) {}

 protected:
  std::span<const Row> robots() const { return robots_; }
  template <class Term>
  double mean(World& world, Term&& term) const {
    if (robots_.empty()) return std::numeric_limits<double>::quiet_NaN();
    const double sum =
        engine::ordered_sum(world, robots_.size(), [&](std::size_t i) { return term(robots_[i]); });
    return sum / static_cast<double>(robots_.size());
  }
  template <class Holds>
  double count(Holds&& holds) const {
    return static_cast<double>(std::ranges::count_if(robots_, holds));
  }

 private:
  std::vector<Row> robots_;
};

class Stalls : public OfRobots {
 public:
  using OfRobots::OfRobots;
  double value(World& world) override {
    return count([&](Row row) { return world.stalled(row); });
  }
};

class Held : public OfRobots {
 public:
  using OfRobots::OfRobots;
  double value(World& world) override {
    return count([&](Row row) { return world.held(row); });
  }
};

class Displacement : public OfRobots {
 public:
  using OfRobots::OfRobots;
  double value(World& world) override {
    return mean(world, [&](Row row) {
      const Pose& start = world.spec().bodies[world.body(row).index()].pose_world_body;
      return (world.transform(row).position - start.position()).norm();
    });
  }
};

class PathLength : public OfRobots {
 public:
  PathLength(const World& world, const Record& params, std::vector<Row> rows)
      : OfRobots(world, params, std::move(rows)), lengths_(robots().size(), 0), tick_(world.tick()) {
    for (const Row row : robots()) places_.push_back(world.transform(row).position);
  }

  void see(World& world) override {
    constexpr std::size_t k_block = 4096;
    if (world.tick() != tick_) set_out_from(world.placed_before_step());
    tick_ = world.tick();
    world.parallel().for_each((lengths_.size() + k_block - 1) / k_block, [&](std::size_t b) {
      for (std::size_t i = b * k_block; i < std::min(lengths_.size(), (b + 1) * k_block); ++i) {
        const Vec2& place = world.transform(robots()[i]).position;
        lengths_[i] += (place - places_[i]).norm();
        places_[i] = place;
      }
    });
  }
  double value(World& world) override {
    if (lengths_.empty()) return std::numeric_limits<double>::quiet_NaN();
    return engine::ordered_sum(world, lengths_.size(), [&](std::size_t i) { return lengths_[i]; }) /
           static_cast<double>(lengths_.size());
  }
  // The places need not be kept: in a state that is put back, they are those where it begins.
  std::span<std::byte> memory() override { return std::as_writable_bytes(std::span(lengths_)); }

 private:
  /// Who was put elsewhere went from there: that it was put there is no way.
  void set_out_from(std::span<const World::Placed> placed) {
    if (placed.empty()) return;
    if (numbers_.empty()) {
      for (std::uint32_t i = 0; i < robots().size(); ++i) numbers_.emplace_back(robots()[i], i);
      std::ranges::sort(numbers_, {}, by_row);
    }
    for (const World::Placed& place : placed) {
      const auto found = std::ranges::lower_bound(numbers_, place.row.index(), {}, by_row);
      if (found != numbers_.end() && found->first == place.row)
        places_[found->second] = place.pose.position();
    }
  }
  static std::size_t by_row(const std::pair<Row, std::uint32_t>& number) { return number.first.index(); }

  std::vector<double> lengths_;                         // beside robots(), as are
  std::vector<Vec2> places_;                            // in the state that was seen last
  std::vector<std::pair<Row, std::uint32_t>> numbers_;  // of robots(), by row; made when somebody is placed
  std::uint64_t tick_;                                  // that was seen last
};

class MeanSpeed : public OfRobots {
 public:
  using OfRobots::OfRobots;
  double value(World& world) override {
    return mean(world, [&](Row row) {
      const engine::Velocity& v = world.velocities()[row.index()];
      return world.stalled(row) ? 0 : Vec2(v.x, v.y).norm();
    });
  }
};

class Order : public OfRobots {
 public:
  using OfRobots::OfRobots;
  double value(World& world) override {
    const double x = mean(world, [&](Row row) { return world.transform(row).rotation.cos; });
    const double y = mean(world, [&](Row row) { return world.transform(row).rotation.sin; });
    return Vec2(x, y).norm();
  }
};

class Spread : public OfRobots {
 public:
  using OfRobots::OfRobots;
  double value(World& world) override {
    const double x = mean(world, [&](Row row) { return world.transform(row).position.x(); });
    const double y = mean(world, [&](Row row) { return world.transform(row).position.y(); });
    return mean(world, [&](Row row) { return (world.transform(row).position - Vec2(x, y)).norm(); });
  }
};

}  // namespace

engine::MeasureKind stalls_measure() {
  return engine::make_measure_kind<Stalls>(
      "stalls", Unit::none, "robots that are stalled",
      "The number of robots whose last motion was refused, because something stood in its way, or because it "
      "would have left the world.");
}

engine::MeasureKind held_measure() {
  return engine::make_measure_kind<Held>(
      "held", Unit::none, "robots held at the world's bounds",
      "The number of robots whose last motion would have left the world. They count as stalled, too.");
}

engine::MeasureKind displacement_measure() {
  return engine::make_measure_kind<Displacement>(
      "displacement", Unit::meters, "how far robots are from where they started, in the mean",
      "The mean over the robots of the straight distance between their origins now and at tick 0.");
}

engine::MeasureKind path_length_measure() {
  return engine::make_measure_kind<PathLength>(
      "path_length", Unit::meters, "how far robots have gone, in the mean",
      "The mean over the robots of the sum, over all ticks since measuring began, of the straight distance "
      "between their origins before and after the tick. Where a program puts a robot between two ticks it "
      "has "
      "not gone.");
}

engine::MeasureKind mean_speed_measure() {
  return engine::make_measure_kind<MeanSpeed>(
      "mean_speed", Unit::meters_per_second, "how fast robots moved in the last tick, in the mean",
      "The mean over the robots of the speed, in any direction, with which their origins moved in the last "
      "tick; 0 for one that is stalled, and for all before the first tick.");
}

engine::MeasureKind order_measure() {
  return engine::make_measure_kind<Order>(
      "order", Unit::none, "how far headings agree: 0 not at all, 1 wholly",
      "The length of the mean of the robots' unit vectors of heading. Vicsek et al., Novel type of phase "
      "transition in a system of self-driven particles, Physical Review Letters 75, 1995, for particles of "
      "one speed; also called polarisation.");
}

engine::MeasureKind spread_measure() {
  return engine::make_measure_kind<Spread>(
      "spread", Unit::meters, "how far robots are from their centre, in the mean",
      "The mean over the robots of the distance between their origins and the mean of all their origins.");
}

}  // namespace troupe::models
