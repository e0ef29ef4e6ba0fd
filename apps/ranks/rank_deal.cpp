#include "apps/ranks/rank_deal.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>

namespace troupe::apps {
namespace {

using partition::Message;

/// Number of times per limit (RankDeal, limit_s) that a rank at work calls tell_that_it_works().
constexpr double k_reports_per_limit = 4;
/// k_result is the first byte of a message of RankDeal::gather(). k_at_work is the only byte of a message of
/// RankDeal::tell_that_it_works().
constexpr std::byte k_result{1};
constexpr std::byte k_at_work{0};

}  // namespace

RankDeal::RankDeal(unsigned threads) : threads_(threads), interval_(std::chrono::hours(1)) {}

RankDeal::RankDeal(partition::Transport& transport, unsigned threads, double limit_s)
    : transport_(&transport),
      threads_(threads),
      interval_(std::min(std::chrono::duration<double>(limit_s / k_reports_per_limit),
                         std::chrono::duration<double>(std::chrono::hours(1)))) {}

unsigned RankDeal::rank() const { return transport_ ? transport_->rank() : 0; }
unsigned RankDeal::ranks() const { return transport_ ? transport_->ranks() : 1; }

RankDeal::~RankDeal() {
  if (transport_ == nullptr || rank() > 0 || has_shared_) return;
  try {
    transport_->send_to_all(std::make_shared<const Message>());
  } catch (const partition::RankError&) {  // the run has failed already, and its error is reported
  }
}

void RankDeal::tell_that_it_works() const {
  if (transport_ == nullptr) return;
  const auto message = std::make_shared<const Message>(Message{k_at_work});
  if (rank() == 0)
    transport_->send_to_all(message);
  else
    transport_->send(0, message);
}

void RankDeal::share(Message message) {
  has_shared_ = true;
  message.push_back(std::byte{0});  // because an empty message means that share() was not called
  if (transport_ != nullptr) transport_->send_to_all(std::make_shared<const Message>(std::move(message)));
}

std::optional<Message> RankDeal::shared() {
  Message message = *transport_->receive(0);
  if (message.empty()) return {};
  has_shared_ = true;
  message.pop_back();
  return message;
}

std::vector<Message> RankDeal::gather(Message own) const {
  if (rank() > 0) {
    own.insert(own.begin(), k_result);
    transport_->send(0, std::make_shared<const Message>(std::move(own)));
    return {};
  }
  std::vector<Message> all{std::move(own)};
  for (unsigned from = 1; from < ranks(); ++from) {
    Message message = *transport_->receive(from);
    for (; message.front() == k_at_work; message = *transport_->receive(from)) tell_that_it_works();
    message.erase(message.begin());
    all.push_back(std::move(message));
  }
  return all;
}

}  // namespace troupe::apps
