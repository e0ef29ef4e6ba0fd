#pragma once

#include "base/result.hpp"
#include "engine/fields/description.hpp"

#include <cstdint>
#include <string_view>

namespace troupe::engine {

struct BodyType;

/// The effect of a fault on a body, and how often the fault occurs. A drop-out is a fault that stops the
/// whole body, for a limited time or for good (`drops_out`). Any other fault lasts until the end of the run,
/// or until the body dies.
///
/// Building the world reports an error at the position of the fault in the world file if `speed`, `per_s` or
/// `lasts_s` is out of its range.
struct Impairment {
  /// Devices that stop working: bit d for the device with index d in the list of devices of the body's type
  /// (BodyType::devices).
  std::uint32_t dead = 0;
  double speed = 1;        ///< factor on the velocity of the body's drive; above 0, at most 1
  bool drops_out = false;  ///< true: a drop-out, which stops all devices, all controllers and the drive
  /// The rate at which the fault occurs, 1/s; finite, at least 0. The fault cannot occur before the simulated
  /// time FaultSpec::from_s. After that, the waiting time until the fault is random: exponentially
  /// distributed with the mean 1 / per_s, and rounded up to whole ticks (time steps). When a drop-out ends, a
  /// new waiting time begins. If the rate is 0, the fault occurs once, at FaultSpec::from_s.
  double per_s = 0;
  /// Duration of a drop-out, s; finite, at least 0; rounded up to whole ticks (time steps); 0: the drop-out
  /// never ends. Not used for other faults: they do not end, so each of them occurs at most once per body.
  double lasts_s = 0;
};

/// Largest number of devices of a body type that can fail: the number of bits of Impairment::dead. Devices
/// with an index of 32 or more never fail.
inline constexpr std::size_t k_most_fallible = 32;

/// A kind of fault. It defines the effect of the fault on a body, how often the fault occurs and how long it
/// lasts (Impairment). The world selects the robots that may fail, and draws the random times. As long as no
/// robot is impaired, faults take no extra computing time.
struct FaultKind {
  std::string_view name = {};  ///< name in files; unique among the fault kinds
  /// Description in one sentence, which the command `troupe describe` prints. `name` and `text` must live as
  /// long as the kind.
  std::string_view text = {};
  FieldTable params =
      {};  ///< table of the parameters of a fault of this kind, with their limits and defaults
  /// Computes the Impairment for the bodies of a type from the parameters of a fault. The parameters are
  /// within the limits of `params`. The error says why bodies of the type cannot have the fault. Called when
  /// a world is built or restarted, for each fault of the world file: once for each type whose bodies may
  /// have that fault. If it throws, building the world reports an error at the position of the fault in the
  /// world file.
  Result<Impairment> (*prepare)(const Record& params, const BodyType& type) = nullptr;
};

/// Makes a fault kind from a class F. F must have a `struct Params` and the function
///
///     static Result<Impairment> prepare(const Params&, const BodyType&);
///
/// FaultKind::prepare calls this function. Params must have a function `describe`, which lists the members of
/// Params (engine/fields/description.hpp). `name` and `text` are the members of FaultKind, and must live as
/// long as the kind.
template <class F>
FaultKind make_fault_kind(std::string_view name, std::string_view text) {
  return {name, text, described<typename F::Params>(), [](const Record& record, const BodyType& type) {
            return F::prepare(from_record<typename F::Params>(record), type);
          }};
}

}  // namespace troupe::engine
