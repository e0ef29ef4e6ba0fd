#pragma once

#include "engine/rows/placed_rows.hpp"
#include "engine/sensing/sensing_view.hpp"
#include "engine/spec/body_names.hpp"
#include "partition/parallel.hpp"

#include <span>
#include <string_view>

namespace troupe::engine {

class World;

/// What measures read of a world between two steps: the state of all bodies, which they cannot change. The
/// object is valid until the next change of the world.
class MeasuredWorld : public CommittedView {
 public:
  /// The arguments must outlive the object.
  MeasuredWorld(World& world, const CommittedView& view, partition::Parallel& parallel,
                const BodyNames& names, std::span<const Placed> placed)
      : CommittedView(view), world_(world), parallel_(parallel), names_(names), placed_(placed) {}

  partition::Parallel& parallel() const { return parallel_; }  ///< the worker threads of the world
  /// The body with this name, also an unborn or dead one; see BodyNames::find().
  BodyId find(std::string_view name) const { return names_.find(name); }
  /// The bodies that were placed before the motions of the last step: see Places::placed_before_step().
  std::span<const Placed> placed_before_step() const { return placed_; }

 private:
  friend World& whole_world(const MeasuredWorld& measured);
  World& world_;
  partition::Parallel& parallel_;
  const BodyNames& names_;
  std::span<const Placed> placed_;
};

}  // namespace troupe::engine
