#pragma once

#include "partition/message.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>

namespace troupe::partition {

/// Largest number of ranks of a Transport. Ranks are the threads or processes that compute one world
/// together.
inline constexpr unsigned k_most_ranks = 1024;

/// Thrown by a Transport if another rank (see k_most_ranks) failed or cannot be reached, or if MPI fails. The
/// text names the other rank if it is known.
class RankError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Sends and receives messages between *ranks*, the threads or processes that compute one world together
/// (docs/cluster.md). Each rank has an object of this class, which only one thread may use.
class Transport {
 public:
  Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;
  virtual ~Transport() = default;

  virtual unsigned rank() const = 0;   ///< number of this rank, from 0 to ranks() - 1
  virtual unsigned ranks() const = 0;  ///< number of ranks
  /// Starts to send a message to another rank and returns without waiting for the receiver. to: a rank below
  /// ranks() other than rank(). A transport between processes throws RankError if sending fails.
  void send(unsigned to, std::shared_ptr<const Message> message) {
    traffic_.messages += 1;
    traffic_.bytes += message->size();
    post(to, std::move(message));
  }
  void send(unsigned to, MessageWriter message) { send(to, std::make_shared<const Message>(message.take())); }
  /// Starts to send a message to every other rank; errors are those of send().
  void send_to_all(const std::shared_ptr<const Message>& message) {
    for (unsigned to = 0; to < ranks(); ++to)
      if (to != rank()) send(to, message);
  }
  void send_to_all(MessageWriter message) { send_to_all(std::make_shared<const Message>(message.take())); }
  /// Waits for the next message from the rank `from` and returns it. Messages from one rank arrive in the
  /// order in which that rank sent them. from: a rank below ranks() other than rank(). Throws RankError if a
  /// rank has failed, if the rank `from` does not answer, or if MPI fails.
  virtual std::shared_ptr<const Message> receive(unsigned from) = 0;

  /// The messages that this rank has sent so far.
  struct Traffic {
    std::uint64_t messages = 0;  ///< number of messages
    std::uint64_t bytes = 0;     ///< sum of their lengths
  };
  const Traffic& traffic() const { return traffic_; }  ///< what this rank has sent so far
  /// Returns the time of a clock, s. Only differences between two results are meaningful. A transport without
  /// a clock always returns 0.
  virtual double seconds() const { return 0; }
  virtual double waited_s() const { return 0; }  ///< total wait for other ranks, s; 0 without a clock

 private:
  virtual void post(unsigned to, std::shared_ptr<const Message> message) = 0;

  Traffic traffic_;
};

}  // namespace troupe::partition
