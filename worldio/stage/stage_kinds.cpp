#include "worldio/stage/stage_kinds.hpp"

#include "base/number_text.hpp"
#include "base/split.hpp"
#include "worldio/json/document_table.hpp"
#include "worldio/stage/stage_devices.hpp"
#include "worldio/stage/stage_limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace troupe::worldio {
namespace {

using engine::Field;
using engine::FieldTable;
using engine::FieldType;
using engine::Record;
using engine::Value;

/// Sets a field if the table has it. A kind need not have a field for every property of Stage's models.
void set(const FieldTable& table, Record& record, std::string_view name, Value value) {
  if (const int at = table.find(name); at >= 0) record[static_cast<std::size_t>(at)] = std::move(value);
}

/// Returns why a property has no effect; empty if it has one.
std::string unused(const FieldTable& table, const Record& params, const Field& field) {
  return engine::is_used(table, params, field) ? std::string() : engine::unused_reason(table, params, field);
}

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; (at = text.find_first_not_of(" \t", at)) != std::string_view::npos;) {
    const std::size_t end = std::min(text.size(), text.find_first_of(" \t", at));
    words.push_back(text.substr(at, end - at));
    at = end;
  }
  return words;
}

/// Reads the text of an argument of a controller as a number, which is multiplied by `to_si`. The error says
/// what the argument must be.
Result<double> number_argument(const Field& field, double to_si, std::string_view text) {
  const std::optional<double> given = finite_number_of(text);
  if (!given) return Error{"needs a number"};
  const double si = *given * to_si;
  if (const Result<> kept = check_limits(field, si, to_si); !kept) return kept.error();
  return si;
}

/// Like number_argument(), for several numbers.
Result<std::vector<double>> numbers_argument(const Field& field, double to_si, std::string_view text) {
  std::vector<double> list;
  for (std::string_view rest = text; !rest.empty() || list.empty();) {
    const std::size_t comma = std::min(rest.size(), rest.find(','));
    const std::optional<double> given = finite_number_of(rest.substr(0, comma));
    if (!given) return Error{"needs numbers separated by commas, without blanks"};
    list.push_back(*given * to_si);
    if (const Result<> kept = check_limits(field, list.back(), to_si); !kept) return kept.error();
    rest.remove_prefix(std::min(rest.size(), comma + 1));
  }
  if (field.columns > 0 && list.size() != field.columns)
    return Error{fmt::format("needs {} numbers separated by commas, without blanks", field.columns)};
  return list;
}

/// Reads the text of an argument of a controller as a value of `field`. Numbers are multiplied by `to_si`.
/// The error says what the argument must be.
Result<Value> argument_value(const Field& field, double to_si, std::string_view text) {
  switch (field.type) {
    case FieldType::boolean:
      if (text != "0" && text != "1" && text != "true" && text != "false")
        return Error{"needs true or false"};
      return Value(text == "1" || text == "true");
    case FieldType::integer: {
      const Result<double> given = number_argument(field, to_si, text);
      if (!given) return given.error();
      if (*given != std::floor(*given) || std::abs(*given) > 9e15) return Error{"needs a whole number"};
      return Value(static_cast<std::int64_t>(*given));
    }
    case FieldType::number: {
      const Result<double> given = number_argument(field, to_si, text);
      if (!given) return given.error();
      return Value(*given);
    }
    case FieldType::text:
      if (!field.choices.empty() && std::ranges::find(field.choices, text) == field.choices.end())
        return Error{
            fmt::format("must be one of {}{}", comma_list(field.choices), did_you_mean(text, field.choices))};
      return Value(std::string(text));
    case FieldType::numbers: {
      Result<std::vector<double>> given = numbers_argument(field, to_si, text);
      if (!given) return given.error();
      return Value(*std::move(given));
    }
    default: return Error{"cannot be given in a .world file, only in JSON"};
  }
}

}  // namespace

