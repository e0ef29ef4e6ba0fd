#include "worldio/json/spec_check.hpp"

#include "base/number_text.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/json/spec_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::worldio {
namespace {

using engine::Field;
using engine::FieldTable;
using engine::FieldType;
using engine::MemberType;
using engine::Record;
using engine::Value;

/// Returns which alternative of the std::variant in engine::Value holds values of this field type.
std::size_t alternative_of(FieldType type) {
  switch (type) {
    case FieldType::boolean: return Value(true).v.index();
    case FieldType::integer: return Value(0).v.index();
    case FieldType::number: return Value(0.0).v.index();
    case FieldType::text: return Value("").v.index();
    case FieldType::texts: return Value(std::vector<std::string>()).v.index();
    case FieldType::numbers:
    case FieldType::color:
    case FieldType::colors: return Value(std::vector<double>()).v.index();
    case FieldType::record:
    case FieldType::records: break;
  }
  return Value(std::vector<Record>()).v.index();
}

/// Returns a phrase for the values that a parameter of this type accepts, such as "a whole number".
std::string_view noun_of(FieldType type) {
  switch (type) {
    case FieldType::boolean: return "true or false";
    case FieldType::integer: return "a whole number";
    case FieldType::number: return "a number";
    case FieldType::text: return "a text";
    case FieldType::texts: return "a list of texts";
    case FieldType::numbers:
    case FieldType::color:
    case FieldType::colors: return "a list of numbers";
    case FieldType::record: return "an object of parameters";
    case FieldType::records: break;
  }
  return "a list of objects of parameters";
}

class SpecCheck {
 public:
  SpecCheck(const engine::WorldSpec& spec, const engine::Registry& registry, Diagnostics& diagnostics)
      : spec_(spec), registry_(registry), diagnostics_(diagnostics) {}

  void check() {
    object(engine::world_fields(), &spec_, {}, nullptr);
    list(engine::body_fields(), spec_.bodies, "bodies");
    list(engine::alias_fields(), spec_.aliases, "aliases");
    const std::size_t before = diagnostics_.findings().size();
    engine::check_rules(spec_,
                        [this](Where where, const std::string& error) { diagnostics_.error(where, error); });
    if (diagnostics_.findings().size() == before) settings();
  }

 private:
  void object(const FieldTable& table, const void* object, Where where, const SpecPath* path);
  void member(const Field& field, const FieldTable& table, const void* object, Where where,
              const SpecPath& path);
  void lists(const Field& field, const MemberType& type, const void* list, Where where, const SpecPath& path);
  void structure(const Field& field, const void* object, Where where, const SpecPath& path);
  void numbers(const Field& limits, const FieldTable& table, const void* object, Where where,
               const SpecPath& path);
  void value(const Field& field, const Value& value, Where where, const SpecPath& path);
  void beyond(const Field& field, double x, Where where, const SpecPath& path);
  void record(const FieldTable& table, const Record& record, bool is_partial, Where where,
              const SpecPath& path);
  void settings();

  template <class T>
  void list(const FieldTable& table, const std::vector<T>& entries, std::string_view name) {
    const SpecPath path{nullptr, name};
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const SpecPath entry{&path, {}, i};
      object(table, &entries[i], {}, &entry);
    }
  }
  void error(Where where, const SpecPath& path, std::string_view message) {
    diagnostics_.error(where, fmt::format("{}: {}", path.text(), message));
  }

  const engine::WorldSpec& spec_;
  const engine::Registry& registry_;
  Diagnostics& diagnostics_;
};

/// Checks the members of a struct. `where` is the place of the enclosing struct, which errors get if the
/// struct itself has no place. `path` is the path of the struct; null for the world.
void SpecCheck::object(const FieldTable& table, const void* object, Where where, const SpecPath* path) {
  for (const Field& field : table.fields)
    if (field.name == "where") where = *static_cast<const Where*>(member_of(field, object));
  for (const Field& field : table.fields)
    if (field.member != nullptr && !field.provenance) member(field, table, object, where, {path, field.name});
}

void SpecCheck::member(const Field& field, const FieldTable& table, const void* object, Where where,
                       const SpecPath& path) {
  const MemberType& type = *field.member;
  const void* at = member_of(field, object);
  if (field.type == FieldType::records || type.each != nullptr) return lists(field, type, at, where, path);
  if (field.type == FieldType::record && field.record != nullptr) {
    if (type.size(at) > 0) structure(field, block_of(type, at, 0), where, path);
    return;
  }
  const Value given = type.get(at);
  if (!given.given()) return;
  if (field.type != FieldType::record) return value(field, given, where, path);
  if (&table == &engine::setting_fields()) return;  // checked by settings()
  const Result<const FieldTable*> parameters = parameters_of(table, object, registry_);
  if (!parameters) return error(where, path, parameters.error().text);
  record(**parameters, given.records().front(), false, where, path);
}

void SpecCheck::lists(const Field& field, const MemberType& type, const void* list, Where where,
                      const SpecPath& path) {
  const std::size_t size = type.size(list);
  for (std::size_t i = 0; i < size; ++i) {
    const SpecPath entry{&path, {}, i};
    const void* block = block_of(type, list, i);
    if (type.each == nullptr)
      structure(field, block, where, entry);
    else if (type.each->each != nullptr)
      lists(field, *type.each, block, where, entry);
    else
      value(field, type.each->get(block), where, entry);
  }
}

