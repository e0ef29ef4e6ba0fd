#include "models/measures/measures.hpp"

#include "engine/observing/robot_sums.hpp"
#include "engine/observing/sensed_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace troupe::models {
namespace {

using engine::Measure;
using engine::MeasuredWorld;
using engine::StateTable;
using engine::Unit;

/// Base of the measures that are counts or means over a list of robots.
class OfRobots : public Measure {
 public:
  OfRobots(const MeasuredWorld&, std::vector<BodyId> robots) : robots_(std::move(robots)) {}

 protected:
  std::span<const BodyId> robots() const { return robots_; }
  /// The present row of robots()[i].
  Row row(const MeasuredWorld& world, std::size_t i) const { return world.row(robots_[i]); }
  /// Mean of term(i) over those robots()[i] that are in the world; NaN if there are none.
  template <class Term>
  double mean(const MeasuredWorld& world, Term&& term) const {
    const auto is_there = [&](std::size_t i) { return world.is_there(row(world, i)); };
    return mean_of_some(world, engine::count_there(world, robots_), is_there, term);
  }
  /// Mean of term(i) over the robots()[i] for which counts(i) is true. `count` is the number of these robots.
  /// NaN if `count` is 0.
  template <class Counts, class Term>
  double mean_of_some(const MeasuredWorld& world, std::size_t count, Counts&& counts, Term&& term) const {
    if (count == 0) return std::numeric_limits<double>::quiet_NaN();
    const double sum = engine::exact_sum(
        world, robots_.size(), [&](std::size_t i) { return counts(i) ? static_cast<double>(term(i)) : 0.0; });
    return sum / static_cast<double>(count);
  }
  /// Number of robots for whose rows holds(row) is true.
  template <class Holds>
  double count(const MeasuredWorld& world, Holds&& holds) const {
    return static_cast<double>(
        std::ranges::count_if(robots_, [&](BodyId id) { return holds(world.row(id)); }));
  }

 private:
  std::vector<BodyId> robots_;
};

class Stalls : public OfRobots {
 public:
  using OfRobots::OfRobots;
  double value(const MeasuredWorld& world) override {
    return count(world, [&](Row row) { return world.stalled(row); });
  }
};

class Held : public OfRobots {
 public:
  using OfRobots::OfRobots;
  double value(const MeasuredWorld& world) override {
    return count(world, [&](Row row) { return world.stall(row) == engine::Stall::out_of_bounds; });
  }
};

class Displacement : public OfRobots {
 public:
  using OfRobots::OfRobots;
  double value(const MeasuredWorld& world) override {
    return mean(world, [&](std::size_t i) {
      const Row row = this->row(world, i);
      return (world.transform(row).position - world.origin(row)).norm();
    });
  }
};

class PathLength : public OfRobots {
 public:
  PathLength(const MeasuredWorld& world, std::vector<BodyId> robots)
      : OfRobots(world, std::move(robots)), lengths_(this->robots().size(), 0), tick_(world.tick()) {
    for (std::size_t i = 0; i < lengths_.size(); ++i) {
      places_.push_back(world.transform(row(world, i)).position);
      was_there_.push_back(world.is_there(row(world, i)));
    }
  }

  void see(const MeasuredWorld& world) override {
    // The order matters: a program may move a robot after its birth and before its first tick.
    if (world.has_lives()) for_robots(world, [&](std::size_t i) { begin_life(world, i); });
    if (world.tick() != tick_) set_out_from(world, world.placed_before_step());
    tick_ = world.tick();
    for_robots(world, [&](std::size_t i) {
      const Vec2& place = world.transform(row(world, i)).position;
      lengths_[i] += (place - places_[i]).norm();
      places_[i] = place;
    });
  }
  double value(const MeasuredWorld& world) override {
    return mean(world, [&](std::size_t i) { return lengths_[i]; });
  }
  // Checkpoints contain neither places_ nor was_there_: the constructor reads them from the restored state.
  std::span<std::byte> memory() override { return std::as_writable_bytes(std::span(lengths_)); }

