// A checkpoint that was changed on purpose can give the memories of controllers and the readings and states
// of devices any values. A run with such values may go on or throw, but must not read or write outside of its
// data. Builds with sanitizers would report that.

#include "engine/world/world.hpp"
#include "tests/support/draw.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/troupe.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <exception>
#include <set>
#include <span>
#include <type_traits>

namespace troupe::junk_state_test {
namespace {

using engine::Element;
using engine::StateTable;
using test::Draw;

constexpr int k_tries = test::k_slow_build ? 2 : 6;
constexpr int k_ticks = test::k_slow_build ? 3 : 5;

template <class T>
void fill(std::span<T> values, Draw& draw) {
  for (T& value : values) {
    if constexpr (std::is_floating_point_v<T>)
      value = static_cast<T>(draw.chance(0.5) ? draw.real(-2, 2) : draw.real(-1e18, 1e18));
    else
      value = static_cast<T>(draw.chance(0.7) ? draw.below(9) : draw.below(~0u));
  }
}

void fill(StateTable& table, std::size_t row, std::size_t field, Draw& draw) {
  if (table.fields()[field].is_bool) {
    for (std::uint8_t& value : table.cell<std::uint8_t>(row, field)) value = draw.chance(0.5);
    return;
  }
  switch (table.fields()[field].element) {
    case Element::f64: return fill(table.cell<double>(row, field), draw);
    case Element::f32: return fill(table.cell<float>(row, field), draw);
    case Element::i64: return fill(table.cell<std::int64_t>(row, field), draw);
    case Element::i32: return fill(table.cell<std::int32_t>(row, field), draw);
    case Element::u64: return fill(table.cell<std::uint64_t>(row, field), draw);
    case Element::u32: return fill(table.cell<std::uint32_t>(row, field), draw);
    case Element::u8: return fill(table.cell<std::uint8_t>(row, field), draw);
  }
}

class JunkState : public ::testing::TestWithParam<scenes::Run> {};

TEST_P(JunkState, IsNoIndexIntoOtherData) {
  const scenes::Run& run = GetParam();
  SimulationOptions options;
  options.threads = 1;
  if (run.robots) options.robots = {{"", *run.robots}};
  Simulation simulation(run.file(), options);
  const std::span<const StateTable> tables = simulation.world().tables();
  std::set<std::size_t> of_kinds;
  for (const engine::BodyType& type : simulation.world().view().types()) {
    for (const engine::BodyType::Controller& controller : type.controllers)
      if (controller.table) of_kinds.insert(*controller.table);
    for (const engine::BodyType::Device& device : type.devices)
      if (tables[device.table].group() == engine::HashGroup::sensor) of_kinds.insert(device.table);
  }
  if (of_kinds.empty()) GTEST_SKIP() << "this world has no controller with a memory, and no device";
  for (int i = 0; i < k_tries; ++i) {
    Draw draw(static_cast<std::uint64_t>(i + 1));
    simulation.reset();
    for (int tick = 0; tick < k_ticks; ++tick) simulation.step();
    for (const std::size_t t : of_kinds) {
      auto& table = const_cast<StateTable&>(tables[t]);
      for (std::size_t row = 0; row < table.rows(); ++row)
        for (std::size_t field = 0; field < table.fields().size(); ++field)
          if (draw.chance(0.8)) fill(table, row, field, draw);
    }
    try {
      for (int tick = 0; tick < k_ticks; ++tick) simulation.step();
    } catch (const std::exception&) {  // for example for a speed that is not finite
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Worlds, JunkState, ::testing::ValuesIn(scenes::runs_of("same_bits")),
                         [](const auto& run) { return run.param.name(); });

}  // namespace
}  // namespace troupe::junk_state_test
