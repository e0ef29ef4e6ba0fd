#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>

namespace troupe::apps {

/// The description of a run that its results contain: the header of a hash log, or the group /meta of a
/// recording.
struct RunHeader {
  struct Entry {
    std::string value;
    std::size_t line = 0;  ///< line number in the file; 0: not a text file
  };
  std::filesystem::path file;
  std::map<std::string, Entry> entries;
};

/// Throws InputError if the two headers differ, with one line per difference that begins with the place in
/// the second file. Compares versions, compilers, flags and instruction sets unless `across_domains`; worlds,
/// seeds and options unless `across_runs`. Threads, tile size, recorded fields and recording interval are not
/// compared, because they change no result.
void refuse_unlike(const RunHeader& first, const RunHeader& second, bool across_domains, bool across_runs);

}  // namespace troupe::apps
