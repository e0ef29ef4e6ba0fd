#pragma once

#include "engine/fields/description.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/kinds/kinds.hpp"

namespace troupe::models {

/// The command of a gripper. The command holds until the controller replaces it. A motion that an order has
/// started continues to its end, unless the opposite order (`open` and `close`, `up` and `down`) reverses it.
/// So the paddles and the lift can move at the same time, if an order for one follows an order for the other.
struct GripperCommand {
  /// The motion to start.
  enum Order : std::uint8_t {
    nothing,  ///< starts no motion
    open,     ///< open the paddles, and release what they hold
    close,    ///< close the paddles, and grip what they touch
    up,       ///< lift the paddles, with what they hold
    down,     ///< lower the paddles, with what they hold
  };
  std::uint8_t order = nothing;  ///< the motion to start, an Order

  static constexpr void describe(engine::Description<GripperCommand>& d) {
    d.member<&GripperCommand::order>("order", "motion to start: 0: none, 1: open, 2: close, 3: up, 4: down");
  }
};

/// State of a gripper: its motions and its readings. A tick is a simulation step. A body "with
/// gripper_return" has this parameter set: it can be detected and gripped.
struct GripperState {
  /// State of the paddles.
  enum Paddles : std::uint8_t {
    is_open,  ///< at rest, fully apart
    closing,  ///< moving towards each other
    closed,   ///< at rest, together or on the body that they hold
    opening,  ///< moving apart
  };
  /// State of the lift.
  enum Lift : std::uint8_t {
    is_down,  ///< at rest at the lower end
    rising,   ///< moving up
    is_up,    ///< at rest at the upper end
    sinking,  ///< moving down
  };
  std::uint8_t paddles = is_open;  ///< state of the paddles, one of Paddles
  std::uint8_t lift = is_down;     ///< state of the lift, one of Lift
  std::uint8_t stalled = 0;        ///< 1: the motion of the gripper in this tick was blocked
  std::uint8_t taken = 0;          ///< 1: a body could not be gripped, because another gripper holds it
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
        "taken", "1: the gripper could not grip a body, because another gripper holds that body");
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

/// Returns the definition of the device `gripper`: a base with two paddles. The paddles close on bodies with
/// gripper_return, hold one of these bodies and lift the held body.
///
/// parameters  size (x, y, z, m), paddle_size (x, y, z, relative to size), paddles (open or closed) and lift
///             (down or up) at the start, autosnatch (the gripper ignores commands: it closes while a body
///             breaks one of its beams, and opens otherwise)
/// state       GripperState; commands: GripperCommand
/// geometry    Let s be `size`, p `paddle_size`, c the paddle position (0 open to 1 closed) and u the lift
///             position (0 down to 1 up). The base fills the rear (1 - p.x) s.x of the length. The paddles
///             are p.y s.y thick and p.z s.z high, their inner faces are at y = +-(1 - c)(s.y / 2 - p.y s.y),
///             and they are raised by u (1 - p.z) s.z.
/// motion      The paddles and the lift each take 2 s from one end to the other. If a paddle would overlap
///             a body or a wall, paddles and lift do not move in this tick, and the gripper is stalled.
/// beams       Two light beams run between the inner faces of the paddles, at the height of their lower
///             edges, 0.495 s.x (inner) and 0.165 s.x (outer) behind the tips. Each paddle also has a contact
///             sensor, which detects bodies in the area that its inner face would sweep in one tick of
///             closing. The beams and the contact sensors detect bodies with gripper_return, and the body
///             that the gripper holds.
/// gripping    When closing paddles touch a body with gripper_return, they stop and hold the body in its
///             present pose: from then on, the body moves with the paddles. If they touch several bodies,
///             they hold the body with the lowest id of those that touch the left paddle. If no body touches
///             the left paddle, they hold the body with the lowest id of those that touch the right paddle. A
///             body wider than the gap between the open paddles cannot be held. If several grippers touch a
///             body in one tick, the gripper whose own body has the lowest id holds the touched body, and the
///             other grippers report `taken`.
/// releasing   When the paddles start to open, they release the body, which stays where it is.
/// source      Stage 4.3; docs/stage-worlds.md lists the bugs of Stage that are fixed here
engine::DeviceKind gripper_kind();

}  // namespace troupe::models
