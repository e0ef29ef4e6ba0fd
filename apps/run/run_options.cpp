#include "apps/run/run_options.hpp"

#include "apps/pictures/picture_options.hpp"
#include "engine/watch_spec.hpp"
#include "worldio/json/spec_json.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::apps {
namespace {

constexpr const char* k_run_footer = R"(
The end: --for S is a time on the world's clock, counted from tick 0; it beats the world's quit_time, and one of the
two must be given. The run ends with the first tick whose time is S or later.

--session repeats a session of troupe view: its acts are done at their ticks. Without --for the run ends where the
session did. A session of another run, of which the first line tells, is refused; so is an act that cannot be done.

Several worlds run side by side, each to its own end: the one whose next tick comes first goes next. All are loaded
before any begins, and none changes another. Outputs have {world} in their names then, which stands for the world's
name: --hash-log {world}.log. The summaries follow one another, with --json a line each.

A run is as fast as it can be. --rate 1 holds it back to real time, --rate world to what the world asks for (speedup).

Outputs are checked before the first tick. Errors and warnings name the file and line: maze.world:41: error: ...
The result depends on the world, --seed, --raytracer, --robots and --set alone: not on --threads, --tile-size or --simd.

A checkpoint holds the state and the whole world; troupe resume needs nothing else to go on, with the same bits as a run
that never stopped. It is written beside its name and renamed when it is whole: whenever the program is killed, the last
one is there. One that exists is refused without --force.

Exit codes: 0 finished; 1 failed; 2 bad input or usage, nothing written; 3 stopped early by Ctrl-C, SIGTERM or
--wall-limit: the tick is finished, and the summary and all files are written, the checkpoint among them.
)";

constexpr const char* k_run_examples = R"(
Examples:
  troupe run worlds/hospital.json --for 60 --snapshot hospital.png
  troupe run worlds/cave-simple.json --for 60 --snapshot cave-{time}.png --snapshot-at 0,60 --camera perspective
  troupe run worlds/cave-complex-laser.json --for 60 --film cave.mp4 --film-speed 4 --layers scans,-grid
  troupe run worlds/hospital.json --for 60 --robots 500 --seed 7
  troupe run worlds/cave-simple.json --for 10 --set /populations/0/count=20 --json
  troupe run worlds/minimal.world --for 30 --threads 1 --hash-log minimal.log
  troupe run worlds/hospital.json --for 3600 --checkpoint day.h5 --checkpoint-every 60 --wall-limit 7000
  troupe run worlds/hospital.json --for 60 --measures m.csv --measure coverage,stalls --measure-every 0.5
  troupe run worlds/camera.world --for 5 --camera-png pictures --camera-every 0.5
  troupe run worlds/hospital.json --for 600 --record run.h5 --record-every 1 --record-fields pose,stall
  troupe run apps/examples/plugin/room.json --for 60 --plugin-path build
  troupe run worlds/minimal.world --for 60 --rate 1 --clock
  troupe run worlds/minimal.world worlds/crowd.json --for 10 --hash-log {world}.log)";

std::string resume_footer() {
  std::string changeable(worldio::k_changeable);
  for (std::size_t at = 0; (at = changeable.find("; ", at)) != changeable.npos;)
    changeable.replace(at, 2, ";\n  ");
  return fmt::format(R"(
Goes on where the checkpoint was saved, with the same bits as a run that never stopped, on any number of threads and
without the world's own files. --for S is a time on the world's clock, counted from tick 0 as in troupe run. Outputs are
those of run. A hash log, a recording or a table that is there already goes on behind the checkpoint's tick, without a
gap or a repeat; another one begins at it. The checkpoint may be written again under its own name without --force.

--set changes what keeps the shape of the state, from here on; h5dump -d /world CHECKPOINT shows the stored world:
  {}

A file that is no checkpoint, was cut off, is damaged, or comes from a newer version is refused with the reason.

Exit codes: those of troupe run.

Examples:
  troupe run worlds/hospital.json --for 60 --checkpoint h.h5 --wall-limit 10
  troupe resume h.h5 --for 60
  troupe resume h.h5 --for 120 --threads 1 --checkpoint h.h5 --checkpoint-every 10
  troupe resume h.h5 --for 120 --set /types/1/drive/params/velocity_max_x_mps=0.2)",
                     changeable);
}

