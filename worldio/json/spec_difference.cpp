#include "worldio/json/spec_difference.hpp"

#include "base/hash.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/json/spec_fields.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace troupe::worldio {
namespace {

using engine::Field;
using engine::FieldTable;
using engine::FieldType;
using engine::MemberType;
using engine::Value;
using engine::WorldSpec;

/// Calls a function of the object `found` for each member of a struct that spec_difference() compares, in the
/// order of the table of the struct. With N = 1 it reads one struct. With N = 2 it reads two structs of the
/// same type, and each call gets the same member of both. `found` must have the functions below; their first
/// argument is an array with one entry for each of the N structs:
///   bool size(sizes, path)    for each list, and for each optional struct (size 0 or 1)
///   bool value(values, path)  for each other value
///   bool place(wheres, path)  for each member that is a place in a file (a Where)
/// `path` is the path of the member. If a call returns false, no further members are read.
template <std::size_t N, class Found>
class Walk {
 public:
  using Objects = std::array<const void*, N>;

  explicit Walk(Found& found) : found_(found) {}

  bool object(const FieldTable& table, const Objects& objects, const SpecPath* path) const {
    return std::ranges::all_of(table.fields,
                               [&](const Field& field) { return member(field, objects, path); });
  }

  bool member(const Field& field, const Objects& objects, const SpecPath* path) const {
    if (field.member == nullptr) return true;  // bodies and aliases are compared by spec_difference() itself
    const SpecPath at{path, field.name, 0};
    const Objects members = of_each(objects, [&](const void* object) { return member_of(field, object); });
    if (field.record == &engine::place_fields())
      return found_.place(
          of_each(members, [](const void* where) { return static_cast<const Where*>(where); }), at);
    if (field.provenance) return true;
    const MemberType& type = *field.member;
    if (type.block != nullptr) return blocks(field, type, members, at);
    return found_.value(of_each(members, [&](const void* member) { return type.get(member); }), at);
  }

 private:
  template <class Of>
  static auto of_each(const Objects& objects, Of of) {
    std::array<decltype(of(objects[0])), N> out;
    std::ranges::transform(objects, out.begin(), of);
    return out;
  }

  bool blocks(const Field& field, const MemberType& type, const Objects& lists, const SpecPath& path) const {
    const auto sizes = of_each(lists, [&](const void* list) { return type.size(list); });
    if (type.resize != nullptr && !found_.size(sizes, path)) return false;
    for (std::size_t i = 0; i < sizes[0]; ++i) {
      const SpecPath entry{&path, {}, i};
      const SpecPath& at = field.type == FieldType::record ? path : entry;
      const Objects blocks = of_each(lists, [&](const void* list) { return block_of(type, list, i); });
      if (type.each == nullptr ? !object(*field.record, blocks, &at) : !points(field, *type.each, blocks, at))
        return false;
    }
    return true;
  }

  bool points(const Field& field, const MemberType& type, const Objects& lists, const SpecPath& path) const {
    if (type.each != nullptr) return blocks(field, type, lists, path);
    return found_.value(of_each(lists, [&](const void* point) { return type.get(point); }), path);
  }

  Found& found_;
};

/// Compares the members of two structs for Walk and keeps the path of the first member that differs.
class FirstDifference {
 public:
  FirstDifference(const WorldSpec* a, const WorldSpec* b, Places places) : specs_{a, b}, places_(places) {}

  bool size(const std::array<std::size_t, 2>& sizes, const SpecPath& path) {
    return note(sizes[0] == sizes[1], path);
  }
  bool value(const std::array<Value, 2>& values, const SpecPath& path) {
    return note(same_bits(values[0], values[1]), path);
  }
  bool place(const std::array<const Where*, 2>& wheres, const SpecPath& path) {
    return note(places_ == Places::ignored ||
                    (wheres[0]->line == wheres[1]->line && file_of(0, *wheres[0]) == file_of(1, *wheres[1])),
                path);
  }
  bool note(bool is_same, const SpecPath& path) {
    if (!is_same) text_ = path.text();
    return is_same;
  }
  void ignore_places() { places_ = Places::ignored; }
  const std::string& text() const { return text_; }

 private:
  std::string_view file_of(std::size_t which, const Where& where) const {
    const SourceFiles* files = specs_[which]->files.get();
    if (files == nullptr || where.file >= files->size()) return {};
    return files->name(where.file);
  }

  std::array<const WorldSpec*, 2> specs_;
  Places places_;
  std::string text_;
};

/// For Walk: appends all compared values to one byte string.
class Bytes {
 public:
  bool size(const std::array<std::size_t, 1>& sizes, const SpecPath&) { return add(sizes[0]); }
  bool value(const std::array<Value, 1>& values, const SpecPath&) { return add(values[0]); }
  bool place(const std::array<const Where*, 1>&, const SpecPath&) { return true; }
  std::string take() { return std::exchange(bytes_, {}); }
  template <class Number>
  requires std::is_arithmetic_v<Number>
  bool add(Number number) {
    bytes_.append(reinterpret_cast<const char*>(&number), sizeof number);
    return true;
  }
  void add(const std::string& text) {
    add(text.size());
    bytes_ += text;
  }

