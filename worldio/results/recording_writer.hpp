#pragma once

#include "engine/world.hpp"
#include "partition/job_thread.hpp"
#include "worldio/results/hdf5_file.hpp"
#include "worldio/results/recording_fields.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
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
/// In the background, a thread of the writer's own writes a batch while the next one is gathered: the caller
/// waits only where the file takes batches more slowly than they come. The file has the same bytes.
///
/// Everything throws Hdf5Error; what fails on that thread is thrown by the next call. After an error the file
/// is left as it was flushed last, marked as closed, and every further call does nothing.
class RecordingWriter {
 public:
  /// A new file, replacing one of the same name, without a frame.
  RecordingWriter(const std::filesystem::path& file, const engine::World& world,
                  std::vector<RecordedComponent> components, const RecordingHead& head,
                  bool in_background = false);
  /// Goes on with the recording of the same world at tick world.tick(): frames of later ticks are cut off,
  /// and those that follow are appended. Throws where the recording is of other bodies or fields, or where it
  /// ends before the last frame that was due until now. A recording that was cut off is repaired first.
  RecordingWriter(const std::filesystem::path& file, const engine::World& world, bool in_background = false);
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
  /// The same, but in the background it may return before they are in the file.
  void start_flush();
  /// Flushes, and closes the file for plain tools.
  void close();

 private:
  struct Output {  // one array of the state
    Hdf5Dataset dataset;
    std::size_t frame_bytes;
  };
  struct Batch {                                // of frames
    std::vector<std::vector<std::byte>> state;  // an array each output, room for the most frames of a batch
    std::vector<std::uint64_t> ticks;           // a value each frame, as are:
    std::vector<double> times_s;
    std::vector<std::uint64_t> hashes;
    void reserve(std::size_t frames);
  };
  void write_head(const engine::World& world, const RecordingHead& head);
  void create_outputs();
  void open_outputs();
  void add_output(Hdf5Dataset dataset, std::size_t frame_bytes, std::byte absent);
  void cut_after(std::uint64_t tick);
  void start(bool in_background);
  void write(Batch& batch);
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
  Batch gathered_;                          // not handed to the file yet
  Batch written_;                           // by the thread, where there is one
  std::uint64_t next_tick_ = 0;             // below it everything is there
  bool open_ = false;
  std::optional<partition::JobThread> thread_;  // the last: it uses the file, the outputs and written_
};

}  // namespace troupe::worldio
