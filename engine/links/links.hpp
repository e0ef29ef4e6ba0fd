#pragma once

#include "base/ids.hpp"
#include "engine/kinds/mount.hpp"
#include "engine/links/shape_buffer.hpp"
#include "engine/state/world_state.hpp"
#include "partition/parallel.hpp"
#include "partition/placed_shape.hpp"

#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace troupe::engine {

/// The joints of bodies, and the *trees* of bodies that carry one another. A tree consists of a root, which
/// is a body that is not carried, and of all bodies that the root carries, directly or through others. This
/// class is a part of World. It writes the state tables (components) `joint/...` and `carrier`, and the poses
/// of carried bodies.
///
/// A row is the index of a body in the state tables, and a tick is a time step. A device is equipment of a
/// body, such as a gripper. A joint is a part that a device moves. Its rest pose is its pose in the
/// definition of the body type. A body is *composite* if it has joints or can carry other bodies. If no body
/// with a row is composite, any() is false, and functions that take a row or a joint must not be called.
///
/// World resolves conflicts of motions, so that bodies do not overlap. For this purpose, a root has the shape
/// of its whole tree, in the frame of the root, and a carried body has an empty shape.
class Links {
 public:
  static constexpr std::uint32_t k_none = ~0u;  ///< no row
  /// Largest number of bodies that carry a body, directly or through others. Functions that visit the bodies
  /// of a tree call themselves for each carried body, so a longer chain could exhaust the stack.
  static constexpr std::size_t k_most_carriers = 1000;
  /// State of the motion of a joint to its goal in this tick.
  enum class Goal : std::uint8_t {
    none,     ///< ask() was not called for the joint
    asked,    ///< ask() was called, and the motion is not yet resolved
    moved,    ///< the joint is at its goal, possibly because it already was there
    blocked,  ///< the motion was blocked: the joint is at its old pose
  };

  /// The arguments must outlive the object.
  Links(WorldState& state, partition::Parallel& parallel) : state_(state), parallel_(parallel) {}
  Links(const Links&) = delete;
  Links& operator=(const Links&) = delete;

  /// Allocates memory for the data of this class. Call this after the rows of the state were made, and again
  /// after bodies have changed their rows. Then call derive(), and reshape() for all rows: they compute the
  /// data.
  void build();
  /// Computes all data that this class derives from the state tables, except the shapes of trees, which
  /// reshape() computes.
  void derive();
  /// Computes from the component `carrier` which bodies carry which, and the roots of all trees. derive()
  /// includes this step. After a separate call, call reshape() for all bodies of the trees that have changed.
  void link_all();
  /// Overwrites all derived data with junk. World::forget() calls this to test that the data can be computed
  /// again from the state.
  void forget();
  /// Returns whether the tables of joints and carriers are consistent. Reads only the state tables. The
  /// tables are consistent if all of these hold:
  /// - All poses are finite.
  /// - Each carrier exists, and its type can carry bodies.
  /// - Each joint that holds a body exists.
  /// - No body carries itself, and at most k_most_carriers bodies carry a body, directly or through others.
  bool hold() const;

  /// Whether any body with a row is composite. Unborn bodies (not yet in the world) and dead bodies count.
  bool any() const { return !composites_.empty(); }
  std::span<const std::uint32_t> composites() const { return composites_; }  ///< rows of composite bodies
  /// Row of a body that the row's body carries directly: the one with the lowest id. k_none if it carries
  /// none.
  std::uint32_t first_cargo(Row row) const { return first_cargo_[row.index()]; }
  /// Appends the rows of all bodies that the row's body carries, directly or through others.
  void add_cargo(Row row, std::vector<Row>& rows) const;

  /// Upper bound on the distance from the origin of a body to any point of the body or of the bodies that it
  /// carries, directly or through others, m. The bound holds for all poses of the joints. It does not hold if
  /// a drive device (DeviceKind::drives) moves joints of these bodies, because such joints move without a
  /// limit.
  double farthest(Row row) const;
  /// Upper bound on farthest() of the roots of all trees of two or more bodies; 0 if there are no such trees.
  double farthest_in_trees() const;
  /// Upper bound on how far the joints of a body of this type can move any point of the body away from the
  /// body's origin, compared with the joints at rest, m. The bound does not hold if a drive device
  /// (DeviceKind::drives) moves joints of the type, because such joints move without a limit.
  static double farthest_shift(const BodyType& type);

