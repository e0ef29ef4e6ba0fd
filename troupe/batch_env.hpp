#pragma once

#include "engine/state_table.hpp"
#include "troupe/simulation.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe {

/// Columns of an observed array, for one robot.
struct BatchPart {
  /// The source of the columns.
  enum class Of : std::uint8_t {
    reading,    ///< all columns of a field of a device (Model::readings)
    pose,       ///< x, y (m), cosine and sine of the heading: world frame
    estimate,   ///< estimated pose: x, y (m), cosine and sine of the heading (Model::estimate)
    speed,      ///< forward, left (m/s), turn (rad/s) of the last tick
    stalled,    ///< 1 if the last motion was blocked, else 0
    nearest,    ///< k_neighbour columns for each of the `count` nearest robots, nearest first
    target,     ///< x, y (m, in the robot's frame) and the distance (m) of a body
    time_left,  ///< remaining fraction of the episode, from 1 to 0
  };
  static constexpr std::size_t k_neighbour = 5;  ///< columns of one neighbour, see `nearest`

  Of of = Of::reading;  ///< source of the columns
  std::string device;   ///< reading: name of the device; empty: the first that has this field
  std::string field;    ///< reading: name of the field
  /// nearest: a type or a population of robots, or one robot; empty: all robots. A neighbour has the columns
  /// x, y (m, in the robot's frame), the cosine and the sine of its heading relative to the robot's, and 1.
  /// Columns without a neighbour are 0. Of two robots at one distance, the lower id comes first.
  /// target: a model, or a population: then the target of each robot is the body with the robot's number, for
  /// "r3" and "goal" the body "goal3". The columns are 0 while that body is not in the world.
  std::string name;
  std::size_t count = 1;                                     ///< nearest: number of neighbours
  double range_m = std::numeric_limits<double>::infinity();  ///< nearest: largest distance of a neighbour, m
  /// Factor for lengths, speeds and readings; cosines, sines and flags are not scaled.
  double scale = 1;
};

/// An array of a batch: copies x robots x columns, row-major.
struct BatchArraySpec {
  std::string name;              ///< unique in its team
  std::vector<BatchPart> parts;  ///< concatenated to one row, in float32
  /// Keeps the element type of the field, without `scale`: for images. The array must have one part, a
  /// reading.
  bool raw = false;
};

/// One action of a policy per robot and step, from -1 (`low`) to 1 (`high`), linear in between. Values beyond
/// are clipped.
struct BatchAction {
  std::string device;   ///< device that takes commands (Model::asked); empty: the robot's drive
  std::string command;  ///< drive: "forward", "left" (m/s) or "turn" (rad/s); device: a field of its command
  double low = -1;      ///< in the command's unit; integer fields are rounded to the nearest
  double high = 1;      ///< in the command's unit
};

/// A column of an array of a robot, or a measure of its copy.
struct BatchColumn {
  std::string array;       ///< name of an array of the team; empty: a measure
  std::size_t column = 0;  ///< column of the array
  std::string measure;     ///< column of the measures, with or without its unit
};

/// A term of the reward of each robot that is not finished.
struct BatchReward {
  BatchColumn of;       ///< the rewarded column
  double weight = 1;    ///< factor
  bool change = false;  ///< whether its change in this step is rewarded, instead of its value
};

/// A condition that finishes a robot; a condition on a measure finishes all robots of the copy.
struct BatchEnd {
  BatchColumn of;         ///< the tested column
  double below = 0;       ///< the condition holds if the column is less than this
  bool is_above = false;  ///< the condition holds if the column is more than `below`, instead
  double reward = 0;      ///< added to the reward of the step in which it holds
};

/// Robots that learn one policy, with one list of arrays, actions and rewards.
struct BatchTeam {
  std::string name;                    ///< unique
  std::string robots;                  ///< a type, a population or one robot, as in Simulation::swarm()
  std::vector<BatchArraySpec> arrays;  ///< observations, and the columns of rewards and ends
  std::vector<BatchAction> actions;    ///< actions of one robot
  std::vector<BatchReward> rewards;    ///< summed in this order
  std::vector<BatchEnd> ends;          ///< tested in each step
};

/// The options of a BatchEnv.
struct BatchSpec {
  std::size_t copies = 1;             ///< number of copies of the world
  unsigned threads = 0;               ///< as in SimulationOptions; changes no result
  std::size_t ticks = 1;              ///< ticks of the world per step
  double seconds = 60;                ///< length of an episode in world time, s; it is then truncated
  std::vector<BatchTeam> teams;       ///< no robot may be in two teams
  std::vector<std::string> measures;  ///< of each copy, as Measures takes them
};

