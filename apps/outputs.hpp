#pragma once

#include "troupe/script.hpp"
#include "troupe/simulation.hpp"
#include "worldio/results/descriptor.hpp"

#include <cstdint>
#include <exception>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::apps {

/// Thrown if an output file cannot be written or must not be replaced. Commands that run a world throw it
/// before the first tick (time step).
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Thrown if Ctrl-C, SIGTERM or SIGHUP has arrived while an output could not be opened yet. The program then
/// ends with k_stopped.
class StoppedError : public std::exception {
 public:
  explicit StoppedError(std::string text) : text_(std::move(text)) {}
  const char* what() const noexcept override { return text_.c_str(); }

 private:
  std::string text_;
};

/// Waits until a program reads `file`, if this is a named pipe, because opening it would wait without end,
/// and no signal would end it. Until the result is destroyed, opening the pipe does not wait. Throws
/// StoppedError when stop_requested().
[[nodiscard]] worldio::Descriptor await_reader(const std::filesystem::path& file);

/// Throws OutputError: `file: error: cannot be written: reason`.
[[noreturn]] void refuse_output(const std::filesystem::path& file, std::string_view reason);

/// Throws OutputError if the file exists: it is replaced only with the option --force.
void refuse_existing(const std::filesystem::path& file);

/// Writes a file with worldio::write_whole(), after await_reader(). Throws OutputError if it cannot be
/// written.
void write_output(const std::filesystem::path& file, std::initializer_list<std::string_view> pieces);

/// Checks a file with worldio::check_replaceable(). Throws OutputError if it cannot be written. Ignores an
/// empty path. Call it before a run, so that the results are not lost at its end.
void check_replaceable(const std::filesystem::path& file);

/// Throws OutputError if another process holds the lock of lock_output() on the file. A run calls it before
/// it changes any output: after lock_output() has thrown, another output may already have been emptied.
void check_unlocked(const std::filesystem::path& file);

/// Locks an output before it is opened, so that no two processes write their lines into one file. Creates the
/// file if it does not exist. Returns the descriptor that holds the lock; it is not open if the file is a
/// device or a pipe, or cannot be opened. Throws OutputError if another process holds the lock.
[[nodiscard]] worldio::Descriptor lock_output(const std::filesystem::path& file);

/// Opens an output for writing, after await_reader(), and locks it as lock_output() does. kept: if set, the
/// file exists and is continued: its first `kept` bytes remain, and the others are cut off; else a new file
/// replaces it. Returns the descriptor that holds the lock. Throws OutputError if the file cannot be written,
/// or if another process is writing it.
[[nodiscard]] worldio::Descriptor open_output(std::ofstream& stream, const std::filesystem::path& file,
                                              std::optional<std::uintmax_t> kept);

/// Throws std::runtime_error after a write to an output has failed: `file: error: writing failed at tick 5:
/// reason`, with the reason that errno gives. Before, closes `stream` if it is open, and cuts the file to its
/// first `bytes` bytes, the lines that were written completely. Does not cut a device or a pipe.
[[noreturn]] void throw_write_error(std::ofstream& stream, const std::filesystem::path& file,
                                    std::uintmax_t bytes, std::uint64_t tick);

/// A file that a run reads, which no output may replace.
struct Input {
  std::filesystem::path file;
  std::string_view what;  ///< what the file is, for messages: "the world"
};
/// Checks that each of `outputs` can be written. Creates no file and no folder, so an invalid world leaves
/// none. Ignores empty paths. Throws OutputError if an output does not meet these conditions:
///
/// - Its folder exists.
/// - If the file exists, it is writable and not a folder. If the file does not exist, its folder is writable.
/// - The file is not one of `inputs`, and no two of `outputs` are the same file. Each frame of a film such as
///   frames/%06d.png is a file of its own.
/// - No input and no other output has the name of a temporary file of the output (worldio::PartialFile).
void check_outputs(const std::vector<Input>& inputs, const std::vector<std::filesystem::path>& outputs);
/// A type of text file that a run writes and replaces without --force.
struct ReplacedType {
  std::string_view name;        ///< with its option, for messages: "a hash log (--hash-log)"
  std::string_view mark;        ///< the beginning of each file of this type
  std::string_view other = {};  ///< the longer beginning of files of another type that begin with `mark` too
  std::string_view choose = "file name";  ///< for messages: of what the user chooses another one
};
/// Checks that replacing `file` by a new file of this type loses no file of another type. Throws OutputError
/// if `file` is a regular file that does not begin with the mark of the type. Accepts an empty file and a
/// file that ends within the mark, because a run that was killed may leave such a file. Changes nothing.
void check_replaced(const std::filesystem::path& file, const ReplacedType& type);
/// Checks a text file that a run writes line by line, and that a resumed run continues: that no other process
/// is writing it (check_unlocked()) and, unless the run is resumed, that it may be replaced
/// (check_replaced()). Throws OutputError if a check fails.
void check_lines_file(const std::filesystem::path& file, const Simulation& simulation,
                      const ReplacedType& type);
/// Throws the OutputError of check_replaced().
[[noreturn]] void refuse_other_type(const std::filesystem::path& file, const ReplacedType& type);
/// Appends the files of the world to `inputs`: all files that were read to load the simulation. Appends
/// nothing for a simulation that was resumed from a checkpoint (saved state of a run).
void add_inputs(const Simulation& simulation, std::vector<Input>& inputs);
/// Appends the files of Python scripts with controllers (--controller) to `inputs`.
void add_inputs(std::span<const std::shared_ptr<const Script>> scripts, std::vector<Input>& inputs);
/// Checks that files can be written into a folder. If the folder does not exist, checks that it can be
/// created: its parent folder must exist and be writable. Throws OutputError if a check fails. Ignores an
/// empty path. Creates no file and no folder.
void check_folder(const std::filesystem::path& folder);

}  // namespace troupe::apps
