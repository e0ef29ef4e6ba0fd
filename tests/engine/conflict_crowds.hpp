#pragma once

#include "tests/engine/conflict_oracle.hpp"
#include "tests/support/draw.hpp"
#include "tests/support/slow_build.hpp"

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace troupe::oracle {

/// The tests divide their numbers of repetitions by this number. It is 10 in slow builds
/// (test::k_slow_build), else 1.
inline constexpr std::uint64_t k_thrift = test::k_slow_build ? 10 : 1;

using test::Draw;

inline Ring rectangle(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

/// A fence along the x axis, centred on the origin: bars of 0.5 m by 1 m, one per metre, each of them a
/// piece.
inline partition::ObstacleShape fence_of(int bars) {
  std::vector<ConvexPrism> pieces;
  for (int i = 0; i < bars; ++i)
    pieces.push_back({rectangle(i - bars / 2, -0.5, i - bars / 2 + 0.5, 0.5), {0, 1}});
  return partition::make_obstacle_shape(pieces);
}

inline Ring turned(const Ring& ring, double angle, const Vec2& by = Vec2::Zero()) {
  Ring out;
  for (const Vec2& v : ring)
    out.push_back(by + Vec2(std::cos(angle) * v.x() - std::sin(angle) * v.y(),
                            std::sin(angle) * v.x() + std::cos(angle) * v.y()));
  return out;
}

/// Returns a random polygon around the origin, with its corners in counter-clockwise order. The distance of
/// each corner from the origin is random, from inner * radius to radius. If `inner` is 1, the polygon is
/// convex.
inline Ring random_star(Draw& draw, std::size_t corners, double radius, double inner) {
  Ring ring;
  const double start = draw.real(0, 2 * k_pi);
  for (std::size_t i = 0; i < corners; ++i) {
    const double angle =
        start + (static_cast<double>(i) + draw.real(0, 0.7)) * 2 * k_pi / static_cast<double>(corners);
    const double r = radius * draw.real(inner, 1);
    ring.emplace_back(r * std::cos(angle), r * std::sin(angle));
  }
  return ring;
}

/// Returns the blocks (extruded polygons) of a random body that is about `size` m wide. The shape is chosen
/// at random from nine sorts. These include convex and concave shapes, a ring, two blocks at different
/// heights, and a block beside the origin of the body.
inline std::vector<Solid> random_blocks(Draw& draw, double size) {
  const double h = size / 2;
  const ZInterval low{0, 0.3};
  const ZInterval high{0.3, 0.8};
  switch (draw.below(9)) {
    case 0: {
      const double w = h * draw.real(0.2, 1);
      return {{{rectangle(-h, -w, h, w)}, low}};
    }
    case 1: return {{{random_star(draw, 3 + draw.below(6), h, 1)}, low}};
    case 2: return {{{random_star(draw, 5 + draw.below(5), h, 0.3)}, low}};
    case 3: {  // an L, clockwise
      Ring ring{{-h, -h}, {h, -h}, {h, -0.3 * h}, {-0.2 * h, -0.3 * h}, {-0.2 * h, h}, {-h, h}};
      std::ranges::reverse(ring);
      return {{{turned(ring, draw.real(0, 6))}, low}};
    }
    case 4:  // a T in height: broad below, narrow and off centre above
      return {{{rectangle(-h, -h, h, h)}, low}, {{rectangle(0, -0.3 * h, 1.2 * h, 0.3 * h)}, high}};
    case 5:  // a ring, in which a small body has room
      return {{{rectangle(-h, -h, h, h), rectangle(-0.6 * h, -0.6 * h, 0.6 * h, 0.6 * h)}, low}};
    case 6: {  // a fork
      Ring ring{{-h, -h},     {h, -h}, {h, -0.5 * h}, {-0.3 * h, -0.5 * h}, {-0.3 * h, 0.5 * h},
                {h, 0.5 * h}, {h, h},  {-h, h}};
      return {{{turned(ring, draw.real(0, 6))}, ZInterval{0.1, 0.6}}};
    }
    case 7:  // far from its own origin
      return {{{turned(random_star(draw, 5, 0.5 * h, 1), 0, {0.5 * h, 0.2 * h})}, low}};
    default: return {{{random_star(draw, 4, h, 0.8)}, high}, {{random_star(draw, 6, 0.6 * h, 0.8)}, low}};
  }
}

/// The shape of a body, in two forms: `body` is for the oracle (the slow reference implementation in
/// tests/engine/conflict_oracle.hpp), and `shape` is for the engine.
struct Kind {
  Body body;                       ///< the shape for the oracle
  partition::ObstacleShape shape;  ///< the same shape for the engine
};
inline Kind make_kind(std::vector<Solid> blocks) {
  Kind kind;
  std::vector<ConvexPrism> pieces;
  kind.body.thinnest = 1e300;
  for (const Solid& block : blocks) {
    for (ConvexPrism& piece : convex_pieces(block)) {
      kind.body.thinnest = std::min(kind.body.thinnest, thickness(piece.outline));
      pieces.push_back(std::move(piece));
    }
  }
  kind.body.blocks = std::move(blocks);
  kind.shape = partition::make_obstacle_shape(pieces);
  kind.body.pieces = std::move(pieces);
  return kind;
}
/// Returns a random shape that is about `size` m wide. Shapes with very thin convex pieces are rejected: the
/// oracle would have to test their motions at tens of thousands of poses.
inline Kind random_kind(Draw& draw, double size) {
  for (;;) {
    Kind kind = make_kind(random_blocks(draw, size));
    if (kind.body.thinnest > 0.03 * size) return kind;
  }
}

struct TestCrowd {
  std::deque<Kind> kinds;  // addresses stay
  std::vector<const Body*> bodies;
  std::vector<const partition::ObstacleShape*> shapes;
  std::vector<std::uint32_t> ids;
  std::vector<Motion> motions;
  std::vector<std::uint8_t>
      turns;  ///< 1: the body turns on the spot if its motion is blocked; empty: none does
  std::vector<Solid> walls;
  std::vector<Solid> ghosts;  ///< fixed solids that block no body
  std::optional<Box> bounds;
  std::uint64_t seed = 1;
  std::uint64_t tick = 0;

  std::size_t size() const { return motions.size(); }
  void add(const Kind& kind, const Pose& pose) {
    bodies.push_back(&kind.body);
    shapes.push_back(&kind.shape);
    ids.push_back(static_cast<std::uint32_t>(2 * ids.size() + 1));  // not the rows
    motions.push_back({pose, pose, 0, false});
  }
  Question question() const { return {motions, bodies, ids, walls, seed, tick, bounds, turns}; }
  /// Lets random bodies turn on the spot if their motions are blocked.
  void draw_turns(Draw& draw) {
    turns.clear();
    for (std::size_t i = 0; i < size(); ++i) turns.push_back(draw.chance(0.5));
  }
};

struct CrowdShape {
  std::size_t most_bodies = 100;  ///< number of bodies, if all of them find a place
  double fill = 0.7;       ///< area of all bodies divided by the area of the square where they are placed
  double small = 0.05;     ///< least size of a body, m
  double large = 3;        ///< greatest size of a body, m
  double overlapping = 0;  ///< fraction of the bodies that may start in other bodies or in walls
  std::size_t walls = 0;   ///< number of straight walls; about a fifth of them block no body
  bool region = false;     ///< true: also a floor plan: outer walls around the square, and four pillars
  bool bounded = false;    ///< true: the crowd has bounds slightly inside the square
};

/// Returns a crowd of bodies of random shapes at random poses, among random walls. A body that may not
/// overlap others gets up to 25 random poses. The first pose at which it overlaps no wall and no other body
/// is used. If there is none, the body is left out.
inline TestCrowd random_crowd(Draw& draw, const CrowdShape& options) {
  TestCrowd crowd;
  crowd.seed = draw.below(1000);
  crowd.tick = draw.below(1000);
  std::vector<double> sizes;
  const std::size_t kinds = 2 + draw.below(6);
  double area = 0;
  for (std::size_t k = 0; k < kinds; ++k) {
    sizes.push_back(draw.scale(options.small, options.large));
    crowd.kinds.push_back(random_kind(draw, sizes.back()));
    area += sizes.back() * sizes.back() / static_cast<double>(kinds);
  }
  const double side = std::sqrt(area * static_cast<double>(options.most_bodies) / options.fill);
  const Vec2 corner(draw.real(-50, 50), draw.real(-50, 50));
  const auto anywhere = [&] {
    return Vec2(corner.x() + draw.real(0, side), corner.y() + draw.real(0, side));
  };

  for (std::size_t w = 0; w < options.walls; ++w) {
    const Ring plank = rectangle(0, 0, draw.scale(0.2, 5), draw.chance(0.5) ? 0.02 : draw.scale(0.02, 0.5));
    Solid wall{{turned(plank, draw.real(0, 6), anywhere())},
               draw.chance(0.7) ? ZInterval{0, 1} : ZInterval{0.4, 2}};
    (draw.chance(0.8) ? crowd.walls : crowd.ghosts).push_back(std::move(wall));
  }
  if (options.region) {
    const double x = corner.x();
    const double y = corner.y();
    Solid region{
        {rectangle(x - 0.3, y - 0.3, x + side + 0.3, y + side + 0.3), rectangle(x, y, x + side, y + side)},
        {0, 1}};
    for (const Vec2& centre : {Vec2(0.2, 0.2), Vec2(0.8, 0.2), Vec2(0.2, 0.8), Vec2(0.8, 0.8)})
      region.contours.push_back(turned(random_star(draw, 7, 0.04 * side, 0.4), 0, corner + side * centre));
    crowd.walls.push_back(std::move(region));
  }
  if (options.bounded) {
    crowd.bounds = Box::around(corner + Vec2(side / 2, side / 2), 0.48 * side);
  }

  std::vector<Blocks> solid;
  for (const Solid& wall : crowd.walls) solid.push_back(place({wall}, {}));
  for (std::size_t i = 0; i < options.most_bodies; ++i) {
    const Kind& kind = crowd.kinds[draw.below(kinds)];
    const bool anyhow = draw.chance(options.overlapping);
    for (int trial = 0; trial < 25; ++trial) {
      const Vec2 p = anywhere();
      const Pose pose{p.x(), p.y(), draw.chance(0.8) ? 0 : 0.3, draw.real(-3, 3)};
      Blocks placed = place(kind.body.blocks, pose);
      if (!anyhow && std::ranges::any_of(solid, [&](const Blocks& other) { return overlap(placed, other); }))
        continue;
      solid.push_back(std::move(placed));
      crowd.add(kind, pose);
      break;
    }
  }
  return crowd;
}

/// Sets a random motion for each body of the crowd. A tenth of the bodies do not move. Most bodies move by up
/// to 1.5 times their radius, and some by up to 1 m. Most bodies also turn. The oracle tests each motion at
/// many poses along the way. A motion that would need more than about `most_poses` poses is shortened to that
/// number, which limits the time that the oracle takes.
inline void random_motions(TestCrowd& crowd, Draw& draw, double most_poses) {
  for (std::size_t i = 0; i < crowd.size(); ++i) {
    Motion& m = crowd.motions[i];
    m = {m.from, m.from, 0, false};
    if (draw.chance(0.1)) continue;
    const double reach = crowd.shapes[i]->radius;
    double far = draw.chance(0.2) ? draw.real(0, 1) : reach * draw.real(0, 1.5);
    double turn = draw.chance(0.3) ? 0 : draw.chance(0.2) ? draw.real(-3, 3) : draw.real(-0.4, 0.4);
    const double poses = (far + reach * std::abs(turn)) / (crowd.shapes[i]->thinnest / 4);
    if (poses > most_poses) {
      far *= most_poses / poses;
      turn *= most_poses / poses;
    }
    const double direction = draw.real(-k_pi, k_pi);
    m.moves = true;
    m.turn = turn;
    m.to = compose(m.from, {far * std::cos(direction), far * std::sin(direction), 0, turn});
  }
}

inline partition::StaticScene scene_of(const TestCrowd& crowd, double cell_m) {
  std::vector<partition::FixedSolid> solids;
  for (const Solid& wall : crowd.walls) solids.push_back({wall, BodyId(solids.size()), true, 1});
  for (const Solid& ghost : crowd.ghosts) solids.push_back({ghost, BodyId(solids.size()), false, 1});
  return {std::move(solids), cell_m};
}

/// Returns the outcome that the engine computes for each motion of the crowd. free: data that the engine
/// keeps from tick to tick, one entry per body; pass the same vector in each tick. pushables: which bodies
/// can be pushed; by default none. border: the connection to other ranks, if there are any. blocks: if not
/// null, receives what blocked each body
inline std::vector<engine::Conflicts::Outcome> resolve(
    const TestCrowd& crowd, const partition::StaticScene& scene, const partition::GridGeometry& grid,
    partition::Parallel& parallel, engine::Conflicts& conflicts, std::vector<engine::FreeCircle>& free,
    const engine::Pushables& pushables = {}, engine::Conflicts::Border* border = nullptr,
    std::vector<engine::Conflicts::Block>* blocks = nullptr) {
  std::vector<Pose> poses;
  std::vector<Transform> transforms;
  std::vector<engine::Motion> motions;
  std::vector<double> radii;
  for (std::size_t i = 0; i < crowd.size(); ++i) {
    const Motion& m = crowd.motions[i];
    poses.push_back(m.from);
    transforms.emplace_back(m.from);
    motions.push_back({m.to, Rotation(m.to.heading), m.turn, m.moves});
    radii.push_back(crowd.shapes[i]->radius);
  }
  partition::BodyIndex index(grid);
  index.rebuild(transforms, radii, parallel);
  free.resize(crowd.size());
  if (blocks != nullptr) blocks->assign(crowd.size(), {});
  conflicts.resolve({poses, transforms, motions, crowd.shapes, crowd.ids, free, crowd.seed, crowd.tick,
                     crowd.bounds.value_or(Box::around(Vec2::Zero(), 1e9)), pushables, crowd.turns,
                     blocks != nullptr ? std::span(*blocks) : std::span<engine::Conflicts::Block>()},
                    scene, index, parallel, border);
  std::vector<engine::Conflicts::Outcome> outcomes;
  for (std::size_t i = 0; i < crowd.size(); ++i) outcomes.push_back(conflicts.outcome(i));
  return outcomes;
}
inline std::vector<engine::Conflicts::Outcome> resolve(const TestCrowd& crowd,
                                                       const partition::StaticScene& scene,
                                                       const partition::GridGeometry& grid,
                                                       partition::Parallel& parallel,
                                                       engine::Conflicts& conflicts) {
  std::vector<engine::FreeCircle> free;
  return resolve(crowd, scene, grid, parallel, conflicts, free);
}

}  // namespace troupe::oracle
