#pragma once

#include "engine/fields/description.hpp"
#include "worldio/json/document_table.hpp"
#include "worldio/json/json_reader.hpp"
#include "worldio/json/world_document.hpp"

#include <cstddef>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace troupe::worldio {

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

/// Converts to any type except Eigen's vectors. engine::detail::member_count() initialises every member of a
/// struct with such an object. If it converted to Eigen's vectors, the constructors of std::optional would
/// try to make such a vector from it, which does not compile.
struct AnyMember {
  template <class T>
  requires(!requires { T::RowsAtCompileTime; }) operator T() const;
};

/// Identifies a struct of a WorldDocument.
struct StructMembers {
  std::string_view name;  ///< the compiler's text for a function of the struct: contains its name
  std::size_t count = 0;  ///< number of members of the struct, without those of its base
};
template <class C>
constexpr std::string_view text_with_name() {
  return __PRETTY_FUNCTION__;
}
// A struct that is derived from Placed, or from another document, has this base as its first initialiser.
template <class C>
inline constexpr StructMembers k_members_of{
    text_with_name<C>(),
    engine::detail::member_count<C, AnyMember>() - (std::is_base_of_v<Placed, C> ? 1 : 0)};

/// DocumentKey::make and DocumentKey::find of a key.
struct MemberAccess {
  bool is_optional = false;
  void* (*make)(void* object) = nullptr;
  const void* (*find)(const void* object) = nullptr;
};

/// The functions of DocumentKey that access the entries of a list or a map.
struct EntryAccess {
  std::size_t (*size)(const void* list);
  void* (*append)(void* list, std::string_view name);
  const void* (*item)(const void* list, std::size_t index);
  const std::string* (*item_name)(const void* list, std::size_t index);
};
template <class List>
inline constexpr EntryAccess k_list_access{
    [](const void* list) { return static_cast<const List*>(list)->size(); },
    [](void* list, std::string_view) -> void* { return &static_cast<List*>(list)->emplace_back(); },
    [](const void* list, std::size_t i) -> const void* { return &(*static_cast<const List*>(list))[i]; },
    nullptr};
template <class Map>
inline constexpr EntryAccess k_map_access{
    [](const void* map) { return static_cast<const Map*>(map)->size(); },
    [](void* map, std::string_view its_name) -> void* {
      auto& entry = static_cast<Map*>(map)->emplace_back();
      entry.first = its_name;
      return &entry.second;
    },
    [](const void* map, std::size_t i) -> const void* { return &(*static_cast<const Map*>(map))[i].second; },
    [](const void* map, std::size_t i) { return &(*static_cast<const Map*>(map))[i].first; }};

/// The part of DocumentKeys that is the same for all structs.
class KeyList {
 public:
  /// Returns DocumentTable::incomplete. Call this function after all keys are added.
  std::vector<std::string> incomplete() const;

  /// Adds a rule to DocumentTable::rules.
  void rule(DocumentRule rule) { table_.rules.push_back(std::move(rule)); }
  /// The table that this object fills. It gives access to the members that no function above sets.
  DocumentTable& table() { return table_; }

 protected:
  KeyList(DocumentTable& table, const StructMembers& of) : table_(table) { noted(of); }

  DocumentKey& add(Form form, std::string_view name, std::string_view text, std::string_view expects,
                   const MemberAccess& access);
  /// member: address of the member in DocumentTable::usual
  DocumentKey& add_value(std::string_view name, const engine::MemberType& type, const void* member,
                         bool is_float, std::initializer_list<engine::Fact> facts);
  /// table: the table of the entries
  DocumentKey& add_entries(Form form, std::string_view name, std::string_view text,
                           const MemberAccess& access, const DocumentTable& (*entry_table)(),
                           const EntryAccess& entries);
  /// Notes that a member of the struct `of` has a key, or needs none. member: its engine::detail::tag()
  void note(const StructMembers& of, std::string_view member);

 private:
  /// The members of one struct that were passed to note().
  struct Noted {
    StructMembers of;
    std::vector<std::string_view> members;
  };
  Noted& noted(const StructMembers& of);

  DocumentTable& table_;
  std::vector<Noted> noted_;
};

}  // namespace detail

/// Fills the DocumentTable of T, a struct of a WorldDocument. T::describe() calls one function of this class
/// per key, in the order in which the writer writes the keys.
template <class T>
class DocumentKeys : public detail::KeyList {
 public:
  /// DocumentTable::usual must be set.
  explicit DocumentKeys(DocumentTable& table) : KeyList(table, detail::k_members_of<T>) {}

