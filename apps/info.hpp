#pragma once

#include "apps/exit_code.hpp"

#include <filesystem>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}  // namespace CLI

namespace troupe::apps {

/// Adds `info` to the program; parsing fills `file`, which must outlive `app`.
CLI::App* add_info_command(CLI::App& app, std::filesystem::path& file);

/// `troupe info FILE`: what kind of file of ours it is, found out from its content, and what it holds, on
/// standard output. Throws InputError where it is none, or is one that cannot be read.
ExitCode info(const std::filesystem::path& file);

}  // namespace troupe::apps
