// Tests that visit all properties of Stage's files and all keys of JSON worlds, so that a new one cannot be
// forgotten.

#include "tests/support/scratch.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/registry.hpp"
#include "worldio/json/document_table.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/json/json_document.hpp"
#include "worldio/json/json_text.hpp"
#include "worldio/json/json_world.hpp"
#include "worldio/json/spec_check.hpp"
#include "worldio/json/spec_json.hpp"
#include "worldio/json/world_document.hpp"
#include "worldio/load.hpp"
#include "worldio/stage/stage_properties.hpp"
#include "worldio/stage/stage_writer.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::worldio::stage_walk_test {
namespace {

using engine::Field;
using engine::FieldTable;
using engine::FieldType;
using engine::WorldSpec;
using ::testing::ElementsAre;

class StageWalk : public test::ScratchTest {
 protected:
  WorldSpec load(const std::string& text, Diagnostics& diagnostics) const {
    return load_stage_world(folder_ / "w.world", text, registry_, {}, diagnostics);
  }
  static std::string errors_of(const Diagnostics& diagnostics) {
    std::string all;
    for (const Finding& finding : diagnostics.findings())
      if (finding.severity == Severity::error) all += finding.message + "\n";
    return all;
  }

  engine::Registry registry_ = make_registry();
};

/// A world in which an entity of the type has this line.
std::string world_with(std::string_view type, const std::string& line) {
  if (type == "world") return line + "\nposition( )\n";
  if (type == "block")
    return fmt::format(
        "position( block( points 3 z [0 1] point[0] [0 0] point[1] [1 0] point[2] [0 1] {} ) )\n", line);
  if (type == "sensor") return fmt::format("position( ranger( alwayson 1 sensor( {} ) ) )\n", line);
  if (type == "window") return fmt::format("window( {} )\nposition( )\n", line);
  if (type == "model" || type == "position")
    return fmt::format("position( ctrl \"wander\" ranger( ) {} )\n", line);
  return fmt::format("position( {}( alwayson 1 {} ) )\n", type, line);
}

// A value that the reader of Stage's files accepts is within the limits of the engine.
TEST_F(StageWalk, WhatIsAcceptedIsWithinTheLimits) {
  const std::string numbers[] = {
      "9007199254740992", "-9007199254740992", "4000000000", "100001", "-100001", "0", "0.0000001"};
  std::size_t accepted = 0, refused = 0;
  for (const StageRow& row : stage_rows()) {
    if (row.support != StageSupport::honoured || row.name == "threads" || row.name == "include") continue;
    if (test::k_slow_build && row.type != "world" && row.type != "model") continue;
    std::string name(row.name);
    if (const std::size_t k = name.find("[k]"); k != name.npos) name.replace(k, 3, "[0]");
    for (const std::string& number : numbers) {
      const std::string tuples[] = {number, fmt::format("[{0} {0}]", number), fmt::format("[1 1 {}]", number),
                                    fmt::format("[{0} {0} {0}]", number),
                                    fmt::format("[{0} {0} {0} {0}]", number)};
      for (const std::string& value : tuples) {
        const std::string text = world_with(row.type, name + " " + value);
        Diagnostics found;
        const WorldSpec spec = load(text, found);
        if (found.has_errors()) {
          ++refused;
          continue;
        }
        ++accepted;
        Diagnostics checked;
        check_spec(spec, registry_, checked);
        EXPECT_EQ(errors_of(checked), "") << text;
      }
    }
  }
  EXPECT_GT(accepted, 100u);
  EXPECT_GT(refused, 100u);
}

// ---- conversion of JSON worlds

/// The values of a world by their paths, such as `bodies/b0/type/sensors/ir/active`. Parts, joints and
/// devices have their names in paths, because their indices may change in a conversion.
using Values = std::map<std::string, std::string>;

/// Adds all values of a JSON node, except places in files and empty values. `name_of` returns the name of the
/// joint or part that the value of a key such as "joint" is the index of, and an empty text for other keys.
void add_values(const JsonNode& node, const std::string& path,
                const std::function<std::string(const std::string& key, std::int64_t index)>& name_of,
                Values& values) {
  if (const auto* object = node.object()) {
    for (const JsonMember& member : *object) {
      if (member.key.find("where") != std::string::npos) continue;
      const auto* index = std::get_if<std::int64_t>(&member.node.value);
      const std::string name = index ? name_of(member.key, *index) : std::string();
      if (!name.empty())
        values[path + "/" + member.key] = name;
      else
        add_values(member.node, path + "/" + member.key, name_of, values);
    }
  } else if (const auto* list = node.list(); list && !list->empty() && list->front().object()) {
    for (std::size_t i = 0; i < list->size(); ++i) {
      const JsonNode* name = (*list)[i].find("name");
      std::string entry = name && name->text() ? "<" + *name->text() + ">" : std::to_string(i);
      if (values.contains(fmt::format("{}/{}/name", path, entry))) entry += fmt::format("#{}", i);
      add_values((*list)[i], fmt::format("{}/{}", path, entry), name_of, values);
    }
  } else if (node.text() ? !node.text()->empty() : !node.list() || !node.list()->empty()) {
    values[path] = json_line(node);
  }
}

/// The names of the devices of a part and of the parts on it.
std::string devices_below(const engine::TypeSpec& type, std::uint32_t part) {
  std::set<std::string> names;
  for (const engine::DeviceSpec& device : type.devices)
    if (engine::is_below(type, device.part, part)) names.insert(device.name);
  return fmt::format("{}", fmt::join(names, " "));
}

/// The values of a world that have an effect. The part that carries a device is not among them, but which
/// devices a controller and a power pack reach.
Values values_of(const WorldSpec& spec, const engine::Registry& registry) {
  Values values;
  Diagnostics diagnostics;
  const auto json = parse_json(spec_to_json(spec, registry), {}, true, diagnostics);
  const std::set<std::string_view> skipped{"types", "words", "files", "resolution_where"};
  const auto no_names = [](const std::string&, std::int64_t) { return std::string(); };
  for (const JsonMember& member : *json->object())
    if (!skipped.contains(member.key)) add_values(member.node, member.key, no_names, values);
  const JsonNode::List& types = *json->find("types")->list();
  for (std::size_t b = 0; b < spec.bodies.size(); ++b) {
    const engine::BodySpec& body = spec.bodies[b];
    const std::string path = fmt::format("bodies/{}", spec.name(BodyId(static_cast<std::uint32_t>(b))));
    const auto& [x, y, z, heading] = body.pose_world_body;
    const auto& [red, green, blue, alpha] = body.color;
    values[path + "/pose"] = fmt::format("{} {} {} {}", x, y, z, heading);
    values[path + "/color"] = fmt::format("{} {} {} {}", red, green, blue, alpha);
    values[path + "/fiducial"] =
        fmt::format("{}", engine::fiducial_of(spec, BodyId(static_cast<std::uint32_t>(b)), 0));
    values[path + "/index"] = fmt::format("{}", b);
    const engine::TypeSpec& type = spec.types[body.type.index()];
    const auto name_of = [&](const std::string& key, std::int64_t index) {
      const auto i = static_cast<std::size_t>(index);
      if (key == "part" || key == "parent") return "<" + type.parts[i].name + ">";
      if (key == "joint" || key == "moves")
        return index == engine::k_rigid ? std::string("none") : "<" + type.joints[i].name + ">";
      return std::string();
    };
    add_values(types[body.type.index()], path, name_of, values);
    values["types/" + type.name] = "";
    for (const engine::DeviceSpec& device : type.devices)
      if (device.kind == "power_pack" || device.kind == "flags")  // have no place
        for (const char* key : {"pose", "joint"})
          values.erase(fmt::format("{}/sensors/<{}>/{}", path, device.name, key));
    std::erase_if(values, [&](const auto& one) {
      const std::string_view at = one.first;
      return at.starts_with(path + "/") &&
             (at == path + "/name" || at == path + "/parts/<>/fiducial_return" || at.ends_with("/part") ||
              at.ends_with("/parent") ||
              (type.drive && at.find("/controllers/") != at.npos && at.ends_with("/period_s")));
    });
    for (std::size_t c = 0; c < type.controllers.size(); ++c)
      values[fmt::format("{}/controllers/{}/devices", path, c)] =
          devices_below(type, type.controllers[c].part);
    for (const engine::DeviceSpec& device : type.devices)
      if (device.kind == "power_pack")
        values[fmt::format("{}/sensors/<{}>/devices", path, device.name)] = devices_below(type, device.part);
    for (const engine::DeviceSpec& device : type.devices)  // controllers choose among devices in this order
      values[fmt::format("{}/order of {}", path, device.kind)] += device.name + " ";
  }
  for (const engine::NamedBody& alias : spec.aliases)
    values["aliases/" + spec.names.text(alias.name)] = spec.name(alias.body);
  return values;
}

/// The value at a path, for messages.
std::string at(const Values& values, const std::string& path) {
  const auto found = values.find(path);
  return found == values.end() ? "nothing" : found->second;
}

/// The paths at which two worlds have different values.
std::set<std::string> differences(const Values& a, const Values& b) {
  std::set<std::string> paths;
  for (const Values* values : {&a, &b})
    for (const auto& [path, value] : *values)
      if (at(a, path) != at(b, path)) paths.insert(path);
  return paths;
}

/// A JSON world, what `troupe convert` makes of it, and what this reads back as.
struct Converted {
  bool is_valid = false;       ///< whether the JSON world has no errors
  Values before, after;        ///< `after` is empty if there are errors
  std::set<std::string> told;  ///< messages about the conversion
  std::string text;
};

/// JSON texts of values that a key with this field may have. Some of them may be invalid.
std::vector<std::string> texts_of(const Field& field);

/// JSON objects, each with the keys of the table that are required and one more.
std::vector<std::string> texts_of(const FieldTable& table) {
  std::string required;
  for (const Field& field : table.fields)
    if (field.required()) required += fmt::format("\"{}\": {}, ", key_of(field), texts_of(field).front());
  std::vector<std::string> all;
  for (const Field& field : table.fields)
    for (const std::string& text : texts_of(field)) {
      std::string others;
      for (const Field& other : table.fields)
        if (&other != &field && other.required())
          others += fmt::format(", \"{}\": {}", key_of(other), texts_of(other).front());
      all.push_back(fmt::format("{{\"{}\": {}{}}}", key_of(field), text, others));
    }
  return all;
}

std::vector<std::string> texts_of(const Field& field) {
  const auto in_list = [](const std::string& text) { return "[" + text + "]"; };
  switch (field.type) {
    case FieldType::boolean: return {"true", "false"};
    case FieldType::integer: return {"1", "0", "2", "3", "-7"};
    case FieldType::number: return {"0.25", "0", "1.5", "-0.35", "0.3333333333333333", "7"};
    case FieldType::text: {
      if (field.choices.empty()) return {"\"lift\"", "\"other\"", "\"two words\""};
      std::vector<std::string> all;
      for (const std::string_view choice : field.choices) all.push_back(fmt::format("\"{}\"", choice));
      return all;
    }
    case FieldType::texts: return {R"(["one"])", R"(["one", "two"])"};
    case FieldType::numbers: {
      std::vector<std::string> all;
      const std::vector<std::size_t> sizes =
          field.columns > 0 ? std::vector{field.columns} : std::vector<std::size_t>{1, 2, 3, 4};
      for (const std::size_t size : sizes)
        for (const double first : {0.25, 1.0 / 3, -3.5, 0.0}) {
          std::vector<double> numbers(size);
          for (std::size_t i = 0; i < size; ++i) numbers[i] = first + 0.125 * static_cast<double>(i);
          all.push_back(fmt::format("[{}]", fmt::join(numbers, ", ")));
        }
      return all;
    }
    case FieldType::color: return {"\"red\"", "[0.1, 0.2, 0.3]", "[0.1, 0.2, 0.3, 0.5]"};
    case FieldType::colors: return {R"(["red"])", R"(["red", "SteelBlue"])", "[[0.1, 0.2, 0.3]]"};
    case FieldType::record: return texts_of(*field.record);
    case FieldType::records: {
      std::vector<std::string> all = texts_of(*field.record);
      std::ranges::transform(all, all.begin(), in_list);
      all.push_back(fmt::format("[{0}, {0}]", texts_of(*field.record).front()));
      return all;
    }
  }
  return {};
}

/// Objects and lists that the walked world does not have, by their keys.
const std::map<std::string_view, std::vector<std::string>>& samples() {
  static const std::map<std::string_view, std::vector<std::string>> all{
      {"record", {R"({"file": "run.h5"})"}},
      {"measures", {R"(["stalls"])"}},
      {"stop_when", {R"(["stalls >= 1"])"}},
      {"at", {R"([{"time_s": 1, "move": {"model": "post", "pose": {}}}])"}},
      {"faults", {R"([{"model": "bot", "slow_wheels": {"factor": 0.5}}])"}},
      {"ring", {R"({"count": 3, "radius_m": 0.1})"}},
      {"disc", {R"({"radius_m": 0.25, "height_m": 0.5})"}},
      {"arena", {R"({"size_m": [80, 60]})", R"({"size_m": [80, 60], "walls": false})"}},
      {"bitmap", {R"("image.pgm")", R"("other.pgm")", R"("map.yaml")"}},
      {"name", {R"("other")", R"("other name")"}},
      {"type", {R"("post")", R"("drum")"}},
      {"reserve_of", {R"("crowd")"}},
      {"on", {R"("lift")"}},
      {"extends", {"\"post\""}},
      {"include", {R"(["more.json"])"}},
      {"device_order", {R"(["ir2", "ir", "lamp", "lift", "eye", "claw", "trailer"])"}},
      {"global_parts", {R"(["box"])"}},
      {"fields", {R"(["pose"])"}},
      {"blocks", {"[]", R"([{"points_m": [[0, 0], [1, 0], [0, 1]], "z_m": [0, 1]}])"}},
      {"parts", {"[]", R"([{"name": "added"}])"}},
      {"sensors", {R"([{"kind": "compass"}])", R"([{"kind": "fiducial"}])"}},
      {"devices", {R"([{"kind": "led"}])", R"([{"kind": "blinkenlight"}])"}},
      {"ground", {R"({"alias": "earth"})"}},
      {"controller", {R"({"kind": "wander"})", R"({"kind": "rasterize"})"}},
      {"controllers",
       {R"([{"kind": "wander"}, {"kind": "rasterize"}])",
        R"([{"kind": "rasterize"}, {"kind": "rasterize"}])"}},
      {"device", {R"({"kind": "fiducial"})"}},
      {"drive", {R"({"kind": "omni"})"}}};
  return all;
}

std::vector<std::string> texts_of(const DocumentKey& key, const Field& field,
                                  const engine::Registry& registry) {
  switch (key.form) {
    case Form::value: return texts_of(field);
    case Form::choice: {
      Field choice = field;
      choice.type = FieldType::text;
      return texts_of(choice);
    }
    case Form::block: return texts_of(*key.block);
    case Form::version: return {"1"};
    case Form::seed: return {"0", "12", "9007199254740993", "18446744073709551615"};
    case Form::name:
      if (const auto found = samples().find(field.name); found != samples().end()) return found->second;
      return {R"("other")", R"("other name")", R"("post")"};
    case Form::model_kind: {
      std::vector<std::string> all;
      for (const engine::ModelKind& kind : registry.models) all.push_back(fmt::format("\"{}\"", kind.name));
      return all;
    }
    case Form::color: return texts_of({.name = "", .type = FieldType::color});
    case Form::color_or_random: return {"\"random\"", "\"red\"", "[0.1, 0.2, 0.3]"};
    case Form::heading: return {"\"random\""};
    case Form::points:
      return {"[[0, 0], [1.25, 0], [0, 1.5]]", "[[0, 0], [2, 0.5]]", "[[-9, -9], [-3, -9], [-9, -3]]"};
    case Form::box: return {"[[-50, -40.5], [50, 40.25]]", "[[-9, -9], [-3, -3]]"};
    case Form::contours: return {"[[[0, 0], [1.25, 0], [0, 1.5]]]"};
    case Form::joint: return {"null", "\"lift\""};
    default:
      if (const auto found = samples().find(field.name); found != samples().end()) return found->second;
      return {};
  }
}

class StageConvertWalk : public StageWalk {
 protected:
  Converted convert(const JsonNode& world) const {
    Converted converted;
    const std::string text = json_text(world);
    Diagnostics found;
    const WorldSpec spec = load_json_world(folder_ / "w.json", text, registry_, {}, found);
    if (found.has_errors()) {
      converted.text = errors_of(found);
      return converted;
    }
    converted.is_valid = true;
    converted.before = values_of(spec, registry_);
    Diagnostics told;
    const auto document = load_json_document(folder_ / "w.json", text, registry_, {}, told);
    converted.text = write_stage_world(spec, folder_ / "w.world", &*document, registry_, told);
    for (const Finding& finding : told.findings()) converted.told.insert(finding.message);
    if (!told.has_errors()) converted.after = values_of(load(converted.text, found), registry_);
    return converted;
  }

