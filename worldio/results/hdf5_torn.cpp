#include "worldio/results/hdf5_torn.hpp"

#include "worldio/results/hdf5_checksum.hpp"
#include "worldio/results/hdf5_superblock.hpp"
#include "worldio/results/little_endian.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace troupe::worldio {
namespace {

using FileBytes = std::vector<std::uint8_t>;
using View = std::span<const std::uint8_t>;

constexpr std::size_t k_checksum_bytes = 4;
constexpr std::size_t k_address_bytes = 8;  // the only size in use
constexpr std::uint64_t k_page_bytes = 4096;
constexpr std::size_t k_most_block_bytes = std::size_t{1} << 20;  // larger blocks are not from Troupe
// No byte of an undamaged file is read more often. This limit ends the search in a file whose blocks refer to
// one another in circles, or thousands of times to the same block.
constexpr std::uint64_t k_most_reads = 3;

/// The numbers at the start of the header of an extensible array ("EAHD"), which stores the addresses of the
/// chunks of a dataset. Its *elements* are in an index block, in data blocks to which the index block points,
/// and in data blocks to which super blocks point. Super block u stands for blocks_of(u) data blocks of
/// elements_of(u) elements each.
struct ArrayShape {
  std::size_t element_bytes;
  std::size_t bits;             // of an element's index
  std::size_t in_index_block;   // number of elements
  std::size_t least_elements;   // of a data block
  std::size_t least_addresses;  // of a super block
  std::size_t page_elements;    // of a data block that is divided into pages

  static std::optional<ArrayShape> of(View header) {
    const ArrayShape shape{header[6], header[7],  header[8],
                           header[9], header[10], std::size_t{1} << (header[11] & 31)};
    const bool is_sound = shape.element_bytes > 0 && shape.bits <= 32 &&
                          std::has_single_bit(shape.least_elements) &&
                          std::has_single_bit(shape.least_addresses) && shape.least_addresses > 1 &&
                          shape.least_elements <= std::size_t{1} << shape.bits &&
                          shape.super_blocks() > shape.first_super_block();
    return is_sound ? std::optional(shape) : std::nullopt;
  }
  std::size_t super_blocks() const {
    return 1 + bits - static_cast<std::size_t>(std::countr_zero(least_elements));
  }
  /// The first super block that is a block of its own. The index block has the addresses of the data blocks
  /// of those before it.
  std::size_t first_super_block() const {
    return 2 * static_cast<std::size_t>(std::countr_zero(least_addresses));
  }
  static std::size_t blocks_of(std::size_t u) { return std::size_t{1} << (u / 2); }
  std::size_t elements_of(std::size_t u) const { return least_elements << ((u + 1) / 2); }
  /// Bytes in front of the elements of a data block and of the addresses of a super block: signature,
  /// version, client, address of the header, and index of the first element.
  std::size_t head_bytes() const { return 14 + (bits + 7) / 8; }
};

class Mender {
 public:
  explicit Mender(const std::filesystem::path& file)
      : file_(file), stream_(file, std::ios::in | std::ios::out | std::ios::binary) {
    if (!stream_.seekg(0, std::ios::end)) fail("read");
    end_ = static_cast<std::uint64_t>(stream_.tellg());
    unread_ = k_most_reads * end_;
  }

  void mend_object(std::uint64_t address) {
    const std::optional<FileBytes> head = read(address, "OHDR", 6);
    if (!head || (*head)[4] != 2) return;
    const std::uint8_t flags = (*head)[5];
    const std::size_t size_at = 6 + ((flags & 0x20) != 0 ? 16 : 0) + ((flags & 0x10) != 0 ? 4 : 0);
    const std::size_t first_message = size_at + (std::size_t{1} << (flags & 3));
    const std::optional<FileBytes> sizes = read(address, "OHDR", first_message);
    if (!sizes) return;
    const std::uint64_t bytes = little_endian(View(*sizes).subspan(size_at));
    if (bytes > k_most_block_bytes) return;
    std::optional<FileBytes> block = read(address, "OHDR", first_message + bytes + k_checksum_bytes);
    if (!block) return;
    mend(address, *block);
    take_messages(View(*block).subspan(first_message, bytes), flags);
    while (!continuations_.empty()) {
      const Continuation next = continuations_.back();
      continuations_.pop_back();
      mend_continuation(next, flags);
    }
  }

  std::size_t mended() const { return mended_; }

 private:
  /// A block in which an object header continues.
  struct Continuation {
    std::uint64_t address;
    std::uint64_t bytes;
  };

  [[noreturn]] void fail(std::string_view action) const {
    throw std::runtime_error(fmt::format("{}: error: cannot be {}", file_.string(), action));
  }

