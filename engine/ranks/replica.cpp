#include "engine/ranks/replica.hpp"

#include "base/diagnostics.hpp"
#include "engine/kinds/effects.hpp"
#include "engine/ranks/distributed_rows.hpp"
#include "engine/ranks/replicated_rows.hpp"
#include "engine/world/rank_access.hpp"
#include "engine/world/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <numeric>
#include <stdexcept>
#include <tuple>
#include <utility>

namespace troupe::engine {
namespace {

using partition::MessageReader;
using partition::MessageWriter;

}  // namespace

Replica::Replica(World& world, const Registry& registry, partition::Transport& transport,
                 std::uint32_t number, ReplicaOptions options)
    : world_(world),
      registry_(registry),
      transport_(transport),
      number_(number),
      options_(std::move(options)),
      sharing_(sharing_of(world)),
      access_(attach_to(world)),
      joined_(&world),
      work_(transport.ranks()),
      times_(transport.ranks(), 0),
      requests_(transport.ranks()),
      failed_(transport.ranks()),
      rows_(make_rows()) {}

RankAccess& Replica::attach_to(World& world) {
  world.attach(this);
  return *given_;
}

std::unique_ptr<RankRows> Replica::make_rows() {
  RankPost post{.rank = transport_.rank(),
                .ranks = ranks(),
                .begin = [this](Order order) { return message_of(order); },
                .send_shared =
                    [this](unsigned to, std::shared_ptr<const partition::Message> message) {
                      transport_.send(to, std::move(message));
                    },
                .receive =
                    [this](Order order, unsigned from) {
                      ReceivedOrder received = expect(order, from);
                      if (received.order == Order::failed) throw OtherFailed();
                      return received;
                    }};
  if (options_.is_distributed)
    return std::make_unique<DistributedRows>(world_, access_, sharing_, std::move(post), options_.cut_seed,
                                             options_.skin_m);
  return std::make_unique<ReplicatedRows>(world_, access_, sharing_, std::move(post), options_.cut_seed);
}

void Replica::Leave::operator()(World* world) const { world->attach(nullptr); }

UserRequests Replica::requests() const {
  UserRequests all;
  for (const UserRequests& requests : requests_) {
    all.saves += requests.saves;
    all.stop = all.stop || requests.stop;
  }
  return all;
}

// ---- Messages

MessageWriter Replica::message_of(Order order) const { return begin_message(order, number_); }

ReceivedOrder Replica::expect(Order wanted, unsigned from) {
  const bool is_answer = wanted == Order::hash || wanted == Order::gather || wanted == Order::counts;
  if (!is_answer && failed_[from]) return *failed_[from];
  while (true) {
    ReceivedOrder received = receive_order(transport_, from);
    const Order order = received.order;
    const bool is_of_this_world = received.world == number_;
    if (is_of_this_world && order == Order::failed) failed_[from] = received;
    // A rank that failed before the callback of before_tick() still answers the orders that the callback
    // gives.
    if (is_of_this_world && is_answer && order == Order::failed) continue;
    if (is_of_this_world && (order == wanted || order == Order::failed)) return received;
    // This rank has failed and is in fail(). The other rank sent this message before it knew of the failure.
    const bool is_before_failure = order == Order::together || order == Order::candidates ||
                                   order == Order::moves || order == Order::rows || order == Order::births ||
                                   order == Order::agree;
    if (is_of_this_world && wanted == Order::exchange && is_before_failure) continue;
    if (from == 0 && (order == Order::drop || order == Order::end))
      throw partition::RankError("rank 0 has failed in this tick: see the error of rank 0");
    const bool may_be_in_callback = has_callback_ && (wanted == Order::agree || wanted == Order::exchange);
    const bool is_order = order == Order::reset || order == Order::restart || order == Order::set ||
                          order == Order::hash || order == Order::gather || order == Order::counts;
    if (!is_of_this_world || from != 0 || !may_be_in_callback || !is_order)
      throw std::logic_error(
          fmt::format("internal error: rank {} expected message {} of rank {} and got {}; this is no error "
                      "of your input: please report it",
                      transport_.rank(), static_cast<int>(wanted), from, static_cast<int>(order)));
    follow(order, received.rest);  // from rank 0, whose callback of before_tick() uses the world
  }
}

// ---- The tick

/// On rank 0: appends whether the program has changed the state since the other ranks received it and, if so,
/// the whole state.
void Replica::put_changes(MessageWriter& message) {
  const bool is_touched = is_touched_.exchange(false);
  message.put(is_touched);
  if (is_touched) rows_->put_all(message);
}

/// On other ranks: reads what put_changes() has appended, and adopts the state if there is one. is_in_tick:
/// see RankAccess::adopt()
void Replica::get_changes(MessageReader& message, bool is_in_tick) {
  if (message.get<bool>()) rows_->adopt_all(message, is_in_tick);
}

void Replica::tick(bool has_callback, const std::function<void()>& work) {
  is_exchanged_ = false;
  observer_error_ = nullptr;
  std::ranges::fill(failed_, std::nullopt);
  phase_ = Phase::intervene;
  is_replaced_ = false;
  if (leads()) {
    has_callback_ = has_callback;
    MessageWriter message = message_of(Order::step);
    message.put(static_cast<std::uint8_t>((has_callback ? k_has_callback : 0) |
                                          (world_.state().watches_contacts ? k_watches_contacts : 0)));
    message.put(rejections_);
    put_changes(message);
    transport_.send_to_all(std::move(message));
  }
  rows_->redistribute(false);
  is_in_tick_ = true;
  try {
    work();
  } catch (...) {
    is_in_tick_ = false;  // before fail(), which may throw
    if (!is_exchanged_) fail();
    throw;
  }
  is_in_tick_ = false;
  if (observer_error_) std::rethrow_exception(std::exchange(observer_error_, nullptr));
  if (leads() && options_.keeps_references && is_read_) gather();
  if (may_write()) touch();
}

void Replica::add_candidates(std::vector<Candidate>& candidates) { rows_->add_candidates(candidates); }

void Replica::follow_jumps() { rows_->redistribute(true); }

void Replica::apply_effects(std::span<const Effect> effects,
                            const std::function<void(const Effect&)>& apply) {
  rows_->apply_effects(effects, apply);
}

bool Replica::tests_places_at(const Vec2& point) const {
  return !is_in_tick_ || rows_->tests_places_at(point);
}

std::uint32_t Replica::lowest_trial(std::uint32_t own, std::uint32_t trials) {
  return is_in_tick_ ? rows_->lowest_trial(own, trials) : own;
}

void Replica::attempt(const std::function<void()>& work) {
  if (is_in_tick_ && is_exchanged_)
    rows_->attempt(work);
  else
    work();  // if this throws before exchange(), fail() tells the other ranks
}

void Replica::end_attempts() { rows_->end_attempts(); }

void Replica::begin(Phase phase) {
  phase_ = phase;
  began_s_[static_cast<std::size_t>(phase)] = transport_.seconds();
}

void Replica::observe(const std::function<void()>& callback) {
  if (observer_error_) return;
  if (!is_exchanged_) return callback();
  try {
    callback();
  } catch (...) {
    observer_error_ = std::current_exception();
  }
}

void Replica::agree(const std::function<void()>& callback) {
  if (callback) {
    is_in_tick_ = false;
    gather_distributed();  // the callback may read all rows
    callback();
    is_in_tick_ = true;
    if (may_write()) is_touched_ = true;
  }
  if (has_callback_) {
    if (leads()) {
      MessageWriter message = message_of(Order::agree);
      message.put(is_replaced_);
      put_changes(message);
      transport_.send_to_all(std::move(message));
    } else {
      ReceivedOrder received = expect(Order::agree, 0);
      if (received.order == Order::failed) throw OtherFailed();
      // The interventions of a state with which the callback has replaced the world's are not yet applied.
      const bool is_replaced = received.rest.get<bool>();
      get_changes(received.rest, !is_replaced);
    }
    rows_->redistribute(false);
  }
  beams_before_ = access_.beams();  // not earlier: the callback may reset the world, and with it this count
}

std::span<const std::uint32_t> Replica::own_of(std::span<const std::uint32_t> order) {
  return rows_within(order, own(), order_);
}

void Replica::on_rank_0(const std::function<void()>& work) {
  const double stopped_s = transport_.seconds();
  if (leads()) {
    bool has_failed = false;
    for (unsigned from = 1; from < ranks(); ++from) {
      ReceivedOrder received = expect(Order::together, from);
      if (received.order == Order::failed)
        has_failed = true;
      else
        rows_->get_rows_of(from, received.rest);
    }
    if (has_failed) throw OtherFailed();
    work();
    for (unsigned to = 1; to < ranks(); ++to) {
      MessageWriter message = message_of(Order::together);
      rows_->put_rows_of(to, message);
      transport_.send(to, std::move(message));
    }
  } else {
    MessageWriter message = message_of(Order::together);
    rows_->put_rows_of(transport_.rank(), message);
    transport_.send(0, std::move(message));
    ReceivedOrder answer = expect(Order::together, 0);
    if (answer.order == Order::failed) throw OtherFailed();
    rows_->get_rows_of(transport_.rank(), answer.rest);
  }
  began_s_[static_cast<std::size_t>(Phase::decide)] += transport_.seconds() - stopped_s;
}

void Replica::exchange() {
  const auto began = [&](Phase phase) { return began_s_[static_cast<std::size_t>(phase)]; };
  work_[transport_.rank()] = {.rows = own().end - own().first,
                              .sense_s = began(Phase::actuate) - began(Phase::sense),
                              .actuate_s = began(Phase::decide) - began(Phase::actuate),
                              .decide_s = transport_.seconds() - began(Phase::decide)};
  MessageWriter head = message_of(Order::exchange);
  head.put(work_[transport_.rank()]);
  const UserRequests requests = options_.requests ? options_.requests() : UserRequests{};
  head.put(requests.saves);
  head.put(requests.stop);
  head.put(access_.beams() - beams_before_);
  const RankRows::Messages messages = rows_->written(head);
  is_exchanged_ = true;
  for (unsigned to = 0; to < ranks(); ++to)
    if (to != transport_.rank()) transport_.send(to, messages[to]);
  std::vector<ReceivedOrder> received(ranks());
  std::vector<Failure> failures;
  for (unsigned from = 0; from < ranks(); ++from)
    if (from != transport_.rank()) received[from] = expect(Order::exchange, from);
  for (unsigned from = 0; from < ranks(); ++from) {
    if (from == transport_.rank()) continue;
    MessageReader& message = received[from].rest;
    if (received[from].order == Order::failed) {
      failures.push_back(failure_of(message));
    } else if (failures.empty()) {
      work_[from] = message.get<RankWork>();
      requests_[from].saves = message.get<std::uint32_t>();
      requests_[from].stop = message.get<bool>();
      access_.beams() += message.get<std::uint64_t>();
      rows_->get_written(from, message);
    }
  }
  if (!failures.empty()) throw_first(failures);
  rebalanced_ += rows_->prepare_motions(unequal_times());
}

/// Adds the times of this tick to times_. Checks, once in k_ticks ticks, whether the ranks have taken unequal
/// times since the last check. If so, returns these times, ns, one per rank. Returns an empty list if the
/// times are about equal, if no check is due, or if the owners of rows are random (ReplicaOptions::cut_seed).
std::vector<std::uint64_t> Replica::unequal_times() {
  constexpr std::uint64_t k_ticks = 32;     // times of single ticks vary
  constexpr double k_most_imbalance = 1.1;  // the slowest rank's time over the mean
  constexpr double k_longest_s = 1e4;       // so that no sum of times overflows; a clock may also be set back
  if (options_.cut_seed) return {};
  for (std::size_t rank = 0; rank < work_.size(); ++rank) {
    const RankWork& work = work_[rank];
    const double time_s = work.sense_s + work.actuate_s + work.decide_s;
    if (time_s > 0) times_[rank] += static_cast<std::uint64_t>(1e9 * std::min(time_s, k_longest_s));
  }
  if (world_.tick() % k_ticks != 0) return {};
  std::vector<std::uint64_t> times = std::exchange(times_, std::vector<std::uint64_t>(ranks(), 0));
  double sum = 0;
  for (const std::uint64_t time : times) sum += static_cast<double>(time);
  if (static_cast<double>(std::ranges::max(times)) * ranks() > k_most_imbalance * sum) return times;
  return {};
}

Replica::Failure Replica::failure_of(MessageReader message) {
  Failure failure;
  failure.is_consequence = message.get<bool>();
  failure.phase = message.get<std::uint32_t>();
  failure.robot = message.get<std::uint32_t>();
  failure.text = message.get_text();
  return failure;
}

/// Called in a catch block, before exchange(): tells the other ranks that this rank cannot compute the tick,
/// and receives the failures of all ranks. Then throws the exception of this rank unchanged, unless it is a
/// StepError or OtherFailed; in these cases, calls throw_first(). Every rank that fails sends one message to
/// every other rank, also if it fails only because another rank has failed. The ranks therefore receive the
/// same failures, and no message of this tick remains.
void Replica::fail() {
  const std::exception_ptr own = std::current_exception();
  Failure failure;
  failure.phase = static_cast<std::uint32_t>(phase_);
  failure.text = fmt::format("rank {} threw an exception that is not a std::exception", transport_.rank());
  bool is_unchanged = true;
  try {
    std::rethrow_exception(own);
  } catch (const OtherFailed&) {
    is_unchanged = false;
    failure.is_consequence = true;
  } catch (const StepError& error) {
    is_unchanged = false;
    failure.error = own;
    failure.text = error.what();
    if (error.robot().valid()) failure.robot = 1 + error.robot().value;
  } catch (const std::exception& error) {
    failure.text = fmt::format("rank {}: {}", transport_.rank(), exception_text(error));
  } catch (...) {
  }
  is_exchanged_ = true;
  MessageWriter message = message_of(Order::failed);
  message.put(failure.is_consequence);
  message.put(failure.phase);
  message.put(failure.robot);
  message.put_text(failure.text);
  transport_.send_to_all(std::move(message));
  std::vector<Failure> failures;
  for (unsigned rank = 0; rank < ranks(); ++rank) {
    if (rank == transport_.rank()) {
      failures.push_back(failure);
      continue;
    }
    const ReceivedOrder other = expect(Order::exchange, rank);
    if (other.order == Order::failed) failures.push_back(failure_of(other.rest));
  }
  if (is_unchanged) std::rethrow_exception(own);
  throw_first(failures);
}

/// Throws the error that a single process would have reported, as a StepError: the error of the earliest
/// phase. Within a phase, errors without a robot (exceptions of kinds) come first, the lowest rank before the
/// others. Then come errors with a robot (commands and velocities that are not finite), the lowest robot
/// before the others.
///
/// failures: in the order of ranks
void Replica::throw_first(const std::vector<Failure>& failures) {
  const Failure& first = *std::ranges::min_element(
      failures, {}, [](const Failure& f) { return std::tuple(f.is_consequence, f.phase, f.robot); });
  if (first.error) std::rethrow_exception(first.error);
  throw StepError(first.text);
}

}  // namespace troupe::engine
