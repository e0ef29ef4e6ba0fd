#include "worldio/results/hdf5_metadata.hpp"

#include "worldio/results/descriptor.hpp"
#include "worldio/results/hdf5_superblock.hpp"
#include "worldio/results/little_endian.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace troupe::worldio {
namespace {

// The sections in the comments are those of the HDF5 File Format Specification 3.0.

using View = std::span<const std::uint8_t>;
using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t k_most_groups = 16;   // in one another
constexpr std::size_t k_most_levels = 16;   // of the index of a group
constexpr std::size_t k_leaf_entries = 8;   // of a leaf of the index: twice the number in the superblock
constexpr std::size_t k_node_entries = 32;  // of another node of the index, alike

/// Why the metadata is refused. The text continues "PATH is damaged: it ".
struct Damage {
  std::string path;
  std::string text;
};

std::uint64_t number(View bytes, std::size_t at, std::size_t size) {
  return little_endian(bytes.subspan(at, size));
}
std::uint64_t address(View bytes, std::size_t at) { return number(bytes, at, 8); }

bool has_signature(View bytes, std::string_view signature) {
  return std::ranges::equal(bytes.first(signature.size()), signature, {}, {},
                            [](char c) { return static_cast<std::uint8_t>(c); });
}

/// a * b; the largest number if the product is too large
std::uint64_t product(std::uint64_t a, std::uint64_t b) {
  constexpr std::uint64_t k_largest = std::numeric_limits<std::uint64_t>::max();
  return b != 0 && a > k_largest / b ? k_largest : a * b;
}

/// Returns the size of a value, bytes, of a datatype that Troupe writes (IV.A.2.d). `type` has the message
/// without its padding, or with it.
std::optional<std::uint64_t> value_bytes(View type) {
  constexpr std::size_t k_head = 8;
  if (type.size() < k_head) return std::nullopt;
  const std::uint64_t size = number(type, 4, 4);
  const auto continues_with = [&](std::initializer_list<std::uint8_t> properties) {
    return type.size() >= k_head + properties.size() &&
           std::ranges::equal(type.subspan(k_head, properties.size()), properties);
  };
  const std::uint64_t bits = number(type, 1, 3);
  switch (type[0]) {
    case 0x10: {  // an integer: little-endian, signed or not, of all its bits
      const bool is_known = (size == 1 || size == 4 || size == 8) && (bits == 0 || bits == 8);
      if (!is_known || !continues_with({0, 0, static_cast<std::uint8_t>(8 * size), 0})) return std::nullopt;
      return size;
    }
    case 0x11:  // IEEE 754, little-endian
      if ((size == 4 && bits == 0x1f20 && continues_with({0, 0, 32, 0, 23, 8, 0, 23, 127, 0, 0, 0})) ||
          (size == 8 && bits == 0x3f20 && continues_with({0, 0, 64, 0, 52, 11, 0, 52, 0xff, 3, 0, 0})))
        return size;
      return std::nullopt;
    case 0x13: return size > 0 && bits == 0x11 ? std::optional(size) : std::nullopt;  // UTF-8, NUL-padded
    default: return std::nullopt;
  }
}

/// Whether a datatype is that of texts of variable length, of which Hdf5Object::set_text() makes long texts.
bool is_variable_text(View type) {
  constexpr std::uint64_t k_reference_bytes = 16;
  return type.size() >= 16 && type[0] == 0x19 && (type[1] & 0xf) == 1 &&
         number(type, 4, 4) == k_reference_bytes && (type[8] == 0x13 || type[8] == 0x10) &&
         number(type, 12, 4) == 1;
}

/// Returns the number of values of a dataspace that Troupe writes (IV.A.2.b).
std::optional<std::uint64_t> values_of(View space) {
  constexpr std::size_t k_head = 8;
  constexpr std::size_t k_most_dimensions = 32;
  if (space.size() < k_head || space[0] != 1 || space[1] > k_most_dimensions || space[2] > 1)
    return std::nullopt;
  const std::size_t dimensions = space[1];
  const bool has_most = space[2] == 1;
  if (space.size() < k_head + (has_most ? 16 : 8) * dimensions) return std::nullopt;
  std::uint64_t values = 1;
  for (std::size_t d = 0; d < dimensions; ++d) {
    const std::uint64_t size = address(space, k_head + 8 * d);
    if (has_most && address(space, k_head + 8 * (dimensions + d)) != size) return std::nullopt;
    values = product(values, size);
  }
  return values;
}

class Checker {
 public:
  Checker(const std::filesystem::path& file, std::uint64_t base) : file_(file, O_RDONLY), base_(base) {
    struct stat status {};
    if (file_.get() < 0 || fstat(file_.get(), &status) != 0 ||
        static_cast<std::uint64_t>(status.st_size) < base)
      fail("/", "cannot be read");
    bytes_ = static_cast<std::uint64_t>(status.st_size) - base;
  }

