#include "engine/replica.hpp"

#include "base/random.hpp"
#include "engine/effects.hpp"
#include "engine/links.hpp"
#include "engine/record_message.hpp"
#include "engine/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace troupe::engine {
namespace {

using partition::MessageReader;
using partition::MessageWriter;

/// Whether a device takes part in the phase move, which every rank computes for all rows.
bool moves(const DeviceKind& kind) {
  return kind.joints_moved != nullptr || kind.apply != nullptr || kind.born != nullptr;
}

/// Whether a device of the world declares that it reads the data `name` of other bodies (DeviceKind::reads).
bool is_read(const World& world, std::string_view name) {
  return std::ranges::any_of(world.types(), [&](const BodyType& type) {
    return std::ranges::any_of(type.devices, [&](const BodyType::Device& device) {
      return std::ranges::find(device.kind->reads, name) != device.kind->reads.end();
    });
  });
}

/// Whether the states of devices of this kind are also read by other bodies or in the phase move, not only by
/// the controllers of their own bodies.
bool shows_state(const World& world, const DeviceKind& kind) {
  return !kind.is_sensor() || kind.shows_color || kind.is_spent != nullptr || moves(kind) ||
         is_read(world, kind.name);
}

/// Whether the commands to devices of this kind are also read by other bodies or in the phase move, not only
/// by the devices themselves.
bool shows_commands(const World& world, const DeviceKind& kind) {
  return moves(kind) || is_read(world, fmt::format("{}/command", kind.name));
}

}  // namespace

std::vector<Sharing> sharing_of(const World& world) {
  const std::span<const StateTable> tables = world.tables();
  std::vector<Sharing> sharing(tables.size(), Sharing::alike);
  const auto of = [&](std::string_view component) -> Sharing& {
    return sharing[static_cast<std::size_t>(std::ranges::find(tables, component, &StateTable::component) -
                                            tables.begin())];
  };
  of("velocity") = Sharing::sent;
  of("command") = is_read(world, k_command_of_others) ? Sharing::sent : Sharing::kept;
  const bool is_running_read = is_read(world, k_runs_of_others);
  for (const BodyType& type : world.types()) {
    for (const BodyType::Device& device : type.devices) {
      if (device.table == 0) continue;  // the type has no bodies
      const std::span<const StateField> fields = tables[device.table].fields();
      const bool is_sent =
          shows_state(world, *device.kind) || (!fields.empty() && is_read(world, fields.front().name));
      sharing[device.table] = is_sent ? Sharing::sent : Sharing::kept;
      if (device.command_table)
        sharing[*device.command_table] =
            shows_commands(world, *device.kind) || (is_running_read && device.kind->drives) ? Sharing::sent
                                                                                            : Sharing::kept;
      // Whether a device is switched on is a bit of the command to the drive.
      if (is_running_read && device.switch_bit != 0) of("command") = Sharing::sent;
    }
    for (const BodyType::Controller& controller : type.controllers)
      if (controller.table) sharing[*controller.table] = Sharing::kept;
  }
  return sharing;
}

Replica::Replica(World& world, const Registry& registry, partition::Transport& transport,
                 std::uint32_t number, ReplicaOptions options)
    : world_(world),
      registry_(registry),
      transport_(transport),
      number_(number),
      options_(std::move(options)),
      sharing_(sharing_of(world)),
      parts_(world.join(this)),
      cut_(equal_cut()),
      work_(transport.ranks()),
      times_(transport.ranks(), 0),
      requests_(transport.ranks(), 0),
      failed_(transport.ranks()) {}

Replica::~Replica() { world_.join(nullptr); }

Cut Replica::equal_cut() const {
  Cut cut;
  for (std::size_t r = 0; r <= ranks(); ++r)
    cut.push_back(static_cast<std::uint32_t>(world_.rows() * r / ranks()));
  return cut;
}

std::uint64_t Replica::requests() const {
  return std::accumulate(requests_.begin(), requests_.end(), std::uint64_t{0});
}

// ---- Messages

MessageWriter Replica::message_of(Order order) const { return begin_message(order, number_); }

