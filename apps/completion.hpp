#pragma once

#include "apps/cli_app.hpp"
#include "apps/command_table.hpp"
#include "apps/exit_code.hpp"

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::apps {

/// The shells for which there are completion scripts.
inline constexpr std::array<std::string_view, 3> k_shells{"bash", "zsh", "fish"};

/// Returns a script that completes the command line of the program in a shell. The script completes the names
/// of commands and options, and these values:
///
/// - The placeholder of an option's value (CommandOption::value) may list values, such as "exact|grid". The
///   script offers those that consist of lower-case letters, digits and hyphens.
/// - If the placeholder contains FILE or DIR, the script offers file names.
/// - For a positional argument, the script offers the values that `arguments` has for the command. If
///   `arguments` has none, it offers file names.
///
/// shell: one of k_shells
/// commands: the result of command_table()
/// arguments: for the name of a command, the allowed values of its positional argument
std::string completion(std::string_view shell, const std::vector<Command>& commands,
                       const std::map<std::string, std::vector<std::string>>& arguments);

/// Adds the options of `completion`. Parsing stores the name of the shell in `shell`, which must outlive
/// `command`.
void add_completion_options(CLI::App& command, std::string& shell);
/// `troupe completion`: prints the script for a shell, one of k_shells, on standard output.
ExitCode print_completion(const std::string& shell);

}  // namespace troupe::apps
