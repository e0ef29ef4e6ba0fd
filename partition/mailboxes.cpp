#include "partition/mailboxes.hpp"

#include "base/random.hpp"

#include <condition_variable>
#include <map>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace troupe::partition {

struct Mailboxes::Impl {
  struct Letter {
    unsigned delay = 0;  // how many more times the receiver ignores the letter (tests only)
    std::shared_ptr<const Message> message;
  };

  struct Mailbox {
    std::mutex mutex;
    std::condition_variable changed;
    // By the sender, and by the number of the letter among those of the sender to this mailbox, from 0.
    std::map<std::pair<unsigned, std::uint64_t>, Letter> letters;
    std::optional<std::string> closed;  // after close(): the reason
  };

  class Mail : public Transport {
   public:
    Mail(Impl& all, unsigned rank, unsigned ranks)
        : all_(all), rank_(rank), sent_(ranks, 0), received_(ranks, 0) {}

    unsigned rank() const override { return rank_; }
    unsigned ranks() const override { return static_cast<unsigned>(sent_.size()); }
    std::shared_ptr<const Message> receive(unsigned from) override;
    double seconds() const override { return all_.clock ? all_.clock(rank_) : 0; }
    double waited_s() const override { return waited_s_; }

   private:
    std::shared_ptr<const Message> take(unsigned from);
    void post(unsigned to, std::shared_ptr<const Message> message) override;

    Impl& all_;
    unsigned rank_;
    std::vector<std::uint64_t> sent_;      // number of letters to each rank
    std::vector<std::uint64_t> received_;  // number of letters from each rank
    double waited_s_ = 0;
  };

  std::optional<std::uint64_t> seed;
  std::function<double(unsigned rank)> clock;
  std::vector<std::unique_ptr<Mailbox>> boxes;
  std::vector<std::unique_ptr<Mail>> mails;
};

void Mailboxes::Impl::Mail::post(unsigned to, std::shared_ptr<const Message> message) {
  Mailbox& box = *all_.boxes[to];
  const std::uint64_t number = sent_[to]++;
  Letter letter{.message = std::move(message)};
  if (all_.seed) {
    constexpr unsigned k_longest_delay = 8;
    Random random(*all_.seed, rank_, to, static_cast<std::uint32_t>(number));
    letter.delay = random.bits() % (k_longest_delay + 1);
  }
  {
    const std::lock_guard lock(box.mutex);
    box.letters.emplace(std::pair(rank_, number), std::move(letter));
  }
  box.changed.notify_one();
}

std::shared_ptr<const Message> Mailboxes::Impl::Mail::receive(unsigned from) {
  const double start_s = seconds();
  std::shared_ptr<const Message> message = take(from);
  waited_s_ += seconds() - start_s;
  return message;
}

std::shared_ptr<const Message> Mailboxes::Impl::Mail::take(unsigned from) {
  Mailbox& box = *all_.boxes[rank_];
  std::unique_lock lock(box.mutex);
  while (true) {
    const auto found = box.letters.find(std::pair(from, received_[from]));
    if (found == box.letters.end()) {
      if (box.closed) throw RankError(*box.closed);
      box.changed.wait(lock);
    } else if (found->second.delay > 0) {
      --found->second.delay;
      lock.unlock();
      std::this_thread::yield();
      lock.lock();
    } else {
      std::shared_ptr<const Message> message = std::move(found->second.message);
      box.letters.erase(found);
      ++received_[from];
      return message;
    }
  }
}

Mailboxes::Mailboxes(unsigned ranks, std::optional<std::uint64_t> seed,
                     std::function<double(unsigned rank)> clock)
    : impl_(std::make_unique<Impl>()) {
  if (ranks < 1 || ranks > k_most_ranks)
    throw std::invalid_argument(std::to_string(ranks) + " ranks: must be 1 to " +
                                std::to_string(k_most_ranks));
  impl_->seed = seed;
  impl_->clock = std::move(clock);
  for (unsigned rank = 0; rank < ranks; ++rank) {
    impl_->boxes.push_back(std::make_unique<Impl::Mailbox>());
    impl_->mails.push_back(std::make_unique<Impl::Mail>(*impl_, rank, ranks));
  }
}

Mailboxes::~Mailboxes() = default;

Transport& Mailboxes::of(unsigned rank) { return *impl_->mails[rank]; }

void Mailboxes::close(const std::string& reason) {
  for (const auto& box : impl_->boxes) {
    {
      const std::lock_guard lock(box->mutex);
      if (!box->closed) box->closed = reason;
    }
    box->changed.notify_all();
  }
}

}  // namespace troupe::partition
