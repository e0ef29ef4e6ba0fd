// Messages between ranks with wrong contents (engine/ranks/replica.hpp).

#include "engine/ranks/replica.hpp"

#include "base/diagnostics.hpp"
#include "engine/ranks/rank_rows.hpp"
#include "engine/ranks/record_message.hpp"
#include "engine/spec/experiment_spec.hpp"
#include "engine/world/world.hpp"
#include "partition/mailboxes.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/scratch.hpp"
#include "troupe/troupe.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>

namespace troupe::engine::replica_test {
namespace {

using partition::Message;
using partition::MessageReader;
using partition::MessageWriter;
using ::testing::HasSubstr;

// More elements than the address space has bytes: to allocate memory for them fails.
constexpr std::uint64_t k_too_many = std::uint64_t{1} << 50;

void expect_error(const std::function<void()>& work, const std::string& text) {
  EXPECT_THAT(test::message_of<std::exception>([&] { work(); }), HasSubstr(text));
}

void expect_too_short(const std::function<void()>& work) {
  expect_error(work, "a message between ranks is too short");
}

void expect_unknown(const std::function<void()>& work) {
  expect_error(work, "a message between ranks refers to a body, or to another object, that does not exist");
}

class ReplicaMessages : public test::ScratchTest {
 protected:
  ReplicaMessages()
      : simulation_(write("room.json", R"({"troupe": 1, "types": {"bot": {"size_m": [0.2, 0.2, 0.2],
            "drive": {"kind": "diff"}}},
          "populations": [{"name": "p", "type": "bot", "count": 10,
            "place": {"rule": "uniform", "region_m": [[-2, -2], [2, 2]]}}]})"),
                    {}),
        world_(simulation_.world().spec(), simulation_.registry(), {.threads = 1}, diagnostics_) {}

  Simulation simulation_;
  Diagnostics diagnostics_;
  World world_;
  partition::Mailboxes mailboxes_{2};
};

TEST_F(ReplicaMessages, OrdersWithAWrongSizeAllocateNothing) {
  Replica replica(world_, simulation_.registry(), mailboxes_.of(1), 0, {});
  const auto follow = [&](Order order, MessageWriter writer) {
    const Message message = writer.take();
    replica.follow(order, MessageReader(message));
  };
  MessageWriter step;          // the state of a replicated world, with too many subscribed bodies
  step.put(false);             // no callback
  step.put(std::uint64_t{0});  // no rejected restarts
  step.put(true);              // the state follows
  step.put(std::uint64_t{0});
  step.put(k_too_many);
  expect_too_short([&] { follow(Order::step, std::move(step)); });
  MessageWriter set;  // a setting whose record has too many values
  set.put(world_.tick());
  set.put(world_.spec().bodies.back().type);
  set.put(SettingSpec::Of());
  set.put(std::uint32_t{0});
  set.put(k_too_many);
  expect_too_short([&] { follow(Order::set, std::move(set)); });
}

TEST_F(ReplicaMessages, RowsWithAWrongSizeAllocateNothing) {
  Replica replica(world_, simulation_.registry(), mailboxes_.of(0), 0, {.is_distributed = true});
  MessageWriter rows = begin_message(Order::gather, 0);
  rows.put(BodyId(0));
  rows.put_point({0, 0});
  rows.put(k_too_many);
  mailboxes_.of(1).send(0, std::move(rows));
  expect_too_short([&] { world_.gather(); });
}

TEST_F(ReplicaMessages, OrdersMayNotReferToWhatDoesNotExist) {
  Replica replica(world_, simulation_.registry(), mailboxes_.of(1), 0, {});
  const auto follow = [&](Order order, MessageWriter writer) {
    const Message message = writer.take();
    replica.follow(order, MessageReader(message));
  };
  const auto subscribed = [](BodyId body) {  // the state of a replicated world with a subscribed body
    MessageWriter step;
    step.put(false);             // no callback
    step.put(std::uint64_t{0});  // no rejected restarts
    step.put(true);              // the state follows
    step.put(std::uint64_t{0});
    step.put_all(std::span<const BodyId>(&body, 1));
    return step;
  };
  const BodyId last(world_.spec().bodies.size() - 1);
  expect_unknown([&] { follow(Order::step, subscribed(BodyId(last.index() + 1))); });
  expect_unknown([&] { follow(Order::step, subscribed(BodyId())); });
  expect_too_short([&] { follow(Order::step, subscribed(last)); });
  const auto setting = [](std::size_t type, SettingSpec::Of of, std::uint32_t index) {
    MessageWriter set;
    set.put(std::uint64_t{0});  // tick
    set.put(TypeId(type));
    set.put(of);
    set.put(index);
    put_record(set, {});
    return set;
  };
  const std::size_t types = world_.view().types().size();
  expect_unknown([&] { follow(Order::set, setting(types, SettingSpec::Of::drive, 0)); });
  for (std::size_t type = 0; type < types; ++type)
    for (const SettingSpec::Of of : {SettingSpec::Of::device, SettingSpec::Of::controller})
      expect_unknown([&] { follow(Order::set, setting(type, of, 0)); });
}

