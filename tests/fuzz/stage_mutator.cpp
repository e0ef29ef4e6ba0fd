#include "tests/fuzz/stage_mutator.hpp"

#include "tests/fuzz/draws.hpp"
#include "troupe/registry.hpp"
#include "worldio/stage/stage_properties.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

namespace troupe::fuzz {
namespace {

using Tokens = std::vector<std::string>;

bool is_word(const std::string& token) { return std::isalpha(static_cast<unsigned char>(token[0])) != 0; }
bool is_number(const std::string& token) {
  return std::isdigit(static_cast<unsigned char>(token[0])) != 0 || token[0] == '-' || token[0] == '.';
}

/// Splits a text into words, numbers, texts with their quotes, and single punctuation characters, without
/// comments.
Tokens tokens_of(std::string_view text) {
  Tokens tokens;
  const auto is_part = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.' || c == '-' || c == '+';
  };
  // `point[3]` is one word.
  const auto is_index = [](std::string_view in, std::size_t at) {
    const std::size_t end = in.find_first_not_of("0123456789-", at + 1);
    return (in[at] == '[' && end != in.npos && end > at + 1 && in[end] == ']') ||
           (in[at] == ']' && in.find_last_not_of("0123456789-", at - 1) != in.npos &&
            in[in.find_last_not_of("0123456789-", at - 1)] == '[');
  };
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    std::size_t end = i + 1;
    if (c == '#') {
      i = std::min(text.find('\n', i), text.size());
      continue;
    }
    if (c == '"')
      end = std::min(text.find('"', i + 1), text.size() - 1) + 1;
    else if (is_part(c))
      while (end < text.size() && (is_part(text[end]) || is_index(text, end))) ++end;
    if (std::isspace(static_cast<unsigned char>(c)) == 0) tokens.emplace_back(text.substr(i, end - i));
    i = end;
  }
  return tokens;
}

std::string text_of(const Tokens& tokens) {
  std::string text;
  for (const std::string& token : tokens) {
    text += token;
    text += token == "(" || token == ")" || token == "]" ? '\n' : ' ';
  }
  return text;
}

struct Span {
  std::size_t begin = 0;
  std::size_t end = 0;  ///< index after the last token
};

/// The blocks of a text between the brackets `open` and `close`: `word ( ... )` and
/// `define word word ( ... )`, each with the words in front of the bracket, or `[ ... ]`.
std::vector<Span> blocks_of(const Tokens& tokens, const char* open, const char* close) {
  std::vector<Span> blocks;
  std::vector<std::size_t> begun;
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    if (tokens[i] == open) {
      std::size_t begin = i;
      while (begin > 0 && i - begin < 3 && is_word(tokens[begin - 1])) --begin;
      if (i - begin == 3 && tokens[begin] != "define") begin = i - 1;
      if (i - begin == 2) begin = i - 1;
      begun.push_back(begin);
    } else if (tokens[i] == close && !begun.empty()) {
      blocks.push_back({begun.back(), i + 1});
      begun.pop_back();
    }
  }
  return blocks;
}

std::string made_number(Random& random) {
  constexpr std::array k_numbers{"0",        "1",    "-1",         "2",
                                 "0.5",      "3",    "10",         "100",
                                 "360",      "-0",   "0.02",       "1000",
                                 "0.001",    "1e9",  "100000",     "999999999999",
                                 "0.000001", "-180", "2147483648", "9007199254740993",
                                 "1e300",    "0.1",  "7"};
  if (chance(random, 30)) return any_of(k_numbers, random);
  return fmt::format("{:.3g}", (static_cast<double>(random() % 20001) - 10000) / 1000);
}

std::string quoted(const std::string& text) { return '"' + text + '"'; }

Tokens made_values(Random& random) {
  if (chance(random, 45)) return {made_number(random)};
  if (chance(random, 40)) return {quoted(any_of(stage_words().texts, random))};
  Tokens tuple{"["};
  constexpr std::array<std::size_t, 7> k_lengths{1, 2, 2, 3, 3, 4, 6};
  for (std::size_t i = any_of(k_lengths, random); i > 0; --i) tuple.push_back(made_number(random));
  tuple.emplace_back("]");
  return tuple;
}

void insert(Tokens& tokens, std::size_t at, const Tokens& what) {
  tokens.insert(tokens.begin() + static_cast<std::ptrdiff_t>(at), what.begin(), what.end());
}

Tokens copy_of(const Tokens& tokens, Span span) {
  return {tokens.begin() + static_cast<std::ptrdiff_t>(span.begin),
          tokens.begin() + static_cast<std::ptrdiff_t>(span.end)};
}

