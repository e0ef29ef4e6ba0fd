#include "engine/links.hpp"

#include "engine/world.hpp"
#include "partition/placed_shape.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace troupe::engine {
namespace {

using partition::ObstacleShape;
using partition::PlacedShape;

constexpr std::size_t k_batch = 64;  // trees per task

const ObstacleShape k_no_shape;

Pose between(const Pose& from, const Pose& to, double t) {
  return {from.x + t * (to.x - from.x), from.y + t * (to.y - from.y), from.z + t * (to.z - from.z),
          from.heading + t * (to.heading - from.heading)};
}

bool is_finite(const Pose& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) && std::isfinite(p.heading);
}

/// Capacity to reserve for the obstacle shape of a body and of the bodies that it carries. Bodies that are
/// carried by these in turn are not counted.
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

/// Maps the points that a joint moves from their positions with all joints at rest to their positions with
/// this joint displaced by `q` (m, rad), in the frame of the body. `parent` is the same map of the parent
/// joint, or the identity if the joint has no parent.
Mount moved_by(const BodyType::Joint& joint, const Mount& parent, const Pose& q) {
  if (q == Pose{}) return parent;
  return compose(compose(compose(parent, joint.at_rest), Mount(q)), joint.to_body);
}

}  // namespace

/// A body of a tree, which is a body and the bodies that it carries, directly or through others. Trees are
/// visited from the root, the body that is not carried.
struct World::TreeBody {
  Row row;
  Mount place;         // the body's frame, relative to the root's frame
  bool moves = false;  // whether a joint between it and the root moves in this round of resolution
};

void World::build_links() {
  Links& links = links_;
  const bool any = std::ranges::any_of(types_, [](const BodyType& t) { return t.is_composite(); });
  if (!any) return;
  links.joint_begins.resize(rows());
  links.composite_of.assign(rows(), Links::k_none);
  for (auto* list : {&links.roots, &links.first_cargo, &links.next_cargo})
    list->assign(rows(), Links::k_none);
  std::size_t joints = 0;
  for (std::uint32_t r = 0; r < rows(); ++r) {
    const BodyType& t = type(Row(r));
    links.joint_begins[r] = static_cast<std::uint32_t>(joints);
    joints += t.joints.size();
    links.rounds = std::max(links.rounds, t.joint_devices.size());
    if (!t.is_composite()) continue;
    links.composite_of[r] = static_cast<std::uint32_t>(links.composites.size());
    links.composites.push_back(r);
  }
  links.joints.resize(joints);
  links.shapes.resize(links.composites.size());
  links.moved.resize(links.composites.size());
  links.on_the_way.resize(links.composites.size());
  links.samples.resize(links.composites.size());
  links.refused.resize(links.composites.size());

  // Reserves memory now, so that no memory is allocated when a body is gripped, unless that body carries
  // another one.
  constexpr std::size_t k_most_pieces = 64;  // larger shapes allocate when they are needed
  const BodyType* cargo = most_intricate_cargo(types_);
  for (std::size_t c = 0; c < links.composites.size(); ++c) {
    const BodyType& t = type(Row(links.composites[c]));
    Room room;
    room.add(t.obstacle, 1);
    const auto carry = [](const BodyType::Device& device) { return device.kind->carries; };
    if (cargo) room.add(cargo->obstacle, static_cast<std::size_t>(std::ranges::count_if(t.devices, carry)));
    for (auto* buffers : {&links.shapes, &links.moved, &links.on_the_way})
      (*buffers)[c].reserve(std::min(room.pieces, k_most_pieces), room.corners);
  }
}

std::span<Links::Joint> World::joints(Row row) {
  return {links_.joints.data() + links_.joint_begins[row.index()], type(row).joints.size()};
}
std::span<const Links::Joint> World::joints(Row row) const {
  return {links_.joints.data() + links_.joint_begins[row.index()], type(row).joints.size()};
}
Pose& World::joint_state(Row row, std::size_t joint) {
  return tables_[type(row).joints[joint].table].as<Pose>(slot(row));
}
const Pose& World::joint_state(Row row, std::size_t joint) const {
  return tables_[type(row).joints[joint].table].as<Pose>(slot(row));
}

