#include "apps/outputs.hpp"

#include "apps/interrupt.hpp"
#include "apps/pictures/picture_options.hpp"
#include "engine/world/world.hpp"
#include "troupe/input_files.hpp"
#include "worldio/file_lock.hpp"
#include "worldio/files.hpp"
#include "worldio/whole_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <system_error>

namespace troupe::apps {
namespace fs = std::filesystem;
namespace {

/// Returns the status of a file or folder. Throws OutputError for `output`, with the reason that the system
/// gives, if the system cannot tell the status: for example, a folder on the path may not be searched.
fs::file_status status_of(const fs::path& file, const fs::path& output) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (status.type() == fs::file_type::none) refuse_output(output, error.message());
  return status;
}

/// Throws OutputError if the file cannot be written. Creates nothing.
void check_output(const fs::path& file) {
  std::error_code ignored;
  // A link to a file that does not exist yet may lead to a folder that does not exist or is not writable. If
  // the file exists, the link need not be a path: /dev/stdout is a link to an open file, whose folder may
  // have been removed, or may not exist in the container.
  const bool leads_nowhere = fs::is_symlink(file, ignored) && !fs::exists(status_of(file, file));
  const fs::path target = leads_nowhere ? worldio::resolved_path(file) : file;
  const fs::path folder = target.has_parent_path() ? target.parent_path() : ".";
  if (!fs::is_directory(status_of(folder, file)))
    refuse_output(file, fmt::format("there is no folder {}", folder.string()));
  if (fs::is_directory(status_of(file, file))) refuse_output(file, "it is a folder");
  const fs::path& written = fs::exists(file, ignored) ? file : folder;
  if (access(written.c_str(), W_OK) != 0) refuse_output(file, std::strerror(errno));
}

/// Opens and locks an output. flags: further flags of open(). Returns the descriptor that holds the lock; it
/// is not open if the file is a device or a pipe, or cannot be opened. Throws OutputError if another process
/// holds the lock.
worldio::Descriptor locked(const fs::path& file, int flags) {
  constexpr unsigned k_mode = 0666;  // permissions of a new file, before the umask
  std::error_code ignored;
  if (fs::is_other(file, ignored)) return {};
  worldio::Descriptor lock(file, O_WRONLY | flags, k_mode);  // NFS locks only files that are open to write
  if (lock.get() >= 0 && worldio::lock_file(lock.get()) == worldio::FileLock::held)
    refuse_output(file, "another process is writing the file: choose another file, or wait until it ends");
  return lock;
}

/// Whether `file` is a picture of a film that is written as one file per frame, such as frames/000012.png of
/// the film frames/%06d.png.
bool is_frame_of(const fs::path& film, const fs::path& file) {
  if (!is_frames(film)) return false;
  const std::string name = worldio::resolved_path(file).filename().string();
  const std::size_t first = film.filename().string().find(k_number_mark);
  std::size_t number = 0;
  return first < name.size() &&
         std::from_chars(name.data() + first, name.data() + name.size(), number).ec == std::errc() &&
         same_file(frame_file(film, number), file);
}

/// Returns the files of which `file` may be a partial file (worldio::PartialFile), or a partial file of a
/// partial file. Empty if `file` does not have the name of a partial file.
std::vector<fs::path> files_with_partial_file(const fs::path& file) {
  constexpr std::string_view k_mark = ".partial";
  constexpr int k_most_numbers = 2;  // NAME.<process>.<number>.partial
  const fs::path resolved = worldio::resolved_path(file);
  const std::string name = resolved.filename().string();
  std::vector<fs::path> files;
  for (std::size_t at = name.find(k_mark); at != name.npos; at = name.find(k_mark, at + 1)) {
    const std::size_t end = at + k_mark.size();
    if (end < name.size() && name[end] != '.') continue;
    std::string written = name.substr(0, at);
    for (int numbers = 0; !written.empty(); ++numbers) {
      files.push_back(resolved.parent_path() / written);
      const std::size_t digits = written.find_last_not_of("0123456789") + 1;
      if (numbers == k_most_numbers || digits == 0 || digits == written.size() || written[digits - 1] != '.')
        break;
      written.resize(digits - 1);
    }
  }
  return files;
}

/// Whether writing the output replaces `file`: they are the same file, or `file` is a frame of a film.
bool replaces(const fs::path& output, const fs::path& file) {
  return same_file(output, file) || is_frame_of(output, file);
}

/// An input or output, and what the checks of pairs of files need of it. This is computed once for each file,
/// because a run may have thousands of snapshots, and each pair of files is compared.
struct NamedFile {
  explicit NamedFile(const fs::path& named)
      : file(named), resolved(worldio::resolved_path(named)), partial_of(files_with_partial_file(named)) {
    std::error_code ignored;
    exists = fs::exists(named, ignored);
  }

  fs::path file;
  fs::path resolved;
  bool exists;
  std::vector<fs::path> partial_of;  ///< files_with_partial_file()
};

/// Whether `file` has the name of a temporary file with which `output` may be written.
bool is_partial_file_of(const fs::path& output, const NamedFile& file) {
  return std::ranges::any_of(file.partial_of,
                             [&](const fs::path& written) { return replaces(output, written); });
}

/// Throws OutputError if the output would replace the input, or if one has the name of a temporary file of
/// the other. what: what the input is (Input::what)
void check_input(const NamedFile& output, const NamedFile& input, std::string_view what) {
  if (replaces(output.file, input.file))
    refuse_output(output.file,
                  fmt::format("it is {}, which this command reads: choose another file name", what));
  if (is_partial_file_of(output.file, input))
    refuse_output(output.file,
                  fmt::format("{}, {}, has the name of its temporary file: choose another file name", what,
                              input.file.string()));
  if (is_partial_file_of(input.file, output))
    refuse_output(output.file,
                  fmt::format("a temporary file of {}, {}, may have this name: choose another file name",
                              what, input.file.string()));
}

/// Throws OutputError if the two outputs write the same file.
void check_two(const NamedFile& output, const NamedFile& other) {
  const bool is_same = output.resolved == other.resolved ||
                       (output.exists && other.exists && same_file(output.file, other.file));
  if (is_same || is_frame_of(output.file, other.file) || is_frame_of(other.file, output.file))
    refuse_output(output.file, "another output has the same name: choose another file name");
  const auto check_partial = [](const NamedFile& whole, const NamedFile& partial) {
    if (is_partial_file_of(whole.file, partial))
      refuse_output(partial.file, fmt::format("another output, {}, uses this name for a temporary file: "
                                              "choose another file name",
                                              whole.file.string()));
  };
  check_partial(output, other);
  check_partial(other, output);
}

}  // namespace

void refuse_output(const fs::path& file, std::string_view reason) {
  throw OutputError(fmt::format("{}: error: cannot be written: {}", file.string(), reason));
}

void refuse_existing(const fs::path& file) {
  std::error_code ignored;
  if (fs::exists(file, ignored))
    throw OutputError(fmt::format("{}: error: the file exists; --force replaces it", file.string()));
}

worldio::Descriptor await_reader(const fs::path& file) {
  constexpr int k_wait_ms = 50;
  std::error_code ignored;
  while (fs::is_fifo(file, ignored)) {
    // Open until the result is, so that the reader does not see the end of the pipe.
    const worldio::Descriptor trial(file, O_WRONLY | O_NONBLOCK);
    if (trial.get() >= 0) return {file, O_RDWR | O_NONBLOCK};
    if (errno != ENXIO) return {};
    if (stop_requested())
      throw StoppedError(fmt::format(
          "{}: error: nothing was written: the program was stopped before another program read this "
          "pipe",
          file.string()));
    poll(nullptr, 0, k_wait_ms);
  }
  return {};
}

void write_output(const fs::path& file, std::initializer_list<std::string_view> pieces) {
  const worldio::Descriptor reader = await_reader(file);
  try {
    worldio::write_whole(file, pieces);
  } catch (const std::system_error& error) {
    refuse_output(file, error.code().message());
  }
}

void check_replaceable(const fs::path& file) {
  if (file.empty()) return;
  try {
    worldio::check_replaceable(file);
  } catch (const std::system_error& error) {
    refuse_output(file, error.code().message());
  }
}

void check_unlocked(const fs::path& file) { static_cast<void>(locked(file, 0)); }

worldio::Descriptor lock_output(const fs::path& file) { return locked(file, O_CREAT); }

worldio::Descriptor open_output(std::ofstream& stream, const fs::path& file,
                                std::optional<std::uintmax_t> kept) {
  worldio::Descriptor lock = lock_output(file);
  const worldio::Descriptor reader = await_reader(file);
  stream.open(file, std::ios::binary | (kept ? std::ios::app : std::ios::trunc));  // before the file is cut
  if (!stream) refuse_output(file, std::strerror(errno));
  if (!kept) return lock;
  std::error_code error;
  fs::resize_file(file, *kept, error);
  if (error) refuse_output(file, error.message());
  return lock;
}

void throw_write_error(std::ofstream& stream, const fs::path& file, std::uintmax_t bytes,
                       std::uint64_t tick) {
  const int error = errno;
  if (stream.is_open()) {
    stream.close();  // first: it tries again to write what is left in its buffer
    std::error_code ignored;
    if (fs::is_regular_file(file, ignored)) fs::resize_file(file, bytes, ignored);
  }
  throw std::runtime_error(
      fmt::format("{}: error: writing failed at tick {}: {}", file.string(), tick, std::strerror(error)));
}

void check_outputs(const std::vector<Input>& inputs, const std::vector<fs::path>& outputs) {
  std::vector<NamedFile> read;
  for (const Input& input : inputs) read.emplace_back(input.file);
  std::vector<NamedFile> written;
  for (const fs::path& file : outputs) {
    if (file.empty()) continue;
    check_output(file);
    const NamedFile output(file);
    for (std::size_t i = 0; i < inputs.size(); ++i) check_input(output, read[i], inputs[i].what);
    for (const NamedFile& other : written) check_two(output, other);
    written.push_back(output);
  }
}

void check_replaced(const fs::path& file, const ReplacedType& type) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) refuse_output(file, fmt::format("the existing file cannot be read: {}", std::strerror(errno)));
  std::string start(std::max(type.mark.size(), type.other.size()), '\0');
  stream.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(stream.gcount()));
  const bool is_other = !type.other.empty() && start.starts_with(type.other);
  if (!is_other && (start.starts_with(type.mark) || type.mark.starts_with(start))) return;
  refuse_other_type(file, type);
}

void check_lines_file(const fs::path& file, const Simulation& simulation, const ReplacedType& type) {
  check_unlocked(file);
  if (!simulation.resumed_at_tick()) check_replaced(file, type);
}

void refuse_other_type(const fs::path& file, const ReplacedType& type) {
  refuse_output(file, fmt::format("the file exists and is not {}: choose another {}, or remove the file",
                                  type.name, type.choose));
}

void add_inputs(const Simulation& simulation, std::vector<Input>& inputs) {
  if (simulation.resumed_at_tick()) return;  // a checkpoint contains its world
  for (const fs::path& file : input_files(simulation.world().spec()))
    inputs.push_back({file, "a file of the world"});
}

void add_inputs(std::span<const std::shared_ptr<const Script>> scripts, std::vector<Input>& inputs) {
  for (const auto& script : scripts) inputs.push_back({script->file, "a script"});
}

void check_folder(const fs::path& folder) {
  if (folder.empty()) return;
  std::error_code ignored;
  const fs::file_status status = status_of(folder, folder);
  const bool is_there = fs::exists(status);
  if (is_there && !fs::is_directory(status)) refuse_output(folder, "it is not a folder");
  if (!is_there && fs::is_symlink(folder, ignored))
    refuse_output(folder, "it is a symbolic link to a folder that does not exist");
  const fs::path above = folder.has_parent_path() ? folder.parent_path() : ".";
  if (!is_there && !fs::is_directory(above, ignored))
    refuse_output(folder, fmt::format("there is no folder {}", above.string()));
  if (access((is_there ? folder : above).c_str(), W_OK) != 0) refuse_output(folder, std::strerror(errno));
}

}  // namespace troupe::apps
