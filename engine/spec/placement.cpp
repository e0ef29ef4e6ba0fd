#include "engine/spec/placement.hpp"

#include "base/assert.hpp"
#include "base/math.hpp"
#include "base/random.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace troupe::engine {
namespace {

constexpr unsigned k_tile_bits = 2;  // a tile's 16 cells fill a cache line
// Exponent of the smallest cells, 2^-10 m. Bodies that are narrower also use these cells.
constexpr int k_finest = -10;

/// Whether the enclosing circles of two bodies overlap; if not, the bodies cannot overlap. The margin covers
/// the rounding of the distance, so that a pair of bodies that overlap is never skipped.
bool circles_meet(double radius_a, const Pose& a, double radius_b, const Pose& b) {
  const double dx = a.x - b.x;
  const double dy = a.y - b.y;
  const double reach = (radius_a + radius_b) * (1 + 1e-9) + 1e-9;
  return dx * dx + dy * dy <= reach * reach;
}

/// Adds 1e-9, so that 3 m at a pitch of 0.1 m are 31 cells in spite of rounding.
double cells_along(double length, double pitch) { return std::floor(length / pitch + 1e-9) + 1; }

double box_cells(const Box& box, double pitch) {
  if (box.empty()) return 0;
  return cells_along(box.size().x(), pitch) * cells_along(box.size().y(), pitch);
}

/// The poses that a placement rule tries, before any test of whether they are free.
class Candidates {
 public:
  Candidates(const PlacementRule& rule, std::uint64_t seed, std::uint32_t stream)
      : rule_(rule), seed_(seed), stream_(stream), is_grid_(rule.kind == PlacementRule::Kind::grid) {
    if (!is_grid_) return;
    TROUPE_ASSERT(grid_cells(rule) < 4294967296.0);
    cells_ = static_cast<std::uint64_t>(grid_cells(rule));
    region_cells_ = static_cast<std::uint64_t>(box_cells(rule.region, rule.pitch_m));
  }

  /// Number of cells of a grid rule, in its region and its spill; 0 for other rules.
  std::uint64_t cells() const { return cells_; }
  /// Whether poses depend on random numbers. If not, the pose is the same for each body and each trial, and
  /// depends only on the cell.
  bool draws() const { return !is_grid_ || rule_.jitter_m > 0 || !rule_.heading; }

  /// The pose that the rule tries for body number `body` of the population, in its trial number `trial`. A
  /// grid rule tries cell number `cell`; other rules ignore `cell`. The random numbers of a trial are drawn
  /// in the order x, y, heading, so that fixed and random headings give the same positions.
  Pose pose(std::uint64_t cell, std::uint32_t body, std::uint32_t trial) const {
    const bool spilt = is_grid_ && cell >= region_cells_;
    const Box& box = spilt ? rule_.spill : rule_.region;
    Pose pose{box.min.x(), box.min.y(), rule_.z, rule_.heading.value_or(0)};
    if (is_grid_) {
      const auto rows = static_cast<std::uint64_t>(cells_along(box.size().y(), rule_.pitch_m));
      if (spilt) cell -= region_cells_;
      const std::uint64_t column = cell / rows;
      pose.x += rule_.pitch_m * static_cast<double>(column);
      pose.y += rule_.pitch_m * static_cast<double>(cell % rows);
    }
    if (!draws()) return pose;
    Random random(seed_, stream_, body, trial);
    if (rule_.kind == PlacementRule::Kind::gaussian) {
      pose.x = rule_.mean.x() + rule_.deviation.x() * random.normal();
      pose.y = rule_.mean.y() + rule_.deviation.y() * random.normal();
    } else {
      const double u = random.uniform();
      const double v = random.uniform();
      const Vec2 size = rule_.region.size();
      pose.x += is_grid_ ? (2 * u - 1) * rule_.jitter_m : u * size.x();
      pose.y += is_grid_ ? (2 * v - 1) * rule_.jitter_m : v * size.y();
    }
    if (!rule_.heading) pose.heading = random.uniform(-k_pi, k_pi);
    return pose;
  }