double StageKinds::period_s(const StageModel& model) {
  constexpr double k_default_ms = 100;
  double ms = k_default_ms;
  if (const StageProperty* property = model.find(document_, "update_interval")) {
    ms = values_.number(*property).value_or(k_default_ms);
    if (ms < 0)
      values_.error(values_.where(*property),
                    fmt::format("\"update_interval\" must be 0 (every tick) or above, in ms, found {}", ms));
    else
      values_.is_within(*property, document_table<DeviceDocument>().find("period")->field, ms / 1000, ms);
  }
  return ms / 1000;
}

std::optional<engine::DeviceSpec> StageKinds::ranger(const StageModel& model,
                                                     const std::vector<StageModel>& sensors) {
  if (registry_.device("ranger") == nullptr) {
    values_.error(model.where, "this build of Troupe has no device of kind \"ranger\"");
    return {};
  }
  const bool is_sensor = !model.alias.empty() && sensors.empty();
  if (sensors.empty() && !is_sensor) {
    values_.explain(model.where, "a ranger without a sensor( ... ) measures nothing: add a sensor( ... )");
    return {};
  }
  engine::RangerParams params;
  for (const StageModel& sensor : is_sensor ? std::vector{model} : sensors)
    if (const auto one = transducer(sensor)) params.transducers.push_back(*one);
  if (params.transducers.size() < sensors.size() + is_sensor) return {};

  params.intensity = values_.flag(model.find(document_, "intensity"), false);
  engine::DeviceSpec spec{.kind = "ranger", .params = engine::to_record(params), .where = model.where};
  spec.period_s = period_s(model);
  spec.active = values_.flag(model.find(document_, "alwayson"), false);
  return spec;
}

std::optional<engine::DeviceSpec> StageKinds::gripper(const StageModel& model, const engine::DeviceKind& kind,
                                                      const Eigen::Vector3d& size) {
  auto spec = device(model, kind);
  if (!spec) return {};
  if (const StageProperty* property = model.find(document_, "size")) {
    const Field& limits = kind.params.at("size");
    for (const double extent : size)  // an extent of 0 is reported with the body of the gripper
      if (extent > 0 && !values_.is_within(*property, limits, extent, extent / values_.length_unit()))
        return {};
  }
  set(kind.params, spec->params, "size", std::vector<double>{size.x(), size.y(), size.z()});
  if (const StageProperty* property = model.find(document_, "paddle_size")) {
    const auto v = values_.tuple(*property, 3, 3, "[x y z], fractions of the gripper's size");
    if (!v) return {};
    if (!std::ranges::all_of(*v, [](double part) { return part > 0 && part < 1; }) || (*v)[1] >= 0.5) {
      values_.error(values_.where(*property),
                    fmt::format("\"paddle_size\" needs three fractions of the gripper's size, [x y z], each "
                                "above 0 and below 1, with y below 0.5, found [{} {} {}]",
                                (*v)[0], (*v)[1], (*v)[2]));
      return {};
    }
    set(kind.params, spec->params, "paddle_size", *v);
  }
  if (const StageProperty* property = model.find(document_, "paddle_state")) {
    const auto given = values_.texts(*property);
    const auto is_one_of = [](std::string_view text, std::string_view a, std::string_view b) {
      return text == a || text == b;
    };
    if (given.size() != 2 || !is_one_of(given[0], "open", "closed") || !is_one_of(given[1], "up", "down")) {
      values_.error(values_.where(*property),
                    fmt::format("\"paddle_state\" needs two strings: \"open\" or \"closed\", then \"up\" or "
                                "\"down\"; found [{}]",
                                joined(given, " ")));
      return {};
    }
    set(kind.params, spec->params, "paddles", std::string(given[0]));
    set(kind.params, spec->params, "lift", std::string(given[1]));
  }
  return spec;
}

std::optional<engine::DeviceSpec> StageKinds::device(const StageModel& model,
                                                     const engine::DeviceKind& kind) {
  engine::DeviceSpec spec{
      .kind = std::string(kind.name), .params = kind.params.defaults(), .where = model.where};
  bool is_right = true;  // no early return: every wrong property is reported
  // Parameters that have an effect only with certain values of others are read after those.
  if (kind.name == "radio") is_right = add_radio_law(model, kind, spec);
  for (const bool has_condition : {false, true})
    for (const StageParameter& parameter : stage_parameters()) {
      const Field* field = parameter.model == model.type ? &kind.params.at(parameter.field) : nullptr;
      if (field == nullptr || has_condition == field->used_if.field.empty()) continue;
      is_right = read_parameter(model, parameter, kind.params, spec.params) && is_right;
    }
  if (kind.name == "blobfinder") is_right = add_blob_colors(model, kind, spec) && is_right;
  if (kind.name == "bumper") is_right = add_bumpers(model, spec) && is_right;
  if (!is_right) return {};
  spec.period_s = period_s(model);
  spec.active = values_.flag(model.find(document_, "alwayson"), false);
  return spec;
}

