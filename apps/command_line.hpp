#pragma once

#include "apps/check/check_options.hpp"
#include "apps/command_table.hpp"
#include "apps/convert.hpp"
#include "apps/diff/diff.hpp"
#include "apps/info/info.hpp"
#include "apps/lint.hpp"
#include "apps/pictures/render.hpp"
#include "apps/replay.hpp"
#include "apps/run/run_options.hpp"
#include "apps/sweep/sweep.hpp"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace troupe::apps {

/// What the command line of each command asks for. One command is called; the others keep their defaults.
struct CommandOptions {
  RunOptions run;
  RunOptions resume;
  SweepOptions sweep;
  CheckOptions check;
  DiffOptions diff;
  std::filesystem::path repair;  ///< the recording
  ConvertOptions convert;
  RenderOptions render;
  ReplayOptions replay;
  LintOptions lint;
  InfoOptions info;
  struct {
    std::string kind;  ///< empty: all
    bool schema = false;
    std::vector<std::filesystem::path> plugin_path;
  } describe;
  std::string shell;  ///< of `completion`
};

/// The whole program: parses the arguments (argv[0] is the program's name), runs the command, and prints what
/// it has to say. Returns the exit code (apps/exit_code.hpp); throws nothing. `limit` is called between
/// parsing and running and may change what is asked for: the fuzz target keeps runs short with it.
int run_command_line(int argc, const char* const* argv,
                     const std::function<void(CommandOptions&)>& limit = nullptr);

/// The commands and their options as the parser knows them.
std::vector<Command> known_commands();

}  // namespace troupe::apps
