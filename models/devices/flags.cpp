#include "models/devices/flags.hpp"

#include "engine/kinds/make_device_kind.hpp"
#include "engine/links/effect_views.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace troupe::models {
namespace {

using engine::DeviceBatch;
using engine::DeviceKind;
using engine::Effect;
using engine::Element;
using engine::StateTable;

constexpr double k_most_flags = 1000;

/// The list of flags in one row of a state table.
class FlagList {
 public:
  FlagList(StateTable& state, std::size_t slot)
      : received_(state.cell<std::uint64_t>(slot, k_flag_received)[0]),
        count_(state.cell<std::uint32_t>(slot, k_flag_count)[0]),
        colors_(state.cell<std::uint32_t>(slot, k_flag_colors)),
        sizes_(state.cell<float>(slot, k_flag_sizes)) {
    // The count of a checkpoint may be wrong.
    count_ = std::min(count_, static_cast<std::uint32_t>(colors_.size()));
  }

  bool empty() const { return count_ == 0; }
  bool full() const { return count_ == colors_.size(); }
  void push(const Flag& flag) {
    if (full()) return;
    std::move_backward(colors_.begin(), colors_.begin() + count_, colors_.begin() + count_ + 1);
    std::move_backward(sizes_.begin(), sizes_.begin() + count_, sizes_.begin() + count_ + 1);
    colors_[0] = flag.color;
    sizes_[0] = flag.size;
    ++count_;
  }
  Flag pop() {
    if (empty()) return {};
    const Flag first{colors_[0], sizes_[0]};
    std::move(colors_.begin() + 1, colors_.begin() + count_, colors_.begin());
    std::move(sizes_.begin() + 1, sizes_.begin() + count_, sizes_.begin());
    --count_;
    colors_[count_] = 0;
    sizes_[count_] = 0;
    return first;
  }
  void count_received() { ++received_; }

 private:
  std::uint64_t& received_;
  std::uint32_t& count_;
  std::span<std::uint32_t> colors_;
  std::span<float> sizes_;
};

/// The list of flags of the target of an effect: its first device of the same kind. Returns nothing if the
/// target is not in the world or has no such device.
std::optional<FlagList> flags_of_target(const engine::DeviceExchange& bodies) {
  if (!bodies.has_target()) return {};
  for (const engine::BodyType::Device& device : bodies.target_type().devices)
    if (device.kind == bodies.device().kind) return FlagList(bodies.table_of(device), bodies.target_slot());
  return {};
}

struct Flags {
  struct Params {
    std::int64_t most = 16;
    std::int64_t yellow = 0;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      d.member<&Params::most>("most", within(1, k_most_flags),
                              "greatest number of flags that the list can hold");
      d.member<&Params::yellow>("yellow", within(0, k_most_flags),
                                "number of yellow flags, each 0.25 m in size, in the list at the start");
    }
  };
  using Command = FlagCommand;

  static constexpr engine::ApplyScope scope = engine::ApplyScope::any_target;

  Params params;

  static DeviceKind::Prepared prepare(const Params& params, const Pose&) {
    const auto most = static_cast<std::uint32_t>(params.most);
    return {
        .data = Flags{params},
        .percepts = {{"received", Element::u64, 1, "", "number of flags given by other bodies since tick 0"},
                     {"count", Element::u32, 1, "", "number of flags in the list"},
                     {"request", Element::u32, 1, "", "value of `request` in the command that was last read"},
                     {"colors", Element::u32, most, "",
                      "colour of each flag, the first flag first: 0xRRGGBBAA"},
                     {"sizes", Element::f32, most, "m", "size of each flag"}},
        .most_effects = 1};
  }

  Result<> bind_part(const engine::TypeSpec&, std::uint32_t) const {
    if (params.yellow <= params.most) return {};
    return Error{
        fmt::format("has {} flags at the start (\"yellow\"), but its list holds at most {}: give a larger "
                    "\"most\"",
                    params.yellow, params.most)};
  }

  void start(StateTable& state, std::size_t slot) const {
    FlagList flags(state, slot);
    for (std::int64_t i = 0; i < params.yellow; ++i) flags.push(k_yellow_flag);
  }

  void act(const DeviceBatch& batch) const {
    for (std::size_t i = 0; i < batch.rows.size(); ++i) {
      const auto& command = batch.commands->as<FlagCommand>(batch.slot(i));
      std::uint32_t& done = batch.state.cell<std::uint32_t>(batch.slot(i), k_flag_request)[0];
      if (command.request == done) continue;
      done = command.request;
      FlagList own(batch.state, batch.slot(i));
      switch (command.verb) {
        case FlagCommand::push: own.push({command.color, command.size}); break;
        case FlagCommand::pop: own.pop(); break;
        case FlagCommand::take:
        case FlagCommand::give:
          if (command.target < batch.view.spec().bodies.size())  // else the effect would be an error
            batch.emit(i, 0, command.verb, BodyId(command.target));
          break;
        default: break;
      }
    }
  }

  void apply(engine::DeviceExchange bodies, const Effect& effect) const {
    FlagList own(bodies.table(), bodies.slot());
    std::optional<FlagList> other = flags_of_target(bodies);
    if (!other || effect.target == effect.source) return;
    const bool takes = effect.verb == FlagCommand::take;
    FlagList& from = takes ? *other : own;
    FlagList& to = takes ? own : *other;
    if (from.empty() || to.full()) return;
    to.push(from.pop());
    if (!takes) to.count_received();
  }

  static engine::HeldFlags flags(const StateTable& state, std::size_t slot) {
    return {.count = state.cell<std::uint32_t>(slot, k_flag_count)[0],
            .received = state.cell<std::uint64_t>(slot, k_flag_received)[0]};
  }
};

}  // namespace

DeviceKind flags_kind() {
  return engine::make_device_kind<Flags>("flags", "a list of flags: coloured tokens that bodies exchange");
}

}  // namespace troupe::models