TEST_F(ReplicaMessages, RowsMayNotReferToWhatDoesNotExist) {
  Replica replica(world_, simulation_.registry(), mailboxes_.of(0), 0, {.is_distributed = true});
  MessageWriter rows = begin_message(Order::gather, 0);
  rows.put(BodyId(world_.spec().bodies.size()));
  mailboxes_.of(1).send(0, std::move(rows));
  expect_unknown([&] { world_.gather(); });
}

TEST_F(ReplicaMessages, EffectsMayNotReferToWhatDoesNotExist) {
  simulation_ = Simulation(write("lamp.json", R"({"troupe": 1, "types": {"bot": {"size_m": [0.2, 0.2, 0.2],
        "drive": {"kind": "diff"}, "devices": [{"name": "lamp", "kind": "led"}]}},
      "populations": [{"name": "p", "type": "bot", "count": 2, "place": {"rule": "grid",
        "region_m": [[-2, -2], [2, 2]], "pitch_m": 1}}]})"),
                           {});
  const World& world = simulation_.world();
  const auto received = [&](const Effect& effect) {
    MessageWriter writer;
    writer.put(effect);
    const Message message = writer.take();
    MessageReader reader(message);
    return get_effect(reader, world);
  };
  const std::size_t bodies = world.spec().bodies.size();
  const Effect good{.source = BodyId(1), .target = BodyId()};
  EXPECT_EQ(received(good).source, good.source);
  const auto expect_bad = [&](auto&& change) {
    Effect bad = good;
    change(bad);
    expect_unknown([&] { received(bad); });
  };
  expect_bad([&](Effect& effect) { effect.source = BodyId(bodies); });
  expect_bad([&](Effect& effect) { effect.source = BodyId(); });
  expect_bad([&](Effect& effect) { effect.source = BodyId(0); });  // static: it has no device
  expect_bad([&](Effect& effect) { effect.device = 1; });
  expect_bad([&](Effect& effect) { effect.target = BodyId(bodies); });
  expect_bad([&](Effect& effect) { effect.verb = k_birth; });  // the world has no reserve
}

// An exception that is no StepError has ended the program on rank 0, which destroys its worlds.
TEST_F(ReplicaMessages, AWorldThatRank0EndsInATickIsNoInternalError) {
  for (const Order last : {Order::drop, Order::end}) {
    partition::Mailboxes mailboxes(2);
    World world(simulation_.world().spec(), simulation_.registry(), {.threads = 1}, diagnostics_);
    Replica replica(world, simulation_.registry(), mailboxes.of(1), 0, {});
    mailboxes.of(0).send(1, begin_message(last, 0));
    MessageWriter step;
    step.put(false);             // no callback
    step.put(std::uint64_t{0});  // no rejected restarts
    step.put(false);             // no state
    const Message message = step.take();
    EXPECT_THROW(replica.follow(Order::step, MessageReader(message)), partition::RankError);
  }
}

TEST(RecordMessage, KeepsTheValues) {
  const Record record{true,
                      std::int64_t{-3},
                      0.5,
                      std::string("text"),
                      std::vector<double>{1, 2},
                      std::vector<Record>{{2.5}, {}},
                      std::vector<std::string>{"a", ""}};
  MessageWriter writer;
  put_record(writer, record);
  const Message message = writer.take();
  MessageReader reader(message);
  EXPECT_EQ(get_record(reader), record);
  EXPECT_TRUE(reader.is_done());
}

// Each list of a record that announces more elements than follow.
TEST(RecordMessage, WithAWrongSizeAllocatesNothing) {
  for (std::uint8_t list = 5; list <= 7; ++list) {  // Value::v.index()
    MessageWriter writer;
    writer.put(std::uint64_t{1});
    writer.put(list);
    writer.put(k_too_many);
    writer.put(std::uint64_t{0});
    const Message message = writer.take();
    MessageReader reader(message);
    expect_too_short([&] { static_cast<void>(get_record(reader)); });
  }
}

}  // namespace
}  // namespace troupe::engine::replica_test
