#include "worldio/json/find_keys.hpp"

#include "base/split.hpp"
#include "worldio/json/document_table.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/json/world_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

namespace troupe::worldio {
namespace {

using engine::Field;
using engine::FieldTable;
using engine::FieldType;

/// Objects of one sort: those of a struct of the document, or those that a table of fields describes. Exactly
/// one of `table` and `fields` is set.
struct Objects {
  std::string path;  ///< "populations[].place"; empty for the whole world
  const DocumentTable* table = nullptr;
  const FieldTable* fields = nullptr;
  std::string_view kind = {};  ///< kind of the objects that have these keys; empty: those of every kind
};

/// A key of such objects.
struct Key {
  std::string path;
  const DocumentTable* table = nullptr;  ///< the table of `key`; null: see `field`
  const DocumentKey* key = nullptr;
  const Field* field = nullptr;  ///< the field of a table of fields, or the parameter of a kind
  std::string_view kind = {};    ///< as in Objects
  /// The preset by whose name the key was found; null if it was found by another name.
  const engine::Registry::Preset* preset = nullptr;

  const Field& name() const { return key != nullptr ? key->field : *field; }
  /// Whether the value has entries, each of which has a name or an index.
  bool has_entries() const {
    return key != nullptr ? key->form == Form::map || key->form == Form::list
                          : field->type == FieldType::records;
  }
};

std::string path_below(const Objects& objects, std::string_view name, std::string_view mark = {}) {
  return fmt::format("{}{}{}{}", objects.path, objects.path.empty() ? "" : ".", name, mark);
}

bool is_called(const Key& key, std::string_view name) {
  if (is_spelled(key.name(), name)) return true;
  if (key.key == nullptr) return false;
  return (key.key->other && is_spelled(*key.key->other, name)) ||
         (key.key->form == Form::heading && is_spelled(heading_field(), name));
}

bool is_index(std::string_view name) {
  return name == "-" || name.find_first_not_of("0123456789") == name.npos;
}

/// Whether faults are keys of the objects: the value of such a key has the parameters of the fault.
bool have_faults(const Objects& objects) {
  return objects.table != nullptr && std::ranges::find(objects.table->keys, Form::faults,
                                                       &DocumentKey::form) != objects.table->keys.end();
}

bool have_kinds(const Objects& objects) {
  return objects.table != nullptr && (objects.table->kinds != nullptr || have_faults(objects));
}

/// The keys of all objects of the worlds that a registry allows.
class Keys {
 public:
  explicit Keys(const engine::Registry& registry) : registry_(registry) {
    sorts_.push_back({.table = &document_table<WorldDocument>()});
    for (std::size_t i = 0; i < sorts_.size(); ++i)
      for (const Key& key : keys_of(Objects(sorts_[i])))
        if (std::optional<Objects> inner = inside(key); inner && !is_listed(*inner))
          sorts_.push_back(*std::move(inner));
  }

  const std::vector<Objects>& sorts() const { return sorts_; }

  std::vector<Key> keys_of(const Objects& objects) const {
    std::vector<Key> keys;
    const auto add_fields = [&](const FieldTable& table, const Objects& owner) {
      for (const Field& field : table.fields)
        keys.push_back(
            {.path = path_below(owner, key_of(field), field.type == FieldType::records ? "[]" : ""),
             .field = &field,
             .kind = owner.kind});
    };
    if (objects.fields != nullptr) add_fields(*objects.fields, objects);
    if (objects.table == nullptr) return keys;
    for (const DocumentKey& key : objects.table->keys) {
      if (key.form == Form::faults) {
        for (const engine::FaultKind& fault : registry_.faults)
          add_fields(fault.params, {.path = path_below(objects, fault.name)});
      } else if (key.form != Form::parameters) {
        const std::string_view mark = key.form == Form::list ? "[]" : key.form == Form::map ? "{}" : "";
        keys.push_back(
            {.path = path_below(objects, key_of(key.field), mark), .table = objects.table, .key = &key});
      }
    }
    if (objects.table->kinds == nullptr) return keys;
    for (const DocumentKind& kind : objects.table->kinds->all(registry_))
      if (kind.params != nullptr && kind.preset_of.empty())
        add_fields(*kind.params, {.path = objects.path, .kind = kind.name});
    return keys;
  }

