#include "apps/pictures/render.hpp"

#include "apps/diff/diff_recordings.hpp"
#include "apps/interrupt.hpp"
#include "apps/observers/filming.hpp"
#include "apps/options.hpp"
#include "apps/outputs.hpp"
#include "apps/pictures/film.hpp"
#include "base/diagnostics.hpp"
#include "engine/ticks.hpp"
#include "troupe/recorded_run.hpp"
#include "troupe/simulation.hpp"
#include "worldio/results/checkpoint.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <utility>

namespace troupe::apps {
namespace fs = std::filesystem;
namespace {

constexpr const char* k_render_footer = R"(
A world is drawn as it begins, a checkpoint as it was saved, a recording as it ended; --at draws other times: a world is
run until then, a checkpoint resumed, and of a recording the last frame that is not later is taken. A recording needs no
other file; it can show what was recorded (troupe run --record-fields): scans want ranges, red outlines want stall.
)";

constexpr const char* k_examples = R"(
Exit codes: 0 finished; 1 failed; 2 bad input or usage, nothing written; 3 ended early by Ctrl-C or SIGTERM, what was
drawn until then is whole.

Examples:
  troupe render worlds/cave-simple.json -o cave.png --camera perspective
  troupe render worlds/cave-simple.json -o cave-{time}.png --at 0,10,60
  troupe render day.h5 --film day.mp4 --film-speed 60 --layers trails
  troupe render day.h5 -o last.png --camera follow:r0 --layers names)";

/// Times in order, or the one the input stands at. Who is stopped on the way there draws nothing of it.
template <class TakeAt>
void draw_each(const RenderOptions& options, Pictures& pictures, TakeAt&& take_at) {
  const std::vector<fs::path> files = snapshot_files(options.pictures);
  for (std::size_t i = 0; i < files.size(); ++i) {
    const Pictures::Shot shot =
        take_at(options.pictures.snapshot_at_s.empty() ? std::nan("") : options.pictures.snapshot_at_s[i]);
    if (stop_requested()) return;
    pictures.write(shot, files[i]);
  }
}

void draw_simulation(const RenderOptions& options, Simulation simulation) {
  Pictures pictures(simulation, options.pictures.look);
  const auto& times = options.pictures.snapshot_at_s;
  if (!times.empty() && engine::ticks_until(times.front(), simulation.tick_s()) < simulation.tick())
    throw InputError(fmt::format("{}: error: --at {:g}: the run is at {:g} s already", options.input.string(),
                                 times.front(), simulation.time_s()));
  pictures.rehearse(snapshot_files(options.pictures).front());
  const RunSpeed speed(simulation.time_s());
  pictures.see(simulation);
  draw_each(options, pictures, [&](double time) {
    while (!std::isnan(time) && simulation.tick() < engine::ticks_until(time, simulation.tick_s()) &&
           !stop_requested()) {
      simulation.step();
      pictures.see(simulation);
    }
    return pictures.take(simulation, speed.at(simulation.time_s()));
  });
}

/// Trails and coverage are made of the frames before.
void see_history(RecordedRun& run, Pictures& pictures) {
  if (pictures.history_s() == 0) return;
  const std::size_t last = run.frame_index();
  for (std::size_t frame = run.first_within(pictures.history_s()); frame <= last; ++frame) {
    run.go_to_frame(frame);
    pictures.see(run);
  }
}

/// Nobody recorded how fast the run was; a film tells how fast it is itself.
void refuse_speed(const RenderOptions& options) {
  const std::string list = "," + options.pictures.look.layers + ",";
  if (list.find(",speed,") == list.npos && list.find(",+speed,") == list.npos) return;
  throw InputError(
      fmt::format("{}: error: the layer \"speed\" is drawn of worlds and checkpoints, not of recordings",
                  options.input.string()));
}

void draw_recording(const RenderOptions& options, RecordedRun& run) {
  refuse_speed(options);
  const double last_s = run.times_s().back();
  Pictures pictures(run, options.pictures.look);
  pictures.rehearse(snapshot_files(options.pictures).front());
  draw_each(options, pictures, [&](double time) {
    run.go_to(std::isnan(time) ? last_s : time);
    see_history(run, pictures);
    return pictures.take(run);
  });
}

void film_recording(const RenderOptions& options, RecordedRun& run) {
  const std::span<const double> times = run.times_s();
  run.go_to_frame(0);
  Filming film(options.pictures, run);
  film.rehearse();
  film.open();
  for (std::size_t frame = 0; frame < times.size() && !stop_requested(); ++frame) {
    run.go_to_frame(frame);
    film.observe(run, frame + 1 < times.size() ? times[frame + 1] : std::numeric_limits<double>::infinity());
  }
  film.finish();
}

void render_checked(const RenderOptions& options) {
  const PictureFiles& wanted = options.pictures;
  std::vector<fs::path> outputs = snapshot_files(wanted);
  outputs.push_back(wanted.film);
  check_outputs({{options.input, "what is to be drawn"}}, outputs);
  check_film(wanted);
  const bool is_checkpoint = worldio::is_checkpoint(options.input);
  if (!is_checkpoint && is_hdf5(options.input)) {
    RecordedRun run(options.input);
    if (!wanted.snapshot.empty()) draw_recording(options, run);
    if (!wanted.film.empty()) film_recording(options, run);
    return;
  }
  if (!wanted.film.empty())
    throw InputError(
        fmt::format("{}: error: --film: a recording can be filmed; a world is while it runs, by "
                    "troupe run --film",
                    options.input.string()));
  if (is_checkpoint) {
    draw_simulation(options,
                    Simulation::resume(options.input, {.plugin_path = plugin_path(options.plugin_path)}));
  } else {
    SimulationOptions simulation;
    simulation.plugin_path = options.plugin_path;
    draw_simulation(options, Simulation(options.input, with_environment(std::move(simulation))));
  }
}

}  // namespace

void add_render_options(CLI::App& command, RenderOptions& options) {
  command.footer(fmt::format("{}\n{}{}", k_render_footer, picture_help(), k_examples));
  command
      .add_option_function<std::string>(
          "INPUT", [&options](const std::string& text) { options.input = text; },
          "World file, checkpoint or recording")
      ->option_text(" ")
      ->required();
  add_value(command, "-o,--output", "FILE.png",
            "The picture; {time} in its name stands for the simulated time",
            [&options](const std::string& text) { set_snapshot(options.pictures, "--output", text); });
  add_value(command, "--at", "T,...", "Simulated times to draw, s",
            [&options](const std::string& text) { set_times(options.pictures, "--at", text); });
  add_film_options(command, options.pictures);
  add_look_options(command, options.pictures.look);
  add_plugin_path_option(command, options.plugin_path);
  add_simd_option(command);
  command.final_callback([&options] {
    if (options.pictures.snapshot.empty() && options.pictures.film.empty())
      throw CLI::RequiredError("--output or --film");
    check_names(options.pictures, "--at", "--output");
  });
}

ExitCode render_pictures(const RenderOptions& options) {
  try {
    stop_on_signals();
    render_checked(options);
    return stop_requested() ? k_stopped : k_finished;
  } catch (const InputError& error) {
    fmt::print(stderr, "{}\n", error.what());
  } catch (const OutputError& error) {
    fmt::print(stderr, "{}\n", error.what());
  }
  return k_bad_input;
}

}  // namespace troupe::apps
