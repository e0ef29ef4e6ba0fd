#include "sensors/bumper.hpp"

#include "engine/kinds/collision.hpp"
#include "engine/kinds/make_device_kind.hpp"
#include "engine/kinds/sensor_params.hpp"
#include "engine/sensing/sight.hpp"

#include <algorithm>

namespace troupe::sensors {
namespace {

using engine::DeviceBatch;
using engine::DeviceKind;
using engine::Element;

/// One strip, from its right end to its left, body frame, m.
struct Strip {
  Vec2 right, left;
};

/// Returns the nearest body with an outline within `thickness` (m) of a strip (world frame). At equal
/// distances it is the body with the lower id. The result is not valid if there is no such body. Skips the
/// body with the row (index in the state tables) `own` and all bodies that move with this body.
BodyId felt(const engine::SensingView& view, Row own, const Strip& strip, double thickness) {
  Box box;
  box.extend(strip.right);
  box.extend(strip.left);
  BodyId nearest;
  double least = thickness;
  const auto any = [](const partition::BodyCircle&) { return true; };
  const auto touch = [&](const engine::OutlineChain& chain) {
    engine::for_each_edge(chain, [&](const Vec2& a, const Vec2& b) {
      const double away = segment_distance(strip.right, strip.left, a, b);
      if (away > least || (away == least && nearest < chain.body)) return;
      least = away;
      nearest = chain.body;
    });
  };
  engine::for_each_fixed_chain(view, box.expanded(thickness), any, touch);
  engine::for_each_body_chain(view, box.expanded(thickness), own, any, touch);
  return nearest;
}

struct Bumper {
  using Params = engine::BumperParams;

  std::vector<Strip> strips;
  double thickness = 0;
  bool crashes = false;

  static DeviceKind::Prepared prepare(const Params& params, const Pose& pose_body_sensor) {
    Bumper bumper{.thickness = params.thickness, .crashes = params.crashes};
    double reach = 0;
    for (const engine::BumperStripParams& strip : params.bumpers) {
      const Pose pose = compose(pose_body_sensor, strip.pose);
      const Vec2 half = strip.length / 2 * (Rotation(pose.heading) * Vec2::UnitY());
      bumper.strips.push_back({pose.position() - half, pose.position() + half});
      reach = std::max(reach, pose.position().norm() + strip.length / 2);
    }
    const auto n = static_cast<std::uint32_t>(bumper.strips.size());
    std::vector<engine::StateField> percepts{
        {"hit", Element::u8, n, "", "1: a body touches the strip, or has crashed into it"},
        {"body", Element::u32, n, "", "id of the body that touches the strip; 0: none"}};
    if (params.crashes)
      percepts.push_back({.name = "crash",
                          .element = Element::u32,
                          .columns = n,
                          .text = "id of the body that crashed into the strip since the last reading, plus "
                                  "1; 0: none",
                          .sparse = true});
    return {.data = std::move(bumper),
            .percepts = std::move(percepts),
            .reach_m = reach + params.thickness,
            .feels_collisions = params.crashes,
            .watts = 0.1};  // as in Stage
  }

  std::uint64_t sense(const DeviceBatch& batch) const {
    for (std::size_t i = 0; i < batch.rows.size(); ++i) {
      const Row row = batch.rows[i];
      const Transform transform = batch.mount(i).transform;
      const auto hits = batch.state.cell<std::uint8_t>(batch.slot(i), k_bumper_hit);
      const auto bodies = batch.state.cell<std::uint32_t>(batch.slot(i), k_bumper_body);
      for (std::size_t k = 0; k < strips.size(); ++k) {
        const Strip there{transform * strips[k].right, transform * strips[k].left};
        BodyId body = felt(batch.view, row, there, thickness);
        if (crashes) {
          std::uint32_t& crash = batch.state.cell<std::uint32_t>(batch.slot(i), k_bumper_crash)[k];
          if (!body.valid() && crash != 0) body = BodyId(crash - 1);
          crash = 0;
        }
        hits[k] = body.valid();
        bodies[k] = body.valid() ? body.value : 0;
      }
    }
    return 0;
  }

  void collide(const DeviceBatch& batch, const engine::Collision& collision) const {
    const Transform transform = batch.mount(0).transform;
    const auto crash = batch.state.cell<std::uint32_t>(batch.slot(0), k_bumper_crash);
    for (std::size_t k = 0; k < strips.size(); ++k)
      if (crash[k] == 0 &&
          collision.reaches(transform * strips[k].right, transform * strips[k].left, thickness))
        crash[k] = collision.other().value + 1;
  }
};

}  // namespace

DeviceKind bumper_kind() {
  return engine::make_device_kind<Bumper>("bumper", "detects bodies that touch its contact strips");
}

}  // namespace troupe::sensors
