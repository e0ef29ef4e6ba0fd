#include "worldio/json/world_document.hpp"

#include "base/math.hpp"
#include "base/number_text.hpp"
#include "base/split.hpp"
#include "engine/spec/ticks.hpp"
#include "engine/spec/watch_spec.hpp"
#include "worldio/images/ros_map.hpp"
#include "worldio/json/document_keys.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/json/json_parts.hpp"
#include "worldio/json/measures_json.hpp"
#include "worldio/json/read_document.hpp"
#include "worldio/json/wall_line.hpp"
#include "worldio/load.hpp"
#include "worldio/window_fields.hpp"

#include <fmt/format.h>

#include <algorithm>

/// Describes the format of JSON worlds: keys, units, limits, meanings, and which keys go together. The
/// reader, the writer and the schema all use this one description. The limits here apply to JSON worlds;
/// engine/spec/spec_description.cpp has those of specs.
namespace troupe::worldio {
namespace {

using namespace engine::facts;
using engine::DeviceKind;
using engine::Registry;
using engine::Unit;
using How = DocumentRule::How;

constexpr Unit meters = Unit::meters;
constexpr Unit seconds = Unit::seconds;

constexpr double k_most_chosen = 1e9;        // maximum number of bodies in a group
constexpr double k_most_in_ring = 10000;     // maximum number of objects of a ring
constexpr double k_most_disc_corners = 100;  // maximum number of corners of a disc
constexpr std::array<std::string_view, 2> k_checks{"error", "warn"};
constexpr std::array<std::string_view, 5> k_rules{"grid", "uniform", "gaussian", "poisson_disc",
                                                  "free_floor"};
constexpr std::string_view k_type_of = "the name of a type, a key of \"types\"";

template <class Kinds>
std::vector<std::string_view> sorted_names(const Kinds& kinds, bool (*counts)(const DeviceKind&) = nullptr) {
  std::vector<std::string_view> names;
  for (const auto& kind : kinds) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(kind)>, DeviceKind>)
      if (counts != nullptr && !counts(kind)) continue;
    names.push_back(kind.name);
  }
  std::ranges::sort(names);
  return names;
}

// ---- kinds

DocumentKind of_device(const DeviceKind& kind) {
  return {.name = kind.name, .text = kind.text, .params = &kind.params, .kind = &kind};
}

enum class DeviceList : std::uint8_t { sensors, devices, both };

template <DeviceList k_list>
bool is_listed(const DeviceKind& kind) {
  return k_list == DeviceList::both || kind.is_sensor() == (k_list == DeviceList::sensors);
}

template <DeviceList k_list>
constexpr std::string_view k_device_word = k_list == DeviceList::sensors ? "sensor" : "device";

template <DeviceList k_list>
std::vector<DocumentKind> all_devices(const Registry& registry) {
  std::vector<DocumentKind> all;
  for (const DeviceKind& kind : registry.devices)
    if (is_listed<k_list>(kind)) all.push_back(of_device(kind));
  return all;
}

template <DeviceList k_list>
std::vector<std::string_view> known_devices(const Registry& registry) {
  return sorted_names(registry.devices, is_listed<k_list>);
}

template <DeviceList k_list>
Result<DocumentKind> find_device(const Registry& registry, const std::string& name) {
  const auto kind =
      registry.find_device(name, unknown_name(k_device_word<k_list>, name, known_devices<k_list>(registry)));
  if (!kind) return kind.error();
  if (is_listed<k_list>(**kind)) return of_device(**kind);
  return Error{fmt::format("\"{}\" {}", name,
                           (*kind)->is_sensor()
                               ? "is a sensor: move this entry to the list \"sensors\""
                               : "is not a sensor: move this entry to the list \"devices\"")};
}

/// Returns the kind of the device that a part itself is. It follows from the model kind of the part, which is
/// the value of its key `kind`: a part of kind "ranger" is a ranger. Empty if the model kind is no device.
std::optional<DocumentKind> implied_device(const Registry& registry, const JsonNode& part) {
  const JsonNode* named = part.find("kind");
  const std::string* name = named ? named->text() : nullptr;
  const engine::ModelKind* model = registry.model(name ? *name : part.find("drive") ? "position" : "model");
  const DeviceKind* kind = model && !model->device.empty() ? registry.device(model->device) : nullptr;
  return kind ? std::optional(of_device(*kind)) : std::nullopt;
}

template <DeviceList k_list>
const DocumentKinds k_devices{.what = k_device_word<k_list>,
                              .page = "extending",
                              .all = all_devices<k_list>,
                              .known = known_devices<k_list>,
                              .named = [](const Registry& registry) { return name_list(registry.devices); },
                              .find = find_device<k_list>,
                              .implied = k_list == DeviceList::both ? implied_device : nullptr};

const DocumentKinds k_drives{
    .what = "drive",
    .all =
        [](const Registry& registry) {
          std::vector<DocumentKind> all;
          for (const engine::DriveKind& kind : registry.drives)
            all.push_back({.name = kind.name, .text = kind.text, .params = &kind.params});
          return all;
        },
    .known = [](const Registry& registry) { return sorted_names(registry.drives); },
    .named = nullptr,
    .find = [](const Registry& registry, const std::string& name) -> Result<DocumentKind> {
      if (const engine::DriveKind* kind = registry.drive(name))
        return DocumentKind{.name = kind->name, .text = kind->text, .params = &kind->params};
      return Error{unknown_name("drive", name, sorted_names(registry.drives))};
    }};

const DocumentKinds k_controllers{
    .what = "controller",
    .page = "controllers",
    .all =
        [](const Registry& registry) {
          std::vector<DocumentKind> all;
          for (const engine::ControllerKind& kind : registry.controllers)
            all.push_back({.name = kind.name, .text = kind.text, .params = &kind.params});
          for (const Registry::Preset& preset : registry.presets)
            if (const engine::ControllerKind* kind = registry.controller(preset.kind))
              all.push_back({.name = preset.name,
                             .text = preset.text,
                             .params = &kind->params,
                             .presets = preset.params,
                             .preset_of = preset.kind});
          return all;
        },
    .known = [](const Registry& registry) { return registry.controller_names(); },
    .named = [](const Registry& registry) { return registry.controller_names(); },
    .find = [](const Registry& registry, const std::string& name) -> Result<DocumentKind> {
      const Registry::Preset* preset = registry.preset(name);
      const auto kind = registry.find_controller(preset ? preset->kind : name);
      if (!kind) return kind.error();
      DocumentKind found{.name = (*kind)->name, .text = (*kind)->text, .params = &(*kind)->params};
      if (preset) found.presets = preset->params;
      return found;
    }};

const DocumentKinds k_measures{
    .what = "measure",
    .page = "measures",
    .all =
        [](const Registry& registry) {
          std::vector<DocumentKind> all;
          for (const engine::MeasureKind& kind : registry.measures)
            all.push_back({.name = kind.name, .text = kind.text, .params = &kind.params});
          return all;
        },
    .known = [](const Registry& registry) { return sorted_names(registry.measures); },
    .named = [](const Registry& registry) { return sorted_names(registry.measures); },
    .find = [](const Registry& registry, const std::string& name) -> Result<DocumentKind> {
      const auto kind = registry.find_measure(name);
      if (!kind) return kind.error();
      return DocumentKind{.name = (*kind)->name, .text = (*kind)->text, .params = &(*kind)->params};
    },
    .expects = "the name of a measure",
    .hint = "the name of a measure"};

