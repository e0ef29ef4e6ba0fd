#include "perf/paper_children.hpp"

#include "base/diagnostics.hpp"
#include "engine/spec/ticks.hpp"
#include "engine/world/world.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <fstream>
#include <stdexcept>

namespace troupe::perf {
namespace {

using Clock = std::chrono::steady_clock;

/// Returns the value, in bytes, of the line of /proc/self/status with this name, such as
/// `VmRSS:   12345 kB`. Throws std::runtime_error if there is no such line.
double status_bytes(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(name + ":")) return 1024 * std::stod(line.substr(name.size() + 1));
  throw std::runtime_error(
      fmt::format("the memory of the process is unknown: /proc/self/status has no {}", name));
}

/// Runs this program with these arguments in a child process and returns its standard output. Throws
/// std::runtime_error if the child cannot be started or fails.
std::string run_self(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "perf_paper");
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) throw std::runtime_error("cannot create a pipe to a child process");
  const pid_t process = fork();
  if (process < 0) throw std::runtime_error("cannot create a child process");
  if (process == 0) {
    dup2(ends[1], STDOUT_FILENO);
    close(ends[0]);
    close(ends[1]);
    execv("/proc/self/exe", argv.data());
    _exit(127);
  }
  close(ends[1]);
  std::string text;
  std::array<char, 4096> buffer;
  for (ssize_t n; (n = read(ends[0], buffer.data(), buffer.size())) > 0;)
    text.append(buffer.data(), static_cast<std::size_t>(n));
  close(ends[0]);
  int status = 0;
  waitpid(process, &status, 0);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw std::runtime_error(
        "a child process that measures loading and memory failed; its own error, if any, is printed above");
  return text;
}

constexpr std::string_view k_text_types = R"(
define floorplan model
(
  color "gray30"
  ranger_return 0.5
)

define ir sensor
(
  range [ 0 2 ]
  fov 30
  samples 1
)

define minibot position
(
  size [ 0.1 0.1 0.1 ]
  drive "diff"
  velocity_bounds [ -1 1 0 0 0 0 -90 90 ]
  color "random"
  ctrl "expand_swarm"
  ranger
  (
    pose [ 0 0 -0.04 0 ]
    size [ 0.01 0.01 0.01 ]
)";

}  // namespace

void report_child(const Scene& scene, const engine::Registry& registry) {
  const auto start = Clock::now();
  Diagnostics diagnostics;
  engine::WorldSpec spec = worldio::load_world(scene.world, registry, scene.load, diagnostics);
  diagnostics.throw_if_errors();
  const auto read = Clock::now();
  engine::World world(std::move(spec), registry, {}, diagnostics);
  diagnostics.throw_if_errors();
  const auto built = Clock::now();
  const std::uint64_t ticks = engine::ticks_until(scene.for_s, world.view().tick_s());
  while (world.tick() < ticks) world.step();

  nlohmann::json json;
  json["robots"] = world.robots();
  json["read_s"] = std::chrono::duration<double>(read - start).count();
  json["build_s"] = std::chrono::duration<double>(built - read).count();
  json["rss_bytes"] = status_bytes("VmRSS");
  json["peak_bytes"] = status_bytes("VmHWM");
  json["tick"] = world.tick();
  json["hash"] = world.hashes().state;
  fmt::print("{}\n", json.dump());
}

ChildTiming time_child(const Child& child, const std::vector<std::string>& arguments, std::size_t repeat) {
  ChildTiming timing{child, {}};
  for (std::size_t i = 0; i < repeat; ++i) {
    const nlohmann::json json = nlohmann::json::parse(run_self(arguments));
    timing.reports.push_back({json.at("robots"), json.at("read_s"), json.at("build_s"), json.at("rss_bytes"),
                              json.at("peak_bytes"), json.at("tick"), json.at("hash")});
  }
  return timing;
}

void write_as_text(const Scene& scene, const std::filesystem::path& file, const engine::Registry& registry) {
  Diagnostics diagnostics;
  const engine::WorldSpec spec = worldio::load_world(scene.world, registry, scene.load, diagnostics);
  diagnostics.throw_if_errors();
  std::string text(k_text_types);
  for (int i = 0; i < 12; ++i) text += fmt::format("    ir( pose [ 0 0 0 {} ] )\n", 30 * i);
  text += fmt::format("  )\n)\n\nfloorplan( name \"hospital\" size [ 140 60 0.5 ] bitmap \"{}\" )\n",
                      std::filesystem::absolute(scene.world.parent_path() / "hospital.png").string());
  std::size_t robots = 0;
  for (const engine::BodySpec& body : spec.bodies) {
    if (!engine::is_mobile(spec.types[body.type.index()])) continue;
    const Pose& pose = body.pose_world_body;
    text += fmt::format("minibot( name \"r{}\" pose [ {} {} 0 {} ] )\n", robots++, pose.x, pose.y,
                        pose.heading / k_pi * 180);
  }
  std::ofstream stream(file, std::ios::binary);
  stream << text << std::flush;
  if (!stream) throw std::runtime_error(fmt::format("{}: error: cannot be written", file.string()));
}

}  // namespace troupe::perf
