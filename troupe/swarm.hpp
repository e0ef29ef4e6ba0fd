#pragma once

#include "base/ids.hpp"
#include "base/pose.hpp"
#include "troupe/simulation.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe {

/// Many robots of one simulation at once: what Model is for one, in one call for all.
///
///     troupe::Swarm swarm = simulation.swarm("minibots");
///     std::vector<float> ranges(swarm.size() * swarm.beams());
///     std::vector<troupe::Model::Speed> speeds(swarm.size());
///     while (simulation.time_s() < 60) {
///       simulation.step();
///       swarm.ranges(ranges);  // robot i's from i * swarm.beams() on
///       steer(ranges, speeds);
///       swarm.set_speeds(speeds);
///     }
///
/// order     of rising ids, the world file's, in whatever order their data lie: robot i is the same one in
///           every run, on any number of threads
/// members   those who are there, those still to be born, and the dead; they never change. Who is not there
///           has readings of 0, and a pose of no number before its birth
/// sizes     what is given, or to be filled, has one element for each robot, ranges one for each beam of
///           each; else std::invalid_argument
/// where     of commands: one byte for each robot, 0 leaves it out; empty: all. Who is not there is left out
/// valid     while its simulation lives, also after a reset
///
/// Reading copies; the state tables themselves, without a copy but in the order of storage, are
/// Simulation::world().tables().
class Swarm {
 public:
  std::size_t size() const { return rows_.size(); }     ///< robots, in the world or not
  std::span<const BodyId> ids() const { return ids_; }  ///< rising
  std::vector<std::string> names() const;               ///< in that order
  /// The types that they are of, each once, in the order of the world.
  std::vector<std::string> types() const;

  /// 1 for who is in the world (docs/lives.md), else 0.
  void alive(std::span<std::uint8_t> out) const;
  /// 1 where the last motion was refused.
  void stalled(std::span<std::uint8_t> out) const;
  /// Global poses, m and rad.
  void poses(std::span<Pose> out) const;
  /// Estimated poses: Model::estimate().
  void estimates(std::span<Pose> out) const;
  /// Velocities of the last tick, body frame, m/s and rad/s.
  void speeds(std::span<Model::Speed> out) const;

  /// Readings of a ranger, a robot: the same number for all. `sensor` names it; empty: the first ranger of
  /// each. Throws std::out_of_range where one of them has no such ranger, and std::invalid_argument where
  /// they have different numbers of beams.
  std::size_t beams(std::string_view sensor = {}) const;
  /// Readings, m: robots x beams, row-major. Throws also std::logic_error where the ranger of one of them is
  /// not running (subscribe first).
  void ranges(std::span<float> out, std::string_view sensor = {}) const;
  /// Headings of the beams in the sensor's frame, rad, of the first robot.
  std::vector<double> bearings(std::string_view sensor = {}) const;
  /// No reading is more, m, of the first robot.
  double range_bound(std::string_view sensor = {}) const;
  /// Runs every sensor of all of them; before the first step.
  void subscribe();

  /// visit(i, robot) for each that is in the world, on all threads of the simulation, in any order. Each
  /// call may read the whole state, cast rays and draw its robot's random numbers, but change nothing than
  /// its own robot's commands and estimate and what is the caller's own of robot i (an array's element i):
  /// then the outcome is the same on any number of threads. Where calls throw, the others are still made, and
  /// the exception of the first robot comes out. Between two steps, also in a callback of on_tick().
  /// A call that commands another robot of the simulation, puts one elsewhere, or bears, removes, steps,
  /// resets or subscribes gets a std::logic_error: what it finds to be done is kept, and done behind.
  void for_each(const std::function<void(std::size_t i, Model& robot)>& visit);

  /// Model::set_speed, accelerate and go_to of each.
  void set_speeds(std::span<const Model::Speed> speeds, std::span<const std::uint8_t> where = {});
  void accelerate(std::span<const Model::Speed> accelerations,
                  std::span<const std::uint8_t> where = {});                          ///< as that
  void go_to(std::span<const Pose> goals, std::span<const std::uint8_t> where = {});  ///< as that
  /// Model::set_pose of each, with one indexing of all bodies. Where one of them cannot be put none is.
  void set_poses(std::span<const Pose> poses, std::span<const std::uint8_t> where = {});

 private:
  friend class Simulation;
  Swarm(engine::World& world, std::vector<Row> rows);
  template <class Read>
  void read(std::size_t room, Read&& one) const;
  template <class Write>
  void write(std::size_t given, std::span<const std::uint8_t> where, Write&& one) const;
  struct Ranger;
  Ranger ranger_of(Row row, std::string_view sensor) const;
  template <class Visit>
  void for_rangers(std::string_view sensor, Visit&& visit) const;

  engine::World* world_;
  std::vector<Row> rows_;  // by id
  std::vector<BodyId> ids_;
  std::vector<Model> robots_;  // made when for_each() is first called
};

}  // namespace troupe