// ---- texts that may replace objects

std::string_view trimmed(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

/// Parses a comparison such as `>= 0.9`. Empty if the text is not a comparison.
std::optional<ComparisonDocument> comparison_of(std::string_view text) {
  std::optional<std::size_t> longest;
  for (std::size_t i = 0; i < engine::k_comparisons.size(); ++i)
    if (text.starts_with(engine::k_comparisons[i]) &&
        (!longest || engine::k_comparisons[i].size() > engine::k_comparisons[*longest].size()))
      longest = i;
  if (!longest) return std::nullopt;
  const std::string_view number = trimmed(text.substr(engine::k_comparisons[*longest].size()));
  const std::optional<double> value = finite_number_of(number);
  if (!value) return std::nullopt;
  return ComparisonDocument{static_cast<engine::Comparison>(*longest), *value};
}

JsonNode schema_of_texts(const std::string& pattern) {
  JsonNode::Object object;
  const auto add = [&object](std::string_view key, std::string text) {
    JsonNode node;
    node.value = std::move(text);
    object.push_back({std::string(key), {}, std::move(node)});
  };
  add("type", "string");
  add("pattern", pattern);
  JsonNode schema;
  schema.value = std::move(object);
  return schema;
}

/// Returns the keys of the parameters without a default, in SI units.
std::vector<std::string> required_keys(const engine::FieldTable& params) {
  const engine::Record defaults = params.defaults();
  std::vector<std::string> keys;
  for (std::size_t i = 0; i < defaults.size(); ++i)
    if (!defaults[i].given()) keys.push_back(key_of(params.fields[i]));
  return keys;
}

bool has_defaults(const engine::FieldTable& params) { return required_keys(params).empty(); }

void read_measure_text(const JsonCursor& at, const std::string& text, const Registry& registry,
                       void* object) {
  auto& measure = *static_cast<MeasureDocument*>(object);
  // "stalls:leaders" is a measure and its robots, "crowd:density" may also be a measure of the plug-in crowd.
  std::size_t colon = text.find(':');
  if (colon != text.npos && !registry.find_measure(text.substr(0, colon)))
    if (const std::size_t next = text.find(':', colon + 1); registry.find_measure(text.substr(0, next)))
      colon = next;
  measure.kind = text.substr(0, colon);
  if (colon != text.npos) {
    measure.of = text.substr(colon + 1);
    if (measure.of.empty())
      return at.error(
          fmt::format("\"{}\": expected the name of a type, a population or a robot after the colon", text));
  }
  const auto kind = k_measures.find(registry, measure.kind);
  if (!kind && colon != text.npos && registry.plugged_measures)  // the plug-in may exist
    return at.error(
        registry
            .plugged_measures(text.substr(0, text.find(':', colon + 1)),
                              unknown_name("measure", measure.kind, sorted_names(registry.measures)))
            .error()
            .text);
  if (!kind) return at.error(kind.error().text);
  measure.params = kind->params->defaults();
  if (const std::vector<std::string> keys = required_keys(*kind->params); !keys.empty())
    at.error(fmt::format(
        "the measure \"{}\" has parameters without a default: write {{\"kind\": \"{}\", \"{}\": ...}}",
        kind->name, kind->name, joined(keys, "\": ..., \"")));
}

std::vector<JsonNode> measure_text_schemas(const Registry& registry) {
  JsonNode::List names;
  std::string either;
  for (const engine::MeasureKind& kind : registry.measures) {
    if (!has_defaults(kind.params)) continue;
    names.emplace_back().value = std::string(kind.name);
    either += fmt::format("{}{}", either.empty() ? "" : "|", kind.name);
  }
  JsonNode::Object one_of;
  one_of.push_back({"enum", {}, {}});
  one_of.front().node.value = std::move(names);
  JsonNode plain;
  plain.value = std::move(one_of);
  // The last schema is for measures of plug-ins, whose names are not known.
  return {std::move(plain), schema_of_texts(fmt::format("^({}):.+$", either)),
          schema_of_texts("^[^<>=! ]+$")};
}

const DocumentShorthand k_measure_text{
    .expects = "the name of a measure, or {\"kind\": ..., ...}",
    .read = read_measure_text,
    .write = [](const void*, const Registry&) -> std::optional<std::string> { return std::nullopt; },
    .schemas = measure_text_schemas};

constexpr std::string_view k_condition =
    "a condition on a measure, as in \"coverage >= 0.9\", with one of <, <=, >, >=, ==, != and a number";
constexpr std::string_view k_comparison_pattern = "(<|<=|>|>=|==|!=) *[-+0-9.eE]+ *$";

/// Returns the entries of the world's list `measures` that have a key `name`, each with this name, for the
/// condition at `at`.
std::vector<std::pair<std::string_view, const JsonNode*>> named_measures(const JsonCursor& at) {
  const JsonCursor* world = at.parent() ? at.parent()->parent() : nullptr;
  const JsonNode* measures = world ? world->node().find("measures") : nullptr;
  std::vector<std::pair<std::string_view, const JsonNode*>> named;
  if (!measures || !measures->list()) return named;
  for (const JsonNode& entry : *measures->list())
    if (const JsonNode* name = entry.find("name"); name && name->text())
      named.emplace_back(*name->text(), &entry);
  return named;
}

/// Returns the entry of the world's list `measures` with the key `name`, for the condition at `at`. Returns
/// nothing if there is none, or if `name` is the name of a kind of measure.
std::optional<MeasureDocument> measure_of_world(const JsonCursor& at, const std::string& name,
                                                const Registry& registry) {
  for (const auto& [given, entry] : named_measures(at)) {
    if (given != name) continue;
    if (registry.find_measure(name) || registry.find_measure(name.substr(0, name.find(':')))) break;
    Diagnostics reported;  // errors of the entry are reported where the list `measures` is read
    return read_document<MeasureDocument>(JsonCursor(*entry, reported),
                                          {registry, LoadOptions().most_bodies});
  }
  return std::nullopt;
}

void read_condition_text(const JsonCursor& at, const std::string& text, const Registry& registry,
                         void* object) {
  auto& condition = *static_cast<ConditionDocument*>(object);
  const std::size_t sign = std::min(text.find_first_of("<>=!"), text.size());
  const std::string name(trimmed(std::string_view(text).substr(0, sign)));
  const std::string_view compares = trimmed(std::string_view(text).substr(sign));
  if (compares.empty() || name.empty()) return at.expected(k_condition);
  const std::size_t before = at.diagnostics().findings().size();
  const std::optional<MeasureDocument> listed = measure_of_world(at, name, registry);
  const auto is_kind = [&](const std::string& kind) { return bool(registry.find_measure(kind)); };
  if (!listed && has_error_in(at.diagnostics(), "/measures") && !is_kind(name) &&
      !is_kind(name.substr(0, name.find(':'))))
    return;  // the name may be that of a measure of the world that could not be read
  MeasureDocument& measure = condition.measure.emplace(listed.value_or(MeasureDocument()));
  measure.where = at.where();
  if (!listed) {
    std::vector<std::string_view> names;
    for (const auto& [given, entry] : named_measures(at)) names.push_back(given);
    if (const std::string error = misspelled_measure(name, std::move(names), registry); !error.empty())
      return at.error(error);
    read_measure_text(at, name, registry, &measure);
  }
  if (at.diagnostics().findings().size() > before) return;
  condition.is = read_comparison(at, compares);
}

/// Returns whether read_condition_text() finds the end of this measure in a text, and reads all its
/// characters.
bool fits_condition_text(const MeasureDocument& measure) {
  const std::string& last = measure.of.empty() ? measure.kind : measure.of;
  return (measure.kind + measure.of).find_first_of("<>=!") == std::string::npos &&
         !measure.kind.starts_with(' ') && !last.ends_with(' ');
}

std::optional<std::string> condition_text(const void* object, const Registry& registry) {
  const auto& condition = *static_cast<const ConditionDocument*>(object);
  if (!condition.measure || !condition.is || !condition.measure->name.empty()) return std::nullopt;
  const MeasureDocument& measure = *condition.measure;
  if (!fits_condition_text(measure)) return std::nullopt;
  const auto kind = registry.find_measure(measure.kind);
  const engine::Record defaults = kind ? (*kind)->params.defaults() : engine::Record();
  const auto same = [](const engine::Value& a, const engine::Value& b) { return same_bits(a, b); };
  if (!std::ranges::equal(measure.params, defaults, same)) return std::nullopt;
  return engine::text_of(
      engine::StopSpec{{.kind = measure.kind, .of = measure.of}, condition.is->how, condition.is->with});
}

const DocumentShorthand k_condition_text{
    .expects = k_condition,
    .read = read_condition_text,
    .write = condition_text,
    .schemas =
        [](const Registry&) {
          return std::vector{schema_of_texts(fmt::format("^ *[^<>=!]+{}", k_comparison_pattern))};
        },
    .before_object = true};

// ---- keys that several structs have

template <class T, auto... Path>
void describe_returns(DocumentKeys<T>& d) {
  using engine::Returns;
  d.template value<Path..., &Returns::obstacle>(
      "obstacle", "true: the body blocks other bodies; false: they pass through it");
  d.template value<Path..., &Returns::ranger>(
      "ranger_return", within(-k_most_ranger_return, k_most_ranger_return),
      "intensity that a ranger reads; below 0: beams pass through the body");
  d.template value<Path..., &Returns::fiducial>(
      "fiducial_return", "number that fiducial finders read from the body; 0: they do not find it");
  d.template value<Path..., &Returns::fiducial_key>(
      "fiducial_key", "only fiducial finders whose parameter `key` is this number find the body");
  d.template value<Path..., &Returns::gripper>("gripper_return",
                                               "true: grippers sense the body and can hold it");
  d.template value<Path..., &Returns::blob>("blob_return", "true: blob finders see the colour of the body");
  d.template value<Path..., &Returns::pushable>("pushable",
                                                "true: a robot that drives against the body pushes the whole "
                                                "body instead of stalling (docs/pushing.md)");
}

constexpr std::string_view k_size_text =
    "size [x, y, height] of a box that is centred on the origin of the body, part or device and stands on "
    "z = 0 of its frame; in types and parts with an image or `fit`: the size to which the image or the "
    "blocks are scaled";

/// Returns the value of the key `bitmap`, the path of an image; null if the object has no such text.
const std::string* bitmap_of(const JsonNode& object) {
  const JsonNode* node = object.find("bitmap");
  return node ? node->text() : nullptr;
}
bool has_image(const JsonNode& object) { return object.find("bitmap") != nullptr; }
bool has_map(const JsonNode& object) {
  const std::string* path = bitmap_of(object);
  return path != nullptr && is_ros_map(*path);
}
bool has_plain_image(const JsonNode& object) { return has_image(object) && !has_map(object); }
bool is_fitted(const JsonNode& object) {
  const JsonNode* fit = object.find("fit");
  const bool* x = fit ? std::get_if<bool>(&fit->value) : nullptr;
  return x != nullptr && *x;
}

bool has_no_map(const JsonNode& object) { return !has_map(object); }

bool has_lines(const JsonNode& object) { return object.find("walls_m") != nullptr; }
bool has_no_lines(const JsonNode& object) { return !has_lines(object); }
bool has_height(const JsonNode& object) { return has_map(object) || has_lines(object); }
bool has_scaled_image(const JsonNode& object) { return !has_map(object) && !has_lines(object); }

/// Describes the keys of an image; `text` is the meaning of `bitmap`. `is_plan` says that the objects are
/// floor plans, which have a `bitmap` unless they have the key `walls_m`. In other objects `bitmap` is
/// optional; without it, `size` is the only key of an image that they may have.
template <class T, auto Image>
void describe_image(DocumentKeys<T>& d, std::string_view text, bool is_plan) {
  constexpr std::string_view k_path =
      "the path of an image, or of the YAML file of a ROS map, relative to the world file";
  static constexpr std::array<std::string_view, 2> k_margins{"trim", "keep"};
  static constexpr std::array<std::string_view, 2> k_unknown{"free", "solid"};
  d.template other<Image, &ImageDocument::bitmap>(Form::name, "bitmap", text, k_path);
  DocumentKey& size = d.template value<Image, &ImageDocument::size>(
      "size", meters, above(0), at_most(k_max_size_m),
      is_plan ? "size [x, y, height] to which the image is scaled; required with an image" : k_size_text);
  size.hint = "[x, y, height]";
  size.when(is_plan ? has_scaled_image : has_no_map);
  d.template value<Image, &ImageDocument::height>(
       "height", meters, above(0), at_most(k_max_size_m),
       is_plan ? "with a ROS map or `walls_m`: height of the walls" : "with a ROS map: height of the walls")
      .or_default("1 m")
      .when(is_plan ? has_height : has_map);
  d.template choice<Image, &ImageDocument::unknown>("unknown", k_unknown,
                                                    "with a ROS map: whether unknown cells are free or solid")
      .when(has_map);
  d.template choice<Image, &ImageDocument::margins>(
       "margins", k_margins,
       "the part of the image that is scaled to `size`. trim: the bounding box of the solid pixels; keep: "
       "the whole image")
      .when(is_plan ? has_scaled_image : has_plain_image);
  DocumentKey& boundary = d.template value<Image, &ImageDocument::boundary>(
      "boundary",
      "true: adds four walls, 0.01 m thick, just inside the edges of the scaled image or of the map");
  boundary.when(is_plan ? has_no_lines : has_image);
}

/// Describes the key `ring`, which an entry of a list may have if it has a pose.
template <class T>
void describe_ring(DocumentKeys<T>& d) {
  DocumentKey& key = d.template other<>(
      Form::object, "ring", "replaces this entry by several copies on a circle around its position");
  key.table = &document_table<RingDocument>;
  key.resolve();
}

/// Reports an error if the object `at` needs a size (`is_needed`) and has none. Fitted blocks and images need
/// one, but ROS maps do not.
void check_size(const ImageDocument& image, bool is_needed, const JsonCursor& at) {
  if (is_needed && at.node().object() && !has_map(at.node()) && !image.size) {
    const DocumentTable& table = document_table<PartDocument>();
    const engine::Field& field = table.find("size")->field;
    for (const JsonMember& member : *at.node().object())
      if (is_spelled(field, member.key))
        return;  // the size is there, but wrong: an error was already reported
    at.error(fmt::format("missing {}: {}", quoted_keys(field), table.find("size")->hint));
  }
}

bool moves_joints(const void* kind) { return !static_cast<const DeviceKind*>(kind)->joints.empty(); }
bool shows_blocks(const void* kind) {
  return moves_joints(kind) && !static_cast<const DeviceKind*>(kind)->body;
}

template <class D>
void describe_device(DocumentKeys<D>& d, std::string_view word, bool is_own) {
  const auto kind = [&] {
    DocumentKey& key = d.template other<&D::kind>(Form::kind, "kind");
    if (!is_own) key.require();
  };
  const auto joint = [&] {
    d.template other<&D::joint>(Form::joint, "joint",
                                "name of the joint that moves the device; null: no joint moves it; `joint` "
                                "does not change the frame of `pose`")
        .or_default("the joint that moves the part on which the device is mounted");
  };
  if (is_own) kind();
  d.template other<&D::name>(Form::name, "name", "name of the device; unique within the type",
                             is_own             ? "the device's name"
                             : word == "sensor" ? "the sensor's name"
                                                : "the device's name")
      .or_default(is_own ? "the name of the part" : "KIND:0, KIND:1, ...");
  if (!is_own) kind();
  d.template value<&D::pose>(
      "pose", "pose in the frame of the body or, with `on`, in the frame of the device that `on` names");
  joint();
  if (!is_own) describe_ring(d);
  d.template value<&D::active>("active",
                               "false: the device runs only while a controller or a program reads it");
  d.template value<&D::period>("period", seconds, within(0, k_most_period_s),
                               "time between two updates of the device; 0: every tick")
      .or_named("update_period");
  d.template other<&D::params>(Form::parameters, "");
  d.template no_key<&D::is_kind_implied>();  // is_kind_implied: the writer sets it
  if (is_own) {
    d.template no_key<&D::on, &D::color, &D::returns, &D::size, &D::blocks>();  // those of the part are used
    return;
  }
  d.template other<&D::on>(Form::name, "on",
                           "name of the actuator or `wheels` on which this device is mounted and with which "
                           "it moves (docs/gripping.md); in `devices`, that device must come before this one",
                           "the name of a device with a joint");
  const std::size_t shown = d.table().keys.size();
  d.template other<&D::color>(Form::color, "color", "colour of the solids of the device")
      .or_default("that of the body");
  describe_returns<D, &D::returns>(d);
  for (std::size_t i = shown; i < d.table().keys.size(); ++i) d.table().keys[i].of_kind(moves_joints);
  d.template value<&D::size>("size", meters, above(0), at_most(k_max_size_m), k_size_text)
      .of_kind(shows_blocks);
  d.template list<&D::blocks>("blocks", "the solids that the device moves, in its frame")
      .of_kind(shows_blocks);
}

template <class G>
void describe_group(DocumentKeys<G>& d) {
  d.template other<&G::population>(Form::name, "population", "all bodies of this population", "a name");
  d.template other<&G::type>(Form::name, "type", "all bodies of this type", "a name");
  d.template other<&G::model>(Form::name, "model", "the body of this name", "a name");
  d.template value<&G::count>("count", within(0, k_most_chosen),
                              "number of bodies to select at random from the group; all of them if the group "
                              "has fewer")
      .or_default("all bodies of the group");
  d.template value<&G::share>("share", within(0, 1),
                              "instead of `count`: fraction of the group to select at random");
  constexpr std::string_view k_whom = "give exactly one of \"population\", \"type\" and \"model\"";
  d.rule({.how = How::one_of,
          .keys = {"population", "type", "model"},
          .none = std::string(k_whom),
          .several = fmt::format("{}, not several", k_whom)});
  d.rule(
      {.how = How::not_both, .keys = {"count", "share"}, .several = "give \"count\" or \"share\", not both"});
}

template <class T, auto... Path>
void describe_experiment(DocumentKeys<T>& d) {
  d.template list<Path..., &ExperimentDocument::stop_when>(
      "stop_when",
      "conditions on measures, which are numbers computed from the state: the run ends with the first tick "
      "after which one of them holds "
      "(docs/experiments.md)");
  d.template list<Path..., &ExperimentDocument::at>("at",
                                                    "interventions, which are changes to the world at given "
                                                    "times");
  d.template list<Path..., &ExperimentDocument::faults>("faults", "failures of robots");
}

template <class P>
void describe_body(DocumentKeys<P>& d) {
  describe_image<P, &P::image>(
      d, "path of an image, or of the YAML file of a ROS map, relative to the world file", false);
  const auto no_image = [](const JsonNode& object) { return !has_image(object); };
  d.template value<&P::fit>("fit", "true: all blocks together are scaled to fill the box `size`, as in Stage")
      .when(no_image);
  d.template value<&P::origin>("origin",
                               "pose, in the frame of the body or part, of the centre of the scaled part of "
                               "the image (`margins`) or of the "
                               "scaled blocks; with a ROS map: of the map frame")
      .when([](const JsonNode& object) { return has_image(object) || is_fitted(object); });
  d.template object<&P::disc>(
       "disc", "an upright cylinder about the origin of the body or part, in addition to the blocks")
      .when([](const JsonNode& object) { return !has_image(object) && !is_fitted(object); });
  d.template list<&P::blocks>("blocks", "upright prisms that form the solid shape of the body or part")
      .when(no_image);
  d.template value<&P::floor_plan>(
       "floor_plan",
       "true: the shape is that of walls; `troupe lint`, and controllers that plan paths, then treat the "
       "body as a floor plan")
      .or_default("true with `bitmap`");
  d.template value<&P::extent>(
      "extent", meters, within(0, 2 * k_max_size_m),
      "size [x, y, height] that fiducial finders report and controllers read, if it differs from the extent "
      "of the solids");
  d.template other<&P::color>(Form::color, "color",
                              std::is_same_v<P, TypeDocument> ? "colour of the bodies" : "colour of the part")
      .or_default(std::is_same_v<P, TypeDocument>
                      ? "a colour of the default palette; dark grey for types such as walls"
                      : "that of the body");
  describe_returns<P, &P::returns>(d);
}

template <class P>
void describe_contents(DocumentKeys<P>& d) {
  d.template object<&P::device>("device", "makes the body or the part itself a device, such as an actuator");
  d.template list<&P::sensors>("sensors", "devices that only observe the world");
  d.template list<&P::devices>("devices", "devices that act, by themselves or on command");
  d.template object<&P::controller>("controller", "the only controller of the body or part");
  d.template list<&P::controllers>("controllers", "several controllers, instead of `controller`");
  d.template list<&P::parts>("parts", "parts that are mounted on this body or part");
  d.rule({.how = How::not_both,
          .keys = {"controller", "controllers"},
          .several = "give \"controller\" or \"controllers\", not both",
          .at_key = true});
}

void check_part(const PartDocument& part, const JsonCursor& at) {
  check_size(part.image, has_image(at.node()) || is_fitted(at.node()), at);
}
void check_type(const TypeDocument& type, const JsonCursor& at) { check_part(type, at); }

void check_floorplan(const FloorplanDocument& plan, const JsonCursor& at) {
  if (!has_lines(at.node())) return check_size(plan.image, has_image(at.node()), at);
  if (!plan.walls || plan.walls->empty()) return;
  if (const Result<> line = check_wall_line(*plan.walls, plan.thickness); !line)
    JsonCursor(at, "walls_m", *at.node().find("walls_m")).error(line.error().text);
}

void check_block(const BlockDocument& block, const JsonCursor& at) {
  if (!block.z) return;
  const auto [low, high] = *block.z;
  if (low > high || (block.points && low == high))
    at.error(
        fmt::format("\"z_m\" must be [min, max] with min below max, found {:.10g} and {:.10g}", low, high));
  if (!block.points || block.points->empty()) return;
  if (const Result<> outline = check_outline(*block.points); !outline)
    JsonCursor(at, "points_m", *at.node().find("points_m")).error(outline.error().text);
}

/// Checks the name of the column that a measure has in tables of results. Only letters, digits and the
/// characters _ - . : are allowed, because the name is part of the header of CSV tables and users type it.
void check_measure(const MeasureDocument& measure, const JsonCursor& at) {
  constexpr std::string_view k_allowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.:";
  if (measure.name.find_first_not_of(k_allowed) == measure.name.npos) return;
  JsonCursor(at, "name", *at.node().find("name"))
      .error(fmt::format("\"{}\" is not a column name: only letters, digits and _ - . : are allowed",
                         measure.name));
}

void check_place(const PlaceDocument& place, const JsonCursor& at) {
  if (!place.polygon || place.polygon->empty()) return;
  if (const Result<> outline = check_outline(*place.polygon); !outline)
    JsonCursor(at, "polygon_m", *at.node().find("polygon_m")).error(outline.error().text);
}

void check_add(const AddDocument& add, const JsonCursor& at) {
  if (add.pose && at.node().find("region_m")) at.error("give \"pose\" or \"region_m\", not both");
}

void check_model(const ModelDocument& model, const JsonCursor& at) {
  if (model.fiducial_return == 0)
    JsonCursor(at, "fiducial_return", *at.node().find("fiducial_return"))
        .error("must not be 0: give the model a type without \"fiducial_return\" instead");
}

}  // namespace

