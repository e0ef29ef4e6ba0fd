#include "sensors/radio.hpp"

#include "base/bearings.hpp"
#include "base/math.hpp"
#include "base/random.hpp"
#include "engine/kinds/make_device_kind.hpp"
#include "engine/observing/lint_view.hpp"
#include "engine/sensing/line_crossings.hpp"
#include "engine/sensing/sensing_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::sensors {
namespace {

using engine::BodyType;
using engine::CommittedView;
using engine::DeviceKind;
using engine::Element;
using engine::SenseBatch;
using partition::BodyCircle;

// Listeners (radios that hear) within a square search together for speakers (radios that send). The edge of
// the square is this number times the parameter `hears` of the listeners.
constexpr double k_group_reaches = 2.25;

enum class Walls : std::uint8_t { block, weaken, pass };
constexpr std::array<std::string_view, 3> names_of(Walls) { return {"block", "weaken", "pass"}; }
enum class Bodies : std::uint8_t { block, pass };
constexpr std::array<std::string_view, 2> names_of(Bodies) { return {"block", "pass"}; }
enum class Law : std::uint8_t { disc, friis, itu_indoor, log_distance };
constexpr std::array<std::string_view, 4> names_of(Law) {
  return {"disc", "friis", "itu_indoor", "log_distance"};
}

struct Radio {
  struct Params {
    double range = 5;
    double hears = 0;
    std::string channel;
    std::uint32_t payload = 8;
    std::uint32_t most_heard = 16;
    double drop_rate = 0;
    Walls walls = Walls::block;
    Bodies bodies = Bodies::pass;
    Law law = Law::disc;
    double power = 20;         // dBm
    double sensitivity = -80;  // dBm
    double frequency = 2.4;    // GHz
    double power_loss_coefficient = 30;
    double path_loss_exponent = 4;
    double wall_loss = 10;  // dB
    bool beacon = false;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      using enum engine::Unit;
      constexpr double k_farthest = 10000;  // m
      constexpr double k_most_power = 200;  // dBm
      d.member<&Params::range>("range", meters, above(0), at_most(k_farthest),
                               "largest distance at which other radios hear this radio, whatever the `law`");
      d.member<&Params::hears>("hears", meters, within(0, k_farthest),
                               "largest distance from which this radio hears others; 0: the same as `range`");
      d.member<&Params::channel>("channel",
                                 "name of the channel; a radio hears only radios on the same channel");
      d.member<&Params::payload>(
          "payload", within(1, 255),
          "largest length of a message, bytes; longer ones are neither sent nor heard");
      d.member<&Params::most_heard>("most_heard", within(1, 1000),
                                    "largest number of messages heard in a tick; if more arrive, the nearest "
                                    "are heard and the others count as `lost`");
      d.member<&Params::drop_rate>("drop_rate", within(0, 1),
                                   "probability that a message to this radio is dropped");
      d.member<&Params::walls>(
          "walls",
          "how static geometry between two radios affects a message: blocks it, weakens it or "
          "lets it pass; only geometry that rangers see has an effect");
      d.member<&Params::bodies>(
          "bodies",
          "how other bodies between two radios affect a message: block it or let it pass; only "
          "bodies that rangers see have an effect");
      d.member<&Params::law>("law",
                             "law by which messages weaken with the distance, see docs/radio.md; with `disc` "
                             "they do not weaken");
      d.member<&Params::power>("power_dBm", within(-k_most_power, k_most_power), "transmission power");
      d.member<&Params::sensitivity>("sensitivity_dBm", within(-k_most_power, k_most_power),
                                     "messages that arrive weaker than this are not heard");
      d.member<&Params::frequency>("frequency_GHz", within(0.001, 1000), used_unless("law", "disc"),
                                   "carrier frequency; all laws but `disc` use it");
      d.member<&Params::power_loss_coefficient>(
          "power_loss_coefficient", within(0, 100), used_if("law", "itu_indoor"),
          "parameter N of the law `itu_indoor`: loss in dB per factor of ten in the distance");
      d.member<&Params::path_loss_exponent>("path_loss_exponent", within(0, 10),
                                            used_if("law", "log_distance"),
                                            "exponent n of the law `log_distance`: 2 in free space");
      d.member<&Params::wall_loss>("wall_loss_dB", within(0, 1000), used_if("walls", "weaken"),
                                   "loss for each wall between the radios, if `walls` is `weaken`");
      d.member<&Params::beacon>(
          "beacon",
          "true: the radio sends an empty message in each tick until a controller sets another message");
    }
  };

