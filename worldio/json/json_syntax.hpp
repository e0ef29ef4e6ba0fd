#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace troupe::worldio {

/// Returns the line, from 1, of the character at this position of a text. A line ends with LF, CR LF or CR.
std::uint32_t line_at(std::string_view text, std::size_t position);

struct JsonSyntaxError {
  std::size_t at = 0;  ///< offset of the character to which the error refers, bytes; at most the text's size
  std::string what;    ///< what is wrong and what to write instead; valid UTF-8
};

/// Describes a syntax error for people who write JSON by hand. The mistakes that are most frequent, such as
/// comments, trailing commas and single quotes, have error texts of their own.
///
/// text: a text that is not JSON
/// last: offset of the last byte that the parser has read when it found the error; the size of the text if
///       the parser has reached the end of the text
JsonSyntaxError json_syntax_error(std::string_view text, std::size_t last);

}  // namespace troupe::worldio
