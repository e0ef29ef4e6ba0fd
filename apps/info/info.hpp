#pragma once

#include "apps/exit_code.hpp"

#include <filesystem>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}  // namespace CLI

namespace troupe::apps {

/// Options of `troupe info`.
struct InfoOptions {
  std::filesystem::path file;                      ///< file to summarise, of any type that Troupe uses
  std::vector<std::filesystem::path> plugin_path;  ///< folders to search for plug-ins
};

/// Adds the options of `info`; parsing fills `options`, which must outlive `command`.
void add_info_options(CLI::App& command, InfoOptions& options);

/// `troupe info FILE`: prints the type of a Troupe file, detected from its content, and a summary of it on
/// standard output. Throws InputError if the file is not a Troupe file or cannot be read.
ExitCode info(const InfoOptions& options);

}  // namespace troupe::apps
