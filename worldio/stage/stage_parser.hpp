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
  std::string_view text;  ///< into a source of the document; a string's without its quotes

  Where where() const { return {file, line}; }
};

/// `key value` or `key [value ...]`.
struct StageProperty {
  std::uint32_t key = 0;    ///< position in StageDocument::tokens
  std::uint32_t count = 0;  ///< of the values
  bool tuple = false;

  std::uint32_t first() const { return key + (tuple ? 2 : 1); }  ///< of the values; position as of the key
};

/// `word ( properties and entities )`.
struct StageEntity {
  struct Run {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };
  std::uint32_t word = 0;  ///< the type or the macro's name; position in StageDocument::tokens
  Run properties;          ///< of StageDocument::all_properties
  Run children;            ///< of StageDocument::all_children
};

/// One thing at the top level of a file: `define word base body`, or the entity itself.
struct StageItem {
  bool is_define = false;
  std::uint32_t base = 0;  ///< of a define; position in StageDocument::tokens
  StageEntity entity;
};

/// A file has a dozen tokens a robot, so they are kept small, and what belongs to entities lies in runs of
/// common lists.
struct StageDocument {
  struct Source {
    std::string text;
    std::uint32_t file;
  };
  struct PackedToken {
    std::uint16_t source;
    StageToken::Kind kind;
    std::uint32_t line;
    std::uint32_t begin;  // in the source's text
    std::uint32_t length;
  };

  std::deque<Source> sources;  ///< every file, each time it is read
  std::vector<PackedToken> tokens;
  std::vector<StageProperty> all_properties;
  std::vector<StageEntity> all_children;
  std::vector<StageProperty> world;  ///< properties at top level, in order
  std::vector<StageItem> items;      ///< defines and entities, in order
  /// What relative paths are relative to: the world file's folder, or that of the last file found through the
  /// search path.
  std::filesystem::path base_directory;
  /// False when parentheses do not match, so that nothing can be said about what belongs to what.
  bool well_nested = true;

  StageToken token(std::uint32_t position) const {
    const PackedToken& t = tokens[position];
    if (t.kind == StageToken::Kind::end) return {};
    const Source& source = sources[t.source];
    return {t.kind, source.file, t.line, std::string_view(source.text).substr(t.begin, t.length)};
  }
  std::string_view word(const StageEntity& entity) const { return token(entity.word).text; }
  std::string_view key(const StageProperty& property) const { return token(property.key).text; }
  StageToken value(const StageProperty& property, std::uint32_t i) const {
    return token(property.first() + i);
  }
  /// The last property of this name at the top level; null when there is none.
  const StageProperty* world_property(std::string_view name) const {
    for (auto property = world.rbegin(); property != world.rend(); ++property)
      if (key(*property) == name) return &*property;
    return nullptr;
  }
  std::span<const StageProperty> properties(const StageEntity& entity) const {
    return std::span(all_properties).subspan(entity.properties.first, entity.properties.count);
  }
  std::span<const StageEntity> children(const StageEntity& entity) const {
    return std::span(all_children).subspan(entity.children.first, entity.children.count);
  }
};

/// Reads the text of the world `file`, and the files it includes.
/// errors  every violation of the grammar at its own file and line, with what would be right; reading goes on
///         behind each, up to a limit. Nesting deeper than 200 and inclusion more than 1,000 times are
///         errors.
StageDocument parse_stage(const std::filesystem::path& file, std::string text,
                          std::span<const std::filesystem::path> search_path, Diagnostics& diagnostics);

}  // namespace troupe::worldio
