#include "apps/lint.hpp"

#include "apps/numbers.hpp"
#include "apps/options.hpp"
#include "troupe/lint.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

namespace troupe::apps {
namespace {

constexpr const char* k_lint_footer = R"(
Reports likely mistakes in a world: bodies that overlap at the start, robots in walls, sensors that can never detect
anything or never run, floor plans that block no robot, robots that can never drive, never stand still or never reach
their goals, power contacts that exchange no energy, colours that LEDs hide, unused types and macros, properties,
interventions and faults without effect, conditions with other parameters than a listed measure, and all warnings of
loading. Each finding is one line with file and line number: maze.world:41: warning: ...

Exit codes: 0 nothing found; 1 findings; 2 the world cannot be loaded, or its measures or its recording have errors
(errors on standard error).

Examples:
  troupe lint worlds/hospital.json
  troupe lint worlds/minimal.world
  troupe lint worlds/crowd.json --set /populations/0/count=5000
  troupe lint room.json --controller my.py)";

}  // namespace

void add_lint_options(CLI::App& lint, LintOptions& options) {
  lint.footer(k_lint_footer);
  add_argument(lint, "WORLD", "World file: Stage's .world, or .json", options.world);
  add_set_option(lint, options.set);
  add_kind_options(lint, options.sources);
}

ExitCode lint_world(const LintOptions& options) {
  const std::filesystem::path& world = options.world;
  SimulationOptions simulation;
  simulation.set = options.set;
  simulation.plugin_path = options.sources.plugin_path;
  simulation.scripts = options.sources.scripts;
  const std::vector<std::string> findings = lint(world, with_environment(std::move(simulation)));
  for (const std::string& finding : findings) fmt::print("{}\n", finding);
  if (findings.empty())
    fmt::print("{}: nothing found\n", world.string());
  else
    fmt::print("{}: {}\n", world.string(), counted(findings.size(), "finding"));
  return findings.empty() ? k_finished : k_failed;
}

}  // namespace troupe::apps
