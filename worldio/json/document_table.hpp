#pragma once

#include "base/color.hpp"
#include "base/geometry.hpp"
#include "base/result.hpp"
#include "engine/description.hpp"
#include "engine/kinds.hpp"
#include "worldio/json/json_reader.hpp"
#include "worldio/json/world_document.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

/// How the structs of a WorldDocument are described: each once, by a function that fills a table of its keys.
/// The reader (read_document.cpp), the writer (write_document.cpp) and the schema (world_schema.cpp) are
/// ordinary code over these tables.
namespace troupe::worldio {

struct DocumentTable;

/// How the value of a key stands in a file, and what it is in C++.
enum class Form : std::uint8_t {
  value,            ///< as DocumentKey::field says
  choice,           ///< an enum of one byte: one of the field's choices, in their order
  block,            ///< engine::Record by DocumentKey::block
  version,          ///< of the format, k_format_version; kept nowhere
  seed,             ///< std::uint64_t
  name,             ///< std::string: a text that is not empty
  names,            ///< std::vector<std::string>: a list of such texts
  model_kind,       ///< std::string: a name of Registry::models
  color,            ///< Color
  color_or_random,  ///< ColorDocument
  heading,          ///< HeadingDocument
  points,           ///< std::vector<Vec2>
  box,              ///< Box
  contours,         ///< std::vector<Ring>
  joint,            ///< JointName: a text or null
  comparison,       ///< ComparisonDocument: `>= 0.9`
  kept,             ///< JsonNode: as it is, of what is described elsewhere
  kind,             ///< std::string: a name of DocumentTable::kinds
  parameters,       ///< engine::Record: keys of the kind's own beside the others
  faults,           ///< std::vector<FaultDocument::Impairment>: a key for each of Registry::faults
  object,           ///< a described struct
  list,             ///< std::vector of one
  map,              ///< std::vector of pairs of a name and one: an object by names
};

/// One key of a described struct.
struct DocumentKey {
  engine::Field field;            ///< its name and text; of values also unit, limits and choices
  Form form = Form::value;        ///< how its value stands in a file
  bool required = false;          ///< an object without it is an error
  std::string_view hint = {};     ///< behind `missing "key": `; empty: the field's text
  std::string_view expects = {};  ///< of texts: behind `expected `
  std::size_t least = 0;          ///< entries of a list
  std::size_t most = std::numeric_limits<std::size_t>::max();  ///< as `least`
  bool always = false;         ///< is written even where it is as by default; of a pose x, y and heading
  bool counts_bodies = false;  ///< its limit is LoadOptions::most_bodies
  std::optional<engine::Field>
      other;  ///< of a value: its field where the object's kind has a parameter of its name
  std::uint32_t variants = ~0u;  ///< for which values of DocumentTable::variant it is there, a bit each
  const DocumentTable& (*table)() = nullptr;  ///< of object, list and map
  const engine::FieldTable* block = nullptr;  ///< of block
  /// Whether it is there beside the other keys of this object. Null: yes.
  bool (*is_there)(const JsonNode& object) = nullptr;
  /// Whether objects of this kind (a const engine::DeviceKind*) have it. Null: all.
  bool (*is_of)(const void* kind) = nullptr;

  bool is_optional = false;  ///< the member is a std::optional
  bool is_float = false;     ///< a value that is a float: written with as few digits as that needs

  // Access to members of other forms than `value`, by the address of the struct.
  void* (*make)(void* object) = nullptr;                           ///< the member, made where it is missing
  const void* (*find)(const void* object) = nullptr;               ///< the member; null where it is missing
  std::size_t (*size)(const void* object) = nullptr;               ///< of list and map
  void* (*append)(void* object, std::string_view name) = nullptr;  ///< as size; name: of map
  const void* (*item)(const void* object, std::size_t index) = nullptr;        ///< as size
  const std::string* (*item_name)(const void* object, std::size_t) = nullptr;  ///< of map

