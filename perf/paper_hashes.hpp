#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace troupe::perf {

/// The recorded state hashes with which results are compared. A state hash is computed from the whole state
/// of a simulation after a tick (time step). The file, by default perf/paper_hashes.txt, has one line
/// per hash, with the name of the scene, the tick and the hash in hexadecimal digits.
class HashBook {
 public:
  /// Reads the file. If it does not exist, there are no hashes. Throws std::runtime_error, with file and
  /// line, if a line is invalid.
  explicit HashBook(std::filesystem::path file);

  /// Returns the recorded hash of a scene at a tick; empty if there is none. scene: name of a scene, such as
  /// "hospital/2000": a world with a number of robots.
  std::optional<std::uint64_t> find(const std::string& scene, std::uint64_t tick) const;
  /// Sets the hash of a scene at a tick; save() writes it.
  void record(const std::string& scene, std::uint64_t tick, std::uint64_t hash) {
    hashes_[{scene, tick}] = hash;
  }
  /// Writes the file, sorted by scene and tick. Throws std::runtime_error if it cannot be written.
  void save() const;

  const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path file_;
  std::map<std::pair<std::string, std::uint64_t>, std::uint64_t> hashes_;
};

}  // namespace troupe::perf
