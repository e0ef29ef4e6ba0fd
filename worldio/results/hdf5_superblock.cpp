#include "worldio/results/hdf5_superblock.hpp"

#include "worldio/files.hpp"
#include "worldio/results/descriptor.hpp"
#include "worldio/results/hdf5_checksum.hpp"
#include "worldio/results/little_endian.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <system_error>

namespace troupe::worldio {
namespace {

// Offsets of the fields in the superblock, bytes. Addresses have 8 bytes, the only size in use.
constexpr std::size_t k_bytes = 48;
constexpr std::size_t k_version_at = 8;
constexpr std::size_t k_offset_size = 9;
constexpr std::size_t k_flags = 11;
constexpr std::size_t k_end_at = 28;
constexpr std::size_t k_checksum = 44;

using SuperblockBytes = std::array<std::uint8_t, k_bytes>;

bool is_whole(const SuperblockBytes& head) {
  const std::uint8_t version = head[k_version_at];
  return std::ranges::equal(k_hdf5_signature, std::span(head).first(k_hdf5_signature.size()), {},
                            [](char c) { return static_cast<std::uint8_t>(c); }) &&
         (version == 2 || version == 3) && head[k_offset_size] == 8 &&
         little_endian(std::span(head).subspan(k_checksum)) ==
             metadata_checksum(std::span(head).first(k_checksum));
}

std::optional<SuperblockBytes> read_head(int fd) {
  SuperblockBytes head{};
  if (fd < 0 || pread(fd, head.data(), head.size(), 0) != static_cast<ssize_t>(head.size()) ||
      !is_whole(head))
    return std::nullopt;
  return head;
}

}  // namespace

std::optional<Hdf5Superblock> read_superblock(const std::filesystem::path& file) {
  if (!check_readable(file)) return std::nullopt;
  // A process that writes the file may be overwriting the superblock at this moment.
  constexpr int k_attempts = 100;
  const Descriptor descriptor(file, O_RDONLY);
  std::optional<SuperblockBytes> head;
  for (int i = 0; i < k_attempts && !head; ++i) head = read_head(descriptor.get());
  if (!head) return std::nullopt;
  return Hdf5Superblock{(*head)[k_flags], little_endian(std::span(*head).subspan(k_end_at, 8))};
}

void close_superblock(const std::filesystem::path& file) {
  const auto fail = [&](const std::string& reason) {
    throw std::runtime_error(
        fmt::format("{}: error: cannot be marked as finished: {}", file.string(), reason));
  };
  const auto system_reason = [] { return std::generic_category().message(errno); };
  const Descriptor descriptor(file, O_RDWR);
  if (descriptor.get() < 0) fail(system_reason());
  std::optional<SuperblockBytes> head = read_head(descriptor.get());
  if (!head) fail("its HDF5 header is damaged");
  struct stat status {};
  if (fstat(descriptor.get(), &status) != 0) fail(system_reason());
  // The file must have exactly the recorded size. HDF5 considers a shorter file truncated (space was
  // allocated but never written) and a longer file damaged.
  const auto size = static_cast<std::uint64_t>(status.st_size);
  const std::uint64_t end = std::max(size, little_endian(std::span(*head).subspan(k_end_at, 8)));
  if (end > size && ftruncate(descriptor.get(), static_cast<off_t>(end)) != 0) fail(system_reason());
  (*head)[k_flags] = 0;
  put_little_endian(end, std::span(*head).subspan(k_end_at, 8));
  put_little_endian(metadata_checksum(std::span(*head).first(k_checksum)),
                    std::span(*head).subspan(k_checksum));
  if (pwrite(descriptor.get(), head->data(), head->size(), 0) != static_cast<ssize_t>(head->size()))
    fail(system_reason());
}

}  // namespace troupe::worldio