 private:
  /// Calls work(i) for the index i of each robot, on several threads.
  template <class Work>
  void for_robots(const MeasuredWorld& world, Work&& work) {
    constexpr std::size_t k_block = 4096;
    world.parallel().for_batches(lengths_.size(), k_block, [&](std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i) work(i);
    });
  }
  /// Corrects places_[i], the point from which see() measures the motion of robot i in this tick. If the
  /// robot was born since see() last ran, this point becomes its birthplace. If the robot is not in the
  /// world, this point becomes its present position, so that its path does not grow.
  void begin_life(const MeasuredWorld& world, std::size_t i) {
    const Row row = this->row(world, i);
    const bool is_there = world.is_there(row);
    if (!is_there)
      places_[i] = world.transform(row).position;
    else if (was_there_[i] == 0)
      places_[i] = world.origin(row);
    was_there_[i] = is_there;
  }

  /// Sets the places_ of robots that a program moved between two ticks to their new positions, so that these
  /// moves are not counted. placed: the moved bodies and their new poses.
  void set_out_from(const MeasuredWorld& world, std::span<const engine::Placed> placed) {
    for (const engine::Placed& place : placed) {
      const BodyId id = world.body(place.row);
      const auto found = std::ranges::lower_bound(robots(), id);  // robots() is in order of ids
      if (found != robots().end() && *found == id)
        places_[static_cast<std::size_t>(found - robots().begin())] = place.pose.position();
    }
  }

  std::vector<double> lengths_;          // m, per robot, in the order of robots()
  std::vector<Vec2> places_;             // position of each robot when see() last ran, m
  std::vector<std::uint8_t> was_there_;  // per robot: whether it was in the world when see() last ran
  std::uint64_t tick_;                   // tick when see() last ran
};

class MeanSpeed : public OfRobots {
 public:
  using OfRobots::OfRobots;
  double value(const MeasuredWorld& world) override {
    return mean(world, [&](std::size_t i) {
      const Row row = this->row(world, i);
      const engine::Velocity& v = world.velocity(row);
      // A carried robot keeps the velocity that its drive computes, but the drive does not move it.
      return world.stalled(row) || world.carrier(row) ? 0 : Vec2(v.x, v.y).norm();
    });
  }
};

class Order : public OfRobots {
 public:
  using OfRobots::OfRobots;
  double value(const MeasuredWorld& world) override {
    const double x = mean(world, [&](std::size_t i) { return world.transform(row(world, i)).rotation.cos; });
    const double y = mean(world, [&](std::size_t i) { return world.transform(row(world, i)).rotation.sin; });
    return Vec2(x, y).norm();
  }
};

class Spread : public OfRobots {
 public:
  using OfRobots::OfRobots;
  double value(const MeasuredWorld& world) override {
    const double x = mean(world, [&](std::size_t i) { return world.transform(row(world, i)).position.x(); });
    const double y = mean(world, [&](std::size_t i) { return world.transform(row(world, i)).position.y(); });
    return mean(world,
                [&](std::size_t i) { return (world.transform(row(world, i)).position - Vec2(x, y)).norm(); });
  }
};

class ShareWithin : public OfRobots {
 public:
  struct Params {
    Vec2 center = Vec2::Zero();
    double radius = 0;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      d.member<&Params::center>("center", Unit::meters, required, "centre of the circle, [x, y]");
      d.member<&Params::radius>("radius", Unit::meters, at_least(0), required, "radius of the circle");
    }
  };

  ShareWithin(const MeasuredWorld& world, const Params& params, std::vector<BodyId> robots)
      : OfRobots(world, std::move(robots)), circle_(params) {}

  double value(const MeasuredWorld& world) override {
    return mean(world, [&](std::size_t i) {
      return (world.transform(row(world, i)).position - circle_.center).squaredNorm() <=
             circle_.radius * circle_.radius;
    });
  }

 private:
  Params circle_;
};

/// Base of the measures of one variable of the robots' state, which Params selects. Robots whose types do not
/// have this variable are left out.
class OfState : public OfRobots {
  struct Cell {
    std::size_t table = k_none;
    std::size_t field = 0;
    std::size_t of_sensed_rows = 0;  // index of the table's entry in sensed_rows_
  };
  static constexpr std::size_t k_none = std::numeric_limits<std::size_t>::max();