/// Reads a parameter of a device from its property, if the model has it. False, with an error, if the value
/// is wrong.
bool StageKinds::read_parameter(const StageModel& model, const StageParameter& parameter,
                                const FieldTable& table, Record& params) {
  const StageProperty* property = model.find(document_, parameter.property);
  if (property == nullptr) return true;
  const double to_si = parameter.unit == StageUnit::length         ? values_.length_unit()
                       : parameter.unit == StageUnit::angle        ? values_.angle_unit()
                       : parameter.unit == StageUnit::degrees      ? radians(1)
                       : parameter.unit == StageUnit::milliseconds ? 1e-3
                                                                   : 1.0;
  const auto at = static_cast<std::size_t>(table.find(parameter.field));
  auto given =
      value(*property, table.fields[at], to_si, parameter.column, unused(table, params, table.fields[at]));
  if (!given) return false;
  params[at] = *std::move(given);
  return true;
}

/// Reads a property as a value of `field`. A number is multiplied by `to_si`; `column` is the index (0 or 1)
/// of the number in a tuple of two, or -1 for the whole property. Empty, with an error, if the value is
/// wrong.
std::optional<Value> StageKinds::value(const StageProperty& property, const Field& field, double to_si,
                                       int column, const std::string& unused) {
  const auto checked = [&](std::optional<double> given) -> std::optional<double> {
    if (!given) return {};
    const double si = field.unit == engine::Unit::radians ? within_a_turn(*given * to_si) : *given * to_si;
    return values_.is_within(property, field, si, *given, unused) ? std::optional(si) : std::nullopt;
  };
  switch (field.type) {
    case FieldType::boolean:
      if (const auto flag = values_.flag(property)) return Value(*flag);
      return {};
    case FieldType::integer: {
      if (column < 0) {
        const auto given = values_.integer(property);
        if (!given || !checked(static_cast<double>(*given))) return {};
        return Value(*given);
      }
      const auto given = checked(values_.column(property, static_cast<std::size_t>(column)));
      if (!given) return {};
      if (*given == std::floor(*given)) return Value(static_cast<std::int64_t>(*given));
      values_.error(values_.where(property),
                    fmt::format("\"{}\" needs whole numbers, found {}", values_.key(property), *given));
      return {};
    }
    case FieldType::number: {
      const auto si = checked(column < 0 ? values_.number(property)
                                         : values_.column(property, static_cast<std::size_t>(column)));
      if (!si) return {};
      return Value(*si);
    }
    case FieldType::text: {
      const auto given = values_.text(property);
      if (!given) return {};
      if (field.choices.empty() || std::ranges::find(field.choices, *given) != field.choices.end())
        return Value(std::string(*given));
      values_.error(values_.where(property),
                    fmt::format("\"{}\" must be one of {}{}, found \"{}\"", values_.key(property),
                                comma_list(field.choices), did_you_mean(*given, field.choices), *given));
      return {};
    }
    case FieldType::numbers: {
      auto given = values_.tuple(property, field.columns, field.columns, "[x y z]");
      if (!given) return {};
      for (double& number : *given) {
        const auto si = checked(number);
        if (!si) return {};
        number = *si;
      }
      return Value(std::move(*given));
    }
    default: break;
  }
  values_.error(values_.where(property),
                fmt::format("\"{}\" cannot be given in a .world file, only in JSON", values_.key(property)));
  return {};
}

