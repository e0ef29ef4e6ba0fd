#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace troupe::worldio {

/// Whether a text looks like UTF-16, which some editors write, instead of UTF-8: it begins with a byte-order
/// mark of UTF-16, or one of its first two bytes is NUL and the other one is not.
bool is_utf16(std::string_view text);
/// The error text for a file for which is_utf16() is true.
inline constexpr const char* k_is_utf16 = "the file is encoded in UTF-16: save it in UTF-8";

/// Returns a text in UTF-8 that is given in Latin-1 (ISO 8859-1), in which each byte is a character.
std::string latin1_to_utf8(std::string_view text);
/// Returns a text in UTF-8: converts each line that is not valid UTF-8 from Latin-1, the usual encoding of
/// older files. A line ends with LF or CR.
std::string lines_in_utf8(std::string text);

/// A character that is not allowed where it stands.
struct StrayCharacter {
  std::size_t bytes = 1;  ///< length of the character in UTF-8; 1 if its bytes are not valid UTF-8
  std::string error;      ///< error text, which names the character; valid UTF-8
};

/// Describes the character that begins at text[at]. The byte text[at] must not be an ASCII character. The
/// errors for quotation marks, dashes and blanks other than those of ASCII, which word processors write, say
/// what to write instead.
///
/// text: UTF-8, or any other bytes
/// where: the places where any character is allowed, such as "strings and comments"
StrayCharacter stray_character(std::string_view text, std::size_t at, std::string_view where);

}  // namespace troupe::worldio
