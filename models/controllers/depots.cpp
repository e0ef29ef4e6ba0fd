#include "models/controllers/depots.hpp"

#include "engine/kinds/controller.hpp"
#include "models/controllers/device_choice.hpp"
#include "models/devices/flags.hpp"

#include <array>

namespace troupe::models {
namespace {

using engine::DeviceInfo;

Result<std::vector<std::size_t>> choose_flags(std::span<const DeviceInfo> devices,
                                              std::vector<bool>& claimed) {
  DeviceChoice choice(devices, claimed);
  if (!choice.take_kind("flags")) return choice.missing("flags", "needs a device of kind \"flags\"");
  return choice.chosen();
}

struct Source {
  static constexpr bool needs_drive = false;
  static constexpr std::array<std::string_view, 1> brings{"flags"};
  struct Params {
    std::uint32_t capacity = 1;
    std::int64_t unused = 0;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      d.member<&Params::capacity>("capacity", at_most(1e6),
                                  "number of flags to which the source refills its stock; at most the number "
                                  "that its device `flags` can hold");
      d.member<&Params::unused>(
          "unused", "no effect; accepted because Stage's worlds give this controller a second number");
    }
  };

  Params params;

  Result<std::vector<std::size_t>> choose(std::span<const DeviceInfo> devices, std::vector<bool>& claimed) {
    Result<std::vector<std::size_t>> chosen = choose_flags(devices, claimed);
    // A source creates no more flags than its list can hold.
    if (chosen)
      params.capacity =
          std::min(params.capacity, devices[chosen->front()].prepared.percepts[k_flag_colors].columns);
    return chosen;
  }
  void operator()(const engine::Percept& percept, Random&, engine::Actions& actions) const {
    if (percept.devices[0].field<std::uint32_t>(k_flag_count)[0] < params.capacity)
      actions.device<FlagCommand>(0).ask(FlagCommand::push, 0, k_yellow_flag);
  }
};

struct Sink {
  struct Memory {
    std::uint64_t delivered = 0;  ///< number of flags received since tick 0
    TROUPE_FIELDS(delivered)
  };
  static constexpr bool needs_drive = false;
  static constexpr std::array<std::string_view, 1> brings{"flags"};

  Result<std::vector<std::size_t>> choose(std::span<const DeviceInfo> devices, std::vector<bool>& claimed) {
    return choose_flags(devices, claimed);
  }
  void operator()(Memory& memory, const engine::Percept& percept, Random&, engine::Actions& actions) const {
    memory.delivered = percept.devices[0].field<std::uint64_t>(k_flag_received)[0];
    if (percept.devices[0].field<std::uint32_t>(k_flag_count)[0] > 0)
      actions.device<FlagCommand>(0).ask(FlagCommand::pop);
  }
};

}  // namespace

engine::ControllerKind source_controller() {
  return engine::make_controller_kind<Source>("source", "create flags for robots to fetch");
}

engine::ControllerKind sink_controller() {
  return engine::make_controller_kind<Sink>("sink", "count and remove the flags that robots bring");
}

}  // namespace troupe::models
