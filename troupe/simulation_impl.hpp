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

/// The data of a Simulation. A registry lists the kinds that the world can use: the implementations of
/// sensors, other devices, drives, controllers, measures and faults. The ranks are the threads or processes
/// that compute the world together.
struct Simulation::Impl {
  std::shared_ptr<engine::Registry> registry;  ///< shared with simulations from another()
  std::shared_ptr<Plugins> plugins;            ///< loads kinds from shared libraries for `registry`
  std::unique_ptr<engine::World> world;
  /// The ranks that compute `world` together with this thread; null if it is computed by one rank.
  std::unique_ptr<RankGroup> ranks;
  std::string why_replicated;  ///< why SimulationOptions::distribute has no effect; else empty
  std::vector<std::string> warnings;
  std::filesystem::path file;       ///< path of the world file
  double tile_size_m = 0;           ///< SimulationOptions::tile_size_m: edge of the tiles of the world, m
  worldio::PlaceAgain place_again;  ///< places bodies for another seed; empty if no pose depends on seeds
  /// Changes to the world, as pairs of key and value for effective_options(): the values of the option `set`,
  /// and the option `spare`. For a value of ResumeOptions::set, the key contains the tick of the checkpoint.
  /// All keys differ.
  std::vector<std::pair<std::string, std::string>> changes;
  /// Tick of the checkpoint that the run was resumed from; std::nullopt if it was not resumed.
  std::optional<std::uint64_t> resumed_at;
  /// The data that the checkpoint contains by name, if the run was resumed from one: those that callbacks of
  /// on_save() returned, and data of Troupe.
  worldio::Memories memories;
  /// The callbacks of on_save(), by name.
  std::map<std::string, std::function<std::vector<std::byte>()>> on_save;
  /// Evaluates the conditions under the key `stop_when` of the world file, which end the run; null if the
  /// world has none.
  std::unique_ptr<engine::StopConditions> stop;
  /// The recording that record() started; null if none is running.
  std::unique_ptr<Recording> recording;
  std::deque<std::function<void(Simulation&)>> on_tick;  ///< callbacks of Simulation::on_tick()
  bool in_callbacks = false;                             ///< whether a callback of `on_tick` is running
  /// Renderer and options of the last call of snapshot() or picture(); null before the first call.
  std::unique_ptr<Pictures> pictures;
  PictureOptions picture_options;

  std::function<void(Simulation&)> before_tick;  ///< callback of Simulation::before_tick(); may be empty
  /// The held robots: those that a user or a program steers instead of their controllers, because of an act
  /// (a change of the running world, Simulation::act()).
  Holds holds;

  /// Throws std::logic_error if a callback of on_tick() is running. `what`: the call that is not allowed in
  /// these callbacks, for the error.
  void refuse_in_callbacks(std::string_view what) const;
  /// Throws std::logic_error for a model of another simulation.
  void require_own(const Model& model) const;
  /// Throws std::runtime_error if an output would replace a file that the simulation was read from.
  void refuse_to_replace_inputs(const std::filesystem::path& output) const;
  /// Returns `pictures`. Makes `pictures` again if the last call had other options.
  Pictures& pictures_of(const Simulation& simulation, const PictureOptions& options);

  // troupe/simulation_files.cpp
  /// Makes the world of a valid spec (the description of a world that the engine uses internally), and
  /// collects the warnings about this world and about plug-ins in `warnings`. populations: the names of the
  /// populations of a JSON world, for the option `spare`, which adds unborn robots to them.
  void start(engine::WorldSpec spec, const SimulationOptions& options, Diagnostics& diagnostics,
             std::span<const std::string> populations = {});
  /// Makes `world` from its spec, and makes its replicas (copies of the world) on the other ranks. options:
  /// SimulationOptions or ResumeOptions.
  template <class Options>
  void make_world(engine::WorldSpec spec, const Options& options, Diagnostics& diagnostics);
  /// Sets up the stop conditions (`stop_when`). `world` must already be set.
  void watch_for_the_end(Diagnostics& diagnostics);
  /// Restores the state of `world`, the stop conditions and the held robots from a checkpoint. `world` must
  /// already be made.
  void restore(const worldio::Checkpoint& checkpoint, Diagnostics& diagnostics);
};

}  // namespace troupe
