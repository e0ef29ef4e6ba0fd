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
  /// A name; its meaning depends on the source `of`. Only the sources `nearest` and `target` use it.
  ///
  /// `nearest`: name of a type of bodies, of a population (the bodies that one entry of the world file
  /// creates) or of one robot. The nearest robots are searched among the robots of this type or population;
  /// empty: among all robots. The observing robot itself and robots that are not in the world are skipped.
  /// Distances are horizontal, between the origins of the robots. If two robots are at the same distance, the
  /// one with the lower id comes first. Each robot that is found has k_neighbour columns: x and y (m, in the
  /// observing robot's frame), the cosine and sine of its heading relative to the observing robot's heading,
  /// and 1. If fewer than `count` robots are found, the remaining columns are 0.
  ///
  /// `target`: name of the body that is the target of all robots. If no body has this name, each robot has
  /// its own target: the body whose name is `name` followed by the number at the end of the robot's name. For
  /// example, if `name` is "goal" and no body is called "goal", the target of the robot "r3" is the body
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

/// An array of observations with the shape copies of the world x robots of the team x columns, row-major. The
/// columns are 0 for a robot that is not in the world.
struct BatchArraySpec {
  std::string name = {};              ///< unique among the arrays of its team
  std::vector<BatchPart> parts = {};  ///< one or more groups of columns, from the first column to the last
  /// False: the elements are float32. True: the elements have the type of the observed field, and `scale` is
  /// applied only if this type is float32; use this for images. An array with raw = true must have exactly
  /// one part, with the source `reading`.
  bool raw = false;
};

/// An action: a number that the policy sets for each robot in each step. It determines one number of a
/// command, to the drive or to another device of the robot. The action -1 commands the value `low`, and the
/// action 1 commands the value `high`. Actions in between are interpolated linearly. Actions outside [-1, 1]
/// are clipped to this range. If a team has actions for some of the speeds forward, left and turn of its
/// drives, the other speeds are commanded to be 0.
struct BatchAction {
  std::string device = {};  ///< name of a device that takes commands (Model::asked); empty: the drive
  /// The number that the action determines. For the drive: "forward", "left" (m/s) or "turn" (rad/s; for a
  /// car drive the steering angle, rad). For another device: the name of a field of its command
  /// (Model::asked); the field must be a single number.
  std::string command = {};
  /// Value for -1, in the unit of the command; finite. Values of integer fields are rounded to the nearest
  /// integer and clamped to the range of their type, which is 0 to 1 for a bool.
  double low = -1;
  /// Value for 1, in the unit of the command; finite, and so is `high - low`; may be less than `low`.
  double high = 1;
};

/// A number that a BatchReward or a BatchEnd uses. It is either a column of an array, with one value per
/// robot, or a measure, with one value per copy of the world. A measure is a number computed from the state
/// of the world (troupe/measures.hpp). If `array` is not empty, it selects a column; otherwise, `measure`
/// selects a measure.
struct BatchColumn {
  std::string array = {};  ///< name of an array of the team; empty: `measure` is used
  std::size_t column = 0;  ///< index of the column in the array, from 0
  /// Name of a column of BatchEnv::measures(), with or without its unit: "displacement_m" or "displacement".
  std::string measure = {};
};

/// A term of the reward. The reward of a robot in a step is the sum of all terms of its team. Each condition
/// (BatchEnd) that holds for the robot after the step adds BatchEnd::reward. The reward is 0 for a robot that
/// was finished (see BatchEnd) before the step, or that is not in the world after the step. For any other
/// robot, a term that is not finite, such as that of a measure that is NaN, makes the step fail.
struct BatchReward {
  BatchColumn of = {};  ///< the number that is rewarded
  double weight = 1;    ///< factor by which the number is multiplied; finite
  /// False: the term uses the number itself. True: the term uses the change of the number since the previous
  /// step or, in the first step of an episode, since the end of the tick with which the episode begins. The
  /// change is 0 for a robot that was not in the world after the previous step.
  bool change = false;
};

