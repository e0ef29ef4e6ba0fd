#include "apps/pictures/render.hpp"

#include "apps/diff/diff_recordings.hpp"
#include "apps/interrupt.hpp"
#include "apps/messages.hpp"
#include "apps/observers/filming.hpp"
#include "apps/options.hpp"
#include "apps/outputs.hpp"
#include "apps/pictures/film.hpp"
#include "apps/progress.hpp"
#include "base/diagnostics.hpp"
#include "engine/spec/ticks.hpp"
#include "troupe/recorded_run.hpp"
#include "troupe/simulation.hpp"
#include "troupe/simulation_source.hpp"
#include "worldio/results/checkpoint.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace troupe::apps {
namespace fs = std::filesystem;
namespace {

constexpr const char* k_render_footer = R"(
Draws a world, a checkpoint or a recording. By default, a world is drawn at its start, a checkpoint at the time at which
it was saved, and a recording at its end. --at selects other times: a world is run, or a checkpoint is resumed, until
these times; a recording is drawn at its last frame at or before each time. For worlds and checkpoints, --for S has the
effect of --at S, and a film (--film) ends at S. A recording needs no other file, but its pictures show only recorded
fields (troupe run --record-fields): the layer scans needs the field ranges, and outlines of stalled robots need the
field stall.
)";

constexpr const char* k_examples = R"(
Exit codes: 0 finished; 1 failed; 2 bad input or usage, nothing written; 3 stopped early by Ctrl-C, SIGTERM or SIGHUP;
the files that exist then are complete.

Examples:
  troupe render worlds/cave-simple.json -o cave.png --camera perspective
  troupe render worlds/cave-simple.json -o cave-{time}.png --at 0,10,60
  troupe render worlds/hospital.json -o hospital.png --for 30 --seed 7 --threads 2
  troupe render day.h5 --film day.mp4 --film-speed 60 --layers trails
  troupe render day.h5 -o last.png --camera follow:r0 --layers names)";

/// Draws one picture for each time of the option --at, in order, or a single picture if --at is not given.
/// take_at(time) returns the state at a simulated time, s; the time is not set if --at is not given. After
/// Ctrl-C, SIGTERM or SIGHUP the remaining pictures are not drawn.
template <class TakeAt>
void draw_each(const RenderOptions& options, Pictures& pictures, TakeAt&& take_at) {
  const std::vector<fs::path> files = snapshot_files(options.pictures);
  const std::vector<double>& times = options.pictures.snapshot_at_s;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const Pictures::Shot shot = take_at(times.empty() ? std::nullopt : std::optional(times[i]));
    if (stop_requested()) return;
    const worldio::Descriptor reader = await_reader(files[i]);
    pictures.write(shot, files[i]);
  }
}

/// Steps the simulation until the simulated time `time_s`, s, or until Ctrl-C, SIGTERM or SIGHUP arrives.
/// Calls after_each() after each step.
void run_until(Simulation& simulation, double time_s, Progress& progress,
               const std::function<void()>& after_each) {
  while (simulation.tick() < engine::ticks_until(time_s, simulation.tick_s()) && !stop_requested()) {
    simulation.step();
    progress.update(simulation.time_s());
    after_each();
  }
}

/// Throws InputError if the simulation was resumed from a checkpoint that was saved after the time `time_s`,
/// s. setting: the option or the key of the world that gives this time, for the error.
void refuse_earlier(const RenderOptions& options, const Simulation& simulation, std::string_view setting,
                    double time_s) {
  if (engine::ticks_until(time_s, simulation.tick_s()) >= simulation.tick()) return;
  throw InputError(fmt::format(
      "{}: error: {} {:.10g}: the checkpoint was saved at {:.10g} s; give this time or a later one{}",
      options.world.string(), setting, time_s, simulation.time_s(),
      setting.starts_with("--") ? "" : " with --for"));
}

/// Returns the simulated time at which the film of a simulation ends, s. Throws InputError if it is not given
/// or if it is before the start of the film.
double end_of_film(const RenderOptions& options, const Simulation& simulation) {
  const double end_s = end_of(options, simulation);
  refuse_earlier(options, simulation, options.for_s ? "--for" : "quit_time_s", end_s);
  return end_s;
}

