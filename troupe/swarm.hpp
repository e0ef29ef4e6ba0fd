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
#include <utility>
#include <vector>

namespace troupe {

/// A group of robots of one simulation. Model (troupe/simulation.hpp) is a handle of a single robot. Most
/// functions of Swarm do in one call, for all robots of the group, what the function of Model with the same
/// name (in the singular) does for one robot. A ranger is a range sensor, such as a laser scanner; a device
/// is a sensor or other equipment of a robot, whose readings and commands consist of named fields.
///
///     troupe::Swarm swarm = simulation.swarm("minibots");
///     std::vector<float> ranges(swarm.size() * swarm.beams());
///     std::vector<troupe::Model::Speed> speeds(swarm.size());
///     while (simulation.time_s() < 60) {
///       simulation.step();
///       swarm.ranges(ranges);  // the ranges of robot i start at index i * swarm.beams()
///       steer(ranges, speeds);
///       swarm.set_speeds(speeds);
///     }
///
/// order     robots are in ascending order of their ids, which is the order of the world file. Robot i is the
///           same robot in every run, on any number of threads
/// members   the group never changes: it also contains robots that were removed and robots that are not yet
///           born. A removed robot keeps its last pose; the pose of a robot that is not yet born is NaN.
///           Robots that are not in the world have readings, speeds and commands of 0
/// sizes     a span whose size a function does not state must have one element per robot; other sizes throw
///           std::invalid_argument
/// where     functions that command or place robots have this parameter to select robots: one byte per robot,
///           0 skips the robot; an empty span selects all. These functions always skip robots that are not in
///           the world
/// valid     while the simulation lives, also after a reset
///
/// Functions with a parameter `out` copy the values to this span, in the order of the robots.
/// Simulation::world().tables() gives access to the state tables without a copy; the rows of these tables are
/// not in the order of the swarm. After a step that threw, all functions that read or change the state throw
/// std::logic_error until Simulation::reset().
class Swarm {
 public:
  std::size_t size() const { return ids_.size(); }      ///< number of robots, in the world or not
  std::span<const BodyId> ids() const { return ids_; }  ///< ids of the robots, in ascending order
  std::vector<std::string> names() const;               ///< names of the robots, in the order of ids()
  std::uint64_t tick() const;                           ///< number of completed ticks (time steps)
  double time_s() const;                                ///< world time, s
  /// Names of the types of the robots (a type states the shape, drive and devices of its robots), each name
  /// once, in the order of the world file.
  std::vector<std::string> types() const;

  /// Writes 1 for each robot that is in the world (docs/lives.md), else 0.
  void alive(std::span<std::uint8_t> out) const;
  /// Writes 1 for each robot whose last motion was blocked or would have left the world's bounds, else 0.
  void stalled(std::span<std::uint8_t> out) const;
  /// Writes the poses in the world frame, m and rad, as Model::pose() returns them.
  void poses(std::span<Pose> out) const;
  /// Writes the estimated poses (the true poses, or those from wheel odometry), m and rad, as
  /// Model::estimate() returns them.
  void estimates(std::span<Pose> out) const;
  /// Writes the velocities that the drives computed in the last tick, in the body frame of each robot, m/s
  /// and rad/s, as Model::speed() returns them.
  void speeds(std::span<Model::Speed> out) const;

  /// Returns the number of beams of the ranger named `sensor` of each robot; 0 for a swarm without robots.
  /// All robots must have the same number of beams. An empty name means the first ranger of each robot.
  /// Throws std::out_of_range if a robot has no such ranger, and std::invalid_argument if the numbers of
  /// beams differ between robots.
  std::size_t beams(std::string_view sensor = {}) const;
  /// Writes the ranges that the ranger named `sensor` of each robot measured, m: robots x beams, row-major,
  /// size() * beams(sensor) elements. Throws as beams() does, std::invalid_argument for a span of another
  /// size, and std::logic_error if the ranger of a robot does not run; call subscribe() before the first
  /// step.
  void ranges(std::span<float> out, std::string_view sensor = {}) const;
  /// Returns the headings of the beams of the first robot's ranger named `sensor`, in the frame of this
  /// ranger, rad, in the order of ranges(). An empty name means the first ranger. The result is empty for a
  /// swarm without robots. Throws std::out_of_range if the first robot has no such ranger.
  std::vector<double> bearings(std::string_view sensor = {}) const;
  /// Returns an upper bound of the ranges that the first robot's ranger named `sensor` can measure, m. A
  /// transducer is a fan of beams of a ranger, and range_max its largest range. The bound is the largest
  /// range_max of the transducers, plus the distances by which the ranger and its transducers are away from
  /// the origin of the body. 0 for a swarm without robots. Throws as bearings() does.
  double range_bound(std::string_view sensor = {}) const;
  /// Returns the description (name, type, columns, unit) of the field `field` of the readings of the first
  /// robot's device named `device`. An empty `device` means the first device of this robot that has this
  /// field. The other robots are not checked; readings() does that. Throws std::out_of_range if the first
  /// robot has no such device or field, and std::logic_error for a swarm without robots.
  const engine::StateField& reading_field(std::string_view field, std::string_view device = {}) const;
  /// Copies the field `field` of the readings of each robot's device named `device` to `out`. An empty name
  /// of the device means the robot's first device that has this field. The values are robots x columns,
  /// row-major, and have the type that reading_field() returns. Does nothing for a swarm without robots.
  /// Throws std::out_of_range if a robot has no such device or field; std::invalid_argument if the types or
  /// numbers of columns differ between robots, or if the size of `out` in bytes is not robots x columns x the
  /// size of an element; std::logic_error if the device of a robot is a sensor that does not run (call
  /// subscribe() before the first step).
  void readings(std::span<std::byte> out, std::string_view field, std::string_view device = {}) const;
  /// Returns descriptions of the fields of the command that the first robot's device named `device` takes.
  /// The other robots are not checked. Throws std::out_of_range if the first robot has no device of this name
  /// that takes commands, and std::logic_error for a swarm without robots.
  std::span<const engine::StateField> command_fields(std::string_view device) const;
  /// Copies the field `field` of the current command of each robot's device named `device` to `out`. The
  /// values are robots x columns, row-major, and have the type of the field (see command_fields()). Does
  /// nothing for a swarm without robots. Throws std::out_of_range if a robot has no device of this name that
  /// takes commands, or if the command has no such field; std::invalid_argument if the types or numbers of
  /// columns differ between robots, or if the size of `out` in bytes is not robots x columns x the size of an
  /// element.
  void commands(std::span<std::byte> out, std::string_view field, std::string_view device) const;
  /// Makes all sensors of the robots of this group run, as Simulation::subscribe() does for one robot. Throws
  /// std::logic_error after the first step of a run; Simulation::reset() keeps the subscriptions.
  void subscribe();

