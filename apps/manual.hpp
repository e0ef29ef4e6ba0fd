#pragma once

#include "apps/command_table.hpp"
#include "apps/exit_code.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}  // namespace CLI

namespace troupe::apps {

/// Returns the manual page troupe(1), written in the man macros of roff: every command with its options and
/// the texts of --help. `version` is printed at the foot of each page.
std::string manual_page(const std::vector<Command>& commands, std::string_view version);

/// `troupe manual` has no options.
struct ManualOptions {};
inline void add_manual_options(CLI::App&, ManualOptions&) {}
/// `troupe manual`: prints manual_page() on standard output.
ExitCode print_manual(const ManualOptions& options);

}  // namespace troupe::apps
