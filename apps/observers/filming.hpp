#pragma once

#include "apps/observers/observer.hpp"
#include "apps/pictures/film.hpp"
#include "apps/pictures/picture_options.hpp"
#include "apps/run/run_output.hpp"
#include "partition/job_thread.hpp"
#include "troupe/picture_source.hpp"
#include "troupe/pictures.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace troupe::apps {

/// How fast a run is, times real time, since this was made.
class RunSpeed {
 public:
  explicit RunSpeed(double begin_s) : begin_s_(begin_s) {}
  /// At this simulated time, s; 0 where no time has gone by.
  double at(double time_s) const;

 private:
  double begin_s_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Pictures of single ticks, drawn beside the run.
class Snapshots : public Observer {
 public:
  /// `end_tick`: of the run. Throws InputError for what the world has not, and for times outside of the run.
  Snapshots(const PictureFiles& files, const Simulation& simulation, std::uint64_t end_tick);

  /// Throws what drawing would throw, so that a file that cannot be written is known before the run.
  void rehearse() { pictures_.rehearse(first_); }
  void observe(const Simulation& simulation) override;
  void finish(const Simulation& simulation) override;
  /// Draws the last tick, where no times were given. Throws what drawing it throws.
  void after_summary(const Simulation& simulation) override;

 private:
  std::vector<std::pair<std::uint64_t, std::filesystem::path>> due_;  // by tick; those to come last
  std::filesystem::path first_;                                       // of all
  std::filesystem::path last_;                                        // empty: times were given
  std::optional<RunSpeed> speed_;
  Pictures pictures_;
  partition::JobThread thread_;
};

/// A film of a run, drawn beside it; or of a recording.
class Filming : public Observer {
 public:
  /// Throws InputError for what the world has not.
  Filming(const PictureFiles& files, const PictureSource& source);
  /// As that of Snapshots.
  void rehearse() { pictures_.rehearse(film_); }
  /// Starts ffmpeg. Throws OutputError.
  void open();

  void observe(const Simulation& simulation) override;
  /// What there is to see now; the next thing comes at `next_s`.
  void observe(const PictureSource& source, double next_s);
  void finish(const Simulation& simulation) override;
  /// Waits until the film is whole. Throws what drawing and writing throw.
  void finish();
  /// `crowd.mp4: 300 pictures, 10 s`.
  std::string result() const override;

 private:
  void add(Pictures::Shot shot);
  double due_s() const { return begin_s_ + static_cast<double>(frames_) * step_s_; }

  std::filesystem::path film_;
  double fps_;
  double speed_;    // simulated seconds a second of it
  double step_s_;   // of simulated time, from frame to frame
  double begin_s_;  // of the first frame
  std::size_t frames_ = 0;
  Pictures pictures_;
  Pictures::Shot previous_;  // the tick before; null where no frame needs it
  double previous_s_ = 0;
  std::unique_ptr<Ffmpeg> ffmpeg_;  // null: pictures, one a frame
  partition::JobThread thread_;     // the last: it uses all others
};

/// --snapshot, --film, and what says how pictures look.
std::unique_ptr<RunOutput> pictures_output();

}  // namespace troupe::apps
