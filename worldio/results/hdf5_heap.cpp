#include "worldio/results/hdf5_heap.hpp"

#include "worldio/results/little_endian.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>

namespace troupe::worldio {
namespace {

// A collection of the global heap begins with a head: signature, version, three reserved bytes, and the size
// of the collection including this head. Its objects follow. Each has a number, a reference count, four
// reserved bytes, a size, and the content padded to whole words. The object with number 0 is the free space
// at the end (HDF5 File Format Specification 3.0, section III.E).
constexpr std::string_view k_signature = "GCOL";
constexpr std::uint8_t k_version = 1;
constexpr std::uint64_t k_head_bytes = 16;  // size of the head of a collection or of an object
constexpr std::uint64_t k_word_bytes = 8;

using Head = std::array<std::uint8_t, k_head_bytes>;

/// Fills `into` with the bytes of a file from position `at`. False if the file is too short.
bool read_at(std::ifstream& stream, std::uint64_t at, std::span<std::uint8_t> into) {
  stream.clear();
  stream.seekg(static_cast<std::streamoff>(at));
  stream.read(reinterpret_cast<char*>(into.data()), static_cast<std::streamsize>(into.size()));
  return stream.good();
}

std::uint64_t number(const Head& head, std::size_t at, std::size_t bytes) {
  return little_endian(std::span(head).subspan(at, bytes));
}

}  // namespace

std::optional<std::string> read_heap_text(const std::filesystem::path& file, std::uint64_t base,
                                          std::span<const std::uint8_t, k_heap_reference_bytes> reference) {
  const std::uint64_t length = little_endian(reference.subspan(0, 4));
  const std::uint64_t address = little_endian(reference.subspan(4, 8));
  const std::uint64_t wanted = little_endian(reference.subspan(12, 4));
  if (length == 0) return std::string();

  std::error_code unknown;
  const std::uint64_t file_bytes = std::filesystem::file_size(file, unknown);
  if (unknown || base > file_bytes || address > file_bytes - base) return std::nullopt;
  std::ifstream stream(file, std::ios::binary);
  Head head{};
  const std::uint64_t first = base + address;
  if (!read_at(stream, first, head) || !std::equal(k_signature.begin(), k_signature.end(), head.begin()) ||
      head[k_signature.size()] != k_version)
    return std::nullopt;
  const std::uint64_t bytes = number(head, 8, 8);
  if (bytes < k_head_bytes || bytes > file_bytes - first) return std::nullopt;

  for (std::uint64_t at = k_head_bytes; bytes - at >= k_head_bytes;) {
    if (!read_at(stream, first + at, head)) return std::nullopt;
    const std::uint64_t object = number(head, 0, 2);
    const std::uint64_t size = number(head, 8, 8);
    at += k_head_bytes;
    if (object == 0 || size > bytes - at) return std::nullopt;
    if (object == wanted) {
      if (length > size) return std::nullopt;
      std::string text(length, '\0');
      const std::span into(reinterpret_cast<std::uint8_t*>(text.data()), text.size());
      return read_at(stream, first + at, into) ? std::optional(std::move(text)) : std::nullopt;
    }
    const std::uint64_t filled = (size + k_word_bytes - 1) / k_word_bytes * k_word_bytes;
    if (filled > bytes - at) return std::nullopt;
    at += filled;
  }
  return std::nullopt;
}

}  // namespace troupe::worldio
