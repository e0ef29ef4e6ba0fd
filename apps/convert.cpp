#include "apps/convert.hpp"

#include "apps/messages.hpp"
#include "apps/numbers.hpp"
#include "apps/outputs.hpp"
#include "troupe/input_files.hpp"
#include "troupe/plugins.hpp"
#include "troupe/registry.hpp"
#include "worldio/convert.hpp"
#include "worldio/load.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <string>
#include <system_error>
#include <vector>

namespace troupe::apps {
namespace {

constexpr const char* k_convert_footer = R"(
Reads the world IN and writes it as OUT. The endings of the file names select the formats: .world is Stage's syntax,
.json the format of docs/world-format.md. A run of OUT gives the same hash log as a run of IN, unless a warning says
that the hash logs may differ.

JSON can express every .world file: macros and included files are expanded, bitmaps remain names of image files, and all
values are in SI units. If OUT is a .world file, a feature of IN that Stage's syntax cannot express is an error, and
nothing is written. If both files are .json, OUT has a normal form, which lists the bodies of each population one by
one.

A controller that IN names may be a class of a script given by --controller. Other classes of the script are not written
to OUT: they control the robots of OUT if a run of OUT also has the option --controller.

Exit codes: 0 written; 2 the world cannot be loaded or expressed in the format of OUT, or OUT exists or is not writable.

Examples:
  troupe convert worlds/minimal.world minimal.json
  troupe convert cave.world cave.json --force --set /models/3/pose/x_m=2
  troupe convert robots.json robots.world
  troupe convert room.world room.json --controller my.py)";

/// Throws OutputError if OUT cannot be written, or exists and --force is not given.
void check(const ConvertOptions& options) {
  check_outputs({{options.in, "the world"}}, {options.out});
  if (!options.force) refuse_existing(options.out);
}

/// Throws OutputError if OUT exists and is one of the files that IN was read from. world: the world that IN
/// describes
void check_inputs(const ConvertOptions& options, const engine::WorldSpec& world) {
  std::error_code ignored;
  if (!std::filesystem::exists(options.out, ignored)) return;
  std::vector<Input> inputs;
  for (const std::filesystem::path& file : input_files(world))
    inputs.push_back({file, "a file of the world"});
  check_outputs(inputs, {options.out});
}

}  // namespace

void add_convert_options(CLI::App& command, ConvertOptions& options) {
  command.footer(k_convert_footer);
  add_argument(command, "IN", "World file: Stage's .world, or .json", options.in);
  add_argument(command, "OUT", "World file to write; its ending, .world or .json, selects the format",
               options.out);
  add_switch(command, "--force", options.force, "Replace an existing file");
  add_set_option(command, options.set);
  add_kind_options(command, options.sources);
}

ExitCode convert(const ConvertOptions& options) {
  check(options);
  engine::Registry registry = make_registry();
  const auto plugins =
      add_plugins(registry, plugin_path(options.sources.plugin_path), options.sources.scripts);
  worldio::LoadOptions load;
  load.set = options.set;
  load.search_path = with_environment({}).search_path;
  Diagnostics diagnostics;
  const worldio::ConvertedWorld world = worldio::convert_world(
      options.in, options.out, registry, load, diagnostics,
      // The conversion also reads OUT, to compare it with IN, so the files of IN are looked up before.
      [&](const engine::WorldSpec& loaded) { check_inputs(options, loaded); });
  diagnostics.throw_if_errors();
  print_lines(diagnostics.warnings());
  print_lines(plugins->warnings());
  write_output(options.out, {world.text});
  print("{}: {} of {}, from {}\n", options.out.string(), counted(world.bodies, "model"),
        counted(world.types, "type"), options.in.string());
  return k_finished;
}

}  // namespace troupe::apps
