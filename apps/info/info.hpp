#pragma once

#include "apps/exit_code.hpp"

#include <filesystem>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}  // namespace CLI

namespace troupe::apps {

/// What the command line of `troupe info` asks for.
struct InfoOptions {
  std::filesystem::path file;
  std::vector<std::filesystem::path> plugin_path;  ///< of a world's controllers and sensors
};

/// Adds the options of `info`; parsing fills `options`, which must outlive `command`.
void add_info_options(CLI::App& command, InfoOptions& options);

/// `troupe info FILE`: what kind of file of ours it is, found out from its content, and what it holds, on
/// standard output. Throws InputError where it is none, or is one that cannot be read.
ExitCode info(const InfoOptions& options);

}  // namespace troupe::apps
