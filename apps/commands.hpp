#pragma once

#include "apps/cli_app.hpp"
#include "apps/exit_code.hpp"

#include <any>
#include <memory>
#include <vector>

namespace troupe::apps {

/// A command of the program, with its options.
class ProgramCommand {
 public:
  /// runs_on_ranks: whether run() may be called if a launcher such as mpirun has started several processes;
  /// all of them then call it.
  ProgramCommand(const char* name, const char* help, bool runs_on_ranks)
      : name_(name), help_(help), runs_on_ranks_(runs_on_ranks) {}
  virtual ~ProgramCommand() = default;
  ProgramCommand(const ProgramCommand&) = delete;
  ProgramCommand& operator=(const ProgramCommand&) = delete;

  const char* name() const { return name_; }             ///< as typed: "run"
  const char* help() const { return help_; }             ///< one line for --help
  bool runs_on_ranks() const { return runs_on_ranks_; }  ///< as given to the constructor
  virtual void add_options(CLI::App& command) = 0;       ///< declares the options; parsing fills them
  virtual ExitCode run() const = 0;                      ///< runs the command with its options
  virtual std::any options() = 0;  ///< returns a pointer to the options, such as a RunOptions*

 private:
  const char* name_;
  const char* help_;
  bool runs_on_ranks_;
};

/// Returns all commands, in the order of --help. The commands, and thus their options, are new in each call.
std::vector<std::unique_ptr<ProgramCommand>> program_commands();

}  // namespace troupe::apps
