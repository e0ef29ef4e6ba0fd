#include "worldio/json/json_include.hpp"

#include "engine/fields/fields.hpp"
#include "worldio/files.hpp"
#include "worldio/json/document_table.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/json/json_reader.hpp"
#include "worldio/json/json_ring.hpp"
#include "worldio/json/world_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

namespace troupe::worldio {
namespace {

namespace fs = std::filesystem;
using Members = JsonNode::Object;

Members* members_of(JsonNode* node) { return node ? std::get_if<Members>(&node->value) : nullptr; }

void remove_key(Members& members, std::string_view key) {
  std::erase_if(members, [key](const JsonMember& member) { return member.key == key; });
}

/// Changes the paths of images in a type of an included file: afterwards they are relative to the folder of
/// the world. `folder` is the folder of the included file, relative to that of the world.
void move_images(JsonNode& node, const fs::path& folder) {
  if (auto* list = std::get_if<JsonNode::List>(&node.value))
    for (JsonNode& item : *list) move_images(item, folder);
  auto* members = members_of(&node);
  if (!members) return;
  for (JsonMember& member : *members) {
    auto* text = std::get_if<std::string>(&member.node.value);
    if (text && member.key == "bitmap" && !text->empty())
      *text = (folder / *text).generic_string();
    else
      move_images(member.node, folder);
  }
}

/// Collects the types of the files that a world includes.
class Includer {
 public:
  Includer(const fs::path& file, Diagnostics& diagnostics)
      : folder_(file.parent_path()), diagnostics_(diagnostics) {
    open_.push_back({canonical(file), file.filename().string()});
  }

  /// Adds the types of the files that `document` includes. `folder`: the folder of the document, relative to
  /// that of the world.
  void add_files_of(const JsonNode& document, const fs::path& folder) {
    const JsonNode* include = document.find("include");
    if (!include) return;
    const JsonCursor root(document, diagnostics_);
    const JsonCursor at(root, "include", *include);
    const JsonNode::List* files = read_list(at);
    for (std::size_t i = 0; files && i < files->size(); ++i) {
      const JsonCursor entry(at, i, (*files)[i]);
      const std::string* name = read_text(entry, "the name of a file");
      if (name && !refuse_nul(entry, *name)) add_file(entry, folder / *name);
    }
  }

  void add_type(JsonMember type) {
    const auto [first, is_new] = places_.emplace(type.key, type.where);
    if (is_new) {
      types_.push_back(std::move(type));
      return;
    }
    diagnostics_.error(
        type.where,
        fmt::format("/types/{}: a type of this name is already defined in {}, line {}: choose another name; "
                    "to inherit from the other type, name that type in the key \"extends\"",
                    escape_pointer_token(type.key), diagnostics_.files()->name(first->second.file),
                    first->second.line));
  }

  Members take_types() { return std::move(types_); }

 private:
  struct OpenFile {
    fs::path path;
    std::string name;  // as it was written
  };

  static fs::path canonical(const fs::path& file) {
    std::error_code error;
    fs::path path = fs::weakly_canonical(file, error);
    return error ? file : path;
  }

  void add_file(const JsonCursor& at, const fs::path& name) {
    const fs::path file =
        folder_ / name;  // not normalised: after a symbolic link, ".." is in the link's target
    const fs::path path = canonical(file);
    const auto same = std::ranges::find(open_, path, &OpenFile::path);
    if (same != open_.end()) {
      std::string chain;
      for (auto each = same; each != open_.end(); ++each) chain += fmt::format("{} includes ", each->name);
      return at.error(fmt::format("the files include each other in a circle: {}{}; remove one \"include\"",
                                  chain, same->name));
    }
    if (!done_.insert(path.string()).second) return;
    if (open_.size() > k_most_nested_includes)
      return at.error(fmt::format(
          "\"{}\" cannot be included: it would be the last of {} files, each of which includes the next one, "
          "and at most {} are allowed; include it in a file nearer to the world",
          name.generic_string(), open_.size(), k_most_nested_includes));
    const Result<> readable = check_readable(file, k_most_input_bytes);
    const std::optional<std::string> text = readable ? read_file(file) : std::nullopt;
    if (!text)
      return at.error(fmt::format("\"{}\" cannot be included: {}", name.generic_string(),
                                  readable ? "the file cannot be read" : readable.error().text));
    std::optional<JsonNode> document =
        parse_json(*text, {diagnostics_.files()->add(file.string()), 0}, false, diagnostics_);
    if (!document) return;
    open_.push_back({path, name.generic_string()});
    add_document(*document, name.parent_path());
    open_.pop_back();
  }

