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

/// A difference that ControllerCheck has found: from identical inputs, two calls of a controller computed
/// different values in a memory or a command, or the decision of a robot changed a memory or a command of
/// another robot. Values are compared bit by bit. The memory of a robot and a command to a robot are structs.
/// A member of such a struct is called a *field*. A field has one or more values, which are called its
/// *columns*.
struct ControllerFinding {
  /// The call whose result differed from that of the first call. If several of `other`, `again` and `afresh`
  /// find a difference in a field, there is only one finding, about the first of them in this order.
  enum class Repeat : std::uint8_t {
    start,   ///< a second call of ControllerKind::start, on memory with other initial bytes
    again,   ///< a second decision of the same controller
    afresh,  ///< a decision of a newly made controller with the same parameters
    other,   ///< a second decision of another robot, which must not change the value
  };
  /// Name of the controller: the name of its kind (ControllerKind::name) and its index among the controllers
  /// of the body type, such as "wander/0". Controllers of different body types can have the same name. Their
  /// findings are then combined.
  std::string controller;
  /// The value that differs, as the name of a table and the name of a field. "memory turn_left_s" is the
  /// field `turn_left_s` of the memory, and "command x" is the field `x` of the command to the drive. For a
  /// command to a device, the text begins with the name of the state table that has the commands to this
  /// device. If the field has several columns, the index of the column follows: "memory goal[1]".
  std::string field;
  Repeat repeat = Repeat::again;  ///< the call that found the difference
  /// The body with the lowest id among the bodies whose value differs. For Repeat::start, the body with the
  /// lowest id among the bodies with this controller, because `start` is not called for a particular body.
  BodyId body;
  /// Result of the decision in the step. For Repeat::start, result of the first call; for Repeat::other, the
  /// value before the decision of the other robot.
  StateValue first;
  StateValue second;  ///< result of the call that `repeat` names
  /// Number of decisions for which this value differs, in one call of ControllerCheck::repeat(). For
  /// Repeat::other, number of times that a value was changed. Not used for Repeat::start.
  std::size_t decisions = 1;
};
/// Returns the message for a finding about a controller of `world`. Example: `controller "wander/0": memory
/// avoid_updates of "r3" (id 4) is 0x0000000b (11) when the decision is repeated, not 0x0000000a (10); 12
/// decisions differ`.
std::string finding_text(const World& world, const ControllerFinding& finding);

/// Finds controllers whose decisions depend on anything other than their inputs. A kind of controller
/// (ControllerKind) is a table of functions: `start` initialises the memory of a robot, and `decide` makes
/// the decisions of robots in a tick (time step). The inputs of a decision are percepts (such as sensor
/// readings), the memory and the commands of the robot. The results are a new memory and new commands. The
/// check compares the results of three calls of `decide` with the same inputs: one in the step of the world,
/// and two in repeat().
///
///     ControllerCheck check(world, registry);
///     world.step();                                           // the decisions of this step take effect
///     std::thread other([&] { findings = check.repeat(); });  // repeats them twice, without effect
///     other.join();                                           // before the next step
///
/// order    The repetitions run on the thread that calls repeat(), with the robots in reverse order. A batch
///          is the robots that one call of `decide` handles. The batches of the first repetition have one
///          robot each. The second repetition forms other batches than the step, unless one batch holds all
///          robots. A collective controller (ControllerKind::is_collective) decides for all its robots in one
///          call. Its batch is repeated with the robots in the order of the step.
/// storage  The inputs are copied during the step, because the robot may be dead when its decision is
///          repeated. The repetitions use copies at other addresses than the step. The storage for the copies
///          of memories and of commands to devices is filled with junk, and then only the fields are copied,
///          so the padding is junk. The second repetition uses a newly made controller, with the parameters
///          that were in force in the step. It is made on a stack filled with junk, so that members that it
///          leaves unset get other values.
/// catches  Dependence on rand(), statics, thread locals, clocks that advance between two decisions, members
///          that change or were left unset, addresses, padding, and (unless the controller is collective) the
///          other robots of the batch. Thread locals are found only if repeat() runs on a thread that has not
///          run the controller, as `other` in the example. Also changes of memories and commands of robots
///          that are not in the batch: in a step, they would take place before or after the decisions of
///          these robots, depending on the threads.
/// misses   Dependence on things that are constant within one process: environment variables, files, the
///          processor.
/// cost     While a check exists, each decision costs copies of the robot's readings, memory and commands,
///          and two more decisions. Without a check there is no cost.
/// limits   World::set(), which adds an intervention `set` (a change of parameters), must not be called while
///          the check exists. The check only knows the interventions that the world has when the check is
///          constructed.
///
/// Not thread-safe: call its functions between steps only. At most one check per world at a time.
class ControllerCheck {
 public:
  using Finding = ControllerFinding;  ///< a short name for ControllerFinding

