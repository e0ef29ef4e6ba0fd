#include "models/devices/gripper.hpp"

#include "engine/kinds/make_device_kind.hpp"
#include "engine/links/effect_views.hpp"
#include "engine/links/shape_buffer.hpp"
#include "engine/observing/frame.hpp"
#include "engine/observing/lint_view.hpp"
#include "partition/placed_shape.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace troupe::models {
namespace {

using engine::DeviceBatch;
using engine::DeviceKind;
using engine::Mount;
using engine::SensingView;

constexpr double k_rate = 0.5;  // 1/s: 2 s from end to end
// Distances of the inner and the outer beam behind the tips of the paddles, as fractions of size.x.
constexpr double k_beams[] = {0.495, 0.165};
enum Verb : std::uint32_t { k_grip, k_release };
enum JointIndex : std::size_t { k_left, k_right };

enum class Paddles : std::uint8_t { open, closed };
constexpr std::array<std::string_view, 2> names_of(Paddles) { return {"open", "closed"}; }
enum class Lift : std::uint8_t { down, up };
constexpr std::array<std::string_view, 2> names_of(Lift) { return {"down", "up"}; }

struct Gripper {
  struct Params {
    Eigen::Vector3d size{0.2, 0.3, 0.2};
    Eigen::Vector3d paddle_size{0.66, 0.1, 0.4};
    Paddles paddles = Paddles::open;
    Lift lift = Lift::down;
    bool autosnatch = false;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      d.member<&Params::size>("size", engine::Unit::meters, above(0), at_most(1000),
                              "size of the base and the open paddles together, [x, y, z]");
      d.member<&Params::paddle_size>("paddle_size", above(0), at_most(0.999),
                                     "size of each paddle as a fraction of `size`, [x, y, z]; y must be "
                                     "below 0.5, or two paddles do not fit");
      d.member<&Params::paddles>("paddles", "state of the paddles at the start");
      d.member<&Params::lift>("lift", "state of the lift at the start");
      d.member<&Params::autosnatch>("autosnatch",
                                    "true: the gripper ignores commands, closes while a body breaks one of "
                                    "the light beams between its paddles, and opens otherwise");
    }
  };
  using State = GripperState;
  using Command = GripperCommand;
  static constexpr std::array joints{std::string_view("left"), std::string_view("right")};
  static constexpr bool carries = true;
  static constexpr engine::ApplyScope scope = engine::ApplyScope::trees;
  static constexpr engine::FrameLayer layer = engine::FrameLayer::grips;

  Params params;
  Mount place = {};  // pose of the gripper in the frame of its body, or of the joint that it is mounted on

  double base_front() const { return -size().x() / 2 + (1 - paddle().x()) * size().x(); }
  double thickness() const { return paddle().y() * size().y(); }
  double height() const { return paddle().z() * size().z(); }
  /// Distance that a paddle moves from open to closed, m.
  double travel() const { return size().y() / 2 - thickness(); }
  /// Distance that the lift moves from down to up, m.
  double rise() const { return size().z() - height(); }
  /// y of the inner face of the left paddle, m, at a closing position from 0 to 1.
  double face(double position) const { return (1 - position) * travel(); }
  Pose left(double position, double lift) const { return {0, -position * travel(), lift * rise(), 0}; }
  Pose right(double position, double lift) const { return {0, position * travel(), lift * rise(), 0}; }
  const Eigen::Vector3d& size() const { return params.size; }
  const Eigen::Vector3d& paddle() const { return params.paddle_size; }  // fractions of size()
  bool starts_closed() const { return params.paddles == Paddles::closed; }
  bool starts_up() const { return params.lift == Lift::up; }

  static std::vector<DeviceKind::Fixture> body(const Params& params);
  static DeviceKind::Prepared prepare(const Params& params, const Pose& pose_body_gripper);
  Result<> bind_part(const engine::TypeSpec&, std::uint32_t) const;
  void start(State& row) const;
  void act(const DeviceBatch& batch) const;
  void joints_moved(const DeviceBatch& batch) const;
  void apply(engine::Gripping gripping, const engine::Effect& effect) const;
  void draw(const engine::DeviceView& view, engine::Frame& frame) const;
  void lint(const engine::LintView& view) const;
};

