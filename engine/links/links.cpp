#include "engine/links/links.hpp"

#include "base/atomic_maximum.hpp"
#include "base/room.hpp"
#include "engine/conflicts/conflict_resolver.hpp"
#include "engine/kinds/finite.hpp"
#include "engine/kinds/step_error.hpp"
#include "partition/placed_shape.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace troupe::engine {
namespace {

using partition::ObstacleShape;
using partition::PlacedShape;

constexpr std::size_t k_trees_per_task = 64;
constexpr std::size_t k_room_near = 64;  // initial capacity of the lists of trees near one tree

Pose between(const Pose& from, const Pose& to, double t) {
  return {from.x + t * (to.x - from.x), from.y + t * (to.y - from.y), from.z + t * (to.z - from.z),
          from.heading + t * (to.heading - from.heading)};
}

/// Capacity to reserve for the obstacle shape of a body together with the bodies that it carries directly.
/// Bodies that these carry in turn are not counted.
struct Room {
  std::size_t pieces = 0;
  std::size_t corners = 0;  ///< of the piece with the most corners

  void add(const ObstacleShape& shape, std::size_t times) {
    pieces += times * shape.pieces.size();
    for (const ConvexPrism& piece : shape.pieces) corners = std::max(corners, piece.outline.size());
  }
};

/// The type with the most obstacle pieces among the types whose bodies can be gripped; null if there is none.
const BodyType* most_intricate_cargo(std::span<const BodyType> types) {
  const BodyType* most = nullptr;
  for (const BodyType& type : types)
    if (!type.grip.empty() && (!most || type.obstacle.pieces.size() > most->obstacle.pieces.size()))
      most = &type;
  return most;
}

/// Returns the map of the points that a joint moves, in the frame of the body: from their positions with all
/// joints at rest to their positions with this joint displaced by `q` (m, rad). `parent` is this map for the
/// parent joint, or the identity if the joint has no parent.
Mount moved_by(const BodyType::Joint& joint, const Mount& parent, const Pose& q) {
  if (q == Pose{}) return parent;
  return compose(compose(compose(parent, joint.at_rest), Mount(q)), joint.to_body);
}

}  // namespace

/// A body of a tree. A tree consists of a root, which is a body that is not carried, and of all bodies that
/// the root carries, directly or through others. Functions visit a tree from its root.
struct Links::TreeBody {
  Row row;
  Mount place;         // the body's frame, relative to the root's frame
  bool moves = false;  // whether a joint between it and the root moves in this round of resolution
};

void Links::build() {
  const bool any = std::ranges::any_of(state_.types, [](const BodyType& t) { return t.is_composite(); });
  if (!any) return;
  resize_with_room(state_.joint_begins, state_.row_count());
  for (auto* list : {&composite_of_, &state_.roots, &first_cargo_, &next_cargo_}) {
    resize_with_room(*list, state_.row_count());
    std::ranges::fill(*list, k_none);
  }
  composites_.clear();
  std::size_t joints = 0;
  for (std::size_t i = 0; i < state_.types.size(); ++i) {
    joints += state_.pools[i].slots * state_.types[i].joints.size();
    if (state_.pools[i].rows > 0) rounds_ = std::max(rounds_, state_.types[i].joint_devices.size());
  }
  for (std::uint32_t r = 0; r < state_.row_count(); ++r) {
    const BodyType& t = state_.type(Row(r));
    state_.joint_begins[r] = state_.joint_begin(state_.row_types[r], state_.slots[r]);
    if (!t.is_composite()) continue;
    composite_of_[r] = static_cast<std::uint32_t>(composites_.size());
    composites_.push_back(r);
  }
  make_room(composites_, composites_.size());
  resize_with_room(joints_, joints);
  resize_with_room(state_.joint_mounts, joints);
  for (auto* buffers : {&shapes_, &moved_, &on_the_way_, &before_})
    resize_with_room(*buffers, composites_.size());
  resize_with_room(samples_, composites_.size());
  resize_with_room(blocked_, composites_.size());
  resize_with_room(blockers_, composites_.size());
  near_.resize(std::max(near_.size(), (composites_.size() + k_trees_per_task - 1) / k_trees_per_task));
  for (std::vector<std::uint32_t>& list : near_) list.reserve(k_room_near);

  // Reserves memory now, so that no memory is allocated when a body is gripped, unless that body carries
  // another one. Larger shapes allocate their memory when they are first computed.
  constexpr std::size_t k_most_pieces = 64;
  const BodyType* cargo = most_intricate_cargo(state_.types);
  for (std::size_t c = 0; c < composites_.size(); ++c) {
    const BodyType& t = state_.type(Row(composites_[c]));
    Room room;
    room.add(t.obstacle, 1);
    const auto carry = [](const BodyType::Device& device) { return device.kind->carries; };
    if (cargo) room.add(cargo->obstacle, static_cast<std::size_t>(std::ranges::count_if(t.devices, carry)));
    for (auto* buffers : {&shapes_, &moved_, &on_the_way_, &before_})
      (*buffers)[c].reserve(std::min(room.pieces, k_most_pieces), room.corners);
  }
}

