#pragma once

#include "engine/fields/state_table.hpp"
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

/// A group of columns of an array of observations (BatchArraySpec): the numbers that one source provides for
/// one robot. A device is a sensor or other equipment of a robot; its readings consist of named fields.
struct BatchPart {
  /// The source of the columns.
  enum class Of : std::uint8_t {
    reading,    ///< all values of a field of a device (Model::readings)
    pose,       ///< x, y (m), cosine and sine of the heading, world frame: 4 columns
    estimate,   ///< x, y (m), cosine and sine of the heading of the estimated pose (Model::estimate)
    speed,      ///< forward, left (m/s), turn (rad/s), as Model::speed() returns them
    stalled,    ///< 1 if the last motion was blocked or would have left the bounds of the world, else 0
    nearest,    ///< the `count` nearest robots, nearest first: see `name`
    target,     ///< x, y (m, in the robot's frame) and distance (m) of a body: see `name`
    time_left,  ///< fraction of BatchSpec::seconds that remains: 1 at the start of an episode, 0 at its end
  };
  static constexpr std::size_t k_neighbour = 5;  ///< number of columns per nearest robot

  Of of = Of::reading;  ///< source of the columns
  std::string device;   ///< `reading`: name of the device; empty: the first device with this field
  std::string field;    ///< `reading`: name of the field
  /// With `nearest`: the robots among which the nearest ones are searched, given as the name of a type of
  /// bodies, of a population (bodies of one type that the world file creates with one entry) or of one robot;
  /// empty: all robots. The observing robot itself and robots that are not in the world are skipped.
  /// Distances are between the origins of the robots, in the plane. Each robot that is found has k_neighbour
  /// columns: x, y (m, in the observing robot's frame), cosine and sine of its heading relative to the
  /// observing robot's heading, and 1. If fewer than `count` robots are found, the remaining columns are 0.
  /// If two robots are at the same distance, the one with the lower id comes first.
  /// With `target`: if a body has this name, it is the target of all robots. Otherwise each robot has its own
  /// target: the body whose name is `name` followed by the number at the end of the robot's name. For
  /// example, if `name` is "goal" and no body has this name, the target of the robot "r3" is the body
  /// "goal3". If a robot has no target, the constructor of BatchEnv throws std::out_of_range. The columns are
  /// 0 while the target is not in the world.
  std::string name;
  std::size_t count = 1;  ///< `nearest`: number of robots to find, 1 to 1000
  /// `nearest`: the largest distance at which robots are found, m; above 0
  double range_m = std::numeric_limits<double>::infinity();
  /// Factor by which lengths, speeds, turn rates and readings are multiplied; finite. Cosines, sines,
  /// `time_left`, `stalled` and the 1 of `nearest` are not scaled.
  double scale = 1;
};

/// An array of observations: copies of the world x robots of the team x columns, row-major. The columns of a
/// robot that is not in the world are 0.
struct BatchArraySpec {
  std::string name;              ///< unique among the arrays of its team
  std::vector<BatchPart> parts;  ///< one or more groups of columns, from the first column to the last
  /// False: the elements are float32. True: the elements have the type of the field, and `scale` is applied
  /// only if this type is float32; use this for images. Such an array must have exactly one part, of the
  /// source `reading`.
  bool raw = false;
};

/// An action: a number that the policy sets for each robot in each step. It controls one component of a
/// command of the robot. The number -1 commands `low`, 1 commands `high`, and numbers in between are
/// interpolated linearly. Numbers outside this range are clipped to it. If at least one action of a team
/// commands the drive, the components of the drive's command that no action controls are 0.
struct BatchAction {
  std::string device;  ///< name of a device that takes commands (Model::asked); empty: the drive
  /// For the drive: "forward", "left" (m/s) or "turn" (rad/s; for a car drive the steering angle, rad). For a
  /// device: a field of its command with a single column (Model::asked).
  std::string command;
  /// Value for -1, in the unit of the command; finite. Values of integer fields are rounded to the nearest
  /// integer and clamped to the range of their type.
  double low = -1;
  double high = 1;  ///< value for 1, in the unit of the command; finite; may be less than `low`
};

/// A number that a BatchReward or a BatchEnd uses: either a column of an array, with one value per robot, or
/// a measure (a number computed from the state of the world, troupe/measures.hpp), with one value per copy of
/// the world.
struct BatchColumn {
  std::string array;       ///< name of an array of the team; empty: `measure` is used
  std::size_t column = 0;  ///< index of the column in the array, from 0
  /// Name of a column of BatchEnv::measures(), with or without its unit: "displacement_m" or "displacement".
  std::string measure;
};