  /// Sets the goals of a row's joints to Goal::none. Updates WorldState::joint_mounts from the poses of the
  /// joints. Does not change the poses.
  void rest_joints(Row row);
  /// Updates the obstacle shape and the radius of a row (WorldState::shapes, WorldState::radii). The root of
  /// a tree gets the shape of its whole tree, and a carried body an empty shape. An unborn or dead body gets
  /// an empty shape and a negative radius.
  void reshape(std::uint32_t row);
  /// Attaches a body (row `cargo`), at its present pose, to another body (row `carrier`). If `joint` is
  /// k_rigid, the cargo is attached to the carrier itself, otherwise to the carrier's joint with this index.
  /// Returns false and changes nothing in each of these cases:
  /// - The cargo is already carried.
  /// - The cargo is the carrier itself, or carries it directly or through others.
  /// - The type of the carrier cannot carry bodies.
  /// - More than k_most_carriers bodies would carry a body, directly or through others.
  bool attach(Row cargo, Row carrier, std::int32_t joint);
  /// Detaches the body of the row `cargo` from its carrier. Does nothing if no body carries it. The pose of
  /// the detached body does not change.
  void release(Row cargo);

  // ---- in a tick
  /// Sets the goal of a joint in this tick: a pose relative to the joint's rest pose, m and rad. All numbers
  /// must be finite. A second call in the same tick replaces the goal. Thread-safe for different rows.
  void ask(Row row, std::size_t joint, const Pose& to);
  /// The goal that ask() has set for a joint in this tick; std::nullopt if there is none. Call this before
  /// resolve_joints().
  std::optional<Pose> asked(Row row, std::size_t joint) const;
  /// Arguments of a call of ask().
  struct AskedGoal {
    std::uint32_t row;    ///< row of the body
    std::uint32_t joint;  ///< index of the joint in BodyType::joints
    Pose goal;            ///< goal of the joint relative to its rest pose, m and rad
  };
  /// Returns the goals that ask() has set for joints of these rows in this tick, one per joint. Call this
  /// before resolve_joints().
  std::vector<AskedGoal> asked_goals(RowRange rows) const;
  /// The connection to the other ranks, if several ranks (threads or processes) compute a world together.
  /// Each rank resolves the motions of the joints of its own rows. A *ghost* is a copy, on this rank, of a
  /// tree of another rank. This rank has a ghost of each tree that could block one of its own trees or be
  /// blocked by one of them.
  class Border {
   public:
    virtual ~Border() = default;
    /// Called in each round of resolve_joints(), after this rank has tested its own trees. Sends the results
    /// (is_blocked()) to the ranks that have ghosts of these trees. Then receives the results for the ghosts
    /// on this rank, and calls block() for each ghost whose motion is blocked.
    virtual void exchange_blocked(Links& links) = 0;
  };
  /// For a Border: whether joints of the tree with this root have to move in the present round of
  /// resolve_joints(). False for carried bodies.
  bool moves_joints(Row root) const;
  /// For a Border: whether the motion of the joints of the tree with this root is blocked in the present
  /// round of resolve_joints().
  bool is_blocked(Row root) const { return blocked_[composite_of_[root.index()]] != 0; }
  /// For a Border: marks the motion of the joints of the tree with this root as blocked in the present round
  /// of resolve_joints(). moves_joints() must be true for the root.
  void block(Row root) { blocked_[composite_of_[root.index()]] = 1; }

  /// State of the motion of a joint in this tick.
  Goal goal(Row row, std::size_t joint) const { return joints(row)[joint].state; }
  /// Tests the joint motions that ask() requested, and carries out those that neither the static scene (all
  /// bodies that never move) nor another tree blocks. The motions are tested in rounds. Each round tests the
  /// joints of at most one device per body: round k, counted from 0, those of the device
  /// BodyType::joint_devices[k]. In a round, all tested joints of a tree reach their goals, or, if one of
  /// them is blocked, none of them moves.
  ///
  /// longest_motion: upper bound on the distance that any body has moved since the spatial index was built, m
  /// border: the connection to the other ranks, if the rows include ghosts; otherwise null
  void resolve_joints(double longest_motion, Border* border);
  /// Returns whether ask() was called since the last call of take_asked() or of derive().
  bool has_asked() const { return asked_.load(std::memory_order_relaxed); }
  /// Makes has_asked() true, for example because ask() was called on another rank.
  void raise_asked() { asked_.store(true, std::memory_order_relaxed); }
  /// Returns the result of has_asked(), which is then false.
  bool take_asked() { return asked_.exchange(false, std::memory_order_relaxed); }
  void clear_goals(Row row);  ///< sets the goals of a row's joints to Goal::none
  void carry();  ///< sets the poses and outlines of all carried bodies from those of their carriers

