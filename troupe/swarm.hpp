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
/// functions of Swarm do for all robots of the group, in one call, what the function of Model with the same
/// name in the singular does for one robot.
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
/// order    The robots are in ascending order of their ids, which is the order of the world file. Robot i is
///          the same robot in every run, on any number of threads.
/// members  The group never changes. It also contains robots that were removed from the world, and robots
///          that are not yet born (docs/lives.md). The readings, speeds and commands of these robots are 0. A
///          removed robot keeps its last pose; the pose of a robot that is not yet born is NaN.
/// devices  A device is a sensor or other equipment of a robot. A ranger is a range sensor, such as a laser
///          scanner. The readings and the command of a device consist of named fields. A field has one value
///          or more, which are called its columns.
/// running  A sensor makes readings only while it runs. It runs if the robot's controller reads it, if the
///          world file makes it run, or if the program has called subscribe() before the first step.
/// out      Functions with this parameter copy values to the span `out`, in the order of the robots.
/// where    Functions that command or place robots have this parameter, which selects robots. It has one byte
///          per robot; 0 skips the robot. An empty span selects all robots. These functions always skip
///          robots that are not in the world.
/// sizes    A span must have one element per robot, unless its function states another size. A wrong size
///          throws std::invalid_argument.
/// valid    A swarm is valid while the simulation lives, also after a reset.
/// errors   After a step that threw, all functions that read or change the state throw std::logic_error until
///          Simulation::reset() is called.
///
/// Simulation::world().tables() gives access to the tables of the state without a copy. These tables list the
/// robots in another order than the swarm.
class Swarm {
 public:
  std::size_t size() const { return ids_.size(); }      ///< number of robots, in the world or not
  std::span<const BodyId> ids() const { return ids_; }  ///< ids of the robots, in ascending order
  std::vector<std::string> names() const;               ///< names of the robots, in the order of ids()
  std::uint64_t tick() const;                           ///< number of completed ticks (time steps)
  double time_s() const;                                ///< simulated time, s
  /// Names of the types of the robots, each name once, in the order of the world file. A type states the
  /// shape, drive and devices of its robots.
  std::vector<std::string> types() const;

  /// Writes 1 for each robot that is in the world (docs/lives.md), else 0.
  void alive(std::span<std::uint8_t> out) const;
  /// Writes 1 for each robot whose last motion was blocked or would have left the world's bounds, else 0.
  void stalled(std::span<std::uint8_t> out) const;
  /// Writes for each robot the id of the body that blocked it in the last tick, as Model::blocked_by() says;
  /// not valid() if nothing did, or only a bound of the world. Throws std::logic_error as
  /// Model::blocked_by().
  void blocked_by(std::span<BodyId> out) const;
  /// Writes the poses in the world frame, m and rad, as Model::pose() returns them.
  void poses(std::span<Pose> out) const;
  /// Writes the estimated poses, m and rad, as Model::estimate() returns them. The estimated pose of a robot
  /// is its true pose or an estimate from wheel odometry, as the world file states.
  void estimates(std::span<Pose> out) const;
  /// Writes the velocities that the drives computed in the last tick, in the body frame of each robot, m/s
  /// and rad/s, as Model::speed() returns them.
  void speeds(std::span<Model::Speed> out) const;

  /// Returns the number of beams of the ranger named `sensor` of each robot; 0 for a swarm without robots.
  /// All robots must have the same number of beams. An empty name means the first ranger of each robot.
  /// Throws std::out_of_range if a robot has no such ranger, and std::invalid_argument if the numbers of
  /// beams differ between robots.
  std::size_t beams(std::string_view sensor = {}) const;
  /// Writes the ranges that the ranger named `sensor` of each robot measured, m. An empty name means the
  /// first ranger of each robot. `out` must have size() * beams(sensor) elements: robots x beams, row-major.
  /// Throws as beams() does. Throws std::invalid_argument if `out` has another size, and std::logic_error if
  /// the ranger of a robot does not run.
  void ranges(std::span<float> out, std::string_view sensor = {}) const;
  /// Returns the headings of the beams of the first robot's ranger named `sensor`, in the frame of this
  /// ranger, rad, in the order of ranges(). An empty name means the first ranger. The result is empty for a
  /// swarm without robots. Throws std::out_of_range if the first robot has no such ranger.
  std::vector<double> bearings(std::string_view sensor = {}) const;
  /// Returns an upper bound, m, of the ranges that the ranger named `sensor` of the first robot can measure.
  /// An empty name means the first ranger. The bound is at least the largest range of the beams. It is larger
  /// if beams start away from the origin of the robot. 0 for a swarm without robots. Throws as bearings()
  /// does.
  double range_bound(std::string_view sensor = {}) const;
  /// Returns the description (name, type, number of columns, unit) of the field `field` of the readings of
  /// the first robot's device named `device`. An empty `device` means the first device of this robot that has
  /// this field. `device` may also name the memory of a controller, as in readings(). The other robots are
  /// not checked; readings() does that. Throws std::out_of_range if the first robot has no such device or
  /// field, and std::logic_error for a swarm without robots.
  const engine::StateField& reading_field(std::string_view field, std::string_view device = {}) const;
  /// Copies the field `field` of the readings of each robot's device named `device` to `out`. An empty
  /// `device` means the first device of each robot that has this field. `device` may also be the component of
  /// the state with the memories of a controller, such as `wander/0`, unless a device has this name. The
  /// values are robots x columns, row-major, and have the type that reading_field() states. Does nothing for
  /// a swarm without robots. Throws
  /// - std::out_of_range if a robot has no such device or field,
  /// - std::invalid_argument if the type or the number of columns differs between robots,
  /// - std::invalid_argument if the size of `out` in bytes is not that of robots x columns values,
  /// - std::logic_error if the device of a robot is a sensor that does not run.
  void readings(std::span<std::byte> out, std::string_view field, std::string_view device = {}) const;
  /// Returns descriptions of the fields of the command that the first robot's device named `device` takes.
  /// The other robots are not checked. Throws std::out_of_range if the first robot has no device of this name
  /// that takes commands, and std::logic_error for a swarm without robots.
  std::span<const engine::StateField> command_fields(std::string_view device) const;
  /// Returns the names of those devices of the first robot whose command has the field `field`, in the order
  /// of its devices. The other robots are not checked. Throws std::logic_error for a swarm without robots.
  std::vector<std::string_view> devices_with_command(std::string_view field) const;
  /// Copies the field `field` of the current command of each robot's device named `device` to `out`. The
  /// values are robots x columns, row-major, and have the type that command_fields() states. Does nothing for
  /// a swarm without robots. Throws
  /// - std::out_of_range if a robot has no device of this name that takes commands,
  /// - std::out_of_range if the command has no such field,
  /// - std::invalid_argument if the type or the number of columns differs between robots,
  /// - std::invalid_argument if the size of `out` in bytes is not that of robots x columns values.
  void commands(std::span<std::byte> out, std::string_view field, std::string_view device) const;
  /// Makes all sensors of the robots of this group run (Simulation::subscribe()). Throws std::logic_error
  /// after the first step of a run. Simulation::reset() keeps the subscriptions.
  void subscribe();

