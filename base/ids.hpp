#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>

namespace troupe {

/// The index of an object among all objects of one category, such as the bodies of a world. Kind is a tag
/// that names the category: ids with different tags do not convert into each other.
template <class Kind>
struct Id {
  std::uint32_t value = std::numeric_limits<std::uint32_t>::max();  ///< the index; 2^32 - 1 in an invalid id

  constexpr Id() = default;
  constexpr explicit Id(std::size_t v) : value(static_cast<std::uint32_t>(v)) {}  ///< index below 2^32 - 1

  /// False for a default-constructed id.
  constexpr bool valid() const { return value != std::numeric_limits<std::uint32_t>::max(); }
  /// Returns the index, for use with arrays. The result has no meaning if valid() is false.
  constexpr std::size_t index() const { return value; }
  friend constexpr auto operator<=>(Id, Id) = default;
};

/// Identifies a body: a robot or another object of the world, with all parts that are attached to it. Bodies
/// are numbered from 0 in the order of the world file. If a body leaves the world during a run, its id is not
/// given to another body. The index of a body in the state tables is not its id, but its Row.
using BodyId = Id<struct BodyIdKind>;
/// Identifies a body type, which holds the data that bodies of the same construction share.
using TypeId = Id<struct TypeIdKind>;
/// Identifies a row of the state tables, the arrays that hold the state of a simulation. A body has a row if
/// it has a drive, a device or a controller, or if it can be gripped or pushed. The row of a body may change
/// between two ticks (time steps). Code that refers to a body for more than one tick must therefore keep its
/// BodyId.
using Row = Id<struct RowKind>;

}  // namespace troupe

/// Makes ids usable as keys of unordered containers. Code that steps a world must not iterate over such a
/// container: its order is unspecified, so results could differ between platforms.
template <class Kind>
struct std::hash<troupe::Id<Kind>> {
  std::size_t operator()(troupe::Id<Kind> id) const noexcept { return id.value; }  ///< the index itself
};
