#include "perf/paper_hashes.hpp"

#include <fmt/format.h>

#include <fstream>
#include <sstream>
#include <stdexcept>

namespace troupe::perf {

HashBook::HashBook(std::filesystem::path file) : file_(std::move(file)) {
  std::ifstream stream(file_);
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    if (line.empty() || line.starts_with('#')) continue;
    std::istringstream words(line);
    std::string scene;
    std::uint64_t tick = 0;
    std::uint64_t hash = 0;
    if (!(words >> scene >> tick >> std::hex >> hash))
      throw std::runtime_error(fmt::format(
          "{}:{}: error: expected a scene, a tick and a hash of 16 hexadecimal digits, as in: hospital/1 60 "
          "0123456789abcdef",
          file_.string(), number));
    record(scene, tick, hash);
  }
}

std::optional<std::uint64_t> HashBook::find(const std::string& scene, std::uint64_t tick) const {
  const auto found = hashes_.find({scene, tick});
  return found == hashes_.end() ? std::nullopt : std::optional(found->second);
}

void HashBook::save() const {
  std::ofstream stream(file_);
  stream
      << "# Expected state hashes of perf_paper, ranges included; `perf_paper --write-hashes` records them.\n"
         "# A changed line means changed results: see docs/decisions.md.\n"
         "# scene tick hash\n";
  for (const auto& [key, hash] : hashes_)
    stream << fmt::format("{:<36} {:>5} {:016x}\n", key.first, key.second, hash);
  stream.flush();
  if (!stream) throw std::runtime_error(fmt::format("{}: error: cannot be written", file_.string()));
}

}  // namespace troupe::perf