/// A condition that ends the episode of a robot; the robot is then *finished*. The condition compares a
/// number with a threshold. It does not hold if the number is NaN. A column of an array is tested for each
/// robot separately. A measure is tested for a whole copy of the world: the condition then holds for all
/// robots of the team in this copy. A condition never finishes a robot that is not in the world (removed or
/// not yet born).
struct BatchEnd {
  BatchColumn of = {};    ///< the number that is tested
  double below = 0;       ///< the threshold; not NaN
  bool is_above = false;  ///< true: holds if the number is greater than the threshold; false: if it is less
  double reward = 0;      ///< added to the robot's reward in the step after which the condition holds; finite
};

/// A group of robots that learn one policy. They have the same observations, actions and rewards.
struct BatchTeam {
  std::string name = {};    ///< name of the team; no two teams have the same name
  std::string robots = {};  ///< name of a type of bodies, a population or a robot; empty: all robots
  /// Name of a robot that is the only robot of the team; `robots` is then ignored. Use this member if the
  /// name of the robot is also the name of a type or a population. Empty: the team has the robots that
  /// `robots` names.
  std::string robot = {};
  std::vector<BatchArraySpec> arrays = {};  ///< observations, and arrays that only rewards and ends use
  /// The actions that each robot of the team has; no two of them may set the same command.
  std::vector<BatchAction> actions = {};
  std::vector<BatchReward> rewards = {};  ///< terms of the reward, summed in this order
  std::vector<BatchEnd> ends = {};        ///< conditions that finish a robot, tested in each step
};

/// The options of a BatchEnv. Its constructor checks them.
struct BatchSpec {
  std::size_t copies = 1;  ///< number of copies of the world, 1 to 1,000,000
  /// Number of threads that step the copies, at most 1,024. 0: one thread per processor that the process may
  /// use. The results are the same with any number of threads.
  unsigned threads = 0;
  std::size_t ticks = 1;  ///< number of ticks (time steps of the simulation) per step, 1 or more
  /// Simulated time after which an episode is truncated, s: above 0 and at most 1e12, rounded up to whole
  /// ticks. The time is tested after each step. It is counted from the end of the first tick of the episode;
  /// in this tick, the policies give no commands.
  double seconds = 60;
  std::vector<BatchTeam> teams = {};  ///< one or more teams; no robot may be in two teams
  /// Measures to compute for each copy. A measure is a number computed from the state of the world. Each text
  /// names a measure, such as "stalls", in the format of the constructor of Measures (troupe/measures.hpp).
  /// Empty: no measures.
  std::vector<std::string> measures = {};
  /// The bodies that may begin an episode at poses that the program writes (BatchEnv::starts()): each text is
  /// the name of a model, of a population or of a type, and a body may be in only one of them. Empty: all
  /// bodies begin where the world places them.
  std::vector<std::string> starts = {};
};

