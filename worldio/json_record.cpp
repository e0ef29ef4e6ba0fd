#include "worldio/json_record.hpp"

#include "worldio/fields_json.hpp"

namespace troupe::worldio {

engine::RecordSpec read_record(const JsonCursor& at) {
  engine::RecordSpec record{.where = at.where(), .where_fields = at.where()};
  JsonObject object(at);
  if (const JsonNode* node = object.find("file"))
    if (const std::string* file = read_text(JsonCursor(at, "file", *node), "the name of a file"))
      record.file = *file;
  const engine::Value every = read_field(
      object, {.name = "every", .unit = engine::Unit::seconds, .min = 0, .max = 1e9, .above_min = true});
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

}  // namespace troupe::worldio
