#include "worldio/results/recorded_scene.hpp"

#include "base/diagnostics.hpp"
#include "base/limits.hpp"
#include "base/split.hpp"
#include "engine/kinds/sensor_params.hpp"
#include "engine/sensing/shown_color.hpp"
#include "engine/spec/names.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/json/json_document.hpp"
#include "worldio/json/json_reader.hpp"
#include "worldio/json/spec_json.hpp"
#include "worldio/window_fields.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace troupe::worldio {
namespace {

using Json = nlohmann::json;

constexpr std::int64_t k_most_beams = 1 << 20;  // beams of a transducer: ten times the maximum in a world

[[noreturn]] void fail(const RecordingReader& recording, std::string_view message) {
  throw Hdf5Error(fmt::format("{}: error: {}", recording.file().string(), message));
}

/// Thrown for values that no world can have. The caller turns it, like the exceptions of nlohmann's parser,
/// into an error with the name of the file.
struct Damaged {};

double number_in_json(const Json& json) {
  const auto x = json.get<double>();
  if (!(std::abs(x) <= k_spec_reach_m)) throw Damaged();  // damaged coordinates are usually far larger
  return x;
}

/// Reads a text. A text that is not UTF-8 is stored as {"latin1": ...}, with one character per byte; these
/// characters are returned.
std::string text_of(const Json& json) {
  return json.is_object() ? json.at("latin1").get<std::string>() : json.get<std::string>();
}

Pose pose_of(const Json& json) {
  return {number_in_json(json.at(0)), number_in_json(json.at(1)), number_in_json(json.at(2)),
          number_in_json(json.at(3))};
}

Solid solid_of(const Json& json) {
  Solid solid;
  solid.z = {number_in_json(json.at("z_m").at(0)), number_in_json(json.at("z_m").at(1))};
  for (const Json& contour : json.at("contours_m")) {
    Ring ring;
    for (const Json& point : contour)
      ring.emplace_back(number_in_json(point.at(0)), number_in_json(point.at(1)));
    solid.contours.push_back(std::move(ring));
  }
  return solid;
}

/// Reads the index of a joint from the member `key`; k_rigid if there is no such member. Throws Damaged if
/// the index is not below `known`, the number of joints.
std::int32_t joint_of(const Json& json, const char* key, std::size_t known) {
  const auto found = json.find(key);
  if (found == json.end()) return engine::k_rigid;
  const auto joint = found->get<std::int64_t>();
  if (joint < 0 || joint >= static_cast<std::int64_t>(known)) throw Damaged();
  return static_cast<std::int32_t>(joint);
}

/// Returns the path in /state of the component of a joint.
std::string component_of(std::string_view joint) {
  std::string component = "joint";
  for (const std::string_view step : split(joint, '/')) component += '/' + hdf5_name(step);
  return component;
}

std::vector<RecordedScene::Joint> joints_of(const Json& type) {
  std::vector<RecordedScene::Joint> joints;
  for (const Json& joint : type.value("joints", Json::array()))
    joints.push_back({.component = component_of(text_of(joint.at("name"))),
                      .parent = joint_of(joint, "parent", joints.size()),
                      .pose_body_joint = pose_of(joint.at("pose"))});
  return joints;
}

void add_shapes(const Json& json, RecordedScene::Type& type) {
  engine::FrameType& look = type.look;
  look.mobile = json.contains("drive");
  for (const Json& part : json.at("parts")) {
    const auto index = static_cast<std::uint32_t>(type.part_colors.size());
    type.part_colors.emplace_back();
    std::optional<Color> color;
    if (const auto own = part.find("color"); own != part.end())
      color = Color{own->at(0).get<float>(), own->at(1).get<float>(), own->at(2).get<float>(),
                    own->at(3).get<float>()};
    for (const Json& solid : part.at("solids")) {
      look.shapes.push_back({solid_of(solid), color});
      type.shape_joints.push_back(joint_of(part, "joint", type.joints.size()));
      type.shape_parts.push_back(index);
    }
  }
  look.radius = engine::enclosing_radius(look.shapes);
}

/// Reads a stored block of parameters. `table` describes them; those that are not stored have their default
/// value.
engine::Record record_of(const Json& block, const engine::FieldTable& table) {
  engine::Record record = table.defaults();
  for (std::size_t i = 0; i < table.fields.size(); ++i) {
    const engine::Field& field = table.fields[i];
    const auto found = block.find(key_of(field));
    if (found == block.end()) continue;
    switch (field.type) {
      case engine::FieldType::boolean: record[i] = found->get<bool>(); break;
      case engine::FieldType::integer: record[i] = static_cast<std::int64_t>(number_in_json(*found)); break;
      case engine::FieldType::number: record[i] = number_in_json(*found); break;
      case engine::FieldType::record:
        record[i] = std::vector<engine::Record>{record_of(*found, *field.record)};
        break;
      default: break;  // parameters of transducers have no other types
    }
  }
  return record;
}

std::vector<RecordedScene::Transducer> transducers_of(const Json& ranger) {
  const Pose pose_body_device = pose_of(ranger.at("pose"));
  std::vector<RecordedScene::Transducer> transducers;
  for (const Json& block : ranger.at("params").value("transducers", Json::array())) {
    const auto transducer = engine::from_record<engine::TransducerParams>(
        record_of(block, engine::described<engine::TransducerParams>()));
    if (!(transducer.samples >= 1 && transducer.samples <= k_most_beams)) throw Damaged();
    transducers.push_back({.pose_body_transducer = compose(pose_body_device, transducer.pose),
                           .range_max_m = transducer.range_max,
                           .fov_rad = transducer.fov,
                           .beams = static_cast<std::size_t>(transducer.samples)});
  }
  return transducers;
}

RecordedScene::Type type_of(const Json& json) {
  RecordedScene::Type type;
  type.name = text_of(json.at("name"));
  type.joints = joints_of(json);
  add_shapes(json, type);
  engine::UniqueNames names(engine::k_device_mark);  // as the engine names them
  for (const Json& sensor : json.at("sensors")) {
    std::string name = hdf5_name(names.add(text_of(sensor.at("name"))));
    const auto part = sensor.value("part", std::uint32_t{0});
    if (part >= type.part_colors.size()) throw Damaged();
    type.devices.push_back({name, part});
    if (sensor.at("params").contains("transducers"))  // only kinds of rangers have transducers
      type.rangers.push_back(
          {std::move(name), transducers_of(sensor), joint_of(sensor, "joint", type.joints.size())});
  }
  for (const Json& controller : json.value("controllers", Json::array()))
    type.memories.push_back(fmt::format("{}/{}", text_of(controller.at("kind")), type.memories.size()));
  return type;
}

RecordedScene scene_of(const Json& json, const BodyColumns& columns) {
  RecordedScene scene;
  scene.title = text_of(json.at("title"));
  if (const auto bounds = json.find("bounds_m");
      bounds != json.end() && bounds->is_array() && bounds->size() == 4)
    scene.limits = Box{{number_in_json((*bounds)[0]), number_in_json((*bounds)[1])},
                       {number_in_json((*bounds)[2]), number_in_json((*bounds)[3])}};
  std::vector<std::string> words;
  for (const Json& word : json.at("words")) words.push_back(text_of(word));
  for (const Json& type : json.at("types")) scene.types.push_back(type_of(type));

  const std::size_t bodies = columns.type.size();
  scene.bodies.reserve(bodies);
  for (std::size_t b = 0; b < bodies; ++b) {
    const double* pose = &columns.pose[4 * b];
    const float* color = &columns.color[4 * b];
    if (columns.word[b] >= words.size() || columns.type[b] >= scene.types.size() ||
        !std::all_of(pose, pose + 4, [](double x) { return std::abs(x) <= k_spec_reach_m; }) ||
        !std::all_of(color, color + 4, [](float part) { return std::isfinite(part); }))
      throw Damaged();
    std::string name = words[columns.word[b]];
    if (columns.number[b] != engine::Name::k_no_number) name += std::to_string(columns.number[b]);
    scene.bodies.push_back({.name = std::move(name),
                            .type = columns.type[b],
                            .pose_world_body = {pose[0], pose[1], pose[2], pose[3]},
                            .color = {color[0], color[1], color[2], color[3]}});
  }
  return scene;
}

/// Finds the components that give each type and its parts their shown colours. If several devices of a part
/// show a colour, the first of them is used, as in the engine.
void find_shown_colors(const RecordingReader& recording, RecordedScene& scene) {
  // For each type and part, the index of the device whose colour is shown.
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> best;
  for (const RecordingReader::Array& array : recording.arrays()) {
    if (array.field.name != engine::k_shown_color || array.field.columns != 3 || array.bodies.empty() ||
        !array.component.starts_with("sensors/"))
      continue;
    const std::uint32_t t = scene.bodies[recording.ids()[array.bodies.front()]].type;
    RecordedScene::Type& type = scene.types[t];
    const auto device =
        std::ranges::find(type.devices, array.component.substr(array.component.rfind('/') + 1),
                          &RecordedScene::Type::Device::name);
    if (device == type.devices.end()) continue;
    const auto place = static_cast<std::size_t>(device - type.devices.begin());
    const auto [known, is_first] = best.try_emplace({t, device->part}, place);
    if (!is_first && known->second <= place) continue;
    known->second = place;
    (device->part == 0 ? type.shown_color : type.part_colors[device->part]) = array.component;
  }
}

}  // namespace

