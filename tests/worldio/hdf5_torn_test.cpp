// Files whose writer was killed while the operating system copied a block of metadata: see hdf5_torn.hpp.

#include "worldio/results/hdf5_torn.hpp"
#include "base/sanitizers.hpp"
#include "tests/support/scratch.hpp"
#include "worldio/results/hdf5_checksum.hpp"
#include "worldio/results/hdf5_file.hpp"
#include "worldio/results/hdf5_superblock.hpp"
#include "worldio/results/little_endian.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#ifdef TROUPE_ADDRESS_SANITIZER
#include <sanitizer/lsan_interface.h>
#endif

namespace troupe::worldio::hdf5_torn_test {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t k_arrays = 40;
constexpr std::size_t k_page = 4096;

using View = std::span<const std::uint8_t>;

View bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// A block of metadata in a file.
struct Block {
  std::string signature;
  std::size_t begin = 0;
  std::size_t end = 0;
};

/// Returns the blocks that a writer overwrites. A block ends where the checksum is that of the bytes before.
std::vector<Block> blocks_of(std::string_view file) {
  constexpr std::size_t k_most = 1200;
  std::vector<Block> blocks;
  for (const std::string_view signature : {"OHDR", "EAHD", "EAIB", "EASB", "EADB"})
    for (std::size_t at = file.find(signature); at != file.npos; at = file.find(signature, at + 1))
      for (std::size_t size = 16; size < std::min(k_most, file.size() - at); ++size)
        if (little_endian(bytes_of(file.substr(at + size - 4, 4))) ==
            metadata_checksum(bytes_of(file.substr(at, size - 4)))) {
          blocks.push_back({std::string(signature), at, at + size});
          break;
        }
  return blocks;
}

void put(std::string& file, std::size_t at, std::string_view text) { file.replace(at, text.size(), text); }

void put_number(std::string& file, std::size_t at, std::uint64_t value, std::size_t bytes) {
  for (std::size_t i = 0; i < bytes; ++i) file[at + i] = static_cast<char>(value >> (8 * i));
}

/// Puts an object header, whose only message is a layout, at the start of a file. The layout refers to the
/// header of an extensible array, which follows.
/// numbers  element size, bits of an index, elements in the index block, least elements of a data block,
///          least addresses of a super block, bits of the number of elements of a page
void put_array(std::string& file, const std::array<std::uint8_t, 6>& numbers, std::uint64_t index_block) {
  constexpr std::size_t k_array = 64;
  put(file, 0, std::string_view("OHDR\x02\x00\x17", 7));          // the messages have 23 bytes
  put(file, 7, std::string_view("\x08\x13\x00\x00\x04\x02", 6));  // layout of 19 bytes, version 4, chunked
  put_number(file, 16, 4, 1);                                     // its index is an extensible array
  put_number(file, 22, k_array, 8);
  put(file, k_array, "EAHD");
  for (std::size_t i = 0; i < numbers.size(); ++i) put_number(file, k_array + 6 + i, numbers[i], 1);
  put_number(file, k_array + 60, index_block, 8);
}

class Hdf5Torn : public test::ScratchTest {
 protected:
  void SetUp() override {
    if (!has_hdf5()) GTEST_SKIP() << "built without HDF5";
  }

  static std::string name_of(std::size_t array) { return fmt::format("x{}", array); }

  /// Writes a file with arrays of `batches` rows in SWMR mode. Returns the file before and after the last
  /// batch was flushed, as a killed writer would leave it.
  std::array<std::string, 2> last_batch(std::size_t batches) {
    const fs::path file = folder_ / "written.h5";
    std::array<std::string, 2> files;
    Hdf5File hdf5 = Hdf5File::create(file);
    std::vector<Hdf5Dataset> arrays;
    for (std::size_t a = 0; a < k_arrays; ++a)
      arrays.push_back(hdf5.create_extendible(name_of(a), engine::Element::u32, {3}, {.extent = {1, 3}}));
    hdf5.start_swmr();
    for (std::size_t b = 0; b < batches; ++b) {
      if (b + 1 == batches) files[0] = content(file);
      for (std::size_t a = 0; a < k_arrays; ++a) {
        const auto value = static_cast<std::uint32_t>(1000 * b + a);
        arrays[a].append(std::span<const std::uint32_t>(std::array{value, value, value}));
        arrays[a].flush();
      }
      hdf5.flush();
    }
    files[1] = content(file);
    return files;
  }

