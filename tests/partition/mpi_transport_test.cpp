#include "partition/mpi_transport.hpp"

#include <gtest/gtest.h>

namespace troupe::partition {
namespace {

TEST(MpiTransport, AMessageThatComesTooLateIsWrittenToMemoryOfItsOwn) {
  MpiTransport transport(TROUPE_STUCK_MPI);
  transport.set_limit(2);
  EXPECT_THROW(transport.receive(1), RankError);
  const double then = transport.seconds();  // the module writes the rest of the message
  EXPECT_GT(transport.seconds(), then);
  EXPECT_THROW(transport.receive(1), RankError);
}

}  // namespace
}  // namespace troupe::partition
