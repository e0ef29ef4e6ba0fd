#pragma once

#include "partition/transport.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace troupe::partition {

/// The transports (partition/transport.hpp) between ranks that are threads of this process. A rank is one of
/// the threads that compute a world together, numbered from 0. Each rank has a mailbox to which the other
/// ranks add messages.
class Mailboxes {
 public:
  /// seed: if it is given, messages arrive late and in a random order that follows from the seed, as they may
  /// on a network; receive() still returns the messages of one rank in the order in which that rank sent
  /// them. For tests.
  /// clock: returns the time of a rank for Transport::seconds(), s; called on the threads of all ranks. If it
  /// is empty, there is no clock.
  /// Throws std::invalid_argument unless `ranks` is 1 to k_most_ranks.
  explicit Mailboxes(unsigned ranks, std::optional<std::uint64_t> seed = {},
                     std::function<double(unsigned rank)> clock = {});
  ~Mailboxes();
  Mailboxes(const Mailboxes&) = delete;
  Mailboxes& operator=(const Mailboxes&) = delete;

  /// The transport of a rank, which must be below the number of ranks; valid while this object lives.
  Transport& of(unsigned rank);
  /// Tells all ranks that a rank has failed. Calls of Transport::receive() that wait for a message, and later
  /// calls that find no message, then throw RankError with the text `reason`. Messages sent earlier are still
  /// received. If several calls are made, the reason of the first one is used. Thread-safe.
  void close(const std::string& reason);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe::partition
