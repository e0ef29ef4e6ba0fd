#include "engine/placement.hpp"

#include "base/assert.hpp"
#include "base/math.hpp"
#include "base/random.hpp"

#include <algorithm>
#include <cmath>

namespace troupe::engine {
namespace {

constexpr int k_finest = -10;  // 2^-10 m: bodies narrower than a millimetre share its cells

/// Two bodies whose circles are apart cannot overlap; the margin covers the rounding of the distance, so that
/// the cull never changes an answer.
bool circles_meet(double radius_a, const Pose& a, double radius_b, const Pose& b) {
  const double dx = a.x - b.x;
  const double dy = a.y - b.y;
  const double reach = (radius_a + radius_b) * (1 + 1e-9) + 1e-9;
  return dx * dx + dy * dy <= reach * reach;
}

std::int64_t cell_of(double x, double cell_m) { return static_cast<std::int64_t>(std::floor(x / cell_m)); }

double cells_along(double length, double pitch) {
  return std::floor(length / pitch + 1e-9) +
         1;  // 3 m at a pitch of 0.1 m are 31 cells, whatever rounding says
}

double box_cells(const Box& box, double pitch) {
  if (box.empty()) return 0;
  return cells_along(box.size().x(), pitch) * cells_along(box.size().y(), pitch);
}

}  // namespace

partition::ObstacleShape obstacle_shape(const TypeSpec& type) {
  std::vector<ConvexPrism> pieces;
  for (const PartSpec& part : type.parts) {
    if (!part.returns.obstacle) continue;
    for (const Solid& solid : part.solids)
      for (ConvexPrism& piece : convex_pieces(solid)) pieces.push_back(std::move(piece));
  }
  return partition::make_obstacle_shape(pieces);
}

std::size_t Crowd::slot_of(const std::vector<Slot>& slots, std::int64_t x, std::int64_t y) {
  const std::size_t mask = slots.size() - 1;
  std::uint64_t h = static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15u ^
                    static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4fu;
  h ^= h >> 29;
  h *= 0xbf58476d1ce4e5b9u;
  std::size_t i = static_cast<std::size_t>(h ^ (h >> 32)) & mask;
  while (slots[i].first != k_none && (slots[i].x != x || slots[i].y != y)) i = (i + 1) & mask;
  return i;
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
    levels_.push_back(
        {.exponent = exponent, .cell_m = std::ldexp(1.0, exponent), .slots = std::vector<Slot>(64)});
    level = levels_.end() - 1;
  }

  if (2 * (level->used + 1) > level->slots.size()) {
    std::vector<Slot> wider(2 * level->slots.size());
    for (const Slot& s : level->slots)
      if (s.first != k_none) wider[slot_of(wider, s.x, s.y)] = s;
    level->slots = std::move(wider);
  }
  const std::int64_t x = cell_of(pose.x, level->cell_m);
  const std::int64_t y = cell_of(pose.y, level->cell_m);
  Slot& s = level->slots[slot_of(level->slots, x, y)];
  level->used += s.first == k_none;
  bodies_[number].next = s.first;
  s = {x, y, number};
  level->bodies.push_back(number);
}

template <class Visit>
bool Crowd::each_near(double radius, const Pose& pose, Visit visit) const {
  for (const Level& level : levels_) {
    const double reach =
        radius + 0.5 * level.cell_m + 1e-6;  // margin as in circles_meet, for metres up to 100 km
    const std::int64_t x0 = cell_of(pose.x - reach, level.cell_m), x1 = cell_of(pose.x + reach, level.cell_m);
    const std::int64_t y0 = cell_of(pose.y - reach, level.cell_m), y1 = cell_of(pose.y + reach, level.cell_m);
    const double cells = static_cast<double>(x1 - x0 + 1) * static_cast<double>(y1 - y0 + 1);
    if (cells > static_cast<double>(level.bodies.size())) {  // a wide body among few small ones
      for (const std::uint32_t body : level.bodies)
        if (!visit(body)) return false;
      continue;
    }
    for (std::int64_t x = x0; x <= x1; ++x)
      for (std::int64_t y = y0; y <= y1; ++y)
        for (std::uint32_t body = level.slots[slot_of(level.slots, x, y)].first; body != k_none;
             body = bodies_[body].next)
          if (!visit(body)) return false;
  }
  return true;
}

