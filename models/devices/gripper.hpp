#pragma once

#include "engine/fields/description.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/kinds/device_kind.hpp"

namespace troupe::models {

/// The command of a gripper, which has two paddles that close and open, and a lift that raises the paddles.
/// The command holds until the controller replaces it. A motion that has begun continues to its end, even
/// after another command, unless this is the opposite command (`open` and `close`, `up` and `down`). So a
/// controller can make the paddles and the lift move at the same time: it commands `close`, and in the next
/// tick (time step) `up`.
struct GripperCommand {
  /// The motion that the gripper starts.
  enum Order : std::uint8_t {
    nothing,  ///< starts no motion
    open,     ///< open the paddles, and release the held body
    close,    ///< close the paddles, and grip a body that they touch
    up,       ///< lift the paddles and the held body
    down,     ///< lower the paddles and the held body
  };
  std::uint8_t order = nothing;  ///< the motion to start, one of Order

  static constexpr void describe(engine::Description<GripperCommand>& d) {
    d.member<&GripperCommand::order>("order", "motion to start: 0: none, 1: open, 2: close, 3: up, 4: down");
  }
};

/// State of a gripper: its motions and its readings. A body "with gripper_return" is one whose parameter
/// gripper_return is set in the world file: grippers can detect and grip it. A tick is a time step.
struct GripperState {
  /// State of the two paddles.
  enum Paddles : std::uint8_t {
    is_open,  ///< at rest, fully apart
    closing,  ///< moving towards each other
    closed,   ///< at rest, together or at the held body; if this body has died, where they held it
    opening,  ///< moving apart
  };
  /// State of the lift, which moves the paddles up and down.
  enum Lift : std::uint8_t {
    is_down,  ///< at rest at the lower end
    rising,   ///< moving up
    is_up,    ///< at rest at the upper end
    sinking,  ///< moving down
  };
  std::uint8_t paddles = is_open;  ///< state of the paddles, one of Paddles
  std::uint8_t lift = is_down;     ///< state of the lift, one of Lift
  std::uint8_t stalled = 0;        ///< 1: the motion of the gripper in this tick was blocked
  std::uint8_t taken = 0;          ///< 1: a body could not be gripped: Gripping::attach() returned false
  std::uint8_t beam_inner = 0;     ///< 1: a body with gripper_return breaks the beam near the base
  std::uint8_t beam_outer = 0;     ///< 1: a body with gripper_return breaks the beam near the tips
  std::uint8_t contact_left = 0;   ///< 1: a body with gripper_return touches the left paddle's inner face
  std::uint8_t contact_right = 0;  ///< 1: a body with gripper_return touches the right paddle's inner face
  std::uint32_t held = 0;          ///< id + 1 of the body that the gripper holds; 0: none
  double paddle_position = 0;      ///< from 0 (open) to 1 (closed)
  double lift_position = 0;        ///< from 0 (down) to 1 (up)
  double asked_paddle = 0;         ///< paddle position at the end of this tick if nothing blocks the motion
  double asked_lift = 0;           ///< lift position at the end of this tick if nothing blocks the motion

  static constexpr void describe(engine::Description<GripperState>& d) {
    d.member<&GripperState::paddles>("paddles",
                                     "state of the paddles: 0: open, 1: closing, 2: closed, 3: opening");
    d.member<&GripperState::lift>("lift", "state of the lift: 0: down, 1: rising, 2: up, 3: sinking");
    d.member<&GripperState::stalled>("stalled", "1: the motion of the gripper in this tick was blocked");
    d.member<&GripperState::taken>(
        "taken",
        "1: the gripper could not grip a body, because another gripper holds that body, because that body "
        "carries the gripper, or because a body would be carried by too many others (docs/limits.md)");
    d.member<&GripperState::beam_inner>("beam_inner",
                                        "1: a body with gripper_return breaks the beam near the base");
    d.member<&GripperState::beam_outer>("beam_outer",
                                        "1: a body with gripper_return breaks the beam near the tips");
    d.member<&GripperState::contact_left>(
        "contact_left", "1: a body with gripper_return touches the left paddle's inner face");
    d.member<&GripperState::contact_right>(
        "contact_right", "1: a body with gripper_return touches the right paddle's inner face");
    d.member<&GripperState::held>("held", "id + 1 of the body that the gripper holds; 0: none");
    d.member<&GripperState::paddle_position>("paddle_position", "from 0 (open) to 1 (closed)");
    d.member<&GripperState::lift_position>("lift_position", "from 0 (down) to 1 (up)");
    d.member<&GripperState::asked_paddle>(
        "asked_paddle",
        "position of the paddles, from 0 to 1, at the end of this tick unless their motion is blocked");
    d.member<&GripperState::asked_lift>(
        "asked_lift",
        "position of the lift, from 0 to 1, at the end of this tick unless its motion is blocked");
  }
};

/// Returns the definition of the device `gripper`: a base with two paddles, which close on a body, hold it
/// and lift it. The body must have gripper_return, a parameter in the world file. x points from the base to
/// the tips of the paddles, y to the left. A tick is a time step.
///
/// parameters  size (x, y, z of the base and the open paddles together, m), paddle_size (x, y, z of a paddle
///             as fractions of size), paddles (open or closed at the start), lift (down or up at the start),
///             autosnatch (true: the gripper ignores commands; it closes while a body breaks one of its light
///             beams, and opens otherwise)
/// state       GripperState; commands: GripperCommand
/// geometry    Let s be size, p paddle_size, c the paddle position (0 open to 1 closed), and u the lift
///             position (0 down to 1 up).
///             - The base fills the rear (1 - p.x) s.x of the length.
///             - The paddles are p.y s.y thick and p.z s.z high.
///             - The inner faces of the paddles are at y = +-(1 - c)(s.y / 2 - p.y s.y).
///             - The lift raises the paddles by u (1 - p.z) s.z.
/// motion      The paddles and the lift each take 2 s from one end to the other. If a paddle would overlap a
///             body or a wall, the paddles and the lift do not move in this tick, and the gripper is stalled.
/// sensors     Two light beams run from one inner face to the other, at the height of the lower edges of the
///             paddles. The inner beam is 0.495 s.x behind the tips, the outer beam 0.165 s.x. Each paddle
///             also has a contact sensor: it detects bodies that the inner face would touch if the paddle
///             closed for one more tick. The beams and the contact sensors detect bodies with gripper_return,
///             and also the held body.
/// gripping    When a closing paddle touches a body with gripper_return, the paddles stop and hold the body
///             in its present pose. From then on, the body moves with the paddles. Bodies that are wider than
///             the gap between the open paddles are not held.
///             If the paddles touch several bodies, they hold the body with the lowest id among those that
///             the left paddle touches. If the left paddle touches none, they hold the body with the lowest
///             id among those that the right paddle touches.
///             If several grippers touch a body in the same tick, only one of them holds it: the gripper
///             whose own body has the lowest id. The other grippers report `taken`.
/// releasing   When the paddles start to open, they release the held body, which stays where it is.
/// source      Stage 4.3; docs/stage-worlds.md lists the bugs of Stage that are fixed here
engine::DeviceKind gripper_kind();

}  // namespace troupe::models