  /// Parses a world and writes the files to which worlds refer.
  JsonNode world(const std::string& text) const {
    const std::string white = "\xff", gray = "\x90";
    write("image.pgm", "P5 3 3 255\n.." + white + "." + white + white + "." + white + white);
    write("other.pgm", "P5 2 2 255\n....");
    write("cells.pgm", "P5 2 2 255\n." + white + gray + ".");
    write("map.yaml",
          "image: cells.pgm\nresolution: 0.5\norigin: [-1, -1, 0]\nnegate: 0\noccupied_thresh: 0.65\n"
          "free_thresh: 0.196\n");
    write("more.json", R"({"types": {"more": {"size_m": [1, 1, 1]}}})");
    Diagnostics diagnostics;
    std::optional<JsonNode> node = parse_json(text, {}, true, diagnostics);
    EXPECT_EQ(errors_of(diagnostics), "");
    return *node;
  }
  /// Begins with a world in which each key is changed in turn.
  void begin(const JsonNode& world) {
    base_ = world;
    usual_ = convert(base_);
    EXPECT_TRUE(usual_.is_valid) << usual_.text << json_line(world);
  }
  /// Sets the value at a JSON pointer and checks what becomes of it. Returns whether the value is valid and
  /// has an effect.
  bool check(const std::string& pointer, const std::string& text) {
    JsonNode world = base_;
    Diagnostics diagnostics;
    set_json_value(world, pointer, text, diagnostics);
    if (diagnostics.has_errors()) return false;
    const Converted changed = convert(world);
    if (!changed.is_valid) return false;
    const std::set<std::string> effects = differences(usual_.before, changed.before);
    if (effects.empty()) return false;
    const bool is_reported = std::ranges::any_of(
        changed.told, [this](const std::string& message) { return !usual_.told.contains(message); });
    if (is_reported) return true;
    // What only the converted world has, such as parts that carry sensors, is not lost.
    std::set<std::string> paths = effects;
    for (const auto& [path, value] : changed.before) paths.insert(path);
    for (const std::string& path : paths) {
      // The conversion of the unchanged world reports that bounds are not written.
      if (path == "bounds_m" || at(changed.before, path) == at(changed.after, path)) continue;
      const bool is_usual = at(usual_.before, path) != at(usual_.after, path);
      if (is_usual && (!effects.contains(path) || at(usual_.after, path) != at(changed.after, path)))
        continue;
      lost_ += fmt::format("{} = {}: {}: {} -> {}\n", pointer, text, path, at(changed.before, path),
                           at(changed.after, path));
    }
    return true;
  }

