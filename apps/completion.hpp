#pragma once

#include "apps/command_table.hpp"
#include "apps/exit_code.hpp"

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}  // namespace CLI

namespace troupe::apps {

/// The shells for which there are completion scripts.
inline constexpr std::array<std::string_view, 3> k_shells{"bash", "zsh", "fish"};

/// Returns a completion script. The script completes commands, options, and the values of options whose
/// placeholder lists words of lower-case letters, digits and hyphens ("exact|grid"). It offers file names for
/// values whose placeholder contains FILE or DIR. It also offers file names for the positional arguments of
/// commands that `arguments` does not list. For other values it offers nothing. shell: one of k_shells;
/// commands: the result of command_table(); arguments: maps the name of a command to the allowed values of
/// its positional argument.
std::string completion(std::string_view shell, const std::vector<Command>& commands,
                       const std::map<std::string, std::vector<std::string>>& arguments);

/// Adds the options of `completion`; parsing fills `shell`, which must outlive `command`.
void add_completion_options(CLI::App& command, std::string& shell);
/// `troupe completion`: prints the script for a shell, one of k_shells, on standard output.
ExitCode print_completion(const std::string& shell);

}  // namespace troupe::apps