std::optional<ComparisonDocument> read_comparison(const JsonCursor& at, std::string_view text) {
  const auto comparison = comparison_of(trimmed(text));
  if (!comparison)
    at.error(fmt::format("\"{}\" is not a comparison: expected one of <, <=, >, >=, ==, != and a number",
                         trimmed(text)));
  return comparison;
}

std::string comparison_pattern() { return fmt::format("^ *{}", k_comparison_pattern); }

bool Placed::says(std::string_view key) const {
  return std::ranges::find(keys, key, &Key::name) != keys.end();
}

Where Placed::where_of(std::string_view key) const {
  const auto found = std::ranges::find(keys, key, &Key::name);
  return found == keys.end() ? where : found->where;
}

void BlockDocument::describe(DocumentKeys<BlockDocument>& d) {
  static constexpr std::array<std::string_view, 2> k_frames{"part", "body"};
  d.table().definition = "block";
  d.other<&BlockDocument::points>(Form::points, "points_m",
                                  "outline of the prism, which must not cross itself")
      .entries(3, k_most_block_points);
  d.other<&BlockDocument::contours>(Form::contours, "contours_m",
                                    "outlines; points inside an odd number of them are solid")
      .entries(3);
  d.value<&BlockDocument::z>("z", meters, within(-k_max_size_m, k_max_size_m),
                             "heights of the bottom and the top of the prism")
      .require("the heights of the bottom and the top of the prism, [min, max]");
  d.choice<&BlockDocument::frame>("frame", k_frames, "frame of the points: that of the part or of the body");
  d.rule({.how = How::one_of,
          .keys = {"points_m", "contours_m"},
          .none = "missing \"points_m\": the outline, [[x, y], ...] (or \"contours_m\", a list of outlines)",
          .several = "give \"points_m\" or \"contours_m\", not both",
          .at_key = true});
  d.check<check_block>();
}

