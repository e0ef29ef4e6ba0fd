#include "apps/completion.hpp"

#include "apps/command_line.hpp"
#include "apps/describe.hpp"
#include "apps/options.hpp"
#include "base/split.hpp"
#include "troupe/registry.hpp"
#include "worldio/json/find_keys.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <span>
#include <utility>

namespace troupe::apps {
namespace {

using Arguments = std::map<std::string, std::vector<std::string>>;

/// The values that a shell offers for an option: the list `words`, or, if `file` is true, file names. If the
/// list is empty and `file` is false, the shell offers nothing.
struct ValueHint {
  std::vector<std::string> words;
  bool file = false;
};

ValueHint hint_of(const CommandOption& option) {
  ValueHint hint;
  const auto is_in = [&](std::string_view part) { return option.value.find(part) != option.value.npos; };
  hint.file = is_in("FILE") || is_in("DIR") || is_in("SCRIPT") || option.positional;
  if (!is_in("|")) return hint;
  for (const std::string_view word : split(option.value, '|')) {
    const auto is_letter = [](char c) { return c >= 'a' && c <= 'z'; };
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    if (!word.empty() && is_letter(word.front()) && std::ranges::all_of(word, [&](char c) {
          return is_letter(c) || is_digit(c) || c == '-' || c == '_';
        }))
      hint.words.emplace_back(word);
  }
  return hint;
}

std::vector<std::string> option_names(const Command& command) {
  std::vector<std::string> names;
  for (const CommandOption& option : command.options)
    if (!option.positional) names.insert(names.end(), option.names.begin(), option.names.end());
  return names;
}

const std::vector<std::string>* words_of(const Arguments& arguments, const Command& command) {
  const auto found = arguments.find(command.name);
  return found == arguments.end() ? nullptr : &found->second;
}

std::string names_of(std::span<const Command> commands) {
  std::string names;
  for (const Command& command : commands)
    names += fmt::format("{}{}", names.empty() ? "" : " ", command.name);
  return names;
}

std::string bash(const Command& program, std::span<const Command> commands, const Arguments& arguments) {
  std::string options, values, positional;
  std::vector<std::string> files, others;  // COMMAND:OPTION whose value is a file; those with other values
  for (const Command& command : commands) {
    options += fmt::format("    {}) words=\"{}\" ;;\n", command.name, joined(option_names(command), " "));
    if (const auto* words = words_of(arguments, command))
      positional += fmt::format("    {}) COMPREPLY=($(compgen -W \"{}\" -- \"$cur\")) ;;\n", command.name,
                                joined(*words, " "));
    for (const CommandOption& option : command.options) {
      if (option.positional || option.value.empty()) continue;
      const ValueHint hint = hint_of(option);
      for (const std::string& name : option.names) {
        std::string pattern = fmt::format("{}:{}", command.name, name);
        if (!hint.words.empty())
          values += fmt::format("    {}) COMPREPLY=($(compgen -W \"{}\" -- \"$cur\")); return ;;\n", pattern,
                                joined(hint.words, " "));
        else
          (hint.file ? files : others).push_back(std::move(pattern));
      }
    }
  }
  values += fmt::format("    {}) COMPREPLY=($(compgen -f -- \"$cur\")); return ;;\n", joined(files, "|"));
  values += fmt::format("    {}) compopt +o default; return ;;\n", joined(others, "|"));
  return fmt::format(R"(# bash completion of troupe; made by `troupe completion bash`
_troupe() {{
  local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD-1]}} command=${{COMP_WORDS[1]}} words=
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    COMPREPLY=($(compgen -W "{} {}" -- "$cur"))
    return
  fi
  case $command:$prev in
{}  esac
  if [[ $cur == -* ]]; then
    case $command in
{}    esac
    COMPREPLY=($(compgen -W "$words" -- "$cur"))
    return
  fi
  case $command in
{}  esac
}}
complete -o default -F _troupe troupe
)",
                     names_of(commands), joined(option_names(program), " "), values, options, positional);
}

/// Escapes a text for single quotes in zsh. Also escapes [ ] and :, which have a meaning in zsh's completion
/// specifications.
std::string zsh_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
    if (c == '\'')
      out += "'\\''";
    else
      out += c;
  }
  return out;
}