std::span<Links::Joint> Links::joints(Row row) {
  return {joints_.data() + state_.joint_begins[row.index()], state_.type(row).joints.size()};
}
std::span<const Links::Joint> Links::joints(Row row) const {
  return {joints_.data() + state_.joint_begins[row.index()], state_.type(row).joints.size()};
}

bool Links::hold() const {
  for (const std::uint32_t r : composites_)
    for (std::size_t j = 0; j < state_.type(Row(r)).joints.size(); ++j)
      if (!is_finite(state_.joint_state(Row(r), j))) return false;
  if (!state_.carrier_table) return true;
  const auto carrier_row = [this](std::uint32_t r) {
    const std::uint32_t id = state_.carried(r).carrier;
    return id == 0 || id > state_.rows.size() ? Row() : state_.view.row(BodyId(id - 1));
  };
  for (std::uint32_t r = 0; r < state_.row_count(); ++r) {
    const Carried& link = state_.carried(r);
    if (link.carrier == 0) continue;
    const Row by = carrier_row(r);
    if (!by.valid() || !state_.type(by).carries || link.joint > state_.type(by).joints.size() ||
        !is_finite(link.pose))
      return false;
  }
  for (std::uint32_t r = 0; r < state_.row_count(); ++r) {
    std::size_t carriers = 0;  // has no limit in a cycle
    for (Row by = carrier_row(r); by.valid(); by = carrier_row(by.value))
      if (++carriers > k_most_carriers) return false;
  }
  return true;
}

void Links::derive() {
  asked_ = false;
  for (const std::uint32_t r : composites_) rest_joints(Row(r));  // before any shape of a tree is computed
  link_all();
}

void Links::link_all() {
  state_.now.carried = 0;
  if (!any()) return;
  std::ranges::fill(first_cargo_, k_none);
  for (std::uint32_t r = 0; r < state_.row_count(); ++r) state_.roots[r] = r;
  for (std::uint32_t r = 0; state_.carrier_table && r < state_.row_count(); ++r) {
    const std::uint32_t id = state_.carried(r).carrier;
    if (id != 0) link_cargo(r, state_.view.row(BodyId(id - 1)).value);
  }
  for (std::uint32_t r = 0; r < state_.row_count(); ++r) {
    std::uint32_t root = r;
    while (const auto by = state_.view.carrier(Row(root))) root = state_.view.row(*by).value;
    state_.roots[r] = root;
  }
}

void Links::forget() {
  constexpr std::uint32_t k_junk = 0x5a5a5a5a;
  const Mount nowhere(k_nowhere);
  std::ranges::fill(joints_, Joint{nowhere, k_nowhere, Goal::asked, true});
  std::ranges::fill(state_.joint_mounts, nowhere);
  for (auto* buffers : {&shapes_, &moved_, &on_the_way_, &before_})
    for (ShapeBuffer& buffer : *buffers) buffer.begin();
  for (auto* list : {&samples_, &state_.roots, &first_cargo_, &next_cargo_}) std::ranges::fill(*list, k_junk);
  std::ranges::fill(blocked_, std::uint8_t{1});
  state_.now.carried = k_junk;
  asked_ = true;
}