  /// Changes each key of a JSON object in turn. `path` is the kind of the object in messages.
  void walk(const DocumentTable& table, const JsonNode& node, const JsonNode& around,
            const std::string& pointer, const std::string& path) {
    tables_.insert(&table);
    std::optional<DocumentKind> kind;
    if (table.kinds != nullptr) {
      const JsonNode* name = node.find("kind");
      kind = name ? *table.kinds->find(registry_, *name->text()) : *table.kinds->implied(registry_, around);
    }
    std::uint32_t variant = ~0u;
    if (!table.variant.empty()) {
      const auto& choices = table.find(table.variant)->field.choices;
      const auto at = std::ranges::find(choices, *node.find(table.variant)->text()) - choices.begin();
      variant = 1u << static_cast<unsigned>(at);
    }
    for (const DocumentKey& key : table.keys) {
      if ((key.variants & variant) == 0 || (key.is_there && !key.is_there(node)) ||
          (key.is_of && !key.is_of(kind->kind)))
        continue;
      if (key.form == Form::parameters) {
        for (const Field& field : kind->params->fields)
          walk_key(pointer + "/" + key_of(field), fmt::format("{} {}.{}", path, kind->name, field.name),
                   texts_of(field));
        continue;
      }
      if (key.form == Form::kind) continue;  // each kind is tested below
      const Field& field = field_of(key, kind ? kind->params : nullptr);
      const std::string below = fmt::format("{}/{}", pointer, key_of(field));
      const std::string below_path =
          path.empty() ? std::string(field.name) : fmt::format("{}.{}", path, field.name);
      const JsonNode* member = node.find(field.name);
      if (member && (key.form == Form::list || key.form == Form::map || key.form == Form::object)) {
        if (key.form == Form::object) walk(key.table(), *member, node, below, below_path);
        if (key.form == Form::list)
          for (std::size_t i = 0; i < member->list()->size(); ++i)
            walk(key.table(), (*member->list())[i], node, fmt::format("{}/{}", below, i), below_path + "[]");
        if (key.form == Form::map)
          for (const JsonMember& one : *member->object())
            walk(key.table(), one.node, node, fmt::format("{}/{}", below, one.key), below_path + "{}");
      } else {
        walk_key(below, below_path, texts_of(key, field, registry_));
        if (key.form == Form::heading) walk_key(below + "_rad", below_path, texts_of(heading_field()));
      }
    }
  }
  void walk_key(const std::string& pointer, const std::string& path, const std::vector<std::string>& values) {
    bool& is_tested = tested_[path];
    for (const std::string& value : values) is_tested |= check(pointer, value);
  }
  std::set<std::string> untested() const {
    std::set<std::string> paths;
    for (const auto& [path, is_tested] : tested_)
      if (!is_tested) paths.insert(path);
    return paths;
  }