Mount World::mount(Row row, std::int32_t joint) const {
  const Pose& pose = poses()[row.index()];
  const Mount body(transform(row), pose.z, pose.heading);
  return joint == k_rigid ? body : compose(body, joints(row)[static_cast<std::size_t>(joint)].now);
}

std::optional<BodyId> World::carrier(Row row) const {
  if (!carrier_table_) return {};
  const std::uint32_t id = tables_[*carrier_table_].as<Carried>(row.index()).carrier;
  if (id == 0) return {};
  return BodyId(id - 1);
}

/// Whether the tables of joints and carriers are consistent. Poses must be finite, carriers and the joints
/// that hold their cargo must exist, and no body may carry itself, directly or through others.
bool World::links_hold() const {
  for (const std::uint32_t r : links_.composites)
    for (std::size_t j = 0; j < type(Row(r)).joints.size(); ++j)
      if (!is_finite(joint_state(Row(r), j))) return false;
  if (!carrier_table_) return true;
  const auto carrier_row = [this](std::uint32_t r) {
    const std::uint32_t id = tables_[*carrier_table_].as<Carried>(r).carrier;
    return id == 0 || id > body_rows_.size() ? Row() : body_rows_[id - 1];
  };
  for (std::uint32_t r = 0; r < rows(); ++r) {
    const Carried& link = tables_[*carrier_table_].as<Carried>(r);
    if (link.carrier == 0) continue;
    const Row by = carrier_row(r);
    if (!by.valid() || !type(by).carries || link.joint > type(by).joints.size() || !is_finite(link.pose))
      return false;
  }
  // Finds cycles of carriers: one walk takes two steps towards the root while the other takes one step. They
  // only meet in a cycle.
  for (std::uint32_t r = 0; r < rows(); ++r) {
    Row slow(r);
    for (Row fast(r); fast.valid(); slow = carrier_row(slow.value)) {
      fast = carrier_row(fast.value);
      if (fast.valid()) fast = carrier_row(fast.value);
      if (fast.valid() && fast == slow) return false;
    }
  }
  return true;
}

void World::derive_links() {
  Links& links = links_;
  links.carried = 0;
  links.asked = false;
  if (!links.any()) return;
  std::ranges::fill(links.first_cargo, Links::k_none);
  for (std::uint32_t r = 0; r < rows(); ++r) links.roots[r] = r;
  for (const std::uint32_t r : links.composites)
    rest_joints(Row(r));  // before any shape of a tree is computed
  for (std::uint32_t r = 0; carrier_table_ && r < rows(); ++r) {
    const std::uint32_t id = tables_[*carrier_table_].as<Carried>(r).carrier;
    if (id != 0) link_cargo(r, body_rows_[id - 1].value);
  }
  for (std::uint32_t r = 0; r < rows(); ++r) {
    std::uint32_t root = r;
    while (const auto by = carrier(Row(root))) root = body_rows_[by->index()].value;
    links.roots[r] = root;
  }
}

void World::forget_links() {
  constexpr std::uint32_t k_junk = 0x5a5a5a5a;
  constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
  constexpr Pose k_nowhere{k_nan, k_nan, k_nan, k_nan};
  const Mount nowhere(k_nowhere);
  std::ranges::fill(links_.joints, Links::Joint{nowhere, nowhere, k_nowhere, Links::Goal::asked, true});
  for (auto* buffers : {&links_.shapes, &links_.moved, &links_.on_the_way})
    for (ShapeBuffer& buffer : *buffers) buffer.begin();
  for (auto* list : {&links_.samples, &links_.roots, &links_.first_cargo, &links_.next_cargo})
    std::ranges::fill(*list, k_junk);
  std::ranges::fill(links_.refused, std::uint8_t{1});
  std::ranges::fill(links_.lifts, k_nan);
  links_.carried = k_junk;
  links_.asked = true;
}

