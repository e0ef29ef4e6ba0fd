#pragma once

#include "engine/fields/state_table.hpp"
#include "engine/kinds/effects.hpp"
#include "engine/sensing/sensing_view.hpp"
#include "engine/spec/body_type.hpp"

#include <cstddef>
#include <cstdint>

namespace troupe::engine {

class Links;
struct WorldState;

/// The world in which an effect is applied. The hooks DeviceKind::apply and DeviceKind::born pass it to one
/// of the views below, which say what the kind may see and change. Nothing else is accessible.
class EffectContext {
 public:
  /// The arguments must outlive the object.
  EffectContext(WorldState& state, Links& links, const Effect& effect)
      : state_(state), links_(links), effect_(effect) {}
  EffectContext(const EffectContext&) = delete;
  EffectContext& operator=(const EffectContext&) = delete;

 private:
  friend class OwnDevice;
  friend class DeviceExchange;
  friend class Gripping;
  WorldState& state_;
  Links& links_;
  const Effect& effect_;
};

/// The device that has emitted an effect: its state, which a kind may change.
class OwnDevice {
 public:
  /// A view of the effect that is being applied. The context must outlive the object, here and in the classes
  /// below.
  explicit OwnDevice(const EffectContext& context);

  Row row() const { return row_; }                             ///< row of its body
  const BodyType::Device& device() const { return *device_; }  ///< the device
  StateTable& table() const { return *table_; }                ///< its state table
  std::size_t slot() const { return slot_; }                   ///< row of its state in table()
  /// Its state as a struct, whose members must be the fields of the state.
  template <class State>
  State& state() const {
    return table_->as<State>(slot_);
  }

 protected:
  const CommittedView& view() const;
  const EffectContext& context_;

 private:
  Row row_;
  const BodyType::Device* device_;
  StateTable* table_;
  std::size_t slot_;
};

/// The devices of the bodies between which an effect acts: their states, which a kind may change. The effect
/// has a *target*, the body Effect::target.
class DeviceExchange : public OwnDevice {
 public:
  using OwnDevice::OwnDevice;  ///< as OwnDevice

  const BodyType& own_type() const;  ///< type of the body of the device
  /// Whether the target is a body with a row that is in the world. The functions below may be called only
  /// then.
  bool has_target() const;
  const BodyType& target_type() const;  ///< type of the target
  std::size_t target_slot() const;      ///< slot of the target
  /// State table of a device of the own type or of the target's type.
  StateTable& table_of(const BodyType::Device& device) const;
};

/// The body that a device grips or releases.
class Gripping : public OwnDevice {
 public:
  using OwnDevice::OwnDevice;  ///< as OwnDevice
  using OwnDevice::view;       ///< the present state of all bodies

  /// Row of the target; not valid() if there is no such body, or if it has no row.
  Row target() const;
  /// Attaches the target to the body of the device. From then on, it keeps its present pose relative to the
  /// joint with the index `joint` in BodyType::joints; if `joint` is k_rigid, relative to the body itself.
  /// Both bodies must be in the world. Throws std::logic_error if the kind does not set
  /// DeviceKind::carries, because the effects on trees that may change are applied in groups if the rows are
  /// distributed among ranks (SharedEffects). Returns false and changes nothing in the cases of
  /// Links::attach().
  bool attach(std::int32_t joint) const;
  /// Detaches the target from its carrier; its pose stays. Does nothing if it is not carried. Throws as
  /// attach() does.
  void release() const;
};

}  // namespace troupe::engine
