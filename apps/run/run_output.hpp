#pragma once

#include "apps/cli_app.hpp"
#include "apps/observers/observer.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace troupe::apps {

struct RunOptions;

using Observers = std::vector<std::unique_ptr<Observer>>;
/// A function that opens the files of an output. It makes the observers that write these files, and appends
/// them to its argument. An observer is an object that reads the state after each tick (time step).
using OpenOutput = std::function<void(Observers&)>;
/// Returns a function that calls open() of a prepared observer and appends it to the other observers. Call
/// the function once.
template <class Output>
OpenOutput opening(std::unique_ptr<Output> output) {
  // shared, because the returned function must be copyable
  const auto prepared = std::make_shared<std::unique_ptr<Output>>(std::move(output));
  return [prepared](Observers& observers) {
    (*prepared)->open();
    observers.push_back(std::move(*prepared));
  };
}

/// Base class of the outputs of a run, with their command-line options. Each kind of output, such as the hash
/// log (a text file with the hash of the state after each tick), is a derived class. To add a kind, add a
/// derived class in a source file of its own, and a row to the table in run_outputs.cpp.
class RunOutput {
 public:
  virtual ~RunOutput() = default;
  /// Returns a copy of this output, including the values of its options.
  virtual std::unique_ptr<RunOutput> clone() const = 0;

  /// Adds the options of this output to `app`, the command `run` or `resume`. Parsing stores the values in
  /// this output and in `options`; both must outlive `app`.
  virtual void add_options(CLI::App& app, RunOptions& options) = 0;
  /// Returns pointers to the file and folder names of this output. The caller can then replace {world} in the
  /// names by the name of the world. The names are members of this output or of `options`. An empty name
  /// means that the output does not write that file.
  virtual std::vector<std::filesystem::path*> names(RunOptions& options) = 0;
  /// Returns the files that the output will write, so that the caller can check that they can be written. An
  /// empty path stands for no file. Creates nothing. Throws OutputError if the output itself finds an error,
  /// for example that a checkpoint (a saved state of a run) exists already.
  virtual std::vector<std::filesystem::path> files(const RunOptions& options) const = 0;
  /// If the command line names no file for this output, stores the file name that the world gives, if any, in
  /// `options`. Throws InputError if the name in the world is not allowed. The default implementation does
  /// nothing; it is for outputs that a world cannot name.
  virtual void take_name_from_world(RunOptions& /*options*/, const Simulation& /*simulation*/) const {}
  /// Checks that the output can be made with these options and this world, and that a file that a resumed run
  /// continues belongs to this run. For example, the output for films draws a test picture. Returns a
  /// function that opens the files; null if there is nothing to open. Throws InputError or OutputError if a
  /// check fails.
  ///
  /// Files are only created, shortened or replaced by the returned functions, and a run calls these after
  /// all outputs of all its worlds have passed their checks. An error therefore leaves every file as it was.
  ///
  /// options: must outlive the returned function
  /// simulation: must outlive the observers that the returned function makes
  /// end_tick: last tick of the run
  virtual OpenOutput prepare(const RunOptions& options, Simulation& simulation,
                             std::uint64_t end_tick) const = 0;
};

/// Base class of `Output`, a class of outputs; implements RunOutput::clone() with the copy constructor of
/// `Output`.
template <class Output>
class ClonedOutput : public RunOutput {
 public:
  std::unique_ptr<RunOutput> clone() const override {
    return std::make_unique<Output>(static_cast<const Output&>(*this));
  }
};

/// Base class of `Output`, a class of outputs that write one file, which an option names.
template <class Output>
class FileOutput : public ClonedOutput<Output> {
 public:
  std::vector<std::filesystem::path*> names(RunOptions&) override { return {&file_}; }
  std::vector<std::filesystem::path> files(const RunOptions&) const override { return {file_}; }

 protected:
  std::filesystem::path file_;  ///< empty: the option was not given
};

/// All outputs of a run, one of each kind. Each function calls the RunOutput function of the same name for
/// every output, and returns all results in one list.
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
  /// Returns the functions that open the outputs. They have the order in which the observers must observe a
  /// tick. RunOutput::prepare() is called in this order too.
  std::vector<OpenOutput> prepare(const RunOptions& options, Simulation& simulation,
                                  std::uint64_t end_tick) const;

 private:
  std::vector<std::unique_ptr<RunOutput>> all_;  // in the order of the table in run_outputs.cpp
};

}  // namespace troupe::apps
