#include "apps/command_line.hpp"

#include "apps/command_table.hpp"
#include "apps/commands.hpp"
#include "apps/exit_code.hpp"
#include "apps/messages.hpp"
#include "apps/options.hpp"
#include "apps/outputs.hpp"
#include "apps/ranks/ranks.hpp"
#include "apps/scripts.hpp"
#include "base/diagnostics.hpp"
#include "partition/simd_target.hpp"
#include "troupe/version.hpp"

#include <CLI/CLI.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <any>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <functional>
#include <iostream>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::apps {
namespace {

constexpr const char* k_troupe_footer = R"(
Examples:
  troupe run worlds/hospital.json --for 60 --snapshot hospital.png
  troupe check worlds/crowd.json --for 5
  troupe render worlds/cave-simple.json -o cave.png --camera perspective
  troupe lint worlds/hospital.json
  troupe convert worlds/minimal.world minimal.json
  troupe describe ranger
  troupe help run)";

/// Opens standard streams that the caller has closed, in a mode in which using them fails. Otherwise the
/// first file that the program opens for writing would get the file descriptor of standard output, and the
/// summary would be written into this file.
void fill_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) < 0)
      static_cast<void>(open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY));
}

std::vector<std::string> words_of(const CLI::App& app) {
  std::vector<std::string> words;
  for (const CLI::Option* option : app.get_options())
    if (!option->get_lnames().empty()) words.push_back("--" + option->get_lnames().front());
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    words.push_back(command->get_name());
  return words;
}

/// Returns one line with the error in the command line and with the command that prints the help.
std::string usage_text(const CLI::App& app, const CLI::ParseError& error) {
  const auto commands = app.get_subcommands();
  const bool in_command = !commands.empty() && app.remaining(false).empty();
  const CLI::App& scope = in_command ? *commands.front() : app;
  const std::string name = in_command ? "troupe " + scope.get_name() : "troupe";
  std::string message = error.what();
  if (error.get_name() == "ArgumentMismatch") {
    // CLI11's message begins with the name: without dashes for a switch that was given a value, with dashes
    // for an option with too many or too few values.
    message = message.starts_with('-')
                  ? fmt::format("{} must be given once, with one value", message.substr(0, message.find(':')))
                  : fmt::format("--{} takes no value", message.substr(0, message.find(' ')));
  } else if (const std::vector<std::string> extras = app.remaining(true); !extras.empty()) {
    const std::string& word = extras.front();
    if (word.starts_with('-') || !in_command) {
      const std::vector<std::string> known = words_of(scope);
      message = fmt::format("unknown {} \"{}\"{}", word.starts_with('-') ? "option" : "command", word,
                            did_you_mean(word, std::vector<std::string_view>(known.begin(), known.end())));
    } else {
      message = fmt::format("one argument too many: \"{}\"", word);
    }
  }
  return fmt::format("{}: error: {}; see {} --help\n", name, message, name);
}

/// Returns the arguments after the program's name. Splits `--option=` into `--option` and an empty value, if
/// the option takes a value: CLI11 would take the next argument as its value.
std::vector<std::string> split_arguments(const CLI::App& app, int argc, const char* const* argv) {
  std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
  const auto command_in_front = [&] {
    return app.get_subcommands(
        [&](const CLI::App* one) { return !arguments.empty() && one->get_name() == arguments.front(); });
  };
  // `troupe help COMMAND` is `troupe COMMAND --help`, unless there is no such command, which is an error.
  if (!arguments.empty() && arguments.front() == "help") {
    arguments.erase(arguments.begin());
    if (arguments.empty() || !command_in_front().empty()) arguments.emplace_back("--help");
  }
  const auto commands = command_in_front();
  for (std::size_t i = 1; !commands.empty() && i < arguments.size(); ++i) {
    if (arguments[i].find('=') + 1 != arguments[i].size()) continue;
    const std::string name = arguments[i].substr(0, arguments[i].size() - 1);
    const CLI::Option* option =
        name.starts_with("--") ? commands.front()->get_option_no_throw(name) : nullptr;
    if (!option || option->get_items_expected_max() == 0) continue;
    arguments[i] = name;
    arguments.emplace(arguments.begin() + static_cast<std::ptrdiff_t>(i) + 1);
  }
  return arguments;
}