  void add_document(JsonNode& document, const fs::path& folder) {
    const JsonCursor root(document, diagnostics_);
    JsonObject keys(root);
    if (!keys.is_object()) return;
    for (const std::string_view known : k_included_keys) keys.find(known);
    if (const JsonNode* version = keys.find("troupe"))
      if (const auto* number = std::get_if<std::int64_t>(&version->value);
          number == nullptr || *number != k_format_version)
        JsonCursor(root, "troupe", *version)
            .expected(fmt::format("{}, the version of the format", k_format_version));
    keys.finish();
    add_files_of(document, folder);
    JsonNode* types = document.find("types");
    Members* members = members_of(types);
    if (types && !members)
      JsonCursor(root, "types", *types).expected("an object whose keys are the names of the types");
    if (!members) return;
    for (JsonMember& type : *members) {
      move_images(type.node, folder);
      add_type(std::move(type));
    }
  }

  fs::path folder_;  // of the world
  Diagnostics& diagnostics_;
  std::vector<OpenFile> open_;            // the files that are being read, the world first
  std::unordered_set<std::string> done_;  // canonical paths of the files that are or were read
  Members types_;
  std::map<std::string, Where> places_;  // of types_
};

// ---- extends

/// Returns names for the quantities that a key gives. No object may have two keys that give the same
/// quantity, such as `size_m` and `size_cm`, or `controller` and `controllers`.
std::vector<std::string> quantities(std::string_view key) {
  if (key == "controller" || key == "controllers") return {"controllers"};
  std::vector<std::string> names;
  for (const engine::Unit unit : engine::all_units())
    for (const engine::UnitSuffix& in : engine::unit_suffixes(unit))
      if (key.ends_with(in.suffix) && key.size() > in.suffix.size())
        names.push_back(
            fmt::format("{} {}", static_cast<int>(unit), key.substr(0, key.size() - in.suffix.size())));
  return names;
}

/// Returns the description of a key that types can have; null for any other key.
const DocumentKey* key_of_type(std::string_view key) {
  const std::vector<DocumentKey>& keys = document_table<TypeDocument>().keys;
  const auto found =
      std::ranges::find_if(keys, [key](const DocumentKey& one) { return is_spelled(one.field, key); });
  return found == keys.end() ? nullptr : &*found;
}

const std::string* text_of(const JsonNode& object, std::string_view key) {
  const JsonNode* node = object.find(key);
  return node ? node->text() : nullptr;
}

void merge(JsonNode& own, const JsonNode& base);

/// Merges two lists of devices or parts and stores the result in `own`: first the entries of `base`, each
/// merged with the entry of `own` that has the same name, then the other entries of `own`. If both of these
/// entries lack the key `kind`, which the entries of the list `key` need, only the error of the base is kept.
void merge_lists(std::string_view key, JsonNode& own, const JsonNode& base) {
  auto& list = std::get<JsonNode::List>(own.value);
  std::multimap<std::string_view, std::size_t> named;  // entries to merge; equal names in the order of `list`
  for (std::size_t i = 0; i < list.size(); ++i)
    if (const std::string* name = text_of(list[i], "name")) named.emplace(*name, i);
  std::vector<bool> is_merged(list.size());
  JsonNode::List merged;
  for (const JsonNode& inherited : *base.list()) {
    const std::string* name = text_of(inherited, "name");
    const auto same = name ? named.lower_bound(*name) : named.end();
    if (same == named.end() || same->first != *name) {
      merged.push_back(inherited);
      continue;
    }
    const std::size_t i = same->second;
    named.erase(same);
    is_merged[i] = true;
    const bool lacks_kind = key != "parts" && !list[i].find("kind") && !inherited.find("kind");
    if (lacks_kind) {
      merged.push_back(inherited);
    } else {
      merge(list[i], inherited);
      merged.push_back(std::move(list[i]));
    }
  }
  for (std::size_t i = 0; i < list.size(); ++i)
    if (!is_merged[i]) merged.push_back(std::move(list[i]));
  own.value = std::move(merged);
}

/// Whether the value that a base type has for `key` is wrong, so that an object in an heir that relies on it
/// would lack keys. The base then has an error of its own.
bool is_wrong_base(std::string_view key, const JsonNode& own, const JsonNode& base) {
  if (is_named_list(key)) return own.list() && !base.list();
  const DocumentKey* known = own.object() ? key_of_type(key) : nullptr;
  if (!known || known->form != Form::object) return false;
  const DocumentKinds* kinds = known->table().kinds;
  const bool needs_kind = kinds && !kinds->implied;
  return !base.object() || (needs_kind && !own.find("kind") && !base.find("kind"));
}

bool have_other_kinds(const JsonNode& a, const JsonNode& b) {
  const std::string* kind_a = text_of(a, "kind");
  const std::string* kind_b = text_of(b, "kind");
  return kind_a && kind_b && *kind_a != *kind_b;
}

/// Removes the keys with the value null, which say that a type does not inherit these keys. The exception is
/// `"joint": null`, which says that no joint moves the part.
void remove_nulls(Members& members) {
  std::erase_if(members, [](const JsonMember& member) {
    return member.key != "joint" && std::holds_alternative<std::monostate>(member.node.value);
  });
}

/// Adds the keys of `base` to the object `own`, which keeps its own keys.
void merge(JsonNode& own, const JsonNode& base) {
  Members* members = members_of(&own);
  if (!members || !base.object() || have_other_kinds(own, base)) return;
  members->reserve(members->size() + base.object()->size());  // so that `places` stays valid
  std::unordered_map<std::string_view, JsonNode*> places;
  std::unordered_set<std::string> given;  // quantities
  const auto note = [&](JsonMember& member) {
    places.emplace(member.key, &member.node);
    for (std::string& quantity : quantities(member.key)) given.insert(std::move(quantity));
  };
  for (JsonMember& member : *members) note(member);
  for (const JsonMember& inherited : *base.object()) {
    const auto same = places.find(inherited.key);
    if (same != places.end()) {
      JsonNode& node = *same->second;
      const bool are_lists = node.list() && inherited.node.list() && is_named_list(inherited.key);
      if (is_wrong_base(inherited.key, node, inherited.node))
        node = inherited.node;  // which has an error that is reported once, for the base
      else if (are_lists)
        merge_lists(inherited.key, node, inherited.node);
      else
        merge(node, inherited.node);
    } else if (std::ranges::none_of(quantities(inherited.key),
                                    [&](const std::string& quantity) { return given.contains(quantity); })) {
      note(members->emplace_back(inherited));
    }
  }
  remove_nulls(*members);
}

/// Removes the keys with the value null from an object and from all objects in it.
void remove_all_nulls(JsonNode& node) {
  if (Members* members = members_of(&node)) {
    remove_nulls(*members);
    for (JsonMember& member : *members) remove_all_nulls(member.node);
  } else if (auto* list = std::get_if<JsonNode::List>(&node.value)) {
    for (JsonNode& entry : *list) remove_all_nulls(entry);
  }
}

/// Returns the number of JSON values in a value, including the value itself.
std::size_t count_values(const JsonNode& node) {
  std::size_t values = 1;
  if (const JsonNode::List* list = node.list())
    for (const JsonNode& entry : *list) values += count_values(entry);
  if (const Members* members = node.object())
    for (const JsonMember& member : *members) values += count_values(member.node);
  return values;
}

/// Whether a type has one of the keys that give it a shape.
bool has_any_shape(const JsonNode& type) {
  const std::vector<DocumentRule>& rules = document_table<TypeDocument>().rules;
  const auto shape = std::ranges::find(rules, DocumentRule::How::any_of, &DocumentRule::how);
  return std::ranges::any_of(*type.object(), [&](const JsonMember& member) {
    const DocumentKey* key = key_of_type(member.key);
    return key && std::ranges::find(shape->keys, key->field.name) != shape->keys.end();
  });
}

/// Gives a type the size 1 m x 1 m x 1 m if it may have a size and has none, which is an error of its base.
void add_missing_size(JsonNode& type, const Where& where) {
  const DocumentKey& size = *document_table<TypeDocument>().find("size");
  Members& members = *members_of(&type);
  const bool has_size = std::ranges::any_of(
      members, [&size](const JsonMember& member) { return is_spelled(size.field, member.key); });
  if (has_size || !size.is_there(type)) return;
  const JsonNode one{1.0, where};
  members.push_back({"size_m", where, {JsonNode::List{one, one, one}, where}});
}

/// Whether a key of a type may be an error only because the type lacks what it would have inherited: the
/// value of the key would be merged with an inherited value, or the key is valid only with other keys.
bool needs_base(const JsonNode& type, std::string_view key) {
  const DocumentKey* known = key_of_type(key);
  if (!known) return false;
  return known->form == Form::object || is_named_list(key) || (known->is_there && !known->is_there(type));
}

/// Removes the key "extends" of a type whose base is wrong, and everything in the type that needs_base().
/// Otherwise the reader would also report the lack of keys that the type would have inherited. For the same
/// reason, keys with the value null, which remove inherited values, are removed, and the type gets a size.
void replace_wrong_base(JsonNode& type) {
  Members& members = *members_of(&type);
  const Where where = type.find("extends")->where;
  remove_key(members, "extends");
  remove_all_nulls(type);
  const JsonNode whole = type;
  std::erase_if(members, [&whole](const JsonMember& member) { return needs_base(whole, member.key); });
  add_missing_size(type, where);
}

/// Resolves `extends` of all types, each type after the one that it extends.
class TypeMerger {
 public:
  /// bases: if not null, the list to which the names of base types are added.
  /// has_all_types: whether an unknown base type is an error
  TypeMerger(Members& types, Diagnostics& diagnostics, std::vector<std::string>* bases, bool has_all_types)
      : types_(types),
        diagnostics_(diagnostics),
        bases_(bases),
        has_all_types_(has_all_types),
        is_visited_(types.size()),
        is_wrong_(types.size()),
        depths_(types.size()) {
    for (std::size_t t = 0; t < types.size(); ++t) indices_.emplace(types[t].key, t);
  }

