#pragma once

#include "engine/sensing/ray_hit.hpp"
#include "engine/sensing/sensing_view.hpp"

#include <algorithm>
#include <optional>
#include <span>

namespace troupe::engine {

/// A chain of edges: a whole outline of a body, or a section of an outline. The chain has an edge from each
/// vertex to the next. A closed chain also has an edge from the last vertex to the first. A body consists of
/// parts, and a part of solids. A solid is an extruded polygon, whose edges form outlines. The static scene
/// is the set of the solids of all bodies that do not move during a run; all other bodies are mobile. A
/// ranger is a sensor that measures distances along rays.
struct OutlineChain {
  std::span<const Vec2> vertices;  ///< vertices along the outline; valid until the next step
  bool closed = false;             ///< true: a whole closed outline; false: a section of one
  ZInterval z;                     ///< height interval, world frame, m
  BodyId body;                     ///< the body that it belongs to
  std::uint32_t part = 0;          ///< the part that it belongs to: index in the body's type
  /// Number of the solid that the outline belongs to. All chains with the same `body` and `solid` together
  /// bound one region (even-odd rule).
  std::uint32_t solid = 0;
  /// A number that differs between the chains of one solid.
  std::uint32_t piece = 0;
  float ranger_return = 1;  ///< intensity that rangers read; below 0: rays of rangers pass through the chain
};

/// Calls visit(begin, end) with the two ends (m, world frame) of each edge of the chain.
template <class Visit>
void for_each_edge(const OutlineChain& chain, Visit&& visit) {
  for (std::size_t i = 0; i + 1 < chain.vertices.size(); ++i) visit(chain.vertices[i], chain.vertices[i + 1]);
  if (chain.closed && !chain.vertices.empty()) visit(chain.vertices.back(), chain.vertices.front());
}

/// Returns a piece of an outline of the static scene as a chain. A piece is a section of an outline.
/// `outlines` must be scene.outlines() or scene.hidden_outlines(), and `piece` is the number of the piece in
/// `outlines`.
inline OutlineChain fixed_chain(const partition::StaticScene& scene, const partition::FixedOutlines& outlines,
                                std::uint32_t piece) {
  const partition::FixedSolid& solid = scene.solids()[outlines.solid(piece)];
  return {outlines.chain(piece), false, solid.solid.z,      solid.body, solid.part,
          outlines.solid(piece), piece, solid.ranger_return};
}

/// Calls visit(chain) for pieces of the outlines of the static scene, including pieces that rangers do not
/// see. A piece is visited if it has an enclosing circle that may touch the box (world frame, m), and if
/// wanted(circle) is true. The circle is a partition::BodyCircle. A piece may be visited more than once.
template <class Wanted, class Visit>
void for_each_fixed_chain(const SensingView& view, const Box& box, Wanted&& wanted, Visit&& visit) {
  const partition::StaticScene& scene = view.scene();
  for (const partition::FixedOutlines* outlines : {&scene.outlines(), &scene.hidden_outlines()}) {
    outlines->for_each_run(box, [&](std::span<const partition::BodyCircle> circles) {
      for (const partition::BodyCircle& circle : circles)
        if (wanted(circle)) visit(fixed_chain(scene, *outlines, circle.row));
    });
  }
}

/// Calls visit(chain) for each outline of a row's body, including those that rangers do not see. A row is the
/// index of a body in the state tables. The body must be in the world.
template <class Visit>
void for_each_chain_of(const SensingView& view, Row row, Visit&& visit) {
  const std::span<const Vec2> vertices = view.outline(row);
  const double base = view.poses()[row.index()].z;
  const BodyType& type = view.type(row);
  for (const std::vector<RayOutline>* outlines : {&type.outlines, &type.hidden_outlines})
    for (const RayOutline& outline : *outlines)
      visit(OutlineChain{vertices.subspan(outline.first, outline.count), true,
                         outline.z.shifted(base + view.lift(row, outline.joint)), view.body(row),
                         outline.part, outline.solid, outline.first, outline.ranger_return});
}

/// Calls visit(chain) for the outlines of mobile bodies, including outlines that rangers do not see. All
/// outlines of a body are visited once if the body's enclosing circle may touch the box (world frame, m), and
/// if wanted(circle) is true. The circle is a partition::BodyCircle.
///
/// own: row (index in the state tables) of a body to skip, together with the bodies that move with it
/// (SensingView::same_tree()); not valid(): no body is skipped
template <class Wanted, class Visit>
void for_each_body_chain(const SensingView& view, const Box& box, Row own, Wanted&& wanted, Visit&& visit) {
  view.index().for_each_near(box, [&](const partition::BodyCircle& circle) {
    const Row row(circle.row);
    if (!wanted(circle) || (own.valid() && view.same_tree(row, own))) return;
    for_each_chain_of(view, row, visit);
  });
}

/// A horizontal ray, for first_met().
struct SightRay {
  Vec2 origin = Vec2::Zero();      ///< start of the ray, world frame, m
  Vec2 direction = Vec2::UnitX();  ///< unit vector, world frame
  double length = 0;               ///< length, m; surfaces at this range or farther are not hit
  /// Row of the sensor's body. The ray passes through this body and through the bodies that move together
  /// with it (SensingView::same_tree()). Not valid(): the ray passes through no body.
  Row own;
  std::optional<double> z =
      {};  ///< height of the ray, world frame, m; not set: it hits surfaces at any height
  bool (*stops)(const Returns&) = nullptr;  ///< returns whether a part stops the ray; null: all parts do
  /// Row of a second body that the ray passes through, together with the bodies that move with it. Example:
  /// the body of a lamp towards which the ray points. Not valid(): there is no such body.
  Row target = {};
};

/// Returns the part whose surface a ray hit. Call this only if hit.met() is true.
inline const PartSpec& part_of(const SensingView& view, const RayHit& hit) {
  return view.spec().type(hit.body).parts[hit.part];
}

/// Returns the present colour of the part that a ray hit. If a device sets the colour of the part
/// (shown_color()), the result is that colour. Otherwise it is the colour of the part in the world file. If
/// the part has none, it is the colour of the part's body. Call this only if hit.met() is true.
Color color_of(const CommittedView& view, const RayHit& hit);

/// Returns the first surface that a ray hits, computed in double precision. If the ray hits nothing,
/// RayHit::range_m is the length of the ray, and RayHit::met() is false.
/// hits    The ray hits an outline if the height of the ray is within the height interval of the outline,
///         limits included. It also hits outlines from inside the body. A ray that starts on an outline hits
///         it at range 0.
/// ties    If surfaces of two bodies are at the same range, the body with the lower id is returned. If they
///         belong to one body, the part with the lower index is returned.
/// cost    The function searches the spatial indices step by step along the ray, up to the first surface.
///         Sensors that cast several rays from one point use VisibilityQuery
///         (engine/sensing/visibility_query.hpp). Rangers, which cast many rays at once, use the functions of
///         partition/ranging.hpp.
RayHit first_met(const SensingView& view, const SightRay& ray);

/// The position of a vertex of an outline relative to a ray.
struct SeenVertex {
  Vec2 to;      ///< vector from the ray's origin to the vertex, world frame, m
  double side;  ///< signed distance of the vertex from the ray's line, m; negative to the left of the ray
  /// `origin` and `direction` define the ray, and `direction` has unit length. All arguments are in the world
  /// frame, positions in m.
  SeenVertex(const Vec2& origin, const Vec2& direction, const Vec2& vertex)
      : to(vertex - origin), side(cross(to, direction)) {}
};

/// Range at which a ray of unlimited length hits the edge from a to b, m; negative if the ray does not hit
/// the edge. The ends belong to the edge, so a ray never passes between two edges that share a vertex. If the
/// edge runs along the ray, the result is the range to the nearer end of the edge, or 0 if the ray starts on
/// the edge. `a` and `b` must have been made with the same origin and with this `direction`.
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
/// Range at which a ray with this origin and unit direction hits the edge from a to b, m; negative if it does
/// not hit the edge. All arguments are in the world frame.
inline double range_to_edge(const Vec2& origin, const Vec2& direction, const Vec2& a, const Vec2& b) {
  return range_to_edge(direction, SeenVertex(origin, direction, a), SeenVertex(origin, direction, b));
}

/// Tests a ray against the edges of a chain, and updates `nearest`, the nearest surface that the ray has hit
/// so far. Does not compare the heights of the ray and the chain. `origin` (m) and `direction` (unit length)
/// are in the world frame; `length` is the length of the ray, m. Before the call for the first chain,
/// `nearest.range_m` must be the length of the ray, and `nearest.body` must not be valid(). Ties are resolved
/// as in first_met().
inline void meet_chain(const OutlineChain& chain, const Vec2& origin, const Vec2& direction, double length,
                       RayHit& nearest) {
  if (chain.vertices.empty()) return;
  const auto meet = [&](const SeenVertex& a, const SeenVertex& b) {
    const double range = range_to_edge(direction, a, b);
    if (range < 0 || range >= length || range > nearest.range_m) return;
    const bool is_lower = chain.body != nearest.body ? chain.body < nearest.body : chain.part < nearest.part;
    if (range < nearest.range_m || is_lower) nearest = {range, chain.body, chain.part};
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
