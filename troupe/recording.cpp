#include "troupe/recording.hpp"

#include "base/diagnostics.hpp"
#include "engine/spec/ticks.hpp"
#include "engine/world/world.hpp"
#include "troupe/effective_options.hpp"
#include "worldio/file_lock.hpp"
#include "worldio/files.hpp"
#include "worldio/json/spec_json.hpp"
#include "worldio/partial_file.hpp"
#include "worldio/results/descriptor.hpp"
#include "worldio/results/recording_reader.hpp"
#include "worldio/results/recording_repair.hpp"
#include "worldio/results/recording_writer.hpp"

#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace troupe {
namespace {

constexpr double k_every_s = 0.1;
constexpr const char* k_fields = "pose";

/// Throws std::invalid_argument if the interval is NaN or too long.
void check_interval(const RecordingOptions& options) {
  if (!(options.every_s <= engine::k_most_seconds))
    throw std::invalid_argument(
        fmt::format("RecordingOptions::every_s is {}: give a time up to {} s, or 0 for the default",
                    options.every_s, engine::k_most_seconds));
}

/// Returns the names of the recorded fields: those of the options, or else of the world file, or else
/// k_fields.
std::vector<std::string> fields_of(const Simulation& simulation, const RecordingOptions& options) {
  const std::optional<engine::RecordSpec>& record = simulation.world().spec().record;
  if (!options.fields.empty()) return options.fields;
  if (record && !record->fields.empty()) return record->fields;
  return {k_fields};
}

/// Returns the head of a recording: metadata, world, interval and fields. Interval and fields are taken from
/// the options, or else from the world file, or else they are the defaults.
worldio::RecordingHead head_of(const Simulation& simulation, const RecordingOptions& options) {
  const engine::WorldSpec& spec = simulation.world().spec();
  const engine::RecordSpec record = spec.record.value_or(engine::RecordSpec{});
  const double every_s = options.every_s > 0 ? options.every_s : record.every_s.value_or(k_every_s);
  worldio::RecordingHead head{.meta = simulation.effective_options(),
                              .world_json = worldio::spec_to_json(spec, simulation.registry()),
                              .every_ticks = engine::period_ticks(every_s, simulation.tick_s()),
                              .fields = fields_of(simulation, options)};
  head.meta.insert(head.meta.begin(), {"version", version_line()});
  return head;
}

/// Returns the components that these fields select. Throws InputError for an unknown field: if the world file
/// requested it, with the line there, else with the name of the recording (`file`).
std::vector<worldio::RecordedComponent> components_of(const std::filesystem::path& file,
                                                      const Simulation& simulation,
                                                      const std::vector<std::string>& fields,
                                                      const RecordingOptions& options) {
  try {
    return worldio::recorded_components(simulation.world(), fields);
  } catch (const std::invalid_argument& error) {
    const engine::WorldSpec& spec = simulation.world().spec();
    if (!options.fields.empty() || !spec.record || !spec.files)
      throw InputError(fmt::format("{}: error: {}", file.string(), error.what()));
    throw InputError(Diagnostics(spec.files)
                         .text({Severity::error, spec.record->where_fields,
                                fmt::format("/record/fields: {}", error.what())}));
  }
}

/// Whether a file is locked through another file descriptor.
bool is_locked(const std::filesystem::path& file) {
  const worldio::Descriptor descriptor(file, O_WRONLY | O_NONBLOCK);
  return descriptor.get() >= 0 && worldio::lock_file(descriptor.get()) == worldio::FileLock::held;
}

/// Gives this process the turn to create a recording, until the result is destroyed. Otherwise two runs that
/// start at the same time could both find that no process writes the file: both would create it and write to
/// it, and the frames of one of them would be lost without an error. The turn is the lock of a partial file.
/// Throws InputError if another process has the turn. The result is null if the system does not allow a
/// partial file, for example because there is no such folder, which the caller then reports.
std::unique_ptr<worldio::PartialFile> turn_to_create(const std::filesystem::path& file) {
  try {
    auto turn = std::make_unique<worldio::PartialFile>(file);
    const std::filesystem::path first = std::filesystem::path(turn->target()).concat(".partial");
    if (turn->path() == first || !is_locked(first)) return turn;
  } catch (const std::system_error&) {
    return nullptr;
  }
  throw InputError(fmt::format(
      "{}: error: another process is creating the file: choose another file, or wait until the process has "
      "ended",
      file.string()));
}

/// Throws InputError if the file is open elsewhere. HDF5 locks each file that it opens, also one that a
/// program only reads. To replace such a file, HDF5 would first cut off its content, and then fail because of
/// the lock.
void check_not_open(const std::filesystem::path& file) {
  if (is_locked(file))
    throw InputError(
        fmt::format("{}: error: the file is open elsewhere, for example in a notebook: close it there, or "
                    "choose another file",
                    file.string()));
}

/// Throws InputError if the file of a new recording must not be created or replaced, or if the world lacks
/// a requested field. Returns the recorded components.
std::vector<worldio::RecordedComponent> checked_components(const std::filesystem::path& file,
                                                           const Simulation& simulation,
                                                           const RecordingOptions& options) {
  check_interval(options);
  worldio::require_hdf5_ending(file);
  std::error_code ignored;
  if (!options.replace && std::filesystem::exists(file, ignored))
    throw InputError(
        fmt::format("{}: error: the file exists; --force replaces it (in C++ and Python: the option replace)",
                    file.string()));
  if (std::filesystem::exists(file, ignored) && !std::filesystem::is_regular_file(file, ignored))
    throw InputError(fmt::format("{}: error: cannot be written: it is not a regular file", file.string()));
  if (std::filesystem::exists(file, ignored))
    if (const auto writer = worldio::writer_of(file))
      throw InputError(fmt::format(
          "{}: error: process {} is still writing the file: choose another file, or wait until the "
          "process has ended",
          file.string(), *writer));
  check_not_open(file);
  return components_of(file, simulation, fields_of(simulation, options), options);
}

/// Throws std::runtime_error if the recording belongs to another run than the simulation.
void check_same_run(const worldio::RecordingReader& recording, const Simulation& simulation) {
  const std::filesystem::path& file = recording.file();
  const auto value_of = [&](const std::string& key) {
    const auto known = recording.meta().find(key);
    return known == recording.meta().end() ? nullptr : &known->second;
  };
  if (const auto other = option_of_other_run(simulation.effective_options(), value_of))
    throw std::runtime_error(fmt::format(
        "{}: error: {} is {} in the recording, but \"{}\" in this run: the recording belongs to another run; "
        "choose another file",
        file.string(), other->key, other->in_file, other->here));
  const auto tick = std::ranges::find(recording.ticks(), simulation.tick());
  if (tick != recording.ticks().end() &&
      recording.hashes()[static_cast<std::size_t>(tick - recording.ticks().begin())] !=
          simulation.state_hash())
    throw std::runtime_error(
        fmt::format("{}: error: the state hash of tick {} differs from that of this run: the recording "
                    "belongs to another run; choose another file",
                    file.string(), simulation.tick()));
}

/// Throws std::runtime_error if the options state another interval or other fields than the recording has,
/// because these cannot change within a recording.
void check_same_options(const worldio::RecordingReader& recording, const Simulation& simulation,
                        const RecordingOptions& options) {
  const std::filesystem::path& file = recording.file();
  if (options.every_s > 0) {
    const std::uint64_t ticks = engine::period_ticks(options.every_s, simulation.tick_s());
    if (ticks != recording.every_ticks())
      throw std::runtime_error(
          fmt::format("{}: error: the recording has a frame every {:.10g} s, which cannot change, but "
                      "--record-every is {:.10g} s: omit --record-every (in C++: every_s)",
                      file.string(), static_cast<double>(recording.every_ticks()) * simulation.tick_s(),
                      options.every_s));
  }
  const std::string fields = worldio::join_field_names(options.fields);
  const auto recorded = recording.meta().find("record_fields");
  if (!fields.empty() && recorded != recording.meta().end() && recorded->second != fields)
    throw std::runtime_error(
        fmt::format("{}: error: the recording has the fields {}, which cannot change, but --record-fields is "
                    "{}: omit --record-fields (in C++: fields)",
                    file.string(), recorded->second, fields));
}

}  // namespace

