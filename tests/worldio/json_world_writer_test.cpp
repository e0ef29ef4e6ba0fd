// A world that was written as JSON reads back as the same world, to the last bit.

#include "engine/spec/add_device.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/registry.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/json/json_text.hpp"
#include "worldio/json/json_world.hpp"
#include "worldio/json/spec_difference.hpp"
#include "worldio/window_fields.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace troupe::worldio::json_world_writer_test {
namespace {

using engine::DeviceKind;
using engine::Field;
using engine::FieldTable;
using engine::FieldType;
using engine::Record;
using engine::Value;
using engine::WorldSpec;
using testing::ElementsAre;
using testing::HasSubstr;

const engine::Registry& all_kinds() {
  static const engine::Registry all = make_registry();
  return all;
}

/// Unlikely worlds, within the limits of the format.
class RandomWorld {
 public:
  explicit RandomWorld(unsigned seed) : generator_(seed) {}

  WorldSpec make() {
    engine::add_ground(spec_);
    spec_.title = "random";
    spec_.seed = generator_();
    spec_.tick_s = one_of({0.1, 0.05, 1.0 / 3});
    if (chance()) spec_.quit_time_s = number(0.1, 100);
    if (chance()) spec_.window = record(window_fields());
    if (chance()) spec_.aliases.push_back({spec_.names.add("model:0"), BodyId(0)});
    const int types = below(4) + 1;
    for (int t = 0; t < types; ++t) add_type(t);
    const int bodies = below(6);
    for (int b = 0; b < bodies; ++b) add_body(b);
    return std::move(spec_);
  }

 private:
  int below(int n) { return static_cast<int>(generator_() % static_cast<unsigned>(n)); }
  bool chance() { return below(2) == 0; }
  template <class T>
  T one_of(std::initializer_list<T> values) {
    return *(values.begin() + below(static_cast<int>(values.size())));
  }
  double number(double min, double max) {
    min = std::max(min, -1e3);
    max = std::min(max, 1e3);
    const double any = min + (max - min) * std::uniform_real_distribution<double>()(generator_);
    if (chance()) return any;
    const double round = std::clamp(std::round(any * 100) / 100, min, max);
    return round == 0 && chance() ? -0.0 : round;
  }
  Pose pose() { return {number(-9, 9), number(-9, 9), number(-1, 1), chance() ? 0 : number(-3.1, 3.1)}; }
  Color color() {
    const auto part = [this] { return static_cast<float>(below(256)) / 255.0f; };
    return chance() ? Color{1, 0, 0, 1} : Color{part(), part(), part(), chance() ? 1.0f : part()};
  }

  Value value(const Field& field) {
    const double min = std::max(field.min, -1e6) + (field.above_min ? 0.01 : 0);
    const double max = std::min(field.max, 1e6);
    switch (field.type) {
      case FieldType::boolean: return chance();
      case FieldType::integer:
        return static_cast<std::int64_t>(std::clamp(std::floor(number(min, max)), min, max));
      case FieldType::number: return number(min, max);
      case FieldType::text:
        return field.choices.empty() ? Value("some text, \"quoted\"\n\\")
                                     : Value(std::string(field.choices[static_cast<std::size_t>(
                                           below(static_cast<int>(field.choices.size())))]));
      case FieldType::texts: return std::vector<std::string>(static_cast<std::size_t>(below(3)), "some text");
      case FieldType::color: {
        const Color c = color();
        return std::vector<double>{c.r, c.g, c.b, c.a};
      }
      case FieldType::numbers: {
        std::vector<double> list(field.columns > 0 ? field.columns : static_cast<std::size_t>(below(3)));
        for (double& x : list) x = number(min, max);
        return list;
      }
      case FieldType::colors: {
        std::vector<double> list;
        for (int i = below(3); i > 0; --i) {
          const Color c = color();
          list.insert(list.end(), {c.r, c.g, c.b});
        }
        return list;
      }
      case FieldType::record: return std::vector<Record>{record(*field.record)};
      case FieldType::records: break;
    }
    std::vector<Record> list(static_cast<std::size_t>(below(3)));
    for (Record& one : list) one = record(*field.record);
    return list;
  }
  /// Some fields as they are by default, others not.
  Record record(const FieldTable& table) {
    Record values = table.defaults();
    for (std::size_t i = 0; i < values.size(); ++i)
      if (!values[i].given() || chance()) values[i] = value(table.fields[i]);
    return values;
  }

  Ring ring(int corners, double radius) {
    Ring points;
    for (int i = 0; i < corners; ++i)
      points.emplace_back(radius * std::cos(2 * k_pi * i / corners),
                          radius * std::sin(2 * k_pi * i / corners));
    return points;
  }
  std::vector<Solid> solids() {
    std::vector<Solid> all;
    for (int i = below(3); i > 0; --i) {
      Solid solid{{ring(below(5) + 3, number(0.1, 1))}, {number(-1, 0), number(0.1, 1)}};
      if (chance()) solid.contours.push_back(ring(4, number(0.01, 0.05)));  // a hole
      if (chance()) std::ranges::reverse(solid.contours.front());
      all.push_back(std::move(solid));
    }
    return all;
  }
  engine::Returns returns() {
    if (chance()) return {};
    return {chance(), static_cast<float>(number(-1, 2)), below(9) - 4, below(3), chance(), chance()};
  }

  void add_type(int t) {
    engine::TypeSpec type{.name = chance() ? "same" : "type" + std::to_string(t)};
    engine::PartSpec root{.kind = one_of<const char*>({"model", "ranger", "camera"})};
    root.solids = solids();
    root.returns = returns();
    root.floor_plan = chance();
    root.size = {number(0, 2), number(0, 2), number(0.1, 2)};
    if (chance()) {
      const engine::DriveKind& kind =
          all_kinds().drives[static_cast<std::size_t>(below(static_cast<int>(all_kinds().drives.size())))];
      type.drive =
          engine::DriveSpec{std::string(kind.name), record(kind.params), one_of({0.0, 0.1, 0.7}), {}};
      if (chance()) root.kind = "position";
    }
    type.parts.push_back(std::move(root));
    add_contents(type, 0, engine::k_rigid);
    add_parts(type, 0, engine::k_rigid, 0);
    spec_.types.push_back(std::move(type));
  }

  void add_parts(engine::TypeSpec& type, std::uint32_t parent, std::int32_t joint, int depth) {
    for (int i = depth < 3 ? below(3) : 0; i > 0; --i) {
      const auto p = static_cast<std::uint32_t>(type.parts.size());
      engine::PartSpec part{.name = "part" + std::to_string(p), .parent = parent, .joint = joint};
      if (chance()) part.alias = "other name";
      part.kind = one_of<const char*>({"model", "ranger", "actuator", "gripper"});
      part.pose_body_part = pose();
      part.returns = returns();
      if (chance()) part.color = color();
      part.size = {number(0.1, 2), number(0.1, 2), number(0.1, 2)};
      if (part.kind == "model") part.solids = solids();
      const bool moves = part.kind == "actuator" || part.kind == "gripper";
      type.parts.push_back(part);
      std::int32_t below_joint = joint;
      if (moves) {
        const DeviceKind& kind = *all_kinds().device(part.kind);
        engine::DeviceSpec device{.name = part.name, .kind = part.kind, .part = p, .joint = joint};
        device.params = record(kind.params);
        device.pose_body_device = chance() ? part.pose_body_part : pose();
        const std::size_t d = engine::add_device(type, device, kind);
        if (!kind.body) type.parts[p].joint = below_joint = type.devices[d].moves;
        if (kind.body && chance()) engine::add_device_body(type, d, kind);
      }
      add_contents(type, p, below_joint);
      add_parts(type, p, below_joint, depth + 1);
    }
  }

