#pragma once

#include "engine/observing/state_difference.hpp"
#include "engine/world/world.hpp"

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace troupe::engine {

/// A result of ControllerCheck: a value in a memory or command that a controller set differently in two calls
/// with identical inputs. Values are compared bit by bit. A memory or a command is a struct with one row of
/// bytes per robot; a field is one of its members, with one column per value.
struct ControllerFinding {
  /// The repetition that found the difference. If both repetitions of a controller's decisions differ in a
  /// field, the finding is about `again`.
  enum class Repeat : std::uint8_t {
    start,   ///< a second call of ControllerKind::start, on memory with other initial bytes
    again,   ///< a second decision of the same controller
    afresh,  ///< a decision of a newly made controller with the same parameters
  };
  /// Name of the controller: the name of its kind (ControllerKind::name) and its index among the controllers
  /// of the body type, such as "wander/0". Controllers of several body types can have the same name, and then
  /// share their findings.
  std::string controller;
  /// What differs: "memory turn_left_s" for a field of the memory, "command x" for a field of the command to
  /// the drive. For a field of the command to a device, the component (state table) of these commands
  /// replaces the word "memory". A field with several columns is followed by the index of the column, as in
  /// "memory goal[1]".
  std::string field;
  Repeat repeat = Repeat::again;  ///< the repetition that found it
  /// The body with the lowest id of those whose value differs. For Repeat::start, the body with the lowest id
  /// of the type, because the call of `start` concerns no particular body.
  BodyId body;
  StateValue first;   ///< value after the decision in the step; for Repeat::start, after the first call
  StateValue second;  ///< value after the repetition
  /// Number of decisions in which this field differs in the repetition `repeat`, counted in one call of
  /// ControllerCheck::repeat(). Not used for Repeat::start.
  std::size_t decisions = 1;
};
/// The message of a finding about a controller of this world: `controller "wander/0": memory avoid_updates of
/// "r3" (id 4) is 0x0000000b (11) when the decision is repeated, not 0x0000000a (10); 12 decisions differ`.
std::string finding_text(const World& world, const ControllerFinding& finding);

/// Finds controllers whose decisions depend on anything other than their inputs. A kind of controller
/// (ControllerKind) is a table of functions: `start` sets the memory of a robot at the beginning, and
/// `decide` makes its decision in a tick (time step). Each decision is made three times from the same
/// percepts (sensor readings), memory and command: once by the step of the world, and twice by repeat().
///
///     ControllerCheck check(world, registry);
///     world.step();                                           // the decisions of this step take effect
///     std::thread other([&] { findings = check.repeat(); });  // repeats them twice, without effect
///     other.join();                                           // before the next step
///
/// order    The repetitions run on the thread that calls repeat(). They process the robots in reverse order.
///          They also divide the robots into other batches, unless one batch holds all robots. (A batch is
///          the robots that one call of the controller handles.) A collective controller
///          (ControllerKind::is_collective) may depend on its whole batch, and so gets the batch of the step
///          again, in the same order.
/// storage  Readings, estimated poses, memories and commands are copied at the decision, because the robot
///          may be dead when its decision is repeated. Memories and the commands to devices are copied field
///          by field to other addresses, into storage filled with junk. The second repetition uses a newly
///          made controller. It is made on a stack filled with junk, from the parameters that were in force
///          at the decision.
/// catches  Dependence on rand(), statics, thread locals, clocks that advance between two decisions, members
///          that change or were left unset, addresses, padding, and (unless the controller is collective) the
///          other robots of the batch. Thread locals are found only if repeat() runs on a thread that has not
///          run the controller, as `other` in the example.
/// misses   Dependence on things that are constant within one process: environment variables, files, the
///          processor.
/// cost     While a check exists, each decision costs copies of the robot's readings, memory and commands,
///          and two more decisions. Without a check there is no cost.
/// limits   An intervention `set` changes parameters, for example of a controller, at a given time. The check
///          knows the interventions `set` that the world has when the check is constructed. World::set(),
///          which adds such an intervention, must not be called while the check exists.
///
/// Not thread-safe: call its functions between steps only. At most one check per world at a time.
class ControllerCheck {
 public:
  using Finding = ControllerFinding;  ///< a short name for ControllerFinding

  /// Sets the callback of World::on_decide(), which the world calls for each decision. The destructor removes
  /// the callback again. `registry`, the list of all kinds, must be the registry of the world, or have the
  /// same kinds. World and registry must outlive the check. Throws InputError if a type of the world does not
  /// compile with this registry.
  ControllerCheck(World& world, const Registry& registry);
  ~ControllerCheck();
  ControllerCheck(const ControllerCheck&) = delete;
  ControllerCheck& operator=(const ControllerCheck&) = delete;

  /// Calls ControllerKind::start twice for each controller that has a memory, on storage with different
  /// bytes. Returns one finding for each column of the memory that `start` leaves unset, or sets to different
  /// values in the two calls; an empty list if there is none. Omits types without bodies. Does not change the
  /// memories of the robots. Throws a StepError (the exception of a failed step) if `start` throws an
  /// exception.
  std::vector<Finding> start_twice() const;
  /// Repeats each decision of the last step twice. Call this after each step: without a call, the decisions
  /// of several steps accumulate, and the findings of the next call are then wrong. Returns one finding for
  /// each controller and column that differs; an empty list if there is none. Throws a StepError if a
  /// controller throws an exception.
  std::vector<Finding> repeat();
  /// Number of decisions that repeat() has not yet repeated.
  std::size_t pending() const;
  /// Number of decisions that repeat() has repeated since construction.
  std::uint64_t decisions() const { return decisions_; }

 private:
  /// The decisions that one controller of one type made in one tick. Each vector has one entry, or one row of
  /// bytes, per robot, with the robots in the same order.
  struct Decisions {
    DecideBatch given;  // the inputs, except those that the following members copy
    std::vector<Row> rows;
    std::vector<Command> commands_before, commands_after;
    std::vector<Pose> estimates;  // as they were at the decision; those of the world have changed since
    std::vector<std::vector<std::byte>> written_before, written_after;  // one per entry of `written`
    std::vector<std::vector<std::byte>> percepts;                       // one per chosen device
  };
  /// A table to which a controller writes: its memories, or the commands to a device. Drive commands are
  /// stored in Decisions instead. The chosen devices of a controller are those that it reads or commands.
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

  /// Updates the body types of the check (fresh_types_, type_specs_), which hold newly made controllers, to
  /// the parameters that are in force when the robots decide in the tick with this number.
  void follow_settings(std::uint64_t tick);
  Watched watch(const BodyType& type, const BodyType::Controller& controller) const;
  void record(const BodyType& type, const BodyType::Controller& controller, const DecideBatch& batch);
  void repeat(const BodyType::Controller& controller, Watched& watched);
  void compare(const Watched& watched, const Finding& about, std::vector<Finding>& findings) const;

  World& world_;
  std::vector<BodyType> fresh_types_;
  /// A change of parameters by an intervention of the world.
  struct Setting {
    std::uint64_t tick = 0;  ///< last tick with the old parameters
    SettingSpec setting;     ///< the change
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
