#pragma once

#include "apps/observers/observer.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}  // namespace CLI

namespace troupe::apps {

struct RunOptions;

using Observers = std::vector<std::unique_ptr<Observer>>;
/// A function that opens the files of an output. It makes the observers that write these files, and appends
/// the observers to its argument.
using OpenOutput = std::function<void(Observers&)>;

/// Base class of the kinds of output of a run, such as the hash log, with their command-line options. To add
/// a kind, derive a class in a file of its own and add a row to the table in run_outputs.cpp.
class RunOutput {
 public:
  virtual ~RunOutput() = default;
  /// Returns a copy of this object with the values of its options.
  virtual std::unique_ptr<RunOutput> clone() const = 0;

  /// Adds the options of this output to the command `app`, which is `run` or `resume`. Parsing fills this
  /// object and `options`; both must outlive `app`.
  virtual void add_options(CLI::App& app, RunOptions& options) = 0;
  /// Returns pointers to the names of the output's files and folders, so that the caller can replace {world}
  /// in them. A file with an empty name is not written. options: the options whose member `outputs` contains
  /// this output.
  virtual std::vector<std::filesystem::path*> names(RunOptions& options) = 0;
  /// Returns the files that the output will write. The caller checks that they can be written. Throws
  /// OutputError if the output finds another error, such as a checkpoint (saved state of a run) that exists
  /// already. Creates nothing.
  virtual std::vector<std::filesystem::path> files(const RunOptions& options) const = 0;
  /// Takes the name of the output's file from the loaded world, if the world names a file and the command
  /// line does not. Throws InputError if that name is not allowed. The default implementation does nothing;
  /// it is for kinds of output whose file a world cannot name.
  virtual void take_name_from_world(RunOptions& /*options*/, const Simulation& /*simulation*/) const {}
  /// Checks the output before any file is opened, so that errors in drawing, measuring or writing are
  /// reported before the run. Returns a function that opens the files; null if there is nothing to open.
  /// simulation: must outlive the opened observers. end_tick: last tick (simulation step) of the run. Throws
  /// InputError if the options do not fit the world.
  virtual OpenOutput prepare(const RunOptions& options, Simulation& simulation,
                             std::uint64_t end_tick) const = 0;
};

/// Base class of outputs that implements RunOutput::clone() with the copy constructor of `Output`.
template <class Output>
class ClonedOutput : public RunOutput {
 public:
  std::unique_ptr<RunOutput> clone() const override {
    return std::make_unique<Output>(static_cast<const Output&>(*this));
  }
};

/// All outputs of a run, one of each kind. Each function calls the function of the same name of all outputs.
class RunOutputs {
 public:
  RunOutputs();
  RunOutputs(const RunOutputs& other);
  RunOutputs(RunOutputs&&) = default;
  RunOutputs& operator=(const RunOutputs& other);
  RunOutputs& operator=(RunOutputs&&) = default;

  void add_options(CLI::App& app, RunOptions& options);
  std::vector<std::filesystem::path*> names(RunOptions& options);
  std::vector<std::filesystem::path> files(const RunOptions& options) const;
  void take_names_from_world(RunOptions& options, const Simulation& simulation) const;
  /// Returns the functions that open the outputs, in the order in which their observers observe a tick.
  std::vector<OpenOutput> prepare(const RunOptions& options, Simulation& simulation,
                                  std::uint64_t end_tick) const;

 private:
  std::vector<std::unique_ptr<RunOutput>> all_;  // in the order of the table in run_outputs.cpp
};

}  // namespace troupe::apps
