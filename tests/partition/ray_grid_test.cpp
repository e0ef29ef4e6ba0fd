#include "partition/ray_grid.hpp"

#include "tests/engine/conflict_crowds.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace troupe::partition::ray_grid_test {
namespace {

using oracle::Draw;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using Place = std::pair<std::int64_t, std::int64_t>;

constexpr std::uint32_t k_no_body = ~0u;
constexpr std::uint32_t k_fixed = ~0u - 1;

/// A simple grid: a map of cells, through which a ray moves one cell at a time.
class Canvas {
 public:
  explicit Canvas(double resolution) : resolution_(resolution) {}

  void outline(const Ring& ring, ZInterval z, float ranger_return, std::uint32_t body) {
    if (ranger_return < 0) return;
    const auto mark = [&](Place at) {
      cells_[at].push_back({z, ranger_return, body});
      squares_.insert(square_of(at));
    };
    bool drawn = false;
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Place from = place(ring[k]);
      const Place to = place(ring[(k + 1) % ring.size()]);
      const std::int64_t across = std::abs(to.first - from.first);
      const std::int64_t up = std::abs(to.second - from.second);
      for (std::int64_t i = 0, j = 0; i + j < across + up; drawn = true) {
        mark({from.first + (to.first > from.first ? i : -i),
              from.second + (to.second > from.second ? j : -j)});
        if (up * (2 * i + 1) < across * (2 * j + 1))
          ++i;
        else
          ++j;
      }
    }
    if (!drawn) mark(place(ring[0]));
  }

  GridHit cast(const GridRay& ray) const {
    const double cos = std::abs(ray.direction.x());
    const double sin = std::abs(ray.direction.y());
    const double step_x = ray.direction.x() < 0 ? -1 : 1;
    const double step_y = ray.direction.y() < 0 ? -1 : 1;
    const auto across = static_cast<std::int64_t>(cos * (ray.range_max / resolution_));
    const auto up = static_cast<std::int64_t>(sin * (ray.range_max / resolution_));
    const Vec2 start = ray.origin / resolution_;
    Vec2 base = start;  // the position after the last jump, and the steps since then
    Vec2 steps(0, 0);
    std::int64_t order = up - across;
    for (std::int64_t left = across + up; left > 0;) {
      const Vec2 at = base + Vec2(step_x * steps.x(), step_y * steps.y());
      Place cell{static_cast<std::int64_t>(at.x()), static_cast<std::int64_t>(at.y())};
      const Place square = square_of(cell);
      if (squares_.contains(square)) {
        for (; square_of(cell) == square && left > 0; --left) {
          if (const float most = met(cell, ray); most >= 0) {
            const Vec2 now = base + Vec2(step_x * steps.x(), step_y * steps.y());
            const double cells =
                across > up ? std::abs(now.x() - start.x()) / cos : std::abs(now.y() - start.y()) / sin;
            const auto range = static_cast<float>(cells * resolution_);
            return range < ray.range_max ? GridHit{range, most} : GridHit{ray.range_max, 0};
          }
          if (order < 0) {
            cell.first += static_cast<std::int64_t>(step_x);
            ++steps.x();
            order += 2 * up;
          } else {
            cell.second += static_cast<std::int64_t>(step_y);
            ++steps.y();
            order -= 2 * across;
          }
        }
      } else {
        Vec2 border(static_cast<double>(32 * square.first + (step_x > 0 ? 32 : -1)),
                    static_cast<double>(32 * square.second + (step_y > 0 ? 32 : -1)));
        double before = 0;
        do {
          const Vec2 to = (border - at).cwiseAbs();
          const double along_x = to.x() * (1 / cos);
          const double along_y = to.y() * (1 / sin);
          if (along_x < along_y) {
            base = {border.x(), at.y() + step_y * std::min(along_x * sin, to.y())};
            border.x() += 32 * step_x;
          } else {
            base = {at.x() + step_x * std::min(along_y * cos, to.x()), border.y()};
            border.y() += 32 * step_y;
          }
          const double nearest = std::min(along_x, along_y);
          left = static_cast<std::int64_t>(static_cast<double>(left) - (nearest - before) * (cos + sin));
          before = nearest;
          cell = {static_cast<std::int64_t>(base.x()), static_cast<std::int64_t>(base.y())};
        } while (left > 0 && !squares_.contains(square_of(cell)));
        steps = {0, 0};
      }
    }
    return {ray.range_max, 0};
  }

