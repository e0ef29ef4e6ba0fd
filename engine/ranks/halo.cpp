#include "engine/ranks/halo.hpp"

#include "base/capacity.hpp"
#include "base/random.hpp"
#include "base/sort.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace troupe::engine {
namespace {

using partition::MessageReader;
using partition::MessageWriter;
using partition::TileOwners;

// The skin (class Halo) without the option skin_m, as a multiple of the longest motion in a tick. Two bodies
// can approach each other by two such motions per tick, so rows are distributed about once in half as many
// ticks.
constexpr double k_skin_motions = 16;

/// Appends the data that a table has for a row, if it has any.
void put_table_row(const World& world, const StateTable& table, Row row, MessageWriter& message) {
  if (const std::optional<std::size_t> at = world.view().find_in(table, row))
    message.put_bytes({table.row(*at), table.row_bytes()});
}

/// Reads what put_table_row() has appended for the same table and row, and overwrites the data of the row.
void get_table_row(const World& world, StateTable& table, Row row, MessageReader& message) {
  if (const std::optional<std::size_t> at = world.view().find_in(table, row))
    message.get_bytes({table.row(*at), table.row_bytes()});
}

/// The squares of which the regions of ranks consist: a quarter of a tile of the index each, so that ranks
/// can divide the bodies more evenly.
partition::GridGeometry owned_squares(const World& world) {
  partition::GridGeometry squares = world.view().geometry();
  if (squares.tile_bits > 0) --squares.tile_bits;
  return squares;
}

/// The place of the row's body (class Halo, `owners`), m, world frame.
Vec2 place_of(const World& world, Row row) { return world.view().transform(world.view().root(row)).position; }

/// The keys of the squares of all bodies in the world among the first `rows` rows, sorted.
std::vector<TileOwners::Key> sorted_keys(const World& world, std::size_t rows) {
  std::vector<TileOwners::Key> keys;
  for (std::size_t r = 0; r < rows; ++r)
    if (world.view().is_there(Row(r)))
      keys.push_back(TileOwners::key(owned_squares(world), place_of(world, Row(r))));
  std::ranges::sort(keys);
  return keys;
}

/// The key of a square, and the part of the time of its rank that counts for the key, ns.
struct WeightedKey {
  TileOwners::Key key;
  std::uint64_t weight;
};

/// Returns the keys at which the list must be cut so that each rank gets about the same weight.
std::vector<TileOwners::Key> weighted_cut(std::vector<WeightedKey> all, unsigned ranks) {
  std::ranges::sort(all, {}, [](const WeightedKey& each) { return std::pair(each.key, each.weight); });
  std::uint64_t total = 0;
  for (const WeightedKey& each : all) total += each.weight;
  std::vector<TileOwners::Key> cut;
  std::uint64_t before = 0;
  for (const WeightedKey& each : all) {
    while (cut.size() + 1 < ranks && before >= total / ranks * (cut.size() + 1)) cut.push_back(each.key);
    before += each.weight;
  }
  cut.resize(ranks - 1, all.empty() ? 0 : all.back().key + 1);
  return cut;
}

}  // namespace

Halo::Halo(World& world, RankAccess& access, std::vector<std::size_t> sent, RankPost post,
           std::optional<std::uint64_t> cut_seed, std::optional<double> skin_m)
    : world_(world),
      access_(access),
      tables_(access.tables()),
      links_(access.links()),
      sent_(std::move(sent)),
      post_(std::move(post)),
      cut_seed_(cut_seed),
      skin_m_(skin_m),
      extent_(extent_of(world)),
      own_(world.view().rows()),
      shown_(post_.ranks),
      seen_(post_.ranks),
      shown_rows_(post_.ranks),
      seen_rows_(post_.ranks),
      border_(world, post_, extent_.has_pushable) {}

HaloPlan plan_halo(const World& world, unsigned ranks, double longest_motion) {
  HaloPlan plan{.coverage_m = Halo::extent_of(world).of_all(longest_motion) + k_skin_motions * longest_motion,
                .ranks = std::vector<HaloPlan::Rank>(ranks)};
  const std::vector<TileOwners::Key> keys = sorted_keys(world, world.view().rows());
  const TileOwners owners(owned_squares(world), TileOwners::equal_cut(keys, ranks));
  std::vector<std::set<unsigned>> neighbours(ranks);
  std::vector<unsigned> near;
  for (std::size_t r = 0; r < world.view().rows(); ++r) {
    const Vec2 at = place_of(world, Row(r));
    const unsigned owner = owners.owner(at);
    ++plan.ranks[owner].own;
    near.clear();
    if (world.view().is_there(Row(r))) owners.find_near(at, plan.coverage_m, near);
    for (const unsigned rank : near) {
      ++plan.ranks[rank].ghosts;
      neighbours[rank].insert(owner);
      neighbours[owner].insert(rank);
    }
  }
  for (unsigned rank = 0; rank < ranks; ++rank) plan.ranks[rank].neighbours = neighbours[rank].size();
  return plan;
}