/// Sets the joints of a row to "no command to move" (Links::Goal::none), and updates Links::Joint::now.
void World::rest_joints(Row row) {
  for (Links::Joint& joint : joints(row)) joint.state = Links::Goal::none;
  move_to_joints(row);
}

/// Updates Links::Joint::now of a row's joints from their displacements in the state tables.
void World::move_to_joints(Row row) {
  const std::span<Links::Joint> all = joints(row);
  for (std::size_t j = 0; j < all.size(); ++j) {
    const BodyType::Joint& joint = type(row).joints[j];
    const Mount parent = joint.parent == k_rigid ? Mount() : all[static_cast<std::size_t>(joint.parent)].now;
    all[j].now = moved_by(joint, parent, joint_state(row, j));
  }
}

/// Adds row `cargo` to the list of bodies that row `carrier` carries. The list is sorted by id, so that sums
/// over it do not depend on the order in which the bodies were picked up.
void World::link_cargo(std::uint32_t cargo, std::uint32_t carrier) {
  std::uint32_t* at = &links_.first_cargo[carrier];
  while (*at != Links::k_none && row_ids_[*at] < row_ids_[cargo]) at = &links_.next_cargo[*at];
  links_.next_cargo[cargo] = *at;
  *at = cargo;
  ++links_.carried;
}

void World::unlink_cargo(std::uint32_t cargo, std::uint32_t carrier) {
  std::uint32_t* at = &links_.first_cargo[carrier];
  while (*at != cargo) at = &links_.next_cargo[*at];
  *at = links_.next_cargo[cargo];
  --links_.carried;
}

void World::set_root(std::uint32_t row, std::uint32_t root) {
  links_.roots[row] = root;
  for (std::uint32_t c = links_.first_cargo[row]; c != Links::k_none; c = links_.next_cargo[c])
    set_root(c, root);
}

/// Adds to `out` the obstacle pieces of a body and of all bodies that it carries, in the frame of the root.
/// If `then` is false, joints are where they are now. If it is true, they are at Links::Joint::then, and only
/// the pieces that move in this round of resolution are added. Lowers `thinnest` to the width of the thinnest
/// obstacle piece of these bodies, m.
void World::add_tree_body(const TreeBody& body, bool then, ShapeBuffer& out, double& thinnest) const {
  const BodyType& t = type(body.row);
  const std::span<const Links::Joint> all = joints(body.row);
  thinnest = t.obstacle.empty() ? thinnest : std::min(thinnest, t.obstacle.thinnest);
  for (std::size_t p = 0; p < t.obstacle.pieces.size(); ++p) {
    const std::int32_t j = t.obstacle_joints.empty() ? k_rigid : t.obstacle_joints[p];
    if (j == k_rigid) {
      if (!then || body.moves) out.add(t.obstacle.pieces[p], body.place);
      continue;
    }
    const Links::Joint& joint = all[static_cast<std::size_t>(j)];
    if (!then || body.moves || joint.moves)
      out.add(t.obstacle.pieces[p], compose(body.place, then ? joint.then : joint.now));
  }
  for (std::uint32_t c = links_.first_cargo[body.row.index()]; c != Links::k_none; c = links_.next_cargo[c]) {
    const Carried& link = tables_[*carrier_table_].as<Carried>(c);
    TreeBody cargo{Row(c), body.place, body.moves};
    if (link.joint > 0) {
      const Links::Joint& joint = all[link.joint - 1];
      cargo.place = compose(cargo.place, then ? joint.then : joint.now);
      cargo.moves = cargo.moves || joint.moves;
    }
    cargo.place = compose(cargo.place, Mount(link.pose));
    add_tree_body(cargo, then, out, thinnest);
  }
}

/// Updates row_shapes_ and row_radii_ of a row: the obstacle shape and the radius that conflict resolution
/// and queries use. The root of a tree has the shape of its whole tree; a carried body has an empty shape.
void World::reshape(std::uint32_t row) {
  if (!is_there(Row(row))) return update_presence(Row(row));
  const BodyType& t = type(Row(row));
  const std::uint32_t c = links_.composite_of[row];
  const ObstacleShape* shape = &t.obstacle;
  // A body without cargo whose joints are at rest uses the shape of its type, which stays in the CPU caches.
  const auto is_at_rest = [&] {
    for (std::size_t j = 0; j < t.joints.size(); ++j)
      if (!(joint_state(Row(row), j) == Pose{})) return false;
    return links_.first_cargo[row] == Links::k_none;
  };
  if (links_.roots[row] != row) {
    shape = &k_no_shape;
  } else if (c != Links::k_none && !is_at_rest()) {
    double thinnest = std::numeric_limits<double>::infinity();
    links_.shapes[c].begin();
    add_tree_body({Row(row), Mount()}, false, links_.shapes[c], thinnest);
    links_.shapes[c].finish(thinnest);
    shape = &links_.shapes[c].shape();
  }
  row_shapes_[row] = shape;
  double shift = 0;
  if (c != Links::k_none)
    for (const Links::Joint& joint : joints(Row(row)))
      shift = std::max(shift, joint.now.transform.position.norm());
  // An upper bound for all points of the body: Joint::now rotates points about the body's origin, which keeps
  // their distance from it, and then shifts them.
  row_radii_[row] = std::max(t.radius + shift, shape->radius);
}

/// Computes the outlines of a row with joints, in the world frame. `transform` is the pose of its body.
void World::update_jointed_outlines(Row row, const BodyType& type, const Transform& transform) {
  Vec2* out = outlines_.data() + outline_begins_[row.index()];
  const std::span<const Links::Joint> all = joints(row);
  const auto transform_outline = [&](const RayOutline& outline) {
    Transform at = transform;
    if (outline.joint != k_rigid)
      at = compose(Mount(transform, 0, 0), all[static_cast<std::size_t>(outline.joint)].now).transform;
    for (std::uint32_t v = 0; v < outline.count; ++v) *out++ = at * type.outline_vertices[outline.first + v];
  };
  for (const RayOutline& outline : type.outlines) transform_outline(outline);
  for (const RayOutline& outline : type.hidden_outlines) transform_outline(outline);
}

// ---- Resolution of joint motions

template <class Work>
void World::for_roots(Work&& work) {
  const std::size_t count = links_.composites.size();
  parallel_.for_each((count + k_batch - 1) / k_batch, [&](std::size_t b) {
    for (std::size_t c = b * k_batch; c < std::min(count, (b + 1) * k_batch); ++c)
      if (const std::uint32_t r = links_.composites[c]; links_.roots[r] == r) work(c, r);
  });
}

/// Resolves the motions of joints: carries them out or blocks them. A round moves the joints of one device
/// per body; parent joints move in earlier rounds than their children. The moving pieces of a tree must be
/// free of the static scene. They must also be free of every other tree at its present pose, both with the
/// joints of that tree where they are now and with these joints at their goals. The order in which two trees
/// are tested therefore does not matter, and they do not come to overlap, whether one of them moves or both.
/// A static piece or another tree that already overlapped the tree before the round does not block it.
void World::resolve_joints() {
  Links& links = links_;
  if (!links.asked.load(std::memory_order_relaxed)) return;
  // The index still contains each tree as a circle about its origin before this tick. Since then its origin
  // has moved by at most the longest motion or push, and its radius has grown by at most the joint motions of
  // this tick, including those of this round. Turns of bodies change neither origin nor radius.
  double reach = conflicts_.longest();
  for (std::size_t round = 0; round < links.rounds; ++round) {
    std::atomic<std::uint64_t> longest = 0;  // bits of a double >= 0: they compare as the double does
    for_roots([&](std::size_t c, std::uint32_t r) {
      const auto bits = std::bit_cast<std::uint64_t>(ask_joints(c, Row(r), round));
      std::uint64_t known = longest.load(std::memory_order_relaxed);
      while (known < bits && !longest.compare_exchange_weak(known, bits, std::memory_order_relaxed)) {
      }
    });
    if (longest == 0) continue;
    reach += std::bit_cast<double>(longest.load()) + partition::k_rounding_m;
    for_roots([&](std::size_t c, std::uint32_t r) {
      if (links.samples[c] > 0) links.refused[c] = refuses_joints(c, Row(r), round, reach);
    });
    for_roots([&](std::size_t c, std::uint32_t r) {
      if (links.samples[c] > 0) answer_joints(Row(r), round, links.refused[c] != 0);
    });
  }
}

