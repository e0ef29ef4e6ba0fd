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

/// Options of `troupe run` and `troupe resume`. A rank is a process or a group of threads; several ranks can
/// compute a world together.
struct RunOptions : WorldCommandOptions {
  /// The world files to run or, for `troupe resume`, the checkpoint to resume. Each world is run with its own
  /// copy of these options, whose member `world` names its file.
  std::vector<std::filesystem::path> worlds;
  RunOutputs outputs;  ///< the kinds of output (hash log, pictures, ...), with most of their options
  std::filesystem::path checkpoint;  ///< file for checkpoints (saved states); empty: none
  /// Simulated time between checkpoints, s; not given: checkpoints are saved only on SIGUSR1 and at the end.
  std::optional<double> checkpoint_every_s;
  std::optional<double> wall_limit_s;  ///< wall time after which the run stops, s; not given: no limit
  std::filesystem::path record;        ///< file of the recording; empty: the one that the world names, if any
  RecordingOptions recording;          ///< interval and fields of the recording
  std::filesystem::path session;       ///< file with actions of users (troupe view) to repeat; empty: none
  bool view = false;                   ///< --view: show the run in browsers (docs/live.md)
  bool force = false;                  ///< replace an existing checkpoint or recording
  bool clock = false;       ///< print the simulated time even if the world file does not request this
  double rate = 0;          ///< limit of the speed, in multiples of real time; 0: no limit
  bool world_rate = false;  ///< limit the speed to the rate in the world file, and ignore `rate`
  // For `troupe resume`: `world` is then a checkpoint, and the only members of `simulation` that are used are
  // those that ResumeOptions also has, such as `threads` and `set`.
  bool dry_run = false;  ///< --dry-run: load the world, print what the run would need, and end
  /// Whether slower ranks pass robots to faster ranks (--rank-balance time) or not (--rank-balance off).
  bool balances_ranks = true;
  bool json = false;   ///< print the summary as JSON
  bool quiet = false;  ///< print neither progress, warnings nor the summary as text
};

/// Placeholder in the names of outputs. It stands for the name of the world: the name of the world file
/// without folder and extension.
inline constexpr std::string_view k_world_mark = "{world}";
/// Returns `name` with each k_world_mark replaced by the name of the world. world: path of the world file
std::string with_world(std::string name, const std::filesystem::path& world);

/// Adds the options of `run` to `command`. Parsing fills `options`, which must outlive `command`. Parsing
/// throws CLI::ValidationError for an invalid value; the error states the allowed values.
void add_run_options(CLI::App& command, RunOptions& options);
/// Adds the options of `resume` to `command`, including all options for outputs that `run` has. Parsing fills
/// `options` and throws as for add_run_options(). `options` must outlive `command`.
void add_resume_options(CLI::App& command, RunOptions& options);

}  // namespace troupe::apps
