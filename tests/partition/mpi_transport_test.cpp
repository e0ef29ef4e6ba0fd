#include "partition/mpi_transport.hpp"

#include "tests/support/paths.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace troupe::partition::mpi_transport_test {
namespace {

TEST(MpiTransport, AMessageThatComesTooLateIsWrittenToMemoryOfItsOwn) {
  MpiTransport transport((test::binary_dir() / "tests/libslow_mpi.so").string());
  transport.set_limit(2);
  EXPECT_THROW(transport.receive(1), RankError);
  const double then = transport.seconds();  // the module writes the rest of the message
  EXPECT_GT(transport.seconds(), then);
  EXPECT_THROW(transport.receive(1), RankError);
}

// A job that was suspended goes on, although the clock has moved on by far more than the limit.
TEST(MpiTransport, TimeInWhichTheProcessIsSuspendedDoesNotCount) {
  MpiTransport transport((test::binary_dir() / "tests/libslow_mpi.so").string());
  transport.set_limit(10);
  transport.send(1, std::make_shared<const Message>());
  transport.complete_sending();
  EXPECT_TRUE(transport.receive(1)->empty());
  EXPECT_GT(transport.waited_s(), 10) << "the clock has not moved on";
  transport.set_limit(3);
  EXPECT_THROW(transport.receive(1), RankError);
}

}  // namespace
}  // namespace troupe::partition::mpi_transport_test