  static constexpr std::array reads{std::string_view("radio/command"), engine::k_runs_of_others};

  Params params;
  Pose pose_body_radio;
  double hears = 0;        // m
  double loss_at_1m = 0;   // dB
  double loss_a_fold = 0;  // dB by which the loss grows if the distance grows by a factor of e

  static DeviceKind::Prepared prepare(const Params& params, const Pose& pose_body_radio);
  Result<> bind_part(const engine::TypeSpec& type, std::uint32_t part);
  std::uint64_t sense(const SenseBatch& batch) const;
  void lint(const engine::LintView& view) const;

  bool bodies_block() const { return params.bodies == Bodies::block; }
  /// Whether the loss depends on the distance.
  bool has_law() const { return params.law != Law::disc; }
  double loss(double distance) const {
    if (!has_law() || distance == 0) return 0;
    return std::max(0.0, loss_at_1m + loss_a_fold * log(distance));
  }
};

/// A radio of a body type. It is on the listener's channel, so the listener can hear it if the two are near
/// enough.
struct Sender {
  const Radio* radio;
  const BodyType::Device* device;
  std::uint32_t ordinal;  // among the radios of its body on this channel
  const engine::StateTable* commands;
  bool
      always_runs;  // whether it runs whenever it works, because it has neither an energy supply nor a switch
  Vec2 position;    // frame of the body, or of the joint that carries the radio, m
  double limit;     // longest link to the listener, m
};

/// A radio that sends a message and that some of the listeners may hear.
struct Speaker {
  BodyCircle circle;
  BodyId body;
  std::uint32_t length = 0;   // of the message, bytes
  Vec2 place = Vec2::Zero();  // m, world frame
  double limit = 0;           // longest link to the listeners, m
  const Radio* radio = nullptr;
  const BodyType::Device* device = nullptr;
  std::uint32_t ordinal = 0;  // as in Sender
  const std::uint8_t* message = nullptr;

  Row row() const { return Row(circle.row); }
};

/// A link from a speaker to the listener.
struct Link {
  double range = 0;
  double loss = 0;  // dB
  const Speaker* speaker = nullptr;
};

/// Finds the messages that the radios of a batch hear. Radios near one another share the search for speakers
/// and the sorting of the speakers in the order of readings. Each thread keeps one object of this class,
/// which keeps its buffers, so that only the first searches allocate memory.
class Listener {
 public:
  Listener() {
    for (Known& known : known_) known.senders.reserve(4);
  }

  /// Writes the readings of all rows of the batch. Returns the number of lines between radios that it tested
  /// for walls and bodies.
  std::uint64_t listen(const SenseBatch& batch);

 private:
  void begin(const SenseBatch& batch);
  std::span<const Sender> senders(const BodyType& type);
  void find_speakers(const Box& listeners);
  void consider(const BodyCircle& circle, const Sender& sender);
  const Speaker& speaker(std::uint64_t key) const { return speakers_[static_cast<std::uint32_t>(key)]; }
  void fetch_readings(std::size_t slot) const;
  void listen(std::size_t i);
  void find_links();
  double height(const Speaker& speaker) const;
  void weaken_links();
  void find_obstacles();
  bool arrives(Link& link);
  /// The largest loss, dB, with which the current listener (the radio whose readings are computed) hears the
  /// speaker.
  double budget_of(const Speaker& speaker) const {
    return speaker.radio->params.power - radio_->params.sensitivity;
  }
  engine::SpatialLine line_to(const Speaker& speaker) const;
  /// The number of walls between the speaker and the current listener that weaken the message; -1 if a wall
  /// or a body between them blocks it.
  int hindrances(const Speaker& speaker);
  bool is_dropped(const Speaker& speaker) const;
  void keep_nearest();
  double quality(const Link& link) const;
  void write(std::size_t slot);

