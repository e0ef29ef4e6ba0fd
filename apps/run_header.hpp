#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>

namespace troupe::apps {

/// The options of a run and the version of the program, as a result file of the run stores them. In a hash
/// log (a text file with the hash of the state after each tick), they are the header. In a recording (an HDF5
/// file with the state over time), they are the group /meta.
struct RunHeader {
  /// The value of one key, such as `seed`.
  struct Entry {
    std::string value;     ///< value as text
    std::size_t line = 0;  ///< line number in the file; 0: not a text file
  };
  std::filesystem::path file;            ///< file that contains the header
  std::map<std::string, Entry> entries;  ///< by key: version, world, seed, ...
};

/// Compares the headers of two result files, and throws InputError if they differ. The error has one line per
/// difference. A line begins with the name of the second file and, for text files, a line number.
///
/// - By default, both runs must have the same version of Troupe, compiler, compiler flags and instruction
///   set. With `across_domains`, these may differ.
/// - By default, both runs must have the same world, seed and options. With `across_runs`, these may differ.
///   World files are compared by their names without folders.
/// - Values that change no result are never compared. Examples are the number of threads, the tile size
///   (--tile-size, which divides robots into tasks) and the fields of a recording.
void refuse_unlike(const RunHeader& first, const RunHeader& second, bool across_domains, bool across_runs);

}  // namespace troupe::apps
