#include "worldio/json/world_document.hpp"

#include "engine/watch_spec.hpp"
#include "worldio/images/ros_map.hpp"
#include "worldio/json/document_table.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/json/json_parts.hpp"
#include "worldio/load.hpp"
#include "worldio/window_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

/// What a world in JSON says is described here, and nowhere else: its keys, their units, limits and meanings,
/// and what goes together. Limits are those for authors of worlds.
namespace troupe::worldio {
namespace {

using namespace engine::facts;
using engine::DeviceKind;
using engine::Registry;
using engine::Unit;
using How = DocumentRule::How;

constexpr Unit meters = Unit::meters;
constexpr Unit seconds = Unit::seconds;

constexpr double k_most_s = 1e9;          // of times and periods of a world
constexpr double k_most_period_s = 1e6;   // of what robots carry
constexpr double k_most_chosen = 1e9;     // bodies of a group
constexpr double k_most_return = 1e6;     // of rangers
constexpr double k_least_step_m = 0.001;  // between bodies, and of the floor that is looked at
constexpr std::array<std::string_view, 2> k_checks{"error", "warn"};
constexpr std::array<std::string_view, 5> k_rules{"grid", "uniform", "gaussian", "poisson_disc",
                                                  "free_floor"};
constexpr std::string_view k_type_of = "the name of one of /types";

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
                           (*kind)->is_sensor() ? "only looks: it belongs under \"sensors\""
                                                : "does something: it belongs under \"devices\"")};
}

/// What models of the kind of the part are.
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
                              .named =
                                  [](const Registry& registry) {
                                    std::vector<std::string_view> names;
                                    for (const DeviceKind& kind : registry.devices)
                                      names.push_back(kind.name);
                                    return names;
                                  },
                              .find = find_device<k_list>,
                              .implied = k_list == DeviceList::both ? implied_device : nullptr};

const DocumentKinds k_drives{
    .what = "drive",
    .page = {},
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
    .page = {},
    .all =
        [](const Registry& registry) {
          std::vector<DocumentKind> all;
          for (const engine::MeasureKind& kind : registry.measures)
            all.push_back({.name = kind.name, .text = kind.text, .params = &kind.params});
          return all;
        },
    .known = [](const Registry& registry) { return sorted_names(registry.measures); },
    .named = nullptr,
    .find = [](const Registry& registry, const std::string& name) -> Result<DocumentKind> {
      if (const engine::MeasureKind* kind = registry.measure(name))
        return DocumentKind{.name = kind->name, .text = kind->text, .params = &kind->params};
      return Error{unknown_name("measure", name, sorted_names(registry.measures))};
    },
    .expects = "the name of a measure",
    .hint = "the name of a measure"};

// ---- texts in place of objects