Solid block(double x0, double x1, double y0, double y1, double height) {
  return {{{Vec2(x0, y0), Vec2(x1, y0), Vec2(x1, y1), Vec2(x0, y1)}}, {0, height}};
}

/// The solids of the base and the two paddles, with the paddles open and down. Each solid comes with the
/// index of the joint that moves it: -1 for the base, k_left and k_right for the paddles.
std::vector<DeviceKind::Fixture> Gripper::body(const Params& params) {
  const Gripper g{params};
  const double half_x = g.size().x() / 2;
  const double half_y = g.size().y() / 2;
  return {{block(-half_x, g.base_front(), -half_y, half_y, g.size().z()), -1},
          {block(g.base_front(), half_x, half_y - g.thickness(), half_y, g.height()), k_left},
          {block(g.base_front(), half_x, -half_y, -half_y + g.thickness(), g.height()), k_right}};
}

// ---- sensing

/// The parts of a body that grippers can grip, placed in the world, with its joints where they are now. The
/// result is valid until the next call on the same thread.
partition::PlacedShape placed_grip(const SensingView& view, Row row) {
  const engine::BodyType& type = view.type(row);
  const Transform& at = view.transform(row);
  if (type.grip_joints.empty()) return {type.grip, at, view.poses()[row.index()].z};
  thread_local engine::ShapeBuffer moved;  // thread_local, so that its memory is reused
  moved.begin();
  for (std::size_t p = 0; p < type.grip.pieces.size(); ++p)
    moved.add(type.grip.pieces[p], view.mount(row, type.grip_joints[p]));
  moved.finish(type.grip.thinnest);
  return {moved.shape(), Transform(), 0};
}

/// The paddles of one gripper at one instant. Tests which bodies break its beams, touch its paddles or fit
/// between them.
class Hand {
 public:
  Hand(const SensingView& view, const Gripper& gripper, const GripperState& state, Row row,
       const Mount& frame)
      : view_(view),
        gripper_(gripper),
        state_(state),
        row_(row),
        frame_(frame),
        z_(frame.z + state.lift_position * gripper.rise()) {}

  /// Calls visit(row, shape) for each other body that has gripper_return and comes near enough to the gripper
  /// to touch it. `shape` is the outline of the body at its present pose, with its joints where they are now.
  template <class Visit>
  void for_each_near(Visit&& visit) const {
    const double reach = gripper_.size().head<2>().norm() / 2;
    view_.index().for_each_near(
        Box::around(frame_.transform.position, reach), [&](const partition::BodyCircle& circle) {
          const Row other(circle.row);
          const engine::BodyType& type = view_.type(other);
          if (other == row_ || type.grip.empty()) return;
          const double radius = type.grip_joints.empty() ? type.grip.radius : view_.radius(other);
          const Vec2& position = view_.transform(other).position;
          if (!partition::in_reach(frame_.transform.position, reach, position, radius)) return;
          visit(other, placed_grip(view_, other));
        });
  }

  bool breaks_beam(const partition::PlacedShape& shape, double behind_tips) const {
    const double x = gripper_.size().x() / 2 - behind_tips * gripper_.size().x();
    const double y = gripper_.face(state_.paddle_position);
    const Vec2 left = frame_.transform * Vec2(x, y);
    const Vec2 right = frame_.transform * Vec2(x, -y);
    return shape.any_piece([&](const ConvexPrism& piece, const auto& polygon) {
      return piece.z.shifted(shape.z()).contains(z_) && partition::segment_overlap(left, right, polygon);
    });
  }

