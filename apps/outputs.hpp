#pragma once

#include "apps/observers/observer.hpp"
#include "apps/run/run_output.hpp"
#include "troupe/simulation.hpp"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::apps {

/// A file that cannot be written. Thrown before anything is written.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws OutputError: `file: error: cannot be written: reason`.
[[noreturn]] void refuse_output(const std::filesystem::path& file, std::string_view reason);

/// A file that a run reads.
struct Input {
  std::filesystem::path file;
  std::string_view what;  ///< its name in messages: "the world"
};
/// Checks that each of `outputs` (empty paths are skipped) can be written: its folder exists and is writable,
/// it is not a folder itself, and it is neither an input nor another output. Creates nothing, so that an
/// invalid world leaves no files. Throws OutputError.
void check_outputs(const std::vector<Input>& inputs, const std::vector<std::filesystem::path>& outputs);
/// Checks that files can be written into a folder (an empty path is skipped), which need not exist yet.
/// Creates nothing. Throws OutputError.
void check_folder(const std::filesystem::path& folder);
/// Whether two paths name the same file, which need not exist yet.
bool same_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// Writes a hash log; each line is in the file at the end of its tick.
class HashLog : public Observer {
 public:
  /// Opens the file and writes the header. If the simulation was resumed from a checkpoint and the file
  /// exists, the file must be a log with the checkpoint's tick and state: it is cut after that tick and
  /// continued. Throws OutputError, or InputError if the file is not a hash log.
  HashLog(const std::filesystem::path& file, const Simulation& simulation);

  /// Writes the line of the simulation's tick. Throws std::runtime_error if writing fails (disk full).
  void observe(const Simulation& simulation) override;

 private:
  std::filesystem::path file_;
  std::ofstream stream_;
  std::optional<std::uint64_t> written_;  // the last tick of a continued log
};

/// The output of --hash-log.
std::unique_ptr<RunOutput> hash_log_output();

}  // namespace troupe::apps
