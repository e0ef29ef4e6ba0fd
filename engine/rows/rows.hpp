#pragma once

#include "base/ids.hpp"
#include "engine/rows/places.hpp"
#include "engine/state/world_state.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace troupe::engine {

/// The data of a row that cannot be computed from the spec or from other data: the state of the row's body,
/// whether World::subscribe() was called for the body, and what placed_before_step() must know about it.
struct RowState {
  BodyId body;                   ///< body of the row
  std::vector<std::byte> bytes;  ///< the data, for a world with the same spec; empty: a row of zeros
};

/// Which body of a world has which row, and which slot: gives bodies other rows, removes rows and adds them.
/// Moves the state, and the lists of placed bodies, with the rows. Does not compute derived data: the caller
/// must do so after each change (World).
class Rows {
 public:
  /// The arguments must outlive the object.
  Rows(WorldState& state, Places& places) : state_(state), places_(places) {}
  Rows(const Rows&) = delete;
  Rows& operator=(const Rows&) = delete;

  /// Makes the rows of a world, before it has tables. Bodies that are neighbours in space at tick 0 get rows
  /// that are close in memory, and most of them remain neighbours for a long time. With 100,000 robots in a
  /// building, a step with rows in arbitrary order takes 1.5 times as long. The order affects only the speed.
  ///
  /// geometry: the grid that the world has if WorldOptions::tile_size_m is not set
  void build(const partition::GridGeometry& geometry);
  /// Gives the bodies other rows and slots, at random. The random numbers follow from `seed` and the tick.
  void shuffle(std::uint64_t seed);
  /// Removes the rows of bodies, and returns their data, in the order of `bodies`. Throws
  /// std::invalid_argument, and changes nothing, if a body has no row here, if a body occurs twice, or if
  /// only a part of a tree is removed.
  std::vector<RowState> take(std::span<const BodyId> bodies);
  /// Adds rows after the present ones, in the order of the list. Throws std::invalid_argument, and changes
  /// nothing, if location() of a body is not RowLocation::elsewhere, or if a body occurs twice.
  void add(std::span<const RowState> added);
  /// Removes the rows of `leaving`, and then adds those of `coming` after the remaining rows. The last rows
  /// fill the places of the removed rows. Afterwards, the first `own` rows are the own rows
  /// (WorldState::own_rows). Returns whether there are other rows than before.
  bool exchange(std::span<const BodyId> leaving, std::span<const RowState> coming, std::size_t own);
  /// Returns the data of a row, as RowState::bytes contains them.
  std::vector<std::byte> bytes(Row row);

 private:
  std::vector<BodyId> by_place(const partition::GridGeometry& geometry) const;
  void move(std::span<const std::uint32_t> to, std::span<const std::vector<std::uint32_t>> slots_to);
  void drop(const std::vector<bool>& leaves);
  std::vector<bool> change_capacities(std::span<const RowState> added);
  void append(std::span<const RowState> added);
  void set(Row row, std::span<const std::byte> bytes);

  WorldState& state_;
  Places& places_;
};

}  // namespace troupe::engine
