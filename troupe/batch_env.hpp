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

/// Some columns of an observed array, for one robot.
struct BatchPart {
  /// Where they come from.
  enum class Of : std::uint8_t {
    reading,    ///< all columns of a field of a device (Model::readings)
    pose,       ///< x, y (m), cosine and sine of the heading: world frame
    estimate,   ///< the same of the pose that the robot believes to have
    speed,      ///< forward, left (m/s), turn (rad/s) of the last tick
    stalled,    ///< 1 where the last motion was refused, else 0
    nearest,    ///< k_neighbour columns for each of the `count` nearest robots, nearest first
    target,     ///< x, y (m, in the robot's frame) and the distance (m) of a body
    time_left,  ///< of the episode, from 1 to 0
  };
  static constexpr std::size_t k_neighbour = 5;  ///< see `nearest`

  Of of = Of::reading;  ///< which of these
  std::string device;   ///< reading: its name; empty: the first that has such a field
  std::string field;    ///< reading: its name
  /// nearest: a type or a population of robots, or one robot; empty: all robots. Each neighbour has x, y (m,
  /// in the robot's frame), the cosine and the sine of its heading relative to the robot's, and 1; five zeros
  /// where there are fewer. Of two at one distance the lower id comes first.
  /// target: a model; or a population, of which each robot is given the body of its own number: "r3" of
  /// "goal" that is "goal3". Zeros while that body is not in the world.
  std::string name;
  std::size_t count = 1;                                     ///< nearest: how many
  double range_m = std::numeric_limits<double>::infinity();  ///< nearest: none is farther than this
  /// Lengths and readings are multiplied by this; cosines, sines and flags are not.
  double scale = 1;
};

/// An array of a batch: copies x robots x columns, row-major.
struct BatchArraySpec {
  std::string name;              ///< unique in its team
  std::vector<BatchPart> parts;  ///< beside one another, in float32
  /// Keeps the element type of the field, unscaled: for pictures. The array then has one part, a reading.
  bool raw = false;
};

/// One number that a policy gives a robot in each step: -1 asks for `low`, 1 for `high`, what is beyond is
/// clipped, and what is between is linear.
struct BatchAction {
  std::string device;   ///< takes commands (Model::asked); empty: the robot's drive
  std::string command;  ///< of the drive: "forward", "left" (m/s) or "turn" (rad/s); of a device a field
  double low = -1;      ///< in the command's unit; integers are rounded to the nearest
  double high = 1;      ///< in the same
};

/// A column of a robot's arrays, or of the measures of its copy.
struct BatchColumn {
  std::string array;       ///< of the team; empty: a measure
  std::size_t column = 0;  ///< of the array
  std::string measure;     ///< its column, with its unit or without
};

/// What is added to the reward of each robot that is not finished.
struct BatchReward {
  BatchColumn of;       ///< of what
  double weight = 1;    ///< it is multiplied by
  bool change = false;  ///< of how much it grew in this step; else of its value
};

/// What finishes a robot; of a measure all robots of the copy.
struct BatchEnd {
  BatchColumn of;         ///< of what
  double below = 0;       ///< it has come to be less than this
  bool is_above = false;  ///< it has come to be more than `below`, instead
  double reward = 0;      ///< is added to the reward of that step
};

/// Robots that learn one policy: with one list of arrays, actions and rewards.
struct BatchTeam {
  std::string name;                    ///< unique
  std::string robots;                  ///< a type, a population or a robot, as of Simulation::swarm()
  std::vector<BatchArraySpec> arrays;  ///< what they observe, and what rewards and ends are made of
  std::vector<BatchAction> actions;    ///< what they do
  std::vector<BatchReward> rewards;    ///< summed up in this order
  std::vector<BatchEnd> ends;          ///< each is looked at in each step
};

/// What a BatchEnv is made of, beside a world.
struct BatchSpec {
  std::size_t copies = 1;             ///< of the world
  unsigned threads = 0;               ///< as in SimulationOptions; changes no result
  std::size_t ticks = 1;              ///< of the world in one step
  double seconds = 60;                ///< world time of an episode, which is then truncated
  std::vector<BatchTeam> teams;       ///< no robot is in two
  std::vector<std::string> measures;  ///< of each copy, as Measures takes them
};

