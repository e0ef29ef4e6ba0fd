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
#include <vector>

namespace troupe::apps {

/// Calls Pictures::rehearse() for a picture or film `file`. Throws OutputError if the file cannot be written,
/// and the other errors of Pictures::rehearse().
void rehearse_picture(Pictures& pictures, const std::filesystem::path& file);

/// Measures the mean speed of a run, in multiples of real time, since the construction of this object.
class RunSpeed {
 public:
  /// begin_s: simulated time of the run when this object is constructed, s
  explicit RunSpeed(double begin_s) : begin_s_(begin_s) {}
  /// Returns the mean speed from the construction of this object until now, in multiples of real time; 0 if
  /// no wall time has passed. time_s: simulated time of the run now, s.
  double at(double time_s) const;

 private:
  double begin_s_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Writes pictures of single ticks (time steps) of a run. A separate thread draws them while the run
/// continues.
class Snapshots : public Observer {
 public:
  /// Prepares the snapshots. Throws InputError if a requested time is outside the run, or if `files.look`
  /// names something that does not exist, such as a body to follow. Throws std::runtime_error if the program
  /// was built without a renderer.
  ///
  /// files: must request at least one snapshot
  /// end_tick: last tick of the run
  Snapshots(const PictureFiles& files, const Simulation& simulation, std::uint64_t end_tick);

  /// Writes a small picture next to the first snapshot file and removes it. Call it before the run, to find
  /// errors of drawing or writing early. Throws the errors of rehearse_picture().
  void rehearse() { rehearse_picture(pictures_, first_); }
  void observe(const Simulation& simulation) override;
  bool reads_robots() const override { return false; }  // Pictures fetches the robots that it draws
  void finish(const Simulation& simulation) override;
  /// Returns a warning that lists the times of --snapshot-at that the run did not reach, or an empty text.
  std::string warning() const override { return warning_; }
  /// If --snapshot-at was not given, draws the state at the end of the run and writes the picture. Throws if
  /// drawing or writing fails.
  void after_summary(const Simulation& simulation) override;

 private:
  /// A picture of a time that --snapshot-at gives.
  struct Due {
    double time_s;
    std::uint64_t tick;
    std::filesystem::path file;
  };
  std::vector<Due> due_;         // by time
  std::filesystem::path first_;  // the first of all files
  std::filesystem::path last_;   // picture of the end of the run; empty: --snapshot-at was given
  std::string warning_;
  std::optional<RunSpeed> speed_;
  Pictures pictures_;
  partition::JobThread thread_;
};

/// Films a run or a recording. A separate thread draws the frames while the run continues.
class Filming : public Observer {
 public:
  /// Prepares the film. Throws InputError if `files.look` names something that does not exist in `source`,
  /// such as a body to follow. Throws std::runtime_error if the program was built without a renderer.
  ///
  /// files: must request a film
  /// source: the run or the recording to film
  Filming(const PictureFiles& files, const PictureSource& source);
  /// Writes a small picture next to the film and removes it. Call it before the run, to find errors of
  /// drawing or writing early. Throws the errors of rehearse_picture().
  void rehearse() { rehearse_picture(pictures_, film_); }
  /// Starts ffmpeg, unless the film is written as one picture file per frame. Call it once, before observe().
  /// Throws OutputError if ffmpeg is not found or the file cannot be written.
  void open();

  void observe(const Simulation& simulation) override;
  bool reads_robots() const override { return false; }  // Pictures fetches the robots that it draws
  /// Adds the frames of the film up to the current time of `source`. Call it repeatedly, with increasing
  /// times. A frame between two calls is interpolated between the states at these calls.
  ///
  /// next_s: simulated time of the next call, s; infinity if there is no next call. If no frame before this
  /// time needs the current state, the state is not copied.
  void observe(const PictureSource& source, double next_s);
  void finish(const Simulation& simulation) override;
  /// Waits until the film is complete. Throws if drawing or writing failed.
  void finish();
  /// Returns name, number of frames and duration of the film: `crowd.mp4: 300 pictures, 10 s`.
  std::string result() const override;

 private:
  void add(Pictures::Shot shot);
  /// Simulated time of the next frame, s.
  double due_s() const { return begin_s_ + static_cast<double>(frames_) * step_s_; }

  std::filesystem::path film_;
  double fps_;
  double speed_;    // simulated seconds per second of film
  double step_s_;   // simulated time between frames
  double begin_s_;  // simulated time of the first frame
  std::size_t frames_ = 0;
  Pictures pictures_;
  Pictures::Shot previous_;  // state at the previous observe(); null if no frame needs it
  double previous_s_ = 0;
  std::unique_ptr<Ffmpeg> ffmpeg_;  // null: one picture file per frame
  partition::JobThread thread_;     // last, because it uses all members above
};

/// Returns the RunOutput for pictures and films (Snapshots and Filming). A RunOutput is one output of a run,
/// together with its command-line options. The options are those of add_picture_options(). Without --snapshot
/// and --film, which name the files, nothing is written.
std::unique_ptr<RunOutput> pictures_output();

}  // namespace troupe::apps
