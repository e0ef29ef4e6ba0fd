#pragma once

#include "base/diagnostics.hpp"

#include <cstdint>
#include <deque>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::worldio {

// The syntax of the `.world` files of Stage, an older robot simulator: tokens, properties, entities and
// macros. Their meaning is not checked here.

/// A token of a world file. The tokens of an included file are inserted in place of its `include "FILE"`.
/// Each token has the file and the line in which it was written.
struct StageToken {
  enum class Kind : std::uint8_t { word, number, string, open, close, tuple_open, tuple_close, end };
  Kind kind = Kind::end;                  ///< `end`: the end of the document
  std::uint32_t file = Where::k_no_file;  ///< index of the file in SourceFiles
  std::uint32_t line = 0;                 ///< line in the file, from 1
  std::string_view text;  ///< points into a source of the document; strings without their quotes

  Where where() const { return {file, line}; }
};

/// A property: `key value` or, with a tuple, `key [value ...]`.
struct StageProperty {
  std::uint32_t key = 0;    ///< index of the key in StageDocument::tokens
  std::uint32_t count = 0;  ///< number of values; 1 unless `tuple` is true
  bool tuple = false;       ///< whether the values are written as a tuple, in [ ]

  /// Returns the index of the first value in StageDocument::tokens.
  std::uint32_t first() const { return key + (tuple ? 2 : 1); }
};

/// An entity: `word ( properties and entities )`. Models, blocks, sensors and windows are entities.
struct StageEntity {
  /// Consecutive entries of a list: first, ..., first + count - 1.
  struct Run {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };
  std::uint32_t word = 0;  ///< the type or the macro's name; index into StageDocument::tokens
  Run properties;          ///< entries of StageDocument::all_properties
  Run children;            ///< entries of StageDocument::all_children
};

/// A macro or an entity at the top level of a file. A macro is written `define word base body`. An entity is
/// written `word body`. The body is the part in parentheses.
struct StageItem {
  bool is_define = false;  ///< true: a macro; false: an entity
  /// The type or macro from which a macro inherits; index into StageDocument::tokens.
  std::uint32_t base = 0;
  StageEntity entity;  ///< the entity; for a macro, `word` and `body` of the `define`
};

/// A parsed world file, together with the files that it includes. To save memory (a world has about a dozen
/// tokens per robot), tokens are packed, and an entity refers to ranges of shared lists instead of owning
/// lists.
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

  std::deque<Source> sources;  ///< the text of every file, once for each inclusion
  std::vector<PackedToken> tokens;
  std::vector<StageProperty> all_properties;
  std::vector<StageEntity> all_children;
  std::vector<StageProperty> world;  ///< properties at the top level, in order
  std::vector<StageItem> items;      ///< defines and entities, in order
  /// The folder that relative paths in the document start from. It is the folder of the world file until an
  /// included file is found in a folder of the search path (see parse_stage()). From then on, it is this
  /// folder of the search path.
  std::filesystem::path base_directory;
  /// False if parentheses do not match, or if parsing stopped early. The entity to which a property belongs
  /// is then not known for certain.
  bool well_nested = true;
  /// The names of the included files that could not be read, each once.
  std::vector<std::string> missing_includes;

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
  /// Returns the last property of this name at the top level; null if there is none.
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

/// Returns the number in a key such as "point[12]", here 12; `stem` is "point". Empty for any other key.
std::optional<std::int64_t> index_in(std::string_view key, std::string_view stem);

/// Parses the text of a world file and of the files that it includes.
/// file         path of the world file, for messages and for relative paths
/// text         the text of the world file
/// search_path  folders in which an included file is searched for, by the last component of its path, if
///              there is no file at its path
/// The path of an included file is relative to StageDocument::base_directory, even if the `include` is in
/// another included file. A line that is not UTF-8 is read as Latin-1, so all texts of the document are
/// UTF-8.
///
/// Reports an error for every violation of the grammar, with the correct form, and for every included file
/// that cannot be read. Parsing continues after an error, but stops at the 50th. Parsing also stops with an
/// error at nesting deeper than 200 levels, at more than 1,000 inclusions, at more than 256 MiB of included
/// text, and at a world file of 4 GiB or more.
StageDocument parse_stage(const std::filesystem::path& file, std::string text,
                          std::span<const std::filesystem::path> search_path, Diagnostics& diagnostics);

}  // namespace troupe::worldio
