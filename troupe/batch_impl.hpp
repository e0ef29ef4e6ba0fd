#pragma once

#include "engine/spec/body_type.hpp"
#include "partition/parallel.hpp"
#include "troupe/batch_env.hpp"
#include "troupe/measures.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe {

/// The data of a BatchEnv, which steps many copies of one world. A *team* is a group of robots that learn one
/// policy. An *array* contains observations of a team: the same columns of numbers for each robot. A *part*
/// of an array is a group of consecutive columns that have one source, such as a sensor.
///
/// The user describes teams, arrays and parts by names (BatchSpec). The constructor looks up all names, so
/// that a step uses only ids and indices.
struct BatchEnv::Impl {
  using Of = BatchPart::Of;
  /// Number of components of the command of a drive: forward, left, turn.
  static constexpr std::size_t k_drive = 3;

  /// A part of an array: its description by the user (`spec`), and what the constructor has looked up for it.
  struct Part {
    const BatchPart* spec = nullptr;
    std::size_t columns = 0;
    engine::Element element = engine::Element::f32;  // of the field of a part `reading`
    // Index of this part among the parts of the team with the same source `reading`, `nearest` or `target`,
    // and so in TeamCopy::readings, groups or targets. 0 for other sources.
    std::size_t of_kind = 0;
  };
  /// An array of a team, with the numbers of its robots in all copies of the world.
  struct ArrayData {
    std::string name;
    engine::Element element = engine::Element::f32;
    std::size_t columns = 0;
    std::vector<Part> parts;
    std::vector<std::byte> bytes;  // copies x robots x columns

    std::size_t row_bytes() const { return columns * engine::element_size(element); }
  };
  /// A number on which a reward or the end of an episode depends (BatchColumn): a column of an array or a
  /// measure. If `of_measure` is true, `column` is an index into `measure_columns`. Otherwise `array` is the
  /// index of the array in TeamData::arrays, and `column` is the index of the column in this array.
  struct Column {
    std::size_t array = 0;
    std::size_t column = 0;
    bool of_measure = false;
  };
  /// An action (BatchAction): a number that the policy sets for each robot, and that controls one component
  /// of a command. Names are replaced by indices.
  struct Action {
    std::size_t command = 0;  // 0 to 2: drive; from k_drive on: devices, see TeamCopy::commands
    engine::Element element = engine::Element::f64;
    bool is_bool = false;
    double low = 0;
    double span = 0;  // BatchAction::high - low
  };
  /// The data of a team for all copies of the world together.
  struct TeamData {
    const BatchTeam* spec = nullptr;
    std::size_t robots = 0;
    std::vector<std::string> names;
    std::vector<ArrayData> arrays;
    std::vector<Action> actions_plan;
    bool drives = false;  // whether an action commands the drive
    std::vector<Column> rewards_of;
    std::vector<Column> ends_of;
    std::vector<double> actions;  // copies x robots x actions
    // Each of the following has copies x robots elements.
    std::vector<double> rewards;
    std::vector<std::uint8_t> terminated;
    std::vector<std::uint8_t> alive;
  };
  /// An entry of BatchSpec::starts, with the poses that the program writes.
  struct StartData {
    std::string name;
    std::vector<BodyId> bodies;  // the same in all copies
    std::vector<double> poses;   // copies x bodies x k_start_columns

    std::span<const double, k_start_columns> row(std::size_t copy, std::size_t body) const {
      const std::size_t at = (copy * bodies.size() + body) * k_start_columns;
      return std::span<const double, k_start_columns>(poses.data() + at, k_start_columns);
    }
  };
  /// A field of a device. In TeamCopy::readings, `field` is the index of the field among the fields of the
  /// device's readings. In TeamCopy::commands, `field` is the offset of the field in the device's command,
  /// bytes.
  struct DeviceField {
    const engine::BodyType::Device* device;
    std::size_t field;
  };
  /// The data of a team for one copy of the world.
  struct TeamCopy {
    std::vector<BodyId> ids;
    std::vector<DeviceField> readings;         // readings x robots
    std::vector<std::vector<BodyId>> groups;   // the possible neighbours, for each part `nearest`
    std::vector<std::vector<BodyId>> targets;  // for each part `target`: one for all robots, or one per robot
    std::vector<DeviceField> commands;         // commands of devices x robots
    std::vector<double> before;                // rewards x robots: the rewarded numbers of the previous step
    std::vector<std::uint8_t> was_terminated;  // per robot: `terminated` before the step
    std::vector<std::uint8_t> was_alive;       // per robot: `alive` after the previous step
  };
  /// One copy of the world.
  struct Copy {
    explicit Copy(Simulation&& s) : simulation(std::move(s)) {}
    Simulation simulation;
    std::optional<Measures> measures;
    std::vector<std::uint8_t> learns;  // per body: 1 if it is in a team
    std::vector<TeamCopy> teams;
    std::uint64_t first_seed = 0;  // seed of episode 0, from which the seeds of later episodes are derived
    std::uint64_t episode = 0;     // number of the episode
    bool has_begun = false;        // whether episode 0 has begun
    bool has_starts = false;       // whether the program has placed bodies for the current episode
    bool has_failed = false;       // whether its last step or reset threw: rewards do not know its last ticks
    std::uint64_t last_tick = 0;   // tick at which the episode is truncated
  };