 public:
  struct Params {
    std::string component;
    std::string field;
    std::int64_t column = 0;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      d.member<&Params::component>(
          "component", required,
          "name of a component (a table) of the state, such as \"pose\", the name of a device, or "
          "\"wander/0\" for the memory of the first controller if its kind is `wander`");
      d.member<&Params::field>("field", required, "name of a field of that component");
      d.member<&Params::column>("column", within(0, 1e6),
                                "index of the element, from 0, if the field is an array");
    }
  };

  OfState(const MeasuredWorld& world, const Params& params, const std::vector<BodyId>& robots)
      : OfState(world, params, robots, cells_of(world, params, robots)) {}

 protected:
  /// Mean of term(value) over the robots that are in the world and whose variable (Params) has a value
  /// (engine::SensedRows::exist()); NaN if there are none. The mean of equal terms is exactly this term.
  /// value: the present value of the variable.
  template <class Term>
  double mean_of(const MeasuredWorld& world, Term&& term) const {
    const std::span<const StateTable> tables = world.tables();
    const auto table_row = [&](std::size_t i) {
      return world.row_in(tables[cells_[i].table], row(world, i));
    };
    const auto exists = [&](std::size_t i) {
      return world.is_there(row(world, i)) &&
             sensed_rows_[cells_[i].of_sensed_rows].exist(world, table_row(i));
    };
    const auto term_of = [&](std::size_t i) {
      return term(tables[cells_[i].table].number(table_row(i), cells_[i].field, column_));
    };
    std::size_t count = 0;
    double least = std::numeric_limits<double>::infinity();
    double greatest = -least;
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      if (!exists(i)) continue;
      ++count;
      least = std::min(least, term_of(i));
      greatest = std::max(greatest, term_of(i));
    }
    const double mean = mean_of_some(world, count, exists, term_of);
    return least <= greatest ? std::clamp(mean, least, greatest) : mean;  // as rounding may move it outside
  }

 private:
  /// cells: the result of cells_of().
  OfState(const MeasuredWorld& world, const Params& params, std::vector<BodyId> robots,
          const std::vector<Cell>& cells)
      : OfRobots(world, with(cells, std::move(robots))), column_(static_cast<std::size_t>(params.column)) {
    std::vector<std::size_t> indices(world.tables().size(), k_none);  // by table: its entry in sensed_rows_
    for (const BodyId id : this->robots()) {
      Cell& cell = cells_.emplace_back(cells[id.index()]);
      if (indices[cell.table] == k_none) {
        indices[cell.table] = sensed_rows_.size();
        sensed_rows_.emplace_back(world, world.tables()[cell.table]);
      }
      cell.of_sensed_rows = indices[cell.table];
    }
  }

  /// For each body, in order of ids, the table and field that hold its variable; `table` is k_none if the
  /// body does not have the variable. A component of a device or a controller has one table per type, and a
  /// name may stand for several components, such as those of an actuator and of its joint. Throws
  /// std::invalid_argument if no table has the component, if none of the component's tables has the field, or
  /// if one of them has the field without the column. If there are no `robots`, only the last of the three is
  /// an error, because a world without bodies of their type has no table of their devices and controllers.
  static std::vector<Cell> cells_of(const MeasuredWorld& world, const Params& params,
                                    const std::vector<BodyId>& robots) {
    const std::string& component = params.component;
    std::vector<Cell> cells(world.spec().bodies.size());
    std::set<std::string_view> components;
    std::set<std::string_view> fields;  // of the tables of the component
    bool has_field = false;
    const bool is_whole = std::ranges::any_of(
        world.tables(), [&](const StateTable& table) { return table.component() == component; });
    for (std::size_t t = 0; t < world.tables().size(); ++t) {
      const StateTable& table = world.tables()[t];
      const std::string_view given = engine::given_name(table.component());
      components.insert(given);
      if ((is_whole ? table.component() : given) != component) continue;
      for (const engine::StateField& field : table.fields()) fields.insert(field.name);
      const std::optional<std::size_t> field = field_of(table, params);
      if (!field) continue;
      has_field = true;
      for (const BodyId id : table.ids()) cells[id.index()] = {.table = t, .field = *field};
    }
    if (robots.empty()) return cells;
    if (fields.empty())
      throw std::invalid_argument(
          unknown_name("component", component, {components.begin(), components.end()}));
    if (!has_field)
      throw std::invalid_argument(unknown_name("field", params.field, {fields.begin(), fields.end()}));
    return cells;
  }
  /// The index of the field in a table; std::nullopt if the table does not have it.
  static std::optional<std::size_t> field_of(const StateTable& table, const Params& params) {
    const engine::StateField* const field = engine::field_named(table.fields(), params.field);
    if (field == nullptr) return {};
    if (params.column >= field->columns)
      throw std::invalid_argument(
          fmt::format("there is no column {}: the last column of the field \"{}\" is {} (counted from 0)",
                      params.column, params.field, field->columns - 1));
    return static_cast<std::size_t>(field - table.fields().data());
  }
  static std::vector<BodyId> with(const std::vector<Cell>& cells, std::vector<BodyId> robots) {
    std::erase_if(robots, [&](BodyId id) { return cells[id.index()].table == k_none; });
    return robots;
  }

  std::size_t column_;
  std::vector<Cell> cells_;                      // per robot, in the order of robots()
  std::vector<engine::SensedRows> sensed_rows_;  // one for each table of the cells
};

