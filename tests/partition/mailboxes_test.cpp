#include "partition/mailboxes.hpp"

#include "base/ids.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace troupe::partition::mailboxes_test {
namespace {

std::shared_ptr<const Message> number(std::uint64_t value) {
  MessageWriter writer;
  writer.put(value);
  return std::make_shared<const Message>(writer.take());
}

std::uint64_t number_in(const std::shared_ptr<const Message>& message) {
  return MessageReader(*message).get<std::uint64_t>();
}

// Each rank sends its numbers to each other rank, and receives theirs from the last rank to the first.
TEST(Mailboxes, KeepTheOrderOfEachSender) {
  constexpr unsigned k_ranks = 5;
  constexpr std::uint64_t k_messages = 30;
  for (const std::optional<std::uint64_t> seed : {std::optional<std::uint64_t>(), {1}, {2}}) {
    Mailboxes boxes(k_ranks, seed);
    std::vector<std::vector<std::uint64_t>> got(k_ranks);
    std::vector<std::thread> threads;
    for (unsigned rank = 0; rank < k_ranks; ++rank)
      threads.emplace_back([&, rank] {
        Transport& own = boxes.of(rank);
        for (std::uint64_t i = 0; i < k_messages; ++i) own.send_to_all(number(1000 * rank + i));
        for (unsigned from = k_ranks; from-- > 0;)
          for (std::uint64_t i = 0; from != rank && i < k_messages; ++i)
            got[rank].push_back(number_in(own.receive(from)));
      });
    for (std::thread& thread : threads) thread.join();
    for (unsigned rank = 0; rank < k_ranks; ++rank) {
      std::vector<std::uint64_t> expected;
      for (unsigned from = k_ranks; from-- > 0;)
        for (std::uint64_t i = 0; from != rank && i < k_messages; ++i) expected.push_back(1000 * from + i);
      EXPECT_EQ(got[rank], expected) << "rank " << rank;
      EXPECT_EQ(boxes.of(rank).traffic().messages, k_messages * (k_ranks - 1));
      EXPECT_EQ(boxes.of(rank).traffic().bytes, k_messages * (k_ranks - 1) * 8);
    }
  }
}

// A receiver that searched the waiting messages one by one would need minutes.
TEST(Mailboxes, FindTheNextOfManyMessagesAtOnce) {
  constexpr std::uint64_t k_messages = 400'000;
  Mailboxes boxes(3);
  const std::shared_ptr<const Message> message = number(7);
  for (const unsigned from : {1u, 2u})
    for (std::uint64_t i = 0; i < k_messages; ++i) boxes.of(from).send(0, message);
  for (const unsigned from : {2u, 1u})
    for (std::uint64_t i = 0; i < k_messages; ++i) ASSERT_EQ(boxes.of(0).receive(from), message);
}

TEST(Mailboxes, ThatAreClosedEndAWait) {
  Mailboxes boxes(2, 1);
  boxes.of(1).send(0, number(7));
  std::string error;
  std::thread waiting([&] {
    EXPECT_EQ(number_in(boxes.of(0).receive(1)), 7u);
    try {
      boxes.of(0).receive(1);
    } catch (const RankError& thrown) {
      error = thrown.what();
    }
  });
  boxes.close("rank 1 failed: no memory");
  boxes.close("a later reason");
  waiting.join();
  EXPECT_EQ(error, "rank 1 failed: no memory");
}

TEST(Mailboxes, AreForOneTo1024Ranks) {
  EXPECT_NO_THROW(Mailboxes(1024));
  for (const unsigned ranks : {0u, 1025u}) {
    try {
      Mailboxes boxes(ranks);
      ADD_FAILURE() << ranks;
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(std::string(error.what()), std::to_string(ranks) + " ranks: must be 1 to 1024");
    }
  }
}

TEST(Message, ThatIsTooShortIsAnError) {
  MessageWriter writer;
  writer.put(std::uint32_t{3});
  writer.put_text("abc");
  const Message message = writer.take();
  MessageReader reader(message);
  EXPECT_EQ(reader.get<std::uint32_t>(), 3u);
  EXPECT_FALSE(reader.is_done());
  EXPECT_EQ(reader.get_text(), "abc");
  EXPECT_TRUE(reader.is_done());
  EXPECT_THROW(reader.get<std::uint8_t>(), std::logic_error);
}

TEST(Message, WithAWrongNumberOfElementsAllocatesNothing) {
  MessageWriter writer;
  writer.put_all(std::span<const std::uint32_t>(std::vector<std::uint32_t>{7, 8}));
  writer.put(std::uint64_t{3});  // one element more than follow
  writer.put_point({1, 2});
  const Message message = writer.take();
  MessageReader reader(message);
  EXPECT_EQ(reader.get_all<std::uint32_t>(), (std::vector<std::uint32_t>{7, 8}));
  MessageReader other = reader;
  EXPECT_EQ(other.get_count(5), 3u);
  other = reader;
  EXPECT_THROW(other.get_count(6), std::logic_error);
  EXPECT_THROW(reader.get_all<double>(), std::logic_error);
}

TEST(Message, WithAnIndexOutOfRangeIsAnError) {
  MessageWriter writer;
  for (const std::uint32_t index : {0u, 6u, 7u, ~0u}) writer.put(index);
  const Message message = writer.take();
  MessageReader reader(message);
  MessageReader ids = reader;
  EXPECT_EQ(reader.get_below<std::uint32_t>(7), 0u);
  EXPECT_EQ(reader.get_below<std::uint32_t>(7), 6u);
  EXPECT_THROW(reader.get_below<std::uint32_t>(7), std::logic_error);
  EXPECT_EQ(ids.get_below<BodyId>(7), BodyId(0));
  EXPECT_EQ(ids.get_below<BodyId>(7), BodyId(6));
  EXPECT_THROW(ids.get_below<BodyId>(7), std::logic_error);
  EXPECT_THROW(ids.get_below<BodyId>(7), std::logic_error) << "an invalid id";
}

TEST(Message, ABoolIsTrueIfItsByteIsNot0) {
  MessageWriter writer;
  for (std::uint8_t byte = 0; byte <= 2; ++byte) writer.put(byte);
  const Message message = writer.take();
  MessageReader reader(message);
  EXPECT_FALSE(reader.get<bool>());
  EXPECT_TRUE(reader.get<bool>());
  EXPECT_TRUE(reader.get<bool>());
}

}  // namespace
}  // namespace troupe::partition::mailboxes_test