 private:
  struct Mark {
    ZInterval z;
    float ranger_return;
    std::uint32_t body;
  };
  Place place(const Vec2& p) const {
    return {static_cast<std::int64_t>(std::floor(p.x() / resolution_)),
            static_cast<std::int64_t>(std::floor(p.y() / resolution_))};
  }
  /// The square of 32 x 32 cells that contains a cell.
  static Place square_of(Place cell) {
    const auto of = [](std::int64_t v) { return (v >= 0 ? v : v - 31) / 32; };
    return {of(cell.first), of(cell.second)};
  }
  /// The largest ranger_return that the ray hits in the cell; negative if it hits nothing.
  float met(Place at, const GridRay& ray) const {
    float most = -1;
    if (const auto cell = cells_.find(at); cell != cells_.end())
      for (const Mark& mark : cell->second)
        if (mark.body != ray.body && mark.z.contains(ray.z)) most = std::max(most, mark.ranger_return);
    return most;
  }

  double resolution_;
  std::map<Place, std::vector<Mark>> cells_;
  std::set<Place> squares_;  // those in which something is drawn
};

/// A random scene of static solids and mobile bodies, which a Canvas and a RayGrid draw.
class Scene {
 public:
  Scene(Draw& draw, double resolution, double extent) : resolution_(resolution), extent_(extent) {
    for (std::size_t n = 2 + draw.below(12); n > 0; --n) {
      FixedSolid fixed{.solid = {}, .body = BodyId(n), .ranger_return = random_return(draw)};
      const Vec2 at = point(draw);
      for (const Solid& solid : oracle::random_blocks(draw, draw.scale(2 * resolution, extent))) {
        fixed.solid = placed(solid, {at.x(), at.y(), draw.real(-0.2, 0.2), draw.real(-3, 3)});
        solids_.push_back(fixed);
      }
    }
    for (std::size_t n = draw.below(draw.chance(0.1) ? 600 : 60); n > 0; --n, ++bodies_) {
      const auto add = [&](const Ring& ring, ZInterval z) {
        outlines_.push_back({bodies_, static_cast<std::uint32_t>(body_vertices_.size()),
                             static_cast<std::uint32_t>(ring.size()), z, random_return(draw)});
        body_vertices_.insert(body_vertices_.end(), ring.begin(), ring.end());
      };
      for (const Solid& solid : oracle::random_blocks(draw, draw.scale(0.1 * resolution, 0.3 * extent)))
        for (const Ring& ring : solid.contours) add(ring, solid.z);
    }
    poses_.resize(bodies_);
    vertices_.resize(body_vertices_.size());
    move(draw, false);
  }

  /// Moves all bodies to random places; if `away` is true, far away from the static scene.
  void move(Draw& draw, bool away) {
    for (Pose& pose : poses_) {
      const Vec2 at = point(draw) * (away ? 100 : 1);
      pose = {at.x(), at.y(), draw.real(-0.2, 0.2), draw.real(-3, 3)};
    }
    for (const MovingOutline& o : outlines_)
      for (std::uint32_t v = o.first; v < o.first + o.count; ++v)
        vertices_[v] = Transform(poses_[o.body]) * body_vertices_[v];
  }

  Canvas canvas() const {
    Canvas canvas(resolution_);
    for (const FixedSolid& fixed : solids_)
      for (const Ring& ring : fixed.solid.contours)
        canvas.outline(ring, fixed.solid.z, fixed.ranger_return, k_fixed);
    for (const MovingOutline& o : outlines_)
      canvas.outline({vertices_.begin() + o.first, vertices_.begin() + o.first + o.count},
                     o.z.shifted(poses_[o.body].z), o.ranger_return, o.body);
    return canvas;
  }
  RayGrid grid() const { return {solids_, outlines_, vertices_, resolution_}; }
  void redraw(RayGrid& grid, Parallel& parallel) const { grid.redraw(vertices_, poses_, parallel); }

