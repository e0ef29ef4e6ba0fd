#pragma once

#include "apps/exit_code.hpp"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}

namespace troupe::apps {

/// Options of `troupe convert`.
struct ConvertOptions {
  std::filesystem::path in;   ///< world file to read
  std::filesystem::path out;  ///< world file to write; its ending selects the format
  bool force = false;         ///< replace an existing output file
  /// Values of the world to replace: pairs of a JSON pointer and a JSON value (SimulationOptions::set).
  std::vector<std::pair<std::string, std::string>> set;
  std::vector<std::filesystem::path> plugin_path;  ///< folders to search for plug-ins (shared libraries)
};

/// Adds the options of `convert`; parsing fills `options`, which must outlive `command`.
void add_convert_options(CLI::App& command, ConvertOptions& options);

/// `troupe convert`: reads a world, writes it to another file, and prints one line with the numbers of models
/// and types. Each of the two files is in one of two formats, Stage's or JSON; both may have the same format.
/// A JSON output of a JSON world lists each body of a population (an entry that creates many bodies by a
/// rule) instead of the rule. Throws InputError if the world cannot be loaded or cannot be expressed in the
/// format of the output. If the output exists (without `force`) or cannot be written, prints an error and
/// returns k_bad_input.
ExitCode convert(const ConvertOptions& options);

}  // namespace troupe::apps