  std::vector<FileBlock> check() {
    // II.A, version 0
    constexpr std::size_t k_superblock_bytes = 96;
    constexpr std::array<std::uint8_t, 16> k_after_signature{0, 0, 0, 0, 0, 8, 8, 0, 4, 0, 16, 0, 0, 0, 0, 0};
    const Bytes head = take("/", 0, k_superblock_bytes, "superblock");
    if (!has_signature(head, k_hdf5_signature) ||
        !std::ranges::equal(View(head).subspan(8, 16), k_after_signature) || address(head, 24) != base_ ||
        address(head, 32) != k_hdf5_no_address || address(head, 40) != base_ + bytes_ ||
        address(head, 48) != k_hdf5_no_address || address(head, 56) != 0)
      fail("/", "has a superblock that Troupe does not write");
    check_entry("", View(head).subspan(56), 0);
    std::vector<FileBlock> blocks;
    for (const auto& [at, block] : taken_)
      if (block.is_metadata) blocks.push_back({base_ + at, block.bytes});
    return blocks;
  }

 private:
  struct Block {
    std::uint64_t bytes;
    bool is_metadata;
  };
  /// The symbol table of a group: addresses of its index and of the heap with its names.
  using SymbolTable = std::pair<std::uint64_t, std::uint64_t>;
  /// What the header of an object says. Pointers into the headers are not kept.
  struct Header {
    std::optional<SymbolTable> table;
    std::optional<std::uint64_t> values;
    std::optional<std::uint64_t> value_bytes;
    std::optional<std::pair<std::uint64_t, std::uint64_t>> storage;  ///< address and bytes
    bool has_fill = false;
  };
  /// The index of a group, while it is checked.
  struct Index {
    Bytes names;  ///< of the heap
    std::size_t groups;
    std::array<std::uint64_t, k_most_levels> last;           ///< of each level: address of the last node
    std::array<std::uint64_t, k_most_levels> right_of_last;  ///< and what it says follows
  };

  [[noreturn]] static void fail(std::string_view path, std::string text) {
    throw Damage{path.empty() ? "/" : std::string(path), std::move(text)};
  }

  /// Marks a block as used. It must be inside the file and must not overlap another block.
  void mark(std::string_view path, std::uint64_t at, std::uint64_t bytes, bool is_metadata,
            std::string_view what) {
    if (at > bytes_ || bytes > bytes_ - at || bytes == 0)
      fail(path, fmt::format("has a {} that is not inside the file", what));
    const auto next = taken_.lower_bound(at);
    if ((next != taken_.end() && next->first < at + bytes) ||
        (next != taken_.begin() && std::prev(next)->first + std::prev(next)->second.bytes > at))
      fail(path, fmt::format("has a {} that overlaps another part of the file", what));
    taken_.emplace_hint(next, at, Block{bytes, is_metadata});
  }