// ---- Which rank owns which rows

/// Chooses the coverage. It suffices for motions of up to `longest` (m) in this tick and, because of the
/// skin, in some later ticks.
void Halo::choose_coverage(double longest) {
  longest = std::max(longest, longest_);  // bodies may soon move as far as in this tick
  double skin = k_skin_motions * longest;
  if (cut_seed_) {
    // Tests need both thin and thick skins. With a thin skin, the rows are often distributed. With a thick
    // skin, bodies move far before the rows are distributed again, so that a missing ghost would change the
    // results of own rows.
    Random random(*cut_seed_, stream_id("ranks", "skin"), 0, static_cast<std::uint32_t>(world_.tick()));
    skin = random.below(random.below(2) == 0 ? 4 : 32) * longest;
  }
  coverage_ = extent_.of_all(longest) + skin_m_.value_or(skin);
  moved_ = 0;
  border_.take_pushed();  // bodies were pushed before this distribution
}

void Halo::divide() {
  keys_ = sorted_keys(world_, world_.view().rows());
  owners_ = TileOwners(owned_squares(world_), TileOwners::equal_cut(keys_, post_.ranks));
  if (cut_seed_)
    cut_again();
  else
    keys_ = {};
  choose_coverage(0);
  std::vector<BodyId> leaving;
  std::vector<RowState> ghosts;
  std::vector<unsigned> near;
  for (std::size_t r = 0; r < world_.view().rows(); ++r) {
    if (owners_.owner(place(Row(r))) == post_.rank) continue;
    leaving.push_back(world_.view().body(Row(r)));
    find_ranks_near(Row(r), near);
    if (std::ranges::binary_search(near, post_.rank))
      ghosts.push_back({leaving.back(), access_.row_bytes(Row(r))});
  }
  own_ = world_.view().rows() - leaving.size();
  access_.exchange_rows(leaving, ghosts, own_);
  release_freed_memory();
  is_complete_ = false;
  note_neighbours();
}

/// Sets `near` to the ranks that must have a row as a ghost, in ascending order. An unborn or dead body is a
/// ghost only as a guest.
void Halo::find_ranks_near(Row row, std::vector<unsigned>& near) const {
  near.clear();
  if (world_.view().is_there(row)) owners_.find_near(place(row), coverage_, near);
  if (guests_.empty()) return;
  const BodyId root = world_.view().body(world_.view().root(row));
  auto guest = std::ranges::lower_bound(guests_, root, {}, &Guest::root);
  if (guest == guests_.end() || guest->root != root) return;
  for (; guest != guests_.end() && guest->root == root; ++guest) near.push_back(owners_.owner(guest->host));
  std::erase(near, owners_.owner(place(row)));
  std::ranges::sort(near);
  near.erase(std::unique(near.begin(), near.end()), near.end());
}

/// Divides the ground among the ranks at random. All ranks compute the same division, because it depends only
/// on the seed, the tick and the positions at tick 0.
void Halo::cut_again() {
  Random random(*cut_seed_, stream_id("ranks", "cut"), 0, static_cast<std::uint32_t>(world_.tick()));
  owners_ = TileOwners(owned_squares(world_), TileOwners::random_cut(keys_, post_.ranks, random));
}