  std::string_view missing_hint() const {
    return !hint.empty() ? hint : !field.text.empty() ? field.text : expects;
  }
  DocumentKey& require(std::string_view what = {}) {
    required = true;
    hint = what;
    return *this;
  }
  DocumentKey& when(bool (*holds)(const JsonNode& object)) {
    is_there = holds;
    return *this;
  }
  DocumentKey& of_kind(bool (*holds)(const void* kind)) {
    is_of = holds;
    return *this;
  }
  DocumentKey& of_variants(std::uint32_t bits) {
    variants = bits;
    return *this;
  }
  DocumentKey& entries(std::size_t at_least, std::size_t at_most = std::numeric_limits<std::size_t>::max()) {
    least = at_least;
    most = at_most;
    return *this;
  }
  /// Another name, where the object's kind has a parameter of this one.
  DocumentKey& or_named(std::string_view name) {
    other = field;
    other->name = name;
    return *this;
  }
  DocumentKey& write_always() {
    always = true;
    return *this;
  }
};

/// Which keys go together: for the reader and the schema.
struct DocumentRule {
  /// How many of the keys an object has.
  enum class How : std::uint8_t { one_of, any_of, not_both };
  How how = How::one_of;
  std::vector<std::string_view> keys = {};  ///< names of fields
  std::string none = {};                    ///< the error where there is none of them; empty: no error
  std::string several = {};                 ///< the error where there are more than one; empty: as `none`
  bool at_key = false;  ///< `several` is reported at each key too many, else at the object
  bool in_schema = true;
};

/// The kind of an object that has one.
struct DocumentKind {
  std::string_view name;
  std::string_view text;
  const engine::FieldTable* params = nullptr;
  /// Other defaults; the name is that of a preset then, and objects are of the kind `preset_of`.
  std::span<const std::pair<std::string_view, engine::Value>> presets = {};
  std::string_view preset_of = {};
  const void* kind = nullptr;  ///< for DocumentKey::is_of
};

/// The kinds that objects of one struct may be of.
struct DocumentKinds {
  std::string_view what;  ///< "drive"
  std::string_view page;  ///< of the documentation of plug-ins with such kinds; empty: there are none
  std::vector<DocumentKind> (*all)(const engine::Registry& registry);
  std::vector<std::string_view> (*known)(const engine::Registry& registry);  ///< for messages, sorted
  std::vector<std::string_view> (*named)(const engine::Registry& registry);  ///< those that plug-ins' are not
  /// Of this name, also of a plug-in, which is then loaded.
  Result<DocumentKind> (*find)(const engine::Registry& registry, const std::string& name);
  /// What an object around it says of the kind. Null: nothing.
  std::optional<DocumentKind> (*implied)(const engine::Registry& registry, const JsonNode& around) = nullptr;
  std::string_view expects = {};  ///< of the key `kind`; empty: "the name of a" what
  std::string_view hint = {};     ///< of the key `kind`; empty: "one of" all known
};

/// A text in place of an object.
struct DocumentShorthand {
  std::string_view expects;
  /// Fills the object, or reports what is wrong.
  void (*read)(const JsonCursor& at, const std::string& text, const engine::Registry& registry, void* object);
  /// The text; empty where there is none for this object.
  std::optional<std::string> (*write)(const void* object, const engine::Registry& registry);
  std::vector<JsonNode> (*schemas)(const engine::Registry& registry);
  bool before_object = false;  ///< in the schema
};

/// A described struct.
struct DocumentTable {
  std::string_view definition;  ///< of the schema; empty: it stands where it is needed
  std::vector<DocumentKey> keys;
  std::vector<DocumentRule> rules;
  const DocumentKinds* kinds = nullptr;
  const DocumentShorthand* shorthand = nullptr;
  std::string_view variant;  ///< the key whose choices tell variants apart; empty: there are none
  /// What else is to hold, where all keys were read. Null: nothing.
  void (*check)(const void* object, const JsonCursor& at) = nullptr;
  Placed& (*placed)(void* object) = nullptr;
  const void* usual = nullptr;  ///< a struct with its defaults
  /// Whether `kind` needs not be said. Null: it must be.
  bool (*is_kind_implied)(const void* object) = nullptr;

  const DocumentKey* find(std::string_view name) const;
};

/// `>= 0.9`. Empty, and reported, where the text is something else.
std::optional<ComparisonDocument> read_comparison(const JsonCursor& at, std::string_view text);
/// What the schema says of such texts.
std::string comparison_pattern();

/// The table of a described struct; made when it is first asked for.
template <class T>
const DocumentTable& document_table();

/// Of HeadingDocument, in radians or degrees: that of poses.
const engine::Field& heading_field();
/// The field of a key, for objects of a kind with these parameters (null: of no kind).
const engine::Field& field_of(const DocumentKey& key, const engine::FieldTable* params);

namespace detail {

template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};
template <class T>
struct InnerOf {
  using Type = T;
};
template <class T>
struct InnerOf<std::optional<T>> {
  using Type = T;
};
template <class T>
using Inner = typename InnerOf<T>::Type;

}  // namespace detail

/// Fills the table of T: a call for each key, in the order in which they are written.
template <class T>
class DocumentKeys {
 public:
  explicit DocumentKeys(DocumentTable& table) : table_(table) {}

  /// What engine::Description takes as a member: a number, a truth, an enum, a pose, ...; Path: the member,
  /// or a member of a member.
  template <auto... Path, class... Facts>
  DocumentKey& value(std::string_view name, Facts... facts) {
    static const T example{};
    const auto& member = at<Path...>(static_cast<const void*>(&example));
    using Member = std::remove_cvref_t<decltype(member)>;
    engine::FieldTable fields;
    engine::detail::add_field(fields, name, engine::detail::TypeOf<Member>::value, &example, &member,
                              {engine::Fact(facts)...});
    DocumentKey& key = table_.keys.emplace_back();
    key.field = std::move(fields.fields.front());
    key.field.fallback = {};  // a key that is not there leaves the member as it is
    key.is_float = std::is_same_v<detail::Inner<Member>, float>;
    return key;
  }