ReceivedOrder Replica::expect(Order wanted, unsigned from) {
  const bool is_sent_by_owner = wanted == Order::together || wanted == Order::exchange;
  if (is_sent_by_owner && failed_[from]) return *failed_[from];
  while (true) {
    ReceivedOrder received = receive_order(transport_, from);
    const Order order = received.order;
    const bool is_of_this_world = received.world == number_;
    if (is_of_this_world && order == Order::failed) failed_[from] = received;
    if (is_of_this_world && (order == wanted || order == Order::failed)) return received;
    // The other rank sent its rows before it knew that this rank has failed.
    if (is_of_this_world && wanted == Order::exchange && order == Order::together) continue;
    if (!is_of_this_world || from != 0 || wanted != Order::agree)
      throw std::logic_error(
          fmt::format("internal error: rank {} expected message {} of rank {} and got {}; this is no error "
                      "of your input: please report it",
                      transport_.rank(), static_cast<int>(wanted), from, static_cast<int>(order)));
    follow(order, received.rest);  // the callback of the program reads the state
  }
}

RowRange Replica::rows_in(const StateTable& table, const RowRange& rows) const {
  if (table.rows() == world_.rows()) return rows;
  const auto before = [&](std::size_t row) {
    const auto found = std::ranges::partition_point(
        table.ids(), [&](BodyId body) { return world_.row(body).index() < row; });
    return static_cast<std::size_t>(found - table.ids().begin());
  };
  return {before(rows.first), before(rows.end)};
}

/// Calls visit(bytes) for each contiguous piece of the tables with this sharing. Only the table rows of those
/// bodies are visited that have the rows `rows` in the world.
template <class Visit>
void Replica::for_rows(Sharing sharing, const RowRange& rows, Visit&& visit) const {
  for (std::size_t t = 0; t < parts_.tables.size(); ++t) {
    if (sharing_[t] != sharing) continue;
    StateTable& table = parts_.tables[t];
    const RowRange in = rows_in(table, rows);
    if (in.first < in.end) visit(std::span(table.row(in.first), table.row(in.end)));
  }
}

void Replica::put_kept(MessageWriter& message, const RowRange& rows) const {
  for_rows(Sharing::kept, rows, [&](std::span<std::byte> bytes) { message.put_bytes(bytes); });
}

void Replica::get_kept(MessageReader& message, const RowRange& rows) {
  for_rows(Sharing::kept, rows, [&](std::span<std::byte> bytes) { message.get_bytes(bytes); });
}

/// Appends the rows whose present values other ranks do not have: those in tables that are kept or sent.
void Replica::put_own(MessageWriter& message, const RowRange& rows) const {
  const auto put = [&](std::span<std::byte> bytes) { message.put_bytes(bytes); };
  for_rows(Sharing::kept, rows, put);
  for_rows(Sharing::sent, rows, put);
}

void Replica::get_own(MessageReader& message, const RowRange& rows) {
  const auto get = [&](std::span<std::byte> bytes) { message.get_bytes(bytes); };
  for_rows(Sharing::kept, rows, get);
  for_rows(Sharing::sent, rows, get);
}

/// Appends the whole state, and the subscriptions (World::subscribe()).
void Replica::put_state(MessageWriter& message) {
  message.put(world_.tick());
  const std::vector<BodyId> subscribed = world_.subscribed();
  message.put(static_cast<std::uint64_t>(subscribed.size()));
  message.put_bytes(std::as_bytes(std::span(subscribed)));
  for (StateTable& table : parts_.tables) message.put_bytes(table.data());
}

void Replica::adopt_state(MessageReader message, bool is_in_tick) {
  const auto tick = message.get<std::uint64_t>();
  std::vector<BodyId> subscribed(message.get<std::uint64_t>());
  message.get_bytes(std::as_writable_bytes(std::span(subscribed)));
  for (const BodyId body : subscribed) world_.subscribe(body);
  world_.adopt(
      tick,
      [&](std::span<StateTable> tables) {
        for (StateTable& table : tables) message.get_bytes(table.data());
      },
      is_in_tick);
}

// ---- Orders

