#include "apps/options.hpp"

#include "apps/scripts.hpp"
#include "base/diagnostics.hpp"
#include "base/number_text.hpp"
#include "base/split.hpp"
#include "engine/spec/ticks.hpp"
#include "partition/parallel.hpp"
#include "partition/simd_target.hpp"
#include "troupe/plugins.hpp"
#include "troupe/registry.hpp"
#include "worldio/files.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <utility>

namespace troupe::apps {
namespace {

/// Converts a value of --robots to the name of a population (empty: the only one) and its size.
std::pair<std::string, std::size_t> population_size(const std::string& text) {
  const auto equals = text.rfind('=');
  const auto count = number_of<std::size_t>(text.substr(equals == text.npos ? 0 : equals + 1));
  if (!count || equals == 0)
    refuse("--robots", text,
           "a number of robots, as in --robots 500, or --robots NAME=500 for one population");
  return {equals == text.npos ? "" : text.substr(0, equals), *count};
}

/// Converts a value of --set to a JSON pointer and the text of a JSON value.
std::pair<std::string, std::string> assignment(const std::string& text) {
  const auto equals = text.find('=');
  if (!text.starts_with('/') || equals == text.npos)
    refuse("--set", text,
           "a JSON pointer, which begins with \"/\", and a value, as in --set /populations/0/count=500");
  return {text.substr(0, equals), text.substr(equals + 1)};
}

/// Converts a value of the option `option` to a seed.
std::uint64_t seed_of(const char* option, const std::string& text) {
  const auto seed = number_of<std::uint64_t>(text);
  if (!seed) refuse(option, text, "a whole number from 0 to 2^64 - 1");
  return *seed;
}

/// Returns the value of an environment variable; empty if it is not set.
std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

/// Appends the folders of a list separated by colons.
void append_folders(const std::string& list, std::vector<std::filesystem::path>& folders) {
  for (const std::string_view folder : split(list, ':'))
    if (!folder.empty()) folders.emplace_back(folder);
}

}  // namespace

void refuse(const char* option, std::string_view text, std::string_view expected) {
  throw CLI::ValidationError(option, fmt::format("\"{}\" is not {}", text, expected));
}

CLI::Option* add_value(CLI::App& app, const char* name, const char* value, const char* help,
                       const std::function<void(const std::string&)>& set, CLI::Option* needed) {
  CLI::Option* const option = app.add_option_function<std::string>(name, set, help)->option_text(value);
  if (needed != nullptr) option->needs(needed);
  return option;
}

CLI::Option* add_values(CLI::App& app, const char* name, const char* value, const char* help,
                        const std::function<void(const std::string&)>& add, CLI::Option* needed) {
  const auto add_all = [add](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) add(text);
  };
  CLI::Option* const option = app.add_option_function<std::vector<std::string>>(name, add_all, help)
                                  ->option_text(value)
                                  ->allow_extra_args(false);
  if (needed != nullptr) option->needs(needed);
  return option;
}

CLI::Option* add_switch(CLI::App& app, const char* name, bool& on, const char* help) {
  return app.add_flag(name, on, help)->disable_flag_override();
}

void add_argument(CLI::App& app, const char* name, const char* help, std::filesystem::path& file) {
  add_value(app, name, " ", help, [&file](const std::string& text) { file = text; })->required();
}

std::filesystem::path file_name(const char* option, const std::string& text) {
  if (text.empty() || text.starts_with('-')) refuse(option, text, "a file name");
  return text;
}

std::filesystem::path hdf5_name(const char* option, const std::string& text) {
  std::filesystem::path file = file_name(option, text);
  if (worldio::has_ending_of_other_format(file))
    refuse(option, text, fmt::format("the name of an HDF5 file, as in {} run.h5", option));
  return file;
}

double seconds_from_zero(const char* option, const std::string& text) {
  const std::optional<double> seconds = finite_number_of(text);
  if (!seconds || *seconds < 0 || *seconds > engine::k_most_seconds)
    refuse(option, text, fmt::format("a time in seconds, from 0 to {}", engine::k_most_seconds));
  return *seconds;
}

double positive_seconds(const char* option, const std::string& text, std::string_view what) {
  const std::optional<double> seconds = finite_number_of(text);
  if (!seconds || *seconds <= 0 || *seconds > engine::k_most_seconds)
    refuse(option, text, fmt::format("{} in seconds, above 0 and at most {}", what, engine::k_most_seconds));
  return *seconds;
}