void Links::clear_goals(Row row) {
  for (Joint& joint : joints(row)) joint.state = Goal::none;
}

void Links::rest_joints(Row row) {
  clear_goals(row);
  move_to_joints(row);
}

/// Updates WorldState::joint_mounts of a row from the displacements of its joints in the state tables.
void Links::move_to_joints(Row row) {
  const std::span<Mount> all = state_.mounts(row);
  for (std::size_t j = 0; j < all.size(); ++j) {
    const BodyType::Joint& joint = state_.type(row).joints[j];
    const Mount parent = joint.parent == k_rigid ? Mount() : all[static_cast<std::size_t>(joint.parent)];
    all[j] = moved_by(joint, parent, state_.joint_state(row, j));
  }
}

/// Adds row `cargo` to the list of bodies that row `carrier` carries. The list is sorted by id, so that sums
/// over it do not depend on the order in which the bodies were picked up.
void Links::link_cargo(std::uint32_t cargo, std::uint32_t carrier) {
  std::uint32_t* at = &first_cargo_[carrier];
  while (*at != k_none && state_.ids[*at] < state_.ids[cargo]) at = &next_cargo_[*at];
  next_cargo_[cargo] = *at;
  *at = cargo;
  ++state_.now.carried;
}

void Links::unlink_cargo(std::uint32_t cargo, std::uint32_t carrier) {
  std::uint32_t* at = &first_cargo_[carrier];
  while (*at != cargo) at = &next_cargo_[*at];
  *at = next_cargo_[cargo];
  --state_.now.carried;
}

void Links::set_root(std::uint32_t row, std::uint32_t root) {
  state_.roots[row] = root;
  for (std::uint32_t c = first_cargo_[row]; c != k_none; c = next_cargo_[c]) set_root(c, root);
}

/// Adds to `out` the obstacle pieces of a body and of all bodies that it carries, in the frame of the root.
/// If `then` is false, joints are where they are now. If it is true, they are at Joint::then, and only
/// the pieces that move in this round of resolution are added. Lowers `thinnest` to the width of the thinnest
/// obstacle piece of these bodies, m.
void Links::add_tree_body(const TreeBody& body, bool then, ShapeBuffer& out, double& thinnest) const {
  const BodyType& t = state_.type(body.row);
  const std::span<const Joint> all = joints(body.row);
  const std::span<const Mount> mounts = state_.mounts(body.row);
  thinnest = t.obstacle.empty() ? thinnest : std::min(thinnest, t.obstacle.thinnest);
  for (std::size_t p = 0; p < t.obstacle.pieces.size(); ++p) {
    const std::int32_t j = t.obstacle_joints.empty() ? k_rigid : t.obstacle_joints[p];
    if (j == k_rigid) {
      if (!then || body.moves) out.add(t.obstacle.pieces[p], body.place);
      continue;
    }
    const Joint& joint = all[static_cast<std::size_t>(j)];
    if (!then || body.moves || joint.moves)
      out.add(t.obstacle.pieces[p],
              compose(body.place, then ? joint.then : mounts[static_cast<std::size_t>(j)]));
  }
  for (std::uint32_t c = first_cargo_[body.row.index()]; c != k_none; c = next_cargo_[c]) {
    const Carried& link = state_.carried(c);
    TreeBody cargo{Row(c), body.place, body.moves};
    if (link.joint > 0) {
      const Joint& joint = all[link.joint - 1];
      cargo.place = compose(cargo.place, then ? joint.then : mounts[link.joint - 1]);
      cargo.moves = cargo.moves || joint.moves;
    }
    cargo.place = compose(cargo.place, Mount(link.pose));
    add_tree_body(cargo, then, out, thinnest);
  }
}

