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

/// The names of the files a world was read from, shared by what points into them.
class SourceFiles {
 public:
  /// The number of a file; the same name gives the same number.
  std::uint32_t add(std::string_view name);
  /// As it was added; the file must be one that add() gave.
  const std::string& name(std::uint32_t file) const { return names_[file]; }
  /// How many files there are: their numbers are 0 to size() - 1.
  std::size_t size() const { return names_.size(); }

 private:
  std::vector<std::string> names_;
};

/// A place in an input file. Line 0: the file as a whole; an invalid file: a world built by a program.
struct Where {
  static constexpr std::uint32_t k_no_file = ~0u;  ///< no file at all: made by a program
  std::uint32_t file = k_no_file;                  ///< its number in SourceFiles
  std::uint32_t line = 0;                          ///< from 1; 0 is the file as a whole
};

/// How grave a finding is.
enum class Severity {
  note,     ///< explains the finding before it
  warning,  ///< is reported; the world runs
  error,    ///< ends a load: InputError
};

/// One thing that was found in an input.
struct Finding {
  Severity severity;    ///< what Diagnostics counts: only errors stop a load
  Where where;          ///< the place it is about
  std::string message;  ///< one sentence, without the place and without a full stop
};

/// Bad input: the message lists the errors, a line each, as `maze.world:41: error: ...`; of more than 50 the
/// rest are counted in a last line.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Collects what is wrong with an input, so that a load reports everything at once. Of a message that quotes
/// something endless the beginning is kept.
/// Not thread-safe.
class Diagnostics {
 public:
  /// thorough: as a lint wants it. A warning that a load reports once for many places is listed at each of
  /// them, and readers also look for what no run cares about (unused definitions, ...).
  explicit Diagnostics(bool thorough = false);
  /// Of places in files that are known already: what a spec's places point into. May be null.
  explicit Diagnostics(std::shared_ptr<SourceFiles> files);

  bool thorough() const { return thorough_; }  ///< whether it was made for a lint, see the constructor
  /// What Where::file counts in; never null.
  const std::shared_ptr<SourceFiles>& files() const { return files_; }

  /// Throws InputError, as throw_if_errors() does, at the k_most_errors-th: who goes on reading behind that
  /// many only takes time and memory.
  void error(Where where, std::string message);
  static constexpr std::size_t k_most_errors = 1000;  ///< of one load, see error()
  /// Listed by warnings() at each call; stops nothing.
  void warning(Where where, std::string message);
  /// A warning that is reported once for all places: calls with the same message after the first are only
  /// counted, and ` (and 99 more)` follows it in warnings(). Where thorough, once for each place.
  void warning_once(Where where, std::string message);

  bool has_errors() const { return errors_ > 0; }  ///< whether throw_if_errors() would throw
  /// All, in the order they were found; valid until the next is added.
  std::span<const Finding> findings() const { return findings_; }
  /// One finding as `file:line: severity: message`; without the line where it is 0, without both where there
  /// is no file.
  std::string text(const Finding& finding) const;
  /// Every warning, a line each; the count stands behind those reported once for many places.
  std::vector<std::string> warnings() const;
  /// Throws InputError with the errors in the order they were found, if any was.
  void throw_if_errors() const;

 private:
  bool thorough_;
  std::shared_ptr<SourceFiles> files_;
  std::vector<Finding> findings_;
  std::vector<std::size_t> repeats_;         // beside findings_: how many more times a warning_once was met
  std::map<std::string, std::size_t> once_;  // text of a warning_once -> its place in findings_
  std::size_t errors_ = 0;
};

/// ` (did you mean "omni"?)` for the nearest known name within an edit for every three letters, else empty.
/// Of equally near names the first.
std::string did_you_mean(std::string_view word, std::span<const std::string_view> known);
/// `unknown drive "hover"; known: car, diff, omni (did you mean "omni"?)`: what every message about a name
/// says. Of many known names the first are listed, and of thousands none is suggested.
std::string unknown_name(std::string_view what, std::string_view name, std::vector<std::string_view> known);
/// `a, b, c`.
std::string comma_list(std::span<const std::string_view> names);

}  // namespace troupe