 private:
  const PlacementRule& rule_;
  std::uint64_t seed_;
  std::uint32_t stream_;
  bool is_grid_;
  std::uint64_t cells_ = 0;
  std::uint64_t region_cells_ = 0;
};

double floor_cell(const PlacementRule& rule, const partition::ObstacleShape& shape) {
  constexpr double k_least_m = 0.02;
  return rule.cell_m > 0 ? rule.cell_m : std::max(shape.radius / 2, k_least_m);
}

/// The connected part of a region in which a body can move around, as a set of square grid cells. A cell is
/// open if a disc that encloses the body, placed at the cell, is free of the static scene. Of the connected
/// parts of the open cells, this is the one that contains the point PlacementRule::from or, if the rule has
/// no such point, the largest one.
class Floor {
 public:
  Floor(const PlacementRule& rule, const partition::ObstacleShape& shape, const partition::StaticScene& scene,
        partition::Parallel& parallel)
      : region_(rule.region), cell_m_(floor_cell(rule, shape)) {
    columns_ = static_cast<std::size_t>(std::ceil(region_.size().x() / cell_m_)) + 1;
    rows_ = static_cast<std::size_t>(std::ceil(region_.size().y() / cell_m_)) + 1;
    cells_.assign(columns_ * rows_, k_blocked);
    const partition::ObstacleShape disc = disc_about(shape);
    parallel.for_each(columns_, [&](std::size_t column) {
      for (std::size_t row = 0; row < rows_; ++row) {
        const Vec2 at = region_.min + cell_m_ * Vec2(static_cast<double>(column), static_cast<double>(row));
        if (disc.empty() || !scene.blocked(disc, {at.x(), at.y(), rule.z, 0}))
          cells_[column * rows_ + row] = k_open;
      }
    });
    if (rule.from) {
      if (region_.contains(*rule.from)) fill(cell_at(*rule.from), k_floor);
      return;
    }
    std::size_t most = 0;
    std::size_t best = cells_.size();
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      if (cells_[i] != k_open) continue;
      const std::size_t size = fill(i, k_seen);
      if (size > most) best = i;
      most = std::max(most, size);
    }
    for (State& cell : cells_)
      if (cell == k_seen) cell = k_open;
    if (best < cells_.size()) fill(best, k_floor);
  }

  bool contains(const Vec2& point) const {
    return region_.contains(point) && cells_[cell_at(point)] == k_floor;
  }

 private:
  enum State : std::uint8_t { k_blocked, k_open, k_seen, k_floor };

  static partition::ObstacleShape disc_about(const partition::ObstacleShape& shape) {
    if (shape.empty()) return {};
    constexpr int k_corners = 8;
    const double radius = shape.radius / cos(k_pi / k_corners);  // so that the octagon encloses the circle
    ConvexPrism prism{{}, shape.z};
    for (int i = 0; i < k_corners; ++i) {
      const SinCos at = sincos(2 * k_pi * (i + 0.5) / k_corners);
      prism.outline.emplace_back(radius * at.cos, radius * at.sin);
    }
    return partition::make_obstacle_shape({&prism, 1});
  }

  /// The cell whose centre is nearest to a point of the region.
  std::size_t cell_at(const Vec2& point) const {
    const Vec2 from = (point - region_.min) / cell_m_ + Vec2(0.5, 0.5);  // from the first cell's corner
    const auto column = static_cast<std::size_t>(from.x());
    const auto row = static_cast<std::size_t>(from.y());
    return std::min(column, columns_ - 1) * rows_ + std::min(row, rows_ - 1);
  }

