#pragma once

#include "engine/world.hpp"

#include <algorithm>
#include <optional>
#include <span>

namespace troupe::engine {

/// A part of an outline in the world's frame, metres: edges from each vertex to the next, and from the last
/// to the first where it is closed. Of whatever body, also of those that rangers pass through.
struct OutlineChain {
  std::span<const Vec2> vertices;  ///< in order; what they point into lives until the next step
  bool closed = false;             ///< a whole ring; else a stretch of one
  ZInterval z;                     ///< world frame
  BodyId body;                     ///< whose it is
  std::uint32_t part = 0;          ///< of the body's type
  std::uint32_t solid = 0;         ///< contours of one body and number are one even-odd region
  std::uint32_t piece = 0;  ///< tells chains of one solid and sight (by rangers or not) from one another
  float ranger_return = 1;  ///< intensity that rangers read; below 0: they pass it
};

/// visit(edge from, edge to) for each edge of the chain.
template <class Visit>
void for_each_edge(const OutlineChain& chain, Visit&& visit) {
  for (std::size_t i = 0; i + 1 < chain.vertices.size(); ++i) visit(chain.vertices[i], chain.vertices[i + 1]);
  if (chain.closed && !chain.vertices.empty()) visit(chain.vertices.back(), chain.vertices.front());
}

/// A piece of the outlines of the static scene, as a chain.
inline OutlineChain fixed_chain(const partition::StaticScene& scene, const partition::FixedOutlines& outlines,
                                std::uint32_t piece) {
  const partition::FixedSolid& solid = scene.solids()[outlines.solid(piece)];
  return {outlines.chain(piece), false, solid.solid.z,      solid.body, solid.part,
          outlines.solid(piece), piece, solid.ranger_return};
}

/// visit(chain) for the outlines of the static scene whose circles may touch the box and are `wanted`
/// (circle -> bool), each once or more.
template <class Wanted, class Visit>
void for_each_fixed_chain(const World& world, const Box& box, Wanted&& wanted, Visit&& visit) {
  const partition::StaticScene& scene = world.scene();
  for (const partition::FixedOutlines* outlines : {&scene.outlines(), &scene.hidden_outlines()}) {
    const Box centres = box.expanded(outlines->largest_radius());
    const partition::GridGeometry& grid = outlines->geometry();
    outlines->for_each_run(grid.cell(centres.min), grid.cell(centres.max),
                           [&](std::span<const partition::BodyCircle> circles) {
                             for (const partition::BodyCircle& circle : circles)
                               if (wanted(circle)) visit(fixed_chain(scene, *outlines, circle.row));
                           });
  }
}

/// visit(chain) for the outlines of a body that has a row.
template <class Visit>
void for_each_chain_of(const World& world, Row row, Visit&& visit) {
  const std::span<const Vec2> vertices = world.outline(row);
  const double base = world.poses()[row.index()].z;
  const BodyType& type = world.type(row);
  for (const std::vector<RayOutline>* outlines : {&type.outlines, &type.hidden_outlines})
    for (const RayOutline& outline : *outlines)
      visit(OutlineChain{vertices.subspan(outline.first, outline.count), true,
                         outline.z.shifted(base + world.lift(row, outline.joint)), world.body(row),
                         outline.part, outline.solid, outline.first, outline.ranger_return});
}

/// for_each_fixed_chain() for bodies that have rows, less those of one tree (not valid: of none).
template <class Wanted, class Visit>
void for_each_body_chain(const World& world, const Box& box, Row own, Wanted&& wanted, Visit&& visit) {
  world.index().for_each_near(box, [&](const partition::BodyCircle& circle) {
    const Row row(circle.row);
    if (!wanted(circle) || (own.valid() && world.same_tree(row, own))) return;
    for_each_chain_of(world, row, visit);
  });
}

/// A ray of a sensor that casts few of them, and what may stop it.
struct SightRay {
  Vec2 origin = Vec2::Zero();               ///< world frame, m
  Vec2 direction = Vec2::UnitX();           ///< of length 1
  double length = 0;                        ///< m; what is as far or farther is not met
  Row own;                                  ///< it passes all of this tree; not valid: it passes no body
  std::optional<double> z;                  ///< its height, world frame; none: it meets bodies of any height
  bool (*stops)(const Returns&) = nullptr;  ///< whether it ends at such a part; null: at all of them
};

/// What a ray met first.
struct Sighting {
  double range = 0;        ///< m; the ray's length where it met nothing
  BodyId body;             ///< not valid: it met nothing
  std::uint32_t part = 0;  ///< of the body's type