struct Recording::Impl {
  worldio::RecordingWriter writer;
  std::filesystem::path file;
  const engine::World* world;  // of the recorded simulation: its address stays if the Simulation is moved
  std::uint64_t seed;          // of the recorded run
  std::uint64_t tick = 0;      // last tick that observe() has seen

  /// Throws std::logic_error if this is another simulation, or if the simulation has been reset.
  void require_same_run(const Simulation& simulation) {
    if (&simulation.world() != world)
      throw std::logic_error(fmt::format(
          "{}: error: the recording is of another simulation: give the simulation with which it was "
          "made",
          file.string()));
    if (simulation.seed() != seed || simulation.tick() < tick)
      throw std::logic_error(
          fmt::format("{}: error: the simulation was reset after tick {}, and a recording contains one run: "
                      "close this recording, and make another one after the reset",
                      file.string(), tick));
    tick = simulation.tick();
  }
};

Recording::Recording(const std::filesystem::path& file, const Simulation& simulation,
                     const RecordingOptions& options) {
  const std::unique_ptr<worldio::PartialFile> turn = turn_to_create(file);
  std::vector<worldio::RecordedComponent> components = checked_components(file, simulation, options);
  const worldio::RecordingHead head = head_of(simulation, options);
  try {
    impl_ = std::unique_ptr<Impl>(
        new Impl{{file, simulation.world(), std::move(components), head, options.in_background},
                 file,
                 &simulation.world(),
                 simulation.seed()});
  } catch (const worldio::Hdf5Error& error) {
    throw InputError(error.what());
  }
  observe(simulation);
}

