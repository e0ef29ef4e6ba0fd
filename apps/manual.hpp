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

/// Returns the manual page troupe(1) in roff with the macros of `man`. It contains every command with its
/// options and the texts of --help.
///
/// commands: the result of known_commands()
/// version: version of the program, which is printed at the foot of each page
std::string manual_page(const std::vector<Command>& commands, std::string_view version);

/// The options of `troupe manual`: none.
struct ManualOptions {};
inline void add_manual_options(CLI::App&, ManualOptions&) {}
/// `troupe manual`: prints manual_page() on standard output.
ExitCode print_manual(const ManualOptions& options);

}  // namespace troupe::apps
