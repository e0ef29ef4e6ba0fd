#pragma once

#include "engine/state_difference.hpp"
#include "engine/world.hpp"

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace troupe::engine {

/// A result of ControllerCheck: a field of a memory or command that a controller set to different values
/// although its inputs were identical.
struct ControllerFinding {
  /// The repetition that found the difference.
  enum class Repeat : std::uint8_t {
    start,   ///< a second call of ControllerKind::start, on memory with other initial bytes
    again,   ///< a second decision of the same controller
    afresh,  ///< a decision of a newly made controller with the same parameters
  };
  /// The controller, by the name of the component (state table) that holds its memory: its kind, and its
  /// index among the controllers of its type, such as "wander/0".
  std::string controller;
  std::string field;              ///< name of the field, such as "memory turn_left_s" or "command x"
  Repeat repeat = Repeat::again;  ///< the repetition that found it
  BodyId body;                    ///< the lowest id of a body whose field differs
  StateValue first;               ///< value of that body after the first decision or start
  StateValue second;              ///< value of that body after the repetition
  std::size_t decisions = 1;      ///< number of decisions that differ in this field
};
/// The message of a finding: `controller "wander/0": memory avoid_updates of "r3" (id 4) is 0x0000000b (11)
/// when the decision is repeated, not 0x0000000a (10); 12 decisions differ`.
std::string finding_text(const World& world, const ControllerFinding& finding);

/// Finds controllers whose decisions depend on anything other than their inputs. Each decision is made three
/// times from the same percepts, memory and command: once by the step of the world, and twice by repeat().
///
///     ControllerCheck check(world, registry);
///     world.step();                                           // the decisions of this step take effect
///     std::thread other([&] { findings = check.repeat(); });  // repeats them twice, without effect
///     other.join();                                           // before the next step
///
/// order    The repetitions process the robots in reverse order, in batches of another size, on the thread
///          that calls repeat().
/// storage  Readings, memories and commands are copied at the decision, because the robot may be dead when
///          its decision is repeated. Memories and commands are copied field by field to other addresses,
///          into storage filled with junk. The second repetition uses a newly made controller, on a stack
///          filled with junk, with the parameters of that tick (SettingSpec).
/// catches  Dependence on rand(), statics, thread locals, clocks that advance between two decisions, members
///          that change or were left unset, addresses, padding, and the other robots of the batch.
/// misses   Dependence on things that are constant within one process: environment variables, files, the
///          processor.
/// cost     While a check exists, each decision costs a copy of the robot's readings and memory, and two more
///          decisions. Without a check there is no cost.
///
/// Not thread-safe: call repeat() between steps only. At most one check per world at a time.
class ControllerCheck {
 public:
  using Finding = ControllerFinding;  ///< a short name for the result of a check

  /// Sets the OnDecide callback of the world. `registry` must be the registry of the world, or have the same
  /// kinds. World and registry must outlive the check.
  ControllerCheck(World& world, const Registry& registry);
  ~ControllerCheck();
  ControllerCheck(const ControllerCheck&) = delete;
  ControllerCheck& operator=(const ControllerCheck&) = delete;

  /// Calls ControllerKind::start twice for each controller of each type. Returns one finding for each field
  /// of the memory that the function leaves unset, or sets to different values in the two calls.
  std::vector<Finding> start_twice() const;
  /// Repeats each decision of the last step twice. Call this before the next step. Returns one finding for
  /// each field of each controller that differs. If a controller throws an exception, throws a StepError.
  std::vector<Finding> repeat();
  /// Number of decisions of the last step that repeat() has not yet repeated.
  std::size_t pending() const;
  /// Number of decisions repeated so far.
  std::uint64_t decisions() const { return decisions_; }

 private:
  /// The decisions that one controller of one type made in one tick. Each vector has the robots in the same
  /// order.
  struct Decisions {
    DecideBatch given;  // the inputs, except those that the following members copy
    std::vector<Row> rows;
    std::vector<Command> commands_before, commands_after;
    std::vector<Pose> estimates;  // as they were at the decision; those of the world have changed since
    std::vector<std::vector<std::byte>> written_before, written_after;  // one per entry of `written`
    std::vector<std::vector<std::byte>> percepts;                       // one per chosen device
  };
  /// A table to which a controller writes, in addition to the drive commands of its robots: its memories, or
  /// the commands to a device.
  struct Written {
    std::string what;  ///< "memory", or the name of the component that holds a device's commands
    std::vector<StateField> fields;
    std::size_t row_bytes = 0;
    std::optional<std::size_t> device;  ///< index among the chosen devices; none: the memory
    DecideBatch::Rows& rows(DecideBatch& batch) const {
      return device ? batch.device_commands[*device] : batch.memories;
    }
  };
  /// What is stored about one controller of one type: the tables that the controller writes to, and its
  /// decisions.
  struct Watched {
    std::vector<Written> written;
    Decisions taken;
  };

  /// Updates fresh_types_ and type_specs_ to the parameters that are in force when the robots decide in a
  /// tick.
  void follow_settings(std::uint64_t tick);
  Watched watch(const BodyType& type, const BodyType::Controller& controller) const;
  void record(const BodyType& type, const BodyType::Controller& controller, const DecideBatch& batch);
  void repeat(const BodyType::Controller& controller, Watched& watched);
  void compare(const Watched& watched, const Finding& about, std::vector<Finding>& findings) const;

  World& world_;
  std::vector<BodyType> fresh_types_;
  /// A change of parameters by an intervention of the world.
  struct Setting {
    std::uint64_t tick = 0;                ///< last tick with the old parameters
    const SettingSpec* setting = nullptr;  ///< the change, in the world's spec
  };
  std::vector<Setting> settings_;  // sorted by tick
  std::size_t followed_ = 0;       // number of settings that fresh_types_ and type_specs_ include
  std::vector<TypeSpec> type_specs_;
  std::vector<StateField> command_fields_;
  std::vector<std::vector<Watched>> watched_;  // indexed by type, then by controller
  std::mutex mutex_;                           // protects watched_ while the world steps
  std::uint64_t decisions_ = 0;
  // Outputs of the repetitions, indexed by row or slot like the world's own tables.
  std::vector<Command> commands_;
  std::vector<Pose> estimates_;
  std::vector<std::vector<std::byte>> written_;
  // Copies that the repetitions read in place of tables that have changed since.
  std::vector<StateTable> percepts_;
};

}  // namespace troupe::engine
