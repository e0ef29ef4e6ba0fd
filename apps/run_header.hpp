#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>

namespace troupe::apps {

/// The description of a run that its results contain: the header of a hash log, or the group /meta of a
/// recording.
struct RunHeader {
  /// The value of a key.
  struct Entry {
    std::string value;     ///< value as text
    std::size_t line = 0;  ///< line number in the file; 0: not a text file
  };
  std::filesystem::path file;            ///< file that contains the header
  std::map<std::string, Entry> entries;  ///< by key: version, world, seed, ...
};

/// Throws InputError if the two headers differ. The error has one line per difference, which begins with the
/// name of the second file and, for text files, a line number. World files are compared by their names
/// without folders. With `across_domains`, versions of Troupe, compilers, flags and instruction sets may
/// differ. With `across_runs`, worlds, seeds and options may differ. Numbers of threads, tile sizes
/// (--tile-size, which divides robots into tasks), recorded fields and recording intervals are not compared,
/// because they change no result.
void refuse_unlike(const RunHeader& first, const RunHeader& second, bool across_domains, bool across_runs);

}  // namespace troupe::apps
