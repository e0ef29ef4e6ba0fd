#include "base/atomic_extremes.hpp"
#include "engine/conflicts/conflict_resolver.hpp"
#include "engine/links/links.hpp"
#include "engine/links/tree_body.hpp"
#include "partition/placed_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

// The functions of Links that resolve the motions of joints.

namespace troupe::engine {
namespace {

using partition::ObstacleShape;
using partition::PlacedShape;

Pose between(const Pose& from, const Pose& to, double t) {
  return {from.x + t * (to.x - from.x), from.y + t * (to.y - from.y), from.z + t * (to.z - from.z),
          from.heading + t * (to.heading - from.heading)};
}

}  // namespace

void Links::ask(Row row, std::size_t joint, const Pose& to) {
  Joint& asked = joints(row)[joint];
  asked.goal = {to.x + 0.0, to.y + 0.0, to.z + 0.0, to.heading + 0.0};
  asked.state = Goal::asked;
  if (!asked_.load(std::memory_order_relaxed)) asked_.store(true, std::memory_order_relaxed);
}

std::optional<Pose> Links::asked(Row row, std::size_t joint) const {
  const Joint& asked = joints(row)[joint];
  return asked.state == Goal::asked ? std::optional(asked.goal) : std::nullopt;
}

bool Links::moves_joints(Row root) const {
  const std::uint32_t c = composite_of_[root.index()];
  return c != k_none && state_.roots[root.index()] == root.value && samples_[c] > 0;
}

std::vector<Links::AskedGoal> Links::asked_goals(RowRange rows) const {
  std::vector<AskedGoal> goals;
  if (!any() || !asked_.load(std::memory_order_relaxed)) return goals;
  for (auto r = static_cast<std::uint32_t>(rows.first); r < rows.end; ++r) {
    const std::span<const Joint> all = joints(Row(r));
    for (std::uint32_t j = 0; j < all.size(); ++j)
      if (all[j].state == Goal::asked) goals.push_back({r, j, all[j].goal});
  }
  return goals;
}

/// Resolution has several rounds. A round tests the motions of the joints of one device per body; parent
/// joints move in earlier rounds than their children. In each round, the moving pieces of a tree must be
/// free of the static scene. They must also be free of every other tree at its present pose, both with the
/// joints of that tree where they are now and with these joints at their goals. The order in which two trees
/// are tested therefore does not matter, and they do not come to overlap, whether one of them moves or both.
/// What a moving piece already overlaps does not block a motion that takes it no deeper (class Conflicts,
/// `rule`).
void Links::resolve_joints(double longest_motion, Border* border) {
  if (!asked_.load(std::memory_order_relaxed)) return;
  // The index still contains each tree as a circle about its origin before this tick. Since then its origin
  // has moved by at most the longest motion or push, and its radius has grown by at most the joint motions of
  // this tick, including those of this round. Turns of bodies change neither origin nor radius.
  double reach = longest_motion;
  for (std::size_t round = 0; round < rounds_; ++round) {
    std::atomic<std::uint64_t> longest = 0;
    for_roots([&](std::size_t c, std::uint32_t r) { raise_to(longest, ask_joints(c, Row(r), round)); });
    if (longest == 0) continue;
    reach += value_of(longest) + partition::k_rounding_m;
    for_roots([&](std::size_t c, std::uint32_t r) {
      if (samples_[c] > 0 && r < state_.own_rows) blocked_[c] = joints_blocked(c, Row(r), round, reach);
    });
    if (border) border->exchange_blocked(*this);
    for_roots([&](std::size_t c, std::uint32_t r) {
      if (samples_[c] > 0) answer_joints(Row(r), round, blocked_[c] != 0, blockers_[c]);
    });
  }
}

/// Computes Joint::then for the joints of a body and of all bodies that it carries, at a fraction t (0
/// to 1) of their motions of this round. Returns upper bounds on how far the complete motions (t = 1) move
/// any point. They are 0 if no joint moves in this round. `radius` must be an upper bound on the distance of
/// any point from the root, m.
Links::Way Links::aim_joints(const TreeBody& body, std::size_t round, double t, double radius) {
  const BodyType& type = state_.type(body.row);
  const std::span<Joint> all = joints(body.row);
  std::size_t first = 0;
  std::size_t last = 0;
  if (round < type.joint_devices.size()) {
    const BodyType::Device& device = type.devices[type.joint_devices[round]];
    first = static_cast<std::size_t>(device.moves);
    last = first + device.kind->joints.size();
  }
  double way = 0;
  double rise = 0;
  for (std::size_t j = 0; j < all.size(); ++j) {
    const BodyType::Joint& joint = type.joints[j];
    const Joint* parent = joint.parent == k_rigid ? nullptr : &all[static_cast<std::size_t>(joint.parent)];
    Pose q = state_.joint_state(body.row, j);
    const bool is_asked = first <= j && j < last && all[j].state == Goal::asked;
    all[j].moves = is_asked || (parent && parent->moves);
    if (is_asked) {
      const Pose& to = all[j].goal;
      const Mount axis = compose(compose(body.place, parent ? parent->then : Mount()), joint.at_rest);
      way += Vec2(to.x - q.x, to.y - q.y).norm() + std::abs(to.z - q.z) +
             std::abs(to.heading - q.heading) * (radius + way + axis.transform.position.norm());
      rise += std::abs(to.z - q.z);
      // A turn of a joint at the body's origin moves no point of a body without obstacles. It counts as a
      // motion all the same.
      if (to != q) way = std::max(way, partition::k_rounding_m);
      q = t < 1 ? between(q, to, t) : to;
    }
    all[j].then = moved_by(joint, parent ? parent->then : Mount(), q);
  }
  for (std::uint32_t c = first_cargo_[body.row.index()]; c != k_none; c = next_cargo_[c]) {
    const Carried& link = state_.carried(c);
    Mount place = body.place;
    if (link.joint > 0) place = compose(place, state_.mounts(body.row)[link.joint - 1]);
    const Way added = aim_joints({Row(c), compose(place, Mount(link.pose))}, round, t, radius + way);
    way += added.total;
    rise += added.rise;
  }
  return {way, rise};
}

/// Makes the shape of the moving pieces of a tree, with the joints at Joint::then. Returns the width of the
/// thinnest obstacle piece of the bodies of the tree, m.
double Links::shape_moving(Row root, ShapeBuffer& shape) const {
  double thinnest = std::numeric_limits<double>::infinity();
  shape.begin();
  add_tree_body({root, Mount()}, true, shape, thinnest);
  shape.finish(thinnest);
  return thinnest;
}

/// Computes the shape of the moving pieces of a tree at their goals, and the number of samples at which their
/// motion is tested. `c` is the index of the root in composites_. Returns an upper bound on how far any
/// point moves, m; 0 if no joint of the tree moves in this round.
double Links::ask_joints(std::size_t c, Row root, std::size_t round) {
  samples_[c] = 0;
  blocked_[c] = 0;
  const auto is_asked = [](const Joint& joint) { return joint.state == Goal::asked; };
  const bool carries = first_cargo_[root.index()] != k_none;
  if (!carries && std::ranges::none_of(joints(root), is_asked)) return 0;
  const auto [way, rise] = aim_joints({root, Mount()}, round, 1, state_.shapes[root.index()]->radius);
  if (way == 0) {
    mark_joints(root, round, Goal::moved);  // those that were asked are already at their goals
    return 0;
  }
  ShapeBuffer& moved = moved_[c];
  const double thinnest = shape_moving(root, moved);
  // The samples are as close to one another as those of motions of bodies, and at most as many (see
  // Conflicts). In addition, no piece rises or sinks by more than a quarter of its height from one sample to
  // the next, or it could pass through a thin shelf.
  std::size_t samples = moved.shape().empty() ? 1 : motion_samples(way, thinnest);
  if (rise > 0)
    for (const ConvexPrism& piece : moved.shape().pieces)
      if (const double height = piece.z.max - piece.z.min; height > 0)  // a flat piece overlaps nothing
        samples = std::max(samples, motion_samples(rise, height));
  samples_[c] = static_cast<std::uint32_t>(samples);
  return way;
}

bool Links::joints_blocked(std::size_t c, Row root, std::size_t round, double reach) {
  const Transform& at = state_.view.transform(root);
  const double z = state_.poses()[root.index()].z;
  const std::uint32_t n = samples_[c];
  if (moved_[c].shape().empty()) return false;
  const std::span<const std::uint32_t> others = roots_near(c, root, reach);
  const double radius = state_.shapes[root.index()]->radius;
  const auto shape_at = [&](std::uint32_t k, ShapeBuffer& shape) {
    aim_joints({root, Mount()}, round, static_cast<double>(k) / n, radius);
    shape_moving(root, shape);
  };
  for (std::uint32_t k = 1; k <= n; ++k) {
    if (k < n) shape_at(k, on_the_way_[c]);
    const PlacedShape after((k < n ? on_the_way_ : moved_)[c].shape(), at, z);
    const bool meets_scene = state_.scene.has_obstacles() && state_.scene.overlaps(after);
    if (!meets_scene && !meets_others(root, others, after)) continue;
    shape_at(k - 1, before_[c]);
    const PlacedShape before(before_[c].shape(), at, z);
    if ((meets_scene && (!state_.scene.overlaps(before) || state_.scene.deepens(before, after))) ||
        blocked_by_others(root, others, before, after)) {
      if (state_.has_contacts()) blockers_[c] = joint_blocker(root, others, before, after);
      return true;
    }
  }
  return false;
}

/// The body that blocks the moving pieces of a tree at a sample, by the rule of Contact.
BodyId Links::joint_blocker(Row root, std::span<const std::uint32_t> others, const PlacedShape& before,
                            const PlacedShape& after) const {
  if (state_.scene.has_obstacles())
    if (const BodyId body = state_.scene.blocker(before, after); body.valid()) return body;
  BodyId lowest;
  for (const std::uint32_t other : others) {
    const BodyId body = state_.view.body(Row(other));
    if (body < lowest && blocked_by_others(root, {&other, 1}, before, after)) lowest = body;
  }
  return lowest;
}

/// Lists the roots of the other trees that may overlap the moving pieces of a tree at any pose of this round,
/// and those of some trees farther away. The list is valid until the next call for a tree of the same task
/// of for_roots(). `reach`: upper bound on how far any tree extends beyond its circle in the index, and on
/// how far any piece moves in this round, m.
std::span<const std::uint32_t> Links::roots_near(std::size_t c, Row root, double reach) {
  Box box;  // of the moving pieces at their goals
  for (const partition::PieceCircle& circle : moved_[c].shape().circles)
    box.extend(Box::around(state_.view.transform(root) * circle.centre, circle.radius));
  const Vec2 centre = box.center();
  const double radius = 0.5 * box.size().norm() + 2 * reach;
  std::vector<std::uint32_t>& near = near_[c / k_trees_per_task];
  near.clear();
  // A joint can move a piece far away from the origin of its body. The circle of the body is then wide: the
  // index lists it in many cells. Hence the search is near the pieces, not near the whole body, and each tree
  // is listed once. BodyIndex::for_each_near() would not do: it reads the present poses and radii, which are
  // not those for which the index was built. The first comparison keeps the list short before it is sorted.
  const bool has_wide = state_.index.has_wide();
  const auto is_repeat = [&](std::uint32_t tree) {
    const auto end = near.begin() + static_cast<std::ptrdiff_t>(std::min(near.size(), k_near_capacity));
    return has_wide && std::find(near.begin(), end, tree) != end;
  };
  state_.index.for_each_run(Box::around(centre, radius), [&](std::span<const partition::BodyCircle> run) {
    for (const partition::BodyCircle& circle : run) {
      const std::uint32_t tree = state_.roots[circle.row];
      if (partition::in_reach(centre, radius, Vec2(circle.x, circle.y), circle.radius) &&
          tree != root.value && !is_repeat(tree))
        near.push_back(tree);
    }
  });
  if (has_wide) {
    std::ranges::sort(near);
    near.erase(std::unique(near.begin(), near.end()), near.end());
  }
  return near;
}

/// Calls visit(theirs, now, meets) for the shapes of each of the trees `others` that may overlap `mine`, a
/// shape of the tree of `root`, until a call returns true: `theirs` is the shape of the other tree now and,
/// if its joints move in this round, also that of its moving pieces at their goals; `now` is its shape now.
/// meets(a, b) returns whether a shape of the tree of `root` overlaps one of the other tree. Returns whether
/// a call returned true.
template <class Visit>
bool Links::any_near(Row root, const PlacedShape& mine, std::span<const std::uint32_t> others,
                     Visit&& visit) const {
  return std::ranges::any_of(others, [&](std::uint32_t tree) {
    const Row other(tree);
    const ObstacleShape& shape = *state_.shapes[other.index()];
    if (shape.empty()) return false;
    const std::uint32_t c = composite_of_[other.index()];
    const ObstacleShape* goal = c != k_none && samples_[c] > 0 ? &moved_[c].shape() : nullptr;
    const Transform& at = state_.view.transform(other);
    const double z = state_.poses()[other.index()].z;
    const double radius = goal ? std::max(shape.radius, goal->radius) : shape.radius;
    if (!partition::in_reach(mine.position(), mine.shape().radius, at.position, radius)) return false;
    const bool is_first = state_.view.body(root) < state_.view.body(other);
    const auto meets = [is_first](const PlacedShape& a, const PlacedShape& b) {
      return is_first ? overlap(a, b) : overlap(b, a);
    };
    const PlacedShape now(shape, at, z);
    return visit(now, now, meets) || (goal && visit(PlacedShape(*goal, at, z), now, meets));
  });
}

bool Links::meets_others(Row root, std::span<const std::uint32_t> others, const PlacedShape& mine) const {
  return any_near(root, mine, others, [&](const PlacedShape& theirs, const PlacedShape&, auto&& meets) {
    return meets(mine, theirs);
  });
}

/// Whether the moving pieces of a tree, which go from `before` to `after`, thereby come to overlap another
/// tree, or overlap it more deeply. `others`: the trees to test, roots_near()
bool Links::blocked_by_others(Row root, std::span<const std::uint32_t> others, const PlacedShape& before,
                              const PlacedShape& after) const {
  return any_near(root, after, others, [&](const PlacedShape& theirs, const PlacedShape& now, auto&& meets) {
    return meets(after, theirs) && (!meets(before, now) || partition::deepens(before, after, theirs));
  });
}

/// Sets the state of the joints that a round tests, for a body and for all bodies that it carries. The poses
/// of the joints stay.
void Links::mark_joints(Row row, std::size_t round, Goal state) {
  const BodyType& type = state_.type(row);
  if (round < type.joint_devices.size()) {
    const BodyType::Device& device = type.devices[type.joint_devices[round]];
    const auto first = static_cast<std::size_t>(device.moves);
    for (Joint& joint : joints(row).subspan(first, device.kind->joints.size()))
      if (joint.state == Goal::asked) joint.state = state;
  }
  for (std::uint32_t c = first_cargo_[row.index()]; c != k_none; c = next_cargo_[c])
    mark_joints(Row(c), round, state);
}

/// Ends a round of resolution for a body and for all bodies that it carries. If `blocked` is false, their
/// joints move to their goals. If it is true, the joints stay, and are marked as blocked: by the body `by`.
void Links::answer_joints(Row row, std::size_t round, bool blocked, BodyId by) {
  const BodyType& type = state_.type(row);
  if (round < type.joint_devices.size()) {
    const BodyType::Device& device = type.devices[type.joint_devices[round]];
    const std::span<Joint> all = joints(row);
    for (std::size_t n = 0; n < device.kind->joints.size(); ++n) {
      const std::size_t j = static_cast<std::size_t>(device.moves) + n;
      if (all[j].state != Goal::asked) continue;
      all[j].state = blocked ? Goal::blocked : Goal::moved;
      if (blocked && state_.has_contacts() && row.index() < state_.own_rows)
        if (Contact& contact = state_.contact(row); contact.cause == Contact::k_none)
          contact = {Contact::k_joint, by.value + 1, 0};
      if (!blocked) state_.joint_state(row, j) = all[j].goal;
    }
  }
  if (!blocked) {
    move_to_joints(row);
    // carry() updates the outlines of carried bodies.
    if (state_.roots[row.index()] == row.value) state_.update_outlines(row, type, state_.view.transform(row));
  }
  for (std::uint32_t c = first_cargo_[row.index()]; c != k_none; c = next_cargo_[c])
    answer_joints(Row(c), round, blocked, by);
  if (!blocked) reshape(row.value);
}

}  // namespace troupe::engine