  /// Returns the objects in the value of a key. Nothing if the value contains no objects.
  static std::optional<Objects> inside(const Key& key) {
    if (key.key != nullptr && key.key->table != nullptr)
      return Objects{.path = key.path, .table = &key.key->table()};
    if (key.key != nullptr && key.key->block != nullptr)
      return Objects{.path = key.path, .fields = key.key->block};
    if (key.name().record != nullptr)
      return Objects{.path = key.path, .fields = key.name().record, .kind = key.kind};
    return std::nullopt;
  }

  /// Appends the keys of `objects` to which the names refer.
  /// is_pointer: the name or index of an entry follows each key whose value has entries
  void find(const Objects& objects, std::span<const std::string_view> names, bool is_pointer,
            std::vector<Key>& found) const {
    for (const Key& key : keys_of(objects)) {
      if (!is_called(key, names.front())) continue;
      const std::size_t used = std::min<std::size_t>(is_pointer && key.has_entries() ? 2 : 1, names.size());
      const std::span<const std::string_view> rest = names.subspan(used);
      const std::optional<Objects> inner = inside(key);
      if (inner && !rest.empty())
        find(*inner, rest, is_pointer, found);
      else if (std::ranges::all_of(rest, is_index))
        found.push_back(key);
    }
    if (const engine::FaultKind* fault = registry_.fault(names.front());
        fault != nullptr && names.size() > 1 && have_faults(objects))
      find({.path = path_below(objects, fault->name), .fields = &fault->params}, names.subspan(1), is_pointer,
           found);
  }

  /// Returns the parameters of the kind or preset `kind`, and the keys of the objects in their values. If
  /// `names` is not empty, only those to which the names refer; they may leave out the keys of outer objects.
  std::vector<Key> of_kind(std::string_view kind, std::span<const std::string_view> names = {}) const {
    const engine::Registry::Preset* const preset = registry_.preset(kind);
    if (preset != nullptr) kind = preset->kind;
    std::vector<Key> found;
    for (const Objects& objects : sorts_)
      if (names.empty())
        std::ranges::move(keys_of(objects), std::back_inserter(found));
      else
        find(objects, names, false, found);
    std::erase_if(found, [kind](const Key& key) { return key.kind != kind; });
    for (Key& key : found) key.preset = preset;
    return found;
  }

  FoundKey description(const Key& key) const {
    FoundKey found;
    found.paths = {key.kind.empty() ? key.path : fmt::format("{} (kind {})", key.path, key.kind)};
    found.row = row_of(key);
    const std::optional<Objects> inner = inside(key);
    if (!inner) return found;
    if (inner->fields != nullptr)
      for (const Field& field : inner->fields->fields) found.keys.push_back(key_row(field));
    if (inner->table == nullptr) return found;
    for (const DocumentKey& one : inner->table->keys)
      if (one.form != Form::parameters) found.keys.push_back(key_row(*inner->table, one, registry_));
    if (inner->table->kinds == nullptr) return found;
    found.what = inner->table->kinds->what;
    found.kinds = inner->table->kinds->known(registry_);
    return found;
  }

 private:
  KeyRow row_of(const Key& key) const {
    if (key.key != nullptr) return key_row(*key.table, *key.key, registry_);
    Field field = *key.field;
    if (key.preset != nullptr)
      for (const auto& [name, value] : key.preset->params)
        if (&registry_.controller(key.kind)->params.at(name) == key.field) field.fallback = value;
    return key_row(field);
  }
  /// Parts can contain parts, so that only the first place of each struct is listed. Tables of fields, such
  /// as that of poses, do not contain each other.
  bool is_listed(const Objects& objects) const {
    return objects.table != nullptr &&
           std::ranges::find(sorts_, objects.table, &Objects::table) != sorts_.end();
  }