/// Many copies of one world that step together, each with its own seed: a vectorised environment for
/// learning.
///
///     troupe::BatchEnv batch("room.json", spec);
///     batch.reset();
///     for (;;) {
///       policy(batch.array(0, "observation"), batch.actions(0));
///       batch.step(batch.over());  // copies that were over begin their next episode
///     }
///
/// arrays   row-major; the spans stay valid and show new numbers after each step() and reset()
/// result   the same bits for any number of threads and copies. A copy is a Simulation of the world with its
///          own seed; it runs on one thread
/// robots   of teams do not run the controllers of the world, others do. All sensors of teams run
/// end      a robot is finished if one of its ends holds, or if it dies, which itself gives no reward. From
///          then on its drive is commanded to stop and its reward is 0. A program may finish more robots by
///          writing to terminated() between two steps
/// over     a copy is over if all robots of its teams that are in the world are finished, if its episode
///          reaches `seconds`, or if the world's `stop_when` holds, which finishes all robots. step() does
///          not begin the next episode by itself
/// begin    an episode begins with one tick without commands, so that sensors have readings
/// seeds    the first episode of a copy has the seed given to reset(), or else the world's seed plus the
///          index of the copy; seeds of later episodes are derived from it
/// threads  call it from one thread
class BatchEnv {
 public:
  /// Throws InputError as Simulation does, std::out_of_range for unknown names, and std::invalid_argument for
  /// an inconsistent spec. options.threads is ignored.
  BatchEnv(const std::filesystem::path& world, const BatchSpec& spec, const SimulationOptions& options = {});
  /// Makes a batch of copies of a loaded world (Simulation::another()). A simulation may have several
  /// batches.
  BatchEnv(const Simulation& world, const BatchSpec& spec);
  ~BatchEnv();
  BatchEnv(BatchEnv&&) noexcept;             ///< the source may only be destroyed or assigned
  BatchEnv& operator=(BatchEnv&&) noexcept;  ///< the source may only be destroyed or assigned

  const BatchSpec& spec() const;                           ///< the spec that the batch was made from
  std::size_t copies() const;                              ///< number of copies of the world
  std::size_t robots(std::size_t team) const;              ///< robots per copy, in the world or not
  std::vector<std::string> names(std::size_t team) const;  ///< names of the robots, in the order of their ids
  const Simulation& simulation(std::size_t copy) const;    ///< the simulation of a copy, to read
  unsigned threads() const;                                ///< number of threads that step the copies

  /// An array of a team.
  struct Array {
    engine::Element element = engine::Element::f32;  ///< element type of `bytes`
    std::size_t columns = 0;                         ///< elements per robot
    std::span<std::byte> bytes;                      ///< copies x robots x columns elements
  };
  /// The array of this name. Throws std::out_of_range, with the arrays of the team, if there is none.
  Array array(std::size_t team, std::string_view name) const;
  /// An array of float32, as array(). Throws std::invalid_argument for other element types.
  std::span<const float> floats(std::size_t team, std::string_view name) const;
  std::span<double> actions(std::size_t team);           ///< copies x robots x actions: written by the caller
  std::span<double> rewards(std::size_t team);           ///< copies x robots: rewards of the last step
  std::span<std::uint8_t> terminated(std::size_t team);  ///< copies x robots: 1 if the robot is finished
  std::span<const std::uint8_t> alive(
      std::size_t team) const;                      ///< copies x robots: 1 if the robot is in the world
  std::span<const std::uint8_t> truncated() const;  ///< one per copy: 1 after `seconds`
  /// One per copy: 1 if all robots that are in the world are finished, and at least one is, or if the copy is
  /// truncated. Reads terminated() at the time of the call.
  std::span<const std::uint8_t> over();
  std::vector<std::string> measure_columns() const;  ///< names as in Measures::columns()
  std::span<const double> measures() const;          ///< copies x columns
  std::span<const std::uint64_t> seeds() const;      ///< one per copy: seed of its current episode

  /// Begins an episode in some copies.
  /// which  one per copy: 0 leaves the copy as it is; empty: all
  /// seeds  one per copy: the seed of its first episode from now on; without a seed, or empty: begins the
  ///        next episode
  /// Throws std::invalid_argument for spans of other sizes, std::logic_error if a copy that is left out has
  /// not begun yet, and InputError if robots find no place.
  void reset(std::span<const std::uint8_t> which = {},
             std::span<const std::optional<std::uint64_t>> seeds = {});
  /// Advances all copies by one step. begins: one per copy; if not 0, the copy begins its next episode
  /// instead of a step, with a reward of 0; empty: none. Throws std::logic_error before the first reset();
  /// std::invalid_argument, without a step, if an action is not finite; engine::StepError if the step of a
  /// copy throws: the other copies are complete, and that copy can only be reset.
  void step(std::span<const std::uint8_t> begins = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe
