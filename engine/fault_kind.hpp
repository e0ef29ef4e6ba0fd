#pragma once

#include "base/result.hpp"
#include "engine/description.hpp"

#include <cstdint>
#include <string_view>

namespace troupe::engine {

struct BodyType;

/// What a fault does to a body.
struct Ailment {
  std::uint32_t dead = 0;  ///< devices that do nothing any more: a bit each, in the order of the type's
  double speed = 1;        ///< what its drive gives is multiplied by this; above 0, at most 1
  bool drops_out = false;  ///< all of it stops: devices, controllers, drive
  double per_s = 0;        ///< mean rate at which it occurs, once it may; 0: at once
  double lasts_s = 0;      ///< of dropping out: how long; then it may occur again. 0: for good
};

/// The devices that can be dead: Ailment::dead has no more bits.
inline constexpr std::size_t k_most_fallible = 32;

/// A way to fail. It says what the fault does; who fails and when is the world's business, and no robot that
/// is sound pays for it.
struct FaultKind {
  std::string_view name;  ///< as files say it; unique in the registry
  std::string_view text;  ///< one sentence for `troupe describe`
  FieldTable params;      ///< its parameters
  /// For bodies of this type, once, when the world is built; or why such a body cannot fail so.
  Result<Ailment> (*prepare)(const Record& params, const BodyType& type) = nullptr;
};

/// A kind of a class F that has a described `struct Params` and
///
///     static Result<Ailment> prepare(const Params&, const BodyType&);
template <class F>
FaultKind make_fault_kind(std::string_view name, std::string_view text) {
  return {name, text, described<typename F::Params>(), [](const Record& record, const BodyType& type) {
            return F::prepare(from_record<typename F::Params>(record), type);
          }};
}

}  // namespace troupe::engine
