#include "apps/command_line.hpp"

#include "apps/check/check.hpp"
#include "apps/command_table.hpp"
#include "apps/completion.hpp"
#include "apps/describe.hpp"
#include "apps/exit_code.hpp"
#include "apps/manual.hpp"
#include "apps/options.hpp"
#include "apps/repair.hpp"
#include "apps/run/run.hpp"
#include "base/diagnostics.hpp"
#include "partition/simd_target.hpp"
#include "troupe/plugins.hpp"
#include "troupe/registry.hpp"
#include "troupe/version.hpp"
#include "worldio/json/world_schema.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <string>
#include <string_view>
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
  troupe run --help)";

std::vector<std::string> words_of(const CLI::App& app) {
  std::vector<std::string> words;
  for (const CLI::Option* option : app.get_options())
    if (!option->get_lnames().empty()) words.push_back("--" + option->get_lnames().front());
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    words.push_back(command->get_name());
  return words;
}

/// One line that says what is wrong with the command line and where help is.
std::string usage_text(const CLI::App& app, const CLI::ParseError& error) {
  const auto commands = app.get_subcommands();
  const bool in_command = !commands.empty() && app.remaining(false).empty();
  const CLI::App& scope = in_command ? *commands.front() : app;
  const std::string name = in_command ? "troupe " + scope.get_name() : "troupe";
  std::string message = error.what();
  if (error.get_name() == "ArgumentMismatch") {
    // CLI11 names a switch that was given a value without its dashes, an option with too many or too few with
    // them.
    message = message.starts_with('-')
                  ? fmt::format("{} takes one value, once", message.substr(0, message.find(':')))
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

void add_describe_command(CLI::App& app, CommandOptions& options) {
  CLI::App* describe =
      app.add_subcommand("describe", "List what worlds are made of, or the parameters of one kind");
  describe
      ->add_option("KIND", options.describe.kind,
                   "Model, sensor, drive, controller or measure; all of them if not given")
      ->option_text(" ");
  describe->add_flag("--schema", options.describe.schema,
                     "Print the JSON Schema of worlds, for editors and programs");
  add_plugin_path_option(*describe, options.describe.plugin_path);
  describe->footer(
      "\nExamples:\n  troupe describe\n  troupe describe ranger\n  troupe describe follow_wall --plugin-path "
      "build\n  troupe describe --schema > world.schema.json");
}

void add_completion_command(CLI::App& app, CommandOptions& options) {
  CLI::App* completion_command =
      app.add_subcommand("completion", "Print the script with which a shell completes troupe's words");
  add_value(*completion_command, "SHELL", " ", "bash, zsh or fish", [&options](const std::string& text) {
    if (std::ranges::find(k_shells, text) == k_shells.end()) refuse("SHELL", text, "bash, zsh or fish");
    options.shell = text;
  })->required();
  completion_command->footer(
      "\nExamples:\n  source <(troupe completion bash)\n  troupe completion zsh > ~/.zfunc/_troupe\n"
      "  troupe completion fish > ~/.config/fish/completions/troupe.fish");
}

/// What --version prints.
std::string version_text() {
  std::string usable;
  for (const std::string& name : partition::simd_targets().usable)
    usable += fmt::format("{}{}", usable.empty() ? "" : " ", name);
  return fmt::format("{} simd {} (of {})", version_line(), partition::simd_target(), usable);
}

/// Every command, in the order of --help; parsing fills `options`.
void add_commands(CLI::App& app, CommandOptions& options) {
  app.get_formatter()->column_width(26);
  app.footer(k_troupe_footer);
  app.require_subcommand(0, 1);  // a second command would be parsed and then ignored
  app.set_version_flag(
      "--version", [] { return version_text(); }, "Print version, compiler, flags and instruction sets");
  add_run_command(app, options.run);
  add_resume_command(app, options.resume);
  add_sweep_command(app, options.sweep);
  add_check_command(app, options.check);
  add_diff_command(app, options.diff);
  add_repair_command(app, options.repair);
  add_convert_command(app, options.convert);
  add_render_command(app, options.render);
  add_replay_command(app, options.replay);
  add_lint_command(app, options.lint);
  add_info_command(app, options.info);
  add_describe_command(app, options);
  add_completion_command(app, options);
  app.add_subcommand("manual", "Print the manual page, for man");
}

/// What the commands that only print something print. Empty for the others.
std::string printed(const CLI::App& app, const std::string& command, const CommandOptions& options) {
  if (command == "manual") return manual_page(command_table(app), k_version);
  engine::Registry registry = make_registry();
  if (command == "completion") {
    const std::vector<std::string_view> kinds = kind_names(registry);
    return completion(
        options.shell, command_table(app),
        {{"describe", {kinds.begin(), kinds.end()}}, {"completion", {k_shells.begin(), k_shells.end()}}});
  }
  const auto& describe = options.describe;
  if (describe.schema) return worldio::world_schema(registry);
  add_plugins(registry, plugin_path(describe.plugin_path));
  return describe.kind.empty() ? list_kinds(registry) : describe_kind(registry, describe.kind);
}

int run_command(const CLI::App& app, const CommandOptions& options) {
  const std::vector<const CLI::App*> called =
      app.get_subcommands([](const CLI::App* one) { return one->parsed(); });
  if (called.empty()) {
    fmt::print(stderr, "{}", app.help());
    return k_bad_input;
  }
  const std::string command = called.front()->get_name();
  if (command == "run") return run(options.run);
  if (command == "resume") return run(options.resume);
  if (command == "sweep") return sweep(options.sweep);
  if (command == "check") return check(options.check, make_registry());
  if (command == "diff") return diff(options.diff);
  if (command == "repair") return repair(options.repair);
  if (command == "convert") return convert(options.convert);
  if (command == "render") return render_pictures(options.render);
  if (command == "replay") return replay(options.replay);
  if (command == "lint") return lint_world(options.lint);
  if (command == "info") return info(options.info);
  fmt::print("{}", printed(app, command, options));
  return k_finished;
}

/// The code of a command, or an error where what it printed was lost (a full disk, a closed stream).
int told(int code) {
  const bool flushed = std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.flush().good();
  if (!flushed && code != k_bad_input) throw std::runtime_error("standard output cannot be written");
  return code;
}

constexpr const char* k_about =
    "Troupe simulates very large swarms of mobile robots, the same to the last bit on any number of "
    "threads.";

}  // namespace

std::vector<Command> known_commands() {
  CLI::App app(k_about, "troupe");
  CommandOptions options;
  add_commands(app, options);
  return command_table(app);
}

int run_command_line(int argc, const char* const* argv, const std::function<void(CommandOptions&)>& limit) {
  try {
    obey_simd_variable();
    CLI::App app(k_about, "troupe");
    CommandOptions options;
    add_commands(app, options);
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return told(app.exit(error));
      fmt::print(stderr, "{}", usage_text(app, error));
      return k_bad_input;
    }
    if (limit) limit(options);
    return told(run_command(app, options));
  } catch (const InputError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return k_bad_input;
  } catch (const std::exception& error) {
    fmt::print(stderr, "troupe: error: {}\n", error.what());
    return k_failed;
  } catch (...) {  // a plug-in may throw anything
    fmt::print(stderr, "troupe: error: an exception that is no std::exception\n");
    return k_failed;
  }
}

}  // namespace troupe::apps
