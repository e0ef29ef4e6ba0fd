#pragma once

#include "engine/controller.hpp"
#include "engine/kinds.hpp"

namespace troupe::models {

/// The command of a gripper. It holds until the controller replaces it. A motion that an order has started
/// continues to its end even if the order changes, so paddles and lift can move at the same time.
struct GripperCommand {
  /// What to start.
  enum Order : std::uint8_t {
    nothing,  ///< start no motion
    open,     ///< open the paddles, and release what they hold
    close,    ///< close the paddles, and grip what they touch
    up,       ///< lift the paddles
    down,     ///< lower the paddles
  };
  std::uint8_t order = nothing;  ///< an Order
  TROUPE_FIELDS(order)
};

/// State of a gripper: its motions and its readings.
struct GripperState {
  /// State of the paddles.
  enum Paddles : std::uint8_t {
    is_open,  ///< at rest, apart
    closing,  ///< moving
    closed,   ///< at rest, together or on the body that they hold
    opening,  ///< moving
  };
  /// State of the lift.
  enum Lift : std::uint8_t {
    is_down,  ///< at rest
    rising,   ///< moving
    is_up,    ///< at rest
    sinking,  ///< moving
  };
  std::uint8_t paddles = is_open;  ///< one of Paddles
  std::uint8_t lift = is_down;     ///< one of Lift
  std::uint8_t stalled = 0;        ///< 1: its motion was blocked
  std::uint8_t taken = 0;          ///< 1: another gripper holds the body that it closed on
  std::uint8_t beam_inner = 0;     ///< 1: a body with gripper_return breaks the beam near the base
  std::uint8_t beam_outer = 0;     ///< 1: a body with gripper_return breaks the beam near the tips
  std::uint8_t contact_left = 0;   ///< 1: such a body touches the inner face of the left paddle
  std::uint8_t contact_right = 0;  ///< 1: such a body touches the inner face of the right paddle
  std::uint32_t held = 0;          ///< id + 1 of the body that it holds; 0: none
  double paddle_position = 0;      ///< 0 open to 1 closed
  double lift_position = 0;        ///< 0 down to 1 up
  double asked_paddle = 0;         ///< paddle position requested for the end of this tick, 0 to 1
  double asked_lift = 0;           ///< lift position requested for the end of this tick, 0 to 1
  TROUPE_FIELDS(paddles, lift, stalled, taken, beam_inner, beam_outer, contact_left, contact_right, held,
                paddle_position, lift_position, asked_paddle, asked_lift)
};

/// A base with two paddles, which close on bodies that can be gripped and lift them.
///
/// parameters  size (x, y, z, m), paddle_size (x, y, z, relative to size), paddles (open, closed), lift
///             (down, up), autosnatch
/// state       GripperState; commands: GripperCommand
/// geometry    with size s, paddle_size p and positions c (0 open to 1 closed) and u (0 down to 1 up): the
///             base is the rear (1 - p.x) s.x; the paddles are p.y s.y thick and p.z s.z high, their inner
///             faces at y = +-(1 - c)(s.y / 2 - p.y s.y), and are raised by u (1 - p.z) s.z
/// motion      from end to end in 2 s; like all joints, the paddles stop at anything in their way
/// beams       between the inner faces, 0.495 and 0.165 s.x behind the tips. A contact is the area that the
///             face of a paddle would sweep in the tick. Both sense bodies with gripper_return, and the body
///             that the gripper holds
/// gripping    Closing paddles that touch such a body (the left paddle's first, then the lowest id) stop and
///             hold it as it lies: from then on it moves with the paddles. A body wider than the gap between
///             the open paddles cannot be held. If several grippers touch a body in one tick, that of the
///             lowest id holds it, and the others report `taken`.
/// releasing   when the paddles start to open, the body stays where it is
/// source      Stage 4.3; docs/stage-worlds.md lists what is fixed
engine::DeviceKind gripper_kind();

}  // namespace troupe::models