std::string_view trimmed(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

/// `>= 0.9`; nothing where it is none.
std::optional<ComparisonDocument> comparison_of(std::string_view text) {
  std::optional<std::size_t> longest;
  for (std::size_t i = 0; i < engine::k_comparisons.size(); ++i)
    if (text.starts_with(engine::k_comparisons[i]) &&
        (!longest || engine::k_comparisons[i].size() > engine::k_comparisons[*longest].size()))
      longest = i;
  if (!longest) return std::nullopt;
  const std::string_view number = trimmed(text.substr(engine::k_comparisons[*longest].size()));
  double value = 0;
  const auto [end, fault] = std::from_chars(number.data(), number.data() + number.size(), value);
  if (number.empty() || fault != std::errc() || end != number.data() + number.size() || !std::isfinite(value))
    return std::nullopt;
  return ComparisonDocument{static_cast<engine::Comparison>(*longest), value};
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

bool has_defaults(const engine::FieldTable& params) {
  return std::ranges::all_of(params.defaults(), &engine::Value::given);
}

void read_measure_text(const JsonCursor& at, const std::string& text, const Registry& registry,
                       void* object) {
  auto& measure = *static_cast<MeasureDocument*>(object);
  const std::size_t colon = text.find(':');
  measure.kind = text.substr(0, colon);
  if (colon != text.npos) {
    measure.of = text.substr(colon + 1);
    if (measure.of.empty())
      return at.error(
          fmt::format("\"{}\": the name of a type, a population or a robot stands behind the colon", text));
  }
  const auto kind = k_measures.find(registry, measure.kind);
  if (!kind) return at.error(kind.error().text);
  measure.params = kind->params->defaults();
  if (!has_defaults(*kind->params))
    at.error(fmt::format("\"{}\" has parameters that must be given: {{\"kind\": \"{}\", ...}}", kind->name,
                         kind->name));
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
  return {std::move(plain), schema_of_texts(fmt::format("^({}):.+$", either))};
}

const DocumentShorthand k_measure_text{
    .expects = "the name of a measure, or {\"kind\": ..., ...}",
    .read = read_measure_text,
    .write = [](const void*, const Registry&) -> std::optional<std::string> { return std::nullopt; },
    .schemas = measure_text_schemas};

constexpr std::string_view k_condition =
    "a condition on a measure, as \"coverage >= 0.9\": one of <, <=, >, >=, ==, != and a number";
constexpr std::string_view k_comparison_pattern = "(<|<=|>|>=|==|!=) *[-+0-9.eE]+ *$";

void read_condition_text(const JsonCursor& at, const std::string& text, const Registry& registry,
                         void* object) {
  auto& condition = *static_cast<ConditionDocument*>(object);
  const std::size_t sign = std::min(text.find_first_of("<>=!"), text.size());
  const std::string name(trimmed(std::string_view(text).substr(0, sign)));
  const std::string_view compares = trimmed(std::string_view(text).substr(sign));
  if (compares.empty() || name.empty()) return at.expected(k_condition);
  const std::size_t before = at.diagnostics().findings().size();
  MeasureDocument& measure = condition.measure.emplace();
  measure.where = at.where();
  read_measure_text(at, name, registry, &measure);
  if (at.diagnostics().findings().size() > before) return;
  condition.is = read_comparison(at, compares);
}

std::optional<std::string> condition_text(const void* object, const Registry& registry) {
  const auto& condition = *static_cast<const ConditionDocument*>(object);
  if (!condition.measure || !condition.is || !condition.measure->name.empty()) return std::nullopt;
  const MeasureDocument& measure = *condition.measure;
  const engine::MeasureKind* kind = registry.measure(measure.kind);
  const engine::Record defaults = kind ? kind->params.defaults() : engine::Record();
  const auto same = [](const engine::Value& a, const engine::Value& b) { return same_bits(a, b); };
  if (!std::ranges::equal(measure.params, defaults, same)) return std::nullopt;
  return engine::text_of(
      engine::StopSpec{{.kind = measure.kind, .name = {}, .of = measure.of, .params = {}, .where = {}},
                       condition.is->how,
                       condition.is->with});
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

// ---- what several structs have

template <class T, auto... Path>
void describe_returns(DocumentKeys<T>& d) {
  using engine::Returns;
  d.template value<Path..., &Returns::obstacle>("obstacle", "whether it blocks bodies");
  d.template value<Path..., &Returns::ranger>("ranger_return", within(-k_most_return, k_most_return),
                                              "the intensity that rangers read; below 0, beams pass");
  d.template value<Path..., &Returns::fiducial>("fiducial_return",
                                                "what fiducial finders read of it; 0: nothing");
  d.template value<Path..., &Returns::fiducial_key>("fiducial_key", "finders find what has their key");
  d.template value<Path..., &Returns::gripper>("gripper_return", "whether grippers can take it");
  d.template value<Path..., &Returns::blob>("blob_return", "whether blob finders see its colour");
  d.template value<Path..., &Returns::pushable>("pushable",
                                                "whether robots push the whole body, rather than stall");
}

constexpr std::string_view k_size_text = "x, y and height of a box that stands on the floor";

/// The path of an image; null where the object has none.
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

/// is_plan: the object is nothing but an image.
template <class T, auto Image>
void describe_image(DocumentKeys<T>& d, std::string_view text, bool is_plan) {
  constexpr std::string_view k_path =
      "the path of an image, or of the YAML of a map, relative to the world file";
  static constexpr std::array<std::string_view, 2> k_margins{"trim", "keep"};
  static constexpr std::array<std::string_view, 2> k_unknown{"free", "solid"};
  d.template other<Image, &ImageDocument::bitmap>(Form::name, "bitmap", text, k_path);
  DocumentKey& size = d.template value<Image, &ImageDocument::size>("size", meters, above(0),
                                                                    at_most(k_max_size_m), k_size_text);
  size.hint = "[x, y, height]";
  size.when(has_no_map);
  d.template value<Image, &ImageDocument::height>("height", meters, above(0), at_most(k_max_size_m),
                                                  "of a map of ROS: of its walls")
      .when(has_map);
  d.template choice<Image, &ImageDocument::unknown>("unknown", k_unknown,
                                                    "of a map of ROS: what unknown cells are")
      .when(has_map);
  d.template choice<Image, &ImageDocument::margins>("margins", k_margins,
                                                    "trim: the solid pixels' box fills the size")
      .when(is_plan ? has_no_map : has_plain_image);
  DocumentKey& boundary = d.template value<Image, &ImageDocument::boundary>(
      "boundary", "four walls just inside the edges of the box");
  if (!is_plan) boundary.when(has_image);
}

/// Of an image, and of blocks that are fitted.
void check_size(const ImageDocument& image, bool is_needed, const JsonCursor& at) {
  if (is_needed && at.node().object() && !has_map(at.node()) && !image.size) {
    const DocumentTable& table = document_table<PartDocument>();
    const engine::Field& field = table.find("size")->field;
    for (const engine::UnitSuffix& unit : engine::unit_suffixes(field.unit))
      if (at.node().find(fmt::format("{}{}", field.name, unit.suffix))) return;  // it is wrong
    if (at.node().find(field.name)) return;
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
    d.template other<&D::joint>(Form::joint, "joint", "what it moves with; null: nothing");
  };
  if (is_own) kind();
  d.template other<&D::name>(Form::name, "name", "its name within the type",
                             is_own             ? "the device's name"
                             : word == "sensor" ? "the sensor's name"
                                                : "the device's name");
  if (!is_own) kind();
  d.template value<&D::pose>("pose", "in the frame of what it stands on");
  joint();
  d.template value<&D::active>("active", "false: runs only when a controller reads it");
  d.template value<&D::period>("period", seconds, within(0, k_most_period_s),
                               "between two readings; 0: every tick")
      .or_named("update_period");
  d.template other<&D::params>(Form::parameters, "");
  if (is_own) return;
  d.template other<&D::on>(Form::name, "on", "the device that it stands on, and moves with",
                           "the name of a device that moves what stands on it");
  const std::size_t shown = d.table().keys.size();
  d.template other<&D::color>(Form::color, "color");
  describe_returns<D, &D::returns>(d);
  for (std::size_t i = shown; i < d.table().keys.size(); ++i) d.table().keys[i].of_kind(moves_joints);
  d.template value<&D::size>("size", meters, above(0), at_most(k_max_size_m), k_size_text)
      .of_kind(shows_blocks);
  d.template list<&D::blocks>("blocks").of_kind(shows_blocks);
}

template <class G>
void describe_group(DocumentKeys<G>& d) {
  d.template other<&G::population>(Form::name, "population", {}, "a name");
  d.template other<&G::type>(Form::name, "type", {}, "a name");
  d.template other<&G::model>(Form::name, "model", {}, "a name");
  d.template value<&G::count>("count", within(0, k_most_chosen), "so many of them, chosen by the seed");
  d.template value<&G::share>("share", within(0, 1), "this share of them, chosen by the seed");
  constexpr std::string_view k_whom = "give one of \"population\", \"type\" and \"model\": whom is it about?";
  d.rule({.how = How::one_of,
          .keys = {"population", "type", "model"},
          .none = std::string(k_whom),
          .several = fmt::format("{} Here are several", k_whom)});
  d.rule(
      {.how = How::not_both, .keys = {"count", "share"}, .several = "give \"count\" or \"share\", not both"});
}

template <class T, auto... Path>
void describe_experiment(DocumentKeys<T>& d) {
  d.template list<Path..., &ExperimentDocument::stop_when>("stop_when",
                                                           "when a run is over, docs/experiments.md");
  d.template list<Path..., &ExperimentDocument::at>("at", "what is done to the world, and when");
  d.template list<Path..., &ExperimentDocument::faults>("faults", "how robots fail");
}

template <class P>
void describe_body(DocumentKeys<P>& d) {
  describe_image<P, &P::image>(d, "an image, relative to the world's file", false);
  const auto no_image = [](const JsonNode& object) { return !has_image(object); };
  d.template value<&P::fit>("fit", "the blocks are stretched to the size, as in Stage").when(no_image);
  d.template value<&P::origin>("origin", "where the middle of the image or of the stretched blocks is")
      .when([](const JsonNode& object) { return has_image(object) || is_fitted(object); });
  d.template list<&P::blocks>("blocks", "upright prisms").when(no_image);
  d.template value<&P::floor_plan>("floor_plan", "whether it is an image of walls");
  d.template value<&P::extent>("extent", meters, within(0, 2 * k_max_size_m),
                               "the size as it is declared, where it is another");
  d.template other<&P::color>(Form::color, "color");
  describe_returns<P, &P::returns>(d);
}

template <class P>
void describe_contents(DocumentKeys<P>& d) {
  d.template object<&P::device>("device", "the device that it is itself");
  d.template list<&P::sensors>("sensors", "what only looks at the world");
  d.template list<&P::devices>("devices", "what does something");
  d.template object<&P::controller>("controller");
  d.template list<&P::controllers>("controllers");
  d.template list<&P::parts>("parts", "what stands on it");
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
  check_size(plan.image, true, at);
}

void check_block(const BlockDocument& block, const JsonCursor& at) {
  if (!block.z) return;
  const auto [low, high] = *block.z;
  if (low > high || (block.points && low == high))
    at.error(fmt::format("\"z_m\" must rise from min to max, found {:.10g} and {:.10g}", low, high));
  if (!block.points || block.points->empty()) return;
  if (const Result<> outline = check_outline(*block.points); !outline)
    JsonCursor(at, "points_m", *at.node().find("points_m")).error(outline.error().text);
}

/// A column's name stands in the first line of a table, and is typed by people.
void check_measure(const MeasureDocument& measure, const JsonCursor& at) {
  constexpr std::string_view k_plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.:";
  if (measure.name.find_first_not_of(k_plain) == measure.name.npos) return;
  JsonCursor(at, "name", *at.node().find("name"))
      .error(fmt::format("\"{}\" is no name of a column: letters, digits and _ - . : may stand in it",
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
        .error("must not be 0: only a type without one is not marked");
}

}  // namespace

std::optional<ComparisonDocument> read_comparison(const JsonCursor& at, std::string_view text) {
  const auto comparison = comparison_of(trimmed(text));
  if (!comparison)
    at.error(fmt::format("\"{}\" is no comparison with a number: one of <, <=, >, >=, ==, != and the number",
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
  d.other<&BlockDocument::points>(Form::points, "points_m", "the outline, which must not cross itself")
      .entries(3, k_most_block_points);
  d.other<&BlockDocument::contours>(Form::contours, "contours_m",
                                    "outlines; what lies within an odd number of them is solid")
      .entries(3);
  d.value<&BlockDocument::z>("z", meters, within(-k_max_size_m, k_max_size_m),
                             "the heights between which it stands")
      .require("the heights between which the block stands, [min, max]");
  d.choice<&BlockDocument::frame>("frame", k_frames, "of the points, in parts");
  d.rule({.how = How::one_of,
          .keys = {"points_m", "contours_m"},
          .none = "missing \"points_m\": the outline, [[x, y], ...]",
          .several = "give \"points_m\" or \"contours_m\", not both",
          .at_key = true});
  d.check<check_block>();
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
                                  "between two commands that it takes; 0: every tick")
      .or_named("update_period");
  d.other<&DriveDocument::params>(Form::parameters, "");
}

void ControllerDocument::describe(DocumentKeys<ControllerDocument>& d) {
  d.table().definition = "controller";
  d.table().kinds = &k_controllers;
  d.other<&ControllerDocument::kind>(Form::kind, "kind").require();
  d.value<&ControllerDocument::period>("period", seconds, within(0, k_most_period_s),
                                       "how often it runs, where it reads no sensor")
      .or_named("update_period");
  d.other<&ControllerDocument::params>(Form::parameters, "");
}

void PartDocument::describe(DocumentKeys<PartDocument>& d) {
  d.table().definition = "part";
  d.other<&PartDocument::name>(Form::name, "name", "below the body's name", "the part's name")
      .require("the part's name");
  d.other<&PartDocument::alias>(Form::name, "alias", "another name", "another name of the part");
  d.other<&PartDocument::kind>(Form::model_kind, "kind", "what Stage calls it");
  d.value<&PartDocument::pose>("pose", "in the body's frame, while all joints are at rest");
  d.other<&PartDocument::joint>(Form::joint, "joint", "what it moves with; null: nothing");
  describe_body(d);
  describe_contents(d);
  d.check<check_part>();
}

void TypeDocument::describe(DocumentKeys<TypeDocument>& d) {
  d.table().definition = "type";
  d.other<&TypeDocument::name>(Form::name, "name",
                               "what the type is called, where several are called the same",
                               "what the type is called");
  d.other<&TypeDocument::kind>(Form::model_kind, "kind", "what Stage calls it");
  describe_body(d);
  d.object<&TypeDocument::drive>("drive", "a type without one never moves");
  describe_contents(d);
  d.other<&TypeDocument::device_order>(Form::names, "device_order", "in which order the devices count");
  d.rule({.how = How::any_of,
          .keys = {"size", "blocks", "bitmap", "device"},
          .none = "has no body: give \"size_m\" (a box) or \"blocks\""});
  d.check<check_type>();
}

void FloorplanDocument::describe(DocumentKeys<FloorplanDocument>& d) {
  d.other<&FloorplanDocument::name>(Form::name, "name", {}, "a name").require("the floor plan's name");
  describe_image<FloorplanDocument, &FloorplanDocument::image>(
      d, "PNG, JPEG, BMP or PNM, or the YAML of a map of ROS; dark pixels are solid", true);
  for (DocumentKey& key : d.table().keys)
    if (key.field.name == "bitmap") key.require(key.expects);
  d.value<&FloorplanDocument::pose>("pose", "of the centre");
  d.other<&FloorplanDocument::color>(Form::color, "color");
  describe_returns<FloorplanDocument, &FloorplanDocument::returns>(d);
  d.check<check_floorplan>();
}

void ModelDocument::describe(DocumentKeys<ModelDocument>& d) {
  d.other<&ModelDocument::name>(Form::name, "name", {}, "a name").require("the model's name");
  d.other<&ModelDocument::alias>(Form::name, "alias", "another name", "another name of the model");
  d.other<&ModelDocument::type>(Form::name, "type", "the name of one of the types", k_type_of)
      .require(k_type_of);
  d.other<&ModelDocument::reserve_of>(Form::name, "reserve_of",
                                      "the population into which it may be born, docs/lives.md",
                                      "the name of a population");
  d.value<&ModelDocument::pose>("pose").write_always();
  d.other<&ModelDocument::color>(Form::color, "color");
  d.value<&ModelDocument::fiducial_return>("fiducial_return", "its own number for fiducial finders");
  d.other<&ModelDocument::global_parts>(Form::names, "global_parts",
                                        "parts that are found without the body's name", "the name of a part");
  d.check<check_model>();
}

void PlaceDocument::describe(DocumentKeys<PlaceDocument>& d) {
  using Rule = engine::PlacementRule::Kind;
  constexpr auto bit = [](Rule one) { return 1u << static_cast<unsigned>(one); };
  d.table().variant = "rule";
  d.choice<&PlaceDocument::rule>("rule", k_rules)
      .require("grid, uniform, gaussian, poisson_disc or free_floor");
  d.other<&PlaceDocument::region>(Form::box, "region_m", "of the bodies' origins");
  d.other<&PlaceDocument::polygon>(Form::points, "polygon_m", "of the bodies' origins").entries(3);
  d.other<&PlaceDocument::spill>(Form::box, "spill_m", "for the bodies that the first region cannot hold")
      .of_variants(bit(Rule::grid));
  d.value<&PlaceDocument::pitch>("pitch", meters, above(0), at_most(k_max_size_m), "between neighbours")
      .require("the distance between neighbours")
      .of_variants(bit(Rule::grid));
  d.value<&PlaceDocument::jitter>("jitter", meters, within(0, k_max_size_m),
                                  "how far each coordinate may be moved at random")
      .of_variants(bit(Rule::grid));
  d.value<&PlaceDocument::mean>("mean", meters, within(-k_max_size_m, k_max_size_m),
                                "about which they are normally distributed")
      .require("[x, y], about which they are normally distributed")
      .of_variants(bit(Rule::gaussian));
  d.value<&PlaceDocument::deviation>("deviation", meters, within(0, k_max_size_m), "the standard deviations")
      .require("the standard deviations, [x, y]")
      .of_variants(bit(Rule::gaussian));
  d.value<&PlaceDocument::distance>("distance", meters, within(k_least_step_m, k_max_size_m),
                                    "how near two may be to one another")
      .require("how near two of the population may be to one another")
      .of_variants(bit(Rule::poisson_disc));
  d.value<&PlaceDocument::from>("from", meters, within(-k_max_size_m, k_max_size_m),
                                "from where the floor is reached")
      .of_variants(bit(Rule::free_floor));
  d.value<&PlaceDocument::cell>("cell", meters, within(k_least_step_m, k_max_size_m),
                                "how finely the floor is looked at")
      .of_variants(bit(Rule::free_floor));
  d.other<&PlaceDocument::heading>(Form::heading, "heading");
  d.value<&PlaceDocument::z>("z", meters, within(-k_max_size_m, k_max_size_m), "height of the origins");
  d.check<check_place>();
}

void PopulationDocument::describe(DocumentKeys<PopulationDocument>& d) {
  d.other<&PopulationDocument::name>(Form::name, "name", "bodies are called NAME0, NAME1, ...", "a name")
      .require("the population's name");
  d.other<&PopulationDocument::type>(Form::name, "type", "the name of one of the types", k_type_of)
      .require(k_type_of);
  DocumentKey& count =
      d.value<&PopulationDocument::count>("count", within(0, LoadOptions().most_bodies), "how many bodies");
  count.require().counts_bodies = true;
  d.value<&PopulationDocument::reserve>("reserve", within(0, LoadOptions().most_bodies),
                                        "how many more may be born")
      .counts_bodies = true;
  d.other<&PopulationDocument::color>(Form::color_or_random, "color", "or \"random\"");
  d.object<&PopulationDocument::place>("place").require("{\"rule\": ..., \"region_m\": ...}");
}

void MeasureDocument::describe(DocumentKeys<MeasureDocument>& d) {
  d.table().kinds = &k_measures;
  d.table().shorthand = &k_measure_text;
  d.other<&MeasureDocument::kind>(Form::kind, "kind").require();
  d.other<&MeasureDocument::of>(Form::name, "of", "a type, a population or a robot",
                                "the name of a type, a population or a robot");
  d.other<&MeasureDocument::name>(Form::name, "name", "of the column", "the name of the column");
  d.other<&MeasureDocument::params>(Form::parameters, "");
  d.check<check_measure>();
}

void ConditionDocument::describe(DocumentKeys<ConditionDocument>& d) {
  d.table().shorthand = &k_condition_text;
  d.object<&ConditionDocument::measure>("measure").require("the name of a measure, or {\"kind\": ..., ...}");
  d.other<&ConditionDocument::is>(Form::comparison, "is", {}, "what it is compared with, as \">= 0.9\"")
      .require("what it is compared with, as \">= 0.9\"");
}

void GroupDocument::describe(DocumentKeys<GroupDocument>& d) {
  d.table().definition = "group";
  describe_group(d);
}

void AddDocument::describe(DocumentKeys<AddDocument>& d) {
  d.other<&AddDocument::population>(Form::name, "population", "one that has a reserve", "a name").require();
  d.value<&AddDocument::count>("count", within(0, k_most_chosen), "how many are born");
  d.value<&AddDocument::pose>("pose").write_always();
  d.other<&AddDocument::region>(Form::box, "region_m");
  d.check<check_add>();
}

void MoveDocument::describe(DocumentKeys<MoveDocument>& d) {
  d.other<&MoveDocument::model>(Form::name, "model", {}, "a name").require("the body that is put elsewhere");
  d.value<&MoveDocument::pose>("pose").require("where it is put").write_always();
}

void SettingDocument::describe(DocumentKeys<SettingDocument>& d) {
  d.other<&SettingDocument::type>(Form::name, "type", "the name of one of the types", k_type_of)
      .require(k_type_of);
  d.other<&SettingDocument::drive>(Form::kept, "drive", "its parameters that change");
  d.other<&SettingDocument::device>(Form::kept, "device",
                                    "a device by its name, and its parameters that change", "name");
  d.other<&SettingDocument::controller>(Form::kept, "controller",
                                        "a controller by its kind, and its parameters that change", "kind");
  d.rule({.how = How::one_of,
          .keys = {"drive", "device", "controller"},
          .none = "give one of drive, device, controller: what of the type is set?"});
}

void InterventionDocument::describe(DocumentKeys<InterventionDocument>& d) {
  d.value<&InterventionDocument::time>("time", seconds, within(0, k_most_s), "when it is done").require();
  d.object<&InterventionDocument::remove>("remove");
  d.object<&InterventionDocument::add>("add");
  d.object<&InterventionDocument::disable>("disable");
  d.object<&InterventionDocument::enable>("enable");
  d.object<&InterventionDocument::move>("move");
  d.object<&InterventionDocument::set>("set");
  d.rule({.how = How::one_of,
          .keys = {engine::k_actions.begin(), engine::k_actions.end()},
          .none = fmt::format("nothing is done: give one of {}", comma_list(engine::k_actions)),
          .several = "one thing is done at a time: give each an entry of its own",
          .at_key = true});
}

void FaultDocument::describe(DocumentKeys<FaultDocument>& d) {
  describe_group(d);
  d.value<&FaultDocument::from>("from", seconds, within(0, k_most_s), "from when on");
  d.other<&FaultDocument::impairments>(Form::faults, "");
}

void ExperimentDocument::describe(DocumentKeys<ExperimentDocument>& d) { describe_experiment(d); }

void RecordDocument::describe(DocumentKeys<RecordDocument>& d) {
  d.other<&RecordDocument::file>(Form::name, "file", "where troupe run records", "the name of a file");
  d.value<&RecordDocument::every>("every", seconds, above(0), at_most(k_most_s),
                                  "of simulated time from frame to frame");
  d.other<&RecordDocument::fields>(Form::names, "fields", "what of the state, docs/recordings.md",
                                   "the name of a field")
      .entries(1);
}

void GroundDocument::describe(DocumentKeys<GroundDocument>& d) {
  d.other<&GroundDocument::alias>(Form::name, "alias", "another name of the ground",
                                  "another name of the ground")
      .require();
}

void WorldDocument::describe(DocumentKeys<WorldDocument>& d) {
  constexpr double k_least_tick_s = 1e-6;
  constexpr double k_most_tick_s = 3600;
  d.other<&WorldDocument::schema>(Form::name, "$schema", "of this file, for editors",
                                  "where the schema of this file is");
  static const std::string version = fmt::format("the version of the format, {}", k_format_version);
  d.other<>(Form::version, "troupe", "the version of the format").require(version);
  d.other<&WorldDocument::title>(Form::name, "title", "for people", "the world's title");
  d.other<&WorldDocument::seed>(Form::seed, "seed", "of every random draw");
  d.value<&WorldDocument::tick>("tick", seconds, within(k_least_tick_s, k_most_tick_s),
                                "length of a tick; 0.1 s unless given")
      .write_always();
  d.value<&WorldDocument::quit_time>("quit_time", seconds, above(0), at_most(k_most_s), "where a run ends");
  d.value<&WorldDocument::measure_every>("measure_every", seconds, within(0, k_most_s),
                                         "how often; 0: every tick");
  d.choice<&WorldDocument::ranging>("ranging", engine::k_ranging_engines,
                                    "what finds ranges, docs/sensing.md");
  d.value<&WorldDocument::resolution>("resolution", meters,
                                      within(engine::k_min_resolution_m, engine::k_max_resolution_m),
                                      "edge of the cells of the grid engine");
  d.other<&WorldDocument::bounds>(Form::box, "bounds_m", "where robots may be");
  d.object<&WorldDocument::ground>("ground");
  d.object<&WorldDocument::record>("record", "what a run records");
  d.other<&WorldDocument::watch>(Form::block, "watch", "how the world is watched").block =
      &engine::watch_fields();
  d.other<&WorldDocument::window>(Form::block, "window", "the view it asks for").block = &window_fields();
  d.value<&WorldDocument::mortal>("mortal", "programs may remove and disable bodies, docs/lives.md");
  d.choice<&WorldDocument::overlaps>("overlaps", k_checks,
                                     "what models are that overlap something at the start");
  d.choice<&WorldDocument::same_names>("same_names", k_checks, "what two bodies of one name are");
  d.list<&WorldDocument::floorplans>("floorplans", "walls drawn as images");
  d.map<&WorldDocument::types>("types", "what identical bodies share, by name").write_always();
  d.list<&WorldDocument::models>("models", "single bodies").write_always();
  d.list<&WorldDocument::populations>("populations", "many bodies of one type, placed by a rule");
  d.list<&WorldDocument::measures>("measures", "what troupe run --measures measures");
  describe_experiment<WorldDocument, &WorldDocument::experiment>(d);
}

}  // namespace troupe::worldio
