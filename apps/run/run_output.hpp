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
/// Opens the files of an output and appends its observers to those given.
using OpenOutput = std::function<void(Observers&)>;

/// An output of a run, with its command-line options. To add one, write a class in a file of its own and add
/// a row to run_outputs.cpp.
class RunOutput {
 public:
  virtual ~RunOutput() = default;
  virtual std::unique_ptr<RunOutput> clone() const = 0;

  /// Adds its options to `run` or `resume`. Parsing fills this object and `options`; both must outlive `app`.
  virtual void add_options(CLI::App& app, RunOptions& options) = 0;
  /// The names of its files and folders, which may contain {world}. A file with an empty name is not written.
  /// options: the object that contains this output.
  virtual std::vector<std::filesystem::path*> names(RunOptions& options) = 0;
  /// The files that it will write; the caller checks that they are writable. Throws OutputError for other
  /// errors in its names. Creates nothing.
  virtual std::vector<std::filesystem::path> files(const RunOptions& options) const = 0;
  /// Takes the name of the file from the loaded world if the command line has none. Throws InputError.
  virtual void take_name_from_world(RunOptions& /*options*/, const Simulation& /*simulation*/) const {}
  /// Checks the output before any file is opened, so that errors in drawing, measuring or writing are
  /// reported before the run. Returns a function that opens the files; null if there is nothing to open.
  /// `simulation` outlives the opened observers. Throws InputError.
  virtual OpenOutput prepare(const RunOptions& options, Simulation& simulation,
                             std::uint64_t end_tick) const = 0;
};

/// Base class that implements clone().
template <class Output>
class ClonedOutput : public RunOutput {
 public:
  std::unique_ptr<RunOutput> clone() const override {
    return std::make_unique<Output>(static_cast<const Output&>(*this));
  }
};

/// All outputs of a run, one of each kind.
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
  /// The functions that open the outputs, in the order in which their observers observe a tick.
  std::vector<OpenOutput> prepare(const RunOptions& options, Simulation& simulation,
                                  std::uint64_t end_tick) const;

 private:
  std::vector<std::unique_ptr<RunOutput>> all_;  // in the order of the table in run_outputs.cpp
};

}  // namespace troupe::apps