/// Many copies of one world that step together, each with its own seed: a vectorised environment for
/// learning. A team is a group of robots that learn one policy. A step advances each copy by BatchSpec::ticks
/// ticks (time steps of the simulation).
///
///     troupe::BatchEnv batch("room.json", spec);
///     batch.reset();
///     for (;;) {
///       policy(batch.array(0, "observation"), batch.actions(0));
///       batch.step(batch.over());  // copies that were over begin their next episode
///     }
///
/// copies    Each copy is a Simulation, which runs on one thread. The results of a copy have the same bits
///           for any number of threads and copies.
/// robots    The policies command the robots of teams. The controllers that the world file gives these robots
///           do not run, but all sensors of these robots run. The other robots run their controllers.
/// begin     Each episode begins with one tick in which the policies give no commands, so that the sensors
///           have readings for the first step.
/// finished  A robot is finished if one of these conditions holds. A BatchEnd of its team holds. The robot
///           dies, that is, leaves the world for good (its death itself gives no reward). A condition of the
///           world's `stop_when` holds, which finishes all robots of teams in the copy. The program writes 1
///           to terminated() between two steps. In later steps, the reward of a finished robot is 0, its
///           actions are ignored, and its devices keep their last commands. Its drive is commanded to stop if
///           an action of the team commands the drive.
/// over      A copy is over when its episode has lasted for `seconds`, or when all robots of teams that are
///           in the world are finished. over() has the exact rule. The next episode of a copy begins only
///           when the program requests it, with step() or reset().
/// seeds     The first episode of a copy has the seed given to reset() or, without such a seed, the seed of
///           the world plus the index of the copy. The seeds of the later episodes of the copy are derived
///           from the seed of its first episode.
/// indices   The argument `team` is an index in BatchSpec::teams, and `copy` is a number from 0 to copies() -
///           1. Any other number makes the function throw std::out_of_range. In a span with copies x robots
///           elements, robot i of copy c is element c * robots(team) + i. The robots of a team are in the
///           order of their ids.
/// arrays    Arrays are row-major. The spans that array(), actions() and the other functions return stay
///           valid. step() and reset() change their contents. Before the first reset(), all arrays of teams
///           contain 0.
/// threads   Call all functions from one thread. In callbacks of the simulations of the copies, step() and
///           reset() throw std::logic_error.
class BatchEnv {
 public:
  /// Loads a world file and makes the copies. Ignores options.threads. Throws
  /// - InputError for errors in the world file, as the constructor of Simulation does, and for unknown or
  ///   wrong measures, as the constructor of Measures does
  /// - std::out_of_range for unknown names in the spec: of robots, devices, fields, commands, targets, arrays
  ///   or columns of measures
  /// - std::invalid_argument for other errors in the spec, such as a team without robots
  BatchEnv(const std::filesystem::path& world, const BatchSpec& spec, const SimulationOptions& options = {});
  /// Makes copies of the world of a simulation, at tick 0, with Simulation::another(). The simulation is not
  /// changed and need not outlive the batch. Several batches may be made from one simulation. Throws the
  /// exceptions of Simulation::another(), and those of the other constructor for errors in the spec.
  BatchEnv(const Simulation& world, const BatchSpec& spec);
  ~BatchEnv();
  BatchEnv(BatchEnv&&) noexcept;             ///< a moved-from object may only be destroyed or assigned to
  BatchEnv& operator=(BatchEnv&&) noexcept;  ///< a moved-from object may only be destroyed or assigned to

  const BatchSpec& spec() const;                           ///< the options given to the constructor
  std::size_t copies() const;                              ///< number of copies of the world
  std::size_t robots(std::size_t team) const;              ///< robots of a team per copy, in the world or not
  std::vector<std::string> names(std::size_t team) const;  ///< names of a team's robots, in order of ids
  const Simulation& simulation(std::size_t copy) const;    ///< the simulation of a copy, read-only
  /// Returns the simulation of a copy, for observers such as live::View, which shows a running world in a
  /// browser. Only the batch may step and reset the simulation. The callbacks of the simulations of different
  /// copies are called on several threads at once.
  Simulation& simulation(std::size_t copy);
  unsigned threads() const;  ///< number of threads that step the copies