void Links::reshape(std::uint32_t row) {
  state_.free_circles[row] = FreeCircle();  // another shape may overlap what the one before did not
  if (!state_.view.is_there(Row(row))) return state_.update_presence(Row(row));
  const BodyType& t = state_.type(Row(row));
  const std::uint32_t c = composite_of_[row];
  const ObstacleShape* shape = &t.obstacle;
  // A body without cargo whose joints are at rest uses the shape of its type, which stays in the CPU caches.
  const auto is_at_rest = [&] {
    for (std::size_t j = 0; j < t.joints.size(); ++j)
      if (!(state_.joint_state(Row(row), j) == Pose{})) return false;
    return first_cargo_[row] == k_none;
  };
  if (state_.roots[row] != row) {
    shape = &k_no_shape;
  } else if (c != k_none && !is_at_rest()) {
    double thinnest = std::numeric_limits<double>::infinity();
    shapes_[c].begin();
    add_tree_body({Row(row), Mount()}, false, shapes_[c], thinnest);
    shapes_[c].finish(thinnest);
    shape = &shapes_[c].shape();
  }
  state_.shapes[row] = shape;
  double shift = 0;
  if (c != k_none)
    for (const Mount& joint : state_.mounts(Row(row)))
      shift = std::max(shift, joint.transform.position.norm());
  // An upper bound for all points of the body: a joint's mount rotates points about the body's origin, which
  // keeps their distance from it, and then shifts them.
  state_.radii[row] = std::max(t.radius + shift, shape->radius);
}

void Links::add_cargo(Row row, std::vector<Row>& rows) const {
  for (std::uint32_t c = first_cargo_[row.index()]; c != k_none; c = next_cargo_[c]) {
    rows.emplace_back(c);
    add_cargo(Row(c), rows);
  }
}

double Links::farthest_shift(const BodyType& type) {
  // A joint turns points about its axis and shifts them. As a map of the body frame (moved_by()), it turns
  // them about the origin, and then shifts them by at most twice the distance of the axis from the origin
  // plus the shift of the joint itself.
  std::vector<double> axes;  // per joint: the sum of twice these distances, with those of its parents
  for (const BodyType::Joint& joint : type.joints)
    axes.push_back((joint.parent == k_rigid ? 0 : axes[static_cast<std::size_t>(joint.parent)]) +
                   2 * joint.at_rest.transform.position.norm());
  return axes.empty() ? 0 : std::ranges::max(axes) + type.joint_reach;
}

double Links::farthest(Row row) const {
  const BodyType& type = state_.type(row);
  const double shift = farthest_shift(type);
  double farthest = std::max(type.radius, type.obstacle.radius) + shift;
  for (std::uint32_t c = first_cargo_[row.index()]; c != k_none; c = next_cargo_[c]) {
    const Carried& link = state_.carried(c);
    farthest = std::max(farthest,
                        (link.joint > 0 ? shift : 0) + link.pose.position().norm() + this->farthest(Row(c)));
  }
  return farthest;
}

// ---- Resolution of joint motions

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