/// A term of the reward. The reward of a robot in a step is the sum of all terms, plus BatchEnd::reward of
/// each condition (BatchEnd) that holds after the step. The reward is 0 for robots that were finished before
/// the step or are not in the world.
struct BatchReward {
  BatchColumn of;     ///< the number that is rewarded
  double weight = 1;  ///< factor by which the number is multiplied
  /// True: the reward uses the change of the number since the previous step (or since the beginning of the
  /// episode), not the number itself. The change is 0 for a robot that was not in the world after the
  /// previous step.
  bool change = false;
};

/// A condition that finishes a robot, that is, ends its episode: a number is below (or above) a threshold. A
/// condition that tests a measure finishes all robots of the team in its copy of the world, except robots
/// that are not in the world (removed or not yet born). If the number is NaN, the condition does not hold.
struct BatchEnd {
  BatchColumn of;         ///< the number that is tested
  double below = 0;       ///< the threshold; unless `is_above`, the condition holds if the number is less
  bool is_above = false;  ///< true: the condition holds if the number is greater than the threshold `below`
  double reward = 0;      ///< added to the robot's reward of the step in which the condition holds
};

/// A group of robots that learn one policy. They have the same observations, actions and rewards.
struct BatchTeam {
  std::string name;    ///< name of the team; no two teams have the same name
  std::string robots;  ///< name of a type of bodies, a population or a robot; empty: all robots
  /// Name of the only robot of the team, also if a type or a population has this name; empty: the team has
  /// the robots that `robots` names.
  std::string robot;
  std::vector<BatchArraySpec> arrays;  ///< observations, and arrays that only rewards and ends use
  std::vector<BatchAction> actions;    ///< the actions that each robot of the team has
  std::vector<BatchReward> rewards;    ///< terms of the reward, summed in this order
  std::vector<BatchEnd> ends;          ///< conditions that finish a robot, tested in each step
};

/// The options of a BatchEnv. Its constructor checks them.
struct BatchSpec {
  std::size_t copies = 1;  ///< number of copies of the world, 1 to 1,000,000
  /// Number of threads that step the copies, at most 1,024. 0: one per processor that the process may use.
  /// The number changes no result.
  unsigned threads = 0;
  std::size_t ticks = 1;  ///< number of ticks (time steps of the simulation) per step, 1 or more
  /// World time after which an episode is truncated, s: above 0 and at most 1e12, rounded up to whole ticks.
  /// The time counts from the end of the first tick of the episode, in which the policies give no commands,
  /// and is tested after each step.
  double seconds = 60;
  std::vector<BatchTeam> teams;  ///< one or more teams; no robot may be in two teams
  /// Measures (numbers computed from the state of the world) that are computed for each copy, named as for
  /// the constructor of Measures. Empty: no measures.
  std::vector<std::string> measures;
};

/// Many copies of one world that step together, each with its own seed: a vectorised environment for
/// learning. The robots of a team learn one policy. A step advances all copies by BatchSpec::ticks ticks
/// (time steps of the simulation).
///
///     troupe::BatchEnv batch("room.json", spec);
///     batch.reset();
///     for (;;) {
///       policy(batch.array(0, "observation"), batch.actions(0));
///       batch.step(batch.over());  // copies that were over begin their next episode
///     }
///
/// arrays   row-major. The spans that array(), actions() and the other functions return stay valid, and their
///          content changes with each step() and reset()
/// copies   each copy is a Simulation of the world with its own seed, which runs on one thread. Its results
///          have the same bits for any number of threads and copies
/// robots   the policies drive the robots of teams: these robots do not run their controllers of the world
///          file, and all their sensors run. Other robots run their controllers
/// end      a robot is finished when one of the ends of its team holds or when it dies, that is, leaves the
///          world for good; its death itself gives no reward. In the steps after a robot has finished, its
///          reward is 0, its actions are ignored, its drive is commanded to stop (if an action of the team
///          commands the drive), and its devices keep their last commands. A program may finish further
///          robots by writing 1 to terminated() between two steps
/// over     a copy is over when its episode reaches `seconds`, or when all robots of its teams that are in
///          the world are finished (over() has the exact rule). If a condition of the world's `stop_when`
///          holds, all robots of the teams are finished, and so the copy is over. step() begins the next
///          episode of a copy only if the caller requests it
/// begin    each episode begins with one tick in which the policies give no commands, so that sensors have
///          readings
/// seeds    the first episode of a copy has the seed given to reset(), or else the seed of the world plus the
///          index of the copy. The seeds of the later episodes of the copy are derived from that seed
/// indices  `team` is an index in BatchSpec::teams, and `copy` a number from 0 to copies() - 1; other numbers
///          throw std::out_of_range. In spans of copies x robots elements, robot i of copy c is element
///          c * robots(team) + i. The robots of a team are in the order of their ids
/// first    before the first reset(), all arrays of the teams contain 0
/// threads  call all functions from one thread
class BatchEnv {
 public:
  /// Loads a world file and makes the copies. Throws InputError as the constructors of Simulation and
  /// Measures do; std::out_of_range for unknown names of robots, devices, fields, commands, targets, arrays
  /// and columns of measures in the spec; and std::invalid_argument for other errors in the spec, such as a
  /// team without robots. options.threads is ignored.
  BatchEnv(const std::filesystem::path& world, const BatchSpec& spec, const SimulationOptions& options = {});
  /// Makes copies of the world of a simulation, at tick 0, as Simulation::another() does. The simulation is
  /// not changed and need not outlive the batch. Several batches may be made from one simulation. Throws as
  /// the other constructor and as Simulation::another().
  BatchEnv(const Simulation& world, const BatchSpec& spec);
  ~BatchEnv();
  BatchEnv(BatchEnv&&) noexcept;             ///< a moved-from object may only be destroyed or assigned to
  BatchEnv& operator=(BatchEnv&&) noexcept;  ///< a moved-from object may only be destroyed or assigned to