/// Computes Links::Joint::then for the joints of a body and of all bodies that it carries, at a fraction t (0
/// to 1) of their motions of this round. Returns an upper bound on how far the complete motions (t = 1) move
/// any point, m. The bound is 0 if no joint moves in this round. `radius` must be an upper bound on the
/// distance of any point from the root, m.
double World::aim_joints(const TreeBody& body, std::size_t round, double t, double radius) {
  const BodyType& type = this->type(body.row);
  const std::span<Links::Joint> all = joints(body.row);
  std::size_t first = 0;
  std::size_t last = 0;
  if (round < type.joint_devices.size()) {
    const BodyType::Device& device = type.devices[type.joint_devices[round]];
    first = static_cast<std::size_t>(device.moves);
    last = first + device.kind->joints.size();
  }
  double way = 0;
  for (std::size_t j = 0; j < all.size(); ++j) {
    const BodyType::Joint& joint = type.joints[j];
    const Links::Joint* parent =
        joint.parent == k_rigid ? nullptr : &all[static_cast<std::size_t>(joint.parent)];
    Pose q = joint_state(body.row, j);
    const bool is_asked = first <= j && j < last && all[j].state == Links::Goal::asked;
    all[j].moves = is_asked || (parent && parent->moves);
    if (is_asked) {
      const Pose& to = all[j].goal;
      const Mount axis = compose(compose(body.place, parent ? parent->then : Mount()), joint.at_rest);
      way += Vec2(to.x - q.x, to.y - q.y).norm() + std::abs(to.z - q.z) +
             std::abs(to.heading - q.heading) * (radius + way + axis.transform.position.norm());
      q = t < 1 ? between(q, to, t) : to;
    }
    all[j].then = moved_by(joint, parent ? parent->then : Mount(), q);
  }
  for (std::uint32_t c = links_.first_cargo[body.row.index()]; c != Links::k_none; c = links_.next_cargo[c]) {
    const Carried& link = tables_[*carrier_table_].as<Carried>(c);
    Mount place = body.place;
    if (link.joint > 0) place = compose(place, all[link.joint - 1].now);
    way += aim_joints({Row(c), compose(place, Mount(link.pose))}, round, t, radius + way);
  }
  return way;
}

/// Computes the shape of the moving pieces of a tree at their goals, and the number of samples at which their
/// motion is tested. `c` is the index of the root in Links::composites. Returns an upper bound on how far any
/// point moves, m; 0 if no joint of the tree moves in this round.
double World::ask_joints(std::size_t c, Row root, std::size_t round) {
  links_.samples[c] = 0;
  links_.refused[c] = 0;
  const auto is_asked = [](const Links::Joint& joint) { return joint.state == Links::Goal::asked; };
  const bool carries = links_.first_cargo[root.index()] != Links::k_none;
  if (!carries && std::ranges::none_of(joints(root), is_asked)) return 0;
  const double way = aim_joints({root, Mount()}, round, 1, row_shapes_[root.index()]->radius);
  if (way == 0) return 0;
  double thinnest = std::numeric_limits<double>::infinity();
  ShapeBuffer& moved = links_.moved[c];
  moved.begin();
  add_tree_body({root, Mount()}, true, moved, thinnest);
  moved.finish(thinnest);
  // The same sampling as for motions of bodies: see Conflicts.
  constexpr double k_most = 1e6;
  const double samples = moved.shape().empty() ? 1 : std::min(k_most, std::ceil(way / (0.25 * thinnest)));
  links_.samples[c] = std::max(1u, static_cast<std::uint32_t>(samples));
  return way;
}

bool World::refuses_joints(std::size_t c, Row root, std::size_t round, double reach) {
  ShapeBuffer& on_the_way = links_.on_the_way[c];
  const Transform& at = transform(root);
  const double z = poses()[root.index()].z;
  const double radius = row_shapes_[root.index()]->radius;
  const std::uint32_t n = links_.samples[c];
  const PlacedShape before(*row_shapes_[root.index()], at, z);
  for (std::uint32_t k = 1; k <= n; ++k) {
    const ShapeBuffer* moved = &links_.moved[c];
    if (k < n) {
      double thinnest = std::numeric_limits<double>::infinity();
      aim_joints({root, Mount()}, round, static_cast<double>(k) / n, radius);
      on_the_way.begin();
      add_tree_body({root, Mount()}, true, on_the_way, thinnest);
      on_the_way.finish(thinnest);
      moved = &on_the_way;
    }
    if (moved->shape().empty()) return false;
    const PlacedShape after(moved->shape(), at, z);
    if (scene_.has_obstacles() &&
        scene_.crossed(after, [&](std::uint32_t solid) { return scene_.overlaps_solid(solid, before); }) >= 0)
      return true;
    if (others_refuse(root, before, after, reach)) return true;
  }
  return false;
}

/// Whether the moving pieces of a tree, as placed in `after`, overlap another tree that the whole tree, as
/// placed in `before`, does not overlap. `reach`: bound on how far a tree lies outside its circle in the
/// index, m.
bool World::others_refuse(Row root, const PlacedShape& before, const PlacedShape& after, double reach) const {
  const auto meets = [&](Row other, const PlacedShape& mine, const ObstacleShape& shape) {
    const Transform& at = transform(other);
    if (!partition::in_reach(mine.position(), mine.shape().radius, at.position, shape.radius)) return false;
    const PlacedShape theirs(shape, at, poses()[other.index()].z);
    return body(root) < body(other) ? overlap(mine, theirs) : overlap(theirs, mine);
  };
  bool refuses = false;
  // Visits all bodies of the cells in reach and tests their present poses, because the index still contains
  // the poses before this tick.
  index_.for_each_run(
      Box::around(after.position(), after.shape().radius + reach),
      [&](std::span<const partition::BodyCircle> run) {
        for (const partition::BodyCircle& circle : run) {
          if (refuses) return;
          const Row other(links_.roots[circle.row]);
          const ObstacleShape& shape = *row_shapes_[other.index()];
          if (other == root || shape.empty()) continue;
          const std::uint32_t c = links_.composite_of[other.index()];
          const bool moves = c != Links::k_none && links_.samples[c] > 0;
          refuses = (meets(other, after, shape) || (moves && meets(other, after, links_.moved[c].shape()))) &&
                    !meets(other, before, shape);
        }
      });
  return refuses;
}

/// Ends a round of resolution for a body and for all bodies that it carries. If `refused` is false, their
/// joints move to their goals. If it is true, the joints stay, and are marked as blocked.
void World::answer_joints(Row row, std::size_t round, bool refused) {
  const BodyType& type = this->type(row);
  if (round < type.joint_devices.size()) {
    const BodyType::Device& device = type.devices[type.joint_devices[round]];
    const std::span<Links::Joint> all = joints(row);
    for (std::size_t n = 0; n < device.kind->joints.size(); ++n) {
      const std::size_t j = static_cast<std::size_t>(device.moves) + n;
      if (all[j].state != Links::Goal::asked) continue;
      all[j].state = refused ? Links::Goal::refused : Links::Goal::moved;
      if (!refused) joint_state(row, j) = all[j].goal;
    }
  }
  if (!refused) {
    move_to_joints(row);
    // carry() updates the outlines of carried bodies.
    if (links_.roots[row.index()] == row.value) update_outlines(row, type, transform(row));
  }
  for (std::uint32_t c = links_.first_cargo[row.index()]; c != Links::k_none; c = links_.next_cargo[c])
    answer_joints(Row(c), round, refused);
  if (!refused) reshape(row.value);
}

// ---- Cargo

/// Moves carried bodies with their carriers.
void World::carry() {
  if (links_.carried == 0) return;
  for_roots([&](std::size_t, std::uint32_t r) { carry_cargo_of(Row(r)); });
}

