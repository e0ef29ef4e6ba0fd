#pragma once

#include "engine/controller.hpp"
#include "engine/kinds.hpp"

#include <cstdint>

namespace troupe::models {

/// What a power pack holds, J, and what has gone through it since tick 0.
struct PowerPackState {
  double stored = 0;          ///< what is left
  double capacity = 0;        ///< the most it can store
  double dissipated = 0;      ///< by all that runs on it
  double received = 0;        ///< from others, by contact
  double given = 0;           ///< to others, by contact
  std::uint8_t infinite = 0;  ///< 1: it never runs out; `stored` stays 0
  std::uint8_t charging = 0;  ///< 1: it was given something in the last tick

  static constexpr void describe(engine::Description<PowerPackState>& d) {
    using namespace engine::facts;
    using enum engine::Unit;
    d.member<&PowerPackState::stored>("stored", joules, "energy that it holds");
    d.member<&PowerPackState::capacity>("capacity", joules, "energy that it can hold");
    d.member<&PowerPackState::dissipated>("dissipated", joules,
                                          "energy drawn by all that it supplies, since tick 0");
    d.member<&PowerPackState::received>("received", joules, "energy received by contact, since tick 0");
    d.member<&PowerPackState::given>("given", joules, "energy given by contact, since tick 0");
    d.member<&PowerPackState::infinite>("infinite", "1: it never runs out");
    d.member<&PowerPackState::charging>("charging", "1: it received energy in the last tick");
  }

  /// Has nothing left; never where it is infinite.
  bool is_empty() const { return infinite == 0 && stored <= 0; }
  /// Of its capacity, 0 to 1; 1 where it is infinite.
  double proportion_remaining() const {
    if (infinite != 0) return 1;
    return capacity > 0 ? stored / capacity : 0;
  }
};

/// A power pack: what its part and what stands on that run on.
///
/// draw     each tick: `draw` itself; the watts of every sensor and device that runs on it (a ranger 0.2 W a
///          transducer); and, where it stands on the root of a body with a drive, `idle` and 10 W for each kg
///          of `mass` and m/s (rad/s) of |forward| + |left| + |turn|, of the speeds that the drive makes,
///          whether the robot then stalls or not. All as in Stage, but for one second a second whatever the
///          tick is, and of what drives go at, not of what they were asked for
/// empty    with `when_empty` "stop" all that runs on it stops: sensors keep their last readings, the drive
///          stands still; controllers go on deciding. It runs again once the pack is given something. With
///          "nothing" an empty pack has no effect, as in Stage. With "die" it stops all that runs on it, and
///          the body dies unless the pack is given something within a tick (docs/lives.md)
/// state    PowerPackState; no commands
/// settles  after the drive of the same tick: a pack that runs out in a tick still moves in it
engine::DeviceKind power_pack_kind();

/// What a contact that gives does.
struct PowerContactState {
  std::uint8_t touched = 0;  ///< contacts that took, or could have, in the last tick
  TROUPE_FIELDS(touched)
};

/// A contact, through which the packs of two bodies that touch exchange energy: one gives (`give` above 0),
/// the other takes (`take` above 0). The contact is the body of the part that carries it, all heights of it.
///
/// touching  their regions overlap or come within k_contact_m; also of bodies that collide with nothing
/// settles   each tick min(give, take) for its length, no more than the giver holds and the taker has room
///           for; one after another by (giver's id, taker's id), each seeing the earlier ones. Of more than
///           k_most_takers the lowest ids are served
/// state     PowerContactState; no commands
/// needs     a power pack on the same part or below it, on both sides; its own body is never served
engine::DeviceKind power_contact_kind();

/// Farther apart than this two contacts do not touch, m: the width of Stage's cells, in which its bodies
/// meet.
inline constexpr double k_contact_m = 0.02;
/// Bodies that one contact serves in a tick.
inline constexpr std::size_t k_most_takers = 16;

}  // namespace troupe::models
