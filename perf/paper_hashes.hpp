#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace troupe::perf {

/// The checked-in state hashes: scene and tick -> hash, one per line.
class HashBook {
 public:
  /// Reads the file; a missing file is an empty book. Throws std::runtime_error, with the line, for an
  /// invalid line.
  explicit HashBook(std::filesystem::path file);

  std::optional<std::uint64_t> find(const std::string& scene, std::uint64_t tick) const;
  void record(const std::string& scene, std::uint64_t tick, std::uint64_t hash) {
    hashes_[{scene, tick}] = hash;
  }
  /// Writes the file, sorted. Throws std::runtime_error.
  void save() const;

  const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path file_;
  std::map<std::pair<std::string, std::uint64_t>, std::uint64_t> hashes_;
};

}  // namespace troupe::perf
