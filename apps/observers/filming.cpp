#include "apps/observers/filming.hpp"

#include "apps/numbers.hpp"
#include "apps/outputs.hpp"
#include "base/diagnostics.hpp"
#include "engine/spec/ticks.hpp"
#include "troupe/simulation_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

namespace troupe::apps {
namespace {

// Largest number of pictures that wait while another picture is being drawn. Each waiting picture is a copy
// of the state, so more waiting pictures would need more memory.
constexpr std::size_t k_most_waiting = 2;

/// Returns the options for the pictures of a film. By default a film whose speed is not real time shows the
/// speed next to the simulated time.
PictureOptions film_look(const PictureFiles& files) {
  PictureOptions look = files.look;
  if (files.film_speed != 1) look.layers = look.layers.empty() ? "speed" : "speed," + look.layers;
  return look;
}

}  // namespace

void rehearse_picture(Pictures& pictures, const std::filesystem::path& file) {
  try {
    pictures.rehearse(file);
  } catch (const std::system_error& error) {
    throw OutputError(error.what());
  }
}

double RunSpeed::at(double time_s) const {
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  return wall_s > 0 ? (time_s - begin_s_) / wall_s : 0;
}

Snapshots::Snapshots(const PictureFiles& files, const Simulation& simulation, std::uint64_t end_tick)
    : first_(snapshot_files(files).front()), pictures_(simulation, files.look), thread_(k_most_waiting) {
  if (files.snapshot_at_s.empty()) {
    last_ = files.snapshot;
    return;
  }
  const std::vector<std::filesystem::path> names = snapshot_files(files);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double time = files.snapshot_at_s[i];
    const std::uint64_t tick = engine::ticks_until(time, simulation.tick_s());
    if (tick < simulation.tick() || tick > end_tick)
      throw InputError(
          fmt::format("{}: error: --snapshot-at {:.10g}: give times within the run, which goes from {:.10g} "
                      "s to {:.10g} s",
                      simulation.effective_options().front().second, time, simulation.time_s(),
                      static_cast<double>(end_tick) * simulation.tick_s()));
    due_.push_back({time, tick, names[i]});
  }
}

void Snapshots::observe(const Simulation& simulation) {
  if (!speed_) speed_.emplace(simulation.time_s());
  pictures_.see(simulation);
  for (const Due& due : due_) {
    if (due.tick != simulation.tick()) continue;
    thread_.add([this, shot = pictures_.take(simulation, speed_->at(simulation.time_s())), png = due.file] {
      const worldio::Descriptor reader = await_reader(png);
      pictures_.write(shot, png);
    });
  }
}

void Snapshots::finish(const Simulation& simulation) {
  thread_.finish();
  std::string missed;
  for (const Due& due : due_)
    if (due.tick > simulation.tick())
      missed += fmt::format("{}{:.10g}", missed.empty() ? "" : ", ", due.time_s);
  if (!missed.empty())
    warning_ = fmt::format(
        "{}: warning: the run ended at {:.10g} s: these times of --snapshot-at were not drawn: {}",
        simulation.effective_options().front().second, simulation.time_s(), missed);
}

void Snapshots::after_summary(const Simulation& simulation) {
  if (last_.empty()) return;
  const worldio::Descriptor reader = await_reader(last_);
  pictures_.write(pictures_.take(simulation, speed_ ? speed_->at(simulation.time_s()) : 0), last_);
}

Filming::Filming(const PictureFiles& files, const PictureSource& source)
    : film_(files.film),
      fps_(files.fps),
      speed_(files.film_speed),
      step_s_(files.film_speed / files.fps),
      begin_s_(source.time_s()),
      pictures_(source, film_look(files)),
      thread_(k_most_waiting) {}

void Filming::open() {
  if (!is_frames(film_))
    ffmpeg_ = std::make_unique<Ffmpeg>(film_, pictures_.width(), pictures_.height(), fps_);
}

