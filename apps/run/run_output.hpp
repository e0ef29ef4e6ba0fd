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
/// Opens the files of an output, and adds what writes them behind the observers that are there.
using OpenOutput = std::function<void(Observers&)>;

/// An output of a run, with what the command line says of it. A new one is a class in a file of its own, and
/// a row in run_outputs.cpp.
class RunOutput {
 public:
  virtual ~RunOutput() = default;
  virtual std::unique_ptr<RunOutput> clone() const = 0;

  /// Adds its options to `run` or `resume`. Parsing fills this object and `options`, which must outlive
  /// `app`.
  virtual void add_options(CLI::App& app, RunOptions& options) = 0;
  /// The names of its files and folders, in which {world} may stand; empty ones are not written. `options`
  /// are those that hold this output.
  virtual std::vector<std::filesystem::path*> names(RunOptions& options) = 0;
  /// The files that it would write, each of which must be writable. Throws OutputError for what else is wrong
  /// with its names. Creates nothing.
  virtual std::vector<std::filesystem::path> files(const RunOptions& options) const = 0;
  /// A world that is loaded may name a file that the command line does not. Throws InputError.
  virtual void take_name_from_world(RunOptions& /*options*/, const Simulation& /*simulation*/) const {}
  /// Before any file is opened: what cannot be drawn, measured or written costs no run. The result may be
  /// null: there is nothing to open. `simulation` outlives what it opens. Throws InputError.
  virtual OpenOutput prepare(const RunOptions& options, Simulation& simulation,
                             std::uint64_t end_tick) const = 0;
};

/// Gives an output its clone().
template <class Output>
class ClonedOutput : public RunOutput {
 public:
  std::unique_ptr<RunOutput> clone() const override {
    return std::make_unique<Output>(static_cast<const Output&>(*this));
  }
};

/// One of each output.
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
  /// What opens them, in the order in which they observe a tick.
  std::vector<OpenOutput> prepare(const RunOptions& options, Simulation& simulation,
                                  std::uint64_t end_tick) const;

 private:
  std::vector<std::unique_ptr<RunOutput>> all_;  // in the order of the table
};

}  // namespace troupe::apps
