#pragma once

#include "apps/options.hpp"
#include "apps/run/run_output.hpp"
#include "troupe/recording.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::apps {

/// What the command line of `troupe run`, or of `troupe resume`, asks for.
struct RunOptions : WorldOptions {
  /// All worlds of the call, or the checkpoint; `world` is the one that a part of the run is about.
  std::vector<std::filesystem::path> worlds;
  RunOutputs outputs;
  std::filesystem::path checkpoint;          ///< empty: none
  std::optional<double> checkpoint_every_s;  ///< not given: at the end alone
  std::optional<double> wall_limit_s;
  std::filesystem::path record;  ///< empty: where the world says, if it does
  RecordingOptions recording;
  std::filesystem::path session;  ///< acts that are repeated; empty: none
  bool force = false;             ///< outputs that exist may be replaced
  bool clock = false;             ///< the time is told even where the world does not ask for it
  double rate = 0;                ///< times real time, at most; 0: as fast as possible
  bool world_rate = false;        ///< instead: as the world says
  /// `troupe resume`: `world` is a checkpoint, and of `simulation` only threads, tiles and `set` count.
  bool across_versions = false;
  bool across_plugins = false;
  bool json = false;
  bool quiet = false;
};

/// In the names of outputs this stands for the world's name, without folder and ending.
inline constexpr std::string_view k_world_mark = "{world}";
std::string with_world(std::string name, const std::filesystem::path& world);

/// Adds the options of `run`; parsing fills `options`, which must outlive `command`.
/// A value that is not what an option takes is a CLI::ValidationError that says what would be right.
void add_run_options(CLI::App& command, RunOptions& options);
/// The same for `resume`, whose outputs are those of `run`.
void add_resume_options(CLI::App& command, RunOptions& options);

}  // namespace troupe::apps