  const SenseBatch* batch_ = nullptr;
  const CommittedView* view_ = nullptr;
  const Radio* radio_ = nullptr;
  const DeviceKind* kind_ = nullptr;
  struct Known {
    const BodyType* type = nullptr;
    std::vector<Sender> senders;
  };
  std::array<Known, 8> known_;         // cache of senders(), by type number modulo its size
  std::vector<engine::Mount> mounts_;  // of the batch
  Vec2 position_ = Vec2::Zero();       // of the radio, in the frame of its mount
  Rotation turn_;                      // of the radio, in the frame of its mount

  // Shared by listeners near one another.
  std::vector<BodyCircle> bodies_;    // bodies near any of them, if bodies block messages
  std::vector<Speaker> speakers_;     // in the order in which they were found
  std::vector<std::uint64_t> order_;  // their order in the readings: body id * 2^32 + index in speakers_
  struct Reach {                      // in that order: a listener outside this circle cannot hear the speaker
    double x, y, radius2;
  };
  std::vector<Reach> reaches_;

  // For the current listener.
  Row own_;
  BodyId id_;
  Vec2 here_ = Vec2::Zero();
  double z_ = 0;
  Rotation to_own_frame_;
  std::vector<std::uint32_t> in_reach_;                    // indices in reaches_
  std::vector<Link> links_;                                // in the order of readings
  std::vector<std::pair<double, std::uint32_t>> nearest_;  // range and index of links
  std::vector<Vec2> ways_;               // displacements to speakers, frame of the listener's radio, m
  engine::LineCrossings lines_between_;  // walls and bodies between the radios
  bool has_walls_ = false;               // whether walls may hide some of its links
  std::uint32_t lost_ = 0;
  std::uint32_t dropped_ = 0;
  std::uint64_t lines_ = 0;
};

void Listener::begin(const SenseBatch& batch) {
  batch_ = &batch;
  view_ = &batch.committed;
  radio_ = std::any_cast<Radio>(&batch.data);
  kind_ = view_->type(batch.rows.front()).devices[batch.device].kind;
  for (Known& known : known_) known.type = nullptr;
  position_ = radio_->pose_body_radio.position();
  turn_ = Rotation(radio_->pose_body_radio.heading);
  lines_ = 0;
  has_walls_ = false;
  // Reserved up front for crowds of up to 1024.
  const std::size_t room = std::min<std::size_t>(view_->rows(), 1024);
  mounts_.reserve(room);
  speakers_.reserve(room);
  order_.reserve(room);
  reaches_.reserve(room);
  in_reach_.reserve(room);
  links_.reserve(room);
  nearest_.reserve(room);
  ways_.reserve(room);
  if (radio_->bodies_block()) bodies_.reserve(room);
}

std::uint64_t Listener::listen(const SenseBatch& batch) {
  begin(batch);
  mounts_.clear();
  for (std::size_t i = 0; i < batch.rows.size(); ++i) mounts_.push_back(batch.mount(i));
  const auto place = [&](std::size_t i) { return Vec2(mounts_[i].transform * position_); };
  for (std::size_t first = 0; first < mounts_.size();) {
    Box listeners = Box::around(place(first), 0);
    std::size_t last = first + 1;
    for (; last < mounts_.size(); ++last) {
      Box more = listeners;
      more.extend(place(last));
      if (more.size().maxCoeff() > k_group_reaches * radio_->hears) break;
      listeners = more;
    }
    find_speakers(listeners);
    for (; first < last; ++first) {
      if (first + 1 < mounts_.size()) fetch_readings(batch.slot(first + 1));
      listen(first);
    }
  }
  return lines_;
}

std::span<const Sender> Listener::senders(const BodyType& type) {
  const auto number = static_cast<std::size_t>(&type - view_->types().data());
  Known& known = known_[number % known_.size()];
  if (&type == known.type) return known.senders;
  known.type = &type;
  known.senders.clear();
  std::uint32_t on_channel = 0;
  for (const BodyType::Device& device : type.devices) {
    if (device.kind != kind_) continue;
    const Radio& radio = *std::any_cast<Radio>(&device.prepared.data);
    if (radio.params.channel != radio_->params.channel) continue;
    const std::uint32_t ordinal = on_channel++;
    // Such a radio is too weak for the listener even at distance 0. It is tested here because weaken_links()
    // may skip the tests of single links.
    if (radio.params.power < radio_->params.sensitivity) continue;
    const bool always_runs = device.active && !device.supply && device.switch_bit == 0;
    known.senders.push_back({&radio, &device, ordinal, &view_->commands(device), always_runs,
                             radio.pose_body_radio.position(), std::min(radio_->hears, radio.params.range)});
  }
  return known.senders;
}