std::optional<engine::DriveSpec> StageKinds::drive(const StageModel& model, bool is_nested) {
  engine::DriveSpec spec{.kind = "diff", .where = model.where};
  if (const StageProperty* property = model.find(document_, "drive")) {
    const auto name = values_.text(*property);
    if (!name) return {};
    spec.kind = *name;
    spec.where = values_.where(*property);
  }
  const engine::DriveKind* kind = registry_.drive(spec.kind);
  if (!kind) {
    values_.error(spec.where, unknown_name("drive", spec.kind, name_list(registry_.drives)));
    return {};
  }
  const auto speeds = drive_bounds(model, "velocity_bounds");
  const auto accelerations = drive_bounds(model, "acceleration_bounds");
  if (!speeds || !accelerations) return {};
  double wheelbase = 1;
  if (const StageProperty* property = model.find(document_, "wheelbase")) {
    const auto given = values_.number(*property);
    if (!given) return {};
    wheelbase = *given * values_.length_unit();
    const Field limits{.name = "wheelbase", .unit = engine::Unit::meters, .min = 0, .above_min = true};
    const bool has_effect = kind->params.find("wheelbase") >= 0;
    if (!values_.is_within(*property, limits, wheelbase, *given,
                           has_effect ? "" : fmt::format("\"drive\" is \"{}\"", spec.kind)))
      return {};
  }
  spec.params = kind->params.defaults();
  const auto set_param = [&](std::string_view name, Value value) {
    set(kind->params, spec.params, name, std::move(value));
  };
  set_param("velocity_min_x", (*speeds)[0]);
  set_param("velocity_max_x", (*speeds)[1]);
  set_param("velocity_min_y", (*speeds)[2]);
  set_param("velocity_max_y", (*speeds)[3]);
  set_param("turn_min", (*speeds)[6]);
  set_param("turn_max", (*speeds)[7]);
  set_param("acceleration_min_x", (*accelerations)[0]);
  set_param("acceleration_max_x", (*accelerations)[1]);
  set_param("acceleration_min_y", (*accelerations)[2]);
  set_param("acceleration_max_y", (*accelerations)[3]);
  set_param("turn_acceleration_min", (*accelerations)[6]);
  set_param("turn_acceleration_max", (*accelerations)[7]);
  set_param("wheelbase", wheelbase);
  if (const StageProperty* property = model.find(document_, "velocity")) {
    const auto v = values_.tuple(*property, 4, 4, "[x y z a]");
    if (!v) return {};
    set_param("start_x", (*v)[0] * values_.length_unit());
    set_param("start_y", (*v)[1] * values_.length_unit());
    set_param("start_turn", (*v)[3] * values_.angle_unit());
  }
  if (const StageProperty* property = model.find(document_, "goal_bounds")) {
    const auto v = values_.tuple(*property, 2, 2, "[v a]");
    if (!v) return {};
    const double speed = (*v)[0] * values_.length_unit();
    const double turn = (*v)[1] * values_.angle_unit();
    if (!(speed > 0 && speed <= kind->params.at("goal_speed_max").max && turn > 0 &&
          turn <= kind->params.at("goal_turn_max").max)) {
      values_.error(
          values_.where(*property),
          fmt::format("\"goal_bounds\" must be above 0 and at most 1e9 m/s and rad/s, found {} and {}",
                      (*v)[0], (*v)[1]));
      return {};
    }
    set_param("goal_speed_max", speed);
    set_param("goal_turn_max", turn);
  }
  // A model inside another model always knows its true pose: wheels() warns of these properties.
  if (!is_nested && !localize(model, kind->params, spec.params)) return {};
  spec.period_s = period_s(model);
  return spec;
}

