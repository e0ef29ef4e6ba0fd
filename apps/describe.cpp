#include "apps/describe.hpp"

#include "apps/options.hpp"
#include "base/diagnostics.hpp"
#include "engine/observing/events.hpp"
#include "troupe/plugins.hpp"
#include "troupe/registry.hpp"
#include "worldio/json/world_schema.hpp"
#include "worldio/stage/stage_properties.hpp"

#include <CLI/CLI.hpp>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <span>
#include <vector>

namespace troupe::apps {
namespace {

using engine::Field;
using engine::FieldTable;
using engine::FieldType;
using engine::Registry;
using engine::Value;

/// Returns a heading and, below it, one line with name and description for each kind. The text is empty if
/// there are no kinds.
template <class Kinds>
std::string listed(std::string_view heading, const Kinds& kinds) {
  if (kinds.empty()) return {};
  std::size_t width = 0;
  for (const auto& kind : kinds) width = std::max(width, kind.name.size());
  std::string text = fmt::format("{}\n", heading);
  for (const auto& kind : kinds) text += fmt::format("  {:<{}}  {}\n", kind.name, width, kind.text);
  return text + "\n";
}

std::string number_text(double x) { return fmt::format("{:.6g}", x); }

std::string value_text(const Value& value) {
  struct Visitor {
    std::string operator()(std::monostate) const { return "required"; }
    std::string operator()(bool x) const { return x ? "true" : "false"; }
    std::string operator()(std::int64_t x) const { return fmt::format("{}", x); }
    std::string operator()(double x) const { return number_text(x); }
    std::string operator()(const std::string& x) const { return fmt::format("\"{}\"", x); }
    std::string operator()(const std::vector<double>& x) const {
      return fmt::format("[{:.6g}]", fmt::join(x, " "));
    }
    std::string operator()(const std::vector<std::string>& x) const {
      return fmt::format("[{}]", fmt::join(x, " "));
    }
    std::string operator()(const std::vector<engine::Record>& x) const {
      return x.empty() ? "[]" : "see below";
    }
  };
  return std::visit(Visitor{}, value.v);
}

/// Returns the allowed values of a parameter as text: "number 0 .. 1 m", "number > 0 s", "car, diff, omni".
std::string range_text(const Field& field) {
  const std::string unit{engine::unit_suffixes(field.unit).front().symbol};
  const bool low = std::isfinite(field.min);
  const bool high = std::isfinite(field.max);
  std::string range;
  switch (field.type) {
    case FieldType::boolean: return "true, false";
    case FieldType::text: return field.choices.empty() ? "text" : comma_list(field.choices);
    case FieldType::texts: return "a list of texts";
    case FieldType::color: return "a colour";
    case FieldType::colors: return "a list of colours";
    case FieldType::record: return "an object";
    case FieldType::records: return "a list of objects";
    case FieldType::integer: range = "integer"; break;
    case FieldType::number: range = "number"; break;
    case FieldType::numbers:
      range = field.columns == 0 ? "numbers" : fmt::format("{} numbers", field.columns);
      break;
  }
  if (low && high)
    range += fmt::format(" {}{} .. {}", field.above_min ? "above " : "", number_text(field.min),
                         number_text(field.max));
  else if (low)
    range += fmt::format(" {} {}", field.above_min ? ">" : ">=", number_text(field.min));
  else if (high)
    range += fmt::format(" <= {}", number_text(field.max));
  return unit.empty() ? range : range + " " + unit;
}

/// Returns the JSON key of a parameter, with the suffixes of the other units that the key may have: "fov_rad
/// (_deg)".
std::string key_text(const Field& field) {
  const auto units = engine::unit_suffixes(field.unit);
  std::string others;
  for (const engine::UnitSuffix& unit : units.subspan(1))
    others += fmt::format("{}{}", others.empty() ? "" : ", ", unit.suffix);
  return fmt::format("{}{}{}", field.name, units.front().suffix, others.empty() ? "" : " (" + others + ")");
}

/// Largest width of a column, in characters. A longer entry does not widen the column, but shifts the rest of
/// its own line to the right.
constexpr std::size_t k_max_column = 36;

using Line = std::array<std::string, 4>;

void add_lines(const FieldTable& table, const std::string& indent, std::vector<Line>& lines) {
  for (const Field& field : table.fields) {
    const bool block = field.type == FieldType::record || field.type == FieldType::records;
    // A block that the world file omits has the default values of its fields, which the following lines list.
    const bool defaulted_block = field.type == FieldType::record && !field.fallback.given();
    const std::string fallback = field.optional    ? "none"
                                 : defaulted_block ? "see below"
                                                   : value_text(field.fallback);
    lines.push_back({indent + key_text(field), fallback, range_text(field), std::string(field.text)});
    if (block) add_lines(*field.record, indent + "  ", lines);
  }
}

std::string fields_text(const FieldTable& table) {
  if (table.fields.empty()) return "  takes no parameters\n";
  std::vector<Line> lines{{"key", "default", "range", "meaning"}};
  add_lines(table, "", lines);
  std::array<std::size_t, 3> widths{};
  for (const Line& line : lines)
    for (std::size_t i = 0; i < widths.size(); ++i)
      if (line[i].size() <= k_max_column) widths[i] = std::max(widths[i], line[i].size());
  std::string text;
  for (const Line& line : lines) {
    std::string row = fmt::format("  {:<{}}  {:<{}}  {:<{}}  {}", line[0], widths[0], line[1], widths[1],
                                  line[2], widths[2], line[3]);
    row.erase(row.find_last_not_of(' ') + 1);
    text += row + "\n";
  }
  return text;
}

/// Returns typical parameters of a kind: the defaults, and one object in each required list of objects.
/// DeviceKind::prepare() needs parameters to determine the fields of the readings. Returns std::nullopt if
/// any other parameter is required.
std::optional<engine::Record> usual(const FieldTable& table) {
  engine::Record record = table.defaults();
  for (std::size_t i = 0; i < table.fields.size(); ++i) {
    const Field& field = table.fields[i];
    const bool is_block = field.type == FieldType::record || field.type == FieldType::records;
    if (record[i].given() && !(is_block && record[i].records().empty())) continue;
    if (field.optional) continue;
    if (!is_block) return std::nullopt;
    std::optional<engine::Record> block = usual(*field.record);
    if (!block) return std::nullopt;
    record[i] = std::vector<engine::Record>{std::move(*block)};
  }
  return record;
}

/// Returns, as text, the fields of a device that controllers and programs can read, and the fields of its
/// command. Empty if usual() returns std::nullopt.
std::string state_text(const engine::DeviceKind& kind) {
  const std::optional<engine::Record> params = usual(kind.params);
  if (!params) return {};
  const engine::DeviceKind::Prepared prepared = kind.prepare(*params, {});
  std::string text;
  const auto add = [&text](std::string_view heading, std::span<const engine::StateField> fields) {
    if (fields.empty()) return;
    std::vector<std::array<std::string, 2>> lines;
    std::size_t width = 0;
    for (const engine::StateField& field : fields) {
      const std::string count = field.columns == 1 ? "" : fmt::format("{} x ", field.columns);
      const std::string unit = field.unit.empty() ? "" : " " + field.unit;
      lines.push_back({field.name, fmt::format("{}{}{}", count, engine::element_name(field.element), unit)});
      width = std::max(width, field.name.size());
    }
    text += fmt::format("{}\n", heading);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      std::string row = fmt::format("  {:<{}}  {:<20}  {}", lines[i][0], width, lines[i][1], fields[i].text);
      row.erase(row.find_last_not_of(' ') + 1);
      text += row + "\n";
    }
    text += "\n";
  };
  add(kind.is_sensor() ? "readings, with the default parameters" : "state, with the default parameters",
      prepared.percepts);
  add("command", prepared.commands);
  return text;
}

/// Returns, as text, which data of other bodies a device reads, and which bodies its effects change.
std::string others_text(const engine::DeviceKind& kind) {
  std::string text;
  if (!kind.reads.empty())
    text += fmt::format("  reads, in addition to the poses and shapes of other bodies: {}\n",
                        fmt::join(kind.reads, ", "));
  if (kind.apply != nullptr) {
    constexpr std::array<std::string_view, 3> k_scopes{
        "the body that has the device, one target body within the reach of the device (the distance up to "
        "which the device reads other bodies), and all bodies that carry these two or are carried by them",
        "the body that has the device, one target body anywhere in the world, and all bodies that carry "
        "these "
        "two or are carried by them",
        "any body"};
    text += fmt::format("  changes: {}\n", k_scopes[static_cast<std::size_t>(kind.scope)]);
  }
  return text.empty() ? text : "access to bodies\n" + text + "\n";
}

template <class Kind>
std::string kind_text(std::string_view group, const Kind& kind) {
  return fmt::format("{} {}: {}\n\n{}\n", group, kind.name, kind.text, fields_text(kind.params));
}

std::string model_text(const Registry& registry, const engine::ModelKind& kind) {
  const engine::DeviceKind* device = registry.device(kind.device);
  return fmt::format("model {}: {}\n\n  default size {} x {} x {} m, {}\n\n", kind.name, kind.text,
                     kind.size.x(), kind.size.y(), kind.size.z(),
                     kind.has_default_body ? "a box unless the model has blocks or a bitmap"
                     : device && device->body != nullptr
                         ? "with the shape that the device defines, unless the model has blocks or a bitmap"
                         : "without a shape unless the model has blocks or a bitmap") +
         worldio::stage_properties_text(kind.name);
}

/// Wraps a text into indented lines of at most 100 characters.
std::string wrapped(std::string_view text) {
  constexpr std::size_t k_width = 100;
  std::string out;
  for (std::size_t start = 0; start < text.size();) {
    std::size_t end = text.size();
    if (end - start > k_width) end = text.rfind(' ', start + k_width);
    if (end == text.npos || end <= start) end = std::min(text.find(' ', start), text.size());
    out += fmt::format("  {}\n", text.substr(start, end - start));
    start = end + 1;
  }
  return out;
}

std::string measure_text(const engine::MeasureKind& kind) {
  const std::string_view symbol = engine::unit_suffixes(kind.unit).front().symbol;
  return fmt::format("measure {}{}: {}\n\n{}{}\n{}\n", kind.name,
                     symbol.empty() ? std::string() : fmt::format(" ({})", symbol), kind.text,
                     wrapped(kind.definition),
                     kind.formula.empty() ? std::string() : fmt::format("\n    {}\n", kind.formula),
                     fields_text(kind.params));
}

/// Returns the description of a preset (a named set of parameters for a kind of controller), as text: the
/// parameters of the kind, with the preset's values as defaults.
std::string preset_text(const Registry& registry, const Registry::Preset& preset) {
  FieldTable table = registry.controller(preset.kind)->params;
  for (const auto& [name, value] : preset.params)
    table.fields[static_cast<std::size_t>(table.find(name))].fallback = value;
  return fmt::format("controller {}: {}\n\n  preset of {} with these defaults\n\n{}\n", preset.name,
                     preset.text, preset.kind, fields_text(table));
}

}  // namespace