  /// Returns a random ray. It often starts inside a body, runs along an axis, or has the height of an end of
  /// a body.
  GridRay ray(Draw& draw) const {
    GridRay ray{point(draw),
                {},
                draw.real(0, 0.5),
                static_cast<float>(draw.chance(0.1) ? draw.scale(resolution_ / 2, extent_) : 3 * extent_),
                k_no_body};
    if (bodies_ > 0 && draw.chance(0.6)) {
      ray.body = static_cast<std::uint32_t>(draw.below(bodies_));
      ray.origin = poses_[ray.body].position();
      ray.z = poses_[ray.body].z + 0.3 * static_cast<double>(draw.below(2));
    }
    double heading = draw.real(-4, 4);
    if (draw.chance(0.2)) heading = static_cast<double>(draw.below(9)) * k_pi / 4;
    ray.direction = {std::cos(heading), std::sin(heading)};
    if (draw.chance(0.1)) ray.direction = ray.direction.array().round().matrix().normalized();
    return ray;
  }
  Vec2 point(Draw& draw) const { return {draw.real(-extent_, extent_), draw.real(-extent_, extent_)}; }

 private:
  static float random_return(Draw& draw) {
    return draw.chance(0.1) ? -1.0f : 0.25f * static_cast<float>(draw.below(5));
  }
  double resolution_;
  double extent_;
  std::uint32_t bodies_ = 0;
  std::vector<FixedSolid> solids_;
  std::vector<MovingOutline> outlines_;
  Ring body_vertices_;
  Ring vertices_;
  std::vector<Pose> poses_;
};

/// A ray that passes only the cell in which it starts. Its range is 0 if a surface is there.
GridRay ray_of_one_cell(const Vec2& start, double resolution) {
  return {start, {1, 0}, 0.5, static_cast<float>(1.5 * resolution), k_no_body};
}

TEST(RayGrid, SeesWhatPaperAndPencilSee) {
  std::array<Parallel, 4> parallel{Parallel(1), Parallel(2), Parallel(3), Parallel(8)};
  std::size_t hits = 0;
  std::size_t rays = 0;
  for (std::uint64_t seed = 1; seed <= 100 / oracle::k_thrift; ++seed) {
    SCOPED_TRACE(seed);
    Draw draw(seed);
    const double resolution = draw.chance(0.5) ? 0.02 : draw.scale(0.003, 0.5);
    Scene scene(draw, resolution, resolution * draw.scale(20, 400));
    RayGrid grid = scene.grid();
    for (std::size_t tick = 0; tick < 5; ++tick) {
      scene.redraw(grid, parallel[(seed + tick) % parallel.size()]);
      const Canvas canvas = scene.canvas();
      for (std::size_t n = 0; n < 300; ++n) {
        const GridRay one_cell = ray_of_one_cell(scene.point(draw), resolution);
        ASSERT_EQ(grid.cast(one_cell).range, canvas.cast(one_cell).range) << one_cell.origin.transpose();
      }
      for (std::size_t n = 0; n < 300; ++n) {
        const GridRay ray = scene.ray(draw);
        const GridHit expected = canvas.cast(ray);
        const GridHit got = grid.cast(ray);
        ASSERT_EQ(got.range, expected.range) << "from " << ray.origin.transpose() << " along "
                                             << ray.direction.transpose() << ", body " << ray.body;
        ASSERT_EQ(got.ranger_return, expected.ranger_return);
        ++rays;
        hits += got.range < ray.range_max;
      }
      scene.move(draw, tick == 2);  // once, all bodies leave, so that the grid may free empty regions
    }
  }
  EXPECT_GT(hits, rays / 5);
  EXPECT_LT(hits, rays * 3 / 4);
}