  /// Returns whether all types could inherit.
  bool merge_all() {
    for (std::size_t t = 0; t < types_.size(); ++t) resolve(t);
    return std::ranges::find(is_wrong_, true) == is_wrong_.end();
  }

 private:
  void resolve(std::size_t type);
  std::optional<std::size_t> find_base(const JsonMember& type);
  void inherit(std::size_t type, std::size_t base);
  void drop_misspelled_entries(JsonMember& heir, const JsonNode& base);
  /// Replaces the base of a type that cannot inherit, because its base is unknown or wrong.
  void replace_base(std::size_t type) {
    is_wrong_[type] = true;
    replace_wrong_base(types_[type].node);
  }
  static Inheritable inheritable(const JsonMember& type) {
    const std::string* name = text_of(type.node, "name");
    return {"/types/" + escape_pointer_token(type.key), name ? *name : type.key, type.where};
  }
  void error(const JsonMember& type, std::string_view message) {
    diagnostics_.error(type.node.find("extends")->where,
                       fmt::format("/types/{}/extends: {}", escape_pointer_token(type.key), message));
  }
  /// Reports that a limit is exceeded. Throws, because the other types would only repeat the error.
  void limit_error(const JsonMember& type, std::string_view message) {
    error(type, message);
    diagnostics_.throw_if_errors();
  }