/// Finds the radios that send a message which some of the listeners in the box (world frame, m) may hear.
void Listener::find_speakers(const Box& listeners) {
  bodies_.clear();
  speakers_.clear();
  view_->index().for_each_near(listeners.expanded(radio_->hears), [&](const BodyCircle& circle) {
    if (radio_->bodies_block()) bodies_.push_back(circle);
    for (const Sender& sender : senders(view_->type(Row(circle.row)))) consider(circle, sender);
  });
  order_.clear();
  for (std::size_t i = 0; i < speakers_.size(); ++i)
    order_.push_back((std::uint64_t{speakers_[i].body.value} << 32) | i);
  std::ranges::sort(order_);
  reaches_.clear();
  for (const std::uint64_t key : order_) {
    const BodyCircle& circle = speaker(key).circle;
    const double reach = radio_->hears + circle.radius;
    reaches_.push_back({circle.x, circle.y, reach * reach});
  }
}

void Listener::consider(const BodyCircle& circle, const Sender& sender) {
  const Row row(circle.row);
  const auto* command = reinterpret_cast<const std::uint8_t*>(sender.commands->row(view_->slot(row)));
  const auto mode = static_cast<RadioMode>(command[k_radio_mode]);
  const bool says =
      mode == RadioMode::says || (mode == RadioMode::as_world_says && sender.radio->params.beacon);
  if (!says || command[k_radio_bytes] > sender.radio->params.payload) return;
  const bool runs = sender.always_runs ? view_->works(row, *sender.device) : view_->runs(row, *sender.device);
  if (!runs) return;
  const std::int32_t joint = sender.device->joint;
  speakers_.push_back({.circle = circle,
                       .body = view_->body(row),
                       .length = command[k_radio_bytes],
                       .place = joint == engine::k_rigid
                                    ? Vec2(view_->transform(row) * sender.position)
                                    : Vec2(view_->mount(row, joint).transform * sender.position),
                       .limit = sender.limit,
                       .radio = sender.radio,
                       .device = sender.device,
                       .ordinal = sender.ordinal,
                       .message = command + k_radio_said});
}

/// Prefetches the readings in this slot, about a kilobyte, while another radio listens.
void Listener::fetch_readings(std::size_t slot) const {
  constexpr std::size_t k_line = 64;  // bytes
  const std::byte* row = batch_->state.row(slot);
  const std::size_t bytes = std::min<std::size_t>(batch_->state.row_bytes(), 1024);
  for (std::size_t at = 0; at < bytes; at += k_line) __builtin_prefetch(row + at, 1);
}

void Listener::listen(std::size_t i) {
  own_ = batch_->rows[i];
  id_ = batch_->body(i);
  const engine::Mount& mount = mounts_[i];
  here_ = mount.transform * position_;
  z_ = mount.z + radio_->pose_body_radio.z;
  // The inverse of the rotation of the radio in the world frame, which is the product of both rotations.
  const Rotation& body = mount.transform.rotation;
  to_own_frame_.cos = body.cos * turn_.cos - body.sin * turn_.sin;
  to_own_frame_.sin = -(body.sin * turn_.cos + body.cos * turn_.sin);
  lost_ = 0;
  dropped_ = 0;
  find_links();
  weaken_links();
  keep_nearest();
  write(batch_->slot(i));
}

/// Finds the speakers in range. The loops have no branch on whether a speaker is in range, because such a
/// branch would be unpredictable: they write every candidate and advance only past candidates in range.
void Listener::find_links() {
  in_reach_.resize(reaches_.size());
  std::size_t near = 0;
  for (std::uint32_t i = 0; i < reaches_.size(); ++i) {
    const Reach& reach = reaches_[i];
    in_reach_[near] = i;
    near += (Vec2(reach.x, reach.y) - here_).squaredNorm() <= reach.radius2;
  }
  links_.resize(near);
  std::size_t linked = 0;
  for (const std::uint32_t i : std::span(in_reach_).first(near)) {
    const Speaker& other = speaker(order_[i]);
    const double range = (other.place - here_).norm();
    links_[linked] = {.range = range, .loss = 0, .speaker = &other};
    linked += range <= other.limit && !view_->same_tree(other.row(), own_);
  }
  links_.resize(linked);
}

