#include "models/devices/brush.hpp"

#include "engine/kinds/make_device_kind.hpp"
#include "engine/links/effect_views.hpp"
#include "engine/sensing/shown_color.hpp"
#include "sensors/ground.hpp"

#include <algorithm>

namespace troupe::models {
namespace {

using engine::BodyType;
using engine::DeviceBatch;
using engine::DeviceKind;

struct Brush {
  using Params = sensors::GroundParams;
  using State = BrushState;
  using Command = BrushCommand;

  static constexpr engine::ApplyScope scope = engine::ApplyScope::trees;

  sensors::Ground ground;
  Vec2 point;  // position of the brush, in the frame of the body or of its joint

  static DeviceKind::Prepared prepare(const Params& params, const Pose& pose_body_brush) {
    return {.data = Brush{sensors::Ground(params), pose_body_brush.position()},
            .reach_m = pose_body_brush.position().norm(),
            .cell_hint_m = 0,
            .most_effects = 1};
  }

  Result<> bind_world(const engine::WorldSpec& world) {
    ground.collect(world);
    return {};
  }

  void act(const DeviceBatch& batch) const {
    for (std::size_t i = 0; i < batch.rows.size(); ++i) {
      const auto& command = batch.commands->as<BrushCommand>(batch.slot(i));
      if (command.paints == 0) continue;
      const sensors::Ground::Zone zone =
          ground.below(batch.view, batch.rows[i], batch.mount(i).transform * point);
      if (!zone.body.valid() || !batch.view.row(zone.body).valid()) continue;
      if (engine::color_device(batch.view.type(batch.view.row(zone.body)), zone.part) == nullptr) continue;
      batch.emit(i, 0, zone.part, zone.body, {command.red, command.green, command.blue});
    }
  }

  /// Paints a zone: a part of the body effect.target. effect.verb is the index of this part, and
  /// effect.payload holds the colour (red, green, blue).
  void apply(engine::DeviceExchange bodies, const engine::Effect& effect) const {
    const BodyType::Device* device = engine::color_device(bodies.target_type(), effect.verb);
    const auto shown = bodies.table_of(*device).cell<float>(bodies.target_slot(), 0);
    bool is_new = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const double given = effect.payload[k];
      const auto part = given > 0 ? static_cast<float>(std::min(given, 1.0)) : 0.0f;
      is_new = is_new || shown[k] != part;
      shown[k] = part;
    }
    bodies.state<BrushState>().painted += is_new;
  }
};

}  // namespace

DeviceKind brush_kind() {
  return engine::make_device_kind<Brush>(
      "brush", "paints the zone (a flat coloured body) below it, if the zone carries an `led`");
}

}  // namespace troupe::models