/// How a world is run, and what comes out of it: what `run` and `resume` share.
void add_output_options(CLI::App& app, RunOptions& options) {
  add_value(app, "--threads", "N", "Worker threads (default: one for each processor it may use)",
            [&options](const std::string& text) { options.simulation.threads = thread_count(text); });
  add_value(app, "--tile-size", "M", "Edge of the tiles that threads share out, m (default: chosen)",
            [&options](const std::string& text) { options.simulation.tile_size_m = tile_size_m(text); });
  options.outputs.add_options(app, options);
  const auto add_switch = [&app](const char* name, bool& on, const char* help) {
    app.add_flag(name, on, help)->disable_flag_override();
  };
  add_switch("--force", options.force, "Replace a checkpoint or a recording that is there already");
  add_switch("--json", options.json,
             "Print the summary as one flat JSON object, and nothing else, on stdout");
  add_switch("--quiet", options.quiet, "Print errors only (and the JSON that --json asks for)");
}

void add_session_option(CLI::App& app, RunOptions& options) {
  add_value(app, "--session", "FILE.jsonl",
            "Repeat what was done to the world in a session of troupe view, to the same bits (docs/live.md)",
            [&options](const std::string& text) { options.session = text; });
}

/// What the wall clock has to do with it.
void add_clock_options(CLI::App& app, RunOptions& options) {
  add_value(app, "--rate", "R|world",
            "Not faster than R times real time; world: than its speedup (default: as fast as possible)",
            [&options](const std::string& text) {
              constexpr double k_least = 0.001;
              const std::optional<double> rate = finite(text);
              options.world_rate = text == "world";
              if (!options.world_rate && (!rate || *rate < k_least || *rate > engine::k_most_rate))
                refuse("--rate", text,
                       fmt::format("a rate from {} to {:g}, times real time, or world", k_least,
                                   engine::k_most_rate));
              options.rate = rate.value_or(0);
            });
  app.add_flag("--clock", options.clock,
               "Tell the time on the way, a line every 100 ticks, or as often as the world says")
      ->disable_flag_override();
}

}  // namespace

std::string with_world(std::string name, const std::filesystem::path& world) {
  const std::string stem = world.stem().string();
  for (std::size_t at = 0; (at = name.find(k_world_mark, at)) != name.npos; at += stem.size())
    name.replace(at, k_world_mark.size(), stem);
  return name;
}

void add_run_options(CLI::App& run, RunOptions& options) {
  run.footer(fmt::format("{}\n{}{}", k_run_footer, picture_help(), k_run_examples));
  run.add_option_function<std::vector<std::string>>(
         "WORLD",
         [&options](const std::vector<std::string>& names) {
           options.worlds.assign(names.begin(), names.end());
         },
         "World files: Stage's .world, or .json; several run side by side")
      ->option_text("...")
      ->required();
  add_run_settings(run, options);
  add_session_option(run, options);
  add_clock_options(run, options);
  add_output_options(run, options);
}

void add_resume_options(CLI::App& resume, RunOptions& options) {
  resume.footer(resume_footer());
  options.is_checkpoint = true;
  resume
      .add_option_function<std::string>(
          "CHECKPOINT", [&options](const std::string& text) { options.worlds = {text}; },
          "Checkpoint of a run: troupe run --checkpoint")
      ->option_text(" ")
      ->required();
  add_end_option(resume, options);
  add_set_option(resume, "Change a value of the stored world: a JSON pointer into it; repeatable",
                 options.simulation.set);
  resume
      .add_flag("--across-versions", options.across_versions,
                "Though another version of Troupe wrote the checkpoint")
      ->disable_flag_override();
  add_plugin_path_option(resume, options.simulation.plugin_path);
  add_simd_option(resume);
  resume
      .add_flag("--across-plugins", options.across_plugins,
                "Though its plug-ins have been rebuilt since it was written")
      ->disable_flag_override();
  add_session_option(resume, options);
  add_clock_options(resume, options);
  add_output_options(resume, options);
}

}  // namespace troupe::apps
