#pragma once

#include "engine/controller.hpp"
#include "engine/kinds.hpp"

namespace troupe::models {

/// What controllers ask of a gripper; it stays in force until they ask otherwise. What an order has begun
/// goes on to its end whatever comes next: paddles and lift move at the same time.
struct GripperCommand {
  /// What it is to do.
  enum Order : std::uint8_t {
    nothing,  ///< begin nothing new
    open,     ///< the paddles, and let go
    close,    ///< the paddles, and grip what they touch
    up,       ///< lift the paddles
    down,     ///< lower them
  };
  std::uint8_t order = nothing;  ///< an Order
  TROUPE_FIELDS(order)
};

/// What a gripper does, and feels.
struct GripperState {
  /// What the paddles do.
  enum Paddles : std::uint8_t {
    is_open,  ///< at rest, apart
    closing,  ///< on their way
    closed,   ///< at rest, together or on what they hold
    opening,  ///< on their way
  };
  /// What the lift does.
  enum Lift : std::uint8_t {
    is_down,  ///< at rest
    rising,   ///< on its way
    is_up,    ///< at rest
    sinking,  ///< on its way
  };
  std::uint8_t paddles = is_open;  ///< one of Paddles
  std::uint8_t lift = is_down;     ///< one of Lift
  std::uint8_t stalled = 0;        ///< 1: something was in the way of its paddles
  std::uint8_t taken = 0;          ///< 1: another gripper has what it closed on
  std::uint8_t beam_inner = 0;     ///< 1: something that can be gripped breaks the beam near the base
  std::uint8_t beam_outer = 0;     ///< or the one near the tips
  std::uint8_t contact_left = 0;   ///< 1: such a thing touches the inner face of the left paddle
  std::uint8_t contact_right = 0;  ///< or of the right one
  std::uint32_t held = 0;          ///< id + 1 of what it holds; 0: nothing
  double paddle_position = 0;      ///< 0 open to 1 closed
  double lift_position = 0;        ///< 0 down to 1 up
  double asked_paddle = 0;         ///< where they were to be after this tick
  double asked_lift = 0;           ///< 0 down to 1 up, beside asked_paddle
  TROUPE_FIELDS(paddles, lift, stalled, taken, beam_inner, beam_outer, contact_left, contact_right, held,
                paddle_position, lift_position, asked_paddle, asked_lift)
};

/// A base with two paddles, which close on what can be gripped and lift it.
///
/// parameters  size (x, y, z, m), paddle_size (x, y, z, shares of that), paddles (open, closed), lift (down,
///             up), autosnatch
/// state       GripperState; commands: GripperCommand
/// geometry    with size s, paddle_size p and positions c (0 open to 1 closed) and u (0 down to 1 up): the
///             base is the rear (1 - p.x) s.x; the paddles are p.y s.y thick and p.z s.z high, their inner
///             faces at y = +-(1 - c)(s.y / 2 - p.y s.y), and are raised by u (1 - p.z) s.z
/// motion      from end to end in 2 s; paddles stop at whatever is in their way, as all joints do
/// beams       between the inner faces, 0.495 and 0.165 s.x behind the tips; contacts: what the face of a
///             paddle would sweep in the tick. Both feel what has a gripper_return, and what the gripper
///             holds
/// gripping    Closing paddles that touch such a body (the left one's first) stop and hold it whole, as it
///             lies: from then on it moves with the paddles. What is wider than the open paddles are apart
///             cannot be held. Of several grippers that touch it in one tick that of the lowest id has it;
///             the others learn that it is taken.
/// releasing   paddles that begin to open leave what they hold where it is
/// source      Stage 4.3; docs/stage-worlds.md tells what is repaired
engine::DeviceKind gripper_kind();

}  // namespace troupe::models