void Replica::follow(Order order, MessageReader message) {
  switch (order) {
    case Order::step:
      has_callback_ = message.get<bool>();
      if (message.get<bool>()) adopt_state(message, false);
      try {
        world_.step();
      } catch (const StepError&) {  // thrown on all ranks, and reported by rank 0
      }
      return;
    case Order::reset: return world_.reset();
    case Order::restart: {
      const auto seed = message.get<std::uint64_t>();
      std::vector<BodySpec> bodies = world_.spec().bodies;
      for (BodySpec& body : bodies) {
        body.pose_world_body = message.get<Pose>();
        body.color = message.get<Color>();
      }
      return world_.restart(seed, bodies, registry_);
    }
    case Order::set: {
      SettingSpec setting;
      setting.type = message.get<TypeId>();
      setting.of = message.get<SettingSpec::Of>();
      setting.index = message.get<std::uint32_t>();
      setting.params = get_record(message);
      if (const Result<> done = world_.set(setting, registry_); !done)
        throw std::logic_error(
            fmt::format("internal error: rank {}: {}; this is no error of your input: please report it",
                        transport_.rank(), done.error().text));
      return;
    }
    case Order::hash: {
      MessageWriter answer = message_of(Order::hash);
      answer.put(own_hashes());
      if (message.get<bool>())
        for (std::size_t t = 0; t < sharing_.size(); ++t)
          if (sharing_[t] != Sharing::kept) answer.put(world_.hash(parts_.tables[t]));
      transport_.send(0, std::move(answer));
      return;
    }
    case Order::gather: {
      MessageWriter answer = message_of(Order::gather);
      put_kept(answer, own());
      transport_.send(0, std::move(answer));
      return;
    }
    case Order::failed: return;  // from a tick that has already ended on this rank
    default:
      throw std::logic_error(
          fmt::format("internal error: rank {} got order {} between two ticks; this is no error of your "
                      "input: please report it",
                      transport_.rank(), static_cast<int>(order)));
  }
}

void Replica::gather() {
  if (!leads() || is_in_tick_) return;
  if (!is_read_) is_read_ = true;  // no write later, when several threads may call this
  if (!is_stale_) return;
  transport_.send_to_all(message_of(Order::gather));
  for (unsigned from = 1; from < ranks(); ++from) {
    ReceivedOrder answer = expect(Order::gather, from);
    get_kept(answer.rest, rows_of(from));
  }
  is_stale_ = false;
}

void Replica::touch() {
  if (!leads() || is_in_tick_) return;
  gather();
  is_touched_.store(true, std::memory_order_relaxed);
  is_written_.store(true, std::memory_order_relaxed);
}

void Replica::replace() {
  is_stale_ = false;
  is_touched_ = true;
}

void Replica::reset() {
  if (leads()) transport_.send_to_all(message_of(Order::reset));
  is_stale_ = false;
  is_touched_ = may_write();
}

void Replica::restart(std::uint64_t seed, std::span<const BodySpec> bodies) {
  if (leads()) {
    MessageWriter message = message_of(Order::restart);
    message.put(seed);
    for (const BodySpec& body : bodies) {
      message.put(body.pose_world_body);
      message.put(body.color);
    }
    transport_.send_to_all(std::move(message));
  }
  is_stale_ = false;
  is_touched_ = may_write();
}

void Replica::set(const SettingSpec& setting) {
  if (!leads()) return;
  MessageWriter message = message_of(Order::set);
  message.put(setting.type);
  message.put(setting.of);
  message.put(setting.index);
  put_record(message, setting.params);
  transport_.send_to_all(std::move(message));
}

Hashes Replica::own_hashes() {
  Hashes hashes;
  for (const StateTable& table : parts_.tables) {
    constexpr std::size_t k_block = 1024;  // rows per task
    const RowRange in = rows_in(table, own());
    std::atomic<std::uint64_t> sum = 0;
    world_.parallel().for_each((in.end - in.first + k_block - 1) / k_block, [&](std::size_t b) {
      const std::size_t first = in.first + b * k_block;
      sum.fetch_add(table.hash_rows(first, std::min(in.end, first + k_block)), std::memory_order_relaxed);
    });
    hashes.groups[static_cast<std::size_t>(table.group())] += sum;
    hashes.state += sum;
  }
  return hashes;
}