  bool met() const { return body.valid(); }  ///< false: nothing within the ray's length
  /// What it met, as its type says it; only where it met something.
  const PartSpec& part_spec(const World& world) const {
    return world.spec().types[world.spec().bodies[body.index()].type.index()].parts[part];
  }
};

/// The colour of what it met.
Color color_of(const World& world, const Sighting& sighting);

/// The first surface along a ray.
/// meets   outlines whose closed z interval holds the ray's height, from both sides
/// ties    of two surfaces at one range the lower (body, part)
/// errors  none; a ray that starts on an outline meets it at 0
/// cost    a walk along the ray that looks at what lies near it and ends where it meets something; doubles
///         throughout. Who casts several from one point has a Lookout (engine/lookout.hpp); rangers, which
///         cast many beams at a time, have kernels (partition/ranging.hpp).
Sighting first_met(const World& world, const SightRay& ray);

/// Where a vertex lies as seen along a ray: m, left of it negative, and onwards.
struct SeenVertex {
  Vec2 to;      ///< from the ray's origin, world frame
  double side;  ///< across the ray; times the length of its direction
  /// Of a ray by its origin and unit direction, world frame.
  SeenVertex(const Vec2& origin, const Vec2& direction, const Vec2& vertex)
      : to(vertex - origin), side(cross(to, direction)) {}
};

/// Where the ray along the unit vector `direction` meets the closed edge, m from its origin; negative: it
/// does not. Of edges that share a vertex it misses none between them.
inline double range_to_edge(const Vec2& direction, const SeenVertex& a, const SeenVertex& b) {
  constexpr double k_missed = -1;
  if (std::min(a.side, b.side) > 0 || std::max(a.side, b.side) < 0) return k_missed;
  const double along_a = a.to.dot(direction);
  const double along_b = b.to.dot(direction);
  const double near = std::min(along_a, along_b);
  const double far = std::max(along_a, along_b);
  if (a.side == b.side) return far < 0 ? k_missed : std::max(near, 0.0);  // the edge runs along the ray
  const double range = along_a + a.side / (a.side - b.side) * (along_b - along_a);
  return std::clamp(range, near, far) < 0 ? k_missed : std::clamp(range, near, far);
}
/// The same, of an edge by its ends in the world's frame.
inline double range_to_edge(const Vec2& origin, const Vec2& direction, const Vec2& a, const Vec2& b) {
  return range_to_edge(direction, SeenVertex(origin, direction, a), SeenVertex(origin, direction, b));
}

/// Holds a chain against a ray of this length: `nearest` is what it meets first of this chain and of what it
/// met before, of two surfaces at one range the lower (body, part).
inline void meet_chain(const OutlineChain& chain, const Vec2& origin, const Vec2& direction, double length,
                       Sighting& nearest) {
  if (chain.vertices.empty()) return;
  const auto meet = [&](const SeenVertex& a, const SeenVertex& b) {
    const double range = range_to_edge(direction, a, b);
    if (range < 0 || range >= length || range > nearest.range) return;
    const bool is_lower = chain.body != nearest.body ? chain.body < nearest.body : chain.part < nearest.part;
    if (range < nearest.range || is_lower) nearest = {range, chain.body, chain.part};
  };
  const SeenVertex first(origin, direction, chain.vertices.front());
  SeenVertex before = first;
  for (const Vec2& vertex : chain.vertices.subspan(1)) {
    const SeenVertex seen(origin, direction, vertex);
    meet(before, seen);
    before = seen;
  }
  if (chain.closed) meet(before, first);
}

}  // namespace troupe::engine