Color shown_color(std::span<const double> parts, const Color& of_the_world) {
  if (!std::ranges::all_of(parts, [](double part) { return std::isfinite(part); })) return of_the_world;
  return {static_cast<float>(parts[0]), static_cast<float>(parts[1]), static_cast<float>(parts[2]), 1};
}

RecordedScene recorded_scene(const RecordingReader& recording) {
  const std::optional<BodyColumns> columns = recording.scene();
  if (!columns)
    fail(recording,
         "has no group /scene (walls and colours): an older version of Troupe wrote the file; record the "
         "run again with this version");
  try {
    RecordedScene scene = scene_of(Json::parse(recording.world_json()), *columns);
    find_shown_colors(recording, scene);
    return scene;
  } catch (const Json::exception&) {
    fail(recording, "/world is not a valid world: the file is damaged");
  } catch (const Damaged&) {
    fail(recording, "/world or /scene has values that are not allowed in a world: the file is damaged");
  }
}

RecordedScene recorded_scene(const engine::WorldSpec& spec, const engine::Registry& registry) {
  const StoredSpec stored = store_spec(spec, registry);
  return scene_of(Json::parse(stored.json), stored.bodies);
}

std::optional<engine::Record> recorded_window(const RecordingReader& recording) {
  Diagnostics diagnostics;
  const Where where{diagnostics.files()->add(recording.file().string()), 0};
  const std::optional<JsonNode> document = parse_json(recording.world_json(), where, true, diagnostics);
  std::optional<engine::Record> window;
  if (document) {
    const JsonCursor root(*document, diagnostics);
    JsonObject world(root);
    window = read_block(world, "window", window_fields());
  }
  if (diagnostics.has_errors()) fail(recording, "/world is not a valid world: the file is damaged");
  return window;
}

}  // namespace troupe::worldio
