#include "engine/kinds/energy.hpp"
#include "engine/kinds/make_device_kind.hpp"
#include "engine/links/effect_views.hpp"
#include "engine/observing/lint_view.hpp"
#include "models/devices/power.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace troupe::models {
namespace {

using engine::BodyType;
using engine::DeviceBatch;
using engine::DeviceKind;

// Verb of an effect that a pack emits on itself in each tick in which `charging` is 1. The payload is the
// energy received so far. apply() clears `charging` if no transfer has increased that energy since; a
// transfer that is applied later in the tick sets `charging` again. act() cannot clear it: controllers run
// after act() and must still read the state of the last tick.
constexpr std::uint32_t k_ask_whether_charging = 0;

constexpr double k_watts_per_kg = 10;  // W per kg and per m/s or rad/s, as in Stage's position model

enum class WhenEmpty : std::uint8_t { stop, nothing, die };
constexpr std::array<std::string_view, 3> names_of(WhenEmpty) { return {"stop", "nothing", "die"}; }

struct PowerPack {
  using State = PowerPackState;

  struct Params {
    double capacity = 0;
    double stored = k_most_joules;
    bool infinite = false;
    double draw = 0;
    double mass = 0;
    double idle = 1;
    WhenEmpty when_empty = WhenEmpty::stop;

    static constexpr double k_most_joules = 1e12;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      using enum engine::Unit;
      d.member<&Params::capacity>("capacity", joules, within(0, k_most_joules), fixed,
                                  "greatest energy that the pack can hold");
      d.member<&Params::stored>(
          "stored", joules, within(0, k_most_joules),
          "energy at the start; a value above the capacity, such as the default, means a full pack");
      d.member<&Params::infinite>("infinite", fixed, "true: the pack never runs out and is never charged");
      d.member<&Params::draw>(
          "draw", watts, within(0, engine::k_most_watts),
          "constant power drawn from the pack, in addition to what the drive and the devices draw");
      d.member<&Params::mass>(
          "mass", kilograms, within(0, engine::k_most_mass_kg),
          "mass that the drive moves; the drive draws 10 W per kg and per m/s or rad/s of "
          "its speeds, in addition to `idle`");
      d.member<&Params::idle>("idle", watts, within(0, engine::k_most_watts),
                              "power that the drive draws at any speed, also at rest");
      d.member<&Params::when_empty>(
          "when_empty",
          "effect of an empty pack. stop: everything that it supplies stops; nothing: no effect, as in "
          "Stage; die: everything that it supplies stops, and its body dies (docs/lives.md)");
    }
  };

  static constexpr engine::ApplyScope scope = engine::ApplyScope::trees;

  Params params;

  static DeviceKind::Prepared prepare(const Params& params, const Pose&) {
    const bool kills = params.when_empty == WhenEmpty::die;
    return {.data = PowerPack{params}, .most_effects = kills ? std::size_t{2} : 1, .ends_lives = kills};
  }

  void start(State& row) const {
    row.infinite = params.infinite;
    if (params.infinite) return;
    row.capacity = params.capacity;
    row.stored = std::min(params.stored, params.capacity);
  }

  /// Power that the drive of a body draws, W. v: the velocity that the drive produces, m/s and rad/s.
  double drive_watts(const engine::Velocity& v) const {
    return params.idle + k_watts_per_kg * params.mass * (std::abs(v.x) + std::abs(v.y) + std::abs(v.turn));
  }

  void act(const DeviceBatch& batch) const {
    const BodyType& type = batch.view.type(batch.rows.front());
    const auto feeds = [&batch](std::optional<std::size_t> supply) { return supply == batch.device; };
    const bool feeds_drive = type.drive && feeds(type.drive->supply);
    for (std::size_t i = 0; i < batch.rows.size(); ++i) {
      auto& state = batch.state.as<PowerPackState>(batch.slot(i));
      if (state.charging != 0) batch.emit(i, 0, k_ask_whether_charging, batch.body(i), {state.received});
      if (params.when_empty == WhenEmpty::die && state.is_empty()) batch.emit_death(i, 1, batch.body(i));
      double watts = params.draw;
      if (feeds_drive) watts += drive_watts(batch.velocity(i));
      for (std::size_t d = 0; d < type.devices.size(); ++d)
        if (feeds(type.devices[d].supply) && batch.senses(i, d) && batch.is_on(i, d))
          watts += type.devices[d].prepared.watts;
      double joules = watts * batch.period_s;
      if (!params.infinite) {
        joules = std::min(joules, state.stored);
        state.stored -= joules;
      }
      state.dissipated += joules;
    }
  }

  void apply(engine::OwnDevice own, const engine::Effect& effect) const {
    auto& state = own.state<State>();
    state.charging = state.received > effect.payload[0];
  }

  bool is_spent(const State& state) const {
    return params.when_empty != WhenEmpty::nothing && state.is_empty();
  }
  static engine::Energy energy(const State& state) {
    return {state.stored, state.capacity,      state.dissipated,   state.received,
            state.given,  state.infinite != 0, state.charging != 0};
  }

  /// Warns if the pack can hold no energy and therefore stops everything that it supplies.
  void lint(const engine::LintView& view) const {
    if (params.infinite || params.capacity > 0 || params.when_empty == WhenEmpty::nothing) return;
    const std::string& name = view.device().name;
    const std::string& type = view.body_type().name;
    view.warn(engine::LintTopic::energy,
              fmt::format("{} can hold no energy: its capacity is 0 J, so everything that it supplies is "
                          "stopped for the whole run",
                          name.empty() ? engine::device_text(view.device().kind->name, name, type)
                                       : fmt::format("\"{}\" of \"{}\"", name, type)));
  }
};

}  // namespace

DeviceKind power_pack_kind() {
  return engine::make_device_kind<PowerPack>(
      "power_pack",
      "an energy store that supplies the part that carries it and the parts mounted on that part");
}

}  // namespace troupe::models