  /// Mends a torn file, and expects all rows of all batches but the last in it, to which rows can be added.
  void expect_mended(const std::string& bytes, std::size_t batches, const std::string& what) {
    const fs::path file = write("torn.h5", bytes);
    close_superblock(file);
    EXPECT_EQ(mend_torn_metadata(file, Hdf5File::open(file).header_addresses()), 1u) << what;
    EXPECT_EQ(mend_torn_metadata(file, Hdf5File::open(file).header_addresses()), 0u) << what;
    Hdf5File hdf5 = Hdf5File::open_to_write(file);
    for (std::size_t a = 0; a < k_arrays; ++a) {
      Hdf5Dataset array = hdf5.dataset(name_of(a));
      ASSERT_THAT(array.rows(), ::testing::AnyOf(batches - 1, batches)) << what;
      array.resize(batches - 1);
      array.append(std::span<const std::uint32_t>(std::array<std::uint32_t, 3>{7, 7, 7}));
    }
    hdf5.close();
    const Hdf5File mended = Hdf5File::open(file);
    for (std::size_t a = 0; a < k_arrays; ++a) {
      const std::vector<std::uint32_t> rows = mended.dataset(name_of(a)).read<std::uint32_t>();
      for (std::size_t b = 0; b + 1 < batches; ++b) ASSERT_EQ(rows[3 * b], 1000 * b + a) << what;
      ASSERT_EQ(rows.back(), 7u) << what;
    }
  }
};

TEST_F(Hdf5Torn, EveryBlockThatIsTornAtTheBorderOfTwoPagesIsMended) {
#ifdef TROUPE_ADDRESS_SANITIZER
  const __lsan::ScopedDisabler ignored;  // HDF5 1.10 leaks memory when it cannot read a damaged block
#endif
  std::map<std::string, int> torn;
  // The last batch is the first chunk of an index block, of the first data block, of a larger data block, and
  // of a data block of a super block.
  for (const std::size_t batches : {2, 6, 22, 60, 125}) {
    const std::array<std::string, 2> batch = last_batch(batches);
    const auto& before = batch[0];  // clang 14 captures no structured bindings
    const auto& after = batch[1];
    for (const auto& [signature, begin, end] : blocks_of(after)) {
      const std::size_t border = (begin / k_page + 1) * k_page;
      if (border >= end || end > before.size()) continue;
      const auto differs = [&](std::size_t from, std::size_t to) {
        return std::string_view(before).substr(from, to - from) !=
               std::string_view(after).substr(from, to - from);
      };
      if (!differs(begin, border) || !differs(border, end)) continue;
      // Blocks that other blocks point to are written first. An object header is therefore torn when all
      // other blocks are new already, and any other block when the object headers are still old.
      std::string bytes = after;
      if (signature == "OHDR") {
        bytes.replace(border, end - border, before, border, end - border);
      } else {
        bytes.replace(0, before.size(), before);
        bytes.replace(begin, border - begin, after, begin, border - begin);
      }
      expect_mended(bytes, batches, fmt::format("{} at {}, {} batches", signature, begin, batches));
      ++torn[signature];
    }
  }
  for (const char* signature : {"OHDR", "EAIB", "EADB"}) EXPECT_GT(torn[signature], 0) << signature;
}

TEST_F(Hdf5Torn, OtherDamageStays) {
  auto [before, after] = last_batch(22);
  const std::vector<Block> blocks = blocks_of(after);
  const auto inside = std::ranges::find_if(blocks, [](const Block& block) {
    return block.signature == "OHDR" && block.begin > 200 && block.begin / k_page == block.end / k_page;
  });
  ASSERT_NE(inside, blocks.end());
  after[inside->begin + 20] ^= 1;
  const fs::path file = write("damaged.h5", after);
  close_superblock(file);
  EXPECT_EQ(mend_torn_metadata(file, Hdf5File::open(file).header_addresses()), 0u);
}

TEST_F(Hdf5Torn, AddressesThatLeadNowhereAreIgnored) {
  const auto [before, after] = last_batch(2);
  const fs::path file = write("whole.h5", after);
  close_superblock(file);
  const std::string closed = content(file);
  const std::array<std::uint64_t, 4> nowhere{0, 100, closed.size() - 3, ~std::uint64_t{0}};
  EXPECT_EQ(mend_torn_metadata(file, nowhere), 0u);
  EXPECT_EQ(content(file), closed);
  EXPECT_THROW(mend_torn_metadata(folder_ / "none.h5", nowhere), std::runtime_error);
}

TEST_F(Hdf5Torn, AnArrayWithFewerElementsThanADataBlockIsIgnored) {
  std::string file(80'000, '\0');
  put_array(file, {255, 0, 255, 128, 2, 13}, k_page);  // the number of super blocks would be below 0
  put(file, k_page, "EAIB");
  EXPECT_EQ(mend_torn_metadata(write("hostile.h5", file), std::array<std::uint64_t, 1>{0}), 0u);
}

TEST_F(Hdf5Torn, AnObjectHeaderMayContinueInManyBlocksAndInACircle) {
  constexpr std::size_t k_blocks = 60'000;
  constexpr std::size_t k_distance = 32;  // no block crosses a border of pages
  std::string file(k_blocks * k_distance, '\0');
  for (std::size_t b = 0; b < k_blocks; ++b) {
    const std::size_t at = b * k_distance;
    put(file, at, b == 0 ? std::string_view("OHDR\x02\x00\x14", 7) : std::string_view("OCHK"));
    const std::size_t message = at + (b == 0 ? 7 : 4);
    put(file, message, std::string_view("\x10\x10\x00", 3));  // continuation of 16 bytes
    put_number(file, message + 4, b + 1 < k_blocks ? at + k_distance : k_distance, 8);
    put_number(file, message + 12, 28, 8);
  }
  EXPECT_EQ(mend_torn_metadata(write("hostile.h5", file), std::array<std::uint64_t, 1>{0}), 0u);
}

// Reading the pages of all 65,536 data blocks would take minutes.
TEST_F(Hdf5Torn, ASuperBlockThatRefersToOneDataBlockManyTimesIsNotReadInFull) {
  constexpr std::size_t k_blocks = 65'536;
  constexpr std::size_t k_pages = 8;
  constexpr std::size_t k_page_elements = std::size_t{1} << 13;
  constexpr std::size_t k_element_bytes = 127;
  constexpr std::size_t k_super_block = 2 * k_page;
  constexpr std::size_t k_data_block = 200 * k_page;
  constexpr std::size_t k_head = 18;
  std::string file(k_data_block + k_head + 4 + k_pages * (k_page_elements * k_element_bytes + 4), '\0');
  put_array(file, {k_element_bytes, 32, 0, 1, 2, 13}, k_page);
  put(file, k_page, "EAIB");
  for (std::size_t i = 0; i < 33; ++i)  // addresses of 2 data blocks and 31 super blocks
    put_number(file, k_page + 14 + 8 * i, i == 32 ? k_super_block : ~std::uint64_t{0}, 8);
  put(file, k_super_block, "EASB");
  for (std::size_t b = 0; b < k_blocks; ++b) {
    put_number(file, k_super_block + k_head + b, 0xff, 1);  // all pages are in use
    put_number(file, k_super_block + k_head + k_blocks + 8 * b, k_data_block, 8);
  }
  put(file, k_data_block, "EADB");
  EXPECT_EQ(mend_torn_metadata(write("hostile.h5", file), std::array<std::uint64_t, 1>{0}), 1 + k_pages)
      << "the super block and the pages have no checksum";
}

}  // namespace
}  // namespace troupe::worldio::hdf5_torn_test