class StateMean : public OfState {
 public:
  using OfState::OfState;
  double value(const MeasuredWorld& world) override {
    return mean_of(world, [](double number) { return number; });
  }
};

class StateVariance : public OfState {
 public:
  using OfState::OfState;
  double value(const MeasuredWorld& world) override {
    const double middle = mean_of(world, [](double number) { return number; });
    return mean_of(world, [middle](double number) { return (number - middle) * (number - middle); });
  }
};

class Alive : public OfRobots {
 public:
  using OfRobots::OfRobots;
  double value(const MeasuredWorld& world) override {
    return static_cast<double>(engine::count_there(world, robots()));
  }
};

class Deaths : public Measure {
 public:
  struct Params {
    std::string type;

    static constexpr void describe(engine::Description<Params>& d) {
      d.member<&Params::type>("type", engine::facts::required,
                              "name of the type of the bodies that are counted, with or without a drive");
    }
  };

  Deaths(const MeasuredWorld& world, const Params& params, const std::vector<BodyId>&) {
    const std::string& type = params.type;
    for (std::size_t r = 0; r < world.rows(); ++r)
      if (world.type(Row(r)).name == type) bodies_.push_back(world.body(Row(r)));
    std::vector<std::string_view> known;
    for (const engine::BodyType& each : world.types())
      if (each.runs()) known.push_back(each.name);
    if (std::ranges::find(known, type) != known.end()) return;
    std::ranges::sort(known);
    known.erase(std::unique(known.begin(), known.end()), known.end());
    throw std::invalid_argument(unknown_name("type of bodies that may die", type, known));
  }
  double value(const MeasuredWorld& world) override {
    return static_cast<double>(std::ranges::count_if(
        bodies_, [&](BodyId id) { return world.presence(world.row(id)) == engine::Presence::dead; }));
  }

 private:
  std::vector<BodyId> bodies_;
};

}  // namespace

engine::MeasureKind stalls_measure() {
  return engine::make_measure_kind<Stalls>("stalls", Unit::none, "number of stalled robots",
                                           "The number of robots whose last motion was blocked by something "
                                           "in its way, or would have left the bounds of the world.",
                                           "sum_i [robot i is stalled]");
}

engine::MeasureKind alive_measure() {
  return engine::make_measure_kind<Alive>("alive", Unit::none, "number of robots in the world",
                                          "The number of robots that have been born and have not died. Other "
                                          "measures of robots cover only these robots.",
                                          "n");
}

engine::MeasureKind deaths_measure() {
  return engine::make_measure_kind<Deaths>(
      "deaths", Unit::none, "number of bodies of a type that have died",
      "The number of bodies of a type that have died, such as pucks that a remover took or robots whose "
      "power packs ran empty. All bodies of the type count; `of`, which selects robots, has no effect.",
      "sum_b [body b of the type is dead]");
}

engine::MeasureKind held_measure() {
  return engine::make_measure_kind<Held>("held", Unit::none, "number of robots stopped at the world's bounds",
                                         "The number of robots whose last motion would have left the bounds "
                                         "of the world. The measure `stalls` counts these robots as well.",
                                         "sum_i [robot i is held at the bounds]");
}

engine::MeasureKind displacement_measure() {
  return engine::make_measure_kind<Displacement>(
      "displacement", Unit::meters, "mean distance of the robots from where they started",
      "The mean over the robots of the straight-line distance between a robot's origin now and its origin at "
      "tick 0, or at its birth if it was born later.",
      "1/n sum_i |x_i(t) - x_i(0)|");
}

