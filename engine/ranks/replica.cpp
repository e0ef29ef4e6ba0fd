#include "engine/ranks/replica.hpp"

#include "base/random.hpp"
#include "engine/kinds/effects.hpp"
#include "engine/links/links.hpp"
#include "engine/ranks/record_message.hpp"
#include "engine/ranks/shared_effects.hpp"
#include "engine/world/world.hpp"

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
      failed_(transport.ranks()) {
  if (options_.is_distributed) make_halo();
}

void Replica::make_halo() {
  if (const std::string reason = why_replicated(world_); !reason.empty())
    throw std::logic_error(fmt::format("the rows of this world cannot be distributed: {}", reason));
  std::vector<std::size_t> sent;
  for (std::size_t t = 0; t < sharing_.size(); ++t)
    if (sharing_[t] == Sharing::sent) sent.push_back(t);
  Halo::Post post{.rank = transport_.rank(),
                  .ranks = ranks(),
                  .begin = [this](Order order) { return message_of(order); },
                  .send =
                      [this](unsigned to, std::shared_ptr<const partition::Message> message) {
                        transport_.send(to, std::move(message));
                      },
                  .receive =
                      [this](Order order, unsigned from) {
                        ReceivedOrder received = expect(order, from);
                        if (received.order == Order::failed) throw OtherFailed();
                        return received;
                      }};
  Halo::Post post_of_effects = post;
  halo_ = std::make_unique<Halo>(world_, parts_.tables, std::move(sent), std::move(post), options_.cut_seed,
                                 options_.skin_m);
  halo_->divide();
  shared_effects_ =
      std::make_unique<SharedEffects>(world_, *halo_, parts_.effects, std::move(post_of_effects));
  is_stale_ = true;
}

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
  const bool is_sent_by_owner = wanted == Order::together || wanted == Order::exchange ||
                                wanted == Order::rows || wanted == Order::outcomes ||
                                wanted == Order::candidates || wanted == Order::effects;
  if (is_sent_by_owner && failed_[from]) return *failed_[from];
  while (true) {
    ReceivedOrder received = receive_order(transport_, from);
    const Order order = received.order;
    const bool is_of_this_world = received.world == number_;
    if (is_of_this_world && order == Order::failed) failed_[from] = received;
    if (is_of_this_world && (order == wanted || order == Order::failed)) return received;
    // The other rank sent its rows before it knew that this rank has failed.
    const bool is_of_rows = order == Order::together || order == Order::candidates || order == Order::rows;
    if (is_of_this_world && wanted == Order::exchange && is_of_rows) continue;
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
  if (halo_) return;  // Halo::distribute() sends the rows
  const std::vector<BodyId> subscribed = world_.subscribed();
  message.put(static_cast<std::uint64_t>(subscribed.size()));
  message.put_bytes(std::as_bytes(std::span(subscribed)));
  for (StateTable& table : parts_.tables) message.put_bytes(table.data());
}

void Replica::adopt_state(MessageReader message, bool is_in_tick) {
  const auto tick = message.get<std::uint64_t>();
  if (halo_) {
    halo_->own_none();
    return world_.adopt(
        tick, [](std::span<StateTable>) {}, is_in_tick);
  }
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
      distributes_ = message.get<bool>();
      if (distributes_) adopt_state(message, false);
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
      const bool verify = message.get<bool>();
      if (verify && halo_) {
        const std::vector<std::uint64_t> sums = ghost_sums();
        answer.put_bytes(std::as_bytes(std::span(sums)));
      }
      if (verify && !halo_)
        for (std::size_t t = 0; t < sharing_.size(); ++t)
          if (sharing_[t] != Sharing::kept) answer.put(world_.hash(parts_.tables[t]));
      transport_.send(0, std::move(answer));
      return;
    }
    case Order::gather: {
      MessageWriter answer = message_of(Order::gather);
      halo_ ? halo_->put_own(answer) : put_kept(answer, own());
      transport_.send(0, std::move(answer));
      return;
    }
    case Order::counts: {
      MessageWriter answer = message_of(Order::counts);
      answer.put(own_counts());
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
  std::vector<ReceivedOrder> answers;
  for (unsigned from = 1; from < ranks(); ++from) {
    answers.push_back(expect(Order::gather, from));
    if (!halo_) get_kept(answers.back().rest, rows_of(from));
  }
  if (halo_) halo_->complete(answers);
  is_stale_ = false;
}

