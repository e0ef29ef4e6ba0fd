#pragma once

#include "base/result.hpp"
#include "engine/fields/description.hpp"

#include <cstdint>
#include <string_view>

namespace troupe::engine {

struct BodyType;

/// The effect of a fault on a body, and how often the fault occurs. A fault that is no drop-out (`drops_out`)
/// lasts until the end of the run, or until the body dies.
struct Impairment {
  /// Devices that stop working: bit d for device d of the type (BodyType::devices).
  std::uint32_t dead = 0;
  double speed = 1;        ///< factor on the velocity of the body's drive; above 0, at most 1
  bool drops_out = false;  ///< true: a drop-out, which stops all devices, all controllers and the drive
  /// The rate at which the fault occurs, 1/s. The time until the fault occurs counts from FaultSpec::from_s,
  /// the world time from which on faults may occur, or from the end of the last drop-out. This time is
  /// exponentially distributed with the mean 1 / per_s, and rounded up to whole ticks. 0: the fault occurs
  /// at FaultSpec::from_s.
  double per_s = 0;
  /// Duration of a drop-out, s, rounded up to whole ticks; 0: it never ends. Not used by other faults. Only a
  /// drop-out that ends can occur again, and only if per_s is above 0; any other fault occurs at most once
  /// per body.
  double lasts_s = 0;
};

/// The number of devices of a type that can fail: the number of bits of Impairment::dead. Devices with an
/// index of 32 or more never fail.
inline constexpr std::size_t k_most_fallible = 32;

/// A kind of fault. It defines the effect of the fault on a body, and how often the fault occurs and how long
/// it lasts (Impairment). The world selects the robots that may fail, and draws the random times. As long as
/// no robot is impaired, faults take no extra computing time.
struct FaultKind {
  std::string_view name;  ///< name in files; unique in the registry
  /// One sentence for `troupe describe`. `name` and `text` must live as long as the kind.
  std::string_view text;
  FieldTable params;  ///< table of the parameters of such a fault, with their limits and defaults
  /// Compiles the parameters for the bodies of a type. Called when a world is built or restarted, once for
  /// each impairment of a FaultSpec and each type with bodies that may have the fault. The parameters are
  /// within the limits of `params`. The error says why bodies of the type cannot have the fault.
  Result<Impairment> (*prepare)(const Record& params, const BodyType& type) = nullptr;
};

/// Makes a fault kind from a class F that has a described `struct Params` (engine/fields/description.hpp) and
/// the hook FaultKind::prepare with its parameters:
///
///     static Result<Impairment> prepare(const Params&, const BodyType&);
///
/// `name` and `text` must live as long as the kind.
template <class F>
FaultKind make_fault_kind(std::string_view name, std::string_view text) {
  return {name, text, described<typename F::Params>(), [](const Record& record, const BodyType& type) {
            return F::prepare(from_record<typename F::Params>(record), type);
          }};
}

}  // namespace troupe::engine
