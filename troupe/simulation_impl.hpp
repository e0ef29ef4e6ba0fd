#pragma once

#include "engine/observing/stop_conditions.hpp"
#include "engine/world/world.hpp"
#include "troupe/acts.hpp"
#include "troupe/model_place.hpp"
#include "troupe/pictures.hpp"
#include "troupe/plugins.hpp"
#include "troupe/rank_group.hpp"
#include "troupe/recording.hpp"
#include "troupe/simulation.hpp"
#include "worldio/load.hpp"
#include "worldio/results/checkpoint.hpp"

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe {

/// The data of a Simulation. A kind is an implementation of a sensor, another device, a drive, a controller,
/// a measure or a fault; a registry lists the kinds that the world can use. A rank is a thread or process
/// that computes the world together with other ranks.
struct Simulation::Impl {
  std::shared_ptr<engine::Registry> registry;  ///< shared with simulations from another()
  std::shared_ptr<Plugins> plugins;            ///< loads kinds from shared libraries for `registry`
  std::unique_ptr<engine::World> world;
  /// The ranks that compute `world`; the thread that calls the functions of Simulation is rank 0. Null if
  /// there is only one rank.
  std::unique_ptr<RankGroup> ranks;
  std::string why_replicated;  ///< why SimulationOptions::distribute has no effect; else empty
  std::vector<std::string> warnings;
  std::filesystem::path file;       ///< path of the world file
  double tile_size_m = 0;           ///< SimulationOptions::tile_size_m: edge of the tiles of the world, m
  worldio::PlaceAgain place_again;  ///< places bodies for another seed; empty if no pose depends on seeds
  /// The bodies, by id, that reset(seed, starts) has ever placed elsewhere, and their poses before. For
  /// bodies whose poses do not depend on seeds, these are the poses that the world gives.
  std::map<std::uint32_t, Pose> moved_starts;
  /// Changes that options made to the world, as pairs of a key and a value, for effective_options(). These
  /// are the values of the option `set` and the value of the option `spare`. If ResumeOptions::set made a
  /// change, its key contains the tick of the checkpoint. Each key occurs only once.
  std::vector<std::pair<std::string, std::string>> changes;
  /// Simulation::command() without `--seed` and `--session`; empty if a program built the world.
  std::string command;
  std::uint64_t command_seed = 0;  ///< the seed of the loaded world
  bool command_has_seed = false;   ///< whether an option gave the seed
  /// Tick of the checkpoint that the run was resumed from; std::nullopt if it was not resumed.
  std::optional<std::uint64_t> resumed_at;
  /// If the run was resumed from a checkpoint: the data that the checkpoint stores under names. Callbacks of
  /// Simulation::on_save() returned most of these data. Troupe adds data of its own, such as the list of held
  /// robots. Empty if the run was not resumed.
  worldio::Memories memories;
  /// The callbacks that Simulation::on_save() registered, by name.
  std::map<std::string, std::function<std::vector<std::byte>()>> on_save;
  /// Evaluates the stop conditions, which end the run: the value of the key `stop_when` of the world file.
  /// Null if the world has no stop conditions.
  std::unique_ptr<engine::StopConditions> stop;
  /// The recording that record() started; null if none is running.
  std::unique_ptr<Recording> recording;
  /// A callback of Simulation::on_tick(). If it has an owner, it is called only while the owner exists.
  struct OnTick {
    std::function<void(Simulation&)> call;
    std::optional<std::weak_ptr<const void>> owner;
    bool has_expired() const { return owner && owner->expired(); }
  };
  std::deque<OnTick> on_tick;
  bool in_on_tick = false;  ///< whether a callback of `on_tick` is running
  /// Renderer and options of the last call of snapshot() or picture(); null before the first call.
  std::unique_ptr<Pictures> pictures;
  PictureOptions picture_options;

  std::function<void(Simulation&)> before_tick;  ///< callback of Simulation::before_tick(); may be empty
  bool in_before_tick = false;                   ///< whether the callback `before_tick` is running
  std::function<void(Simulation&)> before_step;  ///< callback of Simulation::before_step(); may be empty
  bool in_before_step = false;                   ///< whether the callback `before_step` is running
  /// The held robots: robots that get their speeds from a user or a program instead of from their
  /// controllers. Simulation::act() holds and releases robots.
  Holds holds;

  /// Throws std::logic_error during a step, and if a callback of on_tick(), before_tick() or before_step() is
  /// running. what: name of the calling function, which is not allowed there, for the error.
  void refuse_in_callbacks(std::string_view what) const;
  /// Throws std::logic_error for a model of another simulation.
  void require_own(const Model& model) const;
  /// Throws std::invalid_argument if a body cannot begin a run at this pose: see reset(seed, starts).
  void require_start(BodyId body, const Pose& pose) const;
  /// Throws std::runtime_error if `output` is a file that the simulation was read from.
  void refuse_to_replace_inputs(const std::filesystem::path& output) const;
  /// Returns `pictures`, which draws with `options`. Creates `pictures` at the first call, and again if
  /// `options` differ from those of the previous call.
  Pictures& pictures_of(const Simulation& simulation, const PictureOptions& options);

  // troupe/simulation_files.cpp
  /// Makes the world from a valid spec, which is the engine's description of a world. Stores the warnings
  /// about the world and about plug-ins in `warnings`. populations: names of the populations of a JSON world,
  /// to which the option `spare` adds unborn robots.
  void start(engine::WorldSpec spec, const SimulationOptions& options, Diagnostics& diagnostics,
             std::span<const std::string> populations = {});
  /// Makes `world` from its spec, and a copy of the world (a replica) for each of the other ranks. options:
  /// SimulationOptions or ResumeOptions.
  template <class Options>
  void make_world(engine::WorldSpec spec, const Options& options, Diagnostics& diagnostics);
  /// Makes `stop` for the stop conditions of `world`, which must already be made. Leaves `stop` null if there
  /// are no stop conditions. Throws InputError if a condition is wrong.
  void watch_for_the_end(Diagnostics& diagnostics);
  /// Restores the state of `world`, the stop conditions and the held robots from a checkpoint. `world` must
  /// already be made.
  void restore(const worldio::Checkpoint& checkpoint, Diagnostics& diagnostics);
};

}  // namespace troupe
