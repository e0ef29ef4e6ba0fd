#pragma once

#include "engine/fields/description.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/kinds/device_kind.hpp"

#include <cstdint>

namespace troupe::models {

/// State of a power pack (battery). Packs exchange energy through power contacts, which are devices that
/// touch one another. All energies are in J. Tick 0 is the start of the run; a tick is a time step.
struct PowerPackState {
  double stored = 0;          ///< energy that the pack holds
  double capacity = 0;        ///< greatest energy that the pack can hold
  double dissipated = 0;      ///< energy drawn since tick 0 by everything that the pack supplies
  double received = 0;        ///< energy received since tick 0 through power contacts
  double given = 0;           ///< energy given since tick 0 through power contacts
  std::uint8_t infinite = 0;  ///< 1: the pack never runs out; `stored` and `capacity` are 0
  /// 1: the pack received energy in the last tick; else 0. A pack that does not run, for example because its
  /// body is disabled, cannot set this value back to 0.
  std::uint8_t charging = 0;

  static constexpr void describe(engine::Description<PowerPackState>& d) {
    using namespace engine::facts;
    using enum engine::Unit;
    d.member<&PowerPackState::stored>("stored", joules, "energy that the pack holds");
    d.member<&PowerPackState::capacity>("capacity", joules, "greatest energy that the pack can hold");
    d.member<&PowerPackState::dissipated>("dissipated", joules,
                                          "energy drawn since tick 0 by everything that the pack supplies");
    d.member<&PowerPackState::received>("received", joules,
                                        "energy received since tick 0 through power contacts");
    d.member<&PowerPackState::given>("given", joules, "energy given since tick 0 through power contacts");
    d.member<&PowerPackState::infinite>("infinite", "1: the pack never runs out");
    d.member<&PowerPackState::charging>("charging", "1: the pack received energy in the last tick");
  }

  /// Whether the pack holds no energy. An infinite pack is never empty.
  bool is_empty() const { return infinite == 0 && stored <= 0; }
  /// Returns the stored energy divided by the capacity, from 0 to 1. Returns 1 if the pack is infinite, and 0
  /// if its capacity is 0.
  double proportion_remaining() const {
    if (infinite != 0) return 1;
    return capacity > 0 ? stored / capacity : 0;
  }
};

/// Returns the definition of the device `power_pack`: an energy store (battery) on a part of a body. It
/// supplies this part and the parts mounted on it, except parts that have a power pack of their own. A pack
/// on the main part, on which all other parts are mounted, also supplies the drive of the body. A tick is a
/// time step.
///
/// draw      In each tick, the pack loses the sum of these powers, in W, times the length of the tick:
///           - the parameter `draw`
///           - the power of each running sensor and device that the pack supplies; a ranger, for example,
///             draws 0.2 W per transducer (fan of beams)
///           - if the pack supplies a drive: `idle` + 10 `mass` (|forward| + |left| + |turn|); `idle` (W) and
///             `mass` (kg) are parameters, and forward, left and turn are the velocities (m/s and rad/s) that
///             the drive produces, even if the robot is blocked
///           This is the model of Stage, with two differences: Stage multiplies the power by 0.1 s instead of
///           the length of the tick, and uses the commanded velocities.
/// empty     The parameter `when_empty` says what happens when the pack is empty:
///           - "stop": the drive stands still, and sensors keep their last readings, until the pack receives
///             energy. Controllers continue to decide.
///           - "nothing": no effect, as in Stage.
///           - "die": the same as "stop", but the body dies when the pack runs the next time (usually in the
///             next tick). If the pack has received energy by then, the body lives on (docs/lives.md).
/// state     PowerPackState; no commands
/// when      The pack runs after the drive in each tick. So a robot still moves in the tick in which its pack
///           becomes empty.
engine::DeviceKind power_pack_kind();

/// State of a power contact (see power_contact_kind()).
struct PowerContactState {
  /// If the contact gives energy: number of taking contacts that it touched at the end of the last tick, at
  /// most k_most_takers. Otherwise 0.
  std::uint8_t touched = 0;

  static constexpr void describe(engine::Description<PowerContactState>& d) {
    d.member<&PowerContactState::touched>("touched",
                                          "for a giving contact: number of taking contacts that it touched "
                                          "at the end of the last tick; otherwise 0");
  }
};

/// Returns the definition of the device `power_contact`. Two touching contacts transfer energy between the
/// power packs that supply them. One contact gives: its parameter `give` (W) is above 0. The other takes: its
/// parameter `take` (W) is above 0. A tick is a time step.
///
/// touching  Two contacts touch if the outlines of their parts, seen from above, overlap or are at most
///           k_contact_m apart. Heights make no difference. It also makes no difference whether the bodies
///           are obstacles.
/// transfer  In each tick, two touching contacts transfer the power min(`give`, `take`), but no more energy
///           than the giving pack holds and the taking pack has room for. An infinite pack gives without
///           limit and takes nothing. A contact gives to at most k_most_takers other contacts: those on the
///           bodies with the lowest ids. Only the giving contact must run.
/// order     The transfers of a tick happen one after another, in the order of the ids of the giving bodies.
///           For one giving body, the order is that of its devices. For one giving contact, it is that of the
///           ids of the taking bodies. Each transfer changes what the packs hold for the next transfer.
/// state     PowerContactState; no commands
/// needs     a power pack on the part of the contact, or on a part that carries this part
/// none      Contacts of the same body exchange no energy. Contacts of bodies that move together (one carries
///           the other, or a third body carries both) do not exchange energy either.
engine::DeviceKind power_contact_kind();

/// Two power contacts touch if their outlines are at most this far apart, m. The value is the width of the
/// grid cells with which Stage detects that bodies touch.
inline constexpr double k_contact_m = 0.02;
/// A power contact gives energy to at most this number of other contacts in a tick (time step).
inline constexpr std::size_t k_most_takers = 16;

}  // namespace troupe::models
