#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>

namespace troupe::apps {

/// What a result says about the run that wrote it: the header of a hash log, /meta of a recording.
struct RunHeader {
  struct Entry {
    std::string value;
    std::size_t line = 0;  ///< where it stands; 0: not in a line
  };
  std::filesystem::path file;
  std::map<std::string, Entry> entries;
};

/// Throws InputError with what the two do not have in common, a line each that stands where the second says
/// it: other versions, compilers, flags or instruction sets unless `across_domains`, other worlds, seeds or
/// options unless `across_runs`. Threads and tile size change no result, and what was recorded and how often
/// neither.
void refuse_unlike(const RunHeader& first, const RunHeader& second, bool across_domains, bool across_runs);

}  // namespace troupe::apps
