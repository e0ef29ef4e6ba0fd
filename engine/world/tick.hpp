#pragma once

#include "engine/conflicts/movement.hpp"
#include "engine/interventions/interventions.hpp"
#include "engine/kinds/controller_kind.hpp"
#include "engine/kinds/effects.hpp"
#include "engine/links/links.hpp"
#include "engine/rows/lives.hpp"
#include "engine/rows/places.hpp"
#include "engine/rows/ranks.hpp"
#include "engine/state/phase.hpp"
#include "engine/state/world_state.hpp"
#include "engine/world/activities.hpp"
#include "engine/world/actuation.hpp"
#include "partition/parallel.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace troupe::engine {

class Blinkers;  // engine/state/blinkers.hpp

/// The parts of a world that a tick reads and changes.
struct TickParts {
  WorldState& state;              ///< the state
  partition::Parallel& parallel;  ///< the worker threads
  Links& links;                   ///< joints and carried bodies
  Movement& movement;             ///< the motions of bodies
  Places& places;                 ///< where bodies are
  Lives& lives;                   ///< births and deaths
  Interventions& interventions;   ///< changes at given times
  const RankPort& ranks;          ///< the other ranks
  Activities& activities;         ///< what the world is doing
};

/// Computes the ticks of a world: runs the phases, in which it calls the hooks of kinds in batches, checks
/// what they return, and applies their effects.
class Tick {
 public:
  /// The callbacks of World::on_phase(), World::before_tick() and World::on_decide().
  ///@{
  using OnPhase = std::function<void(std::optional<Phase>)>;
  using BeforeTick = std::function<void()>;
  using OnDecide =
      std::function<void(const BodyType& type, const BodyType::Controller& controller, const DecideBatch&)>;
  ///@}

  /// The parts must outlive the object.
  explicit Tick(const TickParts& parts);
  ~Tick();
  Tick(const Tick&) = delete;
  Tick& operator=(const Tick&) = delete;

  /// Called when the tables were made: reserves memory for effects, and finds out which hooks exist.
  void build();
  /// Computes the phases of one tick. Each phase reads the state that the previous phase has written. Each
  /// task writes only its own rows. Drives run before controllers, so a command takes effect one tick after
  /// the readings on which it is based. If several ranks compute the world, each of them senses, actuates and
  /// decides for its own rows.
  void run();
  void clear_effects() { effects_.clear(); }  ///< forgets the effects of a tick that failed

  /// Replace callbacks: see the functions of World with these names.
  ///@{
  void on_phase(OnPhase callback) { on_phase_ = std::move(callback); }
  void before_tick(BeforeTick callback) { before_tick_ = std::move(callback); }
  void on_decide(OnDecide callback) { on_decide_ = std::move(callback); }
  ///@}
  bool has_before_tick() const { return before_tick_ != nullptr; }  ///< whether before_tick() set a callback
  /// Implements World::hide_beyond_reach().
  void hide_beyond_reach(bool on);
  /// Called after rows were added, removed or moved.
  void follow_rows();

  Effects& effects() { return effects_; }         ///< the effects of the present tick
  std::uint64_t& beams() { return beams_; }       ///< rays cast by all sensors since tick 0
  std::uint64_t beams() const { return beams_; }  ///< see above
  /// Rounds in which conflicts between motions were resolved, in all ticks since tick 0.
  std::uint64_t conflict_rounds() const { return conflict_rounds_; }
  /// Sets beams() and conflict_rounds().
  void restore_counts(std::uint64_t beams, std::uint64_t conflict_rounds) {
    beams_ = beams;
    conflict_rounds_ = conflict_rounds;
  }

 private:
  void begin(Phase phase);
  void call_on_phase(std::optional<Phase> phase);
  std::size_t least_sensing_batch(std::size_t rows) const;
  void sense();
  void actuate();
  void check_effects();
  void decide();
  void decide(std::span<const Row> rows, const BodyType& type, const BodyType::Controller& controller);
  void decide_together();
  void move();
  void report_collisions();
  void add_feelers(Row root, std::uint32_t mover);
  void report_joints();
  void apply_effects();
  DeviceBatch device_batch(std::span<const Row> rows, const BodyType& type, const BodyType::Device& device);
  template <class Work>
  void for_seeing(std::span<const Row> rows, const BodyType& type, const BodyType::Device& device,
                  Work&& work);

  WorldState& state_;
  partition::Parallel& parallel_;
  Links& links_;
  Movement& movement_;
  Places& places_;
  Lives& lives_;
  Interventions& interventions_;
  const RankPort& ranks_;
  Activities& activities_;
  Actuation actuation_;

  // Constants.
  bool has_collisions_ = false;  // a device feels collisions (DeviceKind::collide)
  bool has_collective_ = false;  // a type has a controller with ControllerKind::is_collective

  std::uint64_t beams_ = 0;
  std::uint64_t conflict_rounds_ = 0;

  // Set by the program.
  OnPhase on_phase_;
  BeforeTick before_tick_;
  OnDecide on_decide_;
  std::unique_ptr<Blinkers> blinkers_;  // null: devices see everything

  // Scratch: data of the current tick.
  Effects effects_;
  /// A collision of the body `mover` that devices of the body `feeler` feel, both as rows.
  struct Felt {
    Row feeler;
    std::uint32_t mover;
    bool as_mover;  // the feeler belongs to the tree of the mover
  };
  std::vector<Felt> felt_;
  std::vector<Row> cargo_;     // of a body that feels a collision
  std::vector<Row> deciding_;  // robots with collective controllers, then those for which one of them decides
};

}  // namespace troupe::engine