  /// Sets the state of the cell `start`, if it is open, and of all open cells that are connected to it
  /// through cell sides. Returns the number of cells that it has set.
  std::size_t fill(std::size_t start, State state) {
    if (cells_[start] != k_open) return 0;
    std::size_t count = 0;
    std::vector<std::size_t> open{start};
    cells_[start] = state;
    const auto visit = [&](std::size_t cell) {
      if (cells_[cell] != k_open) return;
      cells_[cell] = state;
      open.push_back(cell);
    };
    while (!open.empty()) {
      const std::size_t cell = open.back();
      open.pop_back();
      ++count;
      const std::size_t row = cell % rows_;
      if (row > 0) visit(cell - 1);
      if (row + 1 < rows_) visit(cell + 1);
      if (cell >= rows_) visit(cell - rows_);
      if (cell + rows_ < cells_.size()) visit(cell + rows_);
    }
    return count;
  }

  Box region_;
  double cell_m_;
  std::size_t columns_ = 0;
  std::size_t rows_ = 0;
  std::vector<State> cells_;  // column by column
};

/// Points with a minimum distance between any two.
class Spaced {
 public:
  explicit Spaced(double distance_m) : distance_m_(distance_m), grid_{distance_m, k_tile_bits} {}

  bool takes(const Vec2& point) const {
    const partition::Cell middle = grid_.cell(point);
    for (std::int32_t x = -1; x <= 1; ++x)
      for (std::int32_t y = -1; y <= 1; ++y)
        if (const auto found = cells_.find(key_of({middle.x + x, middle.y + y})); found != cells_.end())
          for (const Vec2& other : found->second)
            if ((other - point).squaredNorm() < distance_m_ * distance_m_) return false;
    return true;
  }
  void add(const Vec2& point) { cells_[key_of(grid_.cell(point))].push_back(point); }

 private:
  static std::uint64_t key_of(const partition::Cell& cell) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(cell.x)) << 32 |
           static_cast<std::uint32_t>(cell.y);
  }

  double distance_m_;
  partition::GridGeometry grid_;
  std::unordered_map<std::uint64_t, std::vector<Vec2>> cells_;
};

/// Places the bodies of one population, see place(). Many candidates are tested against the static scene in
/// advance and in parallel. They are then tested against other bodies one by one, in order, because each body
/// that is placed affects the next ones.
class RulePlacer {
 public:
  RulePlacer(const Placement& placement, Crowd& crowd, partition::Parallel& parallel)
      : placement_(placement),
        candidates_(placement.rule, placement.seed, stream_id("place", placement.population)),
        crowd_(crowd),
        parallel_(parallel) {
    const PlacementRule& rule = placement.rule;
    if (rule.kind == PlacementRule::Kind::free_floor)
      floor_.emplace(rule, placement.shape, placement.scene, parallel);
    if (rule.kind == PlacementRule::Kind::poisson_disc) spaced_.emplace(rule.distance_m);
  }

  /// Places the bodies by a rule that draws positions.
  std::vector<Pose> place_at_random() {
    const std::size_t count = placement_.count;
    std::size_t size = 64;  // poses per batch, doubled each time: little work is lost if no pose is free
    for (std::size_t i = 0; poses_.size() < count; ++i) {
      const auto body = static_cast<std::uint32_t>(poses_.size());
      if (i == ahead_.size()) {
        size = std::min(2 * size, k_most_ahead);
        test_ahead(std::min(size, count - poses_.size()),
                   [&](std::size_t k) { return next_open(body + static_cast<std::uint32_t>(k), 0); });
        i = 0;
      }
      Ahead found = ahead_[i];
      while (found.is_open && !is_free(found.pose)) found = next_open(body, found.trial + 1);
      if (!found.is_open) break;
      add(found.pose);
    }
    return std::move(poses_);
  }