std::string zsh(const Command&, std::span<const Command> commands, const Arguments& arguments) {
  std::string list, cases;
  for (const Command& command : commands) {
    list += fmt::format("    '{}:{}'\n", command.name, zsh_text(command.help));
    cases += fmt::format("      {})\n        _arguments", command.name);
    for (const CommandOption& option : command.options) {
      const ValueHint hint = hint_of(option);
      std::string action = hint.file ? "_files" : " ";
      if (!hint.words.empty()) action = fmt::format("({})", joined(hint.words, " "));
      if (option.positional) {
        if (const auto* words = words_of(arguments, command))
          action = fmt::format("({})", joined(*words, " "));
        cases += fmt::format(" \\\n          '*:{}:{}'", zsh_text(option.names.front()), action);
        continue;
      }
      for (const std::string& name : option.names)
        cases += fmt::format(
            " \\\n          '*{}[{}]{}'", name, zsh_text(option.help),
            option.value.empty() ? std::string() : fmt::format(":{}:{}", zsh_text(option.value), action));
    }
    cases += "\n        ;;\n";
  }
  return fmt::format(R"(#compdef troupe
# zsh completion of troupe; made by `troupe completion zsh`
_troupe() {{
  local -a commands
  commands=(
{}  )
  local state line
  _arguments -C '1:command:->command' '*::argument:->argument'
  case $state in
  command) _describe command commands ;;
  argument)
    case $words[1] in
{}    esac
    ;;
  esac
}}
if [[ $funcstack[1] == _troupe ]]; then _troupe "$@"; else compdef _troupe troupe; fi
)",
                     list, cases);
}

/// Escapes a text for single quotes in fish.
std::string fish_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\'' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

std::string fish(const Command& program, std::span<const Command> commands, const Arguments& arguments) {
  std::string text = "# fish completion of troupe; made by `troupe completion fish`\n";
  const auto add_options = [&](const Command& command, const std::string& condition) {
    for (const CommandOption& option : command.options) {
      if (option.positional) continue;
      const ValueHint hint = hint_of(option);
      text += fmt::format("complete -c troupe -n '{}'", condition);
      for (const std::string& name : option.names)
        text += name.starts_with("--") ? fmt::format(" -l {}", name.substr(2))
                                       : fmt::format(" -s {}", name.substr(1));
      if (!option.value.empty()) text += hint.file ? " -r -F" : " -x";
      if (!hint.words.empty()) text += fmt::format(" -a '{}'", joined(hint.words, " "));
      text += fmt::format(" -d '{}'\n", fish_text(option.help));
    }
  };
  add_options(program, "__fish_use_subcommand");
  for (const Command& command : commands) {
    text += fmt::format("complete -c troupe -n __fish_use_subcommand -f -a {} -d '{}'\n", command.name,
                        fish_text(command.help));
    const std::string condition = "__fish_seen_subcommand_from " + command.name;
    add_options(command, condition);
    if (const auto* words = words_of(arguments, command))
      text += fmt::format("complete -c troupe -n '{}' -f -a '{}'\n", condition, joined(*words, " "));
  }
  return text;
}

}  // namespace

std::string completion(std::string_view shell, const std::vector<Command>& commands,
                       const Arguments& arguments) {
  const Command& program = commands.front();
  const std::span<const Command> others = std::span(commands).subspan(1);
  if (shell == "zsh") return zsh(program, others, arguments);
  return shell == "fish" ? fish(program, others, arguments) : bash(program, others, arguments);
}

void add_completion_options(CLI::App& command, std::string& shell) {
  add_value(command, "SHELL", " ", "bash, zsh or fish", [&shell](const std::string& text) {
    if (std::ranges::find(k_shells, text) == k_shells.end()) refuse("SHELL", text, "bash, zsh or fish");
    shell = text;
  })->required();
  command.footer(
      "\nExamples:\n  source <(troupe completion bash)\n  troupe completion zsh > ~/.zfunc/_troupe\n"
      "  troupe completion fish > ~/.config/fish/completions/troupe.fish");
}

ExitCode print_completion(const std::string& shell) {
  const engine::Registry registry = make_registry();
  const std::vector<std::string> keys = worldio::key_names(registry);
  std::set<std::string> described(keys.begin(), keys.end());
  for (const std::string_view kind : kind_names(registry)) described.emplace(kind);
  fmt::print("{}", completion(shell, known_commands(),
                              {{"describe", {described.begin(), described.end()}},
                               {"completion", {k_shells.begin(), k_shells.end()}}}));
  return k_finished;
}

}  // namespace troupe::apps