  JsonNode base_;
  Converted usual_;
  std::set<const DocumentTable*> tables_;
  std::map<std::string, bool> tested_;
  std::string lost_;
};

constexpr const char* k_json_world = R"({
  "troupe": 1, "title": "walk", "seed": 7, "tick_s": 0.1, "quit_time_s": 60,
  "floorplans": [
    {"name": "plan", "bitmap": "image.pgm", "size_m": [4, 4, 1], "pose": {"x_m": 40, "y_m": 40}},
    {"name": "map", "bitmap": "map.yaml", "pose": {"x_m": -40, "y_m": -40}},
    {"name": "sw", "bitmap": "image.pgm", "size_m": [1, 1, 1], "pose": {"x_m": -60, "y_m": -60}},
    {"name": "ne", "bitmap": "image.pgm", "size_m": [1, 1, 1], "pose": {"x_m": 60, "y_m": 60}}],
  "types": {
    "bot": {"size_m": [0.5, 0.4, 0.3], "drive": {"kind": "diff"}, "controller": {"kind": "wander"},
      "sensors": [{"name": "ir", "kind": "ranger", "transducers": [{}]},
                  {"name": "ir2", "kind": "ranger", "transducers": [{}]}],
      "devices": [{"name": "lamp", "kind": "blinkenlight"}],
      "parts": [{"name": "box", "pose": {"x_m": 0.25},
                 "blocks": [{"points_m": [[0, 0], [0.25, 0], [0.25, 0.25], [0, 0.25]], "z_m": [0, 0.25]},
                            {"contours_m": [[[0, 0], [-0.25, 0], [0, -0.25]]], "z_m": [0, 0.25]}]},
                {"name": "lift", "kind": "actuator", "size_m": [0.1, 0.1, 0.1], "device": {},
                 "parts": [{"name": "load", "size_m": [0.05, 0.05, 0.05]}],
                 "sensors": [{"name": "eye", "kind": "fiducial"}]},
                {"name": "claw", "kind": "gripper", "pose": {"x_m": 0.25}, "extent_m": [0.2, 0.3, 0.2], "device": {}},
                {"name": "trailer", "kind": "position", "size_m": [0.1, 0.1, 0.1], "device": {"kind": "wheels"}}]},
    "pair": {"size_m": [0.5, 0.4, 0.3], "drive": {"kind": "diff"}, "sensors": [{"kind": "ranger", "transducers": [{}]}],
             "controllers": [{"kind": "wander"}, {"kind": "rasterize"}]},
    "sink": {"size_m": [1, 1, 1], "controllers": [{"kind": "rasterize"}]},
    "post": {"blocks": [{"points_m": [[0, 0], [1, 0], [0, 1]], "z_m": [0, 1]},
                        {"contours_m": [[[-1, -1], [0, -1], [-1, 0]]], "z_m": [0, 1]}], "fiducial_return": 3, "controller": {"kind": "rasterize"}},
    "picture": {"bitmap": "image.pgm", "size_m": [1, 1, 1]},
    "chart": {"bitmap": "map.yaml"},
    "fitted": {"fit": true, "size_m": [1, 1, 1],
               "blocks": [{"points_m": [[0, 0], [1, 0], [1, 1], [0, 1]], "z_m": [0, 1]}]},
    "drum": {"disc": {"radius_m": 0.5, "height_m": 0.5}}},
  "models": [
    {"name": "bot", "type": "bot", "pose": {"y_m": 10}},
    {"name": "pair", "type": "pair", "pose": {"y_m": 20}},
    {"name": "sink", "type": "sink", "pose": {"x_m": 10, "y_m": 20}},
    {"name": "post", "type": "post", "pose": {"x_m": 10, "y_m": 10}},
    {"name": "picture", "type": "picture", "pose": {"x_m": 20, "y_m": 10}},
    {"name": "chart", "type": "chart", "pose": {"x_m": -10, "y_m": 10}},
    {"name": "fitted", "type": "fitted", "pose": {"x_m": -20, "y_m": 10}},
    {"name": "drum", "type": "drum", "pose": {"x_m": -20, "y_m": 20}}],
  "populations": [
    {"name": "crowd", "type": "drum", "count": 2,
     "place": {"rule": "grid", "region_m": [[-9, -15], [-1, -5]], "pitch_m": 1.5}},
    {"name": "u", "type": "drum", "count": 1, "place": {"rule": "uniform", "region_m": [[0, -9], [3, -6]]}},
    {"name": "g", "type": "drum", "count": 1,
     "place": {"rule": "gaussian", "mean_m": [6, -8], "deviation_m": [0.5, 0.5]}},
    {"name": "p", "type": "drum", "count": 1,
     "place": {"rule": "poisson_disc", "region_m": [[8, -9], [12, -6]], "distance_m": 1}},
    {"name": "f", "type": "drum", "count": 1, "place": {"rule": "free_floor", "region_m": [[13, -9], [16, -6]]}}]
})";