 private:
  /// A joint of a body during a tick.
  struct Joint {
    /// Transform, in the body frame, that moves a point mounted on this joint. It maps the point's position
    /// with all joints at rest to its position with this joint at its goal or, during a test, at the tested
    /// pose.
    Mount then;
    Pose goal;                ///< goal in this tick, relative to rest
    Goal state = Goal::none;  ///< state of the motion in this tick
    bool moves = false;       ///< whether the joint moves in this round of resolution
  };
  struct TreeBody;
  /// Upper bounds on the path of any point of a tree during the joint motions of one round, m.
  struct Way {
    double total;  ///< the length of the whole path of the point
    double rise;   ///< the vertical part of that length
  };

  std::span<Joint> joints(Row row);
  std::span<const Joint> joints(Row row) const;
  void move_to_joints(Row row);
  void link_cargo(std::uint32_t cargo, std::uint32_t carrier);
  void unlink_cargo(std::uint32_t cargo, std::uint32_t carrier);
  void set_root(std::uint32_t row, std::uint32_t root);
  std::size_t longest_chain(std::uint32_t row) const;
  void add_tree_body(const TreeBody& body, bool then, ShapeBuffer& out, double& thinnest) const;
  Way aim_joints(const TreeBody& body, std::size_t round, double t, double radius);
  double ask_joints(std::size_t c, Row root, std::size_t round);
  double shape_moving(Row root, ShapeBuffer& shape) const;
  bool joints_blocked(std::size_t c, Row root, std::size_t round, double reach);
  BodyId joint_blocker(Row root, std::span<const std::uint32_t> others, const partition::PlacedShape& before,
                       const partition::PlacedShape& after) const;
  std::span<const std::uint32_t> roots_near(std::size_t c, Row root, double reach);
  template <class Visit>
  bool any_near(Row root, const partition::PlacedShape& mine, std::span<const std::uint32_t> others,
                Visit&& visit) const;
  bool meets_others(Row root, std::span<const std::uint32_t> others,
                    const partition::PlacedShape& mine) const;
  bool blocked_by_others(Row root, std::span<const std::uint32_t> others,
                         const partition::PlacedShape& before, const partition::PlacedShape& after) const;
  void mark_joints(Row row, std::size_t round, Goal state);
  void answer_joints(Row row, std::size_t round, bool blocked, BodyId by);
  void carry_cargo_of(Row carrier);
  template <class Work>
  void for_roots(Work&& work);

  WorldState& state_;
  partition::Parallel& parallel_;

  std::vector<Joint> joints_;        // joints of all rows, at WorldState::joint_begins
  std::atomic<bool> asked_ = false;  // whether ask() has set a goal for any joint in this tick
  // Number of rounds of joint resolution per tick: the largest number of devices that move joints of one
  // body of the world, whose row may be elsewhere. In each round, the joints of at most one device per body
  // move.
  std::size_t rounds_ = 0;

  std::vector<std::uint32_t> composites_;    // rows of composite bodies
  std::vector<std::uint32_t> composite_of_;  // one per row: its index in the lists below; k_none: none
  // One entry per composite body.
  std::vector<ShapeBuffer> shapes_;      // shape of the tree whose root is the body, in the body's frame
  std::vector<ShapeBuffer> moved_;       // pieces of the tree that move in this round, at their goals
  std::vector<ShapeBuffer> on_the_way_;  // the same pieces, at the pose that is tested now
  std::vector<ShapeBuffer> before_;      // the same pieces, at the pose that was tested before
  std::vector<std::uint32_t> samples_;   // number of poses to test in this round; 0: no motion
  std::vector<std::uint8_t> blocked_;    // 1 if the motion of this round is blocked
  std::vector<BodyId> blockers_;         // what blocks it, if WorldState::has_contacts()
  // One per task of for_roots(): the roots of the trees near the tree that is tested now.
  std::vector<std::vector<std::uint32_t>> near_;

  // One per row; empty if there are no composites.
  // Row of the lowest id among the bodies that it carries directly; k_none: none.
  std::vector<std::uint32_t> first_cargo_;
  std::vector<std::uint32_t> next_cargo_;  // row of the next higher id on the same carrier; k_none: none
};

}  // namespace troupe::engine