  Members& types_;
  Diagnostics& diagnostics_;
  std::vector<std::string>* bases_;
  bool has_all_types_;
  std::unordered_map<std::string_view, std::size_t> indices_;  // key of a type -> its index in types_
  std::vector<bool> is_visited_;                               // per type: resolved, or being resolved
  std::vector<bool> is_wrong_;                                 // per type: see replace_base()
  std::vector<std::size_t> depths_;  // per type: number of types that it inherits from
  std::size_t inherited_values_ = 0;
};

/// Resolves `extends` of a type, after that of all types from which it inherits. Not recursive, because the
/// chain of these types may be long.
void TypeMerger::resolve(std::size_t type) {
  std::vector<std::size_t> chain;  // each type extends the next one
  for (std::optional<std::size_t> next = type; next && types_[*next].node.find("extends");) {
    JsonMember& each = types_[*next];
    if (is_visited_[*next]) {
      std::string circle;
      for (auto t = std::ranges::find(chain, *next); t != chain.end(); ++t)
        circle += fmt::format("{} extends ", types_[*t].key);
      error(each, fmt::format("the types extend each other in a circle: {}{}; remove one \"extends\"", circle,
                              each.key));
      replace_base(*next);
      break;
    }
    is_visited_[*next] = true;
    chain.push_back(*next);
    next = find_base(each);
    if (!next) replace_base(chain.back());
  }
  for (; !chain.empty(); chain.pop_back())
    if (const JsonNode* extends = types_[chain.back()].node.find("extends"))
      inherit(chain.back(), indices_.find(*extends->text())->second);
}

/// Returns the index of the type that `type` extends. Empty, with an error, if there is no such type.
std::optional<std::size_t> TypeMerger::find_base(const JsonMember& type) {
  const JsonNode& extends = *type.node.find("extends");
  const std::string* name = extends.text();
  const auto found = name ? indices_.find(*name) : indices_.end();
  if (found != indices_.end()) {
    const JsonMember& base = types_[found->second];
    const std::string* base_name = text_of(base.node, "name");
    if (bases_) bases_->push_back(base_name ? *base_name : base.key);
    return found->second;
  }
  if (name && !has_all_types_) return std::nullopt;
  std::vector<std::string_view> known;
  for (const JsonMember& each : types_)
    if (&each != &type) known.push_back(each.key);
  error(type, name ? unknown_name("type", *name, std::move(known))
                   : fmt::format("expected the name of a type, found {}", extends.describe()));
  return std::nullopt;
}

/// Reports the entries of the lists `sensors` and `devices` of an heir that have no kind, and whose name
/// resembles that of an entry of the base type. Removes them: the reader would only report that they lack a
/// kind.
void TypeMerger::drop_misspelled_entries(JsonMember& heir, const JsonNode& base) {
  constexpr std::size_t k_most_compared = 100;  // longer lists would take time
  for (const char* key : {"sensors", "devices"}) {
    JsonNode* own = heir.node.find(key);
    const JsonNode* inherited = base.find(key);
    if (!own || !own->list() || !inherited || !inherited->list()) continue;
    std::vector<std::string_view> names;
    for (const JsonNode& entry : *inherited->list())
      if (const std::string* name = text_of(entry, "name")) names.push_back(*name);
    if (names.size() > k_most_compared) continue;
    std::erase_if(std::get<JsonNode::List>(own->value), [&](const JsonNode& entry) {
      const std::string* name = text_of(entry, "name");
      if (!name || entry.find("kind") || std::ranges::find(names, *name) != names.end()) return false;
      const std::string hint = did_you_mean(*name, names);
      if (hint.empty()) return false;
      diagnostics_.error(entry.where,
                         fmt::format("/types/{}/{}: the type inherits no entry \"{}\"{}; an entry with a new "
                                     "name needs a \"kind\"",
                                     escape_pointer_token(heir.key), key, *name, hint));
      return true;
    });
  }
}

void TypeMerger::inherit(std::size_t type, std::size_t base) {
  JsonMember& heir = types_[type];
  JsonNode inherited = types_[base].node;
  if (is_wrong_[base] || !inherited.object()) return replace_base(type);  // the error of the base is enough
  depths_[type] = depths_[base] + 1;
  if (depths_[type] > k_most_bases)
    limit_error(heir,
                fmt::format("the type inherits from more than {} types, directly or through other types, "
                            "which is the limit: extend a type that inherits from fewer types",
                            k_most_bases));
  inherited_values_ += count_values(inherited);
  if (inherited_values_ > k_most_inherited_values)
    limit_error(heir,
                fmt::format("up to here, the types of the world inherit more than {} values, which is the "
                            "limit: extend smaller types, or use fewer types with \"extends\"",
                            k_most_inherited_values));
  diagnostics_.inherits(inheritable(heir), inheritable(types_[base]));
  const Where where = heir.node.find("extends")->where;
  remove_key(*members_of(&heir.node), "extends");
  Members& members = *members_of(&inherited);
  remove_key(members, "name");
  if (heir.node.find("kind")) remove_key(members, "kind");
  drop_misspelled_entries(heir, inherited);
  merge(heir.node, inherited);
  if (!has_any_shape(inherited) && !has_any_shape(heir.node)) add_missing_size(heir.node, where);
}

}  // namespace

void resolve_includes(JsonNode& world, const fs::path& file, Diagnostics& diagnostics) {
  Members* members = members_of(&world);
  const JsonNode* include = world.find("include");
  if (!members || !include) return;
  const Where where = include->where;
  Includer includer(file, diagnostics);
  includer.add_files_of(world, {});
  remove_key(*members, "include");
  JsonNode* types = world.find("types");
  if (!types) types = &members->emplace_back(JsonMember{"types", where, {Members(), where}}).node;
  Members* own = members_of(types);
  if (!own) return;  // the reader reports it
  for (JsonMember& type : *own) includer.add_type(std::move(type));
  *own = includer.take_types();
}

bool resolve_extends(JsonNode& world, Diagnostics& diagnostics, std::vector<std::string>* bases,
                     bool has_all_types) {
  Members* types = members_of(world.find("types"));
  return types == nullptr || TypeMerger(*types, diagnostics, bases, has_all_types).merge_all();
}

}  // namespace troupe::worldio
