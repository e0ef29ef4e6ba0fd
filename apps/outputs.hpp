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

/// A file that cannot be written, found out before anything was.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws OutputError: `file: error: cannot be written: reason`.
[[noreturn]] void refuse_output(const std::filesystem::path& file, std::string_view reason);

/// What a run reads.
struct Input {
  std::filesystem::path file;
  std::string_view what;  ///< for people: "the world"
};
/// Checks that each of `outputs` (empty paths count as none) can be written: its folder exists and may be
/// written in, it is no folder itself, and it is neither an input nor another output. Creates nothing, so
/// that a world that turns out wrong afterwards leaves nothing behind. Throws OutputError.
void check_outputs(const std::vector<Input>& inputs, const std::vector<std::filesystem::path>& outputs);
/// Checks that files can be written into a folder (an empty path counts as none), which may have to be made
/// first. Creates nothing. Throws OutputError.
void check_folder(const std::filesystem::path& folder);
/// Whether two names stand for one file, that may not be there yet.
bool same_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// A hash log, streamed: each line is in the file when its tick has ended.
class HashLog : public Observer {
 public:
  /// Opens the file and writes the header. Where the simulation goes on from a checkpoint, and the file is
  /// there, it is a log that holds this tick with this state: it is cut behind it, and goes on. Throws
  /// OutputError, or InputError for what is no such log.
  HashLog(const std::filesystem::path& file, const Simulation& simulation);

  /// Writes the line of the simulation's tick. Throws std::runtime_error when the disk is full.
  void observe(const Simulation& simulation) override;

 private:
  std::filesystem::path file_;
  std::ofstream stream_;
  std::optional<std::uint64_t> written_;  // the last tick of a log that goes on
};

/// --hash-log.
std::unique_ptr<RunOutput> hash_log_output();

}  // namespace troupe::apps
