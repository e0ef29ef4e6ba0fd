#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace troupe {

/// The names of the files that a world was read from, each with a number. A place in a file (struct Where)
/// stores this number instead of the name.
class SourceFiles {
 public:
  /// Returns the number of a file. Adds the file on first use; the same name always gives the same number.
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
  note,     ///< explains the previous finding; does not stop the load
  warning,  ///< reported; the load continues
  error,    ///< the load fails with InputError
};

/// An error, a warning or a note about the input.
struct Finding {
  Severity severity;    ///< only errors make a load fail
  Where where;          ///< the place in the input that the message is about
  std::string message;  ///< one sentence, without the place and without a full stop
};

/// A part of the input that other parts inherit from, or that inherits from another part, such as a type of a
/// world.
struct Inheritable {
  std::string path;  ///< path with which messages about the part begin: `/types/bot`
  std::string name;  ///< name of the part, as messages quote it: `bot`
  Where where;       ///< place in the input where the part begins
};

/// Thrown for invalid input. The message lists the errors, one per line, as `maze.world:41: error: ...`. At
/// most 50 errors are listed; a last line then says how many more there are.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Collects the errors and warnings that are found while a world is loaded, so that they are reported
/// together. Messages longer than 8000 characters are cut. Not thread-safe.
class Diagnostics {
 public:
  /// thorough: true for `troupe lint`. If true, warning_once() reports every place and not only the first,
  /// and the readers of input files also report problems that do not affect a run, such as unused
  /// definitions.
  explicit Diagnostics(bool thorough = false);
  /// Creates diagnostics that are not thorough and that use an existing table of input files. If `files` is
  /// null, they use a new, empty table.
  explicit Diagnostics(std::shared_ptr<SourceFiles> files);

  bool thorough() const { return thorough_; }  ///< whether to report every place, see the constructor
  /// The table that Where::file refers to; never null.
  const std::shared_ptr<SourceFiles>& files() const { return files_; }

  /// Adds an error, unless it repeats an earlier error about inherited content (see inherits()). The call
  /// that adds error number k_most_errors throws InputError, as throw_if_errors() does, because reading more
  /// of the input would only cost time and memory.
  void error(Where where, std::string message);
  static constexpr std::size_t k_most_errors = 1000;  ///< number of errors at which error() throws
  static constexpr std::size_t k_most_listed = 50;    ///< throw_if_errors() only counts further errors
  /// Adds a warning, unless it repeats an earlier warning about inherited content (see inherits()).
  void warning(Where where, std::string message);
  /// Adds a warning as warning() does. If the same message occurs at several places, only the first place is
  /// listed. Later calls with this message are counted, and warnings() appends the count, as in ` (and 99
  /// more such warnings)`. If thorough() is true, the warning is listed once for each place.
  void warning_once(Where where, std::string message);

  /// Declares that `heir` contains copies of the content of `base`. From now on, an error or a warning about
  /// inherited content is reported once instead of for every heir: if two findings have the same place, and
  /// their messages differ only in the names of parts with a common base, the second finding is dropped. If
  /// the first finding is about an heir, and the second one is about a base of this heir, the message of the
  /// second replaces that of the first. Findings on the line on which an heir begins are about the heir's own
  /// content: both findings are then kept, unless one of the two parts inherits from the other.
  void inherits(const Inheritable& heir, const Inheritable& base);

  bool has_errors() const { return errors_ > 0; }      ///< whether throw_if_errors() would throw
  std::size_t error_count() const { return errors_; }  ///< number of errors, also those that are not listed
  /// All findings in the order in which they were added; valid until the next finding is added.
  std::span<const Finding> findings() const { return findings_; }
  /// A finding as `file:line: severity: message`. If the line is 0, it is omitted. If the finding has no
  /// file, file and line are omitted.
  std::string text(const Finding& finding) const;
  /// All warnings, one entry each, with the counts of repetitions that warning_once() describes.
  std::vector<std::string> warnings() const;
  /// If there are errors, throws InputError with the texts of the first 50, in the order in which they were
  /// added, and the number of the others.
  void throw_if_errors() const;

 private:
  /// A part of the input that was passed to inherits().
  struct Kin {
    Inheritable part;
    std::size_t base;  // index in kin_; that of the part itself if it inherits from nothing
  };
  std::size_t kin_of(const Inheritable& part);
  bool is_heir(std::size_t heir, std::size_t base) const;
  /// Finds the part of the input that a message is about: the part with whose path the message begins, or
  /// else the part whose name is the first one that the message quotes. Replaces this path or name in the
  /// message with that of the last part in the chain of bases of the found part. Returns the index in kin_ of
  /// the found part; empty if the message names no part in kin_.
  std::optional<std::size_t> to_common_base(std::string& message) const;
  /// Whether an earlier finding reports the same error or warning in inherited content; the new finding must
  /// then be dropped. Replaces the message of the earlier finding with `message` where inherits() says so.
  bool is_inherited(Severity severity, Where where, const std::string& message);

  bool thorough_;
  std::shared_ptr<SourceFiles> files_;
  std::vector<Kin> kin_;
  std::vector<Finding> findings_;
  std::vector<std::size_t> repeats_;         // per finding: how often warning_once() repeated it
  std::map<std::string, std::size_t> once_;  // text of a warning -> its index in findings_
  std::size_t errors_ = 0;
};

/// Returns a suggestion such as ` (did you mean "omni"?)`, with a leading space and with the known name that
/// differs from `word` by the fewest edits; of several such names, the first. An edit inserts, deletes or
/// replaces a letter or swaps two adjacent ones. A name is suggested only if the shorter of the two words has
/// at least three letters per edit. If there is no such name, the result is empty.
std::string did_you_mean(std::string_view word, std::span<const std::string_view> known);
/// The message for an unknown name: `unknown drive "dif"; known: car, diff, omni (did you mean "diff"?)`.
/// what: what the name stands for, here `drive`. known: the allowed names, of which the first 50 in
/// alphabetical order are listed, followed by ` and N more`. The suggestion is that of did_you_mean(); there
/// is none if `known` has more than 2000 names. If `known` is empty, the message is `unknown drive "dif"; no
/// drive exists`.
std::string unknown_name(std::string_view what, std::string_view name, std::vector<std::string_view> known);
/// The names joined as `a, b, c`; empty without names.
std::string comma_list(std::span<const std::string_view> names);

}  // namespace troupe
