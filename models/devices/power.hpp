#pragma once

#include "engine/controller.hpp"
#include "engine/kinds.hpp"

#include <cstdint>

namespace troupe::models {

/// State of a power pack: its energy, and the energy that it has exchanged since tick 0, J.
struct PowerPackState {
  double stored = 0;          ///< energy that it holds
  double capacity = 0;        ///< energy that it can hold
  double dissipated = 0;      ///< drawn by all that it supplies
  double received = 0;        ///< received by contact
  double given = 0;           ///< given by contact
  std::uint8_t infinite = 0;  ///< 1: it never runs out; `stored` stays 0
  std::uint8_t charging = 0;  ///< 1: it received energy in the last tick

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

  /// Whether it holds no energy. An infinite pack is never empty.
  bool is_empty() const { return infinite == 0 && stored <= 0; }
  /// Stored energy relative to the capacity, 0 to 1; 1 if it is infinite, 0 if its capacity is 0.
  double proportion_remaining() const {
    if (infinite != 0) return 1;
    return capacity > 0 ? stored / capacity : 0;
  }
};

/// A power pack: supplies its part and the parts mounted on that.
///
/// draw     each tick: `draw`; the watts of each running sensor and device that it supplies (a ranger 0.2 W
///          per transducer); and, if it is on the root part of a body with a drive, `idle` plus 10 W for each
///          kg of `mass` and each m/s (rad/s) of |forward| + |left| + |turn|. These are the velocities that
///          the drive produces, even if the robot is stalled. As in Stage, with two differences: the energy
///          is that of the length of the tick (Stage: always 0.1 s), and the velocities are those produced,
///          not those commanded
/// empty    with `when_empty` "stop", everything that it supplies stops: sensors keep their last readings and
///          the drive stands still, but controllers continue to decide. It runs again when the pack receives
///          energy. With "nothing", an empty pack has no effect, as in Stage. With "die", everything that it
///          supplies stops, and the body dies unless the pack receives energy within a tick (docs/lives.md)
/// state    PowerPackState; no commands
/// when     after the drive of the same tick: a robot whose pack runs out in a tick still moves in it
engine::DeviceKind power_pack_kind();

/// State of a contact that gives.
struct PowerContactState {
  std::uint8_t touched = 0;  ///< taking contacts that it touched in the last tick
  TROUPE_FIELDS(touched)
};

/// A contact, through which the packs of two touching bodies exchange energy: one gives (`give` above 0), the
/// other takes (`take` above 0). Its shape is the outline of the part that carries it, whatever the heights.
///
/// touching  the outlines overlap or are within k_contact_m, whether or not the bodies are obstacles
/// transfer  each tick min(give, take) times the length of the tick, at most what the giver holds and the
///           taker has room for. Transfers happen one after another in the order of (giver's id, taker's id);
///           later ones see earlier ones. Of more than k_most_takers contacts, those with the lowest ids are
///           served
/// state     PowerContactState; no commands
/// needs     on both sides a power pack on the same part or on one that carries it; contacts of the same tree
///           of carried bodies are never served
engine::DeviceKind power_contact_kind();

/// Greatest distance of touching contacts, m: the width of the cells in which Stage's bodies meet.
inline constexpr double k_contact_m = 0.02;
/// Contacts that one contact serves in a tick, at most.
inline constexpr std::size_t k_most_takers = 16;

}  // namespace troupe::models
