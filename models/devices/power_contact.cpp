#include "engine/world.hpp"
#include "models/devices/power.hpp"
#include "partition/closeness.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace troupe::models {
namespace {

using engine::BodyType;
using engine::DeviceBatch;
using engine::DeviceKind;
using engine::Effect;
using engine::Record;
using engine::Unit;
using engine::World;
using partition::PlacedShape;

struct Contact {
  double give = 0;
  double take = 0;
  partition::ObstacleShape shape;  ///< of the part, body frame
};

const Contact* as_contact(const BodyType::Device& device) {
  return std::any_cast<Contact>(&device.prepared.data);
}

/// A contact that is touched: which body's, and which of its devices.
struct Taker {
  BodyId body;
  std::size_t device = 0;
  auto operator<=>(const Taker&) const = default;
};

/// The lowest of those met, in whatever order they come.
class Takers {
 public:
  void add(const Taker& taker) {
    Taker* const place = std::lower_bound(list_.data(), list_.data() + count_, taker);
    const auto at = static_cast<std::size_t>(place - list_.data());
    if (at == list_.size()) return;
    count_ = std::min(count_ + 1, list_.size());
    std::move_backward(place, list_.data() + count_ - 1, list_.data() + count_);
    list_[at] = taker;
  }
  std::span<const Taker> list() const { return {list_.data(), count_}; }

 private:
  std::array<Taker, k_most_takers> list_;
  std::size_t count_ = 0;
};

void add_touched(const World& world, const PlacedShape& giver, Row other, Takers& takers) {
  const BodyType& type = world.type(other);
  for (std::size_t d = 0; d < type.devices.size(); ++d) {
    const Contact* contact = as_contact(type.devices[d]);
    if (!contact || !(contact->take > 0) || !type.devices[d].supply || contact->shape.empty()) continue;
    const PlacedShape shape(contact->shape, world.mount(other, type.devices[d].joint).transform, 0);
    if (partition::come_within(giver, shape, k_contact_m)) takers.add({world.body(other), d});
  }
}

/// Givers look about them: poses are those of the last tick, and what packs hold shows when effects are
/// applied.
void act(const DeviceBatch& batch) {
  const Contact& contact = *std::any_cast<Contact>(&batch.data);
  if (!(contact.give > 0) || contact.shape.empty()) return;
  const World& world = batch.world;
  for (std::size_t i = 0; i < batch.rows.size(); ++i) {
    const Row row = batch.rows[i];
    const Transform at = batch.mount(i).transform;
    const PlacedShape shape(contact.shape, at, 0);
    Takers takers;
    world.index().for_each_near(Box::around(shape.position(), contact.shape.radius + k_contact_m),
                                [&](const partition::BodyCircle& circle) {
                                  if (const Row other(circle.row); !world.same_tree(other, row))
                                    add_touched(world, shape, other, takers);
                                });
    batch.state.as<PowerContactState>(batch.slot(i)).touched =
        static_cast<std::uint8_t>(takers.list().size());
    std::uint32_t sequence = 0;
    for (const Taker& taker : takers.list())
      batch.emit(i, sequence++, 0, taker.body, {static_cast<double>(taker.device), batch.period_s});
  }
}

PowerPackState& pack_of(World& world, Row row, const BodyType::Device& contact) {
  return world.state(world.type(row).devices[*contact.supply]).as<PowerPackState>(world.slot(row));
}

void apply(World& world, const std::any& data, const Effect& effect) {
  const Row giver_row = world.row(effect.source);
  const Row taker_row = world.row(effect.target);
  const BodyType::Device& taking = world.type(taker_row).devices[static_cast<std::size_t>(effect.payload[0])];
  PowerPackState& giver = pack_of(world, giver_row, world.type(giver_row).devices[effect.device]);
  PowerPackState& taker = pack_of(world, taker_row, taking);
  if (taker.infinite != 0) return;
  const double watts = std::min(std::any_cast<Contact>(&data)->give, as_contact(taking)->take);
  double joules = std::min(watts * effect.payload[1], taker.capacity - taker.stored);
  if (giver.infinite == 0) {
    joules = std::min(joules, giver.stored);
    giver.stored -= joules;
  }
  if (!(joules > 0)) return;
  giver.given += joules;
  taker.stored += joules;
  taker.received += joules;
  taker.charging = 1;
}

Result<> mount(std::any& data, const engine::TypeSpec& type, std::uint32_t part) {
  std::vector<ConvexPrism> pieces;
  try {
    for (const Solid& solid : type.parts[part].solids)
      for (ConvexPrism& piece : convex_pieces(solid)) pieces.push_back(std::move(piece));
  } catch (const std::length_error& error) {
    return Error{error.what()};
  }
  std::any_cast<Contact>(&data)->shape = partition::make_obstacle_shape(pieces);
  return {};
}

}  // namespace

DeviceKind power_contact_kind() {
  constexpr double k_most_watts = 1e9;
  DeviceKind kind{.name = "power_contact", .text = "gives energy to, or takes it from, bodies it touches"};
  kind.params = {{
      {.name = "give",
       .unit = Unit::watts,
       .fallback = 0.0,
       .min = 0,
       .max = k_most_watts,
       .text = "at most, to each contact that it touches and that takes"},
      {.name = "take",
       .unit = Unit::watts,
       .fallback = 0.0,
       .min = 0,
       .max = k_most_watts,
       .text = "at most, from each contact that touches it and gives"},
  }};
  kind.prepare = [](const Record& params, const Pose&) {
    const Contact contact{.give = params[0].number(), .take = params[1].number(), .shape = {}};
    return DeviceKind::Prepared{.data = contact,
                                .percepts = engine::memory_fields<PowerContactState>(),
                                .percept_bytes = sizeof(PowerContactState),
                                .most_effects = contact.give > 0 ? k_most_takers : 0};
  };
  kind.mount = mount;
  kind.act = act;
  kind.apply = apply;
  kind.needs_supply = true;
  return kind;
}

}  // namespace troupe::models
