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

/// What the command line of `troupe convert` asks for.
struct ConvertOptions {
  std::filesystem::path in;
  std::filesystem::path out;
  bool force = false;  ///< an output that exists may be replaced
  std::vector<std::pair<std::string, std::string>> set;
  std::vector<std::filesystem::path> plugin_path;
};

/// Adds the options of `convert`; parsing fills `options`, which must outlive `command`.
void add_convert_options(CLI::App& command, ConvertOptions& options);

/// Writes a world in another format, or in the normal form of its own, and says so in a line. Throws
/// InputError where the world cannot be loaded, or not be said in the other format.
ExitCode convert(const ConvertOptions& options);

}  // namespace troupe::apps