  /// Marks a block of metadata and returns its bytes.
  Bytes take(std::string_view path, std::uint64_t at, std::uint64_t bytes, std::string_view what,
             std::string_view signature = {}) {
    mark(path, at, bytes, true, what);
    Bytes block(bytes);
    if (pread(file_.get(), block.data(), block.size(), static_cast<off_t>(base_ + at)) !=
        static_cast<ssize_t>(block.size()))
      fail(path, "cannot be read");
    if (!has_signature(block, signature)) fail(path, fmt::format("has a {} without its signature", what));
    return block;
  }

  /// Checks an object and what is in it. `entry` is an entry of a symbol table (III.C), whose name is checked
  /// already.
  void check_entry(const std::string& path, View entry, std::size_t groups) {
    const std::uint64_t cache = number(entry, 16, 4);
    const Header header = read_header(path, address(entry, 8));
    if (cache > 1 || (cache == 1 && header.table != SymbolTable(address(entry, 24), address(entry, 32))))
      fail(path, "has an entry in the index of its group that Troupe does not write");
    if (header.table) {
      if (header.values || header.value_bytes || header.storage || header.has_fill)
        fail(path, "is a group and a dataset");
      check_group(path, *header.table, groups);
    } else {
      check_dataset(path, header);
    }
  }

  /// IV.A.1.a, version 1
  Header read_header(const std::string& path, std::uint64_t at) {
    constexpr std::size_t k_prefix = 16;
    if (at > bytes_ || bytes_ - at < k_prefix) fail(path, "has a header that is not inside the file");
    std::array<std::uint8_t, k_prefix> prefix{};
    if (pread(file_.get(), prefix.data(), k_prefix, static_cast<off_t>(base_ + at)) != k_prefix)
      fail(path, "cannot be read");
    const std::uint64_t messages = number(prefix, 2, 2);
    if (prefix[0] != 1 || number(prefix, 4, 4) != 1) fail(path, "has a header that Troupe does not write");
    const Bytes first = take(path, at, k_prefix + number(prefix, 8, 4), "header");
    Header header;
    std::vector<SymbolTable> continuations;
    std::uint64_t count = read_messages(path, View(first).subspan(k_prefix), header, continuations);
    while (!continuations.empty()) {
      const auto [next, bytes] = continuations.back();
      continuations.pop_back();
      count += read_messages(path, take(path, next, bytes, "header"), header, continuations);
    }
    if (count != messages) fail(path, "has a header with a wrong number of messages");
    return header;
  }

  std::uint64_t read_messages(const std::string& path, View block, Header& header,
                              std::vector<SymbolTable>& continuations) {
    constexpr std::size_t k_head = 8;
    constexpr std::uint8_t k_constant = 1;
    std::uint64_t count = 0;
    for (; !block.empty(); ++count) {
      if (block.size() < k_head || number(block, 2, 2) > block.size() - k_head || block[4] > k_constant)
        fail(path, "has a header whose messages are not complete");
      const std::size_t bytes = number(block, 2, 2);
      read_message(path, number(block, 0, 2), block.subspan(k_head, bytes), header, continuations);
      block = block.subspan(k_head + bytes);
    }
    return count;
  }