  /// Reads a block. Returns nothing if the block is not in the file, does not begin with this signature, or
  /// exceeds the limit k_most_reads.
  std::optional<FileBytes> read(std::uint64_t address, std::string_view signature, std::size_t bytes) {
    if (bytes > k_most_block_bytes || address > end_ || bytes > end_ - address || bytes > unread_)
      return std::nullopt;
    unread_ -= bytes;
    FileBytes block(bytes);
    if (!stream_.seekg(static_cast<std::streamoff>(address)) ||
        !stream_.read(reinterpret_cast<char*>(block.data()), static_cast<std::streamsize>(bytes)))
      fail("read");
    const auto is_same = [](std::uint8_t byte, char c) { return byte == static_cast<std::uint8_t>(c); };
    if (!std::ranges::equal(View(block).first(signature.size()), signature, is_same)) return std::nullopt;
    return block;
  }

  /// Whether a block is torn: its checksum is wrong, and it crosses a border of pages.
  static bool is_torn(std::uint64_t address, View block) {
    const View content = block.first(block.size() - k_checksum_bytes);
    return little_endian(block.last(k_checksum_bytes)) != metadata_checksum(content) &&
           address / k_page_bytes != (address + block.size() - 1) / k_page_bytes;
  }

  /// Mends a block that is torn. Addresses in `addresses`, a part of the block, that are beyond the end of
  /// the file are removed. A block that is not torn stays as it is.
  void mend(std::uint64_t address, std::span<std::uint8_t> block, std::span<std::uint8_t> addresses = {}) {
    if (!is_torn(address, block)) return;
    for (std::size_t at = 0; at + k_address_bytes <= addresses.size(); at += k_address_bytes)
      if (const auto one = addresses.subspan(at, k_address_bytes); little_endian(one) >= end_)
        put_little_endian(k_hdf5_no_address, one);
    put_little_endian(metadata_checksum(block.first(block.size() - k_checksum_bytes)),
                      block.last(k_checksum_bytes));
    if (!stream_.seekp(static_cast<std::streamoff>(address)) ||
        !stream_.write(reinterpret_cast<const char*>(block.data()),
                       static_cast<std::streamsize>(block.size())) ||
        !stream_.flush())
      fail("written");
    ++mended_;
  }

  /// Goes through the messages of an object header: lists its other blocks in continuations_, and mends the
  /// index of the chunks.
  void take_messages(View messages, std::uint8_t flags) {
    constexpr std::uint8_t k_layout = 8;
    constexpr std::uint8_t k_continuation = 16;
    const std::size_t head = (flags & 4) != 0 ? 6 : 4;
    while (messages.size() >= head) {
      const std::uint8_t type = messages[0];
      const std::size_t bytes = little_endian(messages.subspan(1, 2));
      if (bytes > messages.size() - head) return;
      const View message = messages.subspan(head, bytes);
      if (type == k_layout) take_layout(message);
      if (type == k_continuation && bytes >= 2 * k_address_bytes)
        continuations_.push_back({little_endian(message.first(k_address_bytes)),
                                  little_endian(message.subspan(k_address_bytes, k_address_bytes))});
      messages = messages.subspan(head + bytes);
    }
  }

  void mend_continuation(const Continuation& continuation, std::uint8_t flags) {
    constexpr std::size_t k_signature_bytes = 4;
    const auto [address, bytes] = continuation;
    if (bytes < k_signature_bytes + k_checksum_bytes || bytes > k_most_block_bytes) return;
    std::optional<FileBytes> block = read(address, "OCHK", bytes);
    if (!block) return;
    mend(address, *block);
    take_messages(View(*block).subspan(k_signature_bytes, bytes - k_signature_bytes - k_checksum_bytes),
                  flags);
  }

  void take_layout(View message) {
    constexpr std::uint8_t k_layout_version = 4;
    constexpr std::uint8_t k_chunked = 2;
    constexpr std::uint8_t k_extensible_array = 4;
    constexpr std::size_t k_numbers = 5;  // the same as in the header of the array
    if (message.size() < 5 || message[0] != k_layout_version || message[1] != k_chunked) return;
    const std::size_t index = 5 + std::size_t{message[3]} * message[4];
    if (message.size() < index + 1 + k_numbers + k_address_bytes || message[index] != k_extensible_array)
      return;
    mend_array(little_endian(message.subspan(index + 1 + k_numbers, k_address_bytes)));
  }