/// Computes the losses of the links, and removes the links whose message does not arrive or is lost.
void Listener::weaken_links() {
  has_walls_ = false;
  if (radio_->params.walls != Walls::pass || radio_->bodies_block()) find_obstacles();
  if (!has_walls_ && !radio_->bodies_block() && !radio_->has_law() && radio_->params.drop_rate == 0 &&
      std::ranges::all_of(links_,
                          [&](const Link& link) { return link.speaker->length <= radio_->params.payload; }))
    return;
  std::erase_if(links_, [&](Link& link) { return !arrives(link); });
}

/// Collects the walls and bodies that may be between the listener and the speakers.
void Listener::find_obstacles() {
  lines_ += links_.size();
  const bool may_have_walls = radio_->params.walls != Walls::pass && view_->scene().edge_count() > 0;
  if (links_.empty() || !(may_have_walls || radio_->bodies_block())) return;
  lines_between_.stand(*view_, here_);
  if (radio_->bodies_block()) lines_between_.find_bodies(radio_->hears, bodies_);
  if (!may_have_walls) return;
  double farthest = 0;
  for (const Link& link : links_) farthest = std::max(farthest, link.range);
  has_walls_ = lines_between_.find_walls(farthest);
}

bool Listener::arrives(Link& link) {
  const Speaker& speaker = *link.speaker;
  const double budget = budget_of(speaker);
  link.loss = radio_->loss(link.range);
  if (link.loss > budget) return false;
  if (radio_->params.walls != Walls::pass || radio_->bodies_block()) {
    const int walls = hindrances(speaker);
    if (walls < 0) return false;
    link.loss += walls * radio_->params.wall_loss;
    if (link.loss > budget) return false;
  }
  if (is_dropped(speaker)) {
    ++dropped_;
    return false;
  }
  if (speaker.length > radio_->params.payload) {
    ++lost_;
    return false;
  }
  return true;
}

/// Every radio of the speaker's body has a random number of its own: four of them share a block of four
/// words.
bool Listener::is_dropped(const Speaker& speaker) const {
  if (radio_->params.drop_rate == 0) return false;
  const std::uint64_t seed = view_->spec().seed;
  const std::array<std::uint32_t, 4> words = philox4x32(
      {speaker.body.value, batch_->stream, id_.value, static_cast<std::uint32_t>(view_->tick())},
      {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32) + speaker.ordinal / 4});
  return words[speaker.ordinal % 4] * 0x1p-32 < radio_->params.drop_rate;
}

/// The height of a speaker's radio, m, world frame.
double Listener::height(const Speaker& speaker) const {
  const std::int32_t joint = speaker.device->joint;
  const double base = joint == engine::k_rigid ? view_->poses()[speaker.row().index()].z
                                               : view_->mount(speaker.row(), joint).z;
  return base + speaker.radio->pose_body_radio.z;
}

/// The straight line between the radios. It starts at the radio on the body with the lower id, so that both
/// directions give the same result.
engine::SpatialLine Listener::line_to(const Speaker& speaker) const {
  const double z = height(speaker);
  if (speaker.body < id_) return {speaker.place, z, here_, z_};
  return {here_, z_, speaker.place, z};
}

int Listener::hindrances(const Speaker& speaker) {
  if (!has_walls_ && !radio_->bodies_block()) return 0;
  const engine::SpatialLine line = line_to(speaker);
  if (line.length2 == 0) return 0;
  if (radio_->bodies_block() && lines_between_.crosses_body(line, speaker.row(), own_)) return -1;
  if (!has_walls_) return 0;
  if (radio_->params.walls == Walls::block) return lines_between_.crosses_wall(line) ? -1 : 0;
  return lines_between_.count_walls(line);
}

/// Keeps the `most_heard` nearest links, in their order; at equal ranges those of senders with lower ids.
void Listener::keep_nearest() {
  if (links_.size() <= radio_->params.most_heard) return;
  nearest_.clear();
  for (std::uint32_t i = 0; i < links_.size(); ++i) nearest_.emplace_back(links_[i].range, i);
  const auto end = nearest_.begin() + static_cast<std::ptrdiff_t>(radio_->params.most_heard);
  std::ranges::nth_element(nearest_, end);
  std::size_t kept = 0;
  for (std::uint32_t i = 0; i < links_.size(); ++i)
    if (std::pair(links_[i].range, i) < *end) links_[kept++] = links_[i];
  lost_ += static_cast<std::uint32_t>(links_.size() - kept);
  links_.resize(kept);
}