/// Prepares and opens the film, if one is requested; else returns null. Call it before the first picture is
/// written, so that nothing is written if the film cannot be made. Throws InputError or OutputError.
std::unique_ptr<Filming> open_film(const RenderOptions& options, const PictureSource& source) {
  if (options.pictures.film.empty()) return nullptr;
  auto film = std::make_unique<Filming>(options.pictures, source);
  film->rehearse();
  film->open();
  return film;
}

std::unique_ptr<Filming> open_film(const RenderOptions& options, const Simulation& simulation) {
  if (!options.pictures.film.empty()) end_of_film(options, simulation);
  return open_film(options, SimulationSource(simulation));
}

void draw_simulation(const RenderOptions& options, Simulation& simulation) {
  Pictures pictures(simulation, options.pictures.look);
  const auto& times = options.pictures.snapshot_at_s;
  if (!times.empty()) refuse_earlier(options, simulation, options.for_s ? "--for" : "--at", times.front());
  rehearse_picture(pictures, snapshot_files(options.pictures).front());
  const RunSpeed speed(simulation.time_s());
  pictures.see(simulation);
  Progress progress(simulation.time_s(), times.empty() ? 0 : times.back(), true);
  draw_each(options, pictures, [&](std::optional<double> time) {
    if (time) run_until(simulation, *time, progress, [&] { pictures.see(simulation); });
    return pictures.take(simulation, speed.at(simulation.time_s()));
  });
}

void film_simulation(const RenderOptions& options, Simulation& simulation, Filming& film) {
  const double end_s = end_of_film(options, simulation);
  {
    Progress progress(simulation.time_s(), end_s, true);
    film.observe(simulation);
    run_until(simulation, end_s, progress, [&] { film.observe(simulation); });
  }
  film.finish();
  fmt::print("{}\n", film.result());
}

/// Passes the frames of the recording up to the current one to `pictures`, because the layers trails and
/// coverage show earlier frames.
void see_history(RecordedRun& run, Pictures& pictures) {
  if (pictures.history_s() == 0) return;
  const std::size_t last = run.frame_index();
  for (std::size_t frame = run.first_within(pictures.history_s()); frame <= last; ++frame) {
    run.go_to_frame(frame);
    pictures.see(run);
  }
}

/// Throws InputError if the layer "speed" is requested for a recording, which does not contain the speed of
/// its run. (In films whose --film-speed is not 1, Filming adds the layer, which then shows the film's
/// speed.)
void refuse_speed(const RenderOptions& options) {
  const std::string list = "," + options.pictures.look.layers + ",";
  if (list.find(",speed,") == list.npos && list.find(",+speed,") == list.npos) return;
  throw InputError(
      fmt::format("{}: error: the layer \"speed\" can be drawn for worlds and checkpoints, but not for "
                  "recordings: omit this layer",
                  options.world.string()));
}

void draw_recording(const RenderOptions& options, RecordedRun& run) {
  refuse_speed(options);
  const double last_s = run.times_s().back();
  Pictures pictures(run, options.pictures.look);
  rehearse_picture(pictures, snapshot_files(options.pictures).front());
  for (const double time : options.pictures.snapshot_at_s)
    run.go_to(time);  // throws for a time that is not recorded, before the first picture is written
  draw_each(options, pictures, [&](std::optional<double> time) {
    run.go_to(time.value_or(last_s));
    see_history(run, pictures);
    return pictures.take(run);
  });
}

void film_recording(RecordedRun& run, Filming& film) {
  const std::span<const double> times = run.times_s();
  {
    Progress progress(times.front(), times.back(), true);
    for (std::size_t frame = 0; frame < times.size() && !stop_requested(); ++frame) {
      run.go_to_frame(frame);
      film.observe(run,
                   frame + 1 < times.size() ? times[frame + 1] : std::numeric_limits<double>::infinity());
      progress.update(times[frame]);
    }
  }
  film.finish();
  fmt::print("{}\n", film.result());
}

/// Throws InputError if one of the options `given` is not in `allowed`, because the input, a checkpoint or a
/// recording, already determines its value. what: the kind of input, for the error.
void refuse_given(const RenderOptions& options, std::span<const std::string_view> allowed,
                  std::string_view what) {
  for (const std::string& option : options.given)
    if (std::ranges::find(allowed, option) == allowed.end())
      throw InputError(
          fmt::format("{}: error: {} cannot be used with a {}", options.world.string(), option, what));
}

