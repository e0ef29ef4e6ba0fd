#include "engine/links/effect_views.hpp"

#include "engine/links/links.hpp"
#include "engine/state/world_state.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <string_view>

namespace troupe::engine {
namespace {

/// Throws std::logic_error if the kind of the device does not declare that it can carry bodies. If it changed
/// a tree, distributed ranks would apply later effects on the tree to an old state of it (SharedEffects).
/// call: the function that its hook has called
void require_carries(const BodyType::Device& device, std::string_view call) {
  if (!device.kind->carries)
    throw std::logic_error(
        fmt::format("Gripping::{} was called by a kind that does not declare that it can carry bodies: set "
                    "DeviceKind::carries to true",
                    call));
}

}  // namespace

OwnDevice::OwnDevice(const EffectContext& context)
    : context_(context),
      row_(context.state_.view.row(context.effect_.source)),
      device_(&context.state_.type(row_).devices[context.effect_.device]),
      table_(&context.state_.tables[device_->table]),
      slot_(context.state_.slots[row_.index()]) {}

const CommittedView& OwnDevice::view() const { return context_.state_.view; }

const BodyType& DeviceExchange::own_type() const { return view().type(row()); }

bool DeviceExchange::has_target() const {
  const BodyId target = context_.effect_.target;
  if (target.index() >= context_.state_.rows.size() || !view().row(target).valid()) return false;
  return view().is_there(view().row(target));
}

const BodyType& DeviceExchange::target_type() const {
  return view().type(view().row(context_.effect_.target));
}

std::size_t DeviceExchange::target_slot() const { return view().slot(view().row(context_.effect_.target)); }

StateTable& DeviceExchange::table_of(const BodyType::Device& device) const {
  return context_.state_.tables[device.table];
}

Row Gripping::target() const {
  const BodyId target = context_.effect_.target;
  return target.index() < context_.state_.rows.size() ? view().row(target) : Row();
}

bool Gripping::attach(std::int32_t joint) const {
  require_carries(device(), "attach()");
  return context_.links_.attach(target(), row(), joint);
}

void Gripping::release() const {
  require_carries(device(), "release()");
  context_.links_.release(target());
}

}  // namespace troupe::engine