std::optional<Hashes> Replica::hashes() {
  if (!leads() || is_touched_ || (!is_stale_ && !options_.verify)) return {};
  MessageWriter question = message_of(Order::hash);
  question.put(options_.verify);
  transport_.send_to_all(std::move(question));
  Hashes sum = own_hashes();
  for (unsigned from = 1; from < ranks(); ++from) {
    ReceivedOrder answer = expect(Order::hash, from);
    MessageReader& message = answer.rest;
    const auto part = message.get<Hashes>();
    sum.state += part.state;
    for (std::size_t g = 0; g < k_hash_groups; ++g) sum.groups[g] += part.groups[g];
    for (std::size_t t = 0; options_.verify && t < sharing_.size(); ++t) {
      if (sharing_[t] == Sharing::kept) continue;
      const StateTable& table = parts_.tables[t];
      if (message.get<std::uint64_t>() == table.hash_rows(0, table.rows())) continue;
      throw std::logic_error(
          fmt::format("internal error: the tables \"{}\" of ranks 0 and {} differ after tick {}; if the "
                      "world uses no plug-in, please report it",
                      table.component(), from, world_.tick()));
    }
  }
  return sum;
}

// ---- The tick

void Replica::tick(bool has_callback, const std::function<void()>& work) {
  is_exchanged_ = is_agreed_ = false;
  std::ranges::fill(failed_, std::nullopt);
  phase_ = Phase::intervene;
  beams_before_ = parts_.beams;
  if (leads()) {
    has_callback_ = has_callback;
    MessageWriter message = message_of(Order::step);
    message.put(has_callback);
    message.put(is_touched_.load());
    if (is_touched_) put_state(message);
    transport_.send_to_all(std::move(message));
    is_touched_ = false;
  }
  is_in_tick_ = true;
  try {
    work();
  } catch (...) {
    is_in_tick_ = false;  // first: fail() throws
    if (!is_exchanged_) fail();
    throw;
  }
  is_in_tick_ = false;
  is_stale_ = true;
  if (leads() && options_.keeps_references && is_read_) gather();
  if (may_write()) touch();
}

void Replica::begin(Phase phase) {
  phase_ = phase;
  began_s_[static_cast<std::size_t>(phase)] = transport_.seconds();
}

void Replica::agree(const std::function<void()>& callback) {
  if (callback) {
    is_in_tick_ = false;
    callback();
    is_in_tick_ = true;
    if (may_write()) is_touched_ = true;
  }
  if (has_callback_) {
    if (leads()) {
      MessageWriter message = message_of(Order::agree);
      message.put(is_touched_.load());
      if (is_touched_) put_state(message);
      transport_.send_to_all(std::move(message));
      is_touched_ = false;
    } else {
      ReceivedOrder received = expect(Order::agree, 0);
      if (received.order == Order::failed) {
        is_exchanged_ = true;  // the callback threw: no message follows in this tick
        throw StepError("the callback of before_tick() threw an exception on rank 0");
      }
      if (received.rest.get<bool>()) adopt_state(received.rest, true);
    }
  }
  is_agreed_ = true;
}

std::span<const std::uint32_t> Replica::own_of(std::span<const std::uint32_t> order) {
  const auto [first, end] = own();
  order_.resize(order.size());
  std::size_t count = 0;
  for (const std::uint32_t row : order) {  // without a branch, which would be unpredictable
    order_[count] = row;
    count += row >= first && row < end;
  }
  return std::span(order_).first(count);
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
        get_own(received.rest, rows_of(from));
    }
    if (has_failed) throw OtherFailed();
    work();
    for (unsigned to = 1; to < ranks(); ++to) {
      MessageWriter message = message_of(Order::together);
      put_own(message, rows_of(to));
      transport_.send(to, std::move(message));
    }
  } else {
    MessageWriter message = message_of(Order::together);
    put_own(message, own());
    transport_.send(0, std::move(message));
    ReceivedOrder answer = expect(Order::together, 0);
    if (answer.order == Order::failed) throw OtherFailed();
    get_own(answer.rest, own());
  }
  began_s_[static_cast<std::size_t>(Phase::decide)] += transport_.seconds() - stopped_s;
}

