#include "apps/command_table.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace troupe::apps {
namespace {

Command command(const CLI::App& app) {
  Command command{.name = app.get_name(), .help = app.get_description(), .footer = app.get_footer()};
  for (const CLI::Option* option : app.get_options()) {
    CommandOption& entry = command.options.emplace_back();
    entry.help = option->get_description();
    entry.positional = option->get_positional();
    if (entry.positional) entry.names.push_back(option->get_name(true, false));
    for (const std::string& name : option->get_lnames()) entry.names.push_back(fmt::format("--{}", name));
    for (const std::string& name : option->get_snames()) entry.names.push_back(fmt::format("-{}", name));
    const std::string& value = option->get_option_text();
    if (const std::size_t begin = value.find_first_not_of(' '); begin != value.npos)
      entry.value = value.substr(begin);
  }
  return command;
}

}  // namespace

std::vector<Command> command_table(const CLI::App& app) {
  std::vector<Command> commands{command(app)};
  for (const CLI::App* one : app.get_subcommands([](const CLI::App*) { return true; }))
    commands.push_back(command(*one));
  return commands;
}

}  // namespace troupe::apps
