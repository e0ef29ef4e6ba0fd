// Messages between ranks with wrong contents (engine/ranks/replica.hpp).

#include "engine/ranks/replica.hpp"

#include "base/diagnostics.hpp"
#include "engine/ranks/record_message.hpp"
#include "engine/spec/experiment_spec.hpp"
#include "engine/world/world.hpp"
#include "partition/mailboxes.hpp"
#include "tests/support/scratch.hpp"
#include "troupe/troupe.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>

namespace troupe::engine {
namespace {

using partition::Message;
using partition::MessageReader;
using partition::MessageWriter;
using ::testing::HasSubstr;

// More elements than the address space has bytes: to allocate memory for them fails.
constexpr std::uint64_t k_too_many = std::uint64_t{1} << 50;

void expect_too_short(const std::function<void()>& work) {
  try {
    work();
    ADD_FAILURE() << "no exception";
  } catch (const std::exception& error) {
    EXPECT_THAT(std::string(error.what()), HasSubstr("a message between ranks is too short"));
  }
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
  MessageWriter step;  // the state of a replicated world, with too many subscribed bodies
  step.put(false);     // no callback
  step.put(true);      // the state follows
  step.put(std::uint64_t{0});
  step.put(k_too_many);
  expect_too_short([&] { follow(Order::step, std::move(step)); });
  MessageWriter set;  // a setting whose record has too many values
  set.put(TypeId(0));
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

// An exception that is no StepError has ended the program on rank 0, which destroys its worlds.
TEST_F(ReplicaMessages, AWorldThatRank0EndsInATickIsNoInternalError) {
  for (const Order last : {Order::drop, Order::end}) {
    partition::Mailboxes mailboxes(2);
    World world(simulation_.world().spec(), simulation_.registry(), {.threads = 1}, diagnostics_);
    Replica replica(world, simulation_.registry(), mailboxes.of(1), 0, {});
    mailboxes.of(0).send(1, begin_message(last, 0));
    MessageWriter step;
    step.put(false);  // no callback
    step.put(false);  // no state
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
}  // namespace troupe::engine
