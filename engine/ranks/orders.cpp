#include "engine/ranks/orders.hpp"

#include <utility>

namespace troupe::engine {

partition::MessageWriter begin_message(Order order, std::uint32_t world) {
  partition::MessageWriter message;
  message.put(order);
  message.put(world);
  return message;
}

ReceivedOrder receive_order(partition::Transport& transport, unsigned from) {
  ReceivedOrder received;
  received.message = transport.receive(from);
  received.rest = partition::MessageReader(*received.message);
  received.order = received.rest.get<Order>();
  received.world = received.rest.get<std::uint32_t>();
  return received;
}

}  // namespace troupe::engine
