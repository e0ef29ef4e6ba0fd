#include "worldio/characters.hpp"

#include <gtest/gtest.h>

#include <string>
#include <string_view>

namespace troupe::worldio::characters_test {
namespace {

using namespace std::string_view_literals;

TEST(Characters, Utf16IsRecognised) {
  EXPECT_TRUE(is_utf16("\xff\xfe{\0"sv));
  EXPECT_TRUE(is_utf16("\xfe\xff\0{"sv));
  EXPECT_TRUE(is_utf16("{\0\"\0"sv));
  EXPECT_TRUE(is_utf16("\0{"sv));
  EXPECT_FALSE(is_utf16("{}"));
  EXPECT_FALSE(is_utf16("\0\0"sv));
  EXPECT_FALSE(is_utf16("{"));
  EXPECT_FALSE(is_utf16(""));
}

TEST(Characters, ErrorsSayWhatToWriteInstead) {
  const auto stray = [](std::string_view text) { return stray_character(text, 0, "strings").error; };
  EXPECT_EQ(stray("\u201cred\u201d"), "unexpected quotation mark \u201c: write the straight one, \"");
  EXPECT_EQ(stray("\u2019"), "unexpected quotation mark \u2019: write the straight one, \"");
  EXPECT_EQ(stray("\u22121"), "unexpected dash \u2212: write the minus sign of ASCII, -");
  EXPECT_EQ(stray("\u00a0"), "unexpected blank U+00A0: write an ordinary blank");
  EXPECT_EQ(stray("\u00fc"), "unexpected character U+00FC (\u00fc): it may be only in strings");
  EXPECT_EQ(stray("\U0001f916"), "unexpected character U+1F916 (\U0001f916): it may be only in strings");
  EXPECT_EQ(stray_character("a\u201c", 1, "").bytes, 3u);
  EXPECT_EQ(stray_character("\U0001f916", 0, "").bytes, 4u);
}

TEST(Characters, BytesThatAreNotUtf8AreNamedByNumber) {
  for (const std::string text :
       {"\xff", "\x80", "\xe2\x80", "\xe2\x80x", "\xc3(", "\xc0\x80", "\xed\xa0\x80"}) {
    const StrayCharacter stray = stray_character(text, 0, "strings");
    EXPECT_EQ(stray.bytes, 1u);
    EXPECT_TRUE(stray.error.starts_with("unexpected byte 0x") &&
                stray.error.ends_with(": this byte may be only in strings"))
        << stray.error;
  }
}

TEST(Characters, LinesThatAreNotUtf8AreReadAsLatin1) {
  EXPECT_EQ(lines_in_utf8(""), "");
  EXPECT_EQ(lines_in_utf8("caf\xc3\xa9\r\n"), "caf\xc3\xa9\r\n");
  EXPECT_EQ(lines_in_utf8("caf\xe9\r\ncaf\xc3\xa9\n\xff"), "caf\xc3\xa9\r\ncaf\xc3\xa9\n\xc3\xbf");
}

}  // namespace
}  // namespace troupe::worldio::characters_test