  /// Whether the inner face of a paddle would touch the shape if the paddles closed from their present
  /// position to the position `to` (from 0, open, to 1, closed). side: 1 for the left paddle, -1 for the
  /// right.
  bool touches(const partition::PlacedShape& shape, double side, double to) const {
    const double from_y = side * gripper_.face(state_.paddle_position);
    const double to_y = side * gripper_.face(to);
    if (from_y == to_y) return false;  // closed paddles sweep no area
    const double x0 = gripper_.base_front();
    const double x1 = gripper_.size().x() / 2;
    std::array<Vec2, 4> swept{Vec2(x0, std::min(from_y, to_y)), Vec2(x1, std::min(from_y, to_y)),
                              Vec2(x1, std::max(from_y, to_y)), Vec2(x0, std::max(from_y, to_y))};
    for (Vec2& corner : swept) corner = frame_.transform * corner;
    const ZInterval heights{z_, z_ + gripper_.height()};
    return shape.any_piece([&](const ConvexPrism& piece, const auto& polygon) {
      if (!piece.z.shifted(shape.z()).overlaps(heights)) return false;
      return partition::convex_overlap(swept, polygon);
    });
  }

  /// Whether the shape fits between the open paddles.
  bool fits(const partition::PlacedShape& shape) const {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    const Transform back = engine::inverse(frame_).transform;
    shape.any_piece([&](const ConvexPrism&, const auto& polygon) {
      for (std::size_t k = 0; k < polygon.size(); ++k) {
        const double y = (back * polygon[k]).y();
        low = std::min(low, y);
        high = std::max(high, y);
      }
      return false;
    });
    return high - low <= 2 * gripper_.travel();
  }

 private:
  const SensingView& view_;
  const Gripper& gripper_;
  const GripperState& state_;
  Row row_;
  const Mount& frame_;
  double z_;  // lower edge of the paddles, m, world frame
};

/// The bodies that closing paddles would hold: for each paddle, the body with the lowest id among those that
/// it touches and that fit between the open paddles. The body at the left paddle takes precedence.
struct Touched {
  BodyId left;
  BodyId right;

  BodyId target() const { return left.valid() ? left : right; }
};

/// Updates the beams and contacts in `state`, and sets `touched` to the bodies that the paddles would hold.
/// closer: the paddle position, 0 to 1, after one more step of closing.
void feel(const SensingView& view, const Hand& hand, double closer, GripperState& state, Touched& touched) {
  state.beam_inner = state.beam_outer = state.contact_left = state.contact_right = 0;
  hand.for_each_near([&](Row row, const partition::PlacedShape& shape) {
    state.beam_inner = state.beam_inner != 0 || hand.breaks_beam(shape, k_beams[0]);
    state.beam_outer = state.beam_outer != 0 || hand.breaks_beam(shape, k_beams[1]);
    const auto touch = [&](double side, std::uint8_t& contact, BodyId& lowest) {
      if (!hand.touches(shape, side, closer)) return;
      contact = 1;
      if (hand.fits(shape) && (!lowest.valid() || view.body(row) < lowest)) lowest = view.body(row);
    };
    touch(1, state.contact_left, touched.left);
    touch(-1, state.contact_right, touched.right);
  });
}

// ---- motion

/// Starts the motion that `order`, a GripperCommand::Order, requests. Does nothing if the paddles or the lift
/// are already at rest at the end of that motion.
void obey(std::uint8_t order, GripperState& state) {
  using S = GripperState;
  if (order == GripperCommand::open && state.paddles != S::is_open) state.paddles = S::opening;
  // Paddles whose held body has died are at rest, but not together.
  const bool is_shut = state.paddles == S::closed && (state.held != 0 || state.paddle_position == 1);
  if (order == GripperCommand::close && !is_shut) state.paddles = S::closing;
  if (order == GripperCommand::up && state.lift != S::is_up) state.lift = S::rising;
  if (order == GripperCommand::down && state.lift != S::is_down) state.lift = S::sinking;
}

/// Whether the gripper of the body `own` no longer carries the body that it held. This happens only if the
/// held body dies, because no other gripper can take a held body, or if a checkpoint has been changed.
bool has_lost(const SensingView& view, BodyId own, const GripperState& state) {
  if (state.held == 0) return false;
  const BodyId held(state.held - 1);
  return view.location(held) != engine::RowLocation::here || view.carrier(view.row(held)) != own;
}

/// The nearest number from 0 to 1; 0 for NaN.
double within_unit(double x) { return x > 0 ? std::min(x, 1.0) : 0; }