void World::carry_cargo_of(Row carrier) {
  for (std::uint32_t c = links_.first_cargo[carrier.index()]; c != Links::k_none; c = links_.next_cargo[c]) {
    const Carried& link = tables_[*carrier_table_].as<Carried>(c);
    const Mount hook = mount(carrier, static_cast<std::int32_t>(link.joint) - 1);
    const Pose pose = compose(hook, Mount(link.pose)).pose();
    as<Pose>(k_pose)[c] = pose;
    update_outlines(Row(c), type(Row(c)), Transform(pose));
    carry_cargo_of(Row(c));
  }
}

bool World::attach(Row cargo, Row carrier, std::int32_t joint) {
  if (!type(carrier).carries || this->carrier(cargo) || links_.roots[carrier.index()] == cargo.value)
    return false;
  const Mount hook = mount(carrier, joint);
  Carried& link = tables_[*carrier_table_].as<Carried>(cargo.index());
  link.carrier = body(carrier).value + 1;
  link.joint = static_cast<std::uint32_t>(joint + 1);
  link.pose = compose(inverse(hook), mount(cargo, k_rigid)).pose();
  link_cargo(cargo.value, carrier.value);
  set_root(cargo.value, links_.roots[carrier.index()]);
  reshape(cargo.value);
  reshape(links_.roots[carrier.index()]);
  return true;
}

void World::release(Row cargo) {
  const std::optional<BodyId> by = carrier(cargo);
  if (!by) return;
  const Row carrier = row(*by);
  tables_[*carrier_table_].as<Carried>(cargo.index()) = {};
  unlink_cargo(cargo.value, carrier.value);
  set_root(cargo.value, cargo.value);
  reshape(cargo.value);
  reshape(links_.roots[carrier.index()]);
}

void World::redraw_ray_grid() {
  std::size_t o = 0;
  for (std::uint32_t r = 0; !links_.lifts.empty() && r < rows(); ++r)
    for (const RayOutline& outline : type(Row(r)).outlines)
      if (outline.count > 0) links_.lifts[o++] = lift(Row(r), outline.joint);
  partition::RayGrid::Linked linked{.lifts = links_.lifts, .groups = {}, .absent = {}};
  if (links_.carried > 0) linked.groups = links_.roots;
  if (absent_ > 0) linked.absent = not_drawn_;
  ray_grid_->redraw(outlines_, poses(), parallel_, linked);
}

// ---- Joints in DeviceBatch

Mount DeviceBatch::mount(std::size_t i) const {
  return world.mount(rows[i], world.type(rows[i]).devices[device].joint);
}

namespace {
std::size_t joint_index(const DeviceBatch& batch, std::size_t i, std::size_t n) {
  return static_cast<std::size_t>(batch.world.type(batch.rows[i]).devices[batch.device].moves) + n;
}
}  // namespace

const Pose& DeviceBatch::joint(std::size_t i, std::size_t n) const {
  return world.joint_state(rows[i], joint_index(*this, i, n));
}
void DeviceBatch::move_joint(std::size_t i, std::size_t n, const Pose& to) const {
  if (!is_finite(to))
    throw StepError(fmt::format("tick {}: the goal of a joint of \"{}\" is not a finite number", world.tick(),
                                world.spec().name(body(i))));
  Links::Joint& joint = links.joints[links.joint_begins[rows[i].index()] + joint_index(*this, i, n)];
  joint.goal = {to.x + 0.0, to.y + 0.0, to.z + 0.0, to.heading + 0.0};
  joint.state = Links::Goal::asked;
  if (!links.asked.load(std::memory_order_relaxed)) links.asked.store(true, std::memory_order_relaxed);
}
bool DeviceBatch::asked_joint(std::size_t i, std::size_t n) const {
  return links.joints[links.joint_begins[rows[i].index()] + joint_index(*this, i, n)].state !=
         Links::Goal::none;
}
bool DeviceBatch::moved_joint(std::size_t i, std::size_t n) const {
  return links.joints[links.joint_begins[rows[i].index()] + joint_index(*this, i, n)].state ==
         Links::Goal::moved;
}

}  // namespace troupe::engine