  const BatchSpec& spec() const;                           ///< the options given to the constructor
  std::size_t copies() const;                              ///< number of copies of the world
  std::size_t robots(std::size_t team) const;              ///< robots of a team per copy, in the world or not
  std::vector<std::string> names(std::size_t team) const;  ///< names of a team's robots, in order of ids
  const Simulation& simulation(std::size_t copy) const;    ///< the simulation of a copy, read-only
  /// The simulation of a copy, for observers such as live::View, which shows a running world in a browser.
  /// Only the batch may step and reset the simulation.
  Simulation& simulation(std::size_t copy);
  unsigned threads() const;  ///< number of threads that step the copies

  /// The elements of one array of a team, for all copies of the world.
  struct Array {
    engine::Element element = engine::Element::f32;  ///< element type of `bytes`
    std::size_t columns = 0;                         ///< number of elements per robot
    std::span<std::byte> bytes;                      ///< copies x robots x columns elements
  };
  /// Returns the array of this name of a team. Throws std::out_of_range, with the names of the arrays of the
  /// team, if the team has no such array.
  Array array(std::size_t team, std::string_view name) const;
  /// Returns the elements of the array of this name of a team: copies x robots x columns, row-major. Throws
  /// as array() does, and std::invalid_argument if the elements are not float32.
  std::span<const float> floats(std::size_t team, std::string_view name) const;
  /// The actions of a team, copies x robots x actions elements, row-major: the caller writes the numbers for
  /// the next step. A step does not change them.
  std::span<double> actions(std::size_t team);
  std::span<double> rewards(std::size_t team);           ///< copies x robots: reward of the last step
  std::span<std::uint8_t> terminated(std::size_t team);  ///< copies x robots: 1 if the robot is finished
  /// Copies x robots: 1 if the robot is in the world after the last step, else 0.
  std::span<const std::uint8_t> alive(std::size_t team) const;
  /// One per copy: 1 if the episode has reached BatchSpec::seconds, else 0.
  std::span<const std::uint8_t> truncated() const;
  /// One per copy: 1 if the copy is over, else 0. A copy is over if its episode is truncated. It is also over
  /// if at least one robot of its teams is finished (in the world or not) and all robots of its teams that
  /// are in the world are finished. Each call takes into account what the caller has written to terminated().
  std::span<const std::uint8_t> over();
  /// Names of the columns of measures(), with their units, as Measures::columns() returns them; empty if
  /// BatchSpec::measures is empty.
  std::vector<std::string> measure_columns() const;
  /// Values of the measures after the last step: copies x measure_columns().size() elements, row-major.
  std::span<const double> measures() const;
  std::span<const std::uint64_t> seeds() const;  ///< one per copy: seed of its current episode

  /// Begins an episode in all or some copies.
  /// which  one byte per copy: 0 does not change the copy, another value begins an episode; empty: all copies
  /// seeds  one element per copy: the seed of the episode, from which the seeds of later episodes are
  ///        derived. If the element has no value, or if `seeds` is empty, the copy begins its next episode,
  ///        whose seed is derived from the seed that the copy was last given
  /// Throws std::invalid_argument for spans of other sizes, std::logic_error if `which` is 0 for a copy that
  /// has not yet begun its first episode, InputError if the rules by which the world file places robots find
  /// no place, and engine::StepError if the first tick of an episode throws.
  void reset(std::span<const std::uint8_t> which = {},
             std::span<const std::optional<std::uint64_t>> seeds = {});
  /// Advances all copies by one step. begins: one byte per copy; if it is not 0, the copy begins its next
  /// episode instead of making a step, and its rewards are 0; empty: all copies make a step. Throws
  /// std::logic_error before the first reset(). Throws std::invalid_argument, before any copy makes its step,
  /// if `begins` has another size or an action of a copy that makes a step is not finite. Throws
  /// engine::StepError if the step of a copy throws, and as reset() does if a copy cannot begin its episode.
  /// If the step of a copy throws or a copy cannot begin its episode, the other copies have made their step,
  /// and the failed copy must be reset before it can step again.
  void step(std::span<const std::uint8_t> begins = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe
