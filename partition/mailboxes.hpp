#pragma once

#include "partition/transport.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace troupe::partition {

/// Sends messages between ranks that are threads of this process. Ranks are the threads that compute a world
/// together, numbered from 0. Each rank uses an object of class Transport (partition/transport.hpp). Each
/// rank has a mailbox, to which the other ranks add messages.
class Mailboxes {
 public:
  /// Makes the mailboxes and the Transport objects of all ranks. Throws std::invalid_argument if `ranks` is 0
  /// or more than k_most_ranks.
  /// ranks  number of ranks
  /// seed   for tests: if it is given, messages arrive late and in a random order, which follows from the
  ///        seed. Even then, receive() returns the messages of one rank in the order in which that rank sent
  ///        them
  /// clock  clock(rank) is the result of Transport::seconds() on this rank, s. The threads of all ranks call
  ///        it, so it must be thread-safe. If it is empty, there is no clock
  explicit Mailboxes(unsigned ranks, std::optional<std::uint64_t> seed = {},
                     std::function<double(unsigned rank)> clock = {});
  ~Mailboxes();
  Mailboxes(const Mailboxes&) = delete;
  Mailboxes& operator=(const Mailboxes&) = delete;

  /// The Transport object of a rank; valid while this object lives. `rank` must be below the number of ranks.
  Transport& of(unsigned rank);
  /// Tells all ranks that a rank has failed. From then on, Transport::receive() still returns messages that
  /// have been sent. If there is no such message, receive() throws RankError with the text `reason` instead
  /// of waiting; calls that are already waiting throw too. If close() is called several times, the first
  /// `reason` is used. Thread-safe.
  void close(const std::string& reason);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe::partition