/// The position after one step of length `step` towards `end`. If the step would end short of `end` by no
/// more than a rounding error, returns `end`, so that the motion does not take another tick.
double towards(double position, double end, double step) {
  if (std::abs(end - position) <= step * (1 + 1e-9)) return end;
  return position < end ? position + step : position - step;
}

/// Sets the paddles and the lift to their states of rest (closed, is_open, is_up, is_down) if their motion
/// has ended.
void finish(GripperState& state) {
  using S = GripperState;
  if (state.paddles == S::closing && (state.held != 0 || state.paddle_position == 1))
    state.paddles = S::closed;
  if (state.paddles == S::opening && state.paddle_position == 0 && state.held == 0)
    state.paddles = S::is_open;
  if (state.lift == S::rising && state.lift_position == 1) state.lift = S::is_up;
  if (state.lift == S::sinking && state.lift_position == 0) state.lift = S::is_down;
}

void Gripper::act(const DeviceBatch& batch) const {
  using S = GripperState;
  const double step = k_rate * batch.period_s;
  for (std::size_t i = 0; i < batch.rows.size(); ++i) {
    auto& state = batch.state.as<GripperState>(batch.slot(i));
    if (has_lost(batch.view, batch.body(i), state)) state.held = 0;
    // A checkpoint that has been changed may have any positions. Far positions would be tested in many steps.
    state.paddle_position = within_unit(state.paddle_position);
    state.lift_position = within_unit(state.lift_position);
    const Mount frame = compose(batch.mount(i), place);
    const Hand hand(batch.view, *this, state, batch.rows[i], frame);
    Touched touched;
    feel(batch.view, hand, towards(state.paddle_position, 1, step), state, touched);
    state.stalled = 0;
    if (params.autosnatch)
      obey(state.beam_inner != 0 || state.beam_outer != 0 ? GripperCommand::close : GripperCommand::open,
           state);
    else
      obey(batch.commands->as<GripperCommand>(batch.slot(i)).order, state);
    if (state.paddles != S::closing) state.taken = 0;

    double paddle = state.paddle_position;
    if (state.paddles == S::opening && state.held != 0)
      batch.emit(i, 0, k_release, BodyId(state.held - 1));
    else if (state.paddles == S::closing && state.held == 0 && touched.target().valid())
      batch.emit(i, 0, k_grip, touched.target());
    else if (state.paddles == S::closing && state.held == 0)
      paddle = towards(paddle, 1, step);
    else if (state.paddles == S::opening)
      paddle = towards(paddle, 0, step);
    double lift = state.lift_position;
    if (state.lift == S::rising || state.lift == S::sinking)
      lift = towards(lift, state.lift == S::rising ? 1 : 0, step);
    state.asked_paddle = paddle;
    state.asked_lift = lift;
    if (paddle == state.paddle_position && lift == state.lift_position) {
      finish(state);
      continue;
    }
    batch.move_joint(i, k_left, left(paddle, lift));
    batch.move_joint(i, k_right, right(paddle, lift));
  }
}

void Gripper::joints_moved(const DeviceBatch& batch) const {
  for (std::size_t i = 0; i < batch.rows.size(); ++i) {
    if (!batch.asked_joint(i, k_left)) continue;
    auto& state = batch.state.as<GripperState>(batch.slot(i));
    if (batch.moved_joint(i, k_left)) {
      state.paddle_position = state.asked_paddle;
      state.lift_position = state.asked_lift;
    } else {
      state.stalled = 1;
    }
    finish(state);
  }
}

/// Grips or releases the body effect.target. Before it grips the body, it tests the contact again, because
/// the gripper and the body may have moved since act().
void Gripper::apply(engine::Gripping gripping, const engine::Effect& effect) const {
  const engine::CommittedView& view = gripping.view();
  const Row target = gripping.target();
  const engine::BodyType::Device& device = gripping.device();
  auto& state = gripping.state<GripperState>();
  if (effect.verb == k_release) {
    // A restored state may be wrong.
    if (target.valid() && view.carrier(target) == effect.source) gripping.release();
    state.held = 0;
    finish(state);
    return;
  }
  const Mount frame = compose(view.mount(gripping.row(), device.joint), place);
  const Hand hand(view, *this, state, gripping.row(), frame);
  const partition::PlacedShape shape = placed_grip(view, target);
  const double closer =
      towards(state.paddle_position, 1, k_rate * view.tick_s() * static_cast<double>(device.period));
  if (!hand.touches(shape, 1, closer) && !hand.touches(shape, -1, closer)) return;
  const bool has_it = gripping.attach(device.moves);
  state.taken = !has_it;
  if (!has_it) return;
  state.held = effect.target.value + 1;
  finish(state);
}

