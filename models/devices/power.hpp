#pragma once

#include "engine/fields/description.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/kinds/kinds.hpp"

#include <cstdint>

namespace troupe::models {

/// State of a power pack (battery): its energy, and the energy that it has exchanged since the start of the
/// run (tick 0; a tick is a simulation step), all in J. Packs exchange energy through power contacts, which
/// are devices that touch one another.
struct PowerPackState {
  double stored = 0;          ///< energy that the pack holds
  double capacity = 0;        ///< greatest energy that the pack can hold
  double dissipated = 0;      ///< energy drawn since tick 0 by everything that the pack supplies
  double received = 0;        ///< energy received since tick 0 through power contacts
  double given = 0;           ///< energy given since tick 0 through power contacts
  std::uint8_t infinite = 0;  ///< 1: the pack never runs out; `stored` and `capacity` stay 0
  /// 1: the pack received energy in the last tick. If the pack does not run in a tick, for example because
  /// its body is disabled, `charging` keeps the value 1.
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
  /// Stored energy divided by the capacity, 0 to 1; 1 if the pack is infinite, 0 if its capacity is 0.
  double proportion_remaining() const {
    if (infinite != 0) return 1;
    return capacity > 0 ? stored / capacity : 0;
  }
};

/// Returns the definition of the device `power_pack`: an energy store on a part of a body. It supplies this
/// part and the parts mounted on this part.
///
/// draw     The power drawn in each tick is the sum of three terms: the parameter `draw`; the power of each
///          running sensor and device that the pack supplies (a ranger draws 0.2 W per transducer); and, if
///          the pack is on the root part of a body with a drive, the power of the drive. The last term is
///          `idle` + 10 `mass` (|forward| + |left| + |turn|), in W, where `idle` (W) and `mass` (kg) are
///          parameters. The velocities (m/s and rad/s) are those that the drive produces, even if the robot
///          is stalled. This is the model of Stage, with two differences: Stage multiplies the power by 0.1 s
///          instead of the length of the tick, and uses the commanded velocities.
/// empty    If the parameter `when_empty` is "stop", everything that an empty pack supplies stops: sensors
///          keep their last readings and the drive stands still, but controllers continue to decide. Sensors
///          and drive run again when the pack receives energy. With "nothing", an empty pack has no effect,
///          as in Stage. With "die", everything that the pack supplies stops, and the body dies when the pack
///          runs the next time. If the pack runs in every tick, this is the next tick. The body does not die
///          if the pack receives energy in a tick before that (docs/lives.md).
/// state    PowerPackState; no commands
/// when     The pack runs after the drive in each tick, so a robot still moves in the tick in which its pack
///          runs out.
engine::DeviceKind power_pack_kind();

/// State of a power contact.
struct PowerContactState {
  /// For a giving contact: number of taking contacts that it touched at the end of the last tick, counted up
  /// to k_most_takers. For other contacts: 0.
  std::uint8_t touched = 0;

  static constexpr void describe(engine::Description<PowerContactState>& d) {
    d.member<&PowerContactState::touched>("touched",
                                          "for a giving contact: number of taking contacts that it touched "
                                          "at the end of the last tick; otherwise 0");
  }
};

/// Returns the definition of the device `power_contact`. Two touching contacts transfer energy between the
/// power packs that supply them: one contact gives (its parameter `give`, in W, is above 0), and the other
/// takes (its parameter `take`, in W, is above 0). The shape of a contact is the outline of the part that
/// carries it, seen from above: heights make no difference.
///
/// touching  Two contacts touch if their outlines overlap or are at most k_contact_m apart, whether or not
///           the bodies are obstacles.
/// transfer  In each tick, the energy min(give, take) times the length of the tick is transferred, but no
///           more than the giving pack holds, and no more than the taking pack can store. An infinite pack
///           gives without limit and takes nothing. Transfers happen one after another, ordered by the id of
///           the giving body and then that of the taking body. Each transfer uses the energies that the packs
///           have after the earlier transfers. If a contact touches more than k_most_takers taking contacts,
///           it gives only to k_most_takers of them: those on the bodies with the lowest ids.
/// state     PowerContactState; no commands
/// needs     for each of the two contacts, a power pack on the part of the contact or on a part that carries
///           this part. Contacts of the same body, and of bodies that move together (one carries the other,
///           or a third body carries both), do not exchange energy
engine::DeviceKind power_contact_kind();

/// Greatest distance, m, between the outlines of two power contacts that count as touching. It is the width
/// of the grid cells with which Stage detects contact of bodies.
inline constexpr double k_contact_m = 0.02;
/// Greatest number of power contacts to which one power contact gives energy in a tick (simulation step).
inline constexpr std::size_t k_most_takers = 16;

}  // namespace troupe::models