void SpecCheck::structure(const Field& field, const void* block, Where where, const SpecPath& path) {
  if (is_listed(*field.record))
    numbers(field, *field.record, block, where, path);
  else
    object(*field.record, block, where, &path);
}

/// Checks a struct that consists only of numbers against the limits of the member that holds the struct.
void SpecCheck::numbers(const Field& limits, const FieldTable& table, const void* object, Where where,
                        const SpecPath& path) {
  for (const Field& field : table.fields) {
    const SpecPath at{&path, field.name};
    const void* member = member_of(field, object);
    if (field.type == FieldType::record)
      numbers(limits, *field.record, field.member->block(const_cast<void*>(member), 0), where, at);
    else
      value(limits, field.member->get(member), where, at);
  }
}

void SpecCheck::value(const Field& field, const Value& value, Where where, const SpecPath& path) {
  const auto check = [&](double x) {
    if (!is_within(field, x)) beyond(field, x, where, path);
  };
  if (const auto* x = std::get_if<double>(&value.v)) return check(*x);
  if (const auto* list = std::get_if<std::vector<double>>(&value.v)) {
    const auto is_beyond = [&](double x) {
      return !is_within(field, x) || (engine::has_whole_numbers(field) && std::trunc(x) != x);
    };
    const auto found = std::ranges::find_if(*list, is_beyond);  // one error per list is enough
    if (found != list->end()) beyond(field, *found, where, path);
    return;
  }
  if (std::holds_alternative<std::int64_t>(value.v)) return check(integer_number(field, value));
  if (const auto* text = std::get_if<std::string>(&value.v))
    if (!field.choices.empty() && std::ranges::find(field.choices, *text) == field.choices.end())
      error(where, path, unknown_name(field.name, *text, field.choices));
}

void SpecCheck::beyond(const Field& field, double x, Where where, const SpecPath& path) {
  std::string limits = limits_text(field, engine::unit_suffixes(field.unit).front());
  if (is_within(field, x)) limits = "a whole number";
  error(where, path,
        fmt::format("must be {}, found {}", limits.empty() ? "finite" : limits, exact_number(x)));
}

/// Checks the parameters of a kind, whose table is `table`. `is_partial` says that the record changes only
/// some parameters, so that required parameters may be missing.
void SpecCheck::record(const FieldTable& table, const Record& record, bool is_partial, Where where,
                       const SpecPath& path) {
  if (record.size() != table.fields.size())
    return error(where, path,
                 fmt::format("expected {} parameters, found {}", table.fields.size(), record.size()));
  for (std::size_t i = 0; i < record.size(); ++i) {
    const Field& field = table.fields[i];
    const SpecPath at{&path, field.name};
    if (!record[i].given()) {
      if (!is_partial && field.required()) error(where, at, fmt::format("missing: {}", field.text));
      continue;
    }
    if (record[i] == field.fallback) continue;  // a default outside the limits is allowed: it means "none"
    if (record[i].v.index() != alternative_of(field.type)) {
      error(where, at, fmt::format("the value has the wrong type: expected {}", noun_of(field.type)));
    } else if (field.type == FieldType::record || field.type == FieldType::records) {
      const std::vector<Record>& blocks = record[i].records();
      for (std::size_t b = 0; b < blocks.size(); ++b) {
        const SpecPath block{&at, {}, b};
        this->record(*field.record, blocks[b], false, where, block);
      }
    } else if (field.columns > 0 && record[i].numbers().size() != field.columns) {
      error(where, at,
            fmt::format("expected {} numbers, found {}", field.columns, record[i].numbers().size()));
    } else if (field.used_if.field.empty() || (!is_partial && engine::is_used(table, record, field))) {
      // Of a partial record, the engine checks such limits when it has completed the record (check_used()).
      value(field, record[i], where, at);
    }
  }
}

/// Checks the parameters that interventions give to types. The types exist, because check_rules() found no
/// error.
void SpecCheck::settings() {
  for (std::size_t i = 0; i < spec_.experiment.at.size(); ++i) {
    const engine::InterventionSpec& at = spec_.experiment.at[i];
    if (!at.setting) continue;
    const engine::TypeSpec& type = spec_.types[at.setting->type.index()];
    const auto parameters = [&]() -> Result<const FieldTable*> {
      using Of = engine::SettingSpec::Of;
      if (at.setting->of == Of::drive) return parameters_of(engine::drive_fields(), &*type.drive, registry_);
      if (at.setting->of == Of::device)
        return parameters_of(engine::device_fields(), &type.devices[at.setting->index], registry_);
      return parameters_of(engine::controller_fields(), &type.controllers[at.setting->index], registry_);
    }();
    const SpecPath experiment{nullptr, "experiment"};
    const SpecPath list{&experiment, "at"};
    const SpecPath entry{&list, {}, i};
    const SpecPath setting{&entry, "setting"};
    if (parameters) record(**parameters, at.setting->params, true, at.where, {&setting, "params"});
  }
}

}  // namespace

void check_spec(const engine::WorldSpec& spec, const engine::Registry& registry, Diagnostics& diagnostics) {
  SpecCheck(spec, registry, diagnostics).check();
}

}  // namespace troupe::worldio
