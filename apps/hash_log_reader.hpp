#pragma once

#include "apps/run_header.hpp"
#include "engine/fields/state_table.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

namespace troupe::apps {

/// The first line of every hash log.
inline constexpr std::string_view k_hash_log_mark = "# troupe hash log 1";

/// Reads a hash log (troupe run --hash-log), a text file with hashes of the simulation state after every tick
/// (time step). Reads the file line by line, because it may be gigabytes long. An error in the file is
/// thrown as InputError, with file and line: `run.log:31: error: ...`.
class HashLogReader {
 public:
  /// Opens the file and reads its header. Throws InputError if the file cannot be read or is not a hash log.
  explicit HashLogReader(const std::filesystem::path& file);

  const std::filesystem::path& file() const { return header_.file; }
  /// Returns the header lines `# key: value`, with their line numbers.
  const RunHeader& header() const { return header_; }

  /// The hashes of one tick (time step).
  struct Line {
    std::size_t number;   ///< line number in the file, from 1
    std::string text;     ///< the whole line, without its line break
    std::uint64_t tick;   ///< tick of the state; 0: the state as loaded
    std::uint64_t state;  ///< hash of the whole state
    /// Hashes of the four groups of the state, indexed by engine::HashGroup: pose, velocity, sensor, memory.
    /// Their sum, modulo 2^64, is `state`.
    std::array<std::uint64_t, engine::k_hash_groups> groups;
  };
  /// Returns the hashes of the next tick, or std::nullopt at the end of the log. The first call returns the
  /// first line below the header. Throws InputError if the line is incomplete or malformed, if it is not the
  /// line of the next tick, or if `state` is not the sum of `groups`.
  std::optional<Line> next();

 private:
  bool read_line(std::string& line);
  void read_header(const std::string& line);
  Line parse(const std::string& line) const;
  [[noreturn]] void fail(const std::string& message) const;

  RunHeader header_;
  std::ifstream stream_;
  std::size_t number_ = 0;
  std::optional<std::string> ahead_;  // the first line after the header
  std::optional<std::uint64_t> last_tick_;
};

}  // namespace troupe::apps