std::vector<std::string> names_in(const char* option, const std::string& text, std::string_view expected) {
  const std::vector<std::string_view> names = split(text, ',');
  if (std::ranges::count(names, "") > 0) refuse(option, text, expected);
  return {names.begin(), names.end()};
}

unsigned thread_count(std::string_view text) {
  const auto threads = number_of<unsigned>(text);
  if (!threads || *threads < 1 || *threads > partition::Parallel::k_most_threads)
    refuse("--threads", text,
           fmt::format("a number of threads from 1 to {}", partition::Parallel::k_most_threads));
  return *threads;
}

unsigned rank_count(std::string_view text) {
  const auto ranks = number_of<unsigned>(text);
  if (!ranks || *ranks < 1 || *ranks > k_most_ranks)
    refuse("--ranks", text, fmt::format("a number of ranks from 1 to {}", k_most_ranks));
  return *ranks;
}

double tile_size_m(std::string_view text) {
  const auto size = finite_number_of(text);
  if (!size || *size <= 0) refuse("--tile-size", text, "a length in metres, above 0");
  return *size;
}

void add_world_options(CLI::App& app, WorldCommandOptions& options) {
  add_argument(app, "WORLD", "World file: Stage's .world, or .json", options.world);
  add_run_settings(app, options);
}

void add_run_settings(CLI::App& app, WorldCommandOptions& options) {
  add_end_option(app, options);
  add_value(app, "--seed", "N", "Seed of all random numbers (default: the world's, else 1)",
            [&options](const std::string& text) { options.simulation.seed = seed_of("--seed", text); });
  add_value(app, "--raytracer", "exact|grid", "Method of range finding (default: the world's, else exact)",
            [&options](const std::string& text) {
              const auto& names = engine::k_ranging_engines;
              const auto found = std::ranges::find(names, text);
              if (found == names.end()) refuse("--raytracer", text, "exact or grid");
              options.simulation.ranging = static_cast<RangingEngine>(found - names.begin());
            });
  add_values(
      app, "--robots", "[NAME=]N",
      "Number of robots in the world's only population, or in population NAME; repeatable",
      [&options](const std::string& text) { options.simulation.robots.push_back(population_size(text)); });
  add_value(app, "--spare", "N",
            "Spare robots per population, which can be added during the run (default: 0)",
            [&options](const std::string& text) {
              constexpr std::uint32_t k_most = SimulationOptions::k_most_spare;
              const auto count = number_of<std::uint32_t>(text);
              if (!count || *count > k_most)
                refuse("--spare", text, fmt::format("a number of robots from 0 to {}", k_most));
              options.simulation.spare = *count;
            });
  add_set_option(app, options.simulation.set);
  add_kind_options(app, options.simulation.plugin_path, options.simulation.scripts);
  add_simd_option(app);
}

void add_threads_option(CLI::App& app, WorldCommandOptions& options, std::string_view what) {
  const std::string help = fmt::format("{} (default: one per available processor)", what);
  add_value(app, "--threads", "N", help.c_str(),
            [&options](const std::string& text) { options.simulation.threads = thread_count(text); });
}

void add_across_options(CLI::App& app, WorldCommandOptions& options) {
  add_switch(app, "--across-versions", options.across_versions,
             "Resume even if another version of Troupe wrote the checkpoint");
  add_switch(app, "--across-plugins", options.across_plugins,
             "Resume even if plug-ins were rebuilt since the checkpoint was saved");
}

void refuse_across_options(const WorldCommandOptions& options) {
  if (options.across_versions || options.across_plugins)
    throw InputError(
        fmt::format("{}: error: --across-versions and --across-plugins are only for checkpoints: omit these "
                    "options",
                    options.world.string()));
}

void add_rank_seed_option(CLI::App& app, WorldCommandOptions& options) {
  add_value(
      app, "--rank-seed", "N",
      "For tests: delay messages between ranks and move robots to other ranks at random, with seed N",
      [&options](const std::string& text) { options.simulation.rank_seed = seed_of("--rank-seed", text); })
      ->group("Advanced");
}

void add_distribute_option(CLI::App& app, WorldCommandOptions& options) {
  add_switch(app, "--distribute", options.simulation.distribute,
             "With several ranks: each rank has only its own and nearby robots, if the world allows it");
}

void add_rank_limit_option(CLI::App& app, double& limit_s) {
  add_value(
      app, "--rank-limit", "S",
      "Under mpirun or srun: fail after waiting S s of real time for another rank (default: 600)",
      [&limit_s](const std::string& text) { limit_s = positive_seconds("--rank-limit", text, "a time"); })
      ->group("Advanced");
}

