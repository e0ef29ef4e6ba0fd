#include "apps/run/run_options.hpp"

#include "apps/pictures/picture_options.hpp"
#include "apps/scripts.hpp"
#include "base/number_text.hpp"
#include "engine/spec/watch_spec.hpp"
#include "worldio/json/spec_json.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::apps {
namespace {

constexpr const char* k_run_footer = R"(
End: --for S is a simulated time in seconds, counted from tick 0. It overrides the quit_time of the world;
one of the two must be given. The run ends with the first tick whose time is S or later. To allow for rounding, the
time may be earlier by one billionth of a tick or of S, but not by more than half a tick: --for 0.7 ends at tick 7 of
0.1 s, and --for 1e-10 at tick 0.

--session repeats a session of troupe view: the actions of its users (moving, removing or steering robots) are applied
at the same ticks as in the session. Without --for the run ends at the tick at which the session ended. The program
exits with an error if the world, the seed or the options in the first line of the session file differ from those of
this run, or if an action is not possible.

--view prints the address of a web page in which users can watch, pause and change the run, as with troupe view. Their
actions are written to a session file in the working folder.

Several worlds run side by side, each to its own end, and do not interact. All worlds are loaded before the first tick.
The world whose next tick ends at the earliest simulated time always makes its tick first. With several worlds, the
names of outputs must contain {world}, which is replaced by the name of the world: --hash-log {world}.log. A summary is
printed for each world; with --json, each summary is one line.

A run is as fast as possible by default. --rate 1 limits it to real time, and --rate world to the speed that the world
file sets (rate in JSON, speedup in Stage's syntax).

Before the first tick, the program checks that all outputs can be written. Errors and warnings name the file and the
line, as in maze.world:41: error: ...
Results depend only on the world, --seed, --raytracer, --robots, --spare, --set, --controller, --session, and what users
do with --view. They do not depend on --threads, --ranks, --tile-size or --simd.

With --ranks N, this process runs N ranks, each on threads of its own. A rank computes a part of the robots and
exchanges messages with the other ranks. It has all robots of the world or, with --distribute, only its own and those
near them. --ranks is for testing a world before it runs on several processes (docs/cluster.md); on one computer,
--threads is faster.

--dry-run loads the world on one rank, checks that the outputs can be written, prints the number of ticks and the memory
of the loaded world, and ends. With --ranks N it also prints how many robots each of N ranks would compute. With
--distribute it also prints how many copies of robots of other ranks each rank would have, and from how many ranks
these copies would come. It computes no tick and writes no file.

A checkpoint contains the state and the world. troupe resume needs no other file and continues with the same bits as an
uninterrupted run. Each checkpoint is written to a temporary file that then replaces the previous checkpoint, so a valid
checkpoint exists even if the program is killed at any time. If the checkpoint file exists before the run, --force is
required. On SIGUSR1 (kill -USR1), a run with --checkpoint saves the checkpoint after the current tick and goes on.

Exit codes: 0 finished; 1 failed; 2 bad input or usage, nothing written; 3 stopped early by Ctrl-C, SIGTERM, SIGHUP
or --wall-limit: the current tick was finished, and the summary and all files, including the checkpoint, were written.
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

/// Returns the text below the options of `resume`, in which the list k_changeable is broken into lines.
std::string resume_footer() {
  std::string changeable(worldio::k_changeable);
  for (const std::string_view end_of_line : {"; ", "/sensors/N/active, "})
    if (const std::size_t at = changeable.find(end_of_line); at != changeable.npos)
      changeable.replace(at + end_of_line.size() - 1, 1, "\n  ");
  return fmt::format(R"(
Continues a run from its checkpoint with the same bits as an uninterrupted run, on any number of threads and without the
files of the world. --for S is a simulated time in seconds, counted from tick 0 as in troupe run. The output options are
those of troupe run. An existing hash log, recording or table is continued after the tick of the checkpoint, without
gaps or repetitions; a new file begins at that tick. --checkpoint may name the checkpoint that is resumed, without
--force. On SIGUSR1, the file of --checkpoint is saved after the current tick, as in troupe run.

--set changes values of the stored world from the tick of the checkpoint on. The command h5dump -d /world CHECKPOINT
prints the stored world. Only values that do not change the layout of the state can be changed:
  {}

The program exits with an error if the file is not a checkpoint, was cut off, is damaged, or was written by another
version of Troupe (unless --across-versions is given).

Exit codes: those of troupe run.

Examples:
  troupe run worlds/hospital.json --for 60 --checkpoint h.h5 --wall-limit 10
  troupe resume h.h5 --for 60
  troupe resume h.h5 --for 120 --threads 1 --checkpoint h.h5 --checkpoint-every 10
  troupe resume h.h5 --for 120 --set /types/2/drive/params/velocity_max_x_mps=0.2)",
                     changeable);
}

/// Adds the options for threads, tile size and outputs, which `run` and `resume` have in common.
void add_output_options(CLI::App& app, RunOptions& options) {
  add_threads_option(app, options, "Worker threads of each rank");
  add_value(app, "--ranks", "N", "Number of ranks: each computes some of the robots (default: 1)",
            [&options](const std::string& text) {
              options.simulation.ranks = rank_count(text);
              options.gives_ranks = true;
            });
  add_value(app, "--tile-size", "M",
            "Edge length of the tiles (squares of the world that threads process), m (default: automatic)",
            [&options](const std::string& text) { options.simulation.tile_size_m = tile_size_m(text); });
  add_distribute_option(app, options);
  add_rank_seed_option(app, options);
  add_value(app, "--rank-balance", "time|off",
            "time: slower ranks give robots to faster ranks; off: speeds have no effect (default: time)",
            [&options](const std::string& text) {
              if (text != "time" && text != "off") refuse("--rank-balance", text, "time or off");
              options.balances_ranks = text == "time";
            })
      ->group("Advanced");
  add_rank_limit_option(app, options.rank_limit_s);
  options.outputs.add_options(app, options);
  add_switch(app, "--force", options.force, "Replace an existing checkpoint or recording");
  add_switch(app, "--json", options.json,
             "Print only the summary, as one flat JSON object, on standard output");
  add_switch(app, "--dry-run", options.dry_run,
             "Load the world and check the outputs, print what the run would need, and end");
  add_switch(app, "--quiet", options.quiet, "Print only errors (and the JSON object of --json)");
  add_switch(app, "--view", options.view, "Show the run in a browser, as troupe view does (docs/live.md)");
}

void add_session_option(CLI::App& app, RunOptions& options) {
  add_value(app, "--session", "FILE.jsonl",
            "Repeat the actions of users that a session file of troupe view contains (docs/live.md)",
            [&options](const std::string& text) { options.session = file_name("--session", text); });
}

/// Adds the options that relate simulated time to real time (--rate, --clock).
void add_clock_options(CLI::App& app, RunOptions& options) {
  add_value(app, "--rate", "R|world",
            "Limit the speed to R times real time; world: the speed in the world file (default: no limit)",
            [&options](const std::string& text) {
              constexpr double k_least = 0.001;
              const std::optional<double> rate = finite_number_of(text);
              options.world_rate = text == "world";
              if (!options.world_rate && (!rate || *rate < k_least || *rate > engine::k_most_rate))
                refuse("--rate", text,
                       fmt::format("a multiple of real time from {} to {}, or the word world", k_least,
                                   engine::k_most_rate));
              options.rate = rate.value_or(0);
            });
  add_switch(app, "--clock", options.clock,
             "Print the simulated time every 100 ticks, or at the interval that the world file sets");
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
         "World files: Stage's .world, or .json; several worlds run side by side")
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
  add_value(resume, "CHECKPOINT", " ", "Checkpoint that troupe run --checkpoint wrote",
            [&options](const std::string& text) { options.worlds = {text}; })
      ->required();
  add_end_option(resume, options);
  add_set_option(resume, options.simulation.set, "stored world");
  add_across_options(resume, options);
  add_kind_options(resume, options.simulation.plugin_path, options.simulation.scripts);
  add_simd_option(resume);
  add_session_option(resume, options);
  add_clock_options(resume, options);
  add_output_options(resume, options);
}

}  // namespace troupe::apps