bool Crowd::free(const partition::ObstacleShape& shape, const Pose& pose) const {
  if (shape.empty()) return true;
  return each_near(shape.radius, pose, [&](std::uint32_t i) {
    const Body& body = bodies_[i];
    return !circles_meet(body.shape->radius, body.pose, shape.radius, pose) ||
           !partition::overlap(*body.shape, body.pose, shape, pose);
  });
}

std::vector<std::size_t> Crowd::overlapping(const partition::ObstacleShape& shape, const Pose& pose) const {
  std::vector<std::size_t> met;
  if (shape.empty()) return met;
  each_near(shape.radius, pose, [&](std::uint32_t i) {
    const Body& body = bodies_[i];
    if (circles_meet(body.shape->radius, body.pose, shape.radius, pose) &&
        partition::overlap(*body.shape, body.pose, shape, pose))
      met.push_back(i);
    return true;
  });
  std::ranges::sort(met);
  return met;
}

double grid_cells(const PlacementRule& rule) {
  return box_cells(rule.region, rule.pitch_m) + box_cells(rule.spill, rule.pitch_m);
}

std::vector<Pose> place(const PlacementRule& rule, const partition::ObstacleShape& shape, std::size_t count,
                        std::uint64_t seed, std::string_view population, const std::optional<Box>& bounds,
                        const partition::StaticScene& scene, Crowd& crowd) {
  const std::uint32_t stream = stream_id("place", population);
  const bool grid = rule.kind == PlacementRule::Kind::grid;
  TROUPE_ASSERT(!grid || grid_cells(rule) < 4294967296.0);
  const auto cells = grid ? static_cast<std::uint64_t>(grid_cells(rule)) : 0;
  const auto region_cells = grid ? static_cast<std::uint64_t>(box_cells(rule.region, rule.pitch_m)) : 0;
  const bool draws = !grid || rule.jitter_m > 0 || !rule.heading;

  // The draws of one trial have fixed places (x, y, heading), so that a fixed heading moves nobody.
  const auto candidate = [&](std::uint64_t cell, std::uint32_t body, std::uint32_t trial) {
    const bool spilt = grid && cell >= region_cells;
    const Box& box = spilt ? rule.spill : rule.region;
    Pose pose{box.min.x(), box.min.y(), rule.z, rule.heading.value_or(0)};
    if (grid) {
      const auto rows = static_cast<std::uint64_t>(cells_along(box.size().y(), rule.pitch_m));
      if (spilt) cell -= region_cells;
      const std::uint64_t column = cell / rows;
      pose.x += rule.pitch_m * static_cast<double>(column);
      pose.y += rule.pitch_m * static_cast<double>(cell % rows);
    }
    if (!draws) return pose;
    Random random(seed, stream, body, trial);
    const double u = random.uniform();
    const double v = random.uniform();
    const Vec2 size = rule.region.size();
    pose.x += grid ? (2 * u - 1) * rule.jitter_m : u * size.x();
    pose.y += grid ? (2 * v - 1) * rule.jitter_m : v * size.y();
    if (!rule.heading) pose.heading = random.uniform(-k_pi, k_pi);
    return pose;
  };
  const auto is_free = [&](const Pose& pose) {
    return (!bounds || bounds->contains(pose.position())) &&
           (shape.empty() || (!scene.blocked(shape, pose) && crowd.free(shape, pose)));
  };

  std::vector<Pose> poses;
  std::uint64_t cell = 0;
  while (poses.size() < count) {
    const auto body = static_cast<std::uint32_t>(poses.size());
    std::optional<Pose> found;
    for (std::uint32_t trial = 0; !found && (grid ? cell < cells : trial < rule.trials); ++trial) {
      const Pose pose = candidate(grid ? cell++ : 0, body, trial);
      if (is_free(pose)) found = pose;
    }
    if (!found) break;
    crowd.add(shape, *found);
    poses.push_back(*found);
  }
  return poses;
}

}  // namespace troupe::engine