double Listener::quality(const Link& link) const {
  const double budget = budget_of(*link.speaker);
  if (!(budget > 0)) return 0;
  const double of_loss = link.loss > 0 ? 1 - link.loss / budget : 1;
  const double of_range = radio_->has_law() ? 1 : 1 - link.range / link.speaker->limit;
  return std::max(std::min(of_loss, of_range), 0.0);
}

void Listener::write(std::size_t slot) {
  engine::StateTable& state = batch_->state;
  std::uint32_t& count = state.cell<std::uint32_t>(slot, k_radio_count)[0];
  // The count of a checkpoint may be wrong.
  const std::size_t before = std::min<std::size_t>(count, radio_->params.most_heard);
  const std::size_t now = links_.size();
  count = static_cast<std::uint32_t>(now);
  state.cell<std::uint32_t>(slot, k_radio_lost)[0] = lost_;
  state.cell<std::uint32_t>(slot, k_radio_dropped)[0] = dropped_;
  const auto senders = state.cell<std::uint32_t>(slot, k_radio_sender);
  const auto ranges = state.cell<float>(slot, k_radio_range);
  const auto bearings = state.cell<float>(slot, k_radio_bearing);
  const auto strengths = state.cell<float>(slot, k_radio_strength);
  const auto qualities = state.cell<float>(slot, k_radio_quality);
  const auto lengths = state.cell<std::uint8_t>(slot, k_radio_length);
  const auto payloads = state.cell<std::uint8_t>(slot, k_radio_payload);
  // Clears the payloads of this tick and of the previous one, because messages may be shorter than `payload`.
  std::ranges::fill(payloads.first(std::max(before, now) * radio_->params.payload), 0);
  ways_.resize(now);
  for (std::size_t i = 0; i < now; ++i) {
    const Link& link = links_[i];
    const Speaker& speaker = *link.speaker;
    senders[i] = speaker.body.value;
    ranges[i] = static_cast<float>(link.range);
    strengths[i] = static_cast<float>(speaker.radio->params.power - link.loss + 0.0);
    qualities[i] = static_cast<float>(quality(link));
    ways_[i] = to_own_frame_ * (speaker.place - here_);
  }
  to_bearings(ways_, bearings);
  for (std::size_t i = 0; i < now; ++i) {
    const Speaker& speaker = *links_[i].speaker;
    lengths[i] = static_cast<std::uint8_t>(speaker.length);
    if (speaker.length > 0)
      std::memcpy(&payloads[i * radio_->params.payload], speaker.message, speaker.length);
  }
  if (before <= now) return;
  const auto clear = [&](auto entries) { std::ranges::fill(entries.subspan(now, before - now), 0); };
  clear(senders);
  clear(ranges);
  clear(bearings);
  clear(strengths);
  clear(qualities);
  clear(lengths);
}

std::uint64_t Radio::sense(const SenseBatch& batch) const {
  thread_local const auto listener = std::make_unique<Listener>();
  return listener->listen(batch);
}