  /// Calls the function `visit` once for each robot that is in the world, in parallel on all threads of the
  /// simulation and in any order. Call for_each() between two steps, or in a callback of on_tick(). `visit`
  /// may cast rays, draw from Model::random() of its robot, and read the whole state except the commands and
  /// the estimates of other robots, which other calls may be changing. It may change only the commands and
  /// the estimate of its robot, and data of the caller that belong to robot i, such as element i of an array.
  /// Under these conditions the result is the same on any number of threads. In `visit`, commands for other
  /// robots, and the functions set_pose(), spawn(), remove(), step(), reset(), subscribe() and all commands
  /// of a swarm throw std::logic_error: collect such changes, and apply them after for_each(). If `visit`
  /// throws for some robots, it is still called for all others, and for_each() then rethrows the exception of
  /// the first of these robots.
  void for_each(const std::function<void(std::size_t i, Model& robot)>& visit);

  /// Commands the speeds of each robot in its body frame, m/s and rad/s, as Model::set_speed() does. For a
  /// car drive, `turn` is the steering angle, rad.
  void set_speeds(std::span<const Model::Speed> speeds, std::span<const std::uint8_t> where = {});
  /// Commands the accelerations of each robot in its body frame, m/s^2 and rad/s^2, as Model::accelerate()
  /// does. For a car drive, `turn` is the steering angle, rad.
  void accelerate(std::span<const Model::Speed> accelerations, std::span<const std::uint8_t> where = {});
  /// Commands the goal pose of each robot, m and rad, as Model::go_to() does; the z of a goal is ignored.
  void go_to(std::span<const Pose> goals, std::span<const std::uint8_t> where = {});
  /// Sets the field `field` of the command of each robot's device named `device`; the other fields of the
  /// command keep their values. The command applies from the next step on. values: robots x columns,
  /// row-major, of the type of the field (see command_fields()). Throws as commands() does, with `values` in
  /// place of `out`.
  void set_commands(std::span<const std::byte> values, std::string_view field, std::string_view device,
                    std::span<const std::uint8_t> where = {});
  /// Places each robot at a pose in the world frame, m and rad, as Model::set_pose() does, but rebuilds the
  /// spatial index of the bodies only once. If the pose of a selected robot in the world is invalid,
  /// set_poses() throws the error of Model::set_pose() and moves no robot.
  void set_poses(std::span<const Pose> poses, std::span<const std::uint8_t> where = {});

  /// Returns the swarm of these robots of `world`, which must outlive the swarm. The ids must be in ascending
  /// order; this is not checked.
  static Swarm of(engine::World& world, std::vector<BodyId> ids) { return {world, std::move(ids)}; }

 private:
  friend class Simulation;
  Swarm(engine::World& world, std::vector<BodyId> ids);
  Row row(std::size_t i) const;
  template <class Read>
  void read(std::size_t room, Read&& one) const;
  template <class Write>
  void write(std::size_t given, std::span<const std::uint8_t> where, Write&& one) const;
  struct Ranger;
  Ranger ranger_of(Row row, std::string_view sensor) const;
  template <class Visit>
  void for_rangers(std::string_view sensor, Visit&& visit) const;
  struct Cells;
  Cells readings_of(Row row, std::string_view field, std::string_view device) const;
  Cells commands_of(Row row, std::string_view field, std::string_view device) const;
  using FindCells = Cells (Swarm::*)(Row row, std::string_view field, std::string_view device) const;
  template <class Visit>
  void for_cells(FindCells find, std::size_t bytes, std::string_view field, std::string_view device,
                 Visit&& visit) const;

  engine::World* world_;
  std::vector<BodyId> ids_;
  std::vector<Model> robots_;  // filled by the first for_each()
};

}  // namespace troupe