/// Returns the text that --version prints.
std::string version_text() {
  std::string usable;
  for (const std::string& name : partition::simd_targets().usable)
    usable += fmt::format("{}{}", usable.empty() ? "" : " ", name);
  return fmt::format("{} simd {} (available: {})", version_line(), partition::simd_target(), usable);
}

using ProgramCommands = std::vector<std::unique_ptr<ProgramCommand>>;

/// Adds every command to the parser `app`, which then fills ProgramCommand::options().
void add_commands(CLI::App& app, const ProgramCommands& commands) {
  app.get_formatter()->column_width(26);
  app.footer(k_troupe_footer);
  app.require_subcommand(0, 1);  // a second command would be parsed and then ignored
  app.set_version_flag(
      "--version", [] { return version_text(); }, "Print version, compiler, flags and instruction sets");
  for (const auto& command : commands)
    command->add_options(*app.add_subcommand(command->name(), command->help()));
}

ExitCode run_command(const CLI::App& app, const ProgramCommands& commands,
                     const std::function<void(const std::any&)>& limit) {
  for (const auto& command : commands) {
    if (!app.get_subcommand(command->name())->parsed()) continue;
    if (limit) limit(command->options());
    if (!command->runs_on_ranks() && is_refused_on_ranks(command->name())) return k_bad_input;
    return command->run();
  }
  print_usage_error(app.help());
  return k_bad_input;
}

/// Flushes standard output and returns `code`, the exit code of a command. Throws std::runtime_error if
/// output was lost (full disk, closed stream), unless `code` already reports bad input.
int flush_output(int code) {
  const bool flushed = std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.flush().good();
  if (!flushed && code != k_bad_input)
    throw std::runtime_error(
        "cannot write to standard output: the disk may be full, or the program that reads the output has "
        "ended");
  return code;
}

/// Returns the text of an exception as a line. A text that does not begin with the place of the error, as in
/// `run.h5: error: `, gets the name of the program as its place.
std::string error_line(std::string_view text) {
  const std::size_t end = text.find(": ");
  const bool has_place = end != text.npos && text.substr(end).starts_with(": error: ");
  return fmt::format("{}{}\n", has_place ? "" : "troupe: error: ", text);
}

constexpr const char* k_about =
    "Troupe simulates very large swarms of mobile robots; results are bit-identical on any number of "
    "threads.";

}  // namespace

std::vector<Command> known_commands() {
  CLI::App app(k_about, "troupe");
  const ProgramCommands commands = program_commands();
  add_commands(app, commands);
  return command_table(app);
}

int run_command_line(int argc, const char* const* argv, const std::function<void(const std::any&)>& limit) {
  fill_closed_streams();
  try {
    CLI::App app(k_about, "troupe");
    const ProgramCommands commands = program_commands();
    add_commands(app, commands);
    try {
      obey_simd_variable();
      std::vector<std::string> arguments = split_arguments(app, argc, argv);
      std::ranges::reverse(arguments);  // as CLI11 expects them
      app.parse(std::move(arguments));
      if (python_is_wanted()) run_in_python(argc, argv);
    } catch (const CLI::ParseError& error) {
      const bool is_help = error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success);
      if (is_help) return prints_for_all_ranks() ? flush_output(app.exit(error)) : k_finished;
      print_usage_error(usage_text(app, error));
      return k_bad_input;
    } catch (const InputError& error) {
      print_usage_error(fmt::format("{}\n", error.what()));
      return k_bad_input;
    }
    return flush_output(run_command(app, commands, limit));
  } catch (const InputError& error) {
    print_line(error.what());
    return k_bad_input;
  } catch (const OutputError& error) {
    print_line(error.what());
    return k_bad_input;
  } catch (const StoppedError& error) {
    print_line(error.what());
    return k_stopped;
  } catch (const std::bad_alloc&) {
    print_message(
        "troupe: error: not enough memory: use fewer robots, outputs or layers, or a machine with "
        "more memory\n");
    return k_failed;
  } catch (const std::exception& error) {
    print_message(error_line(exception_text(error)));
    return k_failed;
  } catch (...) {  // a plug-in may throw anything
    print_message(
        "troupe: error: unknown exception (not derived from std::exception); a plug-in may have thrown it\n");
    return k_failed;
  }
}

}  // namespace troupe::apps