  /// Calls the function `visit` once for each robot that is in the world; `i` is the index of the robot in
  /// the swarm. The calls run in parallel on all threads of the simulation, in any order. Call for_each()
  /// between two steps, or in a callback of Simulation::on_tick().
  ///
  /// `visit` may
  /// - read the whole state, except the commands and estimated poses of other robots, which other calls may
  ///   be changing at the same time,
  /// - cast rays, and draw random numbers from Model::random() of its robot,
  /// - change the commands and the estimated pose of its robot,
  /// - change data of the caller that belong to robot i alone, such as element i of an array.
  ///
  /// The result is then the same on any number of threads. `visit` must not command other robots. It must not
  /// call set_pose(), spawn(), remove(), step(), reset(), subscribe(), save(), record(), for_each(), the
  /// commands of a swarm, or functions that set callbacks. Such calls throw std::logic_error. Collect such
  /// changes, and apply them after for_each().
  ///
  /// If `visit` throws for a robot, it is still called for all other robots. for_each() then throws the
  /// exception of the robot with the lowest index for which `visit` threw. Throws std::invalid_argument if
  /// `visit` is null.
  void for_each(const std::function<void(std::size_t i, Model& robot)>& visit);

  /// Commands the speeds of each robot in its body frame, m/s and rad/s, as Model::set_speed() does. For a
  /// car drive, `turn` is the steering angle, rad. If a number for a selected robot is not finite, throws
  /// std::invalid_argument and commands no robot; accelerate() and go_to() do so too.
  void set_speeds(std::span<const Model::Speed> speeds, std::span<const std::uint8_t> where = {});
  /// Commands the accelerations of each robot in its body frame, m/s^2 and rad/s^2, as Model::accelerate()
  /// does. For a car drive, `turn` is the steering angle, rad.
  void accelerate(std::span<const Model::Speed> accelerations, std::span<const std::uint8_t> where = {});
  /// Commands a goal pose for each robot, m and rad, in the frame of its estimated pose, as Model::go_to()
  /// does. The z of a goal is ignored.
  void go_to(std::span<const Pose> goals, std::span<const std::uint8_t> where = {});
  /// Sets the field `field` of the command of each robot's device named `device`. The other fields of the
  /// command keep their values. The command applies from the next step on. `values` are robots x columns,
  /// row-major, and have the type that command_fields() states. Throws the exceptions of commands(), and
  /// std::invalid_argument if `values` has another size, or has a value other than 0 and 1 for a bool
  /// (StateField::is_bool). After an exception, no command has changed.
  void set_commands(std::span<const std::byte> values, std::string_view field, std::string_view device,
                    std::span<const std::uint8_t> where = {});
  /// Places each robot at a pose in the world frame, m and rad, as Model::set_pose() does. This is faster
  /// than a call of Model::set_pose() per robot, because the spatial index of the bodies is rebuilt only
  /// once. If Model::set_pose() would throw for one of the placed robots, set_poses() throws that error and
  /// moves no robot.
  void set_poses(std::span<const Pose> poses, std::span<const std::uint8_t> where = {});

  /// Returns the swarm of the robots of `world` that have these ids. `world` must outlive the swarm. The ids
  /// must be in ascending order, which is not checked. Throws std::out_of_range if there is no body with an
  /// id, or if the body is static geometry.
  static Swarm of(engine::World& world, std::vector<BodyId> ids);

 private:
  friend class Simulation;
  Swarm(engine::World& world, std::vector<BodyId> ids);
  Row row(std::size_t i) const;
  Model::Place place(Row row) const;
  template <class Read>
  void read(std::size_t room, Read&& one) const;
  template <class Write>
  void write(std::size_t given, std::span<const std::uint8_t> where, Write&& one) const;
  template <class Value, class CommandOf>
  void command(std::string_view call, std::span<const Value> values, std::span<const std::uint8_t> where,
               CommandOf&& command_of) const;
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