/// Adds a table and all tables of its keys.
void add_tables(const DocumentTable& table, std::set<const DocumentTable*>& all) {
  if (!all.insert(&table).second) return;
  for (const DocumentKey& key : table.keys)
    if (key.table != nullptr && !key.is_resolved) add_tables(key.table(), all);
}

TEST_F(StageConvertWalk, EveryKeyOfAJsonWorldIsWrittenOrReported) {
  if (test::k_slow_build) GTEST_SKIP() << "converts a thousand worlds";
  // Stage's format has no counterpart of these objects. A conversion reports each of them as a whole.
  const std::set<std::string_view> reported{"arena",    "at",     "faults",   "ground",
                                            "measures", "record", "stop_when"};
  begin(world(k_json_world));
  if (!usual_.is_valid) return;
  walk(document_table<WorldDocument>(), base_, base_, "", "");
  EXPECT_TRUE(check("/floorplans/-", R"({"name": "lines", "walls_m": [[20, 30], [25, 30], [25, 33]]})"));
  EXPECT_EQ(lost_, "");
  EXPECT_THAT(untested(),
              ElementsAre("$schema", "floorplans[].walls_m",  // these floor plans have images
                          "include",                          // adds types, and no body has them
                          "overlaps", "populations[].place.cell", "populations[].place.distance",
                          "populations[].place.from", "populations[].place.rule",
                          "populations[].place.spill_m", "same_names", "troupe",
                          "types{}.blocks[].frame",          // the body and its root part have one frame
                          "types{}.devices[].on",            // the only joint comes after them
                          "types{}.parts[].sensors[].on"));  // the sensor is on the only joint already
  std::set<const DocumentTable*> all;
  for (const DocumentKey& key : document_table<WorldDocument>().keys)
    if (key.table != nullptr && !reported.contains(key.field.name)) add_tables(key.table(), all);
  for (const DocumentTable* table : all)
    EXPECT_TRUE(tables_.contains(table))
        << "no object of the world has the keys of this table: " << table->keys.front().field.name << ", ...";
}