void RingDocument::describe(DocumentKeys<RingDocument>& d) {
  d.table().definition = "ring";
  d.value<&RingDocument::count>("count", within(1, k_most_in_ring), "number of copies").require();
  d.value<&RingDocument::radius>("radius", meters, within(0, k_max_size_m),
                                 "radius of the circle on which the copies are placed");
  d.value<&RingDocument::start>(
      "start", Unit::radians, within(-20 * k_pi, 20 * k_pi),
      "direction from the centre of the circle to the first copy, counter-clockwise from the heading of the "
      "pose of the entry");
}

void DiscDocument::describe(DocumentKeys<DiscDocument>& d) {
  d.table().definition = "disc";
  d.value<&DiscDocument::radius>("radius", meters, above(0), at_most(k_max_size_m),
                                 "distance from the axis of the cylinder to the corners of its polygon")
      .require();
  d.value<&DiscDocument::height>("height", meters, above(0), at_most(k_max_size_m), "height of the cylinder")
      .require();
  d.value<&DiscDocument::corners>(
      "corners", within(3, k_most_disc_corners),
      "number of corners of the polygon that replaces the circle; the first corner is on the x axis");
}

void DeviceDocument::describe(DocumentKeys<DeviceDocument>& d) {
  d.table().definition = "device";
  d.table().kinds = &k_devices<DeviceList::devices>;
  describe_device(d, "device", false);
}

void SensorDocument::describe(DocumentKeys<SensorDocument>& d) {
  d.table().definition = "sensor";
  d.table().kinds = &k_devices<DeviceList::sensors>;
  describe_device(d, "sensor", false);
}

void OwnDeviceDocument::describe(DocumentKeys<OwnDeviceDocument>& d) {
  d.table().definition = "own_device";
  d.table().kinds = &k_devices<DeviceList::both>;
  d.table().is_kind_implied = [](const void* object) {
    return static_cast<const OwnDeviceDocument*>(object)->is_kind_implied;
  };
  describe_device(d, "device", true);
}

void DriveDocument::describe(DocumentKeys<DriveDocument>& d) {
  d.table().definition = "drive";
  d.table().kinds = &k_drives;
  d.other<&DriveDocument::kind>(Form::kind, "kind").require();
  d.value<&DriveDocument::period>("period", seconds, within(0, k_most_period_s),
                                  "time between two commands that the drive accepts; 0: every tick")
      .or_named("update_period");
  d.other<&DriveDocument::params>(Form::parameters, "");
}

void ControllerDocument::describe(DocumentKeys<ControllerDocument>& d) {
  d.table().definition = "controller";
  d.table().kinds = &k_controllers;
  d.other<&ControllerDocument::kind>(Form::kind, "kind").require();
  d.value<&ControllerDocument::period>(
       "period", seconds, within(0, k_most_period_s),
       "time between two calls of a controller that uses no device, in a type without a drive; 0: every tick")
      .or_named("update_period");
  d.other<&ControllerDocument::params>(Form::parameters, "");
}

void PartDocument::describe(DocumentKeys<PartDocument>& d) {
  d.table().definition = "part";
  d.other<&PartDocument::name>(
       Form::name, "name",
       "name of the part; programs find the part by the name BODY.NAME, where BODY is the name of its body",
       "the part's name")
      .require("the part's name");
  d.other<&PartDocument::alias>(Form::name, "alias",
                                "another name of the part; programs also find it by BODY.ALIAS",
                                "another name of the part");
  d.other<&PartDocument::kind>(Form::model_kind, "kind", "model type of Stage that corresponds to the part")
      .or_default("\"model\"");
  d.value<&PartDocument::pose>("pose", "pose in the frame of the body, with all joints at rest");
  d.other<&PartDocument::joint>(Form::joint, "joint",
                                "name of the joint that moves the part; null: no joint moves it")
      .or_default("the joint that moves the body or part on which the part is mounted");
  describe_ring(d);
  describe_body(d);
  describe_contents(d);
  d.check<check_part>();
}

void TypeDocument::describe(DocumentKeys<TypeDocument>& d) {
  d.table().definition = "type";
  d.other<>(
       Form::name, "extends",
       "name of another type, whose keys this type inherits; a key that this type has itself replaces the "
       "inherited key")
      .resolve();
  d.other<&TypeDocument::name>(
       Form::name, "name",
       "name of the type, if it differs from the key; several types may have the same name",
       "the name of the type")
      .or_default("the key of the type");
  d.other<&TypeDocument::kind>(Form::model_kind, "kind",
                               "model type of Stage that corresponds to the body itself, without its parts")
      .or_default("\"position\" with a drive, else \"model\"");
  d.no_key<&TypeDocument::alias, &TypeDocument::pose, &TypeDocument::joint>();  // keys of other parts only
  describe_body(d);
  d.object<&TypeDocument::drive>(
      "drive", "the drive of the bodies; without a drive, the bodies do not move by themselves");
  describe_contents(d);
  d.other<&TypeDocument::device_order>(
       Form::names, "device_order",
       "names of all devices of the type, each exactly once, in the order in which controllers choose among "
       "them",
       "the name of a device")
      .or_default("the order in the file");
  d.rule({.how = How::any_of,
          .keys = {"size", "disc", "blocks", "bitmap", "device"},
          .none = "the type has no shape: give \"size_m\" (a box), \"disc\", \"blocks\", \"bitmap\" or "
                  "\"device\""});
  d.check<check_type>();
}

void FloorplanDocument::describe(DocumentKeys<FloorplanDocument>& d) {
  d.other<&FloorplanDocument::name>(Form::name, "name", "name of the body and of its type", "a name")
      .require("the floor plan's name");
  describe_image<FloorplanDocument, &FloorplanDocument::image>(
      d,
      "path, relative to the world file, of an image (PNG, JPEG, BMP, PBM, PGM or PPM; pixels whose "
      "first channel is at most 127 are solid) or of the YAML file of a ROS map; required without `walls_m`",
      true);
  d.other<&FloorplanDocument::walls>(
       Form::points, "walls_m",
       "instead of an image: points of the line along the middle of the walls, in "
       "the frame of `pose`; the line is closed if its last point repeats its "
       "first")
      .entries(2, k_most_block_points);
  d.value<&FloorplanDocument::thickness>("thickness", meters, above(0), at_most(k_max_size_m),
                                         "with `walls_m`: thickness of the walls")
      .when(has_lines);
  d.rule({.how = How::one_of,
          .keys = {"bitmap", "walls_m"},
          .none = fmt::format(
              "a floor plan needs \"bitmap\" ({}) or \"walls_m\" (points [[x, y], ...] of a line of walls)",
              d.table().find("bitmap")->expects),
          .several = "give \"bitmap\" or \"walls_m\", not both",
          .at_key = true});
  d.value<&FloorplanDocument::pose>(
      "pose",
      "pose of the centre of the scaled part of the image (`margins`); with a ROS "
      "map: of the map frame; with `walls_m`: of the frame of its points");
  d.other<&FloorplanDocument::color>(Form::color, "color", "colour of the walls")
      .or_default("[0.3, 0.3, 0.3]");
  describe_returns<FloorplanDocument, &FloorplanDocument::returns>(d);
  d.check<check_floorplan>();
}

void ArenaDocument::describe(DocumentKeys<ArenaDocument>& d) {
  d.value<&ArenaDocument::size>("size", meters, above(0), at_most(k_max_size_m),
                                "size of the free floor along x and y; its centre is the origin of the world")
      .require("[x, y], the size of the free floor");
  d.value<&ArenaDocument::walls>(
      "walls",
      "true: a static body `arena` encloses the free floor; false: the arena has no walls, "
      "and only sets the bounds");
  d.value<&ArenaDocument::height>("height", meters, above(0), at_most(k_max_size_m), "height of the walls");
  d.value<&ArenaDocument::thickness>("thickness", meters, above(0), at_most(k_max_size_m),
                                     "thickness of the walls, which are outside the free floor");
  d.other<&ArenaDocument::color>(Form::color, "color", "colour of the walls").or_default("[0.3, 0.3, 0.3]");
}

void ModelDocument::describe(DocumentKeys<ModelDocument>& d) {
  d.other<&ModelDocument::name>(Form::name, "name", "name of the body", "a name").require("the model's name");
  d.other<&ModelDocument::alias>(Form::name, "alias", "another name, by which programs can find the body",
                                 "another name of the model");
  d.other<&ModelDocument::type>(Form::name, "type", "the name of one of the types", k_type_of)
      .require(k_type_of);
  d.other<&ModelDocument::reserve_of>(
      Form::name, "reserve_of",
      "name of a population: the body does not exist at the start and may be born into that population later "
      "(docs/lives.md); `troupe convert` writes the `reserve` of a population in this way. The models of a "
      "reserve must follow one another and have the same type",
      "the name of a population");
  d.value<&ModelDocument::pose>("pose", "pose of the body in the world frame").write_always();
  d.other<&ModelDocument::color>(Form::color, "color", "colour of the body").or_default("that of its type");
  d.value<&ModelDocument::fiducial_return>(
       "fiducial_return",
       "number that fiducial finders read from this body; its type must have "
       "a `fiducial_return` too")
      .or_default("that of its type");
  d.other<&ModelDocument::global_parts>(
      Form::names, "global_parts", "names of parts that programs can look up without the name of the body",
      "the name of a part");
  d.check<check_model>();
}

void PlaceDocument::describe(DocumentKeys<PlaceDocument>& d) {
  using Rule = engine::PlacementRule::Kind;
  constexpr auto bit = [](Rule one) { return 1u << static_cast<unsigned>(one); };
  d.table().variant = "rule";
  d.choice<&PlaceDocument::rule>("rule", k_rules, "rule by which the bodies are placed")
      .require("grid, uniform, gaussian, poisson_disc or free_floor");
  d.other<&PlaceDocument::region>(Form::box, "region_m", "rectangle in which the origins of the bodies lie")
      .or_default("the bounding box of `polygon_m`, else the bounds of the world");
  d.other<&PlaceDocument::polygon>(
       Form::points, "polygon_m",
       "polygon in which the origins of the bodies lie; it must not cross itself; with `region_m`, the "
       "origins lie in both")
      .entries(3, k_most_block_points);
  d.other<&PlaceDocument::spill>(Form::box, "spill_m",
                                 "second rectangle, for bodies that do not fit into `region_m`")
      .of_variants(bit(Rule::grid));
  d.value<&PlaceDocument::pitch>("pitch", meters, above(0), at_most(k_max_size_m),
                                 "distance between neighbouring cells of the grid")
      .require("the distance between neighbouring cells of the grid")
      .of_variants(bit(Rule::grid));
  d.value<&PlaceDocument::jitter>("jitter", meters, within(0, k_max_size_m),
                                  "maximum random displacement of a body, along x and along y")
      .of_variants(bit(Rule::grid));
  d.value<&PlaceDocument::mean>("mean", meters, within(-k_max_size_m, k_max_size_m),
                                "mean of the normal distribution of the origins")
      .require("[x, y], the mean of the normal distribution")
      .of_variants(bit(Rule::gaussian));
  d.value<&PlaceDocument::deviation>("deviation", meters, within(0, k_max_size_m),
                                     "standard deviations along x and y")
      .require("[x, y], the standard deviations")
      .of_variants(bit(Rule::gaussian));
  d.value<&PlaceDocument::distance>("distance", meters,
                                    within(engine::k_least_placement_step_m, k_max_size_m),
                                    "minimum distance between the origins of two bodies")
      .require("the minimum distance between the origins of two bodies")
      .of_variants(bit(Rule::poisson_disc));
  d.value<&PlaceDocument::from>("from", meters, within(-k_max_size_m, k_max_size_m),
                                "bodies are placed only on floor that can be reached from this point")
      .or_default("a point of the largest connected floor area")
      .of_variants(bit(Rule::free_floor));
  d.value<&PlaceDocument::cell>("cell", meters, within(engine::k_least_placement_step_m, k_max_size_m),
                                "cell size of the search for reachable floor")
      .or_default("half of the body's radius, at least 0.02 m")
      .of_variants(bit(Rule::free_floor));
  d.other<&PlaceDocument::heading>(Form::heading, "heading", "heading of each body")
      .or_default("grid: 0; other rules: random");
  d.value<&PlaceDocument::z>("z", meters, within(-k_max_size_m, k_max_size_m), "height of the origins");
  d.check<check_place>();
}

void PopulationDocument::describe(DocumentKeys<PopulationDocument>& d) {
  d.other<&PopulationDocument::name>(
       Form::name, "name", "name of the population; its bodies are called NAME0, NAME1, ...", "a name")
      .require("the population's name");
  d.other<&PopulationDocument::type>(Form::name, "type", "the name of one of the types", k_type_of)
      .require(k_type_of);
  DocumentKey& count = d.value<&PopulationDocument::count>(
      "count", within(0, LoadOptions().most_bodies),
      "number of bodies; if it is 0, interventions, faults and measures may still "
      "name the population, and then act on no body");
  count.require("number of bodies").counts_bodies = true;
  d.value<&PopulationDocument::reserve>(
       "reserve", within(0, LoadOptions().most_bodies),
       "number of further bodies that may be born during the run (docs/lives.md)")
      .counts_bodies = true;
  d.other<&PopulationDocument::color>(Form::color_or_random, "color",
                                      "colour of all bodies; \"random\": each body has a random colour, "
                                      "which depends only on the seed and the "
                                      "body")
      .or_default("that of the type");
  d.object<&PopulationDocument::place>("place", "how the bodies are placed")
      .require("{\"rule\": ..., \"region_m\": ...}");
}

void MeasureDocument::describe(DocumentKeys<MeasureDocument>& d) {
  d.table().kinds = &k_measures;
  d.table().shorthand = &k_measure_text;
  d.other<&MeasureDocument::kind>(Form::kind, "kind").require();
  d.other<&MeasureDocument::of>(Form::name, "of", "name of the type, population or robot that is measured",
                                "the name of a type, a population or a robot")
      .or_default("all robots");
  d.other<&MeasureDocument::name>(Form::name, "name",
                                  "name of the column in the table of results, without its unit",
                                  "the name of the column")
      .or_default("KIND or KIND:OF");
  d.other<&MeasureDocument::params>(Form::parameters, "");
  d.check<check_measure>();
}

void ConditionDocument::describe(DocumentKeys<ConditionDocument>& d) {
  d.table().shorthand = &k_condition_text;
  d.object<&ConditionDocument::measure>("measure", "the measure whose value is compared")
      .require("the name of a measure, or {\"kind\": ..., ...}");
  d.other<&ConditionDocument::is>(Form::comparison, "is", "the comparison that must hold",
                                  "a comparison, as in \">= 0.9\"")
      .require("a comparison, as in \">= 0.9\"");
}

void GroupDocument::describe(DocumentKeys<GroupDocument>& d) {
  d.table().definition = "group";
  describe_group(d);
}

void AddDocument::describe(DocumentKeys<AddDocument>& d) {
  d.other<&AddDocument::population>(Form::name, "population", "name of a population with a reserve of bodies",
                                    "a name")
      .require();
  d.value<&AddDocument::count>("count", within(0, k_most_chosen), "number of births")
      .or_default("all bodies that remain in the reserve");
  d.value<&AddDocument::pose>("pose", "pose of each new body in the world frame")
      .or_default("a random pose at the height of the population, the `z_m` of its `place`")
      .write_always();
  d.other<&AddDocument::region>(Form::box, "region_m", "instead of `pose`: region of random poses")
      .or_default("the bounds of the world");
  d.check<check_add>();
}

void MoveDocument::describe(DocumentKeys<MoveDocument>& d) {
  d.other<&MoveDocument::model>(Form::name, "model", "name of the body", "a name")
      .require("the name of a body");
  d.value<&MoveDocument::pose>("pose", "new pose, in the world frame").require("the new pose").write_always();
}

void SettingDocument::describe(DocumentKeys<SettingDocument>& d) {
  d.other<&SettingDocument::type>(Form::name, "type", "the name of one of the types", k_type_of)
      .require(k_type_of);
  d.other<&SettingDocument::drive>(Form::kept, "drive", "new values of parameters of the drive");
  d.other<&SettingDocument::device>(Form::kept, "device",
                                    "`name` of a device, and new values of its parameters", "name");
  d.other<&SettingDocument::controller>(Form::kept, "controller",
                                        "`kind` of a controller, and new values of its parameters", "kind");
  d.rule({.how = How::one_of,
          .keys = {"drive", "device", "controller"},
          .none = "give exactly one of \"drive\", \"device\" and \"controller\""});
}

void InterventionDocument::describe(DocumentKeys<InterventionDocument>& d) {
  d.value<&InterventionDocument::time>("time", seconds, within(0, engine::k_most_seconds),
                                       "simulated time of the intervention, rounded up to the end of a tick")
      .require();
  d.object<&InterventionDocument::remove>("remove",
                                          "removes bodies from the world: they die (docs/lives.md)");
  d.object<&InterventionDocument::add>("add", "bodies from the reserve of a population are born");
  d.object<&InterventionDocument::disable>("disable", "stops the drives, controllers and devices of bodies");
  d.object<&InterventionDocument::enable>(
      "enable", "starts the drives, controllers and devices of disabled bodies again");
  d.object<&InterventionDocument::move>("move", "moves a body to a pose");
  d.object<&InterventionDocument::set>("set", "changes parameters for all bodies of a type");
  d.rule({.how = How::one_of,
          .keys = {engine::k_actions.begin(), engine::k_actions.end()},
          .none = fmt::format("the entry has no action: give one of {}", comma_list(engine::k_actions)),
          .several = "the entry has several actions: give each action an entry of its own",
          .at_key = true});
}

void FaultDocument::describe(DocumentKeys<FaultDocument>& d) {
  describe_group(d);
  d.value<&FaultDocument::from>("from", seconds, within(0, engine::k_most_seconds),
                                "earliest simulated time at which a fault occurs");
  d.other<&FaultDocument::impairments>(Form::faults, "");
}

void ExperimentDocument::describe(DocumentKeys<ExperimentDocument>& d) { describe_experiment(d); }

void RecordDocument::describe(DocumentKeys<RecordDocument>& d) {
  d.other<&RecordDocument::file>(
      Form::name, "file",
      "file that `troupe run` writes, in or below the working folder; without it, a "
      "run records only if `--record` names a file",
      "the name of a file");
  d.value<&RecordDocument::every>("every", seconds, above(0), at_most(engine::k_most_seconds),
                                  "simulated time between frames; `--record-every` overrides it")
      .or_default("0.1 s");
  d.other<&RecordDocument::fields>(
       Form::names, "fields",
       "fields of the state to record (docs/recordings.md); `--record-fields` overrides it",
       "the name of a field")
      .or_default("[\"pose\"]")
      .entries(1);
}

void GroundDocument::describe(DocumentKeys<GroundDocument>& d) {
  d.other<&GroundDocument::alias>(Form::name, "alias",
                                  "another name of the ground, in addition to `_ground_model`",
                                  "another name of the ground")
      .require();
}

void WorldDocument::describe(DocumentKeys<WorldDocument>& d) {
  d.no_key<&WorldDocument::files>();  // the reader sets it
  d.other<&WorldDocument::schema>(Form::name, "$schema", "path of the JSON Schema, for editors",
                                  "the path of the JSON Schema");
  static const std::string version = fmt::format("{}, the version of the format", k_format_version);
  d.other<>(Form::version, "troupe", "the version of the format").require(version);
  d.other<&WorldDocument::title>(
       Form::name, "title", "title of the world, shown in summaries and on replay pages", "the world's title")
      .or_default("the file's name without its ending");
  d.other<&WorldDocument::seed>(Form::seed, "seed", "seed of all random numbers; `--seed` overrides it");
  d.value<&WorldDocument::tick>("tick", seconds, within(k_least_tick_s, k_most_tick_s),
                                "length of a tick, which is one simulation step")
      .write_always();
  d.value<&WorldDocument::quit_time>("quit_time", seconds, above(0), at_most(engine::k_most_seconds),
                                     "simulated time at which a run ends; `--for` overrides it");
  d.value<&WorldDocument::measure_every>(
      "measure_every", seconds, within(0, engine::k_most_seconds),
      "simulated time between measurements; 0: every tick; `--measure-every` overrides it");
  d.choice<&WorldDocument::ranging>(
      "ranging", engine::k_ranging_engines,
      "engine that computes ranges (docs/sensing.md); `--raytracer` overrides it");
  d.value<&WorldDocument::resolution>(
      "resolution", meters, within(engine::k_min_resolution_m, engine::k_max_resolution_m),
      used_if("ranging", "grid"),
      "edge length of the cells of the grid engine; without effect on the exact engine");
  d.other<&WorldDocument::bounds>(Form::box, "bounds_m", "rectangle that robots may not leave")
      .or_default("the bounding box of the floor plans and the arena");
  d.object<&WorldDocument::ground>("ground");
  d.object<&WorldDocument::record>("record",
                                   "the recording of a run: its file, the time between frames, and the "
                                   "fields of the state that it contains");
  d.other<&WorldDocument::watch>(
       Form::block, "watch",
       "the speed of a run, whether it prints the simulated time, and whether Stage's window starts paused")
      .or_default("the defaults of its keys")
      .block = &engine::watch_fields();
  d.other<&WorldDocument::window>(Form::block, "window", "the view of `--camera window`").block =
      &window_fields();
  d.value<&WorldDocument::mortal>(
      "mortal",
      "true: programs that use Troupe as a library may remove and disable bodies; "
      "false: they may do so only in worlds with reserves, faults or other causes "
      "of removing or disabling (docs/lives.md)");
  d.value<&WorldDocument::contacts>(
      "contacts",
      "true: the state has the component `contact`, which says what blocked each body in the last tick, also "
      "if no controller reads it (docs/driving.md#who-blocked-whom)");
  d.choice<&WorldDocument::overlaps>(
      "overlaps", k_checks,
      "whether a model that overlaps another body at the start is an error or a warning");
  d.choice<&WorldDocument::same_names>("same_names", k_checks,
                                       "whether two bodies of the same name are an error or a warning; with "
                                       "\"warn\", a search by this name finds the last of them");
  d.list<&WorldDocument::floorplans>("floorplans", "walls, given as images, ROS maps or lines");
  d.object<&WorldDocument::arena>(
      "arena", "a rectangular floor, enclosed by four walls unless `walls` of the arena is false");
  d.other<>(Form::names, "include", "files with further types for this world", "the name of a file")
      .resolve();
  d.map<&WorldDocument::types>("types", "the properties that bodies of one type share").write_always();
  d.list<&WorldDocument::models>("models", "single bodies").write_always();
  d.list<&WorldDocument::populations>("populations", "groups of many bodies of one type, placed by a rule");
  d.list<&WorldDocument::measures>(
       "measures",
       "the measures that `troupe run --measures` computes (docs/measures.md); `--measure` overrides them")
      .entries(1)
      .or_default("all measures that need no parameters");
  describe_experiment<WorldDocument, &WorldDocument::experiment>(d);
}

template const DocumentTable& document_table<BlockDocument>();
template const DocumentTable& document_table<RingDocument>();
template const DocumentTable& document_table<DiscDocument>();
template const DocumentTable& document_table<DeviceDocument>();
template const DocumentTable& document_table<SensorDocument>();
template const DocumentTable& document_table<OwnDeviceDocument>();
template const DocumentTable& document_table<DriveDocument>();
template const DocumentTable& document_table<ControllerDocument>();
template const DocumentTable& document_table<PartDocument>();
template const DocumentTable& document_table<TypeDocument>();
template const DocumentTable& document_table<FloorplanDocument>();
template const DocumentTable& document_table<ArenaDocument>();
template const DocumentTable& document_table<ModelDocument>();
template const DocumentTable& document_table<PlaceDocument>();
template const DocumentTable& document_table<PopulationDocument>();
template const DocumentTable& document_table<MeasureDocument>();
template const DocumentTable& document_table<ConditionDocument>();
template const DocumentTable& document_table<GroupDocument>();
template const DocumentTable& document_table<AddDocument>();
template const DocumentTable& document_table<MoveDocument>();
template const DocumentTable& document_table<SettingDocument>();
template const DocumentTable& document_table<InterventionDocument>();
template const DocumentTable& document_table<FaultDocument>();
template const DocumentTable& document_table<ExperimentDocument>();
template const DocumentTable& document_table<RecordDocument>();
template const DocumentTable& document_table<GroundDocument>();
template const DocumentTable& document_table<WorldDocument>();

}  // namespace troupe::worldio
