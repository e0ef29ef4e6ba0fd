#include "engine/kinds/energy.hpp"
#include "engine/kinds/make_device_kind.hpp"
#include "engine/links/effect_views.hpp"
#include "engine/observing/lint_view.hpp"
#include "models/devices/lowest.hpp"
#include "models/devices/power.hpp"
#include "partition/closeness.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <any>
#include <set>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace troupe::models {
namespace {

using engine::BodyType;
using engine::DeviceBatch;
using engine::DeviceKind;
using engine::Effect;
using engine::SensingView;
using partition::PlacedShape;

struct PowerContact {
  struct Params {
    double give = 0;
    double take = 0;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      using enum engine::Unit;
      d.member<&Params::give>(
          "give", watts, within(0, engine::k_most_watts),
          "greatest power that this contact gives to each taking contact that it touches; 0: it gives none");
      d.member<&Params::take>("take", watts, within(0, engine::k_most_watts),
                              "greatest power that this contact takes from each giving contact that touches "
                              "it; 0: it takes none");
    }
  };
  using State = PowerContactState;
  static constexpr bool needs_supply = true;
  static constexpr engine::ApplyScope scope = engine::ApplyScope::trees;

  Params params;
  partition::ObstacleShape shape = {};  ///< shape of the part that carries the contact, body frame

  static DeviceKind::Prepared prepare(const Params& params, const Pose&) {
    return {
        .data = PowerContact{params}, .cell_hint_m = 0, .most_effects = params.give > 0 ? k_most_takers : 0};
  }
  Result<> bind_part(const engine::TypeSpec& type, std::uint32_t part);
  double reach_m() const { return shape.radius + k_contact_m; }
  void act(const DeviceBatch& batch) const;
  void apply(engine::DeviceExchange bodies, const Effect& effect) const;
  void lint(const engine::LintView& view) const;
};

const PowerContact* as_contact(const BodyType::Device& device) {
  return std::any_cast<PowerContact>(&device.prepared.data);
}

/// A taking contact that is touched: its body, and its index among the devices of that body.
struct Taker {
  BodyId body;
  std::size_t device = 0;
  auto operator<=>(const Taker&) const = default;
};

/// The takers that a giving contact touches, in ascending order of body id and device index.
using Takers = Lowest<Taker, k_most_takers>;

/// Adds to `takers` the taking contacts of the body in row `other` that touch `giver`, the shape of the
/// giving contact.
void add_touched(const SensingView& view, const PlacedShape& giver, Row other, Takers& takers) {
  const BodyType& type = view.type(other);
  for (std::size_t d = 0; d < type.devices.size(); ++d) {
    const PowerContact* contact = as_contact(type.devices[d]);
    if (!contact || !(contact->params.take > 0) || !type.devices[d].supply || contact->shape.empty())
      continue;
    const PlacedShape shape(contact->shape, view.mount(other, type.devices[d].joint).transform, 0);
    if (partition::come_within(giver, shape, k_contact_m)) takers.add({view.body(other), d});
  }
}

Result<> PowerContact::bind_part(const engine::TypeSpec& type, std::uint32_t part) {
  std::vector<ConvexPrism> pieces;
  try {
    for (const Solid& solid : type.parts[part].solids)
      for (ConvexPrism& piece : convex_pieces(solid)) pieces.push_back(std::move(piece));
  } catch (const std::length_error& error) {
    return Error{error.what()};
  }
  shape = partition::make_obstacle_shape(pieces);
  return {};
}