  const engine::Registry& registry_;
  std::vector<Objects> sorts_;  // outer objects first
};

/// The names in a path. In a pointer, they include the names and indices of entries.
struct Path {
  std::vector<std::string_view> names;
  bool is_pointer = false;
};

Path path_of(std::string_view text) {
  Path path{.is_pointer = text.starts_with('/')};
  const char separator = path.is_pointer ? '/' : '.';
  for (std::string_view name : split(text, separator)) {
    if (!path.is_pointer) name = name.substr(0, name.find_first_of("[{"));
    if (!name.empty() && (path.is_pointer || !is_index(name))) path.names.push_back(name);
  }
  return path;
}

std::vector<Key> keys_at(const Keys& keys, const Path& path) {
  std::vector<Key> found;
  if (path.names.empty()) return found;
  if (path.is_pointer) {
    keys.find(keys.sorts().front(), path.names, true, found);
    return found;
  }
  for (const Objects& objects : keys.sorts()) keys.find(objects, path.names, false, found);
  if (path.names.size() > 1)
    std::ranges::move(keys.of_kind(path.names.front(), std::span(path.names).subspan(1)),
                      std::back_inserter(found));
  return found;
}

/// Returns the objects that contain the key to which the path refers, whether or not they have this key.
std::vector<Objects> objects_around(const Keys& keys, Path path) {
  std::vector<Objects> around;
  path.names.pop_back();
  for (const Key& key : keys_at(keys, path))
    if (std::optional<Objects> inner = Keys::inside(key)) around.push_back(*std::move(inner));
  return around;
}

std::vector<std::string> sorted(std::vector<std::string> names) {
  std::ranges::sort(names);
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

bool are_equal(const FoundKey& a, const FoundKey& b) {
  const auto cells = [](const KeyRow& row) { return std::tie(row.names, row.value, row.usual, row.meaning); };
  return cells(a.row) == cells(b.row) && a.kinds == b.kinds &&
         std::ranges::equal(a.keys, b.keys, {}, cells, cells);
}

}  // namespace

std::vector<FoundKey> find_keys(const engine::Registry& registry, std::string_view name) {
  const Keys keys(registry);
  std::vector<FoundKey> all;
  for (const Key& key : keys_at(keys, path_of(name))) {
    FoundKey found = keys.description(key);
    const auto same = std::ranges::find_if(all, [&](const FoundKey& one) { return are_equal(one, found); });
    if (same == all.end())
      all.push_back(std::move(found));
    else if (std::ranges::find(same->paths, found.paths.front()) == same->paths.end())
      same->paths.push_back(std::move(found.paths.front()));
  }
  return all;
}

std::string_view kind_in_path(const engine::Registry& registry, std::string_view name) {
  const Path path = path_of(name);
  if (path.names.size() < 2) return {};
  const Keys keys(registry);
  return std::ranges::any_of(objects_around(keys, path), have_kinds) ? path.names.back() : std::string_view();
}

std::vector<std::string> key_names(const engine::Registry& registry) {
  const Keys keys(registry);
  std::vector<std::string> names;
  for (const Objects& objects : keys.sorts())
    for (const Key& key : keys.keys_of(objects)) names.push_back(key_of(key.name()));
  return sorted(std::move(names));
}

std::vector<std::string> names_near(const engine::Registry& registry, std::string_view name) {
  const Keys keys(registry);
  const Path path = path_of(name);
  std::vector<std::string> names;
  if (path.names.size() > 1) {
    const auto last = static_cast<std::size_t>(path.names.back().data() - name.data());
    const auto add = [&](const std::vector<Key>& near) {
      for (const Key& key : near)
        names.push_back(fmt::format("{}{}", name.substr(0, last), key_of(key.name())));
    };
    for (const Objects& objects : objects_around(keys, path)) add(keys.keys_of(objects));
    if (path.names.size() == 2 && !path.is_pointer) add(keys.of_kind(path.names.front()));
  }
  return names.empty() ? key_names(registry) : sorted(std::move(names));
}

}  // namespace troupe::worldio
