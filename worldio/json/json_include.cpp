#include "worldio/json/json_include.hpp"

#include "engine/fields/fields.hpp"
#include "worldio/files.hpp"
#include "worldio/json/json_reader.hpp"
#include "worldio/json/world_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <unordered_map>
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
      if (const std::string* name = read_text(entry, "the name of a file")) add_file(entry, folder / *name);
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
    const fs::path file = (folder_ / name).lexically_normal();
    const fs::path path = canonical(file);
    const auto same = std::ranges::find(open_, path, &OpenFile::path);
    if (same != open_.end()) {
      std::string chain;
      for (auto each = same; each != open_.end(); ++each) chain += fmt::format("{} includes ", each->name);
      return at.error(fmt::format("the files include each other in a circle: {}{}; remove one \"include\"",
                                  chain, same->name));
    }
    if (std::ranges::find(done_, path) != done_.end()) return;
    done_.push_back(path);
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
    for (const std::string_view known : {"$schema", "include", "types"}) keys.find(known);
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
  std::vector<OpenFile> open_;  // the files that are being read, the world first
  std::vector<fs::path> done_;
  Members types_;
  std::map<std::string, Where> places_;  // of types_
};

// ---- extends

/// Whether two keys give one quantity in different units, such as `size_m` and `size_cm`.
bool differ_in_unit(std::string_view a, std::string_view b) {
  const auto stem = [](std::string_view key, std::string_view suffix) {
    return key.ends_with(suffix) ? key.substr(0, key.size() - suffix.size()) : std::string_view();
  };
  for (auto unit = engine::Unit::meters; unit <= engine::Unit::watts;
       unit = static_cast<engine::Unit>(static_cast<int>(unit) + 1))
    for (const engine::UnitSuffix& of_a : engine::unit_suffixes(unit))
      for (const engine::UnitSuffix& of_b : engine::unit_suffixes(unit))
        if (of_a.suffix != of_b.suffix && !stem(a, of_a.suffix).empty() &&
            stem(a, of_a.suffix) == stem(b, of_b.suffix))
          return true;
  return false;
}

/// Whether no object may have both keys.
bool excludes(std::string_view a, std::string_view b) {
  return (a == "controller" && b == "controllers") || (a == "controllers" && b == "controller") ||
         differ_in_unit(a, b);
}

bool is_named_list(std::string_view key) {
  constexpr std::array<std::string_view, 3> k_lists{"sensors", "devices", "parts"};
  return std::ranges::find(k_lists, key) != k_lists.end();
}

const std::string* text_of(const JsonNode& object, std::string_view key) {
  const JsonNode* node = object.find(key);
  return node ? node->text() : nullptr;
}

void merge(JsonNode& own, const JsonNode& base);

