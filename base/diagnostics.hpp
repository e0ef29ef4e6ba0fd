#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace troupe {

/// The names of the files that a world was read from. Places (Where) refer to them by number.
class SourceFiles {
 public:
  /// Returns the number of a file. Adds it on first use; the same name always gives the same number.
  std::uint32_t add(std::string_view name);
  /// The name of a file; `file` must be a number that add() returned.
  const std::string& name(std::uint32_t file) const { return names_[file]; }
  /// Number of files; they are numbered 0 to size() - 1.
  std::size_t size() const { return names_.size(); }

 private:
  std::vector<std::string> names_;
};

/// A place in an input file.
struct Where {
  static constexpr std::uint32_t k_no_file = ~0u;  ///< no file: the input was built by a program
  std::uint32_t file = k_no_file;                  ///< number of the file in SourceFiles
  std::uint32_t line = 0;                          ///< line, from 1; 0 means the whole file
};

/// Severity of a finding.
enum class Severity {
  note,     ///< explains the finding before it
  warning,  ///< reported; the load continues
  error,    ///< the load fails with InputError
};

/// An error, warning or note about an input.
struct Finding {
  Severity severity;    ///< only errors make a load fail
  Where where;          ///< the place that the message is about
  std::string message;  ///< one sentence, without the place and without a full stop
};

/// Thrown for invalid input. The message lists the errors, one per line, as `maze.world:41: error: ...`. Only
/// the first 50 are listed; a last line counts the rest.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Collects the errors and warnings of a load so that they are reported together. Messages are cut to 8000
/// characters. Not thread-safe.
class Diagnostics {
 public:
  /// thorough: for lint. warning_once() then reports every place instead of the first one, and readers also
  /// report what does not affect a run (unused definitions, ...).
  explicit Diagnostics(bool thorough = false);
  /// For places that refer to an existing table of files. `files` may be null: the table starts empty.
  explicit Diagnostics(std::shared_ptr<SourceFiles> files);

  bool thorough() const { return thorough_; }  ///< true for lint, see the constructor
  /// The table that Where::file refers to; never null.
  const std::shared_ptr<SourceFiles>& files() const { return files_; }

  /// Adds an error. Throws InputError, as throw_if_errors() does, at the k_most_errors-th: reading on would
  /// only cost time and memory.
  void error(Where where, std::string message);
  static constexpr std::size_t k_most_errors = 1000;  ///< limit per load, see error()
  /// Adds a warning.
  void warning(Where where, std::string message);
  /// Adds a warning that is listed once for all places: later calls with the same message are only counted,
  /// and warnings() appends ` (and 99 more)`. If thorough(), it is listed once for each place.
  void warning_once(Where where, std::string message);

  bool has_errors() const { return errors_ > 0; }  ///< whether throw_if_errors() would throw
  /// All findings in the order they were added; valid until the next one is added.
  std::span<const Finding> findings() const { return findings_; }
  /// A finding as `file:line: severity: message`. The line is omitted if it is 0, both are omitted if there
  /// is no file.
  std::string text(const Finding& finding) const;
  /// All warnings, one line each, with the count of repetitions (see warning_once()).
  std::vector<std::string> warnings() const;
  /// Throws InputError with the errors in the order they were added, if there are any.
  void throw_if_errors() const;

 private:
  bool thorough_;
  std::shared_ptr<SourceFiles> files_;
  std::vector<Finding> findings_;
  std::vector<std::size_t> repeats_;         // per finding: how often warning_once() repeated it
  std::map<std::string, std::size_t> once_;  // text of a warning_once() -> its index in findings_
  std::size_t errors_ = 0;
};

/// ` (did you mean "omni"?)` with the nearest known name, by edit distance; of equally near names the first.
/// Empty if no name is within one edit per three letters.
std::string did_you_mean(std::string_view word, std::span<const std::string_view> known);
/// The message for an unknown name: `unknown drive "dif"; known: car, diff, omni (did you mean "diff"?)`.
/// Lists the first 50 known names in alphabetical order; suggests none if there are more than 2000.
std::string unknown_name(std::string_view what, std::string_view name, std::vector<std::string_view> known);
/// The names joined as `a, b, c`.
std::string comma_list(std::span<const std::string_view> names);

}  // namespace troupe
