#include "worldio/json/json_syntax.hpp"

#include "worldio/characters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace troupe::worldio {
namespace {

constexpr std::string_view k_space = " \t\r\n";
constexpr std::size_t k_most_quoted = 40;  // bytes of the text that a message quotes
constexpr std::size_t k_escape = 6;        // bytes of the longest escape sequence, such as \u00e4

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '$'; }
bool is_hexadecimal(char c) { return is_digit(c) || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F'); }
bool is_ascii(char c) { return static_cast<unsigned char>(c) < 128; }
bool ends_line(char c) { return c == '\n' || c == '\r'; }
bool is_control(char c) { return static_cast<unsigned char>(c) < 32; }
/// Whether a byte continues a character in UTF-8.
bool continues(char c) { return (static_cast<unsigned char>(c) & 0xc0) == 0x80; }

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

/// Whether a word is a number, true, false or null, as JSON writes them.
bool is_scalar(std::string_view word) {
  if (word == "true" || word == "false" || word == "null") return true;
  const auto skip_digits = [&word] {
    const std::size_t digits = std::min(word.find_first_not_of("0123456789"), word.size());
    word.remove_prefix(digits);
    return digits > 0;
  };
  if (word.starts_with('-')) word.remove_prefix(1);
  if (word.size() > 1 && word[0] == '0' && is_digit(word[1])) return false;
  if (!skip_digits()) return false;
  if (word.starts_with('.')) {
    word.remove_prefix(1);
    if (!skip_digits()) return false;
  }
  if (word.starts_with('e') || word.starts_with('E')) {
    word.remove_prefix(1);
    if (word.starts_with('+') || word.starts_with('-')) word.remove_prefix(1);
    if (!skip_digits()) return false;
  }
  return word.empty();
}

/// What may come next in a JSON text.
enum class Expected : std::uint8_t { value, value_or_end, key, key_or_end, colon, comma, nothing };

/// Reads the tokens of a JSON text up to the one that is wrong. A token is a string, a mark such as `{`, or a
/// word: the letters, digits and other characters of a number or a name.
class Scanner {
 public:
  Scanner(std::string_view text, std::size_t last) : text_(text), last_(last) {
    if (text_.starts_with("\xef\xbb\xbf")) end_ = 3;  // byte-order mark
    do next();
    while (end_ <= last_ && begin_ < text_.size() && accept());
  }

  JsonSyntaxError error() const {
    if (begin_ >= text_.size()) return at_end();
    const char first = text_[begin_];
    if (last_ < text_.size() && !is_ascii(text_[last_]) && (first != '"' || last_ == begin_ || last_ >= end_))
      return {last_, stray_character(text_, last_, "strings").error};
    const std::string_view rest = text_.substr(begin_);
    if (first == '#' || rest.starts_with("//") || rest.starts_with("/*"))
      return {begin_, "JSON has no comments: remove this comment"};
    // A string is wrong if the parser has not read it to its end, and wherever a string is allowed.
    if (first == '"' &&
        (last_ + 1 < end_ || !is_closed_ || cuts_character() || is_key_next() || is_value_next()))
      return in_string();
    if (first == '\'') return single_quotes();
    if (expected_ == Expected::colon)
      return {begin_, fmt::format("expected a colon after the key {}, found {}", quoted(before_), found())};
    if (expected_ == Expected::nothing)
      return {begin_, fmt::format("found {} after the end of the JSON value: remove it, or remove a closing "
                                  "bracket before it",
                                  found())};
    if (expected_ == Expected::comma) return instead_of_comma();
    if (first == ',' || first == '}' || first == ']') return too_early();
    if (is_key_next()) return instead_of_key();
    return wrong_value();
  }

 private:
  /// The token [begin_, end_) becomes the next one.
  void next() {
    before_ = token();
    before_begin_ = begin_;
    begin_ = std::min(text_.find_first_not_of(k_space, end_), text_.size());
    end_ = begin_ + 1;
    if (begin_ == text_.size()) return;
    if (text_[begin_] == '"')
      end_ = end_of_string();
    else if (is_word(text_[begin_]))
      while (end_ < text_.size() && is_word(text_[end_])) ++end_;
  }

  static bool is_word(char c) { return is_letter(c) || is_digit(c) || c == '.' || c == '+' || c == '-'; }

  std::size_t end_of_string() {
    is_closed_ = false;
    std::size_t at = begin_ + 1;
    for (; at < text_.size() && !ends_line(text_[at]); ++at) {
      if (text_[at] == '\\' && at + 1 < text_.size() && !ends_line(text_[at + 1])) {
        ++at;
      } else if (text_[at] == '"') {
        is_closed_ = true;
        return at + 1;
      }
    }
    return std::min(at, text_.size());
  }

  std::string_view token() const { return text_.substr(begin_, end_ - begin_); }

  /// Updates `expected_` after a valid token. Returns false if the token is not valid here.
  bool accept() {
    const char first = text_[begin_];
    const bool is_end = first == '}' || first == ']';
    if (is_end || first == '{' || first == '[' || first == ',' || first == ':') return accept_mark(first);
    const bool is_string = first == '"' && is_closed_;
    if (is_key_next() && is_string) {
      expected_ = Expected::colon;
      return true;
    }
    if (!is_value_next() || !(is_string || is_scalar(token()))) return false;
    after_value();
    return true;
  }

  bool accept_mark(char mark) {
    if (mark == ':') {
      if (expected_ != Expected::colon) return false;
      expected_ = Expected::value;
      return true;
    }
    if (mark == ',') {
      if (expected_ != Expected::comma) return false;
      expected_ = text_[open_.back()] == '{' ? Expected::key : Expected::value;
      return true;
    }
    if (mark == '{' || mark == '[') {
      if (!is_value_next()) return false;
      open_.push_back(begin_);
      expected_ = mark == '{' ? Expected::key_or_end : Expected::value_or_end;
      return true;
    }
    const bool may_end = expected_ == Expected::comma || expected_ == Expected::key_or_end ||
                         expected_ == Expected::value_or_end;
    if (!may_end || open_.empty() || mark != closing()) return false;
    open_.pop_back();
    after_value();
    return true;
  }

  bool is_key_next() const { return expected_ == Expected::key || expected_ == Expected::key_or_end; }
  bool is_value_next() const { return expected_ == Expected::value || expected_ == Expected::value_or_end; }
  void after_value() { expected_ = open_.empty() ? Expected::nothing : Expected::comma; }

  /// The bracket that closes the innermost object or list.
  char closing() const { return text_[open_.back()] == '{' ? '}' : ']'; }
  /// The innermost object or list that is not closed, as in `the { of line 2`.
  std::string opening() const {
    return fmt::format("the {} of line {}", text_[open_.back()], line_at(text_, open_.back()));
  }

  /// Returns a part of the text for a message. Long parts are cut, and control characters are blanks.
  static std::string quoted(std::string_view part) {
    std::size_t size = std::min(part.size(), k_most_quoted);
    while (size > 0 && size < part.size() && continues(part[size])) --size;
    std::string shown(part.substr(0, size));
    std::ranges::replace_if(shown, is_control, ' ');
    return shown + (size < part.size() ? "..." : "");
  }
  std::string found() const { return quoted(token()); }

  JsonSyntaxError at_end() const {
    if (open_.empty() && expected_ == Expected::value)
      return {text_.size(), "the text is empty: expected a JSON value, such as an object in braces {}"};
    if (open_.empty()) return {text_.size(), "the text ends too early"};
    return {text_.size(), fmt::format("the text ends too early: {} has no closing {}", opening(), closing())};
  }

  JsonSyntaxError in_string() const {
    JsonSyntaxError wrong_bytes{last_,
                                "a string contains bytes that are not valid UTF-8: save the file in UTF-8"};
    const char c = last_ < text_.size() ? text_[last_] : '\n';
    if (cuts_character()) return wrong_bytes;
    if (!is_closed_ && ends_line(c))
      return {begin_,
              "this string has no closing quotation mark on its line; a line break in a string is written as "
              "\\n"};
    if (is_control(c))
      return {last_,
              fmt::format("a string contains {}: write it as {}", c == '\t' ? "a tab" : "a control character",
                          c == '\t' ? "\\t" : fmt::format("\\u{:04x}", static_cast<unsigned>(c)))};
    const std::size_t backslash = text_.rfind('\\', last_ - 1);
    if (backslash == text_.npos || backslash <= begin_ || last_ - backslash > k_escape) return wrong_bytes;
    const std::string_view escape = text_.substr(backslash, last_ - backslash);
    if (backslash + 1 == last_)
      return {backslash, fmt::format("a backslash in a string must begin an escape sequence{}: write a "
                                     "backslash as \\\\",
                                     is_ascii(c) ? fmt::format(", and JSON has no \\{}", c) : "")};
    const bool has_digits =
        escape.size() >= k_escape - 1 && std::ranges::all_of(text_.substr(backslash + 2, 4), is_hexadecimal);
    if (escape[1] == 'u' && !has_digits)
      return {backslash,
              "four hexadecimal digits must follow \\u in a string; a backslash is written as \\\\"};
    const auto begins_half = [this](std::size_t at) {
      return text_.substr(at).starts_with("\\ud") || text_.substr(at).starts_with("\\uD");
    };
    if (!begins_half(backslash) && !begins_half(backslash - std::min(backslash, k_escape)))
      return wrong_bytes;
    return {backslash, "\\ud800 to \\udfff must come in pairs, which stand for one character"};
  }
  /// Whether the last byte that the parser has read is in the place of a byte that continues a character.
  bool cuts_character() const {
    std::size_t first = std::min(last_, text_.size());
    while (first > begin_ && continues(text_[first - 1])) --first;
    if (first == begin_) return false;
    const auto lead = static_cast<unsigned char>(text_[first - 1]);
    const std::size_t bytes = lead < 0xc0 ? 1 : lead < 0xe0 ? 2 : lead < 0xf0 ? 3 : 4;
    return first - 1 + bytes > last_;
  }

  JsonSyntaxError single_quotes() const {
    const std::size_t end = text_.find_first_of("'\r\n", begin_ + 1);
    const bool is_whole = end != text_.npos && text_[end] == '\'' && end - begin_ <= k_most_quoted;
    return {begin_, fmt::format("JSON has no single quotes: write {}",
                                is_whole ? fmt::format("\"{}\"", text_.substr(begin_ + 1, end - begin_ - 1))
                                         : "strings in double quotes, \"")};
  }

  /// A closing bracket or a comma where a key or a value must come.
  JsonSyntaxError too_early() const {
    const char mark = text_[begin_];
    if (before_ == "," && mark != ',' && !open_.empty() && mark == closing())
      return {before_begin_,
              fmt::format("JSON has no trailing commas: remove this comma before the {}", mark)};
    if (before_ == ",") return {begin_, fmt::format("found {} after a comma: remove one of the two", mark)};
    if (before_ == ":") return {begin_, fmt::format("expected a value after the colon, found {}", mark)};
    return {begin_,
            fmt::format("expected a {}, found {}", is_key_next() ? "key in double quotes" : "value", mark)};
  }

  JsonSyntaxError instead_of_comma() const {
    const char first = text_[begin_];
    if (first == '}' || first == ']')
      return {begin_,
              fmt::format("expected a comma or {}, which closes {}, found {}", closing(), opening(), first)};
    if (first == '"' || first == '{' || first == '[' || is_scalar(token()))
      return {begin_, fmt::format("a comma is missing before {}", found())};
    if (before_.starts_with('"') && is_letter(first))
      return {begin_,
              fmt::format("expected a comma or {}, found {}; a quotation mark in a string is written as "
                          "\\\"",
                          closing(), found())};
    return {begin_, fmt::format("expected a comma or {}, found {}", closing(), found())};
  }

  JsonSyntaxError instead_of_key() const {
    if (is_letter(text_[begin_]))
      return {begin_, fmt::format("a key must be in double quotes: write \"{}\"", found())};
    return {begin_, fmt::format("expected a key in double quotes, found {}", found())};
  }

  JsonSyntaxError wrong_value() const {
    const std::string_view word = token();
    const std::string lower = lower_case(word);
    for (const std::string_view name : {"nan", "inf", "infinity"})
      if (lower == name || lower == fmt::format("-{}", name) || lower == fmt::format("+{}", name))
        return {begin_, fmt::format("JSON has no {}: write a finite number", found())};
    for (const std::string_view name : {"true", "false", "null"})
      if (lower == name) return {begin_, fmt::format("expected a value, found {}: write {}", found(), name)};
    if (lower == "none") return {begin_, fmt::format("expected a value, found {}: write null", found())};
    if (is_letter(word.front()))
      return {begin_, fmt::format("expected a value, found {}: a text must be in double quotes", found())};
    if (is_word(word.front())) return wrong_number(word);
    return {begin_, fmt::format("expected a value, found {}", found())};
  }

  JsonSyntaxError wrong_number(std::string_view word) const {
    const auto refuse = [&](std::string_view remedy) {
      return JsonSyntaxError{begin_, fmt::format("{} is not a number of JSON: {}", found(), remedy)};
    };
    const std::string_view digits = word.substr(word.find_first_not_of("+-") == 1 ? 1 : 0);
    if (word.front() == '+') return refuse("write it without +");
    if (digits.front() == '.') return refuse("write a digit before the point, as in 0.5");
    if (digits.starts_with("0x") || digits.starts_with("0X")) return refuse("write it in decimal digits");
    if (digits.size() > 1 && digits[0] == '0' && is_digit(digits[1]))
      return refuse("write it without the leading 0");
    const std::size_t point = digits.find('.');
    if (point != digits.npos && (point + 1 == digits.size() || !is_digit(digits[point + 1])))
      return refuse("write a digit after the point, as in 1.0");
    return refuse("numbers are written as in 12, -0.5 or 2e-3");
  }

  std::string_view text_;
  std::size_t last_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::string_view before_;  // the token before this one
  std::size_t before_begin_ = 0;
  bool is_closed_ = true;          // whether the last string has a closing quotation mark
  std::vector<std::size_t> open_;  // offsets of the brackets that are not closed
  Expected expected_ = Expected::value;
};

}  // namespace

std::uint32_t line_at(std::string_view text, std::size_t position) {
  std::uint32_t line = 1;
  for (std::size_t i = 0; i < std::min(position, text.size()); ++i)
    line += text[i] == '\n' || (text[i] == '\r' && !text.substr(i + 1).starts_with('\n'));
  return line;
}

JsonSyntaxError json_syntax_error(std::string_view text, std::size_t last) {
  return Scanner(text, last).error();
}

}  // namespace troupe::worldio