void erase(Tokens& tokens, Span span) {
  tokens.erase(tokens.begin() + static_cast<std::ptrdiff_t>(span.begin),
               tokens.begin() + static_cast<std::ptrdiff_t>(span.end));
}

/// Inserts a property, or a block with up to three properties, into a random block or at the top level.
void insert_known(Tokens& tokens, Random& random) {
  Tokens what;
  const auto add_property = [&] {
    what.push_back(any_of(stage_words().properties, random));
    for (std::string& value : made_values(random)) what.push_back(std::move(value));
  };
  if (chance(random, 30)) {
    what = {any_of(stage_words().types, random), "("};
    for (std::size_t i = below(random, 4); i > 0; --i) add_property();
    what.emplace_back(")");
  } else {
    add_property();
  }
  const std::vector<Span> blocks = blocks_of(tokens, "(", ")");
  if (blocks.empty() || chance(random, 10))
    return insert(tokens, chance(random, 50) ? 0 : tokens.size(), what);
  insert(tokens, any_of(blocks, random).end - 1, what);
}

void change_blocks(Tokens& tokens, Random& random) {
  const std::vector<Span> blocks = blocks_of(tokens, "(", ")");
  if (blocks.empty()) return;
  const Span one = any_of(blocks, random);
  const Span other = any_of(blocks, random);
  const Tokens copy = copy_of(tokens, one);
  switch (below(random, 5)) {
    case 0:
      for (std::size_t i = 1 + below(random, chance(random, 10) ? 10 : 2); i > 0; --i)
        insert(tokens, one.end, copy);
      break;
    case 1: insert(tokens, other.end - 1, copy); break;  // nested
    case 2: erase(tokens, one); break;
    case 3:
      erase(tokens, other);
      insert(tokens, other.begin, copy);
      break;
    default: insert(tokens, tokens.size(), copy); break;
  }
}

void change_token(Tokens& tokens, Random& random) {
  const StageWords& words = stage_words();
  const std::size_t at = below(random, tokens.size());
  std::string& token = tokens[at];
  if (is_number(token)) {
    token = made_number(random);
  } else if (token.starts_with('"')) {
    token = quoted(any_of(words.texts, random));
  } else if (is_word(token)) {
    const bool opens = at + 1 < tokens.size() && tokens[at + 1] == "(";
    token = any_of(opens ? words.types : words.properties, random);
  } else if (chance(random, 30)) {
    tokens.erase(tokens.begin() + static_cast<std::ptrdiff_t>(at));
  }
}

void change_numbers(Tokens& tokens, Random& random) {
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < tokens.size(); ++i)
    if (is_number(tokens[i])) numbers.push_back(i);
  if (numbers.empty()) return;
  tokens[any_of(numbers, random)] = made_number(random);
}

}  // namespace

std::string mutate_stage(std::string_view text, std::uint32_t seed) {
  Tokens tokens = tokens_of(text);
  Random random(seed);
  random.discard(3);  // with nearly equal seeds, the first numbers are nearly equal
  for (std::size_t times = 1 + below(random, 3); times > 0 && !tokens.empty(); --times)
    switch (below(random, 6)) {
      case 0:
      case 1: insert_known(tokens, random); break;
      case 2: change_blocks(tokens, random); break;
      case 3: change_numbers(tokens, random); break;
      case 4: change_token(tokens, random); break;
      default:
        if (const std::vector<Span> tuples = blocks_of(tokens, "[", "]"); !tuples.empty()) {
          const Span tuple = any_of(tuples, random);
          erase(tokens, tuple);
          insert(tokens, tuple.begin, made_values(random));
        }
    }
  return text_of(tokens);
}

const StageWords& stage_words() {
  static const StageWords words = [] {
    StageWords all;
    for (const worldio::StageRow& row : worldio::stage_rows()) {
      std::string name(row.name);
      for (std::size_t k = 0; (k = name.find("[k]", k)) != name.npos;) name.replace(k, 3, "[0]");
      all.properties.push_back(std::move(name));
    }
    const engine::Registry registry = make_registry();
    for (const engine::ModelKind& kind : registry.models) all.types.emplace_back(kind.name);
    for (const char* type : {"sensor", "block", "window"}) all.types.emplace_back(type);
    for (const engine::DriveKind& kind : registry.drives) all.texts.emplace_back(kind.name);
    for (const std::string_view name : registry.controller_names()) all.texts.emplace_back(name);
    for (const char* text :
         {"red", "random", "cave.png", "gate.pgm", "parts.inc", "linear", "revolute", "vertical", "gps",
          "odom", "closed", "open", "up", "down", "mm", "radians", "degrees", "/a", ""})
      all.texts.emplace_back(text);
    return all;
  }();
  return words;
}

}  // namespace troupe::fuzz
