#pragma once

#include "engine/world/world.hpp"
#include "partition/job_thread.hpp"
#include "worldio/results/hdf5_file.hpp"
#include "worldio/results/recording_fields.hpp"
#include "worldio/results/recording_reader.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace troupe::worldio {

/// The version of the file structure that docs/recordings.md describes.
inline constexpr std::int64_t k_recording_layout = 1;
/// The value of an entry of the array /frames/tick that is not written yet. The array has one entry for each
/// frame, which is the recorded state of the world at one tick (time step). A frame is complete once
/// its entry has another value.
inline constexpr std::uint64_t k_no_tick = ~std::uint64_t{0};

/// The data in the header of a recording that the caller provides. RecordingWriter takes all other data in
/// the header from the world.
struct RecordingHead {
  /// Attributes of /meta, as keys and values: version, world, seed, ...
  std::vector<std::pair<std::string, std::string>> meta;
  /// The content of /world: the spec of the world (the description from which the engine builds it) as JSON.
  std::string world_json;
  std::uint64_t every_ticks = 1;    ///< number of ticks from one frame to the next, at least 1
  std::vector<std::string> fields;  ///< names of the recorded fields, as the user gave them
};

/// Writes a recording (docs/recordings.md): an HDF5 file with the state of a world at certain ticks
/// (time steps). The state at one of these ticks is called a frame. The writer uses the SWMR mode of
/// HDF5 (single writer, multiple readers): other programs can read the file in the meantime, and flushed data
/// survive if the process is killed.
///
/// The writer collects frames in memory and writes them in batches. It flushes the state of a batch before it
/// writes the ticks of the batch. A frame whose tick is in the file is therefore complete.
///
/// With `in_background`, a thread of the writer writes a batch while the caller records the next one. The
/// caller waits only if it fills a batch before the previous batch is written. The bytes of the file do not
/// depend on `in_background`.
///
/// On failure, all functions throw Hdf5Error. An error in the background thread is thrown by the next call of
/// record(), flush(), start_flush() or close(). After an error, all further calls do nothing, and the file
/// keeps the data that were flushed. The writer then marks the file as closed. If this fails too, `troupe
/// repair` can close the file.
class RecordingWriter {
 public:
  /// Creates a file without frames. Replaces an existing file of the same name. `components` are the
  /// components of the state to record, from recorded_components(). If the constructor throws after it has
  /// created the file, it also removes the file.
  RecordingWriter(const std::filesystem::path& file, const engine::World& world,
                  std::vector<RecordedComponent> components, const RecordingHead& head,
                  bool in_background = false);
  /// Continues an existing recording of the same world at tick world.tick(). Frames of later ticks are
  /// removed; record() appends new frames. If the removed frames leave much unused space, the file is
  /// replaced by a copy without this space, as repair_recording() does.
  ///
  /// Throws Hdf5Error if the recording has other bodies or fields than the world. Also throws Hdf5Error if
  /// the recording lacks frames that were due before world.tick(), because these frames can no longer be
  /// recorded: the recording ends before that tick, or was created after it. A recording without frames that
  /// an older version of Troupe created counts as created at tick 0.
  ///
  /// A recording that was cut off is repaired first. This can also throw std::runtime_error: see
  /// repair_recording().
  RecordingWriter(const std::filesystem::path& file, const engine::World& world, bool in_background = false);
  /// Checks that a recording can be continued at the tick world.tick(), and changes nothing. Throws Hdf5Error
  /// as the constructor that continues a recording does, except that nothing is repaired.
  static void check(const RecordingReader& recording, const engine::World& world);
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;
  /// Closes the file like close(), but ignores errors.
  ~RecordingWriter();

  /// Whether a frame of this tick is due and not recorded yet. Frames are due at the multiples of
  /// RecordingHead::every_ticks. Returns false after close() and after an error.
  bool due(std::uint64_t tick) const;
  bool is_open() const { return open_; }  ///< false after close() and after an error
  /// Adds the present state of the world as a frame. `state_hash` is the hash of this state.
  /// due(world.tick()) must be true.
  void record(const engine::World& world, std::uint64_t state_hash);
  /// Writes and flushes all frames that are not in the file yet.
  void flush();
  /// Starts to write and flush all frames that are not in the file yet. With `in_background`, the function
  /// may return before they are in the file.
  void start_flush();
  /// Flushes all frames and closes the file, so that ordinary HDF5 tools can open it. After this call, all
  /// functions do nothing.
  void close();

 private:
  /// Reads which arrays a recording has. The caller sets open_ if it has opened the file for writing.
  RecordingWriter(Hdf5File file, const engine::World& world);
  struct Output {  // one array of the state
    Hdf5Dataset dataset;
    std::size_t frame_bytes;
    std::byte absent;  // each byte of a row that no frame writes
  };
  struct Batch {                                // frames that are written together
    std::vector<std::vector<std::byte>> state;  // one buffer per output, with room for a full batch
    std::vector<std::uint64_t> ticks;           // one per frame, as in the next two members
    std::vector<double> times_s;
    std::vector<std::uint64_t> hashes;
    void reserve(std::size_t frames);
  };
  void write_head(const engine::World& world, const RecordingHead& head);
  void read_head(const engine::World& world);
  void create_outputs(std::uint64_t first_tick);
  void open_outputs();
  void add_output(Hdf5Dataset dataset, std::size_t frame_bytes, std::byte absent);
  std::size_t find_next_tick(std::span<const std::uint64_t> ticks, std::uint64_t tick);
  void start(bool in_background);
  void write(Batch& batch);
  void give_up() noexcept;
  template <class Work>
  void guarded(Work&& work);

  Hdf5File file_;  // destroyed last: datasets and groups must be destroyed before their file
  std::vector<BodyId> bodies_;
  std::vector<RecordedComponent> components_;
  std::uint64_t every_ticks_ = 1;
  std::size_t batch_frames_ = 1;
  std::vector<Output> outputs_;             // one per field of components_; the last is /state/alive
  std::vector<Hdf5Dataset> frame_outputs_;  // /frames/tick, /frames/time_s, /frames/hash
  Batch gathered_;                          // frames that are not written yet
  Batch written_;                           // frames that the thread writes, if there is a thread
  std::uint64_t next_tick_ = 0;             // all due frames before it are recorded
  bool open_ = false;
  std::optional<partition::JobThread> thread_;  // destroyed first: uses file_, outputs_ and written_
};

}  // namespace troupe::worldio
