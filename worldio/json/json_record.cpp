#include "worldio/json/json_record.hpp"

#include "worldio/json/fields_json.hpp"
#include "worldio/json/json_text.hpp"

namespace troupe::worldio {

namespace {

const engine::Field& every_field() {
  static const engine::Field field{
      .name = "every", .unit = engine::Unit::seconds, .min = 0, .max = 1e9, .above_min = true};
  return field;
}

}  // namespace

engine::RecordSpec read_record(const JsonCursor& at) {
  engine::RecordSpec record{.where = at.where(), .where_fields = at.where()};
  JsonObject object(at);
  if (const JsonNode* node = object.find("file"))
    if (const std::string* file = read_text(JsonCursor(at, "file", *node), "the name of a file"))
      record.file = *file;
  const engine::Value every = read_field(object, every_field());
  if (every.given()) record.every_s = every.number();
  if (const JsonNode* node = object.find("fields")) {
    record.where_fields = node->where;
    const JsonCursor fields(at, "fields", *node);
    const JsonNode::List* list = read_list(fields);
    for (std::size_t i = 0; list && i < list->size(); ++i)
      if (const std::string* name = read_text(JsonCursor(fields, i, (*list)[i]), "the name of a field"))
        record.fields.push_back(*name);
    if (list && list->empty()) fields.expected("at least one name of a field");
  }
  object.finish();
  return record;
}

JsonNode record_node(const engine::RecordSpec& record) {
  JsonNode::Object object;
  if (!record.file.empty()) add_member(object, "file", record.file);
  if (record.every_s) write_field(every_field(), *record.every_s, object);
  JsonNode::List fields;
  for (const std::string& name : record.fields) fields.push_back(json_node(name));
  if (!fields.empty()) add_member(object, "fields", std::move(fields));
  return json_node(std::move(object), record.where);
}

}  // namespace troupe::worldio