DeviceKind::Prepared Radio::prepare(const Params& params, const Pose& pose_body_radio) {
  Radio radio{.params = params,
              .pose_body_radio = pose_body_radio,
              .hears = params.hears == 0 ? params.range : params.hears};
  constexpr double k_light = 299792458;  // m/s
  const double decade = 1 / log(10.0);   // decades in a factor of e
  const double hertz = params.law == Law::disc ? 1 : params.frequency * 1e9;
  const double free_space = 20 * decade * log(4 * k_pi * hertz / k_light);  // dB, over the first metre
  switch (params.law) {
    case Law::disc: break;
    case Law::friis:
      radio.loss_at_1m = free_space;
      radio.loss_a_fold = decade * 20;
      break;
    case Law::itu_indoor:
      radio.loss_at_1m = 20 * decade * log(hertz / 1e6) - 28;
      radio.loss_a_fold = decade * params.power_loss_coefficient;
      break;
    case Law::log_distance:
      radio.loss_at_1m = free_space;
      radio.loss_a_fold = decade * 10 * params.path_loss_exponent;
      break;
  }
  const std::uint32_t n = params.most_heard;
  const std::uint32_t bytes = params.payload;
  // The size of the cells of the spatial index is chosen from the reach of the sensors. A radio with a long
  // reach must not make the cells too large for rangers with a short reach.
  constexpr double k_most_hint = 4;
  const double reach = pose_body_radio.position().norm() + radio.hears;
  return {.data = std::move(radio),
          .percepts = {{"count", Element::u32, 1, "", "number of messages heard"},
                       {"lost", Element::u32, 1, "",
                        "number of messages that arrived but are not heard: too many or too long"},
                       {"dropped", Element::u32, 1, "", "number of messages dropped at random"},
                       {"sender", Element::u32, n, "", "id of the body that sent each message"},
                       {"range", Element::f32, n, "m", "horizontal distance to each sending radio"},
                       {"bearing", Element::f32, n, "rad",
                        "bearing of each sending radio, in the frame of this radio"},
                       {"strength", Element::f32, n, "dBm", "strength with which each message arrived"},
                       {"quality", Element::f32, n, "",
                        "quality of each link: 1 at distance 0, 0 where messages are only just heard"},
                       {"length", Element::u8, n, "", "length of each message, bytes"},
                       {"payload", Element::u8, n * bytes, "", "bytes of the messages, one after another"}},
          .commands = {{"mode", Element::u8, 1, "",
                        "0: as the parameter `beacon` says, 1: sends the payload, 2: silent", k_radio_mode},
                       {"length", Element::u8, 1, "", "length of the message, bytes", k_radio_bytes},
                       {"payload", Element::u8, bytes, "", "bytes of the message", k_radio_said}},
          .command_bytes = k_radio_said + bytes,
          .reach_m = reach,
          .cell_hint_m = std::min(reach, k_most_hint)};
}

/// Checks the parameters. A radio must be inside the circle about the origin of its body that encloses the
/// body, because listeners find radios by the circles of bodies.
Result<> Radio::bind_part(const engine::TypeSpec& type, std::uint32_t) {
  if (!(params.sensitivity < params.power))
    return Error{fmt::format("has a sensitivity_dBm of {:g}, which must be below its power_dBm of {:g}",
                             params.sensitivity, params.power)};
  constexpr double k_rim = 1 + 1e-9;  // a radio on the rim may be outside by rounding
  const double radius = engine::solids_radius(type);
  const double distance = pose_body_radio.position().norm();
  if (distance <= radius * k_rim) return {};
  return Error{
      fmt::format("is {:g} m from the origin of its body; it must be within {:g} m, the radius of the body",
                  distance, radius)};
}

/// The types with a radio on each channel, including channels that interventions `set`.
struct Channels {
  std::map<std::string, std::vector<std::uint32_t>> types;

  explicit Channels(const engine::LintWorld& world) {
    world.for_devices<Radio>([&](std::uint32_t type, std::size_t d, const Radio& radio) {
      types[radio.params.channel].push_back(type);
      for (const engine::Value* name : world.set_values(world.spec.types[type].devices[d].params, "channel"))
        types[name->text()].push_back(type);
    });
  }
};

/// Warns if no other body has a radio on the channel.
void Radio::lint(const engine::LintView& view) const {
  const auto& channels = view.world.shared<Channels>().types;
  if (view.has_other_of(channels.at(params.channel)) || view.is_set({"channel"})) return;
  std::string known;
  for (const auto& [name, types] : channels)
    if (name != params.channel)
      known += fmt::format("{}\"{}\"", known.empty() ? "; other channels: " : ", ", name);
  const engine::DeviceSpec& radio = view.device_spec();
  view.warn(
      engine::LintTopic::message,
      fmt::format("{} hears nothing: no other body has a radio on the channel \"{}\"{}",
                  engine::device_text(radio.kind, radio.name, view.type_spec().name), params.channel, known));
}

}  // namespace

DeviceKind radio_kind() {
  return engine::make_device_kind<Radio>("radio",
                                         "sends messages to other radios in range, and receives their "
                                         "messages with the range and bearing of each sender");
}

}  // namespace troupe::sensors
