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

/// A group of robots of one simulation: the functions of Model, for all robots in one call.
///
///     troupe::Swarm swarm = simulation.swarm("minibots");
///     std::vector<float> ranges(swarm.size() * swarm.beams());
///     std::vector<troupe::Model::Speed> speeds(swarm.size());
///     while (simulation.time_s() < 60) {
///       simulation.step();
///       swarm.ranges(ranges);  // those of robot i start at i * swarm.beams()
///       steer(ranges, speeds);
///       swarm.set_speeds(speeds);
///     }
///
/// order     of rising ids, as in the world file, whatever the order of storage: robot i is the same in every
///           run, on any number of threads
/// members   fixed: the living, the unborn and the dead. Robots that are not in the world have readings of 0;
///           unborn ones have a pose of NaN
/// sizes     spans have one element per robot, spans of ranges one per beam of each robot; other sizes throw
///           std::invalid_argument
/// where     for commands: one byte per robot, 0 skips the robot; empty: all. Robots that are not in the
///           world are always skipped
/// valid     while the simulation lives, also after a reset
///
/// The readers copy. Simulation::world().tables() gives the state tables themselves, without a copy, in the
/// order of storage.
class Swarm {
 public:
  std::size_t size() const { return rows_.size(); }     ///< number of robots, in the world or not
  std::span<const BodyId> ids() const { return ids_; }  ///< in rising order
  std::vector<std::string> names() const;               ///< in the order of ids()
  /// The types of the robots, each once, in the order of the world.
  std::vector<std::string> types() const;

  /// 1 if the robot is in the world (docs/lives.md), else 0.
  void alive(std::span<std::uint8_t> out) const;
  /// 1 if the last motion was blocked, else 0.
  void stalled(std::span<std::uint8_t> out) const;
  /// Global poses, m and rad.
  void poses(std::span<Pose> out) const;
  /// Estimated poses, m and rad: Model::estimate().
  void estimates(std::span<Pose> out) const;
  /// Velocities of the last tick, body frame, m/s and rad/s.
  void speeds(std::span<Model::Speed> out) const;

  /// Number of readings of a ranger, equal for all robots. Empty `sensor`: the first ranger of each robot.
  /// Throws std::out_of_range if a robot has no such ranger, and std::invalid_argument if the numbers of
  /// beams differ.
  std::size_t beams(std::string_view sensor = {}) const;
  /// Readings, m: robots x beams, row-major. Throws as beams() does, and std::logic_error if the ranger of a
  /// robot does not run (subscribe first).
  void ranges(std::span<float> out, std::string_view sensor = {}) const;
  /// Headings of the beams of the first robot's ranger, in the frame of the sensor, rad.
  std::vector<double> bearings(std::string_view sensor = {}) const;
  /// Upper bound of all readings of the first robot's ranger, m.
  double range_bound(std::string_view sensor = {}) const;
  /// Runs every sensor of all robots. Call it before the first step.
  void subscribe();

  /// Calls visit(i, robot) for each robot in the world, on all threads of the simulation, in any order. A
  /// call may read the whole state, cast rays and draw random numbers of its robot, but change only the
  /// commands and the estimate of its own robot, and data of the caller that belong to robot i (element i of
  /// an array). The result is then the same on any number of threads. If calls throw, the remaining calls are
  /// still made, and the exception of the first robot is rethrown. Use it between two steps, also in a
  /// callback of on_tick(). A call that commands another robot of the simulation, moves or spawns or removes
  /// a robot, steps, resets or subscribes throws std::logic_error: collect such changes, and apply them after
  /// for_each().
  void for_each(const std::function<void(std::size_t i, Model& robot)>& visit);

  /// Model::set_speed() for each robot.
  void set_speeds(std::span<const Model::Speed> speeds, std::span<const std::uint8_t> where = {});
  /// Model::accelerate() for each robot.
  void accelerate(std::span<const Model::Speed> accelerations, std::span<const std::uint8_t> where = {});
  /// Model::go_to() for each robot.
  void go_to(std::span<const Pose> goals, std::span<const std::uint8_t> where = {});
  /// Model::set_pose() for each robot, with one indexing of all bodies. If one pose is invalid, no robot is
  /// moved.
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
  std::vector<Model> robots_;  // filled by the first for_each()
};

}  // namespace troupe