void Halo::balance(std::span<const std::uint64_t> times) {
  // Each rank sends the keys of at most k_most_keys of its rows, evenly spaced in the order of keys.
  constexpr std::size_t k_most_keys = 512;
  const std::vector<TileOwners::Key> keys = sorted_keys(world_, own_);
  const std::size_t sent = std::min(keys.size(), k_most_keys);
  std::vector<TileOwners::Key> own;
  for (std::size_t i = 0; i < sent; ++i) own.push_back(keys[(2 * i + 1) * keys.size() / (2 * sent)]);
  MessageWriter message = post_.begin(Order::rows);
  message.put_bytes(std::as_bytes(std::span(own)));
  post_.send_to_all(std::move(message));
  std::vector<WeightedKey> all;
  const auto add = [&](unsigned from, std::span<const TileOwners::Key> some) {
    for (const TileOwners::Key key : some) all.push_back({key, 1 + times[from] / some.size()});
  };
  add(post_.rank, own);
  post_.receive_from_all(Order::rows, [&](unsigned from, MessageReader& theirs) {
    std::vector<TileOwners::Key> received;
    while (!theirs.is_done()) received.push_back(theirs.get<TileOwners::Key>());
    add(from, received);
  });
  owners_ = TileOwners(owned_squares(world_), weighted_cut(std::move(all), post_.ranks));
}

void Halo::put_row(MessageWriter& message, Row row) const {
  message.put(world_.view().body(row));
  message.put_point(place(row));
  message.put_all(std::span<const std::byte>(access_.row_bytes(row)));
  message.put_all(std::span<const Goal>(goals_of({row.index(), row.index() + 1})));
}

Halo::Arrival Halo::get_row(MessageReader& message) const {
  Arrival arrival;
  const std::size_t bodies = world_.spec().bodies.size();
  arrival.state.body = message.get_below<BodyId>(bodies);
  arrival.place = message.get_point();
  arrival.state.bytes = message.get_all<std::byte>();
  arrival.goals = message.get_all<Goal>();
  for (const Goal& goal : arrival.goals)
    message.require(goal.body.index() < bodies && goal.joint < world_.view().type(goal.body).joints.size());
  return arrival;
}

/// The goals of joints of these rows in this tick. They are no state, so they are lost when rows change.
std::vector<Halo::Goal> Halo::goals_of(RowRange rows) const {
  std::vector<Goal> goals;
  for (const auto& [row, joint, goal] : links_.asked_goals(rows))
    goals.push_back({world_.view().body(Row(row)), joint, goal});
  return goals;
}

/// Sets the goals of joints again after rows have changed; leaves out those of bodies without a row here.
void Halo::set_goals(std::span<const Goal> goals) {
  for (const auto& [body, joint, goal] : goals)
    if (world_.view().location(body) == RowLocation::here) links_.ask(world_.view().row(body), joint, goal);
}

/// Makes the largest radius of a tree known to all ranks. The radius does not decrease when trees end, only
/// when rank 0 takes all rows (own_all()): otherwise each body that is gripped when there are no such trees
/// would cause a distribution (suffices_for()).
void Halo::agree_on_trees() {
  if (!extent_.has_trees) return;
  const double own = std::max(extent_.radius, extent_of(world_).radius);
  extent_.radius = post_.agree(Order::rows, own, [](double a, double b) { return std::max(a, b); });
}

void Halo::distribute(double longest, std::span<const Guest> guests) {
  guests_.assign(guests.begin(), guests.end());
  std::ranges::sort(guests_, {}, &Guest::root);
  extent_.reach = world_.interventions().settings().longest_reach();
  agree_on_trees();
  if (cut_seed_) cut_again();
  choose_coverage(longest);
  const std::vector<Goal> goals = goals_of({0, own_});
  std::vector<BodyId> leaving;
  std::vector<Arrival> arrivals;
  send_rows(leaving, arrivals);
  receive_rows(arrivals);
  exchange_rows(leaving, arrivals);
  set_goals(goals);
  for (const Arrival& arrival : arrivals) set_goals(arrival.goals);
  is_complete_ = false;
  ++counts_.distributions;
  note_neighbours();
}

/// Sends each own row to the rank that will own it and to the ranks that will have it as a ghost. Appends the
/// bodies of the own rows that this rank gives away, and of all present ghosts, to `leaving`, and the rows
/// that change from own to ghost to `arrivals`.
void Halo::send_rows(std::vector<BodyId>& leaving, std::vector<Arrival>& arrivals) {
  std::vector<MessageWriter> messages;
  for (unsigned to = 0; to < post_.ranks; ++to) messages.push_back(post_.begin(Order::rows));
  std::vector<unsigned> near;
  for (std::size_t r = 0; r < own_; ++r) {
    const Row row(r);
    find_ranks_near(row, near);
    const unsigned owner = owners_.owner(place(row));
    if (owner != post_.rank) {
      ++counts_.migrated;
      leaving.push_back(world_.view().body(row));
      put_row(messages[owner], row);
    }
    for (const unsigned to : near) {
      if (to != post_.rank)
        put_row(messages[to], row);
      else
        arrivals.push_back({{world_.view().body(row), access_.row_bytes(row)}, place(row), {}});
    }
  }
  for (std::size_t r = own_; r < world_.view().rows(); ++r) leaving.push_back(world_.view().body(Row(r)));
  for (unsigned to = 0; to < post_.ranks; ++to)
    if (to != post_.rank) post_.send(to, std::move(messages[to]));
}

