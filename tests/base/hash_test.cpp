#include "base/hash.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <span>
#include <string>

namespace troupe {
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
}  // namespace troupe