  /// An enum of one byte, by its names in the order of its values.
  template <auto... Path>
  DocumentKey& choice(std::string_view name, std::span<const std::string_view> names,
                      std::string_view text = {}) {
    using Member = std::remove_cvref_t<decltype(at<Path...>(std::declval<const void*>()))>;
    static_assert(sizeof(detail::Inner<Member>) == 1 && std::is_enum_v<detail::Inner<Member>>);
    DocumentKey& key = other<Path...>(Form::choice, name, text);
    key.field.choices.assign(names.begin(), names.end());
    return key;
  }

  /// A value of another form. expects: of texts
  template <auto... Path>
  DocumentKey& other(Form form, std::string_view name, std::string_view text = {},
                     std::string_view expects = {}) {
    DocumentKey& key = table_.keys.emplace_back();
    key.field = {.name = name, .type = engine::FieldType::text, .text = text};
    key.form = form;
    key.expects = expects;
    if constexpr (sizeof...(Path) > 0) {
      key.is_optional =
          detail::IsOptional<std::remove_cvref_t<decltype(at<Path...>(std::declval<const void*>()))>>::value;
      key.make = [](void* object) -> void* {
        auto& x = at<Path...>(object);
        if constexpr (detail::IsOptional<std::remove_cvref_t<decltype(x)>>::value)
          return x ? &*x : &x.emplace();
        else
          return &x;
      };
      key.find = [](const void* object) -> const void* {
        const auto& x = at<Path...>(object);
        if constexpr (detail::IsOptional<std::remove_cvref_t<decltype(x)>>::value)
          return x ? &*x : nullptr;
        else
          return &x;
      };
    }
    return key;
  }

  /// A described struct, which may be optional.
  template <auto Member>
  DocumentKey& object(std::string_view name, std::string_view text = {}) {
    DocumentKey& key = other<Member>(Form::object, name, text);
    using M = std::remove_cvref_t<decltype(std::declval<T&>().*Member)>;
    key.table = &document_table<detail::Inner<M>>;
    return key;
  }

  /// A vector of described structs, which may be optional.
  template <auto... Path>
  DocumentKey& list(std::string_view name, std::string_view text = {}) {
    DocumentKey& key = other<Path...>(Form::list, name, text);
    using M = std::remove_cvref_t<decltype(at<Path...>(std::declval<const void*>()))>;
    using List = detail::Inner<M>;
    key.table = &document_table<typename List::value_type>;
    key.size = [](const void* list) { return static_cast<const List*>(list)->size(); };
    key.append = [](void* list, std::string_view) -> void* {
      return &static_cast<List*>(list)->emplace_back();
    };
    key.item = [](const void* list, std::size_t i) -> const void* {
      return &(*static_cast<const List*>(list))[i];
    };
    return key;
  }

  /// A vector of pairs of a name and a described struct.
  template <auto Member>
  DocumentKey& map(std::string_view name, std::string_view text = {}) {
    DocumentKey& key = other<Member>(Form::map, name, text);
    using Map = std::remove_cvref_t<decltype(std::declval<T&>().*Member)>;
    key.table = &document_table<typename Map::value_type::second_type>;
    key.size = [](const void* map) { return static_cast<const Map*>(map)->size(); };
    key.append = [](void* map, std::string_view its_name) -> void* {
      auto& entry = static_cast<Map*>(map)->emplace_back();
      entry.first = its_name;
      return &entry.second;
    };
    key.item = [](const void* map, std::size_t i) -> const void* {
      return &(*static_cast<const Map*>(map))[i].second;
    };
    key.item_name = [](const void* map, std::size_t i) { return &(*static_cast<const Map*>(map))[i].first; };
    return key;
  }

  void rule(DocumentRule rule) { table_.rules.push_back(std::move(rule)); }
  template <void (*Check)(const T& object, const JsonCursor& at)>
  void check() {
    table_.check = [](const void* object, const JsonCursor& at) {
      Check(*static_cast<const T*>(object), at);
    };
  }
  /// The rest of what a table has.
  DocumentTable& table() { return table_; }

 private:
  template <auto First, auto... Rest, class Object>
  static auto& below(Object& object) {
    if constexpr (sizeof...(Rest) == 0)
      return object.*First;
    else
      return below<Rest...>(object.*First);
  }
  template <auto... Path>
  static auto& at(const void* object) {
    return below<Path...>(*static_cast<const T*>(object));
  }
  template <auto... Path>
  static auto& at(void* object) {
    return below<Path...>(*static_cast<T*>(object));
  }

  DocumentTable& table_;
};

template <class T>
const DocumentTable& document_table() {
  static const DocumentTable table = [] {
    static const T usual{};
    DocumentTable made;
    made.usual = &usual;
    made.placed = [](void* object) -> Placed& { return *static_cast<T*>(object); };
    DocumentKeys<T> keys(made);
    T::describe(keys);
    return made;
  }();
  return table;
}

}  // namespace troupe::worldio
