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

/// Where a controller decided otherwise though nothing that it is given had changed.
struct ControllerFinding {
  /// What was done a second time.
  enum class Repeat : std::uint8_t {
    start,   ///< the memory was started on storage that held other bytes
    again,   ///< the same controller decided again
    afresh,  ///< a controller that was made afresh, of the same parameters, decided
  };
  /// Kind and number within its body, as the memory's component is called: "wander/0".
  std::string controller;
  std::string field;              ///< "memory turn_left_s" or "command x"
  Repeat repeat = Repeat::again;  ///< what found it
  BodyId body;                    ///< the lowest one met
  StateValue first;               ///< of that body: what was decided first
  StateValue second;              ///< of that body: what was decided again
  std::size_t decisions = 1;      ///< that differ in this field
};
/// `controller "wander/0": memory avoid_updates of "r3" (id 4) is 0x0000000b (11) when decided again, not
/// 0x0000000a (10); 12 decisions differ`.
std::string finding_text(const World& world, const ControllerFinding& finding);

/// Finds controllers that are no function of what they are given: it has every decision of a world taken
/// three times from the same percepts, memory and command.
///
///     ControllerCheck check(world, registry);
///     world.step();                                                  // the first time; counts as ever
///     std::thread other([&] { findings = check.repeat(); });         // and twice more
///
/// order    the repetitions take the rows backwards, in batches of another size, on the thread that calls
/// storage  readings, memories and commands are copied, the latter two field by field into storage filled
///          with junk, at other addresses: a robot may be dead when its decision is repeated. The second
///          repetition is that of a controller made afresh, on a stack filled with junk, of the parameters
///          that were in force in that tick (SettingSpec)
/// catches  rand(), statics, thread locals, clocks that tick between the two, members that change or were
///          left unset, addresses, padding, what else is in the batch
/// misses   what stays the same within one process: environment, files, which processor
/// cost     while one lives, a copy of each memory and reading and two more decisions; none without
///
/// Not thread-safe beside the world's own workers: repeat() between steps only. One a world at a time.
class ControllerCheck {
 public:
  using Finding = ControllerFinding;  ///< as controllers' tests call it

  /// The registry is the world's own, or one of the same kinds. Both must outlive it.
  ControllerCheck(World& world, const Registry& registry);
  ~ControllerCheck();
  ControllerCheck(const ControllerCheck&) = delete;
  ControllerCheck& operator=(const ControllerCheck&) = delete;

  /// Fields of memories that their controllers' `start` leaves as it found them, or sets to other values.
  std::vector<Finding> start_twice() const;
  /// Takes the decisions of the last step twice more, and tells what came out otherwise: each field of each
  /// controller once. An exception of a controller comes out.
  std::vector<Finding> repeat();
  /// Decisions of the last step that wait to be repeated.
  std::size_t pending() const;
  /// Decisions repeated so far.
  std::uint64_t decisions() const { return decisions_; }

 private:
  /// Those of one controller of one type in one tick, a robot after the other.
  struct Decisions {
    DecideBatch given;  // but for what is here
    std::vector<Row> rows;
    std::vector<Command> commands_before, commands_after;
    std::vector<Pose> estimates;  // of the time, which the world no longer knows
    std::vector<std::vector<std::byte>> written_before, written_after;  // of each of `written`
    std::vector<std::vector<std::byte>> percepts;                       // of each device it chose
  };
  /// What a controller writes beside its robot's command: its memory, and what it asks of devices.
  struct Written {
    std::string what;  ///< "memory", or the component of a device's commands
    std::vector<StateField> fields;
    std::size_t row_bytes = 0;
    std::optional<std::size_t> device;  ///< which of those it chose; none: the memory
    DecideBatch::Rows& rows(DecideBatch& batch) const {
      return device ? batch.device_commands[*device] : batch.memories;
    }
  };
  /// Of one controller of one type.
  struct Watched {
    std::vector<Written> written;
    Decisions taken;
  };

  /// Has fresh_types_ be of the parameters that are in force when the robots decide in a tick.
  void follow_settings(std::uint64_t tick);
  Watched watch(const BodyType& type, const BodyType::Controller& controller) const;
  void record(const BodyType& type, const BodyType::Controller& controller, const DecideBatch& batch);
  void repeat(const BodyType::Controller& controller, Watched& watched);
  void compare(const Watched& watched, const Finding& about, std::vector<Finding>& findings) const;

  World& world_;
  std::vector<BodyType> fresh_types_;
  /// A change of parameters in the experiment.
  struct Setting {
    std::uint64_t tick = 0;                ///< after which it is in force
    const SettingSpec* setting = nullptr;  ///< in the world's spec
  };
  std::vector<Setting> settings_;     // by tick
  std::size_t followed_ = 0;          // of them: those that fresh_types_ have followed
  std::vector<TypeSpec> type_specs_;  // as these have left them
  std::vector<StateField> command_fields_;
  std::vector<std::vector<Watched>> watched_;  // of each type, of each of its controllers
  std::mutex mutex_;                           // of watched_, while the world steps
  std::uint64_t decisions_ = 0;
  // What the repetitions write: as large as the world's own tables.
  std::vector<Command> commands_;
  std::vector<Pose> estimates_;
  std::vector<std::vector<std::byte>> written_;
  // What they read in place of what has changed since.
  std::vector<StateTable> percepts_;
};

}  // namespace troupe::engine