template <class Work>
void Links::for_roots(Work&& work) {
  parallel_.for_batches(composites_.size(), k_trees_per_task, [&](std::size_t first, std::size_t end) {
    for (std::size_t c = first; c < end; ++c)
      if (const std::uint32_t r = composites_[c]; state_.roots[r] == r) work(c, r);
  });
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
    const auto end = near.begin() + static_cast<std::ptrdiff_t>(std::min(near.size(), k_room_near));
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

// ---- Cargo

void Links::carry() {
  if (state_.now.carried == 0) return;
  for_roots([&](std::size_t, std::uint32_t r) { carry_cargo_of(Row(r)); });
}

void Links::carry_cargo_of(Row carrier) {
  for (std::uint32_t c = first_cargo_[carrier.index()]; c != k_none; c = next_cargo_[c]) {
    const Carried& link = state_.carried(c);
    const Mount hook = state_.view.mount(carrier, static_cast<std::int32_t>(link.joint) - 1);
    const Pose pose = compose(hook, Mount(link.pose)).pose();
    state_.poses()[c] = pose;
    state_.update_outlines(Row(c), state_.type(Row(c)), Transform(pose));
    carry_cargo_of(Row(c));
  }
}

/// Number of bodies in the longest chain of bodies that the row's body carries, each of which carries the
/// next.
std::size_t Links::longest_chain(std::uint32_t row) const {
  std::size_t longest = 0;
  for (std::uint32_t c = first_cargo_[row]; c != k_none; c = next_cargo_[c])
    longest = std::max(longest, 1 + longest_chain(c));
  return longest;
}

bool Links::attach(Row cargo, Row carrier, std::int32_t joint) {
  if (!state_.type(carrier).carries || state_.view.carrier(cargo) ||
      state_.roots[carrier.index()] == cargo.value)
    return false;
  std::size_t carriers = 1 + longest_chain(cargo.value);  // of the last body of the chain
  for (auto by = state_.view.carrier(carrier); by; by = state_.view.carrier(state_.view.row(*by))) ++carriers;
  if (carriers > k_most_carriers) return false;
  const Mount hook = state_.view.mount(carrier, joint);
  Carried& link = state_.carried(cargo.value);
  link.carrier = state_.view.body(carrier).value + 1;
  link.joint = static_cast<std::uint32_t>(joint + 1);
  link.pose = compose(inverse(hook), state_.view.mount(cargo, k_rigid)).pose();
  link_cargo(cargo.value, carrier.value);
  set_root(cargo.value, state_.roots[carrier.index()]);
  reshape(cargo.value);
  reshape(state_.roots[carrier.index()]);
  return true;
}

void Links::release(Row cargo) {
  const std::optional<BodyId> by = state_.view.carrier(cargo);
  if (!by) return;
  const Row carrier = state_.view.row(*by);
  state_.carried(cargo.value) = {};
  unlink_cargo(cargo.value, carrier.value);
  set_root(cargo.value, cargo.value);
  reshape(cargo.value);
  reshape(state_.roots[carrier.index()]);
}

// ---- Joints in DeviceBatch

namespace {

/// Index of joint n of the device of a batch in the list of joints of the type. Throws StepError if the kind
/// of the device declares no joint n, because the kind may come from a plug-in.
std::size_t joint_index(const DeviceBatch& batch, std::size_t i, std::size_t n) {
  const BodyType::Device& device = batch.view.type(batch.row(i)).devices[batch.device];
  if (n >= device.kind->joints.size())
    throw StepError(fmt::format(
        "tick {}: device \"{}\" ({}) of \"{}\" uses its joint with the index {} (counted from 0), but "
        "its kind has {} joints (DeviceKind::joints)",
        batch.view.tick(), device.name, device.kind->name, batch.view.spec().name(batch.body(i)), n,
        device.kind->joints.size()));
  return static_cast<std::size_t>(device.moves) + n;
}

}  // namespace

const Pose& DeviceBatch::joint(std::size_t i, std::size_t n) const {
  const BodyType::Joint& moved = view.type(row(i)).joints[joint_index(*this, i, n)];
  return view.columns_.tables[moved.table].as<Pose>(slot(i));
}
void DeviceBatch::move_joint(std::size_t i, std::size_t n, const Pose& to) const {
  if (!is_finite(to))
    throw StepError(
        fmt::format("tick {}: a device of \"{}\" moves joint {} (counted from 0) to x {}, y {}, z {} (m), "
                    "heading {} (rad): DeviceBatch::move_joint() needs finite numbers",
                    view.tick(), view.spec().name(body(i)), n, to.x, to.y, to.z, to.heading));
  links.ask(row(i), joint_index(*this, i, n), to);
}
bool DeviceBatch::asked_joint(std::size_t i, std::size_t n) const {
  return links.goal(row(i), joint_index(*this, i, n)) != Links::Goal::none;
}
bool DeviceBatch::moved_joint(std::size_t i, std::size_t n) const {
  return links.goal(row(i), joint_index(*this, i, n)) == Links::Goal::moved;
}

}  // namespace troupe::engine