  BatchSpec spec;
  partition::Parallel parallel;
  std::uint64_t episode_ticks = 1;
  std::vector<TeamData> teams;
  std::vector<StartData> starts;
  std::vector<std::unique_ptr<Copy>> copies;
  std::vector<std::string> measure_columns;
  std::vector<double> measures;  // copies x columns
  std::vector<std::uint8_t> truncated;
  std::vector<std::uint8_t> over;
  std::vector<std::uint64_t> seeds;
  bool was_reset = false;
  bool is_running = false;  // for_copies() is running

  Impl(const Simulation& world, const BatchSpec& wanted);
  /// Throws std::invalid_argument with the text `text`.
  [[noreturn]] static void refuse(const std::string& text);

  // troupe/batch_plan.cpp: what the names in the spec refer to
  void check_spec() const;
  static void check_team(const BatchTeam& team);
  static void check_array(const BatchTeam& team, const BatchArraySpec& array);
  void plan_starts(const engine::World& world);
  void plan(TeamData& team, Copy& first);
  Part plan(const BatchPart& part, Simulation& simulation, BodyId robot) const;
  void plan_actions(TeamData& team, Simulation& simulation, BodyId robot) const;
  static void plan_drive_action(const BatchAction& action, bool has_drive, TeamData& team);
  static void plan_device_action(const BatchAction& action, std::span<const engine::StateField> fields,
                                 TeamData& team);
  Column find(const TeamData& team, const BatchColumn& column, std::string_view what) const;
  static std::size_t array_index(const TeamData& team, std::string_view name);
  static void bind(const TeamData& team, Copy& copy, TeamCopy& bound);
  static void bind_readings(const TeamData& team, const Part& part, const std::vector<Model>& robots,
                            const engine::World& world, TeamCopy& bound);
  static std::vector<BodyId> targets_of(const TeamData& team, const BatchPart& part,
                                        const std::vector<Model>& robots, const engine::World& world);
  static void bind_commands(const TeamData& team, std::vector<Model>& robots, const engine::World& world,
                            TeamCopy& bound);

  // troupe/batch_env.cpp: the copies and their steps
  void add_copy(const Simulation& world, std::size_t c);
  void refuse_in_callbacks(std::string_view call) const;
  template <class Work>
  void for_copies(Work&& work);
  void begin(std::size_t c);
  std::uint64_t next_seed(std::size_t c) const;
  void check_starts(std::size_t c) const;
  std::vector<std::pair<Model, Pose>> starts_of(std::size_t c);
  void check_actions(std::span<const std::uint8_t> begins) const;
  void act(std::size_t c);
  static void command(engine::World& world, const TeamData& team, const TeamCopy& bound, std::size_t i,
                      std::span<const double> given);
  void read_outputs(std::size_t c);

  // troupe/batch_observations.cpp: the arrays
  class RowReader;
  void observe(std::size_t c);
  double value(const TeamData& team, const Column& column, std::size_t c, std::size_t i) const;

  // troupe/batch_rewards.cpp: rewards and ends of episodes
  void judge(std::size_t c, bool has_stepped);
  double take_reward(const TeamData& team, TeamCopy& bound, std::size_t c, std::size_t i, bool counts) const;
  [[noreturn]] void refuse_reward(const TeamData& team, std::size_t r, std::size_t c, std::size_t i,
                                  double value) const;
  std::optional<double> end_reward(const TeamData& team, double reward, std::size_t c, std::size_t i) const;
};

}  // namespace troupe