  void add_contents(engine::TypeSpec& type, std::uint32_t part, std::int32_t joint) {
    for (const char* name : {"ranger", "fiducial", "blobfinder", "blinkenlight", "power_contact"}) {
      if (below(3) > 0) continue;
      const DeviceKind& kind = *all_kinds().device(name);
      engine::DeviceSpec device{
          .name = name + std::to_string(type.devices.size()), .kind = name, .part = part};
      device.joint = chance() ? joint : engine::k_rigid;
      device.params = record(kind.params);
      if (chance()) device.pose_body_device = pose();
      device.period_s = one_of({0.0, 0.1, 0.25});
      device.active = chance();
      type.devices.push_back(std::move(device));
    }
    for (const char* name : {"source", "sink"}) {
      if (below(4) > 0) continue;
      type.controllers.push_back(
          {name, part, record(all_kinds().controller(name)->params), one_of({0.0, 0.3}), {}});
    }
  }

  void add_body(int b) {
    const BodyId id(spec_.bodies.size());
    const TypeId type(1 + static_cast<std::size_t>(below(static_cast<int>(spec_.types.size()) - 1)));
    spec_.bodies.push_back({.name = spec_.names.add(chance() ? "twin" : "body" + std::to_string(b)),
                            .type = type,
                            .pose_world_body = pose(),
                            .color = color()});
    if (chance()) spec_.aliases.push_back({spec_.names.add("alias:" + std::to_string(b)), id});
    const auto& parts = spec_.types[type.index()].parts;
    if (parts.size() > 1 && chance())
      spec_.part_aliases.insert_or_assign(parts.back().name, engine::PartName{id, parts.back().name});
  }

  std::mt19937 generator_;
  WorldSpec spec_;
};

TEST(JsonWorldWriter, RandomWorldsComeBackToTheLastBit) {
  const unsigned worlds = test::k_slow_build ? 20 : 300;
  for (unsigned seed = 1; seed <= worlds; ++seed) {
    const WorldSpec spec = RandomWorld(seed).make();
    Diagnostics diagnostics;
    const auto document = write_json_world(spec, "out/random.json", all_kinds(), diagnostics);
    ASSERT_TRUE(document) << "seed " << seed << ": " << diagnostics.text(diagnostics.findings().front());
    const std::string text = json_text(*document);
    Diagnostics read;
    const WorldSpec back = load_json_world("out/random.json", text, all_kinds(), {}, read);
    ASSERT_FALSE(read.has_errors()) << "seed " << seed << ": " << read.text(read.findings().front());
    ASSERT_EQ(spec_difference(spec, back), "") << "seed " << seed << "\n" << text;
  }
}

// "wheels" are a device with a body, but no model kind: the part that stands for them must be of one.
TEST(JsonWorldWriter, WheelsAmongTheDevicesComeBack) {
  constexpr std::string_view k_text = R"({"troupe": 1, "types": {"cart": {"size_m": [0.5, 0.5, 0.3],
    "devices": [{"name": "feet", "kind": "wheels", "pose": {"z_m": 0.5}, "size_m": [0.1, 0.1, 0.1]}]}},
    "models": [{"name": "cart", "type": "cart"}]})";
  Diagnostics read;
  const WorldSpec spec = load_json_world("out/cart.json", std::string(k_text), all_kinds(), {}, read);
  ASSERT_FALSE(read.has_errors()) << read.text(read.findings().front());
  Diagnostics diagnostics;
  const auto document = write_json_world(spec, "out/cart.json", all_kinds(), diagnostics);
  ASSERT_TRUE(document) << diagnostics.text(diagnostics.findings().front());
  const WorldSpec back = load_json_world("out/cart.json", json_text(*document), all_kinds(), {}, read);
  ASSERT_FALSE(read.has_errors()) << read.text(read.findings().front());
  EXPECT_EQ(spec_difference(spec, back), "") << json_text(*document);
}