/// Adds lines to frame.grips: the two beams between the paddles, and a line from the gripper to the body that
/// it holds, if any.
void Gripper::draw(const engine::DeviceView& view, engine::Frame& frame) const {
  using engine::FrameTie;
  const auto& state = view.state.as<GripperState>(view.slot);
  const double side = face(state.paddle_position);
  const double lifted = state.lift_position * rise();
  for (const auto& [behind_tips, broken] :
       {std::pair(k_beams[1], state.beam_outer), std::pair(k_beams[0], state.beam_inner)}) {
    const double x = size().x() * (0.5 - behind_tips);
    frame.grips.push_back({broken != 0 ? FrameTie::Kind::broken_beam : FrameTie::Kind::beam,
                           view.at(x, side, lifted), view.at(x, -side, lifted)});
  }
  // If the gripper has not run since the held body died, its state still names this body.
  const BodyId own(std::size_t{frame.mobile[view.body].id});
  if (state.held == 0 || has_lost(view.world, own, state)) return;
  const Pose held = view.world.pose(BodyId(std::size_t{state.held} - 1));
  frame.grips.push_back({FrameTie::Kind::holds, view.at(0, 0, lifted), {held.x, held.y, held.z}});
}

DeviceKind::Prepared Gripper::prepare(const Params& params, const Pose& pose_body_gripper) {
  const Gripper gripper{params, Mount(pose_body_gripper)};
  return {.data = gripper,
          .reach_m = pose_body_gripper.position().norm() + gripper.size().head<2>().norm(),
          .cell_hint_m = gripper.size().head<2>().norm(),
          .most_effects = 1,
          .joints = {gripper.left(gripper.starts_closed(), gripper.starts_up()),
                     gripper.right(gripper.starts_closed(), gripper.starts_up())},
          .joint_reach_m = gripper.travel()};
}

Result<> Gripper::bind_part(const engine::TypeSpec&, std::uint32_t) const {
  if (paddle().y() < 0.5) return {};
  return Error{
      fmt::format("has a paddle_size of [{:g}, {:g}, {:g}], whose y must be below 0.5, or two paddles "
                  "do not fit",
                  paddle().x(), paddle().y(), paddle().z())};
}

void Gripper::start(State& row) const {
  row.paddles = starts_closed() ? State::closed : State::is_open;
  row.lift = starts_up() ? State::is_up : State::is_down;
  row.paddle_position = row.asked_paddle = starts_closed();
  row.lift_position = row.asked_lift = starts_up();
}

// ---- lint

/// The number of bodies that grippers can hold.
struct GrippableBodies {
  std::size_t count = 0;

  explicit GrippableBodies(const engine::LintWorld& world) {
    for (std::size_t t = 0; t < world.types.size(); ++t)
      if (engine::can_be_gripped(world.spec.types[t])) count += world.bodies[t];
  }
};

/// Warns if the gripper can hold no other body.
void Gripper::lint(const engine::LintView& view) const {
  const std::size_t own = engine::can_be_gripped(view.type_spec()) ? 1 : 0;
  if (view.world.shared<GrippableBodies>().count == own)
    view.warn(engine::LintTopic::grip,
              fmt::format(
                  "{} can hold nothing: no other body has \"gripper_return\"",
                  engine::device_text(view.device().kind->name, view.device().name, view.body_type().name)));
}

}  // namespace

DeviceKind gripper_kind() {
  return engine::make_device_kind<Gripper>("gripper", "two paddles that close on bodies, hold and lift them");
}

}  // namespace troupe::models