constexpr const char* k_robot_world = R"({
  "troupe": 1, "seed": 7,
  "types": {
    "bot": {"size_m": [0.5, 0.4, 0.3], "drive": {"kind": "diff"}, "controllers": [],
      "sensors": [{"name": "ir", "kind": "ranger", "transducers": [{}]}, {"name": "eye", "kind": "fiducial"}],
      "devices": [],
      "parts": [{"name": "lift", "kind": "actuator", "size_m": [0.1, 0.1, 0.1], "device": {}}]}},
  "models": [{"name": "bot", "type": "bot"}]
})";

TEST_F(StageConvertWalk, EveryParameterOfAKindIsWrittenOrReported) {
  if (test::k_slow_build) GTEST_SKIP() << "converts a thousand worlds";
  const JsonNode bot = world(k_robot_world);
  std::set<std::string> whole;  // kinds that Stage's format lacks: the conversion reports an error
  using Changes = std::vector<std::pair<std::string, std::string>>;
  const auto walk_object = [&](const DocumentTable& table, const std::string& pointer,
                               const std::string& text, const std::string& what, const Changes& before = {}) {
    Diagnostics diagnostics;
    JsonNode changed = bot;
    for (const auto& [at, value] : before) set_json_value(changed, at, value, diagnostics);
    set_json_value(changed, pointer, text, diagnostics);
    ASSERT_EQ(errors_of(diagnostics), "");
    begin(changed);
    if (!usual_.is_valid) return;
    if (usual_.after.empty()) {
      whole.insert(what);
      return;
    }
    const JsonNode* node = &base_;
    const JsonNode* around = node;
    std::string place;
    std::istringstream tokens(pointer.substr(1));
    for (std::string token; std::getline(tokens, token, '/');) {
      around = node;
      if (token == "-") token = std::to_string(node->list()->size() - 1);
      place += "/" + token;
      node = node->list() ? &(*node->list())[static_cast<std::size_t>(std::stoi(token))] : node->find(token);
    }
    const JsonNode found = *node;
    const JsonNode near = *around;
    walk(table, found, near, place, what);
  };
  // Stage has these devices only under these names, as properties of a model.
  const std::map<std::string_view, std::string_view> own_keys{
      {"power_pack", R"("name": "power", "capacity_J": 100, "stored_J": 0)"},
      {"power_contact", R"("name": "contact", "give_W": 5)"},
      {"flags", R"("name": "flags")"}};
  const auto object = [&](std::string_view kind, const FieldTable& params) {
    std::string text = fmt::format("{{\"kind\": \"{}\"", kind);
    if (const auto keys = own_keys.find(kind); keys != own_keys.end())
      text += fmt::format(", {}", keys->second);
    for (const Field& field : params.fields)
      if (field.required()) text += fmt::format(", \"{}\": {}", key_of(field), texts_of(field).front());
    return text + "}";
  };
  for (const engine::DriveKind& kind : registry_.drives)
    walk_object(document_table<DriveDocument>(), "/types/bot/drive", object(kind.name, kind.params),
                fmt::format("drive {}", kind.name));
  for (const engine::ControllerKind& kind : registry_.controllers) {
    Changes brought;
    for (const std::string_view device : kind.brings)
      brought.emplace_back("/types/bot/devices/-", object(device, registry_.device(device)->params));
    walk_object(document_table<ControllerDocument>(), "/types/bot/controllers/-",
                object(kind.name, kind.params), fmt::format("controller {}", kind.name), brought);
  }
  for (const engine::DeviceKind& kind : registry_.devices) {
    const bool is_sensor = kind.is_sensor();
    Changes before;
    if (kind.name == "power_contact")
      before.emplace_back("/types/bot/devices/-",
                          object("power_pack", registry_.device("power_pack")->params));
    if (kind.name == "flags") before.emplace_back("/types/bot/controllers/-", R"({"kind": "sink"})");
    walk_object(is_sensor ? document_table<SensorDocument>() : document_table<DeviceDocument>(),
                is_sensor ? "/types/bot/sensors/-" : "/types/bot/devices/-", object(kind.name, kind.params),
                fmt::format("device {}", kind.name), before);
  }
  EXPECT_EQ(lost_,
            "/types/bot/devices/0/infinite = true: bodies/bot/sensors/<power>/params/capacity_J: 100 -> 0\n")
      << "the capacity of a pack that never runs out has no effect";
  // With a drive, the period of a controller has no effect. Flags and power packs have no place. The device
  // with a joint comes after these devices, which therefore cannot be on it.
  std::set<std::string> expected{
      "device actuator.joint",    "device actuator.on",      "device blinkenlight.on",
      "device flags.joint",       "device flags.on",         "device flags.pose",
      "device lightindicator.on", "device power_contact.on", "device power_pack.joint",
      "device power_pack.on",     "device power_pack.pose"};
  for (const engine::ControllerKind& kind : registry_.controllers)
    if (!whole.contains(fmt::format("controller {}", kind.name)))
      expected.insert(fmt::format("controller {}.period", kind.name));
  EXPECT_EQ(untested(), expected);
  EXPECT_THAT(whole, ElementsAre("controller dynamic", "controller waypoints", "device brush",
                                 "device compass", "device gripper", "device ground", "device led",
                                 "device light_sensor", "device remover", "device spawner", "device wheels"))
      << "the own devices of parts, in the world above, include a gripper and wheels";
}

}  // namespace
}  // namespace troupe::worldio::stage_walk_test