/// Merges two lists of devices or parts and stores the result in `own`: first the entries of `base`, each
/// merged with the entry of `own` that has the same name, then the other entries of `own`.
void merge_lists(JsonNode& own, const JsonNode& base) {
  auto& list = std::get<JsonNode::List>(own.value);
  JsonNode::List merged;
  for (const JsonNode& inherited : *base.list()) {
    const std::string* name = text_of(inherited, "name");
    const auto same = std::ranges::find_if(list, [name](const JsonNode& entry) {
      const std::string* its_name = text_of(entry, "name");
      return name && its_name && *name == *its_name;
    });
    if (same == list.end()) {
      merged.push_back(inherited);
      continue;
    }
    merge(*same, inherited);
    merged.push_back(std::move(*same));
    list.erase(same);
  }
  std::ranges::move(list, std::back_inserter(merged));
  own.value = std::move(merged);
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
  for (const JsonMember& inherited : *base.object()) {
    const auto same = std::ranges::find(*members, inherited.key, &JsonMember::key);
    if (same != members->end()) {
      const bool are_lists = same->node.list() && inherited.node.list() && is_named_list(same->key);
      if (are_lists)
        merge_lists(same->node, inherited.node);
      else
        merge(same->node, inherited.node);
    } else if (std::ranges::none_of(
                   *members, [&](const JsonMember& member) { return excludes(member.key, inherited.key); })) {
      members->push_back(inherited);
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

/// Resolves `extends` of all types, each type after the one that it extends.
class TypeMerger {
 public:
  /// bases: if not null, the list to which the names of base types are added.
  TypeMerger(Members& types, Diagnostics& diagnostics, std::vector<std::string>* bases)
      : types_(types), diagnostics_(diagnostics), bases_(bases) {}

  void merge_all() {
    for (JsonMember& type : types_) resolve(type);
  }

 private:
  void resolve(JsonMember& type);
  static Inheritable inheritable(const JsonMember& type) {
    const std::string* name = text_of(type.node, "name");
    return {"/types/" + escape_pointer_token(type.key), name ? *name : type.key, type.where};
  }
  void error(const JsonMember& type, Where where, std::string_view message) {
    diagnostics_.error(where, fmt::format("/types/{}/extends: {}", escape_pointer_token(type.key), message));
  }

  Members& types_;
  Diagnostics& diagnostics_;
  std::vector<std::string>* bases_;
  std::vector<const JsonMember*> open_;  // types that are being resolved, each extends the next one
};

/// Removes the key "extends" of a type whose base is wrong, and gives the type a shape if it has none.
/// Otherwise the reader would also report the lack of a shape, although the type would have inherited one.
/// For the same reason, keys with the value null, which remove inherited values, are removed.
void replace_wrong_base(JsonNode& type) {
  constexpr std::array<std::string_view, 7> k_shapes{"size_m", "size_cm", "size_mm", "disc",
                                                     "blocks", "bitmap",  "device"};
  Members& members = *members_of(&type);
  const Where where = type.find("extends")->where;
  remove_key(members, "extends");
  remove_all_nulls(type);
  if (std::ranges::any_of(k_shapes, [&](std::string_view key) { return type.find(key) != nullptr; })) return;
  const JsonNode one{1.0, where};
  members.push_back({"size_m", where, {JsonNode::List{one, one, one}, where}});
}

void TypeMerger::resolve(JsonMember& type) {
  const JsonNode* extends = type.node.find("extends");
  if (!extends) return;
  const Where where = extends->where;
  const JsonNode value = *extends;
  const auto circle = std::ranges::find(open_, &type);
  if (circle != open_.end()) {
    std::string chain;
    for (auto each = circle; each != open_.end(); ++each) chain += fmt::format("{} extends ", (*each)->key);
    replace_wrong_base(type.node);
    return error(type, where,
                 fmt::format("the types extend each other in a circle: {}{}; remove one \"extends\"", chain,
                             type.key));
  }
  const std::string* name = value.text();
  const auto base = name ? std::ranges::find(types_, *name, &JsonMember::key) : types_.end();
  if (base == types_.end()) {
    std::vector<std::string_view> known;
    for (const JsonMember& each : types_)
      if (&each != &type) known.push_back(each.key);
    error(type, where,
          name ? unknown_name("type", *name, std::move(known))
               : fmt::format("expected the name of a type, found {}", value.describe()));
    return replace_wrong_base(type.node);
  }
  const std::string* base_name = text_of(base->node, "name");
  if (bases_) bases_->push_back(base_name ? *base_name : base->key);
  open_.push_back(&type);
  resolve(*base);
  open_.pop_back();
  if (type.node.find("extends") == nullptr) return;  // the circle of types is already reported
  diagnostics_.inherits(inheritable(type), inheritable(*base));
  remove_key(*members_of(&type.node), "extends");
  JsonNode inherited = base->node;
  if (Members* members = members_of(&inherited)) {
    remove_key(*members, "name");
    if (type.node.find("kind")) remove_key(*members, "kind");
  }
  merge(type.node, inherited);
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

void resolve_extends(JsonNode& world, Diagnostics& diagnostics, std::vector<std::string>* bases) {
  if (Members* types = members_of(world.find("types"))) TypeMerger(*types, diagnostics, bases).merge_all();
}

}  // namespace troupe::worldio
