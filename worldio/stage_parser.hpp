#pragma once

#include "base/diagnostics.hpp"

#include <cstdint>
#include <deque>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::worldio {

/// The syntax of Stage's world files: what stands where, before any of it has a meaning. Includes are spliced
/// in while the text is cut into tokens, so that a token alone knows its file and line.

struct StageToken {
  enum class Kind : std::uint8_t { word, number, string, open, close, tuple_open, tuple_close, end };
  Kind kind = Kind::end;
  std::uint32_t file = Where::k_no_file;
  std::uint32_t line = 0;
  std::string_view text;  ///< into the document's sources; a string's without its quotes

  Where where() const { return {file, line}; }
};

/// `key value` or `key [value ...]`; positions in StageDocument::tokens.
struct StageProperty {
  std::uint32_t key = 0;
  std::uint32_t first = 0;  ///< of the values
  std::uint32_t count = 0;
  bool tuple = false;
};

/// `word ( properties and entities )`.
struct StageEntity {
  std::uint32_t word = 0;  ///< the type or the macro's name; position in StageDocument::tokens
  std::vector<StageProperty> properties;
  std::vector<StageEntity> children;
};

/// One thing at the top level of a file: `define word base body`, or the entity itself.
struct StageItem {
  bool is_define = false;
  std::uint32_t base = 0;  ///< of a define; position in StageDocument::tokens
  StageEntity entity;
};

struct StageDocument {
  std::deque<std::string> sources;  ///< the text of every file, where the tokens point into
  std::vector<StageToken> tokens;
  std::vector<StageProperty> world;  ///< properties at top level, in order
  std::vector<StageItem> items;      ///< defines and entities, in order
  /// What relative paths are relative to: the world file's folder, or that of the last file found through the
  /// search path.
  std::filesystem::path base_directory;
  /// False when parentheses do not match, so that nothing can be said about what belongs to what.
  bool well_nested = true;

  const StageToken& token(std::uint32_t position) const { return tokens[position]; }
  std::string_view word(const StageEntity& entity) const { return tokens[entity.word].text; }
  std::string_view key(const StageProperty& property) const { return tokens[property.key].text; }
  std::span<const StageToken> values(const StageProperty& property) const {
    return std::span(tokens).subspan(property.first, property.count);
  }
};

/// Reads the text of the world `file`, and the files it includes.
/// errors  every violation of the grammar at its own file and line, with what would be right; reading goes on
///         behind each, up to a limit. Nesting deeper than 200 and inclusion more than 1,000 times are
///         errors.
StageDocument parse_stage(const std::filesystem::path& file, std::string text,
                          std::span<const std::filesystem::path> search_path, Diagnostics& diagnostics);

}  // namespace troupe::worldio
