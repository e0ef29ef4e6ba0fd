#include "models/devices/remover.hpp"

#include "engine/kinds/make_device_kind.hpp"
#include "engine/sensing/sensing_view.hpp"
#include "models/devices/lowest.hpp"

#include <fmt/format.h>

#include <string>
#include <vector>

namespace troupe::models {
namespace {

using engine::DeviceBatch;
using engine::DeviceKind;
using engine::Mount;
using engine::SensingView;

struct Remover {
  struct Params {
    double radius = 0.5;
    std::string of;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      d.member<&Params::radius>("radius", engine::Unit::meters, above(0), at_most(1000),
                                "a body dies when its origin is within this distance of the remover");
      d.member<&Params::of>("of",
                            "only bodies of this type are removed, whether or not they have a drive; empty: "
                            "all bodies that have a drive are removed");
    }
  };
  using State = RemoverState;

  Params params;
  Mount place;  // pose of the remover in the frame of its body, or of the joint that it is mounted on
  std::vector<std::uint8_t> types = {};  // per TypeId, 1: bodies of this type are removed; empty: all robots

  static DeviceKind::Prepared prepare(const Params& params, const Pose& pose_body_remover) {
    return {.data = Remover{params, Mount(pose_body_remover)},
            .reach_m = pose_body_remover.position().norm() + params.radius,
            .cell_hint_m = params.radius,
            .most_effects = k_most_removed,
            .ends_lives = true};
  }

  Result<> bind_world(const engine::WorldSpec& world) {
    if (params.of.empty()) return {};
    types.assign(world.types.size(), 0);
    std::vector<std::string_view> known;
    bool is_known = false;
    bool has_rows = false;  // bodies without rows are static and cannot die
    for (std::size_t t = 0; t < world.types.size(); ++t) {
      if (TypeId(t) == world.bodies.front().type) continue;  // the ground
      known.push_back(world.types[t].name);
      types[t] = world.types[t].name == params.of;
      if (types[t] == 0) continue;
      is_known = true;
      const engine::TypeSpec& type = world.types[t];
      has_rows = has_rows || !engine::is_static(type) || !type.devices.empty() || !type.controllers.empty();
    }
    if (has_rows) return {};
    if (is_known)
      return Error{
          fmt::format("would remove bodies of the type \"{}\", which are static: only bodies that can move, "
                      "sense, decide, be gripped or be pushed can be removed",
                      params.of)};
    return Error{fmt::format("refers to an {}", unknown_name("type", params.of, known))};
  }

  bool takes(const SensingView& view, Row row) const {
    const engine::BodyType& type = view.type(row);
    const auto index = static_cast<std::size_t>(&type - view.types().data());
    const bool fits = types.empty() ? type.drive.has_value() : types[index] != 0;
    return fits && !view.carrier(row);
  }

  void act(const DeviceBatch& batch) const {
    const SensingView& view = batch.view;
    for (std::size_t i = 0; i < batch.rows.size(); ++i) {
      const Vec2 at = compose(batch.mount(i), place).transform.position;
      Lowest<BodyId, k_most_removed> found;
      view.index().for_each_near(Box::around(at, params.radius), [&](const partition::BodyCircle& circle) {
        const Row row(circle.row);
        if (row == batch.rows[i]) return;
        if ((view.transform(row).position - at).squaredNorm() > params.radius * params.radius) return;
        if (takes(view, row)) found.add(view.body(row));
      });
      std::uint32_t sequence = 0;
      for (const BodyId body : found.list()) batch.emit_death(i, sequence++, body);
      batch.state.as<RemoverState>(batch.slot(i)).removed += found.list().size();
    }
  }
};

}  // namespace

DeviceKind remover_kind() {
  return engine::make_device_kind<Remover>("remover", "removes from the world the bodies that come near it");
}

}  // namespace troupe::models