/// Receives the rows that send_rows() of the other ranks has sent to this rank.
void Halo::receive_rows(std::vector<Arrival>& arrivals) {
  post_.receive_from_all(Order::rows, [&](unsigned, MessageReader& message) {
    while (!message.is_done()) arrivals.push_back(get_row(message));
  });
}

/// Removes the rows of `leaving` from the world, and adds those of `arrivals`: first the rows that this rank
/// will own, then the ghosts, and each group by ids, so that the order of rows does not depend on which ranks
/// sent them. Moves the states out of `arrivals`.
void Halo::exchange_rows(std::span<const BodyId> leaving, std::vector<Arrival>& arrivals) {
  own_ = world_.view().rows() - leaving.size();
  std::vector<std::uint64_t> keys;
  for (const Arrival& arrival : arrivals) {
    const bool is_ghost = owners_.owner(arrival.place) != post_.rank;
    own_ += is_ghost ? 0 : 1;
    keys.push_back(std::uint64_t{is_ghost} << 32 | arrival.state.body.value);
  }
  std::vector<RowState> coming;
  for (const std::size_t next : sorted_order(keys)) coming.push_back(std::move(arrivals[next].state));
  access_.exchange_rows(leaving, coming, own_);
}

void Halo::give(std::span<const Gift> gifts) {
  const unsigned self = post_.rank;
  const auto gift_of = [&](Row row) {
    const BodyId root = world_.view().body(world_.view().root(row));
    const auto gift = std::ranges::lower_bound(gifts, root, {}, &Gift::root);
    return gift != gifts.end() && gift->root == root ? gift : gifts.end();
  };
  if (std::ranges::none_of(gifts, [&](const Gift& gift) { return gift.from == self || gift.to == self; }))
    return;
  std::vector<std::optional<MessageWriter>> messages(post_.ranks);
  std::vector<BodyId> leaving;
  for (std::size_t r = 0; r < world_.view().rows(); ++r) {
    const auto gift = r < own_ ? gift_of(Row(r)) : gifts.end();
    if (r < own_ && gift == gifts.end()) continue;
    leaving.push_back(world_.view().body(Row(r)));
    if (r >= own_) continue;  // a ghost: the rows that come must precede all ghosts
    std::optional<MessageWriter>& message = messages[gift->to];
    if (!message) message = post_.begin(Order::rows);
    put_row(*message, Row(r));
  }
  for (unsigned to = 0; to < post_.ranks; ++to)
    if (messages[to]) post_.send(to, *std::move(messages[to]));
  std::vector<RowState> coming;
  for (unsigned from = 0; from < post_.ranks; ++from) {
    const auto is_from = [&](const Gift& gift) { return gift.to == self && gift.from == from; };
    if (std::ranges::none_of(gifts, is_from)) continue;
    ReceivedOrder received = post_.receive(Order::rows, from);
    while (!received.rest.is_done()) coming.push_back(get_row(received.rest).state);
  }
  own_ = world_.view().rows() - leaving.size() + coming.size();
  access_.exchange_rows(leaving, coming, own_);
  is_complete_ = false;
}

/// Called after the rows were distributed: makes the lists of the bodies whose rows this rank exchanges with
/// other ranks (shown_ and seen_), and counts these ranks.
void Halo::note_neighbours() {
  for (std::vector<std::vector<BodyId>>* lists : {&shown_, &seen_})
    for (std::vector<BodyId>& list : *lists) list.clear();
  std::vector<unsigned> near;
  for (std::size_t r = 0; r < world_.view().rows(); ++r) {
    const BodyId body = world_.view().body(Row(r));
    if (r >= own_) {
      seen_[owners_.owner(place(Row(r)))].push_back(body);
      continue;
    }
    find_ranks_near(Row(r), near);
    for (const unsigned to : near) shown_[to].push_back(body);
  }
  for (std::vector<std::vector<BodyId>>* lists : {&shown_, &seen_})
    for (std::vector<BodyId>& list : *lists) sort_ids(list);
  neighbours_ = 0;
  for (std::size_t rank = 0; rank < post_.ranks; ++rank)
    neighbours_ += !shown_[rank].empty() || !seen_[rank].empty();
  find_rows();
}

