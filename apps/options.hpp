#pragma once

#include "apps/cli_app.hpp"
#include "engine/kinds/registry.hpp"
#include "troupe/script.hpp"
#include "troupe/simulation.hpp"

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Command-line options that several commands share.
namespace troupe::apps {

/// Throws CLI::ValidationError for the value `text` of the option `option`. With `expected` = "a number of
/// threads, ..." the error reads `--threads: "many" is not a number of threads, ...`.
[[noreturn]] void refuse(const char* option, std::string_view text, std::string_view expected);
/// Returns `text`, the value of `option`, as the name of a file to write. Throws CLI::ValidationError if the
/// name is empty or begins with `-`.
std::filesystem::path file_name(const char* option, const std::string& text);
/// Like file_name(), for an HDF5 file. Also throws CLI::ValidationError if the ending of the name is that of
/// another format (worldio::has_ending_of_other_format()).
std::filesystem::path hdf5_name(const char* option, const std::string& text);
/// Converts `text`, the value of `option`, to a time in seconds, from 0 to engine::k_most_seconds (10^9).
/// Throws CLI::ValidationError for other texts.
double seconds_from_zero(const char* option, const std::string& text);
/// Converts `text`, the value of `option`, to a time in seconds, above 0 and at most engine::k_most_seconds
/// (10^9). Throws CLI::ValidationError for other texts. what: name of the time in the error, such as "a real
/// time".
double positive_seconds(const char* option, const std::string& text, std::string_view what);

/// Returns the names in `text`, the value of `option`, which is a list such as `pose,ranges`. Throws
/// CLI::ValidationError if a name is empty. expected: as in refuse().
std::vector<std::string> names_in(const char* option, const std::string& text, std::string_view expected);

/// Convert the text of an option value to a number. These values have the same form in every command. Throw
/// CLI::ValidationError for other values.
///
/// thread_count  --threads: number of worker threads, 1 to partition::Parallel::k_most_threads
/// tile_size_m   --tile-size: edge length, m, above 0, of the squares of the world by which robots are
///               grouped into tasks for the worker threads
/// rank_count    --ranks: number of groups of threads among which the robots are divided, 1 to k_most_ranks
unsigned thread_count(std::string_view text);
double tile_size_m(std::string_view text);
unsigned rank_count(std::string_view text);

/// Adds an option with one value. name: as typed, `--for`; value: placeholder of the value in the help, `S`;
/// help: the description in the help; set: converts the text of the value and stores the result; needed: the
/// option without which this one is an error, null if there is none. CLI11's own conversions are not used,
/// because they would accept hexadecimal numbers and nan.
CLI::Option* add_value(CLI::App& app, const char* name, const char* value, const char* help,
                       const std::function<void(const std::string&)>& set, CLI::Option* needed = nullptr);
/// Like add_value(), for an option that may be repeated. `add` is called once for each value, in the order of
/// the command line, with the text of the value.
CLI::Option* add_values(CLI::App& app, const char* name, const char* value, const char* help,
                        const std::function<void(const std::string&)>& add, CLI::Option* needed = nullptr);

/// Adds an option without a value. name: as typed, `--force`; help: the description in the help. Parsing sets
/// `on`, which must outlive `app`, to true, and rejects a value, as in `--force=false`.
CLI::Option* add_switch(CLI::App& app, const char* name, bool& on, const char* help);

/// Adds a required positional argument, the name of a file or folder. name: as in the help, `RECORDING`;
/// help: the description in the help. Parsing sets `file`, which must outlive `app`.
void add_argument(CLI::App& app, const char* name, const char* help, std::filesystem::path& file);

/// Options of the commands that load a world: the world file, the settings of its simulation, and the end of
/// the run. Ranks are processes, or groups of threads, that compute the world together.
struct WorldCommandOptions {
  std::filesystem::path world;  ///< world file, or checkpoint (saved state of a run)
  bool is_checkpoint = false;   ///< `world` is a checkpoint
  SimulationOptions simulation;
  std::optional<double> for_s;  ///< --for: end in simulated time, s
  bool gives_ranks = false;     ///< whether --ranks is given, which is an error under mpirun
  double rank_limit_s = 600;    ///< --rank-limit: longest wait for another rank, wall time, s
  // For checkpoints:
  bool across_versions = false;  ///< resume although another version of Troupe wrote the checkpoint
  bool across_plugins = false;   ///< resume although plug-ins were rebuilt since the checkpoint
};
/// Adds the positional argument WORLD and the options of add_run_settings(). Parsing fills `options`, which
/// must outlive `app`.
void add_world_options(CLI::App& app, WorldCommandOptions& options);
/// Adds --for, --seed, --raytracer, --robots, --spare, --set, --plugin-path, --controller and --simd. Parsing
/// fills `options`, which must outlive `app`.
void add_run_settings(CLI::App& app, WorldCommandOptions& options);
/// Adds --for, for commands without the other options of add_run_settings(). Parsing sets options.for_s.
void add_end_option(CLI::App& app, WorldCommandOptions& options);
/// Adds --set, for commands without the other options of add_run_settings(). set: receives, for each --set,
/// the JSON pointer and the JSON text of the new value; what: what the help calls the world.
void add_set_option(CLI::App& app, std::vector<std::pair<std::string, std::string>>& set,
                    std::string_view what = "world");

/// Adds --threads. Parsing sets options.simulation.threads. what: what the help calls the threads
void add_threads_option(CLI::App& app, WorldCommandOptions& options,
                        std::string_view what = "Worker threads");
/// Adds --across-versions and --across-plugins, for commands that resume checkpoints. Parsing fills
/// `options`, which must outlive `app`.
void add_across_options(CLI::App& app, WorldCommandOptions& options);
/// Throws InputError if an option of add_across_options() is given. For a world file, which has no use for
/// them.
void refuse_across_options(const WorldCommandOptions& options);

/// Returns the end of the run in simulated time, s: the value of --for, or else the quit time
/// that the world file gives. Throws InputError if neither is given.
double end_of(const WorldCommandOptions& options, const Simulation& simulation);
/// Throws InputError if the simulation was resumed from a checkpoint that was saved after the end of the run
/// at the simulated time `end_s`, s.
void check_end(const WorldCommandOptions& options, const Simulation& simulation, double end_s);
/// Adds --simd, which names a SIMD instruction set. Parsing selects this set for range finding (the
/// computation of the distances that sensors measure) in the whole process. Throws CLI::ValidationError,
/// while parsing, if the name is unknown or the processor lacks the set.
void add_simd_option(CLI::App& app);
/// Selects the SIMD instruction set that the environment variable TROUPE_SIMD names, as add_simd_option()
/// does. Does nothing if the variable is not set or empty. Throws InputError if the name is unknown or the
/// processor lacks the set.
void obey_simd_variable();
/// Adds --rank-seed, an option for tests, which sets SimulationOptions::rank_seed. Ranks are the processes,
/// or groups of threads, that compute a world together. If a seed is given, messages between ranks arrive
/// late, and robots move to randomly chosen ranks during the run. No simulated result depends on the seed.
void add_rank_seed_option(CLI::App& app, WorldCommandOptions& options);
/// Adds --distribute, which sets SimulationOptions::distribute. Ranks are the processes, or groups of
/// threads, that compute a world together. Without this option, each rank has the data of all robots. With
/// it, each rank has only the data of its own robots and of robots near them, if the world allows it.
void add_distribute_option(CLI::App& app, WorldCommandOptions& options);
/// Adds --rank-limit, which sets `limit_s`: the longest time that a rank waits for another rank, wall time,
/// s. A rank is a process, or a group of threads, that computes a part of the world. `limit_s` must outlive
/// `app`.
void add_rank_limit_option(CLI::App& app, double& limit_s);
/// Adds --plugin-path and --controller, which give a command further kinds (implementations of controllers,
/// devices and measures). Parsing fills both lists, which must outlive `app`.
void add_kind_options(CLI::App& app, std::vector<std::filesystem::path>& plugin_path,
                      std::vector<std::shared_ptr<const Script>>& scripts);

/// The values of add_kind_options(), for commands without WorldCommandOptions.
struct KindSources {
  std::vector<std::filesystem::path> plugin_path;      ///< folders to search for plug-ins (shared libraries)
  std::vector<std::shared_ptr<const Script>> scripts;  ///< scripts with controllers (--controller)
};
/// Adds the same options as the other add_kind_options(). Parsing fills `sources`, which must outlive `app`.
void add_kind_options(CLI::App& app, KindSources& sources);
/// Returns the kinds of Troupe, with those of the plug-ins and scripts of `sources` and of the folders in the
/// environment variables that plugin_path() reads. Throws InputError for a script that cannot be used.
engine::Registry registry_with(const KindSources& sources);
/// Returns the folders to search for plug-ins, in this order: those in `given`, those in the environment
/// variable TROUPE_PLUGIN_PATH, and those in STAGEPATH, where users of Stage keep their plug-ins.
std::vector<std::filesystem::path> plugin_path(std::vector<std::filesystem::path> given);
/// Returns `options` with folders from environment variables added. Appends the folders of STAGEPATH to the
/// member search_path, as Stage does. Appends the folders of TROUPE_PLUGIN_PATH, and then those of STAGEPATH,
/// to the member plugin_path.
SimulationOptions with_environment(SimulationOptions options);
/// Returns how `options` resume a checkpoint in one rank. Adds the folders of environment variables to the
/// member plugin_path, as with_environment() does.
ResumeOptions resume_options(const WorldCommandOptions& options);

}  // namespace troupe::apps
