#include "engine/kinds/controller.hpp"

#include "tests/support/message_of.hpp"

#include <gtest/gtest.h>

#include <any>
#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace troupe::engine::controller_test {
namespace {

using test::message_of;

struct Mixed {
  float turn_left_s = 0;
  std::array<double, 3> readings{1, 2, 3};
  bool turning = true;
  std::uint32_t count = 7;
  std::int64_t since = -1;
  TROUPE_FIELDS(turn_left_s, readings, turning, count, since)
};

TEST(MemoryFields, DescribeTheStruct) {
  const std::vector<StateField> fields = memory_fields<Mixed>();
  ASSERT_EQ(fields.size(), 5u);
  const char* const names[]{"turn_left_s", "readings", "turning", "count", "since"};
  const Element elements[]{Element::f32, Element::f64, Element::u8, Element::u32, Element::i64};
  const std::uint32_t columns[]{1, 3, 1, 1, 1};
  const std::size_t offsets[]{offsetof(Mixed, turn_left_s), offsetof(Mixed, readings),
                              offsetof(Mixed, turning), offsetof(Mixed, count), offsetof(Mixed, since)};
  for (std::size_t f = 0; f < fields.size(); ++f) {
    EXPECT_EQ(fields[f].name, names[f]);
    EXPECT_EQ(fields[f].element, elements[f]);
    EXPECT_EQ(fields[f].columns, columns[f]);
    EXPECT_EQ(fields[f].offset, offsets[f]);
  }
}

struct Reordered {
  double a = 0;
  float b = 0;
  TROUPE_FIELDS(b, a)
};
struct Empty {
  TROUPE_FIELDS()
};
struct One {
  double only = 0;
  TROUPE_FIELDS(only)
};
// clang-format off
struct Spaced {
  double first = 0;
  float second = 0;
  TROUPE_FIELDS( first , second )
};
// clang-format on

TEST(MemoryFields, ComeInTheOrderTheyAreListed) {
  const std::vector<StateField> fields = memory_fields<Reordered>();
  ASSERT_EQ(fields.size(), 2u);
  EXPECT_EQ(fields[0].name, "b");
  EXPECT_EQ(fields[0].offset, offsetof(Reordered, b));
  EXPECT_EQ(fields[1].name, "a");
  EXPECT_EQ(fields[1].offset, 0u);
  EXPECT_TRUE(memory_fields<Empty>().empty());
  ASSERT_EQ(memory_fields<One>().size(), 1u);
  EXPECT_EQ(memory_fields<One>()[0].name, "only");
}

TEST(MemoryFields, HaveNamesWithoutSpaces) {
  const std::vector<StateField> fields = memory_fields<Spaced>();
  ASSERT_EQ(fields.size(), 2u);
  EXPECT_EQ(fields[0].name, "first");
  EXPECT_EQ(fields[1].name, "second");
}

/// Counts its calls and drives as fast as it has counted.
struct Counter {
  struct Memory {
    std::uint32_t calls = 10;
    TROUPE_FIELDS(calls)
  };
  struct Params {
    double step = 0.5;

    static constexpr void describe(Description<Params>& d) { d.member<&Params::step>("step", "forward"); }
  };

  Params params;

