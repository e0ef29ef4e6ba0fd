#include "troupe/frame_history.hpp"

#include "engine/spec/ticks.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace troupe {
namespace {

using engine::Frame;
using engine::FrameBody;
using engine::FrameSquare;

constexpr double k_trail_points = 50;
constexpr double k_most_squares = 2e9;  // largest index of a square: indices are stored in 32 bits

std::uint64_t key_of(std::int32_t x, std::int32_t y) {
  return std::uint64_t{static_cast<std::uint32_t>(x)} << 32 | static_cast<std::uint32_t>(y);
}

}  // namespace

Trails::Trails(double tick_s)
    : every_ticks_(engine::period_ticks(k_seconds / k_trail_points, tick_s)),
      most_ticks_(engine::ticks_until(k_seconds, tick_s)),
      history_s_(static_cast<double>(most_ticks_ + every_ticks_) * tick_s) {}

bool Trails::wants(std::uint64_t tick) const {
  return seen_.empty() || tick < seen_.back().tick || tick / every_ticks_ > seen_.back().tick / every_ticks_;
}

void Trails::see(const Frame& frame) {
  if (!wants(frame.tick)) return;
  if (!seen_.empty() && frame.tick < seen_.back().tick) seen_.clear();
  Seen now{frame.tick, {}, {}};
  now.ids.reserve(frame.mobile.size());
  now.places.reserve(frame.mobile.size());
  for (const FrameBody& body : frame.mobile) {
    now.ids.push_back(body.id);
    now.places.emplace_back(body.pose_world_body.x, body.pose_world_body.y, body.pose_world_body.z);
  }
  seen_.push_back(std::move(now));
  while (seen_.size() > static_cast<std::size_t>(k_trail_points) || is_too_old(seen_.front(), frame.tick))
    seen_.pop_front();
}

void Trails::add_to(Frame& frame) const {
  frame.trails.clear();
  frame.trails.resize(frame.mobile.size());
  for (std::size_t i = 0; i < frame.mobile.size(); ++i) frame.trails[i].body = static_cast<std::uint32_t>(i);
  for (const Seen& seen : seen_) {
    if (is_too_old(seen, frame.tick)) continue;
    // Both lists are in the order of ids; bodies may have been born or have died in between.
    std::size_t k = 0;
    for (std::size_t i = 0; i < frame.mobile.size(); ++i) {
      while (k < seen.ids.size() && seen.ids[k] < frame.mobile[i].id) ++k;
      if (k < seen.ids.size() && seen.ids[k] == frame.mobile[i].id)
        frame.trails[i].points.push_back(seen.places[k]);
    }
  }
  for (engine::FrameTrail& trail : frame.trails) {
    const Pose& pose = frame.mobile[trail.body].pose_world_body;
    trail.points.emplace_back(pose.x, pose.y, pose.z);
  }
}

void Covered::see(const engine::FrameScene& scene, const Frame& frame) {
  if (last_.empty() || frame.tick < last_tick_) {
    last_.clear();
    first_tick_ = frame.tick;
  }
  last_tick_ = frame.tick;
  for (const FrameBody& body : frame.mobile) {
    const auto& types = body.type < scene.types.size() ? scene.types : frame.types;
    const std::size_t type = body.type < scene.types.size() ? body.type : body.type - scene.types.size();
    if (!types[type].mobile) continue;
    const double x = std::floor(body.pose_world_body.x / k_square_m);
    const double y = std::floor(body.pose_world_body.y / k_square_m);
    if (std::abs(x) > k_most_squares || std::abs(y) > k_most_squares) continue;
    last_[key_of(static_cast<std::int32_t>(x), static_cast<std::int32_t>(y))] = frame.tick;
  }
}

void Covered::add_to(Frame& frame) const {
  frame.covered.clear();
  frame.covered_m = k_square_m;
  const auto span = static_cast<double>(std::max<std::uint64_t>(last_tick_ - first_tick_, 1));
  for (const auto& [key, tick] : last_)
    frame.covered.push_back({static_cast<std::int32_t>(static_cast<std::uint32_t>(key >> 32)),
                             static_cast<std::int32_t>(static_cast<std::uint32_t>(key)),
                             static_cast<float>(1 - static_cast<double>(last_tick_ - tick) / span)});
  std::ranges::sort(frame.covered, {},
                    [](const FrameSquare& square) { return std::tuple(square.x, square.y); });
}

}  // namespace troupe
