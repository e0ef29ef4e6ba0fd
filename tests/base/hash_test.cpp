#include "base/hash.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <vector>

namespace troupe::hash_test {
namespace {

// XXH3's own value for the empty input and seed 0, from its specification.
TEST(Hash, IsXxh3) { EXPECT_EQ(hash_text(""), 0x2d06800538d394c2u); }

TEST(Hash, DependsOnTextAndSeed) {
  EXPECT_NE(hash_text("a"), hash_text("b"));
  EXPECT_NE(hash_text("a"), hash_text(std::string("a\0", 2)));
  const std::array<std::byte, 3> bytes = {std::byte{1}, std::byte{2}, std::byte{3}};
  EXPECT_EQ(hash_bytes(bytes), hash_bytes(bytes, 0));
  EXPECT_NE(hash_bytes(bytes, 0), hash_bytes(bytes, 1));
}

TEST(Hash, LongInputsAreTheSameEverywhere) {
  // Longer than 240 bytes XXH3 runs the loop that is vectorised differently on each processor.
  std::string text;
  for (int i = 0; i < 1000; ++i) text += static_cast<char>('a' + i % 26);
  EXPECT_EQ(hex(hash_text(text)), "e153425558d7da5d");
}

TEST(Hash, OfRowsIsTheSumOfThoseOfIdsWithTheirRows) {
  std::vector<std::byte> data(4000);
  for (std::size_t i = 0; i < data.size(); ++i) data[i] = static_cast<std::byte>(i * 37 + i / 251);
  const std::array<BodyId, 3> ids = {BodyId(7), BodyId(0), BodyId(4000000000u)};
  for (std::size_t bytes = 0; bytes < 300; ++bytes)
    for (const std::size_t stride : {bytes, bytes + 3}) {
      std::uint64_t sum = 0;
      for (std::size_t i = 0; i < ids.size(); ++i) {
        std::vector<std::byte> gathered;
        for (unsigned k = 0; k < 4; ++k) gathered.push_back(static_cast<std::byte>(ids[i].value >> (8 * k)));
        const auto row = data.begin() + static_cast<std::ptrdiff_t>(1 + i * stride);
        gathered.insert(gathered.end(), row, row + static_cast<std::ptrdiff_t>(bytes));
        sum += hash_bytes(gathered, 99);
      }
      EXPECT_EQ(hash_rows(ids, data.data() + 1, stride, bytes, 99), sum) << bytes;
    }
  EXPECT_EQ(hash_rows({}, nullptr, 8, 8, 99), 0u);
}

TEST(Hash, OfPiecesIsThatOfTheWhole) {
  std::string text;
  for (int i = 0; i < 5000; ++i) text += static_cast<char>('a' + i % 23);
  for (const std::size_t piece : {1, 7, 240, 256, 1024, 5000}) {
    HashStream stream;
    for (std::size_t at = 0; at < text.size(); at += piece)
      stream.add(std::as_bytes(std::span(text).subspan(at, std::min(piece, text.size() - at))));
    EXPECT_EQ(stream.hash(), hash_text(text)) << piece;
  }
  EXPECT_EQ(HashStream().hash(), hash_text(""));
}

TEST(Hash, HexHasSixteenLowerCaseDigits) {
  EXPECT_EQ(hex(0), "0000000000000000");
  EXPECT_EQ(hex(0x0123456789abcdef), "0123456789abcdef");
  EXPECT_EQ(hex(~0ull), "ffffffffffffffff");
}

}  // namespace
}  // namespace troupe::hash_test