TEST(JsonWorldWriter, SeesThatSomethingIsNotSaid) {
  WorldSpec spec = RandomWorld(1).make();
  spec.types[1].parts[0].alias = "roots have no other name";
  Diagnostics diagnostics;
  EXPECT_FALSE(write_json_world(spec, "w.json", all_kinds(), diagnostics));
  ASSERT_TRUE(diagnostics.has_errors());
  EXPECT_THAT(diagnostics.text(diagnostics.findings().front()),
              HasSubstr("w.json: error: a JSON world cannot express this: types[1].parts[0].alias"));
}

std::string written(const WorldSpec& spec) {
  Diagnostics diagnostics;
  const auto document = write_json_world(spec, "w.json", all_kinds(), diagnostics);
  return document ? json_text(*document) : diagnostics.text(diagnostics.findings().front());
}

TEST(JsonWorldWriter, AnglesAreDegreesWhereNothingIsLost) {
  WorldSpec spec;
  engine::add_ground(spec);
  spec.types.push_back({.name = "t", .parts = {{.kind = "model"}}});
  spec.bodies.push_back(
      {.name = spec.names.add("a"), .type = TypeId(1), .pose_world_body = {0, 0, 0, radians(30)}});
  spec.bodies.push_back({.name = spec.names.add("b"), .type = TypeId(1), .pose_world_body = {0, 0, 0, 0.1}});
  const double between = std::nextafter(radians(30), 4);
  spec.bodies.push_back(
      {.name = spec.names.add("c"), .type = TypeId(1), .pose_world_body = {0, 0, 0, between}});
  const std::string text = written(spec);
  EXPECT_THAT(text,
              HasSubstr(R"("name": "a", "type": "t", "pose": {"x_m": 0, "y_m": 0, "heading_deg": 30})"));
  EXPECT_THAT(text,
              HasSubstr(R"("name": "b", "type": "t", "pose": {"x_m": 0, "y_m": 0, "heading_rad": 0.1})"));
  EXPECT_THAT(
      text,
      HasSubstr(
          R"("name": "c", "type": "t", "pose": {"x_m": 0, "y_m": 0, "heading_rad": 0.5235987755982989})"));
}

TEST(JsonText, NumbersAreShortAndComeBack) {
  const auto number = [](double x) { return json_text(json_node(x)); };
  EXPECT_EQ(number(5), "5\n");
  EXPECT_EQ(number(0.1), "0.1\n");
  EXPECT_EQ(number(-0.0), "-0.0\n");
  EXPECT_EQ(number(1e-300), "1e-300\n");
  EXPECT_EQ(json_text(json_node(std::numeric_limits<std::uint64_t>::max())), "18446744073709551615\n");
  EXPECT_THROW(number(std::numeric_limits<double>::infinity()), std::runtime_error);
}

TEST(JsonText, TextsAreUtf8) {
  EXPECT_EQ(json_text(json_node(std::string("a\"\\\n\x01 \xc3\xa9"))),
            "\"a\\\"\\\\\\u000a\\u0001 \xc3\xa9\"\n");
  for (const char* wrong : {"\xe9", "\xc0\x80", "\xed\xa0\x80", "\xf5\x80\x80\x80", "\xe2\x82"})
    EXPECT_THROW(json_text(json_node(std::string(wrong))), std::runtime_error);
}

TEST(JsonText, WhatFitsStandsOnALine) {
  JsonNode::List points;
  for (int i = 0; i < 30; ++i) points.push_back(json_numbers(std::vector<double>{i + 0.5, -i - 0.25}));
  JsonNode::Object object;
  add_member(object, "short", JsonNode::List{json_node(true), json_node(std::monostate())});
  add_member(object, "points", std::move(points));
  const std::string text = json_text(json_node(std::move(object)));
  EXPECT_THAT(text,
              testing::StartsWith("{\n  \"short\": [true, null],\n  \"points\": [\n    [0.5, -0.25], [1.5"));
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    EXPECT_LE(end - at, 110u);
    at = end + 1;
  }
}

}  // namespace
}  // namespace troupe::worldio::json_world_writer_test