  /// IV.A.2
  void read_message(const std::string& path, std::uint64_t type, View message, Header& header,
                    std::vector<SymbolTable>& continuations) {
    const auto only = [&](bool is_first, std::size_t least, std::string_view what) {
      if (!is_first) fail(path, fmt::format("has two {}s", what));
      if (message.size() < least) fail(path, fmt::format("has a {} that is not complete", what));
    };
    switch (type) {
      case 0x00: return;  // unused bytes
      case 0x01:
        only(!header.values, 0, "dataspace");
        header.values = values_of(message);
        if (!header.values) fail(path, "has a dataspace that Troupe does not write");
        return;
      case 0x03:
        only(!header.value_bytes, 0, "datatype");
        header.value_bytes = value_bytes(message);
        if (!header.value_bytes) fail(path, "has elements of a type that Troupe does not write");
        return;
      case 0x05:
        only(!header.has_fill, 8, "fill value");
        header.has_fill = true;
        if (message[0] != 2 || message[1] > 3 || message[2] > 2 || message[3] != 1 ||
            number(message, 4, 4) != 0)
          fail(path, "has a fill value that Troupe does not write");
        return;
      case 0x08:
        only(!header.storage, 18, "layout");
        if (message[0] != 3 || message[1] != 1) fail(path, "is not stored contiguously");
        header.storage = {address(message, 2), address(message, 10)};
        return;
      case 0x0c: check_attribute(path, message); return;
      case 0x10:
        only(true, 16, "continuation of its header");
        continuations.emplace_back(address(message, 0), address(message, 8));
        return;
      case 0x11:
        only(!header.table, 16, "symbol table");
        header.table = {address(message, 0), address(message, 8)};
        return;
      default:
        fail(path, fmt::format("has a message of type {} in its header, which Troupe does not write", type));
    }
  }

  /// IV.A.2.m, version 1: name, datatype and dataspace, each padded to whole words, and the value
  static void check_attribute(const std::string& path, View message) {
    constexpr std::size_t k_head = 8;
    const auto padded = [](std::uint64_t bytes) { return (bytes + 7) / 8 * 8; };
    const auto damaged = [&path] { fail(path, "has an attribute that Troupe does not write"); };
    if (message.size() < k_head || message[0] != 1) damaged();
    const std::uint64_t name = number(message, 2, 2);
    const std::uint64_t type = number(message, 4, 2);
    const std::uint64_t space = number(message, 6, 2);
    const std::uint64_t value_at = k_head + padded(name) + padded(type) + padded(space);
    if (name == 0 || value_at > message.size()) damaged();
    const View text = message.subspan(k_head, name);
    if (std::ranges::find(text, 0) != text.end() - 1) damaged();
    const View datatype = message.subspan(k_head + padded(name), type);
    const std::optional<std::uint64_t> values =
        values_of(message.subspan(k_head + padded(name) + padded(type), space));
    const std::optional<std::uint64_t> bytes =
        is_variable_text(datatype) ? std::optional<std::uint64_t>(16) : value_bytes(datatype);
    if (values != 1 || !bytes || *bytes > message.size() - value_at) damaged();
  }

  void check_dataset(const std::string& path, const Header& header) {
    if (!header.values || !header.value_bytes || !header.storage || !header.has_fill)
      fail(path, "is neither a group nor a dataset");
    const auto [at, bytes] = *header.storage;
    const std::uint64_t needed = product(*header.values, *header.value_bytes);
    if (bytes != needed)
      fail(path, fmt::format("has {} values, but the size of its storage is that of {}", *header.values,
                             bytes / *header.value_bytes));
    if (needed > 0) mark(path, at, bytes, false, "value");
    if (needed == 0 && at != k_hdf5_no_address) fail(path, "has storage, but no value");
  }

  /// III.D: the heap with the names in a group
  Bytes read_names(const std::string& path, std::uint64_t at) {
    constexpr std::uint64_t k_end = 1;  // of the list of unused blocks
    constexpr std::uint64_t k_least_unused = 16;
    const Bytes head = take(path, at, 32, "heap", "HEAP");
    const std::uint64_t bytes = address(head, 8);
    Bytes names = take(path, address(head, 24), bytes, "heap");
    std::uint64_t rest = bytes / k_least_unused;
    for (std::uint64_t unused = address(head, 16); unused != k_end; --rest) {
      if (head[4] != 0 || rest == 0 || unused > bytes || bytes - unused < k_least_unused ||
          address(names, unused + 8) < k_least_unused || address(names, unused + 8) > bytes - unused)
        fail(path, "has a heap that Troupe does not write");
      unused = address(names, unused);
    }
    return names;
  }

