#include "apps/check/check_options.hpp"
#include "apps/command_line.hpp"
#include "apps/run/run_options.hpp"
#include "apps/sweep/sweep.hpp"
#include "apps/view_command.hpp"
#include "tests/fuzz/targets.hpp"
#include "tests/support/paths.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <unistd.h>

#include <algorithm>
#include <any>
#include <cctype>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr double k_wall_s = 0.2;
constexpr double k_for_s = 0.3;
constexpr std::size_t k_most_robots = 30;
constexpr std::size_t k_most_arguments = 40;

std::string content(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// All files and folders in a folder, {path relative to it: content of the file}; a folder has no content.
using Tree = std::map<std::string, std::optional<std::string>>;

int run_program(const std::vector<std::string>& arguments,
                const std::function<void(const std::any&)>& limit) {
  std::vector<const char*> argv{"troupe"};
  for (const std::string& argument : arguments) argv.push_back(argument.c_str());
  return apps::run_command_line(static_cast<int>(argv.size()), argv.data(), limit);
}

/// The folder in which all command lines are run. The process makes it once and removes it at its end. It is
/// the working folder from enter() to leave().
class Scratch {
 public:
  Scratch() {
    std::string name = (fs::temp_directory_path() / "troupe-fuzz-command-XXXXXX").string();
    if (!mkdtemp(name.data())) std::abort();
    folder_ = name;
    // Some commands replace the process by an interpreter of Python, and the target would end silently.
    setenv("TROUPE_PYTHON", "/dev/null", 1);  // NOLINT(concurrency-mt-unsafe): before any thread exists
    enter();
    const fs::path files = test::source_dir() / "tests/fuzz/files";
    for (const char* file : {"study_room.json", "room.world", "gate.pgm"}) fs::copy_file(files / file, file);
    fs::rename("study_room.json", "room.json");
    std::ofstream("study.json") << R"({"troupe_study": 1, "world": "room.json", "for_s": 0.2, "seeds": [1, 2],
      "parameters": [{"set": "/populations/0/count", "values": [2, 3]}], "measures": ["stalls"]})";
    std::vector<std::string> run{"run",      "room.json",  "--for",     "0.5",        "--threads",
                                 "1",        "--hash-log", "a.log",     "--measures", "m.csv",
                                 "--events", "e.csv",      "--profile", "p.json"};
    if (worldio::has_hdf5())
      for (const char* more : {"--record", "run.h5", "--checkpoint", "c.h5"}) run.emplace_back(more);
    if (run_program(run, nullptr) != 0) std::abort();
    fs::copy_file("a.log", "b.log");
    fs::create_directory("folder");
    before_ = tree();
    leave();
  }
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  void enter() {
    outside_ = fs::current_path();
    fs::current_path(folder_);
  }
  void leave() const { fs::current_path(outside_); }

  bool is_unchanged() const { return tree() == before_; }
  bool has_partial() const {
    return std::ranges::any_of(
        tree(), [](const auto& entry) { return entry.first.find(".partial") != std::string::npos; });
  }
  /// Restores the files that the constructor made, and removes all others.
  void restore() const {
    for (const auto& entry : fs::directory_iterator(folder_)) fs::remove_all(entry.path());
    for (const auto& [name, text] : before_) {
      if (text)
        std::ofstream(folder_ / name, std::ios::binary) << *text;
      else
        fs::create_directory(folder_ / name);
    }
  }

 private:
  Tree tree() const {
    Tree all;
    for (const auto& entry : fs::recursive_directory_iterator(folder_))
      all.emplace(entry.path().lexically_relative(folder_).string(),
                  entry.is_directory() ? std::nullopt : std::optional(content(entry.path())));
    return all;
  }

  fs::path folder_;
  fs::path outside_;
  Tree before_;
};

