#include "engine/links/links.hpp"

#include "base/atomic_extremes.hpp"
#include "base/capacity.hpp"
#include "engine/conflicts/conflict_resolver.hpp"
#include "engine/kinds/finite.hpp"
#include "engine/kinds/step_error.hpp"
#include "engine/links/tree_body.hpp"
#include "partition/placed_shape.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace troupe::engine {
namespace {

using partition::ObstacleShape;

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

}  // namespace

void Links::build() {
  const bool any = std::ranges::any_of(state_.types, [](const BodyType& t) { return t.is_composite(); });
  if (!any) return;
  resize_with_capacity(state_.joint_begins, state_.row_count());
  for (auto* list : {&composite_of_, &state_.roots, &first_cargo_, &next_cargo_}) {
    resize_with_capacity(*list, state_.row_count());
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
  change_capacity(composites_, composites_.size());
  resize_with_capacity(joints_, joints);
  resize_with_capacity(state_.joint_mounts, joints);
  for (auto* buffers : {&shapes_, &moved_, &on_the_way_, &before_})
    resize_with_capacity(*buffers, composites_.size());
  resize_with_capacity(samples_, composites_.size());
  resize_with_capacity(blocked_, composites_.size());
  resize_with_capacity(blockers_, composites_.size());
  near_.resize(std::max(near_.size(), (composites_.size() + k_trees_per_task - 1) / k_trees_per_task));
  for (std::vector<std::uint32_t>& list : near_) list.reserve(k_near_capacity);

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

double Links::farthest_in_trees() const {
  double most = 0;
  if (state_.now.carried == 0) return most;
  for (std::uint32_t r = 0; r < state_.row_count(); ++r)
    if (state_.roots[r] == r && first_cargo(Row(r)) != k_none) most = std::max(most, farthest(Row(r)));
  return most;
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
