#include "models/devices/remover.hpp"

#include "engine/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <vector>

namespace troupe::models {
namespace {

using engine::DeviceBatch;
using engine::DeviceKind;
using engine::FieldType;
using engine::Mount;
using engine::Record;
using engine::Unit;
using engine::World;

struct Remover {
  double radius_m = 0;
  std::string of;
  std::vector<std::uint8_t> types;  // a TypeId each: 1: its bodies are removed; empty: those of any
  Mount mount;                      // its frame in the body's
};

/// The lowest ids of those that come, in whatever order.
class Lowest {
 public:
  void add(BodyId body) {
    BodyId* const place = std::lower_bound(list_.data(), list_.data() + count_, body);
    const auto at = static_cast<std::size_t>(place - list_.data());
    if (at == list_.size()) return;
    count_ = std::min(count_ + 1, list_.size());
    std::move_backward(place, list_.data() + count_ - 1, list_.data() + count_);
    list_[at] = body;
  }
  std::span<const BodyId> list() const { return {list_.data(), count_}; }

 private:
  std::array<BodyId, k_most_removed> list_;
  std::size_t count_ = 0;
};

bool takes(const Remover& remover, const World& world, Row row) {
  const engine::BodyType& type = world.type(row);
  const auto index = static_cast<std::size_t>(&type - world.types().data());
  const bool fits = remover.types.empty() ? type.drive.has_value() : remover.types[index] != 0;
  return fits && !world.carrier(row);
}

void act(const DeviceBatch& batch) {
  const Remover& remover = *std::any_cast<Remover>(&batch.data);
  const World& world = batch.world;
  for (std::size_t i = 0; i < batch.rows.size(); ++i) {
    const Vec2 at = compose(batch.mount(i), remover.mount).transform.position;
    Lowest found;
    world.index().for_each_near(Box::around(at, remover.radius_m), [&](const partition::BodyCircle& circle) {
      const Row row(circle.row);
      if (row == batch.rows[i]) return;
      if ((world.transform(row).position - at).squaredNorm() > remover.radius_m * remover.radius_m) return;
      if (takes(remover, world, row)) found.add(world.body(row));
    });
    std::uint32_t sequence = 0;
    for (const BodyId body : found.list()) batch.emit_death(i, sequence++, body);
    batch.state.as<RemoverState>(batch.slot(i)).removed += found.list().size();
  }
}

Result<> look(std::any& data, const engine::WorldSpec& world) {
  auto& remover = *std::any_cast<Remover>(&data);
  if (remover.of.empty()) return {};
  remover.types.assign(world.types.size(), 0);
  std::vector<std::string_view> known;
  bool is_known = false;
  for (std::size_t t = 0; t < world.types.size(); ++t) {
    if (world.types[t].name == "ground") continue;
    known.push_back(world.types[t].name);
    remover.types[t] = world.types[t].name == remover.of;
    is_known = is_known || remover.types[t] != 0;
  }
  if (is_known) return {};
  return Error{fmt::format("removes {}", unknown_name("type", remover.of, known))};
}

}  // namespace

DeviceKind remover_kind() {
  DeviceKind kind{.name = "remover", .text = "ends the lives of bodies that come to it"};
  kind.params = {{
      {.name = "radius",
       .unit = Unit::meters,
       .fallback = 0.5,
       .min = 0,
       .max = 1000,
       .text = "who comes this near, with its origin, dies",
       .above_min = true},
      {.name = "of",
       .type = FieldType::text,
       .fallback = "",
       .text = "bodies of the type of this name, robots or not; empty: robots of any"},
  }};
  kind.prepare = [](const Record& params, const Pose& pose_body_remover) {
    const Remover remover{.radius_m = params[0].number(),
                          .of = params[1].text(),
                          .types = {},
                          .mount = Mount(pose_body_remover)};
    return DeviceKind::Prepared{.data = remover,
                                .percepts = engine::memory_fields<RemoverState>(),
                                .percept_bytes = sizeof(RemoverState),
                                .reach_m = remover.radius_m,
                                .most_effects = k_most_removed,
                                .ends_lives = true};
  };
  kind.look = look;
  kind.act = act;
  return kind;
}

}  // namespace troupe::models