  /// The elements of one array of a team, for all copies of the world.
  struct Array {
    engine::Element element = engine::Element::f32;  ///< element type of `bytes`
    std::size_t columns = 0;                         ///< number of elements per robot
    std::span<std::byte> bytes;                      ///< copies x robots x columns elements
  };
  /// Returns the array with this name of a team. If the team has no such array, throws std::out_of_range with
  /// the names of the team's arrays.
  Array array(std::size_t team, std::string_view name) const;
  /// Returns the elements of the array with this name of a team: copies x robots x columns, row-major. Throws
  /// std::out_of_range if there is no such array, and std::invalid_argument if its elements are not float32.
  std::span<const float> floats(std::size_t team, std::string_view name) const;
  /// Returns the actions of a team: copies x robots x actions elements, row-major. The program writes the
  /// numbers for the next step here. A step does not change them.
  std::span<double> actions(std::size_t team);
  std::span<double> rewards(std::size_t team);           ///< copies x robots: reward of the last step
  std::span<std::uint8_t> terminated(std::size_t team);  ///< copies x robots: 1 if the robot is finished
  /// Copies x robots: 1 if the robot is in the world after the last step, else 0.
  std::span<const std::uint8_t> alive(std::size_t team) const;
  /// One element per copy: 1 if the episode has reached BatchSpec::seconds, else 0.
  std::span<const std::uint8_t> truncated() const;
  /// One element per copy: 1 if the copy is over, else 0. A copy is over if its episode is truncated. A copy
  /// is also over if both of these conditions hold: at least one robot of its teams is finished, and all
  /// robots of its teams that are in the world are finished. Robots that have left the world or are not yet
  /// born count only for the first condition. Each call takes into account what the program has written to
  /// terminated().
  std::span<const std::uint8_t> over();
  /// Names of the columns of measures(), with their units, such as "displacement_m"; empty if
  /// BatchSpec::measures is empty.
  std::vector<std::string> measure_columns() const;
  /// Values of the measures after the last step: copies x measure_columns().size() elements, row-major.
  std::span<const double> measures() const;
  std::span<const std::uint64_t> seeds() const;  ///< one per copy: seed of its current episode

  /// The poses at which the bodies of an entry of BatchSpec::starts begin the next episodes: copies x bodies
  /// x k_start_columns elements, row-major, the bodies in the order of their ids. A row has x, y (m) and the
  /// heading (rad) in the world frame; z is that of the world. A row of NaN (at first, all rows) means that
  /// the body begins where the world places it. The program writes the rows before reset() or step(); these
  /// do not change them. name: the entry. Throws std::out_of_range for any other name
  std::span<double> starts(std::string_view name);
  static constexpr std::size_t k_start_columns = 3;  ///< numbers in a row of starts()
  /// Per copy, the seed of the episode that the copy begins next, unless reset() gives it another seed. A
  /// program that draws starts() from these seeds places the bodies alike in all episodes with equal seeds.
  std::vector<std::uint64_t> next_seeds() const;

  /// Begins an episode in all or some copies. The arguments have one element per copy:
  /// which  0: the copy does not change; another value: the copy begins an episode. An empty span means all
  ///        copies
  /// seeds  a value: the seed of the episode, which then counts as the first episode of the copy. No value:
  ///        the copy begins its next episode, with a seed derived from the seed of its first episode. An
  ///        empty span means no value for all copies
  ///
  /// Throws
  /// - std::invalid_argument if a span has another size, and if a row of starts() of such a copy has some
  ///   numbers that are finite and others that are not; then no copy has changed. Also for a row outside the
  ///   bounds of the world, and for a row of a body that is not in the world when an episode begins
  /// - std::logic_error if `which` is 0 for a copy that has not yet begun its first episode
  /// - InputError if the rules by which the world file places robots find no place for a robot
  /// - StepError if the first tick of an episode throws
  void reset(std::span<const std::uint8_t> which = {},
             std::span<const std::optional<std::uint64_t>> seeds = {});
  /// Advances all copies by one step. begins: one element per copy. If it is not 0, the copy begins its next
  /// episode instead of making a step, and its rewards are 0. An empty span means that all copies make a
  /// step.
  ///
  /// Throws these exceptions before any copy has changed:
  /// - std::logic_error if reset() has not yet been called, or if the last step or reset of a copy failed and
  ///   this copy does not begin an episode
  /// - std::invalid_argument if `begins` has another size, if an action is not finite (the actions of copies
  ///   that begin an episode are not tested), or if a row of starts() is wrong, as for reset()
  ///
  /// Throws StepError if the step of a copy fails or gives a reward that is not finite, and the
  /// exceptions of reset() if a copy cannot begin its episode. The other copies have then made their step.
  /// The failed copy must be reset (by reset() or by `begins`) before its next step.
  void step(std::span<const std::uint8_t> begins = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe
