#include "apps/describe.hpp"

#include "apps/controller_needs.hpp"
#include "apps/example_params.hpp"
#include "apps/options.hpp"
#include "base/diagnostics.hpp"
#include "base/split.hpp"
#include "engine/observing/events.hpp"
#include "troupe/plugins.hpp"
#include "troupe/registry.hpp"
#include "troupe/script.hpp"
#include "worldio/json/find_keys.hpp"
#include "worldio/json/world_schema.hpp"
#include "worldio/stage/stage_properties.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <utility>
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
      std::vector<std::string> numbers;
      for (const double number : x) numbers.push_back(number_text(number));
      return fmt::format("[{}]", joined(numbers, " "));
    }
    std::string operator()(const std::vector<std::string>& x) const {
      return fmt::format("[{}]", joined(x, " "));
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

/// Largest width of a column, in characters. A longer entry does not widen the column, but shifts the rest of
/// its own line to the right.
constexpr std::size_t k_max_column = 36;

using Line = std::array<std::string, 4>;

void add_lines(const FieldTable& table, const std::string& indent, std::vector<Line>& lines) {
  for (const Field& field : table.fields) {
    const bool block = field.type == FieldType::record || field.type == FieldType::records;
    // A block that the world file omits has the default values of its fields, which the following lines list.
    const bool defaulted_block = field.type == FieldType::record && !field.fallback.given();
    const std::string fallback = field.optional || field.is_without_limit() ? "none"
                                 : defaulted_block                          ? "see below"
                                                   : value_text(field.usual_in_json());
    lines.push_back(
        {indent + worldio::key_text(field), fallback, range_text(field), worldio::meaning_text(field)});
    if (field.type == FieldType::records && field.record->find("pose") >= 0)
      lines.push_back({indent + "  ring", "none", "an object",
                       "copies of this object on a circle; `troupe describe ring` lists the keys"});
    if (block) add_lines(*field.record, indent + "  ", lines);
  }
}

/// Returns lines as the rows of a table.
std::string table_text(const std::vector<Line>& lines) {
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

std::string fields_text(const FieldTable& table) {
  if (table.fields.empty()) return "  takes no parameters\n";
  std::vector<Line> lines{{"key", "default", "range", "meaning"}};
  add_lines(table, "", lines);
  return table_text(lines);
}

/// Returns, as text, the fields of a device that controllers and programs can read, and the fields of its
/// command. Empty if no example of the device can be made.
std::string state_text(const engine::DeviceKind& kind) {
  const std::optional<engine::DeviceKind::Prepared> prepared = prepare_example(kind, Example::usual);
  if (!prepared) return {};
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
  constexpr std::string_view k_parameters = "with the default parameters and examples of required ones";
  add(fmt::format("{}, {}", kind.is_sensor() ? "readings" : "state", k_parameters), prepared->percepts);
  add("command", prepared->commands);
  return text;
}

/// Returns, as text, which data of other bodies a device reads, and which bodies its effects change.
std::string others_text(const engine::DeviceKind& kind) {
  std::string text;
  if (!kind.reads.empty())
    text += fmt::format("  reads, in addition to the poses and shapes of other bodies: {}\n",
                        joined(kind.reads, ", "));
  if (kind.apply != nullptr) {
    constexpr std::array<std::string_view, 3> k_scopes{
        "the body that has the device, one target body within the reach of the device (the distance up to "
        "which the device reads other bodies), and all bodies that carry these two or are carried by them",
        "the body that has the device, one target body anywhere in the world, and all bodies that carry "
        "these two or are carried by them",
        "any body"};
    text += fmt::format("  changes: {}\n", k_scopes[static_cast<std::size_t>(kind.scope)]);
  }
  return text.empty() ? text : "access to bodies\n" + text + "\n";
}

template <class Kind>
std::string kind_text(std::string_view group, const Kind& kind) {
  return fmt::format("{} {}: {}\n\n{}\n", group, kind.name, kind.text, fields_text(kind.params));
}

std::string controller_text(const Registry& registry, const engine::ControllerKind& kind) {
  return kind_text("controller", kind) + needs_text(registry, kind, kind.params);
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
  std::string line;
  for (const std::string_view word : split(text, ' ')) {
    if (!line.empty() && line.size() + 1 + word.size() > k_width)
      out += fmt::format("  {}\n", std::exchange(line, {}));
    if (!line.empty()) line += ' ';
    line += word;
  }
  return out + fmt::format("  {}\n", line);
}

std::string measure_text(const engine::MeasureKind& kind) {
  const std::string_view symbol = engine::unit_suffixes(kind.unit).front().symbol;
  return fmt::format("measure {}{}: {}\n{}{}\n{}\n", kind.name,
                     symbol.empty() ? std::string() : fmt::format(" ({})", symbol), kind.text,
                     kind.definition.empty() ? std::string() : "\n" + wrapped(kind.definition),
                     kind.formula.empty() ? std::string() : fmt::format("\n    {}\n", kind.formula),
                     fields_text(kind.params));
}

/// Returns the description of a preset (a named set of parameters for a kind of controller), as text: the
/// parameters of the kind, with the preset's values as defaults.
std::string preset_text(const Registry& registry, const Registry::Preset& preset) {
  const engine::ControllerKind& kind = *registry.controller(preset.kind);
  FieldTable table = kind.params;
  for (const auto& [name, value] : preset.params) table.at(name).fallback = value;
  return fmt::format("controller {}: {}\n\n  preset of {} with these defaults\n\n{}\n", preset.name,
                     preset.text, preset.kind, fields_text(table)) +
         needs_text(registry, kind, table);
}

constexpr std::string_view k_endings =
    "The ending of a key, such as _m, is the unit of its default and range; in JSON, the key may also have "
    "one of the endings in parentheses.\n";

/// Returns the description of a key of JSON worlds as text.
std::string key_description(const worldio::FoundKey& key) {
  const worldio::KeyRow& row = key.row;
  const std::string usual = row.usual == "required" ? row.usual : "default: " + row.usual;
  std::string text = fmt::format("key {}: {}; {}\n\n", row.names, row.value, usual);
  constexpr std::size_t k_most_paths = 8;
  for (std::size_t i = 0; i < std::min(key.paths.size(), k_most_paths); ++i)
    text += fmt::format("  at {}\n", key.paths[i]);
  if (key.paths.size() > k_most_paths)
    text += fmt::format("  and at {} more places\n", key.paths.size() - k_most_paths);
  if (!row.meaning.empty()) text += "\n" + wrapped(row.meaning);
  if (!key.keys.empty()) {
    std::vector<Line> lines{{"key", "default", "range", "meaning"}};
    for (const worldio::KeyRow& one : key.keys)
      lines.push_back({one.names, one.usual, one.value, one.meaning});
    text += "\n" + table_text(lines);
  }
  if (!key.what.empty())
    text += fmt::format("\n{}  `troupe describe KIND` lists the parameters of a kind.\n",
                        wrapped(fmt::format("kinds of {}: {}", key.what, comma_list(key.kinds))));
  return text;
}

/// Returns the description of the kind `name` as text; empty if there is no such kind.
/// with_stage: whether to describe a model that is also a sensor or device with its properties in Stage's
/// world files
std::string kind_description(const Registry& registry, std::string_view name, bool with_stage) {
  std::string text;  // parameters in JSON, then properties in Stage world files
  if (const auto* kind = registry.device(name))
    text +=
        kind_text(kind->is_sensor() ? "sensor" : "device", *kind) + state_text(*kind) + others_text(*kind);
  if (const auto* kind = registry.drive(name)) text += kind_text("drive", *kind);
  if (const auto* kind = registry.controller(name)) text += controller_text(registry, *kind);
  if (const auto* preset = registry.preset(name)) text += preset_text(registry, *preset);
  if (const auto kind = registry.find_measure(name)) text += measure_text(**kind);
  if (const auto* kind = registry.fault(name)) text += kind_text("fault", *kind);
  if (text.find("\n  key ") != std::string::npos) text += k_endings;
  const auto* model = registry.model(name);
  if (model && (with_stage || text.empty()))
    text += (text.empty() ? "" : "\n") + model_text(registry, *model);
  else if (model)
    text += fmt::format("`troupe describe {} --stage` lists the properties in Stage's world files.\n", name);
  return text;
}

/// Returns a list of all kinds as text: one line with name and description for each kind, under a heading for
/// each group.
std::string list_kinds(const Registry& registry) {
  return listed("models", registry.models) + listed("sensors", registry.sensors()) +
         listed("devices", registry.other_devices()) + listed("drives", registry.drives) +
         listed("controllers", registry.controllers) + listed("presets of controllers", registry.presets) +
         listed("measures", registry.measures) + listed("faults", registry.faults) +
         listed("events", engine::event_kinds()) +
         "`troupe describe KIND` lists the parameters of a kind.\n"
         "`troupe describe KEY` describes a key of JSON worlds, such as `populations`.\n";
}

/// Returns a list of the controllers and measures of a script as text, in the same form.
std::string list_script(const Script& script) {
  struct Named {
    std::string name;
    std::string_view text;
  };
  const auto rows = [&](const auto& kinds, auto&& kind_of) {
    std::vector<Named> named;
    for (const auto& each : kinds)
      named.push_back({script.name_in_worlds(kind_of(each).name), kind_of(each).text});
    return named;
  };
  return listed(fmt::format("controllers of {}", script.file.string()),
                rows(
                    script.controllers,
                    [](const Script::Controller& each) -> const auto& { return each.kind; })) +
         listed(fmt::format("measures of {}", script.file.string()),
                rows(
                    script.measures, [](const engine::MeasureKind& each) -> const auto& { return each; }));
}

/// Returns a text that describes the kind or the key of JSON worlds to which `name` refers. If several kinds
/// or keys have this name, such as a model and a sensor, the text describes all of them. A name such as
/// "sensors.ranger" also refers to a kind. Throws InputError if there is no such kind or key, also in
/// plug-ins; the error suggests similar names.
std::string describe_name(const Registry& registry, Plugins& plugins, std::string_view name,
                          bool with_stage) {
  std::string text = kind_description(registry, name, with_stage);
  if (text.empty())
    if (const std::string_view kind = worldio::kind_in_path(registry, name); !kind.empty())
      text = kind_description(registry, kind, with_stage);
  std::string keys;
  for (const worldio::FoundKey& key : worldio::find_keys(registry, name))
    keys += (keys.empty() ? "" : "\n") + key_description(key);
  if (keys.find(" (_") != std::string::npos) keys += fmt::format("\n{}", k_endings);
  if (!text.empty() && !keys.empty()) text += text.ends_with("\n\n") ? "" : "\n";
  text += keys;
  if (!text.empty()) return text;

  // The names of all kinds and keys are not listed: they are long and would come before the suggestion.
  std::vector<std::string_view> known = kind_names(registry);
  const std::vector<std::string> near = worldio::names_near(registry, name);
  known.insert(known.end(), near.begin(), near.end());
  std::string unknown =
      fmt::format("\"{}\" is neither a kind nor a key of JSON worlds{}; `troupe describe` lists all kinds",
                  name, did_you_mean(name, known));
  // The error of a plug-in is more specific. The names of plug-ins contain no separators of keys.
  if (name.find_first_of("./") == name.npos) unknown = plugins.unknown_kind(name, std::move(unknown));
  throw InputError("troupe describe: error: " + unknown);
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

void add_describe_options(CLI::App& command, DescribeOptions& options) {
  add_value(command, "NAME", " ",
            "Kind, such as ranger, or key of JSON worlds, such as populations (default: list all kinds)",
            [&options](const std::string& text) { options.name = text; });
  CLI::Option* const schema = add_switch(command, "--schema", options.schema,
                                         "Print the JSON Schema of worlds, for editors and programs");
  add_switch(command, "--stage", options.stage,
             "Also list the properties that a sensor or device has in Stage's world files");
  add_kind_options(command, options.sources);
  for (const char* other : {"NAME", "--stage", "--plugin-path", "--controller"})  // no part of the schema
    schema->excludes(command.get_option(other));
  command.footer(
      "\nA name of several keys, or of a kind and keys of its parameters, is separated by dots. A JSON "
      "pointer, as in errors, may\nalso be given.\n"
      "\nExamples:\n  troupe describe\n  troupe describe ranger\n  troupe describe populations\n"
      "  troupe describe populations.place\n  troupe describe ranger.transducers.samples\n"
      "  troupe describe /types/bot/sensors/0/range_m\n"
      "  troupe describe follow_wall --plugin-path build\n"
      "  troupe describe my --controller my.py\n  troupe describe --schema > world.schema.json");
}

ExitCode describe(const DescribeOptions& options) {
  if (options.schema) {
    fmt::print("{}", worldio::world_schema(make_registry()));
    return k_finished;
  }
  Registry registry = make_registry();
  const std::shared_ptr<Plugins> plugins =
      add_plugins(registry, plugin_path(options.sources.plugin_path), options.sources.scripts);
  if (!options.name.empty()) {
    fmt::print("{}", describe_name(registry, *plugins, options.name, options.stage));
    return k_finished;
  }
  for (const std::shared_ptr<const Script>& script : options.sources.scripts)
    fmt::print("{}", list_script(*script));
  fmt::print("{}", list_kinds(registry));
  return k_finished;
}

}  // namespace troupe::apps
