#include "worldio/json/document_keys.hpp"

#include <algorithm>

namespace troupe::worldio::detail {

DocumentKey& KeyList::add(Form form, std::string_view name, std::string_view text, std::string_view expects,
                          const MemberAccess& access) {
  DocumentKey& key = table_.keys.emplace_back();
  key.field = {.name = name, .type = engine::FieldType::text, .text = text};
  key.form = form;
  key.expects = expects;
  key.is_optional = access.is_optional;
  key.make = access.make;
  key.find = access.find;
  return key;
}

DocumentKey& KeyList::add_value(std::string_view name, const engine::MemberType& type, const void* member,
                                bool is_float, std::initializer_list<engine::Fact> facts) {
  engine::FieldTable fields;
  engine::detail::add_field(fields, name, type, table_.usual, member, facts);
  DocumentKey& key = table_.keys.emplace_back();
  key.field = std::move(fields.fields.front());
  key.field.fallback = {};  // an absent key leaves the member unchanged
  key.is_float = is_float;
  return key;
}

DocumentKey& KeyList::add_entries(Form form, std::string_view name, std::string_view text,
                                  const MemberAccess& access, const DocumentTable& (*entry_table)(),
                                  const EntryAccess& entries) {
  DocumentKey& key = add(form, name, text, {}, access);
  key.table = entry_table;
  key.size = entries.size;
  key.append = entries.append;
  key.item = entries.item;
  key.item_name = entries.item_name;
  return key;
}

KeyList::Noted& KeyList::noted(const StructMembers& of) {
  for (Noted& known : noted_)
    if (known.of.name == of.name) return known;
  return noted_.emplace_back(Noted{of, {}});
}

void KeyList::note(const StructMembers& of, std::string_view member) {
  std::vector<std::string_view>& members = noted(of).members;
  if (std::ranges::find(members, member) == members.end()) members.push_back(member);
}

std::vector<std::string> KeyList::incomplete() const {
  std::vector<std::string> found;
  for (const Noted& known : noted_)
    if (known.members.size() != known.of.count) found.emplace_back(known.of.name);
  return found;
}

}  // namespace troupe::worldio::detail