/// Whether an argument could name a file outside the working folder. Arguments such as `--set=/a/b=1` and
/// `--part=1/2` are allowed: even if they were taken as file names, these names would be relative paths.
bool may_leave_folder(const std::string& argument) {
  if (argument.find("..") != argument.npos) return true;
  if (argument.starts_with("--part=")) return false;
  if (!argument.starts_with("--set=")) return argument.find('/') != argument.npos;
  // The value of a setting could be the name of an output file: it must not contain a slash or a backslash,
  // with which JSON can escape a slash.
  const std::size_t equals = argument.find('=', std::string_view("--set=").size());
  return equals != argument.npos && argument.find_first_of("/\\", equals) != argument.npos;
}

/// Whether the value of a setting could make a world large: whether it has more than three successive digits
/// or an exponent.
bool may_be_large(const std::string& value) {
  std::size_t digits = 0;
  for (const char c : value) {
    const bool is_digit = std::isdigit(static_cast<unsigned char>(c)) != 0;
    if (digits > 0 && (c == 'e' || c == 'E')) return true;
    digits = is_digit ? digits + 1 : 0;
    if (digits > 3) return true;
  }
  return false;
}

void limit_world(apps::WorldCommandOptions& options) {
  SimulationOptions& simulation = options.simulation;
  simulation.threads = std::clamp(simulation.threads, 1u, 2u);
  for (auto& [population, count] : simulation.robots) count = std::min(count, k_most_robots);
  std::erase_if(simulation.set, [](const auto& set) { return may_be_large(set.second); });
}

void limit_run(apps::RunOptions& options) {
  limit_world(options);
  options.wall_limit_s = std::min(options.wall_limit_s.value_or(k_wall_s), k_wall_s);
  if (options.rate > 0) options.rate = std::max(options.rate, 10.0);
  if (options.worlds.size() > 3) options.worlds.resize(3);
}

/// Makes `troupe view` end at once, without waiting for a viewer.
void limit_view(apps::ViewOptions& options) {
  limit_world(options);
  options.for_s = 0;
  options.port = 0;
  options.bind.clear();
  options.open = false;
}

void limit_check(apps::CheckOptions& check) {
  limit_world(check);
  check.for_s = std::min(check.for_s.value_or(k_for_s), k_for_s);
  std::erase_if(check.simulation.set, [](const auto& set) { return set.first.starts_with("/tick"); });
  if (check.threads.size() > 2) check.threads.resize(2);
  for (unsigned& threads : check.threads) threads = std::min(threads, 3u);
  if (check.tile_sizes_m.size() > 2) check.tile_sizes_m.resize(2);
}

/// The options as those of one command, or null if they are those of another command.
template <class Options>
Options* as(const std::any& options) {
  auto* const* found = std::any_cast<Options*>(&options);
  return found ? *found : nullptr;
}

/// Limits the options so that runs are short, worlds small, and threads few.
void limit(const std::any& options) {
  if (auto* run = as<apps::RunOptions>(options)) limit_run(*run);
  if (auto* view = as<apps::ViewOptions>(options)) limit_view(*view);
  if (auto* check = as<apps::CheckOptions>(options)) limit_check(*check);
  if (auto* sweep = as<apps::SweepOptions>(options))
    sweep->runs_at_once = std::clamp(sweep->runs_at_once, 1u, 2u);
}

std::vector<std::string> arguments_of(std::string_view text) {
  std::vector<std::string> arguments;
  while (!text.empty() && arguments.size() < k_most_arguments) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string argument(text.substr(0, end));
    argument.resize(std::min(argument.find('\0'), argument.size()));
    if (!may_leave_folder(argument)) arguments.push_back(std::move(argument));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return arguments;
}

}  // namespace

void run_command(std::string_view arguments) {
  static Scratch scratch;
  const auto on_interrupt = std::signal(SIGINT, SIG_DFL);
  const auto on_terminate = std::signal(SIGTERM, SIG_DFL);
  const auto on_hangup = std::signal(SIGHUP, SIG_DFL);
  scratch.enter();
  const int code = run_program(arguments_of(arguments), limit);
  scratch.leave();
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_terminate);
  std::signal(SIGHUP, on_hangup);
  if (code < 0 || code > 3) std::abort();
  if (scratch.has_partial()) std::abort();
  if (scratch.is_unchanged()) return;
  if (code == 2) std::abort();
  scratch.restore();
}

}  // namespace troupe::fuzz
