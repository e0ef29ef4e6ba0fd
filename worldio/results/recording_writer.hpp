#pragma once

#include "engine/world.hpp"
#include "worldio/results/hdf5_file.hpp"
#include "worldio/results/recording_fields.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace troupe::worldio {

/// The number of the layout that docs/recordings.md describes.
inline constexpr std::int64_t k_recording_layout = 1;
/// What /frames/tick holds where no tick was written: a frame is whole once its tick is another.
inline constexpr std::uint64_t k_no_tick = ~std::uint64_t{0};

/// What stands at the head of a recording, beside what the world itself says.
struct RecordingHead {
  std::vector<std::pair<std::string, std::string>> meta;  ///< attributes of /meta: the hash log's header
  std::string world_json;                                 ///< /world
  std::uint64_t every_ticks = 1;
  std::vector<std::string> fields;  ///< as they were asked for
};

/// Writes a recording (docs/recordings.md), frame by frame, in HDF5's single-writer mode: others may read it
/// meanwhile, and whatever was flushed outlives the process.
///
/// Frames are gathered in memory and written by the batch, a chunk a batch. The state of a batch is flushed
/// before its ticks are written, so that a frame whose tick can be read is whole.
///
/// Everything throws Hdf5Error. After one the file is left as it was flushed last, marked as closed, and
/// every further call does nothing.
class RecordingWriter {
 public:
  /// A new file, replacing one of the same name, without a frame.
  RecordingWriter(const std::filesystem::path& file, const engine::World& world,
                  std::vector<RecordedComponent> components, const RecordingHead& head);
  /// Goes on with the recording of the same world at tick world.tick(): frames of later ticks are cut off,
  /// and those that follow are appended. Throws where the recording is of other bodies or fields, or where it
  /// ends before the last frame that was due until now. A recording that was cut off is repaired first.
  RecordingWriter(const std::filesystem::path& file, const engine::World& world);
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;
  /// As close(), but what fails is lost.
  ~RecordingWriter();

  /// Whether a frame of this tick is wanted and not there yet.
  bool due(std::uint64_t tick) const;
  /// Adds the world as it is now as a frame, with the hash of its state; its tick is due.
  void record(const engine::World& world, std::uint64_t state_hash);
  /// Writes and flushes the frames that are not in the file yet.
  void flush();
  /// Flushes, and closes the file for plain tools.
  void close();

  /// Frames that were flushed.
  std::uint64_t frames() const { return frames_; }

 private:
  struct Output {  // one array of the state
    Hdf5Dataset dataset;
    std::size_t frame_bytes;
    std::vector<std::byte> batch;
  };
  void write_head(const engine::World& world, const RecordingHead& head);
  void create_outputs();
  void open_outputs();
  void add_output(Hdf5Dataset dataset, std::size_t frame_bytes, std::byte absent);
  void cut_after(std::uint64_t tick);
  void start();
  void write_batch();
  void give_up() noexcept;
  template <class Work>
  void guarded(Work&& work);

  Hdf5File file_;  // ends last: what was opened from it must be gone
  std::vector<BodyId> bodies_;
  std::vector<RecordedComponent> components_;
  std::uint64_t every_ticks_ = 1;
  std::size_t batch_frames_ = 1;
  std::vector<Output> outputs_;             // of the components' fields, in their order, and /state/alive
  std::vector<Hdf5Dataset> frame_outputs_;  // tick, time_s, hash
  std::vector<std::uint64_t> ticks_;        // of the batch, as are:
  std::vector<double> times_s_;
  std::vector<std::uint64_t> hashes_;
  std::uint64_t frames_ = 0;
  std::uint64_t next_tick_ = 0;  // below it everything is there
  bool open_ = false;
};

}  // namespace troupe::worldio