engine::MeasureKind path_length_measure() {
  return engine::make_measure_kind<PathLength>(
      "path_length", Unit::meters, "mean length of the robots' paths",
      "The mean over the robots of the length of a robot's path. That is the sum, over all ticks since "
      "measuring began, of the straight-line distance between the robot's origin before and after the tick. "
      "If a program places a robot elsewhere between two ticks, this distance does not count.",
      "1/n sum_i sum_t |x_i(t) - x_i(t - 1)|");
}

engine::MeasureKind mean_speed_measure() {
  return engine::make_measure_kind<MeanSpeed>(
      "mean_speed", Unit::meters_per_second, "mean speed of the robots in the last tick",
      "The mean over the robots of the speed at which a robot's drive moved its origin in the last tick, "
      "regardless of the direction of motion. The speed is 0 for a stalled robot, and for a robot that "
      "another body carries, even if this body moves. Before the first tick, it is the start speed of the "
      "robot's drive, which is 0 by default.",
      "1/n sum_i |v_i|, with v_i = 0 if robot i is stalled or carried");
}

engine::MeasureKind polarisation_measure() {
  engine::MeasureKind kind = order_measure();
  kind.name = "polarisation";
  kind.same_as = "order";
  kind.text = "another name of the measure `order`";
  kind.definition =
      "The measure `order`, under a name that the literature uses. Source: Vicsek et al., Physical Review "
      "Letters 75, 1995.";
  return kind;
}

engine::MeasureKind order_measure() {
  return engine::make_measure_kind<Order>(
      "order", Unit::none, "agreement of the headings, from 0 (none) to 1 (full)",
      "The length of the mean of the robots' unit heading vectors, also called polarisation: 1 if all "
      "headings are equal, near 0 if they are random. Source: Vicsek et al., Novel type of phase transition "
      "in a system of self-driven particles, Physical Review Letters 75, 1995, where all particles have the "
      "same speed.",
      "|1/n sum_i (cos h_i, sin h_i)|, with the heading h_i of robot i");
}

engine::MeasureKind spread_measure() {
  return engine::make_measure_kind<Spread>(
      "spread", Unit::meters, "mean distance of the robots from their centre",
      "The mean over the robots of the distance between a robot's origin and the mean of all their origins. "
      "Related, with the squares of these distances: Graham and Sloane, Penny-packing and two-dimensional "
      "codes, Discrete and Computational Geometry 5, 1990.",
      "1/n sum_i |x_i - 1/n sum_j x_j|");
}

engine::MeasureKind share_within_measure() {
  return engine::make_measure_kind<ShareWithin>(
      "share_within", Unit::none, "fraction of the robots that are in a given circle",
      "The fraction of the robots whose origin is at most `radius` away from `center`.",
      "1/n sum_i [|x_i - center| <= radius]");
}

engine::MeasureKind state_mean_measure() {
  return engine::make_measure_kind<StateMean>(
      "state_mean", Unit::none, "mean of one variable of the robots' state",
      "The mean, over the robots, of one variable of their state, such as a variable in the memory of a "
      "controller or a reading of a sensor. Robots that do not have this variable are left out, and so are "
      "readings of sensors that do not run because they are inactive and neither a controller nor a program "
      "reads them; the mean is NaN if no robot remains. A sensor that has stopped, for example because its "
      "robot is disabled, counts with its last reading. Before a sensor runs for the first time, as at tick "
      "0, its readings are 0. If the variable is always 0 or 1, the mean is the fraction of the remaining "
      "robots for which it is 1.",
      "m = 1/n sum_i s_i");
}

engine::MeasureKind state_variance_measure() {
  return engine::make_measure_kind<StateVariance>(
      "state_variance", Unit::none, "variance of one variable of the robots' state",
      "The variance, over the robots, of one variable of their state: the mean of the squared differences "
      "between its values and their mean. The same robots are left out as in the measure `state_mean`, which "
      "has the same parameters; the variance is NaN if no robot remains, and 0 if all values are equal.",
      "1/n sum_i (s_i - m)^2, with m = 1/n sum_i s_i");
}

}  // namespace troupe::models