  /// Places the bodies in the cells of a grid rule.
  std::vector<Pose> place_in_cells() {
    const std::size_t count = placement_.count;
    std::uint32_t trial = 0;
    std::size_t i = 0;
    for (std::uint64_t cell = 0; cell < candidates_.cells() && poses_.size() < count; ++cell, ++i) {
      const auto body = static_cast<std::uint32_t>(poses_.size());
      if (i == ahead_.size()) {
        // Without random numbers, the pose of a cell does not depend on its body, so cells can be tested in
        // advance. At least one cell is needed for each remaining body.
        const std::uint64_t left = std::min<std::uint64_t>(candidates_.cells() - cell, count - poses_.size());
        const std::size_t size =
            candidates_.draws() ? 1 : static_cast<std::size_t>(std::min<std::uint64_t>(left, k_most_ahead));
        test_ahead(size, [&](std::size_t k) {
          const Pose pose = candidates_.pose(cell + k, body, trial);
          return Ahead{pose, trial, is_open(pose)};
        });
        i = 0;
      }
      ++trial;
      if (!ahead_[i].is_open || !is_free(ahead_[i].pose)) continue;
      add(ahead_[i].pose);
      trial = 0;
    }
    return std::move(poses_);
  }

 private:
  /// A candidate pose, tested in advance against everything except other bodies.
  struct Ahead {
    Pose pose;
    std::uint32_t trial = 0;  ///< number of the trial that yielded the pose
    bool is_open = false;     ///< result of is_open(pose)
  };
  static constexpr std::size_t k_most_ahead = 16384;

  /// Whether the rule and the bounds allow the pose and no wall blocks it.
  bool is_open(const Pose& pose) const {
    const PlacementRule& rule = placement_.rule;
    const std::optional<Box>& bounds = placement_.bounds;
    // Normally distributed positions may lie outside the region.
    const bool may_leave = rule.kind == PlacementRule::Kind::gaussian;
    const Vec2 at = pose.position();
    return (!bounds || bounds->contains(at)) && (!may_leave || rule.region.contains(at)) &&
           (rule.polygon.empty() || contains(polygon_, at)) && (!floor_ || floor_->contains(at)) &&
           !placement_.scene.blocked(placement_.shape, pose);
  }

  /// Whether the bodies that are already placed allow the pose.
  bool is_free(const Pose& pose) const {
    return (!spaced_ || spaced_->takes(pose.position())) && crowd_.free(placement_.shape, pose);
  }

  void add(const Pose& pose) {
    crowd_.add(placement_.shape, pose);
    if (spaced_) spaced_->add(pose.position());
    poses_.push_back(pose);
  }

  /// Returns the first open one of the random poses of a body, from this trial on. If there is none, is_open
  /// of the result is false.
  Ahead next_open(std::uint32_t body, std::uint32_t trial) const {
    for (; trial < placement_.rule.trials; ++trial)
      if (const Pose pose = candidates_.pose(0, body, trial); is_open(pose)) return {pose, trial, true};
    return {{}, trial, false};
  }

  /// Sets ahead_ to test(0), ..., test(size - 1), computed in parallel.
  template <class Test>
  void test_ahead(std::size_t size, Test&& test) {
    constexpr std::size_t k_batch = 128;
    ahead_.resize(size);
    parallel_.for_batches(size, k_batch, [&](std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i) ahead_[i] = test(i);
    });
  }

  const Placement& placement_;
  const Candidates candidates_;
  Crowd& crowd_;
  partition::Parallel& parallel_;
  const Solid polygon_{{placement_.rule.polygon}, {}};
  std::optional<Floor> floor_;
  std::optional<Spaced> spaced_;
  std::vector<Ahead> ahead_;
  std::vector<Pose> poses_;
};

}  // namespace

partition::ObstacleShape obstacle_shape(const TypeSpec& type) {
  return shape_of(type, [](const PartSpec& part) { return part.returns.obstacle; });
}

partition::ObstacleShape shape_of(const TypeSpec& type, bool (*counts)(const PartSpec& part)) {
  std::vector<ConvexPrism> pieces;
  for (const PartSpec& part : type.parts) {
    if (!counts(part)) continue;
    for (const Solid& solid : part.solids)
      for (ConvexPrism& piece : convex_pieces(solid)) pieces.push_back(std::move(piece));
  }
  return partition::make_obstacle_shape(pieces);
}