  /// Adds a key of Form::value, for a member of a type that engine::Description accepts: a number, a bool, an
  /// enum, a pose, ... `Path` is the pointer to the member, as in value<&PlaceDocument::pitch>("pitch", ...).
  /// For a member of a member, `Path` is the pointer to the outer member, then the pointer to the inner one.
  /// `facts` are the unit, the limits and the meaning of the key (engine::facts). This function and the
  /// functions below that add a key return the new key. The reference is valid until another key is added.
  template <auto... Path, class... Facts>
  DocumentKey& value(std::string_view name, Facts... facts) {
    no_key<Path...>();
    return add_value(name, engine::detail::TypeOf<MemberAt<Path...>>::value, &at<Path...>(table().usual),
                     std::is_same_v<InnerAt<Path...>, float>, {engine::Fact(facts)...});
  }

  /// Adds a key of Form::choice, for a member that is an enum of one byte with the values 0, 1, 2, ...
  /// `names` are the texts for these values, in the order of the values. `text` is the meaning of the key.
  /// `Path` is as in value().
  template <auto... Path>
  DocumentKey& choice(std::string_view name, std::span<const std::string_view> names,
                      std::string_view text = {}) {
    static_assert(sizeof(InnerAt<Path...>) == 1 && std::is_enum_v<InnerAt<Path...>>);
    DocumentKey& key = other<Path...>(Form::choice, name, text);
    key.field.choices.assign(names.begin(), names.end());
    return key;
  }

  /// Adds a key of any other form. `Path` is as in value(); an empty Path adds a key without a member. `text`
  /// is the meaning of the key. `expects` becomes DocumentKey::expects.
  template <auto... Path>
  DocumentKey& other(Form form, std::string_view name, std::string_view text = {},
                     std::string_view expects = {}) {
    no_key<Path...>();
    return add(form, name, text, expects, access<Path...>());
  }

  /// Adds a key of Form::object. The member is a struct with a DocumentTable, or a std::optional of such a
  /// struct. `text` is the meaning of the key, here and in list() and map().
  template <auto Member>
  DocumentKey& object(std::string_view name, std::string_view text = {}) {
    DocumentKey& key = other<Member>(Form::object, name, text);
    key.table = &document_table<InnerAt<Member>>;
    return key;
  }

  /// Adds a key of Form::list. The member is a vector of structs, or a std::optional of such a vector. A
  /// DocumentTable describes the struct.
  template <auto... Path>
  DocumentKey& list(std::string_view name, std::string_view text = {}) {
    using List = InnerAt<Path...>;
    no_key<Path...>();
    return add_entries(Form::list, name, text, access<Path...>(), &document_table<typename List::value_type>,
                       detail::k_list_access<List>);
  }

  /// Adds a key of Form::map. The member is a vector of pairs (name, struct); the struct has a DocumentTable.
  template <auto Member>
  DocumentKey& map(std::string_view name, std::string_view text = {}) {
    using Map = InnerAt<Member>;
    no_key<Member>();
    return add_entries(Form::map, name, text, access<Member>(),
                       &document_table<typename Map::value_type::second_type>, detail::k_map_access<Map>);
  }

  /// Marks members of T that need no key, so that incomplete() does not report them as forgotten.
  template <auto... Members>
  void no_key() {
    (note(detail::k_members_of<typename engine::detail::Pointed<decltype(Members)>::Class>,
          engine::detail::tag<Members>()),
     ...);
  }

  /// Sets DocumentTable::check.
  template <void (*Check)(const T& object, const JsonCursor& at)>
  void check() {
    table().check = [](const void* object, const JsonCursor& at) {
      Check(*static_cast<const T*>(object), at);
    };
  }

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
  /// The type of the member of a path.
  template <auto... Path>
  using MemberAt = std::remove_cvref_t<decltype(below<Path...>(std::declval<T&>()))>;
  /// The same, or the type of the value if the member is a std::optional.
  template <auto... Path>
  using InnerAt = detail::Inner<MemberAt<Path...>>;

  template <auto... Path>
  static constexpr detail::MemberAccess access() {
    if constexpr (sizeof...(Path) == 0)
      return {};
    else if constexpr (detail::IsOptional<MemberAt<Path...>>::value)
      return {.is_optional = true,
              .make = [](void* object) -> void* {
                auto& x = at<Path...>(object);
                return x ? &*x : &x.emplace();
              },
              .find = [](const void* object) -> const void* {
                const auto& x = at<Path...>(object);
                return x ? &*x : nullptr;
              }};
    else
      return {.make = [](void* object) -> void* { return &at<Path...>(object); },
              .find = [](const void* object) -> const void* { return &at<Path...>(object); }};
  }
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
    made.incomplete = keys.incomplete();
    return made;
  }();
  return table;
}

}  // namespace troupe::worldio
