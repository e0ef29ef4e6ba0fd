#include "models/devices/spawner.hpp"

#include "base/math.hpp"
#include "engine/kinds/make_device_kind.hpp"
#include "engine/links/effect_views.hpp"
#include "engine/spec/ticks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

namespace troupe::models {
namespace {

using engine::BirthStatus;
using engine::BodyType;
using engine::DeviceBatch;
using engine::DeviceKind;
using engine::Mount;

/// Number of periods of `every_s` seconds that have ended since the spawner last ran. The first period begins
/// with the birth of the spawner's body, in `row`. own_period: number of ticks since the spawner last ran.
/// Shorter periods than a tick count as a tick, because a spawner tries at most one birth per tick.
std::uint64_t periods_ended(const engine::SensingView& view, Row row, std::uint64_t own_period,
                            double every_s) {
  const std::uint64_t age = view.tick() - view.birth_tick(row);
  const auto ended_at = [&](std::uint64_t ticks) {
    return engine::ticks_within(static_cast<double>(ticks) * view.tick_s(), std::max(every_s, view.tick_s()));
  };
  return ended_at(age) - ended_at(age - std::min(age, own_period));
}

/// Number of births that a controller has requested by changing SpawnerCommand::request from `before` to
/// `now`: none if it has lowered the number. After 2^32 - 1, the numbers continue with 0.
std::uint32_t births_requested(std::uint32_t before, std::uint32_t now) {
  const std::uint32_t more = now - before;
  return more < 0x80000000u ? more : 0;
}

/// Number of flags that body i of the batch, of the given type, has received from other bodies since its
/// birth.
std::uint64_t flags_received(const DeviceBatch& batch, const BodyType& type, std::size_t i) {
  std::uint64_t sum = 0;
  for (std::size_t d = 0; d < type.devices.size(); ++d)
    if (const auto flags = type.devices[d].kind->flags)
      sum += flags(batch.percepts(d), batch.slot(i)).received;
  return sum;
}

struct Spawner {
  struct Params {
    std::string population;
    double every = 0;
    std::int64_t per_flags = 0;
    double within = 0;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      using enum engine::Unit;
      d.member<&Params::population>(
          "population",
          "name of the population whose bodies are spawned; the population must have a reserve of "
          "unborn bodies (key `reserve`)");
      d.member<&Params::every>("every", seconds, at_least(0), at_most(engine::k_most_seconds),
                               "time from one birth to the next; 0: no periodic births");
      d.member<&Params::per_flags>(
          "per_flags", at_least(0), at_most(1e9),
          "number of flags that other bodies must give to the spawner's body for each birth; 0: flags cause "
          "no births");
      d.member<&Params::within>("within", meters, at_least(0), at_most(1000),
                                "bodies are born at random poses within this distance of the spawner; 0: at "
                                "the pose of the spawner");
    }
  };
  using State = SpawnerState;
  using Command = SpawnerCommand;

  Params params;
  Mount mount_body_spawner;
  std::uint32_t reserve = 0;  // index into WorldSpec::reserves

  static DeviceKind::Prepared prepare(const Params& params, const Pose& pose_body_spawner) {
    return {.data = Spawner{params, Mount(pose_body_spawner)}, .most_effects = 1};
  }

  Result<> bind_part(const engine::TypeSpec& type, std::uint32_t) const {
    if (params.per_flags == 0) return {};
    const bool has_flags = std::ranges::any_of(
        type.devices, [](const engine::DeviceSpec& device) { return device.kind == "flags"; });
    if (has_flags) return {};
    return Error{
        "has \"per_flags\", which counts flags, but its body has no device of kind \"flags\": add such a "
        "device, or remove \"per_flags\""};
  }

  Result<> bind_world(const engine::WorldSpec& world) {
    const auto found = std::ranges::find(world.reserves, params.population, &engine::ReserveSpec::population);
    if (found != world.reserves.end()) {
      reserve = static_cast<std::uint32_t>(found - world.reserves.begin());
      return {};
    }
    std::vector<std::string_view> known;
    for (const engine::ReserveSpec& other : world.reserves) known.push_back(other.population);
    if (known.empty())
      return Error{
          fmt::format("spawns \"{}\", but no population of this world has a \"reserve\": give this "
                      "population a \"reserve\"",
                      params.population)};
    return Error{
        fmt::format("refers to an {}", unknown_name("population with a reserve", params.population, known))};
  }

  Pose place(const DeviceBatch& batch, std::size_t i) const {
    const Mount frame = compose(batch.mount(i), mount_body_spawner);
    if (!(params.within > 0)) return frame.pose();
    Random random = batch.random(i);
    const double radius = params.within * sqrt(random.uniform());
    const SinCos at = sincos(random.uniform(-k_pi, k_pi));
    const Pose drawn{radius * at.cos, radius * at.sin, 0, random.uniform(-k_pi, k_pi)};
    return compose(frame, Mount(drawn)).pose();
  }

  void act(const DeviceBatch& batch) const {
    const BodyType& type = batch.view.type(batch.rows.front());
    for (std::size_t i = 0; i < batch.rows.size(); ++i) {
      auto& state = batch.state.as<SpawnerState>(batch.slot(i));
      const std::uint32_t request = batch.commands->as<SpawnerCommand>(batch.slot(i)).request;
      std::uint64_t due = births_requested(state.request, request);
      state.request = request;
      if (params.every > 0)
        due += periods_ended(batch.view, batch.rows[i], type.devices[batch.device].period, params.every);
      const std::uint64_t received = flags_received(batch, type, i);
      if (const auto per_flags = static_cast<std::uint64_t>(params.per_flags); per_flags > 0) {
        const std::uint64_t counted = received - state.uncounted;
        due += counted / per_flags - state.flags / per_flags;
        state.flags = counted;
      } else {
        state.uncounted = received - state.flags;
      }
      // A birth is tried even if the last one found the reserve used up: since then, an intervention may have
      // given the spawner another population.
      state.owed += static_cast<std::uint32_t>(due);
      if (state.owed > 0) batch.emit_birth(i, 0, reserve, place(batch, i));
    }
  }

  void born(engine::OwnDevice own, const engine::Effect&, const engine::Birth& birth) const {
    auto& state = own.state<SpawnerState>();
    state.status = static_cast<std::uint8_t>(birth.status);
    switch (birth.status) {
      case BirthStatus::born:
        ++state.born;
        --state.owed;
        state.last = birth.body.value + 1;
        break;
      case BirthStatus::occupied: ++state.refused; break;
      case BirthStatus::used_up: state.owed = 0; break;
      case BirthStatus::unasked: break;
    }
  }
};

}  // namespace

DeviceKind spawner_kind() {
  return engine::make_device_kind<Spawner>("spawner", "spawns bodies from the reserve of a population");
}

}  // namespace troupe::models
