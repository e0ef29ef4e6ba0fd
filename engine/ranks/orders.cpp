#include "engine/ranks/orders.hpp"

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

void RankPost::send(unsigned to, partition::MessageWriter message) const {
  send_shared(to, std::make_shared<const partition::Message>(message.take()));
}

void RankPost::send_to_all(partition::MessageWriter message) const {
  const auto shared = std::make_shared<const partition::Message>(message.take());
  for (unsigned to = 0; to < ranks; ++to)
    if (to != rank) send_shared(to, shared);
}

}  // namespace troupe::engine