void Crowd::add(const partition::ObstacleShape& shape, const Pose& pose) {
  const auto number = static_cast<std::uint32_t>(bodies_.size());
  bodies_.push_back({pose, &shape, k_none});
  if (shape.empty()) return;

  int exponent = 0;
  std::frexp(2 * shape.radius, &exponent);  // 2 radius < 2^exponent
  exponent = std::max(exponent, k_finest);
  auto level = std::ranges::find(levels_, exponent, &Level::exponent);
  if (level == levels_.end()) {
    levels_.push_back({.exponent = exponent, .grid = {std::ldexp(1.0, exponent), k_tile_bits}});
    level = levels_.end() - 1;
  }
  const partition::Cell cell = level->grid.cell(pose.position());
  const std::size_t slot = level->tiles.insert(level->grid.tile(cell));
  const std::size_t cells = level->grid.cells_per_tile();
  if (level->first.size() < (slot + 1) * cells) level->first.resize((slot + 1) * cells, k_none);
  std::uint32_t& first = level->first[slot * cells + level->grid.in_tile(cell)];
  bodies_[number].next = first;
  first = number;
}

template <class Visit>
bool Crowd::each_near(double radius, const Pose& pose, Visit visit) const {
  bool goes_on = true;
  for (const Level& level : levels_) {
    // The margin covers the rounding of coordinates up to 100 km.
    const double reach = radius + 0.5 * level.grid.cell_m + 1e-6;
    const auto visit_run = [&](std::uint32_t slot, std::size_t begin, std::size_t end, partition::Cell) {
      const std::uint32_t* first = &level.first[slot * level.grid.cells_per_tile()];
      for (std::size_t cell = begin; goes_on && cell < end; ++cell)
        for (std::uint32_t body = first[cell]; goes_on && body != k_none; body = bodies_[body].next)
          goes_on = visit(body);
    };
    partition::for_each_run(level.grid, level.tiles, Box::around(pose.position(), reach), visit_run);
    if (!goes_on) return false;
  }
  return true;
}

bool Crowd::free(const partition::ObstacleShape& shape, const Pose& pose) const {
  if (shape.empty()) return true;
  return each_near(shape.radius, pose, [&](std::uint32_t i) { return !overlaps(i, shape, pose); });
}

std::vector<std::size_t> Crowd::overlapping(const partition::ObstacleShape& shape, const Pose& pose,
                                            const std::function<bool(std::size_t)>& matters) const {
  std::vector<std::size_t> met;
  if (shape.empty()) return met;
  each_near(shape.radius, pose, [&](std::uint32_t i) {
    if (matters(i) && overlaps(i, shape, pose)) met.push_back(i);
    return true;
  });
  std::ranges::sort(met);
  return met;
}

bool Crowd::overlaps(std::size_t number, const partition::ObstacleShape& shape, const Pose& pose) const {
  const Body& body = bodies_[number];
  return circles_meet(body.shape->radius, body.pose, shape.radius, pose) &&
         partition::overlap(*body.shape, body.pose, shape, pose);
}

double grid_cells(const PlacementRule& rule) {
  return box_cells(rule.region, rule.pitch_m) + box_cells(rule.spill, rule.pitch_m);
}

double floor_cells(const PlacementRule& rule, const partition::ObstacleShape& shape) {
  const Vec2 size = rule.region.size() / floor_cell(rule, shape);
  return (std::ceil(size.x()) + 1) * (std::ceil(size.y()) + 1);
}

bool is_on_floor(const PlacementRule& rule, const partition::ObstacleShape& shape,
                 const partition::StaticScene& scene, partition::Parallel& parallel) {
  return Floor(rule, shape, scene, parallel).contains(*rule.from);
}

std::vector<Pose> place(const Placement& placement, Crowd& crowd, partition::Parallel& parallel) {
  if (placement.count == 0) return {};
  RulePlacer placer(placement, crowd, parallel);
  return placement.rule.kind == PlacementRule::Kind::grid ? placer.place_in_cells()
                                                          : placer.place_at_random();
}

}  // namespace troupe::engine