  /// Returns the name at an offset of the heap.
  static std::string name_at(const std::string& path, const Index& index, std::uint64_t at) {
    if (at < index.names.size()) {
      const View rest = View(index.names).subspan(at);
      if (const auto end = std::ranges::find(rest, 0); end != rest.end()) return {rest.begin(), end};
    }
    fail(path, "has the name of an object outside its heap");
  }

  void check_group(const std::string& path, const SymbolTable& table, std::size_t groups) {
    if (groups > k_most_groups) fail(path, "is nested too deep");
    Index index{read_names(path, table.second), groups, {}, {}};
    index.last.fill(k_hdf5_no_address);
    index.right_of_last.fill(k_hdf5_no_address);
    check_node(path, index, table.first, std::nullopt);
    for (const std::uint64_t right : index.right_of_last)
      if (right != k_hdf5_no_address) fail(path, "has an index whose nodes are not linked");
  }

  /// III.A.1: a node of the index of a group, and what is under it. level: of the node, if it has a parent
  void check_node(const std::string& path, Index& index, std::uint64_t at, std::optional<std::size_t> level) {
    constexpr std::size_t k_head = 24;
    constexpr std::size_t k_bytes = k_head + 8 * (2 * k_node_entries + 1);
    const Bytes node = take(path, at, k_bytes, "node of its index", "TREE");
    const std::size_t own = node[5];
    const std::size_t entries = number(node, 6, 2);
    if (node[4] != 0 || own >= k_most_levels || (level && own != *level) || entries > k_node_entries ||
        (level && entries == 0) || (own > 0 && entries == 0))
      fail(path, "has an index that Troupe does not write");
    if (address(node, 8) != index.last[own] ||
        (index.last[own] != k_hdf5_no_address && index.right_of_last[own] != at))
      fail(path, "has an index whose nodes are not linked");
    index.last[own] = at;
    index.right_of_last[own] = address(node, 16);
    if (entries > 0) name_at(path, index, address(node, k_head));
    for (std::size_t i = 0; i < entries; ++i) {
      const std::uint64_t child = address(node, k_head + 8 + 16 * i);
      name_at(path, index, address(node, k_head + 16 + 16 * i));
      if (own > 0)
        check_node(path, index, child, own - 1);
      else
        check_leaf(path, index, child);
    }
  }

  /// III.B: a leaf of the index of a group, and its objects
  void check_leaf(const std::string& path, const Index& index, std::uint64_t at) {
    constexpr std::size_t k_head = 8;
    constexpr std::size_t k_entry = 40;
    const Bytes leaf = take(path, at, k_head + k_leaf_entries * k_entry, "leaf of its index", "SNOD");
    const std::size_t entries = number(leaf, 6, 2);
    if (leaf[4] != 1 || entries == 0 || entries > k_leaf_entries)
      fail(path, "has an index that Troupe does not write");
    for (std::size_t i = 0; i < entries; ++i) {
      const View entry = View(leaf).subspan(k_head + k_entry * i, k_entry);
      check_entry(fmt::format("{}/{}", path, name_at(path, index, address(entry, 0))), entry,
                  index.groups + 1);
    }
  }

  Descriptor file_;
  std::uint64_t base_;                    // size of the user block; addresses count from its end
  std::uint64_t bytes_ = 0;               // of the file after the user block
  std::map<std::uint64_t, Block> taken_;  // the blocks that were found, by their addresses
};

}  // namespace

Result<std::vector<FileBlock>> check_metadata(const std::filesystem::path& file, std::uint64_t user_block) {
  try {
    return Checker(file, user_block).check();
  } catch (const Damage& damage) {
    return Error{
        fmt::format("{} is damaged, or Troupe did not write the file: it {}", damage.path, damage.text)};
  }
}

}  // namespace troupe::worldio
