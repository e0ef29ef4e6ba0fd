#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>

namespace troupe {

/// A dense index that identifies one object of a kind. Ids of different kinds do not convert into each other.
template <class Kind>
struct Id {
  std::uint32_t value = std::numeric_limits<std::uint32_t>::max();  ///< the index; all ones is the invalid id

  constexpr Id() = default;
  constexpr explicit Id(std::size_t v) : value(static_cast<std::uint32_t>(v)) {}  ///< v counts from 0

  /// False for a default-constructed id.
  constexpr bool valid() const { return value != std::numeric_limits<std::uint32_t>::max(); }
  /// The index, for use with arrays; meaningless unless valid().
  constexpr std::size_t index() const { return value; }
  friend constexpr auto operator<=>(Id, Id) = default;
};

/// A top-level model with everything rigidly attached to it, numbered in the order of the world file.
/// Ids are never reused and do not say where the data of the body are in memory.
using BodyId = Id<struct BodyIdKind>;
/// A body type: the data that identical bodies share.
using TypeId = Id<struct TypeIdKind>;
/// A row of the state tables: the current place of a mobile body's data.
using Row = Id<struct RowKind>;

}  // namespace troupe

template <class Kind>
/// For unordered containers. Never iterate over such a container in a step: its order is unspecified.
struct std::hash<troupe::Id<Kind>> {
  std::size_t operator()(troupe::Id<Kind> id) const noexcept { return id.value; }  ///< the index itself
};