 private:
  bool add(const Value& value) {
    add(value.v.index());
    std::visit([this](const auto& held) { add(held); }, value.v);
    return true;
  }
  void add(std::monostate) {}
  template <class T>
  void add(const std::vector<T>& list) {
    add(list.size());
    for (const T& item : list) add(item);
  }

  std::string bytes_;
};

/// Compares the bodies, or the aliases, of two worlds: `list` is the member of WorldSpec, `table` describes
/// its entries, and `what` is its name in paths. Names are compared as texts. Returns whether the lists are
/// equal.
template <class List>
bool compare_named(const FieldTable& table, const std::array<const WorldSpec*, 2>& specs, List list,
                   std::string_view what, FirstDifference& found) {
  const auto& a = specs[0]->*list;
  const auto& b = specs[1]->*list;
  const SpecPath path{nullptr, what, 0};
  if (!found.size({a.size(), b.size()}, path)) return false;
  const Walk<2, FirstDifference> walk(found);
  for (std::size_t i = 0; i < a.size(); ++i) {
    const SpecPath entry{&path, {}, i};
    if (!found.note(specs[0]->names.text(a[i].name) == specs[1]->names.text(b[i].name),
                    {&entry, "name", 0}) ||
        !walk.object(table, {&a[i], &b[i]}, &entry))
      return false;
  }
  return true;
}

/// Appends the entries of a list with names, the bodies or the aliases of a world, to the stream `hash`.
void add_named(const FieldTable& table, const auto& list, const engine::Names& names, HashStream& hash) {
  Bytes bytes;
  const auto flush = [&] {
    const std::string piece = bytes.take();
    hash.add(std::as_bytes(std::span(piece)));
  };
  bytes.add(list.size());
  for (const auto& entry : list) {
    bytes.add(names.text(entry.name));
    static_cast<void>(Walk<1, Bytes>(bytes).object(table, {&entry}, nullptr));
    flush();
  }
  flush();
}

bool same_part_names(const WorldSpec& a, const WorldSpec& b) {
  return a.part_aliases.size() == b.part_aliases.size() &&
         std::ranges::all_of(a.part_aliases, [&](const auto& entry) {
           const auto found = b.part_aliases.find(entry.first);
           return found != b.part_aliases.end() && found->second.body == entry.second.body &&
                  found->second.part == entry.second.part;
         });
}

}  // namespace

bool same_part(const engine::PartSpec& a, const engine::PartSpec& b) {
  FirstDifference found(nullptr, nullptr, Places::ignored);
  return Walk<2, FirstDifference>(found).object(engine::part_fields(), {&a, &b}, nullptr);
}

std::string compared_bytes(const engine::TypeSpec& type) {
  Bytes bytes;
  static_cast<void>(Walk<1, Bytes>(bytes).object(engine::type_fields(), {&type}, nullptr));
  return bytes.take();
}

std::string spec_difference(const WorldSpec& a, const WorldSpec& b, Places places) {
  FirstDifference found(&a, &b, places);
  const Walk<2, FirstDifference> walk(found);
  const std::array<const WorldSpec*, 2> specs{&a, &b};
  for (const Field& field : engine::world_fields().fields) {
    if (field.name == "title" && a.title.empty()) continue;
    if (field.record == &engine::experiment_fields()) found.ignore_places();
    const bool is_same =
        field.name == "bodies"
            ? compare_named(engine::body_fields(), specs, &WorldSpec::bodies, field.name, found)
        : field.name == "aliases"
            ? compare_named(engine::alias_fields(), specs, &WorldSpec::aliases, field.name, found)
        : field.name == "part_names" ? found.note(same_part_names(a, b), {nullptr, field.name, 0})
                                     : walk.member(field, {&a, &b}, nullptr);
    if (!is_same) break;
  }
  return found.text();
}

std::uint64_t hash_of_content(const WorldSpec& spec) {
  constexpr std::array<std::string_view, 9> k_without_effect{
      "title", "quit_time", "record", "measures", "measure_every", "watch", "window", "mortal", "contacts"};
  HashStream hash;
  Bytes bytes;
  for (const Field& field : engine::world_fields().fields)
    if (std::ranges::find(k_without_effect, field.name) == k_without_effect.end())
      static_cast<void>(Walk<1, Bytes>(bytes).member(field, {&spec}, nullptr));
  const std::map<std::string, engine::PartName> sorted(spec.part_aliases.begin(), spec.part_aliases.end());
  for (const auto& [name, place] : sorted) {
    bytes.add(name);
    bytes.add(place.body.value);
    bytes.add(place.part);
  }
  const std::string head = bytes.take();
  hash.add(std::as_bytes(std::span(head)));
  add_named(engine::body_fields(), spec.bodies, spec.names, hash);
  add_named(engine::alias_fields(), spec.aliases, spec.names, hash);
  return hash.hash();
}

}  // namespace troupe::worldio