std::optional<engine::DeviceSpec> StageKinds::wheels(const StageModel& model,
                                                     const engine::DeviceKind& kind) {
  const auto drive = this->drive(model, true);
  if (!drive) return {};
  const engine::FieldTable& given = registry_.drive(drive->kind)->params;
  engine::DeviceSpec spec{
      .kind = std::string(kind.name), .params = kind.params.defaults(), .where = model.where};
  set(kind.params, spec.params, "drive", drive->kind);
  for (std::size_t f = 0; f < given.fields.size(); ++f)
    if (const int at = kind.params.find(given.fields[f].name); at >= 0)
      spec.params[static_cast<std::size_t>(at)] = drive->params[f];
  if (const StageProperty* property = model.find(document_, "velocity"))
    values_.warning_once(
        values_.where(*property),
        "\"velocity\" of a model of type position inside another model has no effect: the drive of such a "
        "model sets the velocity before the first motion: remove this property");
  for (const std::string_view key : {"gps_origin", "odom_error", "odom_heading"})
    if (const StageProperty* property = model.find(document_, key))
      values_.warning_once(
          values_.where(*property),
          fmt::format("\"{}\" of a model of type position inside another model has no effect: such a model "
                      "always knows its true pose: remove this property",
                      key));
  if (const StageProperty* property = model.find(document_, "localization");
      property && values_.text(*property).value_or("gps") != "gps")
    values_.warning_once(
        values_.where(*property),
        "\"localization\" of a model of type position inside another model has no effect: such a "
        "model always knows its true pose: remove this property");
  return spec;
}

std::optional<std::vector<double>> StageKinds::drive_bounds(const StageModel& model, std::string_view key) {
  const double quarter_turn = radians(90);
  // The defaults of Stage, m and rad.
  std::vector<double> bounds{-1, 1, -1, 1, -1, 1, -quarter_turn, quarter_turn};
  const StageProperty* property = model.find(document_, key);
  if (!property) return bounds;
  const auto v = values_.tuple(*property, 8, 8, "[xmin xmax ymin ymax zmin zmax amin amax]");
  if (!v) return {};
  for (std::size_t i = 0; i < bounds.size(); ++i)
    bounds[i] = (*v)[i] * (i < 6 ? values_.length_unit() : values_.angle_unit());
  for (std::size_t i = 0; i < bounds.size(); i += 2)
    if (bounds[i] > bounds[i + 1]) {
      const std::string message =
          fmt::format("in \"{}\", each minimum must be at most the maximum that follows it, found {} and {}",
                      key, (*v)[i], (*v)[i + 1]);
      if (!values_.may_exceed(values_.where(*property), message, i == 4 ? "no model moves along z" : ""))
        return {};
    }
  return bounds;
}

bool StageKinds::localize(const StageModel& model, const FieldTable& table, Record& params) {
  bool is_right = true;
  const auto choose = [&](std::string_view key, std::string fallback, std::vector<std::string_view> choices) {
    const StageProperty* property = model.find(document_, key);
    if (!property) return fallback;
    const auto given = values_.text(*property);
    if (given && std::ranges::find(choices, *given) != choices.end()) return std::string(*given);
    if (given)
      values_.error(values_.where(*property),
                    fmt::format("\"{}\" must be {}, found \"{}\"", key,
                                fmt::format("\"{}\" or \"{}\"", choices[0], choices[1]), *given));
    is_right = false;
    return fallback;
  };
  const std::string kind = choose("localization", "gps", {"gps", "odom"});
  set(table, params, "localization", kind);
  set(table, params, "odom_heading", choose("odom_heading", "new", {"old", "new"}));

  const bool gps_has_origin = values_.flag(model.find(document_, "gps_origin"), false);
  if (const StageProperty* property = model.find(document_, "localization_origin")) {
    const auto origin = values_.pose(*property);
    is_right = is_right && origin;
    if (kind == "gps" && !gps_has_origin && origin && *origin != Pose())
      values_.warning_once(values_.where(*property),
                           "\"localization_origin\" has no effect: as in Stage, poses of \"gps\" are in the "
                           "world frame; add \"gps_origin 1\" to apply the origin");
    else if (origin && (kind != "gps" || gps_has_origin)) {
      set(table, params, "localization_origin", std::vector<double>{origin->x, origin->y});
      set(table, params, "localization_origin_heading", origin->heading);
    }
  }
  if (const StageProperty* property = model.find(document_, "odom_error")) {
    const auto error = values_.tuple(*property, 4, 4, "[x y z a]");
    is_right = is_right && error;
    if (const int at = table.find("odom_error"); error && at >= 0) {
      const auto field = static_cast<std::size_t>(at);
      const std::array written{(*error)[0], (*error)[1], (*error)[3]};
      std::vector<double> fractions{written[0], written[1], written[2] * values_.angle_unit()};
      for (std::size_t i = 0; i < written.size(); ++i)
        is_right = values_.is_within(*property, table.fields[field], fractions[i], written[i],
                                     unused(table, params, table.fields[field])) &&
                   is_right;
      params[field] = std::move(fractions);
    }
  }
  return is_right;
}

