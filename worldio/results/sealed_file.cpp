#include "worldio/results/sealed_file.hpp"

#include "base/diagnostics.hpp"
#include "base/hash.hpp"
#include "worldio/files.hpp"
#include "worldio/partial_file.hpp"
#include "worldio/results/hdf5_superblock.hpp"

#include <fmt/format.h>

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

/// Returns the number after `key` in the line of the head that begins with `key`. Empty if there is no such
/// line.
std::optional<std::uint64_t> number_after(std::string_view head, std::string_view key) {
  const std::size_t line = head.find(fmt::format("\n{} ", key));
  if (line == head.npos) return std::nullopt;
  const char* const begin = head.data() + line + key.size() + 2;
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(begin, head.data() + head.size(), number);
  return error == std::errc() && *end == '\n' ? std::optional(number) : std::nullopt;
}

struct Content {
  std::string head;         // the head; the whole file if that is shorter than a head
  std::uint64_t bytes = 0;  // number of bytes after the head
  std::uint64_t hash = 0;   // XXH3 of these bytes
};

/// Reads the head of a file and computes the hash of the rest. Throws std::system_error if the file cannot be
/// read.
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

}  // namespace

void write_sealed(const fs::path& file, std::string_view kind, unsigned layout,
                  std::span<const std::byte> bytes) {
  std::error_code ignored;
  const auto refuse = [&file](const std::string& reason) {
    throw std::runtime_error(fmt::format("{}: error: cannot be written: {}", file.string(), reason));
  };
  // A device such as /dev/null is refused, because the rename would replace it by a file.
  if (fs::exists(file, ignored) && !fs::is_regular_file(file, ignored)) refuse("it is not a regular file");
  const std::span<const std::byte> rest = bytes.subspan(k_seal_bytes);
  const std::string text = head(kind, layout, rest.size(), hash_bytes(rest));
  try {
    PartialFile out(file);
    out.write(std::as_bytes(std::span(text)));
    out.write(rest);
    out.commit_to_disk();
  } catch (const std::system_error& error) {
    refuse(write_failure(file, error.code().message()));
  }
}

void check_seal(const fs::path& file, std::string_view kind, unsigned layout) {
  const auto refuse = [&file](std::string_view reason) {
    throw InputError(fmt::format("{}: error: {}", file.string(), reason));
  };
  if (const Result<> readable = check_readable(file); !readable) refuse(readable.error().text);
  Content content;
  try {
    content = content_of(file);
  } catch (const std::system_error& error) {
    refuse(fmt::format("cannot be read: {}", error.code().message()));
  }
  const std::string& text = content.head;
  const std::string mark = first_line(kind);
  if (text.empty()) refuse(fmt::format("this is not a {}: the file is empty", kind));
  if (text.starts_with(k_hdf5_signature)) refuse(fmt::format("this is an HDF5 file, but not a {}", kind));
  if (!text.starts_with(mark) && !mark.starts_with(text)) {
    if (text.starts_with("troupe ")) refuse(fmt::format("this is not a {}, or it is damaged", kind));
    refuse(fmt::format("this is not a {}", kind));
  }
  // The first two lines are the same in every layout.
  const auto number = number_after(text, "layout");
  if (number && *number != layout)
    refuse(fmt::format("the file has layout {}, that of {} version of Troupe; this program reads layout {}",
                       *number, *number > layout ? "a newer" : "an older", layout));
  const auto bytes = number_after(text, "bytes");
  if (text.size() < k_seal_bytes || (bytes && content.bytes < *bytes))
    refuse(fmt::format("the file was cut off: it has {} bytes{}", text.size() + content.bytes,
                       bytes ? fmt::format(" instead of {}", k_seal_bytes + *bytes) : ""));
  if (text != head(kind, layout, content.bytes, content.hash))
    refuse("the file is damaged: its hash differs from the one in its header");
}

bool has_seal(const fs::path& file, std::string_view kind) {
  if (!check_readable(file)) return false;
  std::ifstream stream(file, std::ios::binary);
  const std::string mark = first_line(kind);
  std::string text(mark.size(), ' ');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  return stream.gcount() == static_cast<std::streamsize>(mark.size()) && text == mark;
}

}  // namespace troupe::worldio