Simulation load(const RenderOptions& options, bool is_checkpoint) {
  if (is_checkpoint) return Simulation::resume(options.world, resume_options(options));
  refuse_across_options(options);
  return Simulation(options.world, with_environment(options.simulation));
}

void render_recording(const RenderOptions& options) {
  constexpr std::array<std::string_view, 1> k_of_recordings = {"--simd"};
  refuse_given(options, k_of_recordings,
               "recording: omit this option (--at selects a time of the recording)");
  RecordedRun run(options.world);
  const std::string& value = options.pictures.look.color_by;
  if (const auto present = run.present_name(value))
    print_message(fmt::format(
        "{}: warning: --color-by: \"{}\" is a name of an earlier version of Troupe; the name is now "
        "\"{}\"\n",
        options.world.string(), value, *present));
  run.go_to_frame(0);
  const std::unique_ptr<Filming> film = open_film(options, run);
  if (!options.pictures.snapshot.empty()) draw_recording(options, run);
  if (film && !stop_requested()) film_recording(run, *film);
}

void render_all(const RenderOptions& options) {
  constexpr std::array<std::string_view, 7> k_of_checkpoints = {
      "--for",  "--threads",         "--plugin-path",   "--controller",
      "--simd", "--across-versions", "--across-plugins"};
  const PictureFiles& wanted = options.pictures;
  std::vector<fs::path> outputs = snapshot_files(wanted);
  outputs.push_back(wanted.film);
  std::vector<Input> inputs{{options.world, "the file to draw"}};
  add_inputs(options.simulation.scripts, inputs);
  check_outputs(inputs, outputs);
  for (const fs::path& file : outputs) check_replaceable(file);
  check_film(wanted);
  const bool is_checkpoint = worldio::is_checkpoint(options.world);
  if (!is_checkpoint && is_hdf5(options.world)) return render_recording(options);
  if (is_checkpoint) refuse_given(options, k_of_checkpoints, "checkpoint: omit this option");
  std::unique_ptr<Filming> film;
  if (!wanted.snapshot.empty()) {
    Simulation simulation = load(options, is_checkpoint);
    add_inputs(simulation, inputs);
    check_outputs(inputs, outputs);
    film = open_film(options, simulation);
    draw_simulation(options, simulation);
  }
  if (!wanted.film.empty() && !stop_requested()) {
    Simulation simulation = load(options, is_checkpoint);
    add_inputs(simulation, inputs);
    check_outputs(inputs, outputs);
    if (!film) film = open_film(options, simulation);
    film_simulation(options, simulation, *film);
  }
}

}  // namespace

void add_render_options(CLI::App& command, RenderOptions& options) {
  command.footer(fmt::format("{}\n{}{}", k_render_footer, picture_help(), k_examples));
  add_argument(command, "INPUT", "World file, checkpoint or recording", options.world);
  add_value(command, "-o,--output", "FILE",
            "Picture to write, a .png, .svg or .pdf; {time} in FILE is replaced by the time of --at",
            [&options](const std::string& text) { set_snapshot(options.pictures, "--output", text); });
  CLI::Option* const at =
      add_value(command, "--at", "T,...", "Simulated times to draw, s",
                [&options](const std::string& text) { set_times(options.pictures, "--at", text); });
  add_film_options(command, options.pictures);
  add_look_options(command, options.pictures.look);
  const std::size_t before = command.get_options().size();
  add_run_settings(command, options);
  add_across_options(command, options);
  command.get_option("--for")->excludes(at);
  add_threads_option(command, options);
  std::vector<CLI::Option*> settings = command.get_options();
  settings.erase(settings.begin(), settings.begin() + static_cast<std::ptrdiff_t>(before));
  command.final_callback([settings, &options] {
    PictureFiles& pictures = options.pictures;
    if (pictures.snapshot.empty() && pictures.film.empty()) throw CLI::RequiredError("--output or --film");
    if (pictures.snapshot.empty() && !pictures.snapshot_at_s.empty())
      throw CLI::RequiresError("--at", "--output");
    for (const CLI::Option* option : settings)
      if (option->count() > 0) options.given.push_back(option->get_name());
    if (options.for_s) pictures.snapshot_at_s = {*options.for_s};
    check_names(pictures, "--at", "--output");
  });
}

ExitCode render_pictures(const RenderOptions& options) {
  stop_on_signals("troupe render: stopping");
  render_all(options);
  return stop_requested() ? k_stopped : k_finished;
}

}  // namespace troupe::apps
