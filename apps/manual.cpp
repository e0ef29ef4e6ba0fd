#include "apps/manual.hpp"

#include "apps/command_line.hpp"
#include "troupe/version.hpp"

#include <fmt/format.h>

#include <sstream>

namespace troupe::apps {
namespace {

/// Escapes the characters that have a meaning in roff.
std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
  }
  if (out.starts_with('.') || out.starts_with('\'')) return fmt::format("\\&{}", out);
  return out;
}

/// Returns the entry of an option in the manual page.
std::string option_text(const CommandOption& option) {
  std::string text;
  for (const std::string& name : option.names)
    text += fmt::format("{}\\fB{}\\fR", text.empty() ? "" : ", ", escaped(name));
  if (!option.value.empty()) text += fmt::format(" \\fI{}\\fR", escaped(option.value));
  return fmt::format(".TP\n{}\n{}\n", text, escaped(option.help));
}

/// Converts the text below the options of a command (Command::footer) to roff. The lines of paragraphs are
/// filled, and indented lines are kept as they are.
std::string footer_text(const std::string& footer) {
  std::istringstream lines(footer);
  std::string text;
  bool stands = false;
  for (std::string line; std::getline(lines, line);) {
    const bool indented = line.starts_with("  ");
    if (indented != stands) text += indented ? ".nf\n" : ".fi\n";
    stands = indented;
    text += line.empty() ? ".PP\n" : fmt::format("{}\n", escaped(line));
  }
  return stands ? text + ".fi\n" : text;
}

/// Returns the manual page. commands: the result of known_commands(); version: version of the program, which
/// is printed at the foot of each page
std::string manual_page(const std::vector<Command>& commands, std::string_view version) {
  std::string text = fmt::format(".TH TROUPE 1 \"\" \"troupe {}\" \"User Commands\"\n", escaped(version));
  const Command& program = commands.front();
  text += ".SH NAME\ntroupe \\- a simulator of very large swarms of mobile robots\n";
  text += ".SH SYNOPSIS\n";
  for (const Command& command : commands)
    if (&command != &program) {
      std::string arguments;
      for (const CommandOption& option : command.options)
        if (option.positional)
          arguments += option.value.empty() ? fmt::format(" \\fI{}\\fR", escaped(option.names.front()))
                                            : fmt::format(" \\fI{}\\fR {}", escaped(option.names.front()),
                                                          escaped(option.value));
      text += fmt::format(".B troupe {}\n[\\fIoptions\\fR]{}\n.br\n", command.name, arguments);
    }
  text += fmt::format(".SH DESCRIPTION\n{}\n", escaped(program.help));
  for (const CommandOption& option : program.options) text += option_text(option);
  text += ".SH COMMANDS\n";
  for (const Command& command : commands) {
    if (&command == &program) continue;
    text += fmt::format(".SS troupe {}\n{}.\n", command.name, escaped(command.help));
    for (const CommandOption& option : command.options) text += option_text(option);
    text += footer_text(command.footer);
  }
  text +=
      ".SH ENVIRONMENT\n.TP\n.B TROUPE_PLUGIN_PATH\nFolders with plug\\-ins, separated by colons.\n"
      ".TP\n.B STAGEPATH\nFolders searched for worlds, included files and plug\\-ins.\n"
      ".TP\n.B TROUPE_SIMD\nInstruction set for range finding, if \\-\\-simd is not given.\n"
      ".TP\n.B TROUPE_PYTHON\nPython interpreter for \\-\\-controller and for the command plot.\n"
      ".TP\n.B TROUPE_MPI\nModule that connects the processes of a launcher: openmpi, mpich, or a file "
      "(default: the module for the MPI of the launcher).\n"
      ".TP\n.B SLURM_CPUS_PER_TASK\nUnder a launcher of several processes: number of threads of each "
      "process, if \\-\\-threads is not given.\n";
  return text;
}

}  // namespace

ExitCode print_manual(const ManualOptions&) {
  fmt::print("{}", manual_page(known_commands(), k_version));
  return k_finished;
}

}  // namespace troupe::apps
