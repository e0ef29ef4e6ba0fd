#pragma once

#include "apps/observers/observer.hpp"
#include "apps/run/run_output.hpp"
#include "troupe/script.hpp"
#include "troupe/simulation.hpp"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::apps {

/// Thrown if an output file cannot be written or must not be replaced. Commands that run a world throw it
/// before the first tick.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws OutputError: `file: error: cannot be written: reason`.
[[noreturn]] void refuse_output(const std::filesystem::path& file, std::string_view reason);

/// A file that a run reads, which no output may replace.
struct Input {
  std::filesystem::path file;
  std::string_view what;  ///< what the file is, for messages: "the world"
};
/// Checks that each of `outputs` can be written, and throws OutputError if one cannot. The folder of an
/// output must exist. If the file exists, the file must be writable, else the folder. The path must name
/// neither a folder, nor one of `inputs`, nor another output. Empty paths are skipped. The function creates
/// nothing, so that an invalid world leaves no files.
void check_outputs(const std::vector<Input>& inputs, const std::vector<std::filesystem::path>& outputs);
/// Appends to `inputs` the files that the world of a simulation was read from. Appends nothing for a
/// simulation that was resumed from a checkpoint.
void add_inputs(const Simulation& simulation, std::vector<Input>& inputs);
/// Appends the files of Python scripts with controllers (--controller) to `inputs`.
void add_inputs(std::span<const std::shared_ptr<const Script>> scripts, std::vector<Input>& inputs);
/// Checks that files can be written into a folder. If the folder does not exist yet, checks that its parent
/// folder exists and is writable. Throws OutputError if a check fails. Ignores an empty path. Creates no file
/// or folder.
void check_folder(const std::filesystem::path& folder);

/// Writes a hash log: a text file with one line per tick (simulation step), which contains the hashes of the
/// state after this tick. Each line is written to the file at the end of its tick.
class HashLog : public Observer {
 public:
  /// Opens the file and writes the header. If the simulation was resumed from a checkpoint (saved state of a
  /// run) and the file exists, the log is continued, and its lines after the tick of the checkpoint are
  /// removed. To be continued, the log must contain this tick with the same hashes, and its header must have
  /// the same options as this run, apart from options that a resumed run may change. Throws OutputError if
  /// the file cannot be written or continued, and InputError if the existing file is not a hash log.
  HashLog(const std::filesystem::path& file, const Simulation& simulation);

  /// Writes the line of the current tick, unless a continued log already ends with it. Throws
  /// std::runtime_error if writing fails, for example because the disk is full.
  void observe(const Simulation& simulation) override;
  bool reads_robots() const override { return false; }

 private:
  std::filesystem::path file_;
  std::ofstream stream_;
  std::optional<std::uint64_t> written_;  // the last tick of a continued log
};

/// Returns the output of a run (an object with command-line options, see RunOutput) that writes a HashLog. It
/// adds the option --hash-log to the command line, and writes the log to the file that --hash-log names.
/// Without --hash-log, nothing is written.
std::unique_ptr<RunOutput> hash_log_output();

}  // namespace troupe::apps