double distance(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 along = b - a;
  const double t = std::clamp(along.dot(p - a) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
  return (p - a - t * along).norm();
}

TEST(RayGrid, NoRayLeavesAClosedOutlineAndAHitIsWithinFourCellsOfIt) {
  double farthest = 0;
  for (std::uint64_t seed = 1; seed <= 300 / oracle::k_thrift; ++seed) {
    SCOPED_TRACE(seed);
    Draw draw(seed);
    const double resolution = draw.scale(0.001, 1);
    // The outline is often near an axis, where rounding towards zero changes its direction.
    const double away = draw.chance(0.5) ? 1000 : 200 * resolution;
    const Vec2 middle(draw.real(-away, away), draw.real(-away, away));
    const auto range_max = static_cast<float>(resolution * draw.scale(2000, 1e5));
    const Ring ring = oracle::turned(
        oracle::random_star(draw, 3 + draw.below(30), resolution * draw.scale(10, 500), 0.4), 0, middle);
    const RayGrid grid({{FixedSolid{{{ring}, {0, 1}}, BodyId(1)}}}, {}, {}, resolution);
    for (std::size_t n = 0; n < 1000; ++n) {
      const double heading =
          draw.chance(0.1) ? static_cast<double>(draw.below(8)) * k_pi / 4 : draw.real(-4, 4);
      const GridRay ray{middle, {std::cos(heading), std::sin(heading)}, 0.5, range_max, k_no_body};
      const float range = grid.cast(ray).range;
      ASSERT_LT(range, range_max) << heading;
      double nearest = 1e300;
      for (std::size_t i = 0; i < ring.size(); ++i)
        nearest =
            std::min(nearest, distance(middle + range * ray.direction, ring[i], ring[(i + 1) % ring.size()]));
      farthest = std::max(farthest, nearest / resolution);
    }
  }
  EXPECT_LT(farthest, 4);
  EXPECT_GT(farthest, 2);
}

/// A grid without mobile bodies, by default with cells of 1 m.
RayGrid grid_of(std::vector<FixedSolid> solids, double resolution = 1) {
  return {solids, {}, {}, resolution};
}

FixedSolid wall(double x0, double y0, double x1, double y1, float ranger_return = 1, ZInterval z = {0, 1}) {
  return {{{oracle::rectangle(x0, y0, x1, y1)}, z}, BodyId(1), true, ranger_return};
}

GridRay ray_from(double x, double y, const Vec2& direction, float range_max = 10) {
  return {{x, y}, direction, 0.5, range_max, k_no_body};
}

TEST(RayGrid, AnEdgeIsAStaircaseFromItsStartToBeforeItsEnd) {
  // A triangle: right along y = 1, back and up by one, and down again.
  const RayGrid grid = grid_of({{{{{{1.5, 1.5}, {4.5, 1.5}, {1.5, 2.5}}}, {0, 1}}, BodyId(1)}});
  std::string picture;
  for (int y = 3; y >= 0; --y, picture += '\n')
    for (int x = 0; x <= 5; ++x)
      picture += grid.cast(ray_of_one_cell({x + 0.5, y + 0.5}, 1)).range == 0 ? '#' : '.';
  EXPECT_EQ(picture,
            "......\n"
            ".###..\n"
            ".####.\n"
            "......\n");
}

TEST(RayGrid, OutlinesAreHollowAndSeenFromBothSides) {
  const RayGrid grid = grid_of({wall(2.5, -3.5, 6.5, 3.5)});
  EXPECT_EQ(grid.cast(ray_from(0.5, 0.5, {1, 0})).range, 2);
  EXPECT_EQ(grid.cast(ray_from(4.5, 0.5, {1, 0})).range, 2);
  EXPECT_EQ(grid.cast(ray_from(4.5, 0.5, {-1, 0})).range, 2);
  EXPECT_EQ(grid.cast(ray_from(9.5, 0.5, {-1, 0})).range, 3);
}

// A wall far away in y draws nothing that the rays could meet, but lets them step through its 32 x 32 cells.
TEST(RayGrid, RaysRoundTheirPositionTowardsZero) {
  const RayGrid grid = grid_of({wall(-5.5, -0.5, -4.5, -0.2), wall(-9.5, 20, -9, 21), wall(20, 20, 21, 21)});
  // The wall is drawn in cells (-6, -1) and (-5, -1). The cell of a ray at y = -0.5 is in row 0, that of one
  // at y = -1.5 in row -1.
  EXPECT_EQ(grid.cast(ray_from(-1.5, -0.5, {-1, 0})).range, 10);
  EXPECT_EQ(grid.cast(ray_from(-1.5, -1.5, {-1, 0})).range, 4);
  EXPECT_EQ(grid.cast(ray_from(-8.5, -1.5, {1, 0})).range, 2);
  // From cell 0 a ray downwards passes cell 0 twice.
  EXPECT_EQ(grid.cast(ray_from(0.5, -1.5, {-1, 0})).range, 5.5f);
  EXPECT_EQ(grid.cast(ray_from(-0.5, -1.5, {-1, 0})).range, 4.5f);
}

TEST(RayGrid, RaysJumpOverEmptySquaresToTheBorderOrOneCellBeyond) {
  // Cells 40 and -41 of row 4: the squares 1 and -2 are drawn, those between them are empty.
  const RayGrid grid = grid_of({wall(40.2, 4.2, 40.4, 4.4), wall(-40.4, 4.2, -40.2, 4.4)});
  EXPECT_EQ(grid.cast(ray_from(0.75, 4.5, {1, 0}, 100)).range, 39.25f);   // to the near side of the cell
  EXPECT_EQ(grid.cast(ray_from(0.75, 4.5, {-1, 0}, 100)).range, 41.75f);  // to the position -41
  EXPECT_EQ(grid.cast(ray_from(38.75, 4.5, {1, 0}, 100)).range, 2);       // without a jump, in whole steps
}

TEST(RayGrid, DirectionsAreRoundedToWholeCellsOfTheRange) {
  // Over 10 cells the ray rises by 0.9 cells, which are none; over 20 cells by 1.
  const RayGrid grid = grid_of({wall(9.2, 0.2, 9.4, 0.4), wall(15.2, 1.2, 15.4, 1.4)});
  const Vec2 direction(std::cos(0.09), std::sin(0.09));
  EXPECT_NEAR(grid.cast(ray_from(0.5, 0.9, direction, 11)).range, 9 / std::cos(0.09), 1e-5);
  EXPECT_NEAR(grid.cast(ray_from(0.5, 0.9, direction, 20)).range, 9 / std::cos(0.09), 1e-5);
}

TEST(RayGrid, WhatIsSmallerThanACellIsThere) {
  const RayGrid grid = grid_of({wall(3.2, 0.2, 3.4, 0.3)});
  EXPECT_EQ(grid.cast(ray_from(0.5, 0.5, {1, 0})).range, 3);
}

TEST(RayGrid, ReadsRangeMaxWhereNothingIsNearerAndZeroInTheFirstCell) {
  const RayGrid grid = grid_of({wall(3.2, 0.2, 3.4, 0.3)});
  // A ray passes as many cells as its range has.
  EXPECT_EQ(grid.cast(ray_from(0.5, 0.5, {1, 0}, 3.75f)).range, 3.75f);
  EXPECT_EQ(grid.cast(ray_from(0.5, 0.5, {1, 0}, 3.75f)).ranger_return, 0);
  EXPECT_EQ(grid.cast(ray_from(0.5, 0.5, {1, 0}, 4)).range, 3);
  EXPECT_EQ(grid.cast(ray_from(0.5, 0.5, {1, 0}, 4)).ranger_return, 1);
  EXPECT_EQ(grid.cast(ray_from(0.5, 0.5, {0, 1}, 4)).range, 4);
  EXPECT_EQ(grid.cast(ray_from(3.9, 0.9, {0, 1}, 1)).range, 0);
  EXPECT_EQ(grid.cast(ray_from(3.9, 0.9, {0, 1}, 0.9f)).range, 0.9f);  // shorter than a cell
}

TEST(RayGrid, OfSeveralInACellTheLargestReturnCounts) {
  const RayGrid grid = grid_of({wall(3.2, 0.2, 3.4, 0.3, 0.5f), wall(3.2, 0.2, 3.4, 0.3, 0),
                                wall(3.1, 0, 3.4, 0.3, 2, {0.6, 1}), wall(2.2, 0.2, 2.4, 0.3, -1)});
  GridRay ray = ray_from(0.5, 0.5, {1, 0});
  EXPECT_EQ(grid.cast(ray).ranger_return, 0.5f);
  EXPECT_EQ(grid.cast(ray).range, 3);
  ray.z = 0.6;
  EXPECT_EQ(grid.cast(ray).ranger_return, 2);
  ray.z = 1.01;
  EXPECT_EQ(grid.cast(ray).range, 10);
}

TEST(RayGrid, RaysPassTheirOwnBodyOnly) {
  const Ring ring = oracle::rectangle(-0.5, -0.5, 0.5, 0.5);
  Ring vertices;
  std::vector<MovingOutline> outlines;
  for (std::uint32_t body : {0u, 1u}) {
    outlines.push_back({body, static_cast<std::uint32_t>(vertices.size()), 4, {0, 1}, 1});
    for (const Vec2& v : ring) vertices.push_back(v + Vec2(3.0 * body, 0));
  }
  RayGrid grid({}, outlines, vertices, 0.1);
  Parallel parallel(2);
  grid.redraw(vertices, std::vector<Pose>(2), parallel);
  GridRay ray = ray_from(0, 0, {1, 0});
  EXPECT_NEAR(grid.cast(ray).range, 0.5, 1e-6);
  ray.body = 0;
  EXPECT_NEAR(grid.cast(ray).range, 2.5, 1e-6);
}

TEST(RayGrid, GroundThatBodiesHaveLeftIsForgotten) {
  const Ring ring = oracle::rectangle(0, 0, 0.5, 0.5);
  RayGrid grid({{wall(-5, -5, 5, 5)}}, {{0, 0, 4, {0, 1}, 1}}, ring, 0.1);
  const std::size_t fixed = grid.regions();
  Parallel parallel(2);
  for (int tick = 0; tick < 1000; ++tick) {
    const double x = 7.0 * tick;  // more than a region
    Ring vertices;
    for (const Vec2& v : ring) vertices.push_back(v + Vec2(x, 0));
    grid.redraw(vertices, std::vector<Pose>(1), parallel);
    ASSERT_LE(grid.regions(), 64 + 4 * (fixed + 4)) << tick;
    const auto is_drawn = [&](double at_x) {
      return grid.cast(ray_of_one_cell({at_x, 0.05}, 0.1)).range == 0;
    };
    ASSERT_TRUE(is_drawn(x + 0.05)) << tick;
    ASSERT_TRUE(is_drawn(5.05)) << tick;  // the wall, in a region that the body has left
    ASSERT_FALSE(is_drawn(x - 7 + 0.05)) << tick;
  }
}

TEST(RayGrid, EmptyGroundCostsNothing) {
  // 100 km of empty ground between two poles.
  const RayGrid grid = grid_of({wall(-5e4, 0, -5e4 + 0.1, 0.1), wall(5e4, 0, 5e4 + 0.1, 0.1)}, 0.02);
  EXPECT_LT(grid.fixed_bytes(), 10000u);
  EXPECT_EQ(grid.cast(ray_from(-4.9e4, 0.01, {1, 0}, 10000)).range, 10000);
  EXPECT_NEAR(grid.cast(ray_from(4.5e4, 0.05, {1, 0}, 10000)).range, 5000, 0.02);
  EXPECT_EQ(grid.cast(ray_from(1e7, 1e7, {1, 0}, 10000)).range, 10000);
  EXPECT_EQ(grid.cast(ray_from(1e300, -1e300, {1, 0}, 10000)).range, 10000);
}

std::string error_of(const std::vector<FixedSolid>& solids, const Ring& body, double resolution) {
  try {
    const auto count = static_cast<std::uint32_t>(body.size());
    const RayGrid grid(solids, {{0, 0, count, {0, 1}, 1}}, body, resolution);
  } catch (const std::length_error& error) {
    return error.what();
  }
  return "";
}

TEST(RayGrid, CellsThatMemoryCannotHoldAreRefused) {
  const Ring small = oracle::rectangle(0, 0, 1, 1);
  EXPECT_EQ(error_of({wall(0, 0, 1000, 1000)}, small, 0.001), "");
  EXPECT_THAT(error_of({wall(0, 0, 4e4, 4e4)}, small, 1e-4),
              MatchesRegex("cells of 0.0001 m would take ..\\.. GB, more than the limit of 2.15 GB; set the "
                           "resolution to 0.00.. m or more"));
  EXPECT_THAT(error_of({}, oracle::rectangle(0, 0, 4e4, 4e4), 1e-4), HasSubstr("; set the resolution to "));
  EXPECT_THAT(error_of({wall(1e8, 0, 1e8 + 1, 1)}, small, 0.1),
              "with cells of 0.1 m, the grid reaches 53687091 m from the origin, but the static scene "
              "reaches 100000000 m; set a resolution with larger cells");
}

}  // namespace
}  // namespace troupe::partition::ray_grid_test
