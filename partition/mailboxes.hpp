#pragma once

#include "partition/transport.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace troupe::partition {

/// Transports (partition/transport.hpp) for ranks that are threads of this process. Ranks compute one world
/// together. Each rank has a mailbox to which the other ranks add messages.
class Mailboxes {
 public:
  /// seed: if it is given, messages arrive late and in a shuffled order that depends on it, as they may on a
  /// network; for tests. clock: returns the time of a rank for Transport::seconds(), s; called on the threads
  /// of all ranks. Null: there is no clock. Throws std::invalid_argument unless `ranks` is 1 to k_most_ranks.
  explicit Mailboxes(unsigned ranks, std::optional<std::uint64_t> seed = {},
                     std::function<double(unsigned rank)> clock = {});
  ~Mailboxes();
  Mailboxes(const Mailboxes&) = delete;
  Mailboxes& operator=(const Mailboxes&) = delete;

  Transport& of(unsigned rank);  ///< the transport of a rank; valid while this object lives
  /// Makes every waiting and later call of receive() that finds no message throw RankError with this text, on
  /// all ranks. Call it if a rank fails. Only the first text counts. Thread-safe.
  void close(const std::string& reason);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe::partition
