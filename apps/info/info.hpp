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
  std::filesystem::path file;                      ///< file to summarise
  std::vector<std::filesystem::path> plugin_path;  ///< folders to search for plug-ins (shared libraries)
};

/// Adds the options of `info`; parsing fills `options`, which must outlive `command`.
void add_info_options(CLI::App& command, InfoOptions& options);

/// `troupe info FILE`: prints the type of a file, detected from its content, and a summary of the file on
/// standard output. The file may be a world (Stage's or JSON), a hash log, a recording, a checkpoint (saved
/// state of a run), a table of measures (numbers computed during a run) or of events, or a profile (timing of
/// a run). Throws InputError for any other file and for a file that cannot be read.
ExitCode info(const InfoOptions& options);

}  // namespace troupe::apps