/// Appends those data that this rank has written in the phases sense, actuate and decide, and that other
/// ranks read.
void Replica::put_written(MessageWriter& message) {
  message.put(parts_.beams - beams_before_);
  const RowRange rows = own();
  for_rows(Sharing::sent, rows, [&](std::span<std::byte> bytes) { message.put_bytes(bytes); });
  const std::vector<Links::AskedGoal> goals = parts_.links.asked_goals(rows);
  message.put(static_cast<std::uint64_t>(goals.size()));
  message.put_bytes(std::as_bytes(std::span(goals)));
  const std::span<const Effect> effects = parts_.effects.emitted();
  message.put(static_cast<std::uint64_t>(effects.size()));
  message.put_bytes(std::as_bytes(effects));
}

void Replica::get_written(MessageReader& message, unsigned from) {
  parts_.beams += message.get<std::uint64_t>();
  for_rows(Sharing::sent, rows_of(from), [&](std::span<std::byte> bytes) { message.get_bytes(bytes); });
  for (auto left = message.get<std::uint64_t>(); left > 0; --left) {
    const auto [row, joint, goal] = message.get<Links::AskedGoal>();
    parts_.links.ask(Row(row), joint, goal);
  }
  for (auto left = message.get<std::uint64_t>(); left > 0; --left) parts_.effects.emit(message.get<Effect>());
  if (!message.is_done())
    throw std::logic_error(
        "internal error: a message between ranks is too long; this is no error of your input: please report "
        "it");
}

void Replica::exchange() {
  const auto began = [&](Phase phase) { return began_s_[static_cast<std::size_t>(phase)]; };
  work_[transport_.rank()] = {.rows = this->own().end - this->own().first,
                              .sense_s = began(Phase::actuate) - began(Phase::sense),
                              .actuate_s = began(Phase::decide) - began(Phase::actuate),
                              .decide_s = transport_.seconds() - began(Phase::decide)};
  MessageWriter own = message_of(Order::exchange);
  own.reserve(exchanged_bytes_);
  own.put(work_[transport_.rank()]);
  own.put(options_.requests ? options_.requests() : std::uint32_t{0});
  put_written(own);
  exchanged_bytes_ = own.size();
  is_exchanged_ = true;
  transport_.send_to_all(std::move(own));
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
      requests_[from] = message.get<std::uint32_t>();
      get_written(message, from);
    }
  }
  if (!failures.empty()) throw_first(failures, nullptr);
  note_times();
}

Replica::Failure Replica::failure_of(MessageReader message) {
  Failure failure;
  failure.phase = message.get<std::uint32_t>();
  failure.robot = message.get<std::uint32_t>();
  failure.text = message.get_text();
  return failure;
}

/// Called in a catch block: tells the other ranks that this rank cannot compute the tick. If several ranks
/// fail, all of them throw the same StepError, unless their own exception is of another type. A rank that
/// fails only because another has failed sends an empty text.
void Replica::fail() {
  const std::exception_ptr own = std::current_exception();
  Failure failure{static_cast<std::uint32_t>(phase_), 0, "an exception that is not a std::exception"};
  try {
    std::rethrow_exception(own);
  } catch (const OtherFailed&) {
    failure.text.clear();
  } catch (const StepError& error) {
    failure.text = error.what();
    if (error.robot().valid()) failure.robot = 1 + error.robot().value;
  } catch (const std::exception& error) {
    failure.text = fmt::format("rank {}: {}", transport_.rank(), error.what());
  } catch (...) {
  }
  is_exchanged_ = true;
  const bool is_callback = has_callback_ && !is_agreed_;
  if (is_callback && !leads()) return;
  MessageWriter message = message_of(Order::failed);
  message.put(failure.phase);
  message.put(failure.robot);
  message.put_text(failure.text);
  transport_.send_to_all(std::move(message));
  if (is_callback) return;  // the other ranks wait only for this message
  std::vector<Failure> failures;
  for (unsigned rank = 0; rank < ranks(); ++rank) {
    if (rank == transport_.rank()) {
      failures.push_back(failure);
      continue;
    }
    const ReceivedOrder other = expect(Order::exchange, rank);
    if (other.order == Order::failed) failures.push_back(failure_of(other.rest));
  }
  throw_first(failures, own);
}

