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

/// The names of the input files of a world (a description of a simulation), each with a number. A place in a
/// file (struct Where) stores the number of the file instead of its name.
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

/// Severity of a finding, which is a message about the input (struct Finding).
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

/// A part of the input that can inherit content from another part, or from which other parts can inherit,
/// such as a robot type that is defined as a variant of another robot type. A part that inherits is called an
/// heir, and the part from which it inherits is called its base.
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
  /// thorough: true for the command `troupe lint`, which searches a world file for problems. If true,
  /// warning_once() reports every place and not only the first, and the readers of input files also report
  /// problems that do not affect a run, such as unused definitions.
  explicit Diagnostics(bool thorough = false);
  /// Creates diagnostics that are not thorough and that use an existing table of input files. If `files` is
  /// null, they use a new, empty table.
  explicit Diagnostics(std::shared_ptr<SourceFiles> files);

  bool thorough() const { return thorough_; }  ///< whether to report every place, see the constructor
  /// The table that Where::file refers to; never null.
  const std::shared_ptr<SourceFiles>& files() const { return files_; }

  /// Adds an error. Drops the error instead if it repeats an earlier error about inherited content (see
  /// inherits()). The call that adds error number k_most_errors then calls throw_if_errors(), because reading
  /// more of the input would only cost time and memory.
  void error(Where where, std::string message);
  static constexpr std::size_t k_most_errors = 1000;  ///< number of errors at which error() throws
  /// Number of errors that throw_if_errors() lists; it only counts the others.
  static constexpr std::size_t k_most_listed = 50;
  /// Adds a warning, unless it repeats an earlier warning about inherited content (see inherits()).
  void warning(Where where, std::string message);
  /// Adds a warning as warning() does. If the same message occurs at several places, only the first place is
  /// listed. Later calls with this message are counted, and warnings() appends the count, as in ` (and 99
  /// more such warnings)`. If thorough() is true, the warning is listed once for each place.
  void warning_once(Where where, std::string message);

  /// Declares that `heir` contains copies of the content of `base`. Errors and warnings about this content
  /// that are added later are then reported once instead of once for every heir. To find repetitions, the
  /// function that adds a finding compares it with each earlier finding of the same severity and the same
  /// place. If the messages differ only in the names of two parts with a common base, the new finding is
  /// dropped.
  /// - If the earlier finding is about an heir, and the new one is about a base of this heir, the new message
  ///   replaces the earlier one.
  /// - If neither part inherits from the other, and the place is the line on which one of the two parts
  ///   begins, both findings are kept, because they are about content that is not inherited.
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
  /// Returns whether an earlier finding already reports the same error or warning, because both are about
  /// content that one part of the input inherits from another. The caller must then drop the new finding. May
  /// replace the message of the earlier finding with `message`; the comment of inherits() says when.
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