  void mend_array(std::uint64_t address) {
    constexpr std::size_t k_header_bytes = 72;
    constexpr std::size_t k_index_block = 60;
    std::optional<FileBytes> header = read(address, "EAHD", k_header_bytes);
    if (!header) return;
    mend(address, *header);
    const std::optional<ArrayShape> shape = ArrayShape::of(*header);
    if (!shape) return;
    const std::uint64_t index_block = little_endian(View(*header).subspan(k_index_block, k_address_bytes));

    constexpr std::size_t k_head = 14;  // an index block has no index of its first element
    const std::size_t elements = shape->in_index_block * shape->element_bytes;
    const std::size_t direct = 2 * (shape->least_addresses - 1);
    const std::size_t super_blocks = shape->super_blocks() - shape->first_super_block();
    const std::size_t bytes = (direct + super_blocks) * k_address_bytes;
    std::optional<FileBytes> block = read(index_block, "EAIB", k_head + elements + bytes + k_checksum_bytes);
    if (!block) return;
    // Elements of compressed chunks contain more than an address; their addresses are not changed.
    const bool has_addresses = shape->element_bytes == k_address_bytes;
    const std::span<std::uint8_t> all = *block;
    mend(index_block, all,
         has_addresses ? all.subspan(k_head, elements + bytes) : all.subspan(k_head + elements, bytes));
    View next = View(all).subspan(k_head + elements);
    const auto take_address = [&next] {
      const std::uint64_t taken = little_endian(next.first(k_address_bytes));
      next = next.subspan(k_address_bytes);
      return taken;
    };
    for (std::size_t u = 0; u < shape->first_super_block(); ++u)
      for (std::size_t b = 0; b < ArrayShape::blocks_of(u); ++b)
        mend_data_block(*shape, u, take_address(), {});
    for (std::size_t u = shape->first_super_block(); u < shape->super_blocks(); ++u)
      mend_super_block(*shape, u, take_address());
  }

  void mend_super_block(const ArrayShape& shape, std::size_t u, std::uint64_t address) {
    if (address == k_hdf5_no_address) return;
    const std::size_t blocks = ArrayShape::blocks_of(u);
    const std::size_t marks = (pages_of(shape, u) + 7) / 8;  // bytes per data block: which pages it has
    const std::size_t addresses = shape.head_bytes() + blocks * marks;
    std::optional<FileBytes> block =
        read(address, "EASB", addresses + blocks * k_address_bytes + k_checksum_bytes);
    if (!block) return;
    const std::span<std::uint8_t> all = *block;
    mend(address, all, all.subspan(addresses, blocks * k_address_bytes));
    for (std::size_t b = 0; b < blocks; ++b)
      mend_data_block(shape, u,
                      little_endian(View(all).subspan(addresses + b * k_address_bytes, k_address_bytes)),
                      View(all).subspan(shape.head_bytes() + b * marks, marks));
  }

  /// Number of the pages of a data block of super block u; 0 if it is not divided into pages.
  static std::size_t pages_of(const ArrayShape& shape, std::size_t u) {
    const std::size_t elements = shape.elements_of(u);
    return elements > shape.page_elements ? elements / shape.page_elements : 0;
  }

  /// marks: for each page of the block, a bit that says whether the page is in use; the bit of the first page
  /// is the highest bit of the first byte
  void mend_data_block(const ArrayShape& shape, std::size_t u, std::uint64_t address, View marks) {
    if (address == k_hdf5_no_address) return;
    const std::size_t head = shape.head_bytes();
    const std::size_t pages = pages_of(shape, u);
    const std::size_t elements = pages == 0 ? shape.elements_of(u) * shape.element_bytes : 0;
    std::optional<FileBytes> block = read(address, "EADB", head + elements + k_checksum_bytes);
    if (!block) return;
    const bool has_addresses = shape.element_bytes == k_address_bytes;
    const std::span<std::uint8_t> all = *block;
    mend(address, all, has_addresses ? all.subspan(head, elements) : std::span<std::uint8_t>());
    const std::size_t page = shape.page_elements * shape.element_bytes;
    for (std::size_t p = 0; p < std::min(pages, 8 * marks.size()); ++p) {
      if ((marks[p / 8] >> (7 - p % 8) & 1) == 0) continue;
      const std::uint64_t at = address + all.size() + p * (page + k_checksum_bytes);
      std::optional<FileBytes> bytes = read(at, "", page + k_checksum_bytes);
      if (bytes) mend(at, *bytes, has_addresses ? std::span(*bytes).first(page) : std::span<std::uint8_t>());
    }
  }

  std::filesystem::path file_;
  std::fstream stream_;
  std::uint64_t end_ = 0;                    // size of the file
  std::uint64_t unread_ = 0;                 // bytes that may still be read
  std::vector<Continuation> continuations_;  // blocks of the present object header that are yet to be read
  std::size_t mended_ = 0;
};

}  // namespace

std::size_t mend_torn_metadata(const std::filesystem::path& file, std::span<const std::uint64_t> headers) {
  Mender mender(file);
  for (const std::uint64_t header : headers) mender.mend_object(header);
  return mender.mended();
}

}  // namespace troupe::worldio
