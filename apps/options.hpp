#pragma once

#include "troupe/simulation.hpp"

#include <charconv>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
class Option;
}  // namespace CLI

/// What the command lines of several commands have in common.
namespace troupe::apps {

/// The whole text as a number, or nothing.
template <class T>
std::optional<T> number(std::string_view text) {
  T value{};
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (fault != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}
std::optional<double> finite(std::string_view text);

/// Throws CLI::ValidationError: `--threads: "many" is not a number of threads, ...`.
[[noreturn]] void refuse(const char* option, std::string_view text, std::string_view expected);
/// The name of a file to write; others are refused.
std::filesystem::path file_name(const char* option, const std::string& text);
/// A time in seconds, above 0; `what` it is, for people: "a real time".
double positive_seconds(const char* option, const std::string& text, std::string_view what);
inline constexpr double k_most_seconds = 1e9;  ///< of a period, as in a world's `record`

/// What --threads and --tile-size take, in every command; others are refused.
unsigned thread_count(std::string_view text);
double tile_size_m(std::string_view text);

/// An option with one value of our own parsing: CLI11's conversions take hexadecimal, nan, and texts for
/// numbers.
CLI::Option* add_value(CLI::App& app, const char* name, const char* value, const char* help,
                       const std::function<void(const std::string&)>& set);
/// The same for an option that may be repeated.
CLI::Option* add_values(CLI::App& app, const char* name, const char* value, const char* help,
                        const std::function<void(const std::string&)>& add);

/// What says which run it is: the world, and everything that changes its results; and when it ends.
struct WorldOptions {
  std::filesystem::path world;
  bool is_checkpoint = false;  ///< `world` is one
  SimulationOptions simulation;
  std::optional<double> for_s;  ///< end on the world's clock, s
};
/// Adds WORLD and add_run_settings(); `options` must outlive `app`.
void add_world_options(CLI::App& app, WorldOptions& options);
/// Adds --for, --seed, --raytracer, --robots, --set, --plugin-path and --simd.
void add_run_settings(CLI::App& app, WorldOptions& options);
/// Of these, what a run that is resumed takes too.
void add_end_option(CLI::App& app, WorldOptions& options);
void add_set_option(CLI::App& app, const char* help, std::vector<std::pair<std::string, std::string>>& set);

/// Where the run ends, s: --for, else where the world asks to. Throws InputError when neither says so.
double end_of(const WorldOptions& options, const Simulation& simulation);
/// Adds --simd, which is obeyed in the whole process as soon as it is read.
void add_simd_option(CLI::App& app);
/// Has kernels run on the instruction set that TROUPE_SIMD names, if it names one. Throws InputError.
void obey_simd_variable();
/// Adds --plugin-path, which adds to `path`; that must outlive `app`.
void add_plugin_path_option(CLI::App& app, std::vector<std::filesystem::path>& path);
/// The folders given, then those of TROUPE_PLUGIN_PATH, then those of STAGEPATH, where Stage's users have
/// theirs.
std::vector<std::filesystem::path> plugin_path(std::vector<std::filesystem::path> given);
/// The options with the folders that the environment names: those of STAGEPATH for worlds, as Stage's users
/// have them, and plugin_path().
SimulationOptions with_environment(SimulationOptions options);

}  // namespace troupe::apps