/// Many copies of one world that step side by side, each with a seed of its own: for learning.
///
///     troupe::BatchEnv batch("room.json", spec);
///     batch.reset();
///     for (;;) {
///       policy(batch.array(0, "observation"), batch.actions(0));
///       batch.step(batch.over());  // copies that were over begin their next episode
///     }
///
/// arrays   row-major; the spans stay valid, and show new numbers after each step() and reset()
/// result   the same bits for any number of threads and copies: a copy is a Simulation of the world with its
///          seed that is given the same commands, bit for bit, and runs on one thread
/// robots   of teams do not run the controllers that the world gives them; others do. All sensors of teams
/// run finished a robot for which an end holds, or that died: a death itself gives no reward. It is told to
/// stand still, its reward is 0 from then
///          on. Programs may finish more by writing to terminated() between two steps
/// over     a copy whose learning robots are all finished, whose episode is as long as `seconds`, or whose
///          world's `stop_when` holds: that finishes all. step() does not begin the next episode by itself
/// begin    an episode begins with one tick in which robots get no command, so that sensors have readings
/// seeds    the first episode of a copy has the seed that reset() gave, those that follow have numbers drawn
///          from it
/// threads  one thread calls it
class BatchEnv {
 public:
  /// Throws InputError as Simulation does; std::out_of_range for names that are not there;
  /// std::invalid_argument for a spec that makes no sense. options.threads is not looked at.
  BatchEnv(const std::filesystem::path& world, const BatchSpec& spec, const SimulationOptions& options = {});
  /// Of a world that was loaded: its copies are Simulation::another(). Any number of batches may be made of
  /// it.
  BatchEnv(const Simulation& world, const BatchSpec& spec);
  ~BatchEnv();
  BatchEnv(BatchEnv&&) noexcept;             ///< the one moved from is of no use
  BatchEnv& operator=(BatchEnv&&) noexcept;  ///< as that

  const BatchSpec& spec() const;                           ///< as it was given
  std::size_t copies() const;                              ///< of the world
  std::size_t robots(std::size_t team) const;              ///< in each copy, in the world or not
  std::vector<std::string> names(std::size_t team) const;  ///< of them, in the order of their ids
  const Simulation& simulation(std::size_t copy) const;    ///< to look at
  unsigned threads() const;                                ///< of the loop over copies

  /// What an array holds. Throws std::out_of_range with the names that the team has.
  struct Array {
    engine::Element element = engine::Element::f32;  ///< what `bytes` are made of
    std::size_t columns = 0;                         ///< numbers a robot
    std::span<std::byte> bytes;                      ///< copies x robots x columns of them
  };
  Array array(std::size_t team, std::string_view name) const;  ///< see Array
  /// Of an array of float32.
  std::span<const float> floats(std::size_t team, std::string_view name) const;
  std::span<double> actions(std::size_t team);           ///< copies x robots x actions: to be filled
  std::span<double> rewards(std::size_t team);           ///< copies x robots: of the last step
  std::span<std::uint8_t> terminated(std::size_t team);  ///< copies x robots: 1 for who is finished
  std::span<const std::uint8_t> alive(
      std::size_t team) const;                      ///< copies x robots: 1 for who is in the world
  std::span<const std::uint8_t> truncated() const;  ///< of each copy: 1 after `seconds`
  /// Of each copy: 1 where all robots that are in the world are finished, and some are, or it is truncated.
  /// Looks at terminated() when it is called.
  std::span<const std::uint8_t> over();
  std::vector<std::string> measure_columns() const;  ///< as of Measures::columns()
  std::span<const double> measures() const;          ///< copies x columns
  std::span<const std::uint64_t> seeds() const;      ///< of each copy: of its episode

  /// Begins an episode in these copies.
  /// which  of each copy: 0 leaves it as it is; empty: all
  /// seeds  of each copy: of its first episode from now on; no seed, or empty: the next episode
  /// Throws std::invalid_argument for spans of other sizes, and InputError where robots find no place.
  void reset(std::span<const std::uint8_t> which = {},
             std::span<const std::optional<std::uint64_t>> seeds = {});
  /// One step of all copies. begins: of each copy: where not 0 the next episode begins instead of a step,
  /// with a reward of 0; empty: none. Throws std::logic_error before the first reset();
  /// std::invalid_argument, and steps nothing, where an action is not finite; engine::StepError where a
  /// copy's step throws: the others are complete, and that copy goes on from a reset alone.
  void step(std::span<const std::uint8_t> begins = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe
