#include "worldio/sealed_file.hpp"

#include "base/diagnostics.hpp"
#include "base/hash.hpp"
#include "worldio/hdf5_superblock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace troupe::worldio {
namespace fs = std::filesystem;
namespace {

std::string first_line(std::string_view kind) { return fmt::format("troupe {}\n", kind); }

std::string head(std::string_view kind, unsigned layout, std::uint64_t bytes, std::uint64_t hash) {
  std::string text =
      fmt::format("{}layout {}\nbytes {}\nxxh3 {}\n", first_line(kind), layout, bytes, hex(hash));
  text.resize(k_seal_bytes - 1, ' ');
  return text + '\n';
}

/// The number behind `key` at the start of a line of the head.
std::optional<std::uint64_t> number_after(std::string_view head, std::string_view key, int base = 10) {
  const std::size_t line = head.find(fmt::format("\n{} ", key));
  if (line == head.npos) return std::nullopt;
  const char* const begin = head.data() + line + key.size() + 2;
  std::uint64_t number = 0;
  const auto [end, fault] = std::from_chars(begin, head.data() + head.size(), number, base);
  return fault == std::errc() && *end == '\n' ? std::optional(number) : std::nullopt;
}

struct Content {
  std::string head;  // of a file that is shorter, all of it
  std::uint64_t bytes = 0;
  std::uint64_t hash = 0;
};

/// Head and hash of a file. Throws std::system_error.
Content content_of(const fs::path& file) {
  constexpr std::size_t k_piece = 1 << 20;
  const auto failed = [] { return std::system_error(errno, std::generic_category()); };
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw failed();
  std::vector<char> piece(k_piece);
  Content content;
  HashStream hash;
  stream.read(piece.data(), k_seal_bytes);
  content.head.assign(piece.data(), static_cast<std::size_t>(stream.gcount()));
  while (stream) {
    stream.read(piece.data(), k_piece);
    const auto bytes = static_cast<std::size_t>(stream.gcount());
    hash.add(std::as_bytes(std::span(piece.data(), bytes)));
    content.bytes += bytes;
  }
  if (stream.bad()) throw failed();
  content.hash = hash.hash();
  return content;
}

/// A file or folder, open until the end of the scope. Throws std::system_error.
class Descriptor {
 public:
  Descriptor(const fs::path& path, int flags) : id_(open(path.c_str(), flags | O_CLOEXEC, k_mode)) {
    check(id_);
  }
  ~Descriptor() { close(id_); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int id() const { return id_; }
  static void check(std::int64_t result) {
    if (result < 0) throw std::system_error(errno, std::generic_category());
  }

 private:
  static constexpr mode_t k_mode = 0666;  // of a new file, less what the user's umask takes away
  int id_;
};

void write_all(int file, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    Descriptor::check(written);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

/// The name, too, is on the disk when this returns.
void give_name(const fs::path& partial, const fs::path& file) {
  Descriptor::check(std::rename(partial.c_str(), file.c_str()));
  const Descriptor folder(file.has_parent_path() ? file.parent_path() : ".", O_RDONLY | O_DIRECTORY);
  // Not every file system can do that with a folder; the file itself is safe.
  static_cast<void>(fsync(folder.id()));
}

}  // namespace

void write_sealed(const fs::path& file, std::string_view kind, unsigned layout,
                  std::span<const std::byte> bytes) {
  std::error_code ignored;
  const auto refuse = [&file](const std::string& reason) {
    throw std::runtime_error(fmt::format("{}: error: cannot be written: {}", file.string(), reason));
  };
  // To be replaced by a file would not become a device.
  if (fs::exists(file, ignored) && !fs::is_regular_file(file, ignored)) refuse("it is no regular file");
  const std::span<const std::byte> rest = bytes.subspan(k_seal_bytes);
  const std::string text = head(kind, layout, rest.size(), hash_bytes(rest));
  // One name for all of them: who is killed now and then leaves one such file, not many.
  const fs::path partial = fs::path(file).concat(".partial");
  try {
    {
      const Descriptor out(partial, O_WRONLY | O_CREAT | O_TRUNC);
      write_all(out.id(), std::as_bytes(std::span(text)));
      write_all(out.id(), rest);
      Descriptor::check(fsync(out.id()));
    }
    give_name(partial, file);
  } catch (const std::system_error& fault) {
    fs::remove(partial, ignored);
    refuse(fault.code().message());
  }
}

void check_seal(const fs::path& file, std::string_view kind, unsigned layout) {
  const auto refuse = [&file](std::string_view reason) {
    throw InputError(fmt::format("{}: error: {}", file.string(), reason));
  };
  std::error_code ignored;
  if (!fs::exists(file, ignored)) refuse("there is no such file");
  if (fs::is_directory(file, ignored)) refuse("this is a folder");
  Content content;
  try {
    content = content_of(file);
  } catch (const std::system_error& fault) {
    refuse(fmt::format("cannot be read: {}", fault.code().message()));
  }
  const std::string& text = content.head;
  const std::string mark = first_line(kind);
  if (text.empty()) refuse(fmt::format("this is no {}: the file is empty", kind));
  if (text.starts_with(k_hdf5_signature)) refuse(fmt::format("this is an HDF5 file, but no {}", kind));
  if (!text.starts_with(mark) && !mark.starts_with(text)) {
    if (text.starts_with("troupe ")) refuse(fmt::format("this is no {}, or a damaged one", kind));
    refuse(fmt::format("this is no {}", kind));
  }
  // The first line and the second are those of every layout.
  const auto number = number_after(text, "layout");
  if (number && *number != layout)
    refuse(fmt::format("its layout is {}, of {} version; this program reads {}", *number,
                       *number > layout ? "a newer" : "an older", layout));
  const auto bytes = number_after(text, "bytes");
  if (text.size() < k_seal_bytes || (bytes && content.bytes < *bytes))
    refuse(fmt::format("the file was cut off, after {} bytes{}", text.size() + content.bytes,
                       bytes ? fmt::format(" of {}", k_seal_bytes + *bytes) : ""));
  if (text != head(kind, layout, content.bytes, content.hash))
    refuse("the file is damaged: its hash is not the one that was written into it");
}

bool has_seal(const fs::path& file, std::string_view kind) {
  std::ifstream stream(file, std::ios::binary);
  const std::string mark = first_line(kind);
  std::string text(mark.size(), ' ');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  return stream.gcount() == static_cast<std::streamsize>(mark.size()) && text == mark;
}

}  // namespace troupe::worldio