void Replica::touch() {
  if (!leads() || is_in_tick_) return;
  gather();
  is_touched_.store(true, std::memory_order_relaxed);
  is_written_.store(true, std::memory_order_relaxed);
}

/// In a distributed world: rank 0 takes the rows of all ranks. The next tick gives them back.
void Replica::own_all() {
  gather();  // rows have data that are not state, such as subscriptions
  halo_->own_all();
}

void Replica::replace() {
  if (halo_) own_all();
  is_stale_ = false;
  is_touched_ = true;
}

void Replica::reset() {
  if (halo_) leads() ? own_all() : halo_->own_none();
  if (leads()) transport_.send_to_all(message_of(Order::reset));
  is_stale_ = false;
  is_touched_ = may_write() || (leads() && halo_);
}

void Replica::restart(std::uint64_t seed, std::span<const BodySpec> bodies) {
  if (leads()) {
    if (halo_) own_all();
    MessageWriter message = message_of(Order::restart);
    message.put(seed);
    for (const BodySpec& body : bodies) {
      message.put(body.pose_world_body);
      message.put(body.color);
    }
    transport_.send_to_all(std::move(message));
  }
  if (halo_ && !leads()) halo_->own_none();
  is_stale_ = false;
  is_touched_ = may_write() || (leads() && halo_);
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

RankCounts Replica::own_counts() const {
  RankCounts counts = halo_ ? halo_->counts() : counts_;
  counts.messages = transport_.traffic().messages;
  counts.bytes = transport_.traffic().bytes;
  return counts;
}

std::vector<RankCounts> Replica::all_counts() {
  std::vector<RankCounts> counts{own_counts()};  // before the question, whose messages do not count
  transport_.send_to_all(message_of(Order::counts));
  for (unsigned from = 1; from < ranks(); ++from)
    counts.push_back(expect(Order::counts, from).rest.get<RankCounts>());
  return counts;
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

/// Of each state table: 1 if the ghosts of a distributed world have its present values, otherwise 0.
std::vector<std::uint8_t> Replica::known_tables() const {
  std::vector<std::uint8_t> is_known;
  for (const Sharing sharing : sharing_) is_known.push_back(sharing != Sharing::kept);
  return is_known;
}

/// For each rank: Halo::hash_shown() and Halo::hash_seen().
std::vector<std::uint64_t> Replica::ghost_sums() const {
  const std::vector<std::uint8_t> is_known = known_tables();
  std::vector<std::uint64_t> sums;
  for (unsigned rank = 0; rank < ranks(); ++rank) {
    sums.push_back(halo_->hash_shown(rank, is_known));
    sums.push_back(halo_->hash_seen(rank, is_known));
  }
  return sums;
}

/// Throws std::logic_error unless all ghosts equal the rows of which they are copies. sums: ghost_sums() of
/// each rank
void Replica::check_ghosts(std::span<const std::vector<std::uint64_t>> sums) const {
  for (unsigned a = 0; a < ranks(); ++a)
    for (unsigned b = 0; b < ranks(); ++b)
      if (sums[a][2 * b] != sums[b][2 * a + 1])
        throw std::logic_error(fmt::format(
            "internal error: the ghosts of rank {} differ from the rows of rank {} after tick {}; "
            "if the world uses no plug-in, please report it",
            b, a, world_.tick()));
}

std::optional<Hashes> Replica::hashes() {
  if (!leads() || is_touched_ || (!is_stale_ && !options_.verify)) return {};
  if (halo_ && !is_stale_) return {};  // all rows are here
  MessageWriter question = message_of(Order::hash);
  question.put(options_.verify);
  transport_.send_to_all(std::move(question));
  Hashes sum = own_hashes();
  std::vector<std::vector<std::uint64_t>> ghosts(ranks());
  for (unsigned from = 1; from < ranks(); ++from) {
    ReceivedOrder answer = expect(Order::hash, from);
    MessageReader& message = answer.rest;
    const auto part = message.get<Hashes>();
    sum.state += part.state;
    for (std::size_t g = 0; g < k_hash_groups; ++g) sum.groups[g] += part.groups[g];
    if (options_.verify && halo_) {
      ghosts[from].resize(2 * std::size_t{ranks()});
      message.get_bytes(std::as_writable_bytes(std::span(ghosts[from])));
      continue;
    }
    for (std::size_t t = 0; options_.verify && t < sharing_.size(); ++t) {
      if (sharing_[t] == Sharing::kept) continue;
      const StateTable& table = parts_.tables[t];
      if (message.get<std::uint64_t>() == table.hash_rows(0, table.rows())) continue;
      throw std::logic_error(
          fmt::format("internal error: the tables \"{}\" of ranks 0 and {} differ after tick {}; unless a "
                      "plug-in caused this, it is no error of your input: please report it",
                      table.component(), from, world_.tick()));
    }
  }
  if (options_.verify && halo_) {
    ghosts[0] = ghost_sums();
    check_ghosts(ghosts);
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
    distributes_ = is_touched_.exchange(false);
  }
  if (halo_) settle_rows();
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

/// In a distributed world: leaves on each rank only its own rows and its ghosts, after rank 0 had all rows or
/// World::set() has made the reach of a device longer.
void Replica::settle_rows() {
  if (distributes_ && leads()) halo_->own_all();
  if (!distributes_ && leads() && halo_->is_complete()) halo_->forget_completion();
  if (distributes_ || world_.longest_reach() > halo_->reach()) halo_->distribute(0);
  distributes_ = false;
  is_stale_ = true;
}

void Replica::add_candidates(std::vector<Experiment::Candidate>& candidates) {
  if (!halo_) return;
  MessageWriter message = message_of(Order::candidates);
  for (const Experiment::Candidate& candidate : candidates) {
    message.put(candidate.key);
    message.put(candidate.body);
  }
  transport_.send_to_all(std::move(message));
  for (unsigned from = 0; from < ranks(); ++from) {
    if (from == transport_.rank()) continue;
    ReceivedOrder received = expect(Order::candidates, from);
    if (received.order == Order::failed) throw OtherFailed();
    while (!received.rest.is_done()) {
      Experiment::Candidate& candidate = candidates.emplace_back();
      candidate.key = received.rest.get<std::uint64_t>();
      candidate.body = received.rest.get<BodyId>();
    }
  }
}

void Replica::follow_jumps() {
  if (halo_) halo_->distribute(0);
}

void Replica::begin(Phase phase) {
  phase_ = phase;
  began_s_[static_cast<std::size_t>(phase)] = transport_.seconds();
}

void Replica::agree(const std::function<void()>& callback) {
  if (callback) {
    is_in_tick_ = false;
    if (halo_) gather();  // the callback may read all rows
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
      distributes_ = is_touched_.exchange(false);
    } else {
      ReceivedOrder received = expect(Order::agree, 0);
      if (received.order == Order::failed) {
        is_exchanged_ = true;  // the callback threw: no message follows in this tick
        throw StepError("the callback of before_tick() threw an exception on rank 0");
      }
      distributes_ = received.rest.get<bool>();
      if (distributes_) adopt_state(received.rest, true);
    }
    if (halo_) settle_rows();
  }
  is_agreed_ = true;
}

std::span<const std::uint32_t> Replica::own_of(std::span<const std::uint32_t> order) {
  if (halo_) return halo_->own_of(order);
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
  const std::uint32_t requests = options_.requests ? options_.requests() : std::uint32_t{0};
  double longest = halo_ ? halo_->longest_motion() : 0;
  const auto begin_own = [&] {
    MessageWriter own = message_of(Order::exchange);
    own.reserve(exchanged_bytes_);
    own.put(work_[transport_.rank()]);
    own.put(requests);
    return own;
  };
  if (shared_effects_) shared_effects_->note();
  is_exchanged_ = true;
  if (halo_) {
    for (unsigned to = 0; to < ranks(); ++to) {
      if (to == transport_.rank()) continue;
      MessageWriter own = begin_own();
      own.put(parts_.beams - beams_before_);
      own.put(longest);
      halo_->put_shown(to, own);
      shared_effects_->put(own);
      transport_.send(to, std::move(own));
    }
  } else {
    MessageWriter own = begin_own();
    put_written(own);
    exchanged_bytes_ = own.size();
    transport_.send_to_all(std::move(own));
  }
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
      if (halo_) {
        parts_.beams += message.get<std::uint64_t>();
        longest = std::max(longest, message.get<double>());
        halo_->get_seen(from, message);
        shared_effects_->get(message);
      } else {
        get_written(message, from);
      }
    }
  }
  if (!failures.empty()) throw_first(failures, nullptr);
  if (!halo_) return note_times();
  const bool is_unequal = have_unequal_times();
  if (is_unequal) {
    ++rebalanced_;
    halo_->balance(std::exchange(times_, std::vector<std::uint64_t>(ranks(), 0)));
  }
  const std::uint64_t distributions = halo_->counts().distributions;
  halo_->prepare_motions(longest, is_unequal);
  shared_effects_->begin(halo_->counts().distributions != distributions);
}