/// Looks up the rows of the bodies in shown_ and seen_.
void Halo::find_rows() {
  for (std::size_t rank = 0; rank < post_.ranks; ++rank) {
    for (const auto& [bodies, rows] : {std::pair(&shown_, &shown_rows_), std::pair(&seen_, &seen_rows_)}) {
      (*rows)[rank].clear();
      for (const BodyId body : (*bodies)[rank]) (*rows)[rank].push_back(world_.view().row(body).value);
    }
  }
}

// ---- A tick

double Halo::longest_motion() const {
  double longest2 = 0;
  for (std::size_t r = 0; r < own_; ++r) {
    const Velocity& v = world_.view().velocities()[r];
    longest2 = std::max(longest2, v.x * v.x + v.y * v.y);
  }
  return sqrt(longest2) * world_.view().tick_s();
}

/// Adds to moved_ the amount, if positive, by which the longest push of a body in the last tick exceeds
/// longest_.
void Halo::note_pushes() { moved_ += std::max(0.0, border_.take_pushed() - longest_); }

bool Halo::lacks_ghosts() {
  note_pushes();
  return extent_.of_sensing() + 2 * moved_ + k_slack_m > coverage_;
}

void Halo::prepare_motions(double longest, bool distributes, std::span<const Guest> guests) {
  ++counts_.ticks;
  note_pushes();
  const bool covers_motions = extent_.of_motions(longest) + 2 * moved_ + k_slack_m <= coverage_;
  const bool covers_sensing = extent_.of_sensing() + 2 * (moved_ + longest) + k_slack_m <= coverage_;
  distributes = distributes || !covers_motions || !covers_sensing;
  if (cut_seed_) {
    Random random(*cut_seed_, stream_id("ranks", "when"), 0, static_cast<std::uint32_t>(world_.tick()));
    distributes = distributes || random.below(32) == 0;
  }
  if (distributes) distribute(longest, guests);
  moved_ += longest;
  longest_ = longest;
  border_.begin_tick({own_, shown_rows_, seen_rows_}, 2 * extent_.zone(longest));
  counts_.own += own_;
  counts_.ghosts += world_.view().rows() - own_;
  counts_.neighbours += neighbours_;
}

void Halo::put_shown(unsigned to, MessageWriter& message) const {
  for (const std::uint32_t r : shown_rows_[to])
    for (const std::size_t t : sent_) put_table_row(world_, tables_[t], Row(r), message);
  if (!links_.any()) return;
  for (const std::uint32_t r : shown_rows_[to])
    for (std::size_t j = 0; j < world_.view().type(Row(r)).joints.size(); ++j) {
      const std::optional<Pose> goal = links_.asked(Row(r), j);
      message.put(static_cast<std::uint8_t>(goal.has_value()));
      if (goal) message.put(*goal);
    }
}

void Halo::get_seen(unsigned from, MessageReader& message) {
  for (const std::uint32_t r : seen_rows_[from])
    for (const std::size_t t : sent_) get_table_row(world_, tables_[t], Row(r), message);
  if (!links_.any()) return;
  for (const std::uint32_t r : seen_rows_[from])
    for (std::uint32_t j = 0; j < world_.view().type(Row(r)).joints.size(); ++j)
      if (message.get<std::uint8_t>() != 0) links_.ask(Row(r), j, message.get<Pose>());
}

bool Halo::has_cargo(BodyId body) const {
  if (!links_.any() || body.index() >= world_.spec().bodies.size()) return false;
  if (world_.view().location(body) != RowLocation::here || world_.view().row(body).index() >= own_)
    return false;
  return links_.first_cargo(world_.view().row(body)) != Links::k_none;
}

/// The ranks that have the row of an own body as a ghost, in ascending order.
std::vector<unsigned> Halo::shown_to(BodyId body) const {
  std::vector<unsigned> ranks;
  for (unsigned to = 0; to < post_.ranks; ++to)
    if (std::ranges::binary_search(shown_[to], body.value, {}, &BodyId::value)) ranks.push_back(to);
  return ranks;
}