std::vector<engine::ControllerSpec> StageKinds::controllers(const StageModel& model) {
  std::vector<engine::ControllerSpec> specs;
  if (const StageProperty* property = model.find(document_, "ctrl"))
    for (const std::string_view call : values_.texts(*property))
      if (auto spec = controller(call, values_.where(*property))) {
        spec->period_s = period_s(model);
        specs.push_back(std::move(*spec));
      }
  return specs;
}

std::optional<engine::ControllerSpec> StageKinds::controller(std::string_view call, Where where) {
  const std::vector<std::string_view> words = words_of(call);
  if (words.empty()) {
    values_.error(where, fmt::format("\"ctrl\" is empty; it must name a controller: {}",
                                     comma_list(registry_.controller_names())));
    return {};
  }
  const std::string_view name = words[0];
  const engine::Registry::Preset* preset = registry_.preset(name);
  const Result<const engine::ControllerKind*> found = registry_.find_controller(preset ? preset->kind : name);
  if (!found) {
    values_.error(where, found.error().text);
    return {};
  }
  const engine::ControllerKind* kind = *found;
  const std::vector<Field>& fields = kind->params.fields;
  engine::ControllerSpec spec{
      .kind = std::string(kind->name), .params = kind->params.defaults(), .where = where};
  if (preset)
    for (const auto& [field, value] : preset->params) set(kind->params, spec.params, field, value);

  std::size_t positional = 0;
  std::vector<bool> is_set(fields.size());
  for (const std::string_view word : std::span(words).subspan(1)) {
    const std::optional<Argument> given = argument(word, fields, name, where, positional);
    if (!given) return {};
    const Field& field = fields[given->field];
    if (is_set[given->field])
      values_.warning_once(
          where,
          fmt::format("controller \"{}\": \"{}\" is given twice; the last value is used", name, field.name));
    is_set[given->field] = true;
    Result<Value> value = argument_value(field, given->to_si, given->text);
    if (!value) {
      values_.error(where, fmt::format("controller \"{}\": \"{}\" {}, found \"{}\"", name, field.name,
                                       value.error().text, given->text));
      return {};
    }
    spec.params[given->field] = *std::move(value);
  }
  for (std::size_t i = 0; i < fields.size(); ++i)
    if (!spec.params[i].given() && !fields[i].optional) {
      values_.error(where, fmt::format("controller \"{0}\" needs the parameter \"{1}\": ctrl \"{0} {1}=...\"",
                                       name, fields[i].name));
      return {};
    }
  return spec;
}

std::optional<StageKinds::Argument> StageKinds::argument(std::string_view word, std::span<const Field> fields,
                                                         std::string_view controller, Where where,
                                                         std::size_t& positional) {
  const std::size_t equals = word.find('=');
  if (equals == word.npos) {
    if (positional < fields.size()) return Argument{positional++, 1, word};
    values_.error(where, fmt::format("controller \"{}\" takes at most {} argument{}: remove \"{}\"",
                                     controller, fields.size(), fields.size() == 1 ? "" : "s", word));
    return {};
  }
  const std::string_view key = word.substr(0, equals);
  const std::string_view text = word.substr(equals + 1);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (key == fields[i].name) return Argument{i, 1, text};
    for (const engine::UnitSuffix& unit : engine::unit_suffixes(fields[i].unit))
      if (key.starts_with(fields[i].name) && key.substr(fields[i].name.size()) == unit.suffix)
        return Argument{i, unit.to_si, text};
  }
  const std::vector<std::string_view> known = name_list(fields);
  values_.error(where,
                known.empty()
                    ? fmt::format("controller \"{}\" has no parameters: remove \"{}\"", controller, word)
                    : fmt::format("controller \"{}\" has no parameter \"{}\"; known: {}{}", controller, key,
                                  comma_list(known), did_you_mean(key, known)));
  return {};
}

}  // namespace troupe::worldio