void Replica::apply_effects(std::span<const Effect> effects,
                            const std::function<void(const Effect&)>& apply) {
  if (shared_effects_) return shared_effects_->apply(effects, apply);
  std::ranges::for_each(effects, apply);
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

/// Called in each tick, if every rank has all rows: counts the own rows. Gives rows to other ranks if the
/// ranks take unequal times, or at random for tests. All ranks have the same times and compute the same cut.
void Replica::note_times() {
  ++counts_.ticks;
  counts_.own += own().end - own().first;
  if (options_.cut_seed) {
    Random random(*options_.cut_seed, 0, 0, static_cast<std::uint32_t>(world_.tick()));
    const auto rows = static_cast<std::uint32_t>(world_.rows());
    Cut cut{0};
    for (unsigned r = 1; r < ranks(); ++r) cut.push_back(random.below(rows + 1));
    cut.push_back(rows);
    std::ranges::sort(cut);
    return adopt_cut(std::move(cut));
  }
  if (have_unequal_times()) {
    Cut cut = balanced_cut(cut_, std::exchange(times_, std::vector<std::uint64_t>(ranks(), 0)));
    rebalanced_ += cut != cut_;
    adopt_cut(std::move(cut));
  }
}

/// Adds the times of this tick to times_. In one of k_ticks ticks, returns whether the ranks have taken
/// unequal times since the last of these ticks. If they have, the caller must set times_ to 0.
bool Replica::have_unequal_times() {
  constexpr std::uint64_t k_ticks = 32;     // between two cuts: times of single ticks vary
  constexpr double k_most_imbalance = 1.1;  // the slowest rank's time over the mean
  if (options_.cut_seed) return false;
  for (std::size_t rank = 0; rank < work_.size(); ++rank) {
    const RankWork& work = work_[rank];
    times_[rank] += static_cast<std::uint64_t>(1e9 * (work.sense_s + work.actuate_s + work.decide_s));
  }
  if (world_.tick() % k_ticks != 0) return false;
  double sum = 0;
  for (const std::uint64_t time : times_) sum += static_cast<double>(time);
  if (static_cast<double>(std::ranges::max(times_)) * ranks() > k_most_imbalance * sum) return true;
  std::ranges::fill(times_, 0);
  return false;
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
