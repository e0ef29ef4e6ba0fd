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
/// The value of /frames/tick where no tick was written: a frame is complete once its tick has another value.
inline constexpr std::uint64_t k_no_tick = ~std::uint64_t{0};

/// The header of a recording, in addition to what the world itself provides.
struct RecordingHead {
  std::vector<std::pair<std::string, std::string>> meta;  ///< attributes of /meta: the hash log's header
  std::string world_json;                                 ///< /world
  std::uint64_t every_ticks = 1;
  std::vector<std::string> fields;  ///< as requested
};

/// Writes a recording (docs/recordings.md) frame by frame, in HDF5's single-writer mode: others can read it
/// meanwhile, and flushed data outlives the process.
///
/// Frames are gathered in memory and written in batches, one chunk per batch. The state of a batch is flushed
/// before its ticks are written, so a frame whose tick can be read is complete.
///
/// With `in_background`, a thread of the writer writes a batch while the next one is gathered: the caller
/// waits only if batches come faster than the file takes them. The file has the same bytes.
///
/// All functions throw Hdf5Error; the next call throws the errors of that thread. After an error the file
/// stays as it was last flushed, marked as closed, and every further call does nothing.
class RecordingWriter {
 public:
  /// Creates a file without frames, replacing one of the same name.
  RecordingWriter(const std::filesystem::path& file, const engine::World& world,
                  std::vector<RecordedComponent> components, const RecordingHead& head,
                  bool in_background = false);
  /// Continues the recording of the same world at tick world.tick(): removes the frames of later ticks and
  /// appends new ones. Throws if the recording has other bodies or fields, or ends before the last frame that
  /// was due until now. A recording that was cut off is repaired first.
  RecordingWriter(const std::filesystem::path& file, const engine::World& world, bool in_background = false);
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;
  /// As close(), but ignores errors.
  ~RecordingWriter();

  /// Whether a frame of this tick is due and not recorded yet.
  bool due(std::uint64_t tick) const;
  /// Adds the current state of the world as a frame, with its hash. Requires due(world.tick()).
  void record(const engine::World& world, std::uint64_t state_hash);
  /// Writes and flushes the frames that are not in the file yet.
  void flush();
  /// As flush(), but in the background it may return before the frames are in the file.
  void start_flush();
  /// Flushes, and closes the file for plain tools.
  void close();

 private:
  struct Output {  // one array of the state
    Hdf5Dataset dataset;
    std::size_t frame_bytes;
  };
  struct Batch {                                // of frames
    std::vector<std::vector<std::byte>> state;  // an array per output, with room for a full batch
    std::vector<std::uint64_t> ticks;           // a value per frame, as the next two
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

  Hdf5File file_;  // destroyed last: what was opened from it must be gone
  std::vector<BodyId> bodies_;
  std::vector<RecordedComponent> components_;
  std::uint64_t every_ticks_ = 1;
  std::size_t batch_frames_ = 1;
  std::vector<Output> outputs_;             // of the components' fields, in their order, and /state/alive
  std::vector<Hdf5Dataset> frame_outputs_;  // tick, time_s, hash
  Batch gathered_;                          // not yet handed to the file
  Batch written_;                           // by the thread, if there is one
  std::uint64_t next_tick_ = 0;             // all due frames before it are recorded
  bool open_ = false;
  std::optional<partition::JobThread> thread_;  // destroyed first: uses file_, outputs_ and written_
};

}  // namespace troupe::worldio