void Filming::observe(const Simulation& simulation) {
  observe(SimulationSource(simulation), simulation.time_s() + simulation.tick_s());
}

void Filming::observe(const PictureSource& source, double next_s) {
  pictures_.see(source);
  const double now = source.time_s();
  // A frame between this call and the next call needs the states at both, from which it is interpolated.
  const bool is_needed = due_s() < next_s;
  const Pictures::Shot shot = is_needed ? pictures_.take(source, speed_) : nullptr;
  for (; shot && due_s() <= now; ++frames_) {
    const bool is_between = previous_ && due_s() < now;
    add(is_between ? Pictures::between(previous_, shot, (due_s() - previous_s_) / (now - previous_s_))
                   : shot);
  }
  previous_ = shot;
  previous_s_ = now;
}

void Filming::add(Pictures::Shot shot) {
  thread_.add([this, shot = std::move(shot), frame = frames_] {
    if (ffmpeg_) return ffmpeg_->write(pictures_.draw(shot));
    const fs::path file = frame_file(film_, frame);
    const worldio::Descriptor reader = await_reader(file);
    pictures_.write(shot, file);
  });
}

void Filming::finish(const Simulation& /*simulation*/) { finish(); }

void Filming::finish() {
  thread_.finish();
  if (ffmpeg_) ffmpeg_->finish();
}

std::string Filming::result() const {
  return fmt::format("{}: {} picture{}, {} s", film_.string(), grouped(frames_), frames_ == 1 ? "" : "s",
                     four_digits(static_cast<double>(frames_) / fps_));
}

namespace {

/// Throws OutputError if a resumed run would replace a film, which may be that of the earlier part of the
/// run.
void check_new_film(const std::filesystem::path& film) {
  const std::filesystem::path file = is_frames(film) ? frame_file(film, 0) : film;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return;
  throw OutputError(
      fmt::format("{}: error: a film cannot be continued after the checkpoint, and {} exists: choose another "
                  "file name, or remove the file",
                  film.string(), is_frames(film) ? file.string() : "this file"));
}

class PicturesOutput : public ClonedOutput<PicturesOutput> {
 public:
  void add_options(CLI::App& app, RunOptions&) override { add_picture_options(app, pictures_); }
  std::vector<std::filesystem::path*> names(RunOptions&) override {
    return {&pictures_.snapshot, &pictures_.film};
  }
  std::vector<std::filesystem::path> files(const RunOptions&) const override {
    std::vector<std::filesystem::path> files = snapshot_files(pictures_);
    files.push_back(pictures_.film);
    check_film(pictures_);
    return files;
  }
  OpenOutput prepare(const RunOptions&, Simulation& simulation, std::uint64_t end_tick) const override {
    if (simulation.resumed_at_tick()) check_new_film(pictures_.film);
    for (const std::filesystem::path& file : snapshot_files(pictures_)) check_replaceable(file);
    check_replaceable(pictures_.film);
    struct Prepared {
      std::unique_ptr<Snapshots> snapshots;
      std::unique_ptr<Filming> film;
    };
    // Shared, because the returned function must be copyable.
    const auto prepared = std::make_shared<Prepared>();
    if (!pictures_.snapshot.empty())
      prepared->snapshots = std::make_unique<Snapshots>(pictures_, simulation, end_tick);
    if (!pictures_.film.empty())
      prepared->film = std::make_unique<Filming>(pictures_, SimulationSource(simulation));
    if (prepared->snapshots) prepared->snapshots->rehearse();
    if (prepared->film) prepared->film->rehearse();
    return [prepared](Observers& observers) {
      if (prepared->film) prepared->film->open();
      if (prepared->snapshots) observers.push_back(std::move(prepared->snapshots));
      if (prepared->film) observers.push_back(std::move(prepared->film));
    };
  }

 private:
  PictureFiles pictures_;
};

}  // namespace

std::unique_ptr<RunOutput> pictures_output() { return std::make_unique<PicturesOutput>(); }

}  // namespace troupe::apps