/// Throws the error that a single process would have reported: the error of the earliest phase. Within a
/// phase, exceptions of kinds come before velocities that are not finite; then the lowest robot or rank
/// counts. own: the exception of this rank, if it has one; thrown unchanged if it is no StepError.
void Replica::throw_first(std::vector<Failure>& failures, const std::exception_ptr& own) {
  if (own) {
    try {
      std::rethrow_exception(own);
    } catch (const StepError&) {
    } catch (const OtherFailed&) {
    }
  }
  std::erase_if(failures, [](const Failure& f) { return f.text.empty(); });
  std::ranges::stable_sort(failures, {}, [](const Failure& f) { return std::pair(f.phase, f.robot); });
  throw StepError(failures.front().text);
}

// ---- Which rows a rank owns

Cut balanced_cut(const Cut& cut, std::span<const std::uint64_t> times) {
  const std::size_t ranks = times.size();
  const auto rows = [&](std::size_t rank) { return cut[rank + 1] - cut[rank]; };
  double total = 0;
  for (std::size_t rank = 0; rank < ranks; ++rank)
    if (rows(rank) > 0) total += static_cast<double>(times[rank]);
  if (!(total > 0)) return cut;
  Cut balanced(ranks + 1, cut.back());
  balanced[0] = 0;
  double before = 0;  // time of the ranks before `rank`
  std::size_t rank = 0;
  for (std::size_t next = 1; next < ranks; ++next) {
    const double wanted = total * static_cast<double>(next) / static_cast<double>(ranks);
    const auto time = [&] { return rows(rank) > 0 ? static_cast<double>(times[rank]) : 0.0; };
    while (rank + 1 < ranks && before + time() < wanted) before += time(), ++rank;
    const double part = time() > 0 ? std::min(1.0, (wanted - before) / time()) : 0.0;
    balanced[next] = cut[rank] + static_cast<std::uint32_t>(std::lround(part * rows(rank)));
  }
  return balanced;
}

/// Gives rows to other ranks if the ranks take unequal times, or at random for tests. All ranks have the same
/// times and compute the same cut.
void Replica::note_times() {
  if (options_.cut_seed) {
    Random random(*options_.cut_seed, 0, 0, static_cast<std::uint32_t>(world_.tick()));
    const auto rows = static_cast<std::uint32_t>(world_.rows());
    Cut cut{0};
    for (unsigned r = 1; r < ranks(); ++r) cut.push_back(random.below(rows + 1));
    cut.push_back(rows);
    std::ranges::sort(cut);
    return adopt_cut(std::move(cut));
  }
  constexpr std::uint64_t k_ticks = 32;     // between two cuts: times of single ticks vary
  constexpr double k_most_imbalance = 1.1;  // the slowest rank's time over the mean
  for (std::size_t rank = 0; rank < work_.size(); ++rank) {
    const RankWork& work = work_[rank];
    times_[rank] += static_cast<std::uint64_t>(1e9 * (work.sense_s + work.actuate_s + work.decide_s));
  }
  if (world_.tick() % k_ticks != 0) return;
  double sum = 0;
  for (const std::uint64_t time : times_) sum += static_cast<double>(time);
  if (static_cast<double>(std::ranges::max(times_)) * ranks() > k_most_imbalance * sum) {
    Cut cut = balanced_cut(cut_, times_);
    rebalanced_ += cut != cut_;
    adopt_cut(std::move(cut));
  }
  std::ranges::fill(times_, 0);
}

/// Adopts a cut. The rows of tables that are kept go from their old owners to the new ones.
void Replica::adopt_cut(Cut cut) {
  const Cut before = std::exchange(cut_, std::move(cut));
  const auto common = [](const Cut& a, unsigned i, const Cut& b, unsigned j) {
    return RowRange{std::max(a[i], b[j]), std::min(a[i + 1], b[j + 1])};
  };
  const unsigned own = transport_.rank();
  for (unsigned to = 0; to < ranks(); ++to) {
    const RowRange rows = common(before, own, cut_, to);
    if (to == own || rows.first >= rows.end) continue;
    MessageWriter message = message_of(Order::exchange);
    put_kept(message, rows);
    transport_.send(to, std::move(message));
  }
  for (unsigned from = 0; from < ranks(); ++from) {
    const RowRange rows = common(before, from, cut_, own);
    if (from == own || rows.first >= rows.end) continue;
    ReceivedOrder received = expect(Order::exchange, from);
    get_kept(received.rest, rows);
  }
}

}  // namespace troupe::engine
