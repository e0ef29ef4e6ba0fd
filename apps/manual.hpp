#pragma once

#include "apps/cli_app.hpp"
#include "apps/exit_code.hpp"

namespace troupe::apps {

/// The options of `troupe manual`: none.
struct ManualOptions {};
inline void add_manual_options(CLI::App&, ManualOptions&) {}
/// `troupe manual`: prints the manual page troupe(1) on standard output, in roff with the macros of `man`.
/// The page contains every command with its options and the texts of --help.
ExitCode print_manual(const ManualOptions& options);

}  // namespace troupe::apps