  /// Begins to store the decisions of `world`, with the callback of World::on_decide(). The destructor
  /// removes this callback. `registry` is the list of all kinds; it must be the registry of the world, or
  /// have the same kinds. World and registry must outlive the check. Throws InputError if a body type of the
  /// world has an error with this registry, such as an unknown kind.
  ControllerCheck(World& world, const Registry& registry);
  ~ControllerCheck();
  ControllerCheck(const ControllerCheck&) = delete;
  ControllerCheck& operator=(const ControllerCheck&) = delete;

  /// Calls ControllerKind::start twice for each controller that has a memory. Before the two calls, the
  /// storage for the memory is filled with different bytes. Returns one finding for each column of the memory
  /// that `start` leaves unset, or sets to different values in the two calls; an empty list if there is none.
  /// Omits types without bodies. Does not change the memories of the robots. Throws a StepError (the
  /// exception of a failed step) if `start` throws an exception.
  std::vector<Finding> start_twice() const;
  /// Repeats each decision of the last step twice. Returns one finding for each controller and each column
  /// whose value differs; an empty list if there is none. Call this after each step. Without a call, the
  /// decisions of several steps accumulate, and the next findings are wrong. Throws a StepError if a
  /// controller throws an exception.
  std::vector<Finding> repeat();
  /// Number of decisions that the next call of repeat() will repeat.
  std::size_t pending() const;
  /// Number of decisions that repeat() has repeated since construction. A decision that was repeated twice
  /// counts once.
  std::uint64_t decisions() const { return decisions_; }

 private:
  /// The decisions that one controller of one type made in one tick, with their inputs and results. All lists
  /// have one entry, or one row of bytes, per robot. The robots have the same order in all lists.
  struct Decisions {
    DecideBatch given;  // the inputs, except those that the following members copy
    std::vector<Row> rows;
    std::vector<Command> commands_before, commands_after;
    std::vector<Pose> estimates;  // as they were at the decision; those of the world have changed since
    std::vector<std::vector<std::byte>> written_before, written_after;  // one per entry of `written`
    std::vector<std::vector<std::byte>> percepts;                       // one per device of the controller
  };
  /// A table to which a controller writes: its memories, or the commands to one of its devices. Commands to
  /// the drive are stored in Decisions.
  struct Written {
    std::string what;  ///< "memory", or the name of the component that holds a device's commands
    std::vector<StateField> fields;
    std::size_t row_bytes = 0;
    std::optional<std::size_t> device;  ///< index in BodyType::Controller::devices; not set: the memory
    std::size_t table = 0;              ///< index in World::tables()
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

  /// Brings fresh_types_ and type_specs_ up to date with the parameters that are in force in tick number
  /// `tick`. fresh_types_ has the newly made controllers.
  void follow_settings(std::uint64_t tick);
  Watched watch(const BodyType& type, const BodyType::Controller& controller) const;
  void record(const BodyType& type, const BodyType::Controller& controller, const DecideBatch& batch);
  DecideBatch restore_inputs(const Watched& watched);
  void repeat(const BodyType& type, const BodyType::Controller& controller, const Watched& watched,
              const Finding& about, std::vector<Finding>& findings);
  template <class Visit>
  void for_outputs(const BodyType& type, const Watched& watched, Row row, Visit&& visit);
  void compare(const Watched& watched, const Finding& about, std::vector<Finding>& findings) const;

  World& world_;
  std::vector<BodyType> fresh_types_;
  /// A change of parameters that an intervention of the world makes.
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
  // What the outputs must be, unless a decision changes an output of another robot.
  std::vector<Command> kept_commands_;
  std::vector<std::vector<std::byte>> kept_written_;
  // Copies that the repetitions read in place of tables that have changed since.
  std::vector<StateTable> percepts_;
};

}  // namespace troupe::engine