std::vector<std::string_view> kind_names(const Registry& registry) {
  std::vector<std::string_view> names;
  const auto add = [&names](const auto& kinds) {
    for (const auto& kind : kinds) names.push_back(kind.name);
  };
  add(registry.models);
  add(registry.devices);
  add(registry.drives);
  add(registry.controllers);
  add(registry.presets);
  add(registry.measures);
  add(registry.faults);
  std::ranges::sort(names);
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

std::string list_kinds(const Registry& registry) {
  return listed("models", registry.models) + listed("sensors", registry.sensors()) +
         listed("devices", registry.other_devices()) + listed("drives", registry.drives) +
         listed("controllers", registry.controllers) + listed("presets of controllers", registry.presets) +
         listed("measures", registry.measures) + listed("faults", registry.faults) +
         listed("events", engine::event_kinds()) + "`troupe describe KIND` lists the parameters of a kind.\n";
}

std::string describe_kind(const Registry& registry, std::string_view name) {
  std::string text;  // parameters in JSON, then properties in Stage world files
  if (const auto* kind = registry.device(name))
    text +=
        kind_text(kind->is_sensor() ? "sensor" : "device", *kind) + state_text(*kind) + others_text(*kind);
  if (const auto* kind = registry.drive(name)) text += kind_text("drive", *kind);
  if (const auto* kind = registry.controller(name)) text += kind_text("controller", *kind);
  if (const auto* preset = registry.preset(name)) text += preset_text(registry, *preset);
  if (const auto kind = registry.find_measure(name)) text += measure_text(**kind);
  if (const auto* kind = registry.fault(name)) text += kind_text("fault", *kind);
  if (text.find("\n  key ") != std::string::npos)
    text +=
        "The ending of a key, such as _m, is the unit of its default and range; in JSON, the key may also "
        "have "
        "one of the endings in parentheses.\n";
  if (const auto* kind = registry.model(name))
    text += (text.empty() ? "" : "\n") + model_text(registry, *kind);
  if (text.empty()) {
    // The names of all kinds are not listed: they are long and would come before the suggestion.
    std::string unknown = fmt::format("unknown kind \"{}\"{}; `troupe describe` lists all kinds", name,
                                      did_you_mean(name, kind_names(registry)));
    if (registry.plugged_controllers)  // the error of a plug-in is more specific
      if (const auto found = registry.plugged_controllers(name, unknown); !found)
        unknown = found.error().text;
    throw InputError("troupe describe: error: " + unknown);
  }
  return text;
}

void add_describe_options(CLI::App& command, DescribeOptions& options) {
  command
      .add_option("KIND", options.kind,
                  "Name of a model, sensor, device, drive, controller, measure or fault (default: list all)")
      ->option_text(" ");
  command.add_flag("--schema", options.schema, "Print the JSON Schema of worlds, for editors and programs");
  add_plugin_path_option(command, options.plugin_path);
  command.footer(
      "\nExamples:\n  troupe describe\n  troupe describe ranger\n  troupe describe follow_wall --plugin-path "
      "build\n  troupe describe --schema > world.schema.json");
}

ExitCode describe(const DescribeOptions& options) {
  engine::Registry registry = make_registry();
  if (options.schema) {
    fmt::print("{}", worldio::world_schema(registry));
    return k_finished;
  }
  add_plugins(registry, plugin_path(options.plugin_path));
  fmt::print("{}", options.kind.empty() ? list_kinds(registry) : describe_kind(registry, options.kind));
  return k_finished;
}

}  // namespace troupe::apps
