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

/// Adds `info` to the program; parsing fills `options`, which must outlive `app`.
CLI::App* add_info_command(CLI::App& app, InfoOptions& options);

/// `troupe info FILE`: what kind of file of ours it is, found out from its content, and what it holds, on
/// standard output. Throws InputError where it is none, or is one that cannot be read.
ExitCode info(const InfoOptions& options);

}  // namespace troupe::apps
