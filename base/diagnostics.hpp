#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace troupe {

/// The names of the input files of a world (a description of a simulation). Each file has a number, which a
/// place in the input (struct Where) stores instead of the name.
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
  std::map<std::string, std::uint32_t, std::less<>> numbers_;
};

/// A place in an input file.
struct Where {
  static constexpr std::uint32_t k_no_file = ~0u;  ///< no file: the input was built by a program
  std::uint32_t file = k_no_file;                  ///< number of the file in SourceFiles
  std::uint32_t line = 0;                          ///< line, from 1; 0 means the whole file
};

/// Severity of a finding, which is a message about the input (struct Finding).
enum class Severity {
  warning,  ///< reported; the load continues
  error,    ///< the load fails with InputError
};

/// An error or a warning about the input.
struct Finding {
  Severity severity;      ///< only errors make a load fail
  Where where;            ///< the place in the input that the message is about
  std::string message;    ///< one sentence, without the place and without a full stop
  bool explains = false;  ///< of a warning: whether it was added by Diagnostics::explain()
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
/// together. Messages longer than 8000 bytes are cut. Not thread-safe.
class Diagnostics {
 public:
  /// thorough: whether to report more, for the command `troupe lint`, which searches a world file for
  /// problems. warning_once() then reports a warning for every place, not only for the first. The readers of
  /// input files then also report problems that do not affect a run, such as unused definitions.
  explicit Diagnostics(bool thorough = false);
  /// Creates diagnostics that are not thorough. They use the table `files`; if it is null, they use a new,
  /// empty table.
  explicit Diagnostics(std::shared_ptr<SourceFiles> files);

  bool thorough() const { return thorough_; }  ///< whether to report more, see the constructor
  /// The table that Where::file refers to; never null.
  const std::shared_ptr<SourceFiles>& files() const { return files_; }

  /// Adds an error, unless it repeats an earlier error about inherited content (see inherits()). After it has
  /// added error number k_most_errors, it calls throw_if_errors(), so that a reader stops early on a file
  /// with very many errors.
  void error(Where where, std::string message);
  static constexpr std::size_t k_most_errors = 1000;  ///< number of errors at which error() throws
  /// Largest number of errors that throw_if_errors() lists. Further errors are only counted.
  static constexpr std::size_t k_most_listed = 50;
  /// Adds a warning, unless it repeats an earlier warning about inherited content (see inherits()).
  void warning(Where where, std::string message);
  /// Adds a warning as warning() does, but lists the same message only once, at the first place. Later calls
  /// with this message are only counted, and warnings() appends their number, as in ` (and 99 more such
  /// warnings)`. If thorough() is true, the warning is listed once for each place.
  void warning_once(Where where, std::string message);

  /// Adds a warning as warning_once() does, which may be the cause of errors: throw_if_errors() lists it too.
  void explain(Where where, std::string message);

  /// Declares that `heir` contains copies of the content of `base`. An error in such content is found once
  /// for `base` and once for each heir, but is reported only once. The same holds for warnings. For example,
  /// if the type `b` inherits from the type `a`, only the first of these two errors is reported:
  ///
  ///     robots.json:7: error: /types/a: unknown key "x"
  ///     robots.json:7: error: /types/b: unknown key "x"
  ///
  /// Two parts are related if one inherits from the other, or if both inherit from a third part. A new
  /// finding is dropped if an earlier finding has the same severity, the same place, and the same message, or
  /// a message that differs only in the name or path of a related part. There are two special cases:
  ///
  /// - If the earlier finding is about an heir, and the new one is about a base of this heir, the message of
  ///   the earlier finding is replaced by the new message.
  /// - If neither part inherits from the other, and the place is the line on which one of them begins, both
  ///   findings are kept. Such findings are not about inherited content.
  void inherits(const Inheritable& heir, const Inheritable& base);

  bool has_errors() const { return errors_ > 0; }      ///< whether throw_if_errors() would throw
  std::size_t error_count() const { return errors_; }  ///< number of errors, also those that are not listed
  /// All findings in the order in which they were added. The span is valid until the next finding is added.
  std::span<const Finding> findings() const { return findings_; }
  /// Returns a finding as `file:line: severity: message`. Omits the line if it is 0. Omits file and line if
  /// the finding has no file.
  std::string text(const Finding& finding) const;
  /// Returns the texts of all warnings. A warning that warning_once() has counted ends with the number of its
  /// repetitions.
  std::vector<std::string> warnings() const;
  /// Throws InputError if there are errors. The exception lists the first warnings that explain() has added,
  /// and the first errors, up to k_most_listed of each, in the order in which they were added. If there are
  /// more errors, their number follows.
  void throw_if_errors() const;

 private:
  /// A part of the input that was passed to inherits().
  struct Kin {
    Inheritable part;
    std::size_t base;  // index in kin_; that of the part itself if it inherits from nothing
  };
  std::size_t kin_of(const Inheritable& part);
  bool is_heir(std::size_t heir, std::size_t base) const;
  /// Finds the part of the input that a message is about. If the message begins with the path of a part in
  /// kin_, it is about this part. Otherwise it is about the part whose name it quotes first. Returns the
  /// index of the part in kin_; empty if the message names no part.
  ///
  /// message: in the message, the path or name that was found is replaced by that of the part's most distant
  /// base (the base of its base, and so on)
  std::optional<std::size_t> to_common_base(std::string& message) const;
  /// Returns whether `message` repeats an earlier finding, as inherits() describes. The caller must then drop
  /// the message. In the first special case of inherits(), replaces the message of the earlier finding.
  bool is_inherited(Severity severity, Where where, const std::string& message);
  /// Returns the text of a finding whose message to_common_base() has changed: the key of alike_. Of a long
  /// message, it contains only the beginning.
  std::string common_text(Severity severity, Where where, std::string_view common) const;

  bool thorough_;
  std::shared_ptr<SourceFiles> files_;
  std::vector<Kin> kin_;
  std::vector<Finding> findings_;
  std::vector<std::size_t> repeats_;         // per finding: how often warning_once() repeated it
  std::map<std::string, std::size_t> once_;  // text of a warning -> its index in findings_
  std::size_t errors_ = 0;
  std::map<std::string, std::size_t, std::less<>> paths_;  // path of a part -> its index in kin_
  std::map<std::string, std::size_t, std::less<>> names_;  // name of a part -> index of the first such part

  /// A finding and the part that it is about (to_common_base()), as indices in findings_ and kin_.
  struct About {
    std::size_t finding;
    std::optional<std::size_t> part;
  };
  std::map<std::string, std::vector<About>> alike_;  // common_text() -> the findings with this text
  std::size_t listed_ = 0;                           // number of findings in alike_
};

/// Returns a suggestion such as ` (did you mean "omni"?)`, with a leading space. It contains the name in
/// `known` that differs from `word` by the fewest edits; of several such names, the first. An edit inserts,
/// deletes or replaces a letter, or swaps two adjacent letters. One edit is allowed for every three letters
/// of the shorter of the two words: none for 2 letters, one for 3 to 5, two for 6 to 8. If a name differs
/// from `word` only in upper and lower case, the suggestion is this name.
///
/// Names of several words, separated by `_`, `-`, `.` or blanks, differ by at most two edits. If there is no
/// such name, they are compared word by word, in any order: the suggestion has the fewest words without a
/// counterpart, and at most as many as words with one. The last word may be a unit: all units of a quantity
/// are counterparts of each other.
///
/// If no name is that similar, or if `word` is longer than 100 bytes, the result is empty. Names longer than
/// 100 bytes are never suggested.
std::string did_you_mean(std::string_view word, std::span<const std::string_view> known);
/// Returns the message for an unknown name: `unknown drive "dif"; known: car, diff, omni (did you mean
/// "diff"?)`. The message lists the first 50 known names in alphabetical order; if there are more, ` and N
/// more` follows. If there are more than 24 known names and a suggestion, none is listed. did_you_mean()
/// makes the suggestion, which is omitted if there are more than 2000 known names. If `known` is empty, the
/// message is `unknown drive "dif"; no drive exists`.
///
/// what: what the name stands for, here `drive`
/// known: the allowed names, in any order
/// hint: the suggestion, if it is not that of did_you_mean()
std::string unknown_name(std::string_view what, std::string_view name, std::vector<std::string_view> known,
                         std::string hint = {});
/// Returns the member `name` of every object of a range, for unknown_name().
template <class Range>
std::vector<std::string_view> name_list(const Range& objects) {
  std::vector<std::string_view> names;
  for (const auto& object : objects) names.push_back(object.name);
  return names;
}
/// Returns the names joined as `a, b, c`; empty without names.
std::string comma_list(std::span<const std::string_view> names);
/// Returns the text of an exception for a message: `not enough memory` for std::bad_alloc, whose own text is
/// only the name of its class; otherwise what().
std::string exception_text(const std::exception& error);
/// Returns the beginning of a text in UTF-8: as many whole characters as fit in `most` bytes.
std::string_view first_characters(std::string_view text, std::size_t most);

}  // namespace troupe
