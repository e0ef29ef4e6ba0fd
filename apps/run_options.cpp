#include "apps/run_options.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <string>
#include <string_view>

namespace troupe::apps {
namespace {

// Longer than the age of the universe, and ticks of a microsecond still count in 64 bits.
constexpr double k_max_seconds = 1e12;
constexpr unsigned k_max_threads = 1024;
// What OSMesa draws at most.
constexpr int k_max_pixels = 16384;

constexpr const char* k_footer = R"(
The end: --for S is a time on the world's clock, counted from tick 0; it beats the world's quit_time, and one of the
two must be given. The run ends with the first tick whose time is S or later.

Outputs are checked before the first tick. Errors and warnings name the file and line: maze.world:41: error: ...
The result depends on the world, --seed, --raytracer, --robots and --set alone: not on --threads or --tile-size.

Exit codes: 0 finished; 1 failed; 2 bad input or usage, nothing written; 3 stopped early by Ctrl-C or SIGTERM: the
tick is finished, and the summary and all files are written.

Examples:
  troupe run worlds/hospital.json --for 60 --snapshot hospital.png
  troupe run worlds/hospital.json --for 60 --robots 500 --seed 7
  troupe run worlds/cave-simple.json --for 10 --set /populations/0/count=20 --json
  troupe run worlds/minimal.world --for 30 --threads 1 --hash-log minimal.log)";

/// The whole text as a number, or nothing.
template <class T>
std::optional<T> number(std::string_view text) {
  T value{};
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (fault != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<double> finite(std::string_view text) {
  const auto value = number<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

[[noreturn]] void refuse(const char* option, std::string_view text, std::string_view expected) {
  throw CLI::ValidationError(option, fmt::format("\"{}\" is not {}", text, expected));
}

/// An option with one value of our own parsing: CLI11's conversions take hexadecimal, nan, and texts for
/// numbers.
CLI::Option* add_value(CLI::App& app, const char* name, const char* value, const char* help,
                       const std::function<void(const std::string&)>& set) {
  return app.add_option_function<std::string>(name, set, help)->option_text(value);
}

/// The same for an option that may be repeated.
CLI::Option* add_values(CLI::App& app, const char* name, const char* value, const char* help,
                        const std::function<void(const std::string&)>& add) {
  const auto add_all = [add](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) add(text);
  };
  return app.add_option_function<std::vector<std::string>>(name, add_all, help)
      ->option_text(value)
      ->allow_extra_args(false);
}

std::pair<std::string, std::size_t> population_size(const std::string& text) {
  const auto equals = text.rfind('=');
  const auto count = number<std::size_t>(text.substr(equals == text.npos ? 0 : equals + 1));
  if (!count || equals == 0)
    refuse("--robots", text,
           "a number of robots, as in --robots 500, or --robots NAME=500 for one population");
  return {equals == text.npos ? "" : text.substr(0, equals), *count};
}

std::pair<std::string, std::string> assignment(const std::string& text) {
  const auto equals = text.find('=');
  if (!text.starts_with('/') || equals == text.npos)
    refuse("--set", text, "a JSON pointer and a value, as in --set /populations/0/count=500");
  return {text.substr(0, equals), text.substr(equals + 1)};
}

void set_picture_size(RunOptions& options, const std::string& text) {
  const auto cross = text.find('x');
  const auto width = number<int>(text.substr(0, cross));
  const auto height = cross == text.npos ? std::nullopt : number<int>(text.substr(cross + 1));
  const auto good = [](std::optional<int> n) { return n && *n >= 1 && *n <= k_max_pixels; };
  if (!good(width) || !good(height))
    refuse("--size", text,
           fmt::format("a width and a height in pixels, 1 to {} each, as in --size 1280x720", k_max_pixels));
  options.width = *width;
  options.height = *height;
}

void set_profile_ticks(RunOptions& options, const std::string& text) {
  const auto colon = text.find(':');
  const auto first = number<std::uint64_t>(text.substr(0, colon));
  const auto last = colon == text.npos ? std::nullopt : number<std::uint64_t>(text.substr(colon + 1));
  if (!first || !last || *first < 1 || *first > *last)
    refuse("--profile-ticks", text, "a first and a last tick, counted from 1, as in --profile-ticks 100:120");
  options.profile_limits.first_tick = *first;
  options.profile_limits.last_tick = *last;
}

}  // namespace

CLI::App* add_run_command(CLI::App& app, RunOptions& options) {
  CLI::App* run = app.add_subcommand("run", "Run a world and tell how it went");
  run->footer(k_footer);

  run->add_option_function<std::string>(
         "WORLD", [&options](const std::string& text) { options.world = text; },
         "World file: Stage's .world, or .json")
      ->option_text(" ")
      ->required();
  add_value(*run, "--for", "S", "End at S seconds on the world's clock", [&options](const std::string& text) {
    options.for_s = finite(text);
    if (!options.for_s || *options.for_s < 0 || *options.for_s > k_max_seconds)
      refuse("--for", text, fmt::format("a time in seconds, from 0 to {:g}", k_max_seconds));
  });
  add_value(*run, "--threads", "N", "Worker threads (default: one for each core)",
            [&options](const std::string& text) {
              const auto threads = number<unsigned>(text);
              if (!threads || *threads < 1 || *threads > k_max_threads)
                refuse("--threads", text, fmt::format("a number of threads, 1 to {}", k_max_threads));
              options.simulation.threads = *threads;
            });
  add_value(*run, "--seed", "N", "Seed of every random stream (default: the world's, else 1)",
            [&options](const std::string& text) {
              options.simulation.seed = number<std::uint64_t>(text);
              if (!options.simulation.seed) refuse("--seed", text, "a whole number from 0 to 2^64 - 1");
            });
  add_value(*run, "--raytracer", "exact|grid", "What finds ranges (default: the world's, else exact)",
            [&options](const std::string& text) {
              const auto& names = engine::k_ranging_engines;
              const auto found = std::ranges::find(names, text);
              if (found == names.end()) refuse("--raytracer", text, "exact or grid");
              options.simulation.ranging = static_cast<RangingEngine>(found - names.begin());
            });
  add_values(
      *run, "--robots", "[NAME=]N", "Size of the world's only population, or of population NAME; repeatable",
      [&options](const std::string& text) { options.simulation.robots.push_back(population_size(text)); });
  add_values(*run, "--set", "POINTER=VALUE",
             "Change a value of the world: a JSON pointer into it; repeatable",
             [&options](const std::string& text) { options.simulation.set.push_back(assignment(text)); });
  add_value(*run, "--tile-size", "M", "Edge of the tiles that threads share out, m (default: chosen)",
            [&options](const std::string& text) {
              const auto size = finite(text);
              if (!size || *size <= 0)
                refuse("--tile-size", text,
                       "a length in metres, above 0 (tiles are never smaller than the cells they hold)");
              options.simulation.tile_size_m = *size;
            });
  add_value(*run, "--hash-log", "FILE", "Write the hash of the state, a line a tick, from tick 0",
            [&options](const std::string& text) {
              if (text.empty() || text.starts_with('-')) refuse("--hash-log", text, "a file name");
              options.hash_log = text;
            });
  CLI::Option* snapshot =
      add_value(*run, "--snapshot", "FILE.png", "Draw the last tick from above into a PNG",
                [&options](const std::string& text) {
                  options.snapshot = text;
                  if (options.snapshot.extension() != ".png" || text.starts_with('-'))
                    refuse("--snapshot", text, "the name of a picture, as in --snapshot crowd.png");
                });
  add_value(*run, "--size", "WxH", "Size of that picture in pixels (default: 1280x720)",
            [&options](const std::string& text) { set_picture_size(options, text); })
      ->needs(snapshot);
  CLI::Option* profile =
      add_value(*run, "--profile", "FILE.json", "Write where the time goes, for a browser's trace viewer",
                [&options](const std::string& text) {
                  options.profile = text;
                  if (options.profile.extension() != ".json" || text.starts_with('-'))
                    refuse("--profile", text, "the name of a JSON file, as in --profile trace.json");
                });
  add_value(*run, "--profile-ticks", "A:B",
            "Only ticks A to B of it (default: all, while the file stays small)",
            [&options](const std::string& text) { set_profile_ticks(options, text); })
      ->needs(profile);
  const auto add_switch = [run](const char* name, bool& on, const char* help) {
    run->add_flag(name, on, help)->disable_flag_override();
  };
  add_switch("--json", options.json,
             "Print the summary as one flat JSON object, and nothing else, on stdout");
  add_switch("--quiet", options.quiet, "Print errors only (and the JSON that --json asks for)");
  return run;
}

}  // namespace troupe::apps