  Result<std::vector<std::size_t>> choose(std::span<const DeviceInfo>, std::vector<bool>&) const {
    if (params.step < 0) return Error{"cannot count down"};
    return std::vector<std::size_t>();
  }
  void operator()(Memory& memory, const Percept&, Random&, Actions& actions) const {
    ++memory.calls;
    actions.command.x = params.step * memory.calls;
  }
};
struct Forgetful {
  std::vector<std::size_t> choose(std::span<const DeviceInfo>, std::vector<bool>&) const { return {2, 0}; }
  void operator()(const Percept& percept, Random&, Actions& actions) const {
    actions.command.x = percept.period_s;
    actions.command.turn = percept.tick_s;
  }
};

TEST(ControllerKind, KeepsItsMemoryInTheTable) {
  const ControllerKind kind = make_controller_kind<Counter>("counter", "counts");
  EXPECT_EQ(kind.name, "counter");
  EXPECT_EQ(kind.memory_bytes, sizeof(Counter::Memory));
  ASSERT_EQ(kind.memory.size(), 1u);

  StateTable table("counter/0", HashGroup::memory, StateTable::Layout::rows, kind.memory,
                   {BodyId(3), BodyId(9)}, kind.memory_bytes);
  for (std::size_t r = 0; r < 2; ++r) kind.start(table.row(r));
  EXPECT_EQ(table.cell<std::uint32_t>(1, 0)[0], 10u) << "members start as the struct says";

  std::vector<bool> claimed;
  const Result<ControllerKind::Prepared> prepared = kind.prepare({Value(2.0)}, {}, claimed);
  ASSERT_TRUE(prepared);
  Command command;
  const std::uint64_t before = table.hash_row(1);
  const std::vector<Row> rows{Row(0)};
  const std::vector<BodyId> ids{BodyId(9)};
  const std::vector<std::uint32_t> slots{1};
  kind.decide(prepared->data, {.rows = rows,
                               .ids = ids,
                               .slots = slots,
                               .commands = {&command, 1},
                               .memories = {table.row(0), table.row_bytes()}});
  EXPECT_EQ(command.x, 22);
  EXPECT_EQ(table.cell<std::uint32_t>(1, 0)[0], 11u);
  EXPECT_EQ(table.cell<std::uint32_t>(0, 0)[0], 10u) << "a robot's memory is its own";
  EXPECT_NE(table.hash_row(1), before);

  EXPECT_EQ(kind.prepare({Value(-1.0)}, {}, claimed).error().text, "cannot count down");
}

TEST(Actions, SwitchOnlyDevicesThatTheControllerHasChosen) {
  Command command;
  const std::vector<std::uint32_t> switches{4, 0};
  Actions actions{command, {}, switches};
  actions.switch_device(0, false);
  EXPECT_EQ(command.off, 4u);
  EXPECT_FALSE(actions.is_on(0));
  actions.switch_device(1, false);
  EXPECT_TRUE(actions.is_on(1)) << "it cannot be switched off";
  for (const std::size_t none : {std::size_t{2}, std::size_t{77}}) {
    EXPECT_THROW(actions.switch_device(none, false), std::out_of_range);
    EXPECT_THROW(actions.is_on(none), std::out_of_range);
  }
  EXPECT_EQ(command.off, 4u);
}

// A larger struct would reach into the commands of other robots.
TEST(Actions, RefuseCommandStructsOfOtherSizes) {
  Command command;
  alignas(8) std::array<std::byte, 8> lamp{};
  const std::array<std::span<std::byte>, 2> devices{lamp, std::span<std::byte>()};
  const Actions actions{command, devices, {}};
  actions.device<std::array<float, 2>>(0) = {0, 1};
  EXPECT_NE(lamp[7], std::byte{0});
  EXPECT_EQ(
      message_of<std::logic_error>([&] { actions.device<std::array<float, 4>>(0) = {}; }),
      "commands its device with the index 0 (counted from 0) by a struct of 16 bytes, but the command struct "
      "of this device has 8 bytes");
  EXPECT_THROW(actions.device<std::uint8_t>(0), std::logic_error);
  EXPECT_EQ(message_of<std::logic_error>([&] { actions.device<std::array<float, 2>>(1) = {}; }),
            "commands its device with the index 1 (counted from 0), but the kind of this device takes no "
            "commands");
  EXPECT_THROW(actions.device<std::uint8_t>(2), std::out_of_range);
}

// A controller that is given another device than its author expected must not read its bytes as other types.
TEST(Percept, RefusesFieldsOfOtherTypes) {
  const StateTable finder("fiducial/eye", HashGroup::sensor, StateTable::Layout::rows,
                          {{"count", Element::u32, 1, "", ""}, {"range", Element::f32, 2, "m", ""}},
                          {BodyId(0)});
  const StateTable counter("counter/c", HashGroup::sensor, StateTable::Layout::rows, memory_fields<Mixed>(),
                           {BodyId(0)}, sizeof(Mixed));
  const std::array<Readings, 2> devices{Readings(finder, 0), Readings(counter, 0)};
  const Percept percept{.devices = devices};
  EXPECT_EQ(percept.devices[0].field<std::uint32_t>(0).size(), 1u);
  EXPECT_EQ(percept.devices[0].field<float>(1).size(), 2u);
  EXPECT_EQ(percept.devices[1].as<Mixed>().count, 0u);
  EXPECT_TRUE(percept.devices[1].field<bool>(2).size() == 1);
  const auto error_of = [](auto&& read) -> std::string {
    try {
      static_cast<void>(read());
    } catch (const std::logic_error& error) {
      return error.what();
    }
    return "read";
  };
  EXPECT_EQ(
      error_of([&] { return percept.ranges(0); }),
      "reads the field with the index 0 (counted from 0) of the device \"fiducial/eye\" as float32, but "
      "this field, \"count\", has the type uint32");
  EXPECT_EQ(error_of([&] { return percept.devices[0].field<std::int32_t>(2); }),
            "reads the field with the index 2 (counted from 0) of the device \"fiducial/eye\" as int32, but "
            "the device has only 2 fields");
  EXPECT_EQ(error_of([&] { return percept.devices[1].as<Reordered>().a; }),
            "reads the state of the device \"counter/c\" as a struct of 16 bytes, but the state has " +
                std::to_string(sizeof(Mixed)) + " bytes");
}

/// Reads a second device, although it has chosen only one.
struct ReadsTooMany {
  static constexpr std::array k_uses{std::string_view("fiducial")};
  void operator()(const Percept& percept, Random&, Actions& actions) const {
    actions.command.x = percept.devices[1].field<std::uint32_t>(0)[0];
  }
};

TEST(Percept, RefusesDevicesThatTheControllerHasNotChosen) {
  const ControllerKind kind = make_controller_kind<ReadsTooMany>("reads_too_many", "");
  const StateTable finder("fiducial/eye", HashGroup::sensor, StateTable::Layout::rows,
                          {{"count", Element::u32, 1, "", ""}}, {BodyId(0)});
  Command command;
  const std::vector<Row> rows{Row(0)};
  const std::vector<BodyId> ids{BodyId(0)};
  const std::vector<std::uint32_t> slots{0};
  DecideBatch batch{.rows = rows, .ids = ids, .slots = slots, .commands = {&command, 1}};
  batch.percepts[0] = &finder;
  batch.devices = 1;
  const std::any controller = ReadsTooMany();
  try {
    kind.decide(controller, batch);
    ADD_FAILURE() << "nothing was thrown";
  } catch (const DecisionError& error) {
    EXPECT_EQ(message_of<std::out_of_range>([&] { std::rethrow_exception(error.thrown); }),
              "reads a device that it has not chosen: Percept::devices has fewer devices");
  }
  EXPECT_THROW(Readings().as<Mixed>(), std::out_of_range);
}

// The row after those of a batch is that of a robot for which another thread decides.
TEST(DecideBatch, RefusesRobotsAndDevicesThatItDoesNotHave) {
  const StateTable finder("fiducial/eye", HashGroup::sensor, StateTable::Layout::rows,
                          {{"count", Element::u32, 1, "", ""}, {"range", Element::f32, 2, "m", ""}},
                          {BodyId(0), BodyId(1)});
  std::vector<Command> commands(2);
  const std::vector<Row> rows{Row(0), Row(1)};
  const std::vector<BodyId> ids{BodyId(0), BodyId(1)};
  const std::vector<std::uint32_t> slots{0, 1};
  DecideBatch batch{.rows = std::span(rows).first(1), .ids = ids, .slots = slots, .commands = commands};
  batch.percepts[0] = &finder;
  batch.devices = 1;
  EXPECT_EQ(&batch.command(0), &commands[0]);
  EXPECT_EQ(batch.readings(0, 0).field<float>(1).size(), 2u);
  EXPECT_EQ(message_of<std::out_of_range>([&] { batch.command(1) = {}; }),
            "uses the robot with the index 1 (counted from 0) of a batch of 1 robots");
  EXPECT_THROW(batch.body(1), std::out_of_range);
  EXPECT_THROW(batch.memory(1), std::out_of_range);
  EXPECT_THROW(batch.device_command(0, 1), std::out_of_range);
  EXPECT_EQ(message_of<std::out_of_range>([&] { static_cast<void>(batch.readings(1, 0)); }),
            "uses its device with the index 1 (counted from 0), but has chosen only 1 devices");
  EXPECT_THROW(batch.device_command(1, 0), std::out_of_range);
  EXPECT_THROW(batch.ranges(0, 0), std::logic_error) << "its first field has no floats";
}

TEST(ControllerKind, NeedsNoMemory) {
  const ControllerKind kind = make_controller_kind<Forgetful>("forgetful", "");
  EXPECT_TRUE(kind.memory.empty());
  EXPECT_EQ(kind.memory_bytes, 0u);
  std::vector<bool> claimed;
  const Result<ControllerKind::Prepared> prepared = kind.prepare({}, {}, claimed);
  ASSERT_TRUE(prepared);
  EXPECT_EQ(prepared->devices, (std::vector<std::size_t>{2, 0}));
  Command command;
  const std::vector<Row> rows{Row(0)};
  const std::vector<BodyId> ids{BodyId(9)};
  const std::vector<std::uint32_t> slots{0};
  kind.decide(
      prepared->data,
      {.tick_s = 0.25, .period_s = 0.5, .rows = rows, .ids = ids, .slots = slots, .commands = {&command, 1}});
  EXPECT_EQ(command.x, 0.5);
  EXPECT_EQ(command.turn, 0.25);
}

}  // namespace
}  // namespace troupe::engine::controller_test
