#pragma once

#include "apps/observers/profile.hpp"
#include "apps/options.hpp"
#include "apps/pictures/picture_options.hpp"
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
  std::filesystem::path hash_log;  ///< empty: none
  PictureFiles pictures;
  std::filesystem::path profile;  ///< empty: none
  ProfileLimits profile_limits;
  std::filesystem::path checkpoint;          ///< empty: none
  std::optional<double> checkpoint_every_s;  ///< not given: at the end alone
  std::optional<double> wall_limit_s;
  std::filesystem::path record;  ///< empty: where the world says, if it does
  RecordingOptions recording;
  std::filesystem::path measures;         ///< empty: none
  std::vector<std::string> measure;       ///< as Measures takes them; empty: as the world says
  std::optional<double> measure_every_s;  ///< not given: as the world says
  std::filesystem::path events;           ///< empty: none
  std::filesystem::path camera_folder;    ///< empty: none
  double camera_every_s = 1;              ///< 0: every tick
  bool force = false;                     ///< outputs that exist may be replaced
  bool clock = false;                     ///< the time is told even where the world does not ask for it
  double rate = 0;                        ///< times real time, at most; 0: as fast as possible
  bool world_rate = false;                ///< instead: as the world says
  /// `troupe resume`: `world` is a checkpoint, and of `simulation` only threads, tiles and `set` count.
  bool across_versions = false;
  bool across_plugins = false;
  bool json = false;
  bool quiet = false;
};

/// The names of all files that a run writes, but for pictures of cameras, in a fixed order; empty where there
/// is none.
std::vector<std::filesystem::path*> outputs_of(RunOptions& options);
/// In the names of outputs this stands for the world's name, without folder and ending.
inline constexpr std::string_view k_world_mark = "{world}";
std::string with_world(std::string name, const std::filesystem::path& world);

/// Adds `run` and its options to the program; parsing fills `options`, which must outlive `app`.
/// A value that is not what an option takes is a CLI::ValidationError that says what would be right.
CLI::App* add_run_command(CLI::App& app, RunOptions& options);
/// The same for `resume`, whose outputs are those of `run`.
CLI::App* add_resume_command(CLI::App& app, RunOptions& options);

}  // namespace troupe::apps
