#pragma once

#include "apps/observers/observer.hpp"
#include "apps/run/run_output.hpp"
#include "worldio/results/descriptor.hpp"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>

namespace troupe::apps {

/// Writes a hash log: a text file with one line per tick (time step). A line contains the hashes of the
/// state after the tick, and is written to the file at the end of the tick.
class HashLog : public Observer {
 public:
  /// Prepares the log, and writes nothing. If the simulation was resumed from a checkpoint (saved state of a
  /// run) and the file exists, the run continues this log. Throws OutputError if the log to continue belongs
  /// to another run:
  ///
  /// - The log has no line for the tick of the checkpoint, or the line has other hashes than the checkpoint.
  /// - The header of the log has other options than this run. Options that a resumed run may change, or that
  ///   change no result, are not compared.
  ///
  /// Throws InputError if the file to continue is not a hash log or is damaged.
  HashLog(const std::filesystem::path& file, const Simulation& simulation);
  /// Opens the file and writes the header. If the run continues a log, keeps its lines up to the tick of the
  /// checkpoint instead, and removes the later lines. Call it once, before observe(). Throws OutputError if
  /// the file cannot be written, or if another process is writing it as a hash log.
  void open();

  /// Writes the line of the current tick. Does nothing if the log was continued and already ends with this
  /// line. Throws std::runtime_error if writing fails, for example because the disk is full. The file then
  /// contains only whole lines.
  void observe(const Simulation& simulation) override;
  bool reads_robots() const override { return false; }

 private:
  std::filesystem::path file_;
  std::ofstream stream_;
  worldio::Descriptor lock_;
  std::string header_;                    // of a new log, until it is in the file
  std::optional<std::uint64_t> written_;  // the last tick of a continued log
  std::uintmax_t whole_bytes_ = 0;  // length of the lines in the file, or of those that a continued log keeps
};

/// Returns the RunOutput for a hash log (HashLog). A RunOutput is one output of a run, together with its
/// command-line options. The option --hash-log names the file. Without --hash-log, nothing is written.
std::unique_ptr<RunOutput> hash_log_output();

}  // namespace troupe::apps
