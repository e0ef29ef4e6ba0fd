#pragma once

#include "engine/frame.hpp"
#include "engine/world.hpp"

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <vector>

namespace troupe {

/// One number a body out of its state: a field of the components of one name.
struct ChosenValue {
  std::string component;
  std::string field;
  std::size_t column = 0;
  std::string text;  ///< for people, with its unit: "velocity.x (m/s)"
};

/// `velocity.x`, `ranger/ir.ranges.3`, or a component by its kind: `wander.turn_left_s`. Where there is no
/// such thing `fault` says so, and what there is.
std::optional<ChosenValue> find_value(const engine::World& world, const std::string& name,
                                      std::string& fault);
/// A value each of the frame's bodies; NaN for those that lack it.
std::vector<double> values_of(const engine::World& world, const ChosenValue& value,
                              const engine::Frame& frame);

/// The rangers of all types.
std::vector<engine::FrameRanger> frame_rangers(const engine::World& world);
/// What they read, of those that run: fills Frame::scans and ranges.
void add_scans(const engine::World& world, const engine::FrameScene& scene, engine::Frame& frame);
/// What fiducial finders have found: fills Frame::sights.
void add_sights(const engine::World& world, engine::Frame& frame);
/// What power packs hold: fills Frame::charges.
void add_charges(const engine::World& world, engine::Frame& frame);
void add_names(const engine::World& world, engine::Frame& frame);

/// Where bodies have been in the last seconds.
class Trails {
 public:
  /// To be called after each tick.
  void see(const engine::World& world);
  void add_to(engine::Frame& frame) const;

 private:
  struct Seen {
    std::uint64_t tick;
    std::vector<Eigen::Vector3d> places;  // of the frame's bodies
  };
  std::deque<Seen> seen_;
};

}  // namespace troupe