void add_end_option(CLI::App& app, WorldCommandOptions& options) {
  add_value(app, "--for", "S", "End at S seconds of simulated time", [&options](const std::string& text) {
    options.for_s = finite_number_of(text);
    if (!options.for_s || *options.for_s < 0 || *options.for_s > engine::k_longest_run_s)
      refuse("--for", text, fmt::format("a time in seconds, from 0 to {}", engine::k_longest_run_s));
  });
}

void add_set_option(CLI::App& app, std::vector<std::pair<std::string, std::string>>& set,
                    std::string_view what) {
  const std::string help =
      fmt::format("Change a value of the {}: a JSON pointer and a value; repeatable", what);
  add_values(app, "--set", "POINTER=VALUE", help.c_str(),
             [&set](const std::string& text) { set.push_back(assignment(text)); });
}

double end_of(const WorldCommandOptions& options, const Simulation& simulation) {
  if (options.for_s) return *options.for_s;
  if (const auto quit = simulation.quit_time_s()) return *quit;
  const bool json = options.world.extension() == ".json";
  throw InputError(fmt::format("{}: error: no end time: give --for SECONDS{}", options.world.string(),
                               options.is_checkpoint          ? ", or --set /quit_time_s=SECONDS"
                               : simulation.resumed_at_tick() ? ""  // troupe render, which has no --set then
                               : json                         ? ", or set quit_time_s in the world"
                                                              : ", or set quit_time in the world"));
}

void check_end(const WorldCommandOptions& options, const Simulation& simulation, double end_s) {
  if (engine::ticks_until(end_s, simulation.tick_s()) >= simulation.tick()) return;
  throw InputError(
      fmt::format("{}: error: the checkpoint was saved at {:.10g} s, after the end of the run at {:.10g} "
                  "s: give a later --for",
                  options.world.string(), simulation.time_s(), end_s));
}

void add_simd_option(CLI::App& app) {
  add_value(app, "--simd", "scalar|ssse3|sse4|avx2|avx512|neon|sve|sve2|sve_256|sve2_128",
            "Instruction set for range finding (default: environment variable TROUPE_SIMD, else the best)",
            [](const std::string& text) {
              try {
                partition::use_simd_target(text);
              } catch (const std::invalid_argument& error) {
                throw CLI::ValidationError("--simd", error.what());
              }
            })
      ->group("Advanced");
}

void obey_simd_variable() {
  const std::string name = variable("TROUPE_SIMD");
  if (name.empty()) return;
  try {
    partition::use_simd_target(name);
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("TROUPE_SIMD: error: {}", error.what()));
  }
}

void add_kind_options(CLI::App& app, std::vector<std::filesystem::path>& plugin_path,
                      std::vector<std::shared_ptr<const Script>>& scripts) {
  add_values(app, "--plugin-path", "DIR[:DIR]",
             "Folders with plug-ins, searched before those in TROUPE_PLUGIN_PATH and STAGEPATH; repeatable",
             [&plugin_path](const std::string& text) {
               if (text.starts_with('-') || text.find_first_not_of(':') == text.npos)
                 refuse("--plugin-path", text, "a list of folders, as in --plugin-path build:/opt/swarm");
               append_folders(text, plugin_path);
             });
  add_controller_option(app, scripts);
}

void add_kind_options(CLI::App& app, KindSources& sources) {
  add_kind_options(app, sources.plugin_path, sources.scripts);
}

engine::Registry registry_with(const KindSources& sources) {
  engine::Registry registry = make_registry();
  add_plugins(registry, plugin_path(sources.plugin_path), sources.scripts);
  return registry;
}

std::vector<std::filesystem::path> plugin_path(std::vector<std::filesystem::path> given) {
  append_folders(variable("TROUPE_PLUGIN_PATH"), given);
  append_folders(variable("STAGEPATH"), given);
  return given;
}

SimulationOptions with_environment(SimulationOptions options) {
  append_folders(variable("STAGEPATH"), options.search_path);
  options.plugin_path = plugin_path(std::move(options.plugin_path));
  return options;
}

ResumeOptions resume_options(const WorldCommandOptions& options) {
  const SimulationOptions& simulation = options.simulation;
  return {.threads = simulation.threads,
          .tile_size_m = simulation.tile_size_m,
          .set = simulation.set,
          .across_versions = options.across_versions,
          .plugin_path = plugin_path(simulation.plugin_path),
          .scripts = simulation.scripts,
          .across_plugins = options.across_plugins};
}

}  // namespace troupe::apps