bool Halo::suffices_for(Row row) const {
  const Row root = world_.view().root(row);
  const Vec2 at = place(root);
  if (owners_.owner(at) != post_.rank || links_.farthest(root) > extent_.radius) return false;
  const std::vector<unsigned> shown = shown_to(world_.view().body(root));
  if (row != root && shown_to(world_.view().body(row)) != shown) return false;
  // A body without a ghost on a rank was farther than the coverage from the ground of this rank when the rows
  // were distributed, and has moved by at most moved_ since then, if it was not pushed in this tick. The
  // places of bodies that have changed their trees since then were tested here, in the same way.
  std::vector<unsigned> near;
  owners_.find_near(at, coverage_ - moved_, near);
  return std::ranges::includes(shown, near);
}

void Halo::link_again(std::span<const Row> ghosts) {
  if (!links_.any()) return;  // no body here can carry others, so no tree here has changed
  links_.link_all();
  for (const Row row : ghosts) links_.reshape(row.value);
}

Vec2 Halo::place(Row row) const { return place_of(world_, row); }

std::vector<Row> Halo::tree(Row row) const {
  std::vector<Row> rows{world_.view().root(row)};
  if (world_.view().counts().carried > 0) links_.add_cargo(rows.front(), rows);
  return rows;
}

unsigned Halo::owner(BodyId body) const {
  if (world_.view().row(body).index() < own_) return post_.rank;
  const auto found = std::ranges::find_if(seen_, [&](const std::vector<BodyId>& list) {
    return std::ranges::binary_search(list, body.value, {}, &BodyId::value);
  });
  return static_cast<unsigned>(found - seen_.begin());
}

void Halo::put_state(MessageWriter& message, BodyId body) const {
  for (const StateTable& table : tables_) put_table_row(world_, table, world_.view().row(body), message);
}

void Halo::get_state(MessageReader& message, BodyId body) {
  for (StateTable& table : tables_) get_table_row(world_, table, world_.view().row(body), message);
}

std::uint64_t Halo::hash(std::span<const std::uint32_t> rows, std::span<const std::uint8_t> is_known) const {
  std::uint64_t sum = 0;
  for (const std::uint32_t r : rows)
    for (std::size_t t = 0; t < tables_.size(); ++t)
      if (const std::optional<std::size_t> at = world_.view().find_in(tables_[t], Row(r));
          at && is_known[t] != 0)
        sum += tables_[t].hash_row(*at);
  return sum;
}

// ---- All rows on one rank

void Halo::put_own(MessageWriter& message) const {
  for (std::size_t r = 0; r < own_; ++r) put_row(message, Row(r));
}

void Halo::complete(std::span<ReceivedOrder> messages) {
  std::vector<BodyId> leaving;
  for (std::size_t r = own_; r < world_.view().rows(); ++r) leaving.push_back(world_.view().body(Row(r)));
  std::vector<RowState> coming;
  for (ReceivedOrder& message : messages)
    while (!message.rest.is_done()) coming.push_back(get_row(message.rest).state);
  access_.exchange_rows(leaving, coming, own_ + coming.size());
  is_complete_ = true;
}

void Halo::forget_completion() {
  std::vector<BodyId> stays;
  for (const std::vector<BodyId>& list : seen_) stays.insert(stays.end(), list.begin(), list.end());
  sort_ids(stays);
  std::vector<BodyId> leaving;
  for (std::size_t r = own_; r < world_.view().rows(); ++r)
    if (const BodyId body = world_.view().body(Row(r)); !std::ranges::binary_search(stays, body))
      leaving.push_back(body);
  access_.exchange_rows(leaving, {}, own_);
  is_complete_ = false;
  find_rows();  // shown_ and seen_ must not change, because they match the lists of the other ranks
}

void Halo::own_all() {
  std::vector<RowState> coming;
  for (std::size_t b = 0; b < world_.spec().bodies.size(); ++b)
    if (world_.view().location(BodyId(b)) == RowLocation::elsewhere) coming.push_back({BodyId(b), {}});
  own_ = world_.view().rows() + coming.size();
  access_.exchange_rows({}, coming, own_);
  extent_.radius = extent_of(world_).radius;  // a new run may begin, whose trees may be smaller
  is_complete_ = true;
}

void Halo::own_none() {
  std::vector<BodyId> leaving;
  for (std::size_t r = 0; r < world_.view().rows(); ++r) leaving.push_back(world_.view().body(Row(r)));
  own_ = 0;
  access_.exchange_rows(leaving, {}, 0);
  extent_.radius = extent_of(world_).radius;  // as in own_all(): rank 0 has all trees
  is_complete_ = false;
}

}  // namespace troupe::engine
