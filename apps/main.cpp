#include "apps/check/check.hpp"
#include "apps/command_table.hpp"
#include "apps/completion.hpp"
#include "apps/convert.hpp"
#include "apps/describe.hpp"
#include "apps/diff/diff.hpp"
#include "apps/info/info.hpp"
#include "apps/lint.hpp"
#include "apps/manual.hpp"
#include "apps/options.hpp"
#include "apps/pictures/render.hpp"
#include "apps/repair.hpp"
#include "apps/replay.hpp"
#include "apps/run/run.hpp"
#include "apps/run/run_options.hpp"
#include "apps/sweep/sweep.hpp"
#include "base/diagnostics.hpp"
#include "partition/simd_target.hpp"
#include "troupe/plugins.hpp"
#include "troupe/registry.hpp"
#include "troupe/simulation.hpp"
#include "troupe/version.hpp"
#include "worldio/world_schema.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <string>
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

/// What --version prints.
std::string version_text() {
  std::string usable;
  for (const std::string& name : partition::simd_targets().usable)
    usable += fmt::format("{}{}", usable.empty() ? "" : " ", name);
  return fmt::format("{} simd {} (of {})", version_line(), partition::simd_target(), usable);
}

int troupe_main(int argc, char** argv) {
  obey_simd_variable();
  CLI::App app(
      "Troupe simulates very large swarms of mobile robots, the same to the last bit on any number of "
      "threads.",
      "troupe");
  app.get_formatter()->column_width(26);
  app.footer(k_troupe_footer);
  app.set_version_flag(
      "--version", [] { return version_text(); }, "Print version, compiler, flags and instruction sets");

  RunOptions options;
  const CLI::App* run_command = add_run_command(app, options);
  RunOptions resume_options;
  const CLI::App* resume_command = add_resume_command(app, resume_options);
  SweepOptions sweep_options;
  const CLI::App* sweep_command = add_sweep_command(app, sweep_options);
  CheckOptions check_options;
  const CLI::App* check_command = add_check_command(app, check_options);
  DiffOptions diff_options;
  const CLI::App* diff_command = add_diff_command(app, diff_options);
  std::filesystem::path cut_off;
  const CLI::App* repair_command = add_repair_command(app, cut_off);
  ConvertOptions conversion;
  const CLI::App* convert_command = add_convert_command(app, conversion);
  RenderOptions rendered;
  const CLI::App* render_command = add_render_command(app, rendered);
  ReplayOptions replayed;
  const CLI::App* replay_command = add_replay_command(app, replayed);
  LintOptions linted;
  const CLI::App* lint_command = add_lint_command(app, linted);
  InfoOptions shown;
  const CLI::App* info_command = add_info_command(app, shown);
  std::string kind;
  CLI::App* describe =
      app.add_subcommand("describe", "List what worlds are made of, or the parameters of one kind");
  describe->add_option("KIND", kind, "Model, sensor, drive, controller or measure; all of them if not given")
      ->option_text(" ");
  bool schema = false;
  describe->add_flag("--schema", schema, "Print the JSON Schema of worlds, for editors and programs");
  std::vector<std::filesystem::path> plugin_folders;
  add_plugin_path_option(*describe, plugin_folders);
  describe->footer(
      "\nExamples:\n  troupe describe\n  troupe describe ranger\n  troupe describe follow_wall --plugin-path "
      "build\n  troupe describe --schema > world.schema.json");
  std::string shell;
  CLI::App* completion_command =
      app.add_subcommand("completion", "Print the script with which a shell completes troupe's words");
  add_value(*completion_command, "SHELL", " ", "bash, zsh or fish", [&shell](const std::string& text) {
    if (std::ranges::find(k_shells, text) == k_shells.end()) refuse("SHELL", text, "bash, zsh or fish");
    shell = text;
  })->required();
  completion_command->footer(
      "\nExamples:\n  source <(troupe completion bash)\n  troupe completion zsh > ~/.zfunc/_troupe\n"
      "  troupe completion fish > ~/.config/fish/completions/troupe.fish");
  const CLI::App* manual_command = app.add_subcommand("manual", "Print the manual page, for man");

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return app.exit(error);
    fmt::print(stderr, "{}", usage_text(app, error));
    return k_bad_input;
  }

  if (run_command->parsed()) return run(options);
  if (resume_command->parsed()) return run(resume_options);
  if (sweep_command->parsed()) return sweep(sweep_options);
  if (check_command->parsed()) return check(check_options, make_registry());
  if (diff_command->parsed()) return diff(diff_options);
  if (render_command->parsed()) return render_pictures(rendered);
  if (repair_command->parsed()) return repair(cut_off);
  if (convert_command->parsed()) return convert(conversion);
  if (replay_command->parsed()) return replay(replayed);
  if (lint_command->parsed()) return lint_world(linted);
  if (info_command->parsed()) return info(shown);
  if (completion_command->parsed()) {
    const engine::Registry registry = make_registry();
    const std::vector<std::string_view> kinds = kind_names(registry);
    fmt::print("{}", completion(shell, command_table(app),
                                {{"describe", {kinds.begin(), kinds.end()}},
                                 {"completion", {k_shells.begin(), k_shells.end()}}}));
    return k_finished;
  }
  if (manual_command->parsed()) {
    fmt::print("{}", manual_page(command_table(app), k_version));
    return k_finished;
  }
  if (describe->parsed()) {
    engine::Registry registry = make_registry();
    if (schema) {
      fmt::print("{}", worldio::world_schema(registry));
      return k_finished;
    }
    add_plugins(registry, plugin_path(plugin_folders));
    fmt::print("{}", kind.empty() ? list_kinds(registry) : describe_kind(registry, kind));
    return k_finished;
  }
  fmt::print(stderr, "{}", app.help());
  return k_bad_input;
}

}  // namespace
}  // namespace troupe::apps

int main(int argc, char** argv) {
  try {
    return troupe::apps::troupe_main(argc, argv);
  } catch (const troupe::InputError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return troupe::apps::k_bad_input;
  } catch (const std::exception& error) {
    fmt::print(stderr, "troupe: error: {}\n", error.what());
    return troupe::apps::k_failed;
  } catch (...) {  // a plug-in may throw anything
    fmt::print(stderr, "troupe: error: an exception that is no std::exception\n");
    return troupe::apps::k_failed;
  }
}
