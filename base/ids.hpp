#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>

namespace troupe {

/// A dense number that names one thing of one kind. Different kinds do not convert into each other.
template <class Kind>
struct Id {
  std::uint32_t value = std::numeric_limits<std::uint32_t>::max();  ///< the number; all ones names nothing

  constexpr Id() = default;
  constexpr explicit Id(std::size_t v) : value(static_cast<std::uint32_t>(v)) {}  ///< counted from 0

  /// False for a default-made id, which names nothing.
  constexpr bool valid() const { return value != std::numeric_limits<std::uint32_t>::max(); }
  /// For use with arrays; meaningless unless valid().
  constexpr std::size_t index() const { return value; }
  friend constexpr auto operator<=>(Id, Id) = default;
};

/// A top-level model with everything rigidly attached to it, numbered in the order of the world file.
/// Ids are never reused and say nothing about where the body's data lie in memory.
using BodyId = Id<struct BodyIdKind>;
/// What identical bodies share.
using TypeId = Id<struct TypeIdKind>;
/// A row of the state tables: where a mobile body's data lie now.
using Row = Id<struct RowKind>;

}  // namespace troupe

template <class Kind>
/// For unordered containers. Never iterate over one of these in a step: the order is not promised.
struct std::hash<troupe::Id<Kind>> {
  std::size_t operator()(troupe::Id<Kind> id) const noexcept { return id.value; }  ///< the number itself
};