/// Finds the taking contacts that each giving contact touches, by the poses at the end of the last tick, and
/// emits one effect for each of them. apply() computes the energies, one effect after another, because each
/// transfer changes what the packs hold for the next one.
void PowerContact::act(const DeviceBatch& batch) const {
  if (!(params.give > 0) || shape.empty()) return;
  const SensingView& view = batch.view;
  for (std::size_t i = 0; i < batch.rows.size(); ++i) {
    const Row row = batch.rows[i];
    const Transform at = batch.mount(i).transform;
    const PlacedShape placed(shape, at, 0);
    Takers takers;
    view.index().for_each_near(Box::around(placed.position(), shape.radius + k_contact_m),
                               [&](const partition::BodyCircle& circle) {
                                 if (const Row other(circle.row); !view.same_tree(other, row))
                                   add_touched(view, placed, other, takers);
                               });
    batch.state.as<State>(batch.slot(i)).touched = static_cast<std::uint8_t>(takers.list().size());
    std::uint32_t sequence = 0;
    for (const Taker& taker : takers.list())
      batch.emit(i, sequence++, 0, taker.body, {static_cast<double>(taker.device), batch.period_s});
  }
}

void PowerContact::apply(engine::DeviceExchange bodies, const Effect& effect) const {
  const std::vector<BodyType::Device>& devices = bodies.target_type().devices;
  const BodyType::Device& taking = devices[static_cast<std::size_t>(effect.payload[0])];
  const BodyType::Device& own_pack = bodies.own_type().devices[*bodies.device().supply];
  auto& giver = bodies.table_of(own_pack).as<PowerPackState>(bodies.slot());
  auto& taker = bodies.table_of(devices[*taking.supply]).as<PowerPackState>(bodies.target_slot());
  if (taker.infinite != 0) return;
  const double watts = std::min(params.give, as_contact(taking)->params.take);
  double joules = std::min(watts * effect.payload[1], taker.capacity - taker.stored);
  if (giver.infinite == 0) joules = std::min(joules, giver.stored);
  if (!(joules > 0)) return;
  if (giver.infinite == 0) giver.stored -= joules;
  giver.given += joules;
  taker.stored += joules;
  taker.received += joules;
  taker.charging = 1;
}

/// The types with contacts that give, and with contacts that take or may take after an intervention.
struct Exchange {
  std::vector<std::uint32_t> givers;
  std::vector<std::uint32_t> takers;
  std::set<std::uint32_t> changed;  // types with parameters that interventions change, such as `take`

  explicit Exchange(const engine::LintWorld& world) {
    for (const engine::InterventionSpec& at : world.spec.experiment.at)
      if (at.setting) changed.insert(at.setting->type.value);
    world.for_devices<PowerContact>([&](std::uint32_t type, std::size_t, const PowerContact& contact) {
      if (contact.params.give > 0) givers.push_back(type);
      if (takes(contact, type)) takers.push_back(type);
    });
  }
  bool takes(const PowerContact& contact, std::uint32_t type) const {
    return contact.params.take > 0 || changed.contains(type);
  }
};

/// Warns if the contact can exchange no energy.
void PowerContact::lint(const engine::LintView& view) const {
  const Exchange& exchange = view.world.shared<Exchange>();
  const bool gives = params.give > 0;
  const bool takes = exchange.takes(*this, view.type);
  std::string_view why;
  if (!gives && !takes)
    why = "it has neither \"give_W\" nor \"take_W\"";
  else if (shape.empty())
    why =
        "the part that carries it has no shape, so that nothing touches it: give the part a size, or mount "
        "the contact on another part";
  else if (!(gives && view.has_other_of(exchange.takers)) && !(takes && view.has_other_of(exchange.givers)))
    why = gives && takes ? "no other body has a power contact"
          : gives        ? "no other body has a power contact with \"take_W\""
                         : "no other body has a power contact with \"give_W\"";
  if (!why.empty())
    view.warn(engine::LintTopic::charging,
              fmt::format(
                  "{} exchanges no energy: {}",
                  engine::device_text("power contact", view.device_spec().name, view.type_spec().name), why));
}

}  // namespace

DeviceKind power_contact_kind() {
  return engine::make_device_kind<PowerContact>(
      "power_contact", "a contact through which the power packs of touching bodies exchange energy");
}

}  // namespace troupe::models
