#pragma once

#include "partition/message.hpp"
#include "partition/transport.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <utility>

namespace troupe::engine {

/// The types of messages between ranks, which are threads or processes that compute a world together
/// (engine/ranks/replica.hpp). Rank 0 sends orders to the other ranks, and they answer. Within a tick (time
/// step), all ranks also send data to each other. The first byte of every message is its Order. An answer has
/// the Order of the message that it answers, or Order::failed.
///
/// A *row* is the data of one body in the state tables. A rank *owns* the rows of the bodies whose sensors,
/// devices, drives and controllers it runs. In a distributed world (class Halo), a rank has only the rows
/// that it owns and *ghosts*, which are copies of some rows of other ranks. An effect is an action of a
/// device on another body.
enum class Order : std::uint8_t {
  make,        ///< make a replica of a world (troupe/rank_team.hpp); as an answer: the replica is made
  drop,        ///< destroy a replica
  end,         ///< the last order: no other order follows
  step,        ///< compute the next tick
  reset,       ///< call World::reset()
  restart,     ///< call World::restart()
  set,         ///< call RankAccess::set_at()
  hash,        ///< send rank 0 the sums of the hashes of the rows that the receiver owns
  gather,      ///< send rank 0 the rows of the receiver that rank 0 lacks (RankRows::put_missing())
  counts,      ///< send rank 0 what the receiver has counted (Replica::all_counts())
  agree,       ///< in a tick: the callback of World::before_tick() has returned on rank 0
  together,    ///< in a tick: rows for which rank 0 decides (Replica::on_rank_0()), to rank 0 or back
  exchange,    ///< in a tick: values of rows that the sender owns or has just given to another owner
  rows,        ///< in a tick: rows for new owners, new ghosts, and data that decide who gets rows (Halo)
  outcomes,    ///< in a tick: outcomes of motions of rows that are ghosts on the receiver (RankBorder)
  places,      ///< in a tick: final positions of pushed bodies (RankBorder)
  joints,      ///< in a tick: whether joint motions of ghosts on the receiver are blocked (RankBorder)
  blocks,      ///< in a tick: what blocked rows that are ghosts on the receiver (RankBorder)
  candidates,  ///< in a tick: bodies of own rows of the sender that an intervention may choose
  moves,       ///< in a tick: whether interventions have moved a body on the sender (RankRows::on_any_rank())
  effects,     ///< in a tick: rows that effects change, or whether ranks lack ghosts (SharedEffects)
  births,      ///< in a tick: the first free place that the sender found for a birth (lowest_trial())
  ended,  ///< in a tick: whether a hook of the phase move has failed on the sender (SharedError::agree())
  /// the sender could not make the replica, or could not compute its rows of the tick; or the callback of
  /// World::before_tick() threw an exception on the sender, which is rank 0
  failed,
};

/// Begins a message with its head, which consists of the order and the number of the world that the order
/// concerns.
partition::MessageWriter begin_message(Order order, std::uint32_t world);

/// A received message whose head (begin_message()) has already been read.
struct ReceivedOrder {
  Order order = Order::end;                           ///< the type of the message
  std::uint32_t world = 0;                            ///< number of the world
  partition::MessageReader rest;                      ///< reads the message from the end of its head
  std::shared_ptr<const partition::Message> message;  ///< the whole message, to which `rest` refers
};
/// Waits for the next message from the rank `from`, and reads its head. Throws partition::RankError if a rank
/// failed or does not answer, and std::logic_error if the message is shorter than a head.
ReceivedOrder receive_order(partition::Transport& transport, unsigned from);

/// The functions with which the parts of a Replica (a rank's copy of a world) send and receive the messages
/// of a tick.
struct RankPost {
  unsigned rank = 0;                                     ///< number of this rank
  unsigned ranks = 1;                                    ///< number of ranks
  std::function<partition::MessageWriter(Order)> begin;  ///< begin_message() for this world
  /// Sends a message, which several calls may share, to the rank `to`.
  std::function<void(unsigned to, std::shared_ptr<const partition::Message> message)> send_shared;
  /// Waits for a message with this order from rank `from`. If that rank has failed in this tick, throws an
  /// exception that ends the tick.
  std::function<ReceivedOrder(Order order, unsigned from)> receive;

  /// Sends a message to the rank `to`.
  void send(unsigned to, partition::MessageWriter message) const;
  /// Sends a message to every other rank.
  void send_to_all(partition::MessageWriter message) const;
  /// Receives a message with this order from every other rank, in the order of ranks, and calls
  /// read(from, message).
  template <class Read>
  void receive_from_all(Order order, Read&& read) const {
    for (unsigned from = 0; from < ranks; ++from) {
      if (from == rank) continue;
      ReceivedOrder received = receive(order, from);
      read(from, received.rest);
    }
  }
  /// Combines the values `own` of all ranks, and returns the result on all ranks. For example, if `choose`
  /// returns the larger of two values, the result is the largest `own` of any rank. `choose` must be
  /// associative and commutative. All ranks must call this with the same `order`, the type of the messages.
  template <class T, class Choose>
  T agree(Order order, T own, Choose&& choose) const {
    partition::MessageWriter message = begin(order);
    message.put(own);
    send_to_all(std::move(message));
    receive_from_all(order,
                     [&](unsigned, partition::MessageReader& theirs) { own = choose(own, theirs.get<T>()); });
    return own;
  }
};

}  // namespace troupe::engine
