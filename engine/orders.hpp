#pragma once

#include "partition/message.hpp"
#include "partition/transport.hpp"

#include <cstdint>
#include <memory>

namespace troupe::engine {

/// What a rank asks of the others, and the kinds of messages within a tick. The first byte of a message.
enum class Order : std::uint8_t {
  make,      ///< make a replica of a world (troupe/rank_team.hpp)
  drop,      ///< destroy a replica
  end,       ///< no order follows
  step,      ///< compute the next tick
  reset,     ///< World::reset()
  restart,   ///< World::restart()
  set,       ///< World::set()
  hash,      ///< return the hash of the own rows
  gather,    ///< return the own rows of tables that are kept
  agree,     ///< in a tick: the callback before_tick() has returned on rank 0
  together,  ///< in a tick: rows for on_rank_0(), to rank 0 and back
  exchange,  ///< in a tick: what the owner of the rows has written
  failed,    ///< in a tick: the owner of the rows could not compute them
};

/// Begins a message with its head: the order, and the number of the world that it is about.
partition::MessageWriter begin_message(Order order, std::uint32_t world);

/// A message of another rank that begin_message() began.
struct ReceivedOrder {
  Order order = Order::end;
  std::uint32_t world = 0;                            ///< number of the world
  partition::MessageReader rest;                      ///< reads what follows the head
  std::shared_ptr<const partition::Message> message;  ///< what `rest` reads
};
/// Waits for the next message from a rank. Throws partition::RankError.
ReceivedOrder receive_order(partition::Transport& transport, unsigned from);

}  // namespace troupe::engine