Recording::Recording(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Recording::Recording(Recording&&) noexcept = default;
Recording& Recording::operator=(Recording&&) noexcept = default;
Recording::~Recording() = default;

Recording Recording::resume(const std::filesystem::path& file, const Simulation& simulation,
                            const RecordingOptions& options) {
  check_interval(options);
  worldio::repair_recording(file);
  {
    const worldio::RecordingReader recording(file);
    check_same_run(recording, simulation);
    check_same_options(recording, simulation, options);
  }
  Recording recording(std::unique_ptr<Impl>(new Impl{
      {file, simulation.world(), options.in_background}, file, &simulation.world(), simulation.seed()}));
  recording.observe(simulation);
  return recording;
}

void Recording::check(const std::filesystem::path& file, const Simulation& simulation,
                      const RecordingOptions& options) {
  static_cast<void>(checked_components(file, simulation, options));
  try {
    worldio::require_hdf5(file);
  } catch (const worldio::Hdf5Error& error) {
    throw InputError(error.what());
  }
}

void Recording::check_resume(const std::filesystem::path& file, const Simulation& simulation,
                             const RecordingOptions& options) {
  check_interval(options);
  const bool is_whole = worldio::frames_without_repair(file).has_value();
  check_not_open(file);
  std::optional<worldio::RecordingReader> recording;
  try {
    recording.emplace(file);
  } catch (const worldio::Hdf5Error&) {
    if (is_whole) throw;
    return;  // resume() repairs the file before it checks it
  }
  check_same_run(*recording, simulation);
  check_same_options(*recording, simulation, options);
  worldio::RecordingWriter::check(*recording, simulation.world());
}

void Recording::observe(const Simulation& simulation) {
  simulation.world().require_whole();
  if (!impl_->writer.is_open()) return;
  impl_->require_same_run(simulation);
  if (!impl_->writer.due(simulation.tick())) return;
  simulation.world().gather_distributed();
  impl_->writer.record(simulation.world(), simulation.state_hash());
}

void Recording::flush() { impl_->writer.flush(); }

void Recording::start_flush() { impl_->writer.start_flush(); }

void Recording::close() { impl_->writer.close(); }

}  // namespace troupe
