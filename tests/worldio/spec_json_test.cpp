// A stored world comes back to the last bit, without the files that it was loaded from.

#include "worldio/json/spec_json.hpp"
#include "engine/sensor_params.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/registry.hpp"
#include "worldio/load.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <bit>
#include <filesystem>
#include <limits>

namespace troupe::worldio {
namespace {

namespace fs = std::filesystem;
using engine::WorldSpec;
using ::testing::HasSubstr;

using Changes = std::vector<std::pair<std::string, std::string>>;

WorldSpec restored(const StoredSpec& stored, const Changes& changes = {}) {
  Diagnostics diagnostics;
  WorldSpec spec =
      restore_spec(stored, make_registry(), changes, {diagnostics.files()->add("run.h5"), 0}, diagnostics);
  diagnostics.throw_if_errors();
  return spec;
}

std::string errors_of(const StoredSpec& stored, const Changes& changes = {}) {
  try {
    restored(stored, changes);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

/// Equal bits, and equal texts; of a Where the name of its file, since files are numbered by each load.
class Comparison {
 public:
  Comparison(const WorldSpec& a, const WorldSpec& b) : a_(a), b_(b) {}

  void compare() {
    // Each struct is taken apart, so that a field that is added to one must be compared here to compile.
    const auto& [title, files, seed, tick_s, quit_time_s, record, ranging, resolution_m, resolution_where,
                 bounds, types, names, bodies, reserves, mortal, aliases, part_aliases, measures,
                 measure_every_s, watch, window, experiment] = a_;
    EXPECT_EQ(title, b_.title);
    EXPECT_TRUE(files && b_.files);
    EXPECT_EQ(seed, b_.seed);
    same(tick_s, b_.tick_s);
    EXPECT_EQ(quit_time_s, b_.quit_time_s);
    ASSERT_EQ(record.has_value(), b_.record.has_value());
    if (record) same(*record, *b_.record);
    ASSERT_EQ(measures.size(), b_.measures.size());
    for (std::size_t i = 0; i < measures.size(); ++i) same(measures[i], b_.measures[i]);
    same(measure_every_s, b_.measure_every_s);
    EXPECT_EQ(watch, b_.watch);
    EXPECT_EQ(window, b_.window);
    same(experiment, b_.experiment);
    EXPECT_EQ(ranging, b_.ranging);
    same(resolution_m, b_.resolution_m);
    same(resolution_where, b_.resolution_where);
    ASSERT_EQ(bounds.has_value(), b_.bounds.has_value());
    if (bounds) {
      EXPECT_EQ(bounds->min, b_.bounds->min);
      EXPECT_EQ(bounds->max, b_.bounds->max);
    }
    EXPECT_TRUE(std::ranges::equal(names.words(), b_.names.words()));
    ASSERT_EQ(types.size(), b_.types.size());
    for (std::size_t t = 0; t < types.size(); ++t) same(types[t], b_.types[t]);
    ASSERT_EQ(bodies.size(), b_.bodies.size());
    for (std::size_t i = 0; i < bodies.size(); ++i) same(bodies[i], b_.bodies[i]);
    EXPECT_EQ(mortal, b_.mortal);
    ASSERT_EQ(reserves.size(), b_.reserves.size());
    for (std::size_t i = 0; i < reserves.size(); ++i) {
      const auto& [population, first, count] = reserves[i];
      EXPECT_EQ(population, b_.reserves[i].population);
      EXPECT_EQ(first, b_.reserves[i].first);
      EXPECT_EQ(count, b_.reserves[i].count);
    }
    ASSERT_EQ(aliases.size(), b_.aliases.size());
    for (std::size_t i = 0; i < aliases.size(); ++i) {
      const auto& [name, body] = aliases[i];
      EXPECT_EQ(name, b_.aliases[i].name);
      EXPECT_EQ(body, b_.aliases[i].body);
    }
    ASSERT_EQ(part_aliases.size(), b_.part_aliases.size());
    for (const auto& [name, place] : part_aliases) {
      const auto& [body, part] = place;
      EXPECT_EQ(body, b_.part_aliases.at(name).body);
      EXPECT_EQ(part, b_.part_aliases.at(name).part);
    }
  }

 private:
  static void same(double a, double b) {
    EXPECT_EQ(std::bit_cast<std::uint64_t>(a), std::bit_cast<std::uint64_t>(b)) << a << " and " << b;
  }
  void same(const Where& a, const Where& b) {
    EXPECT_EQ(a.line, b.line);
    const auto name = [](const WorldSpec& spec, const Where& where) {
      return where.file == Where::k_no_file ? "" : spec.files->name(where.file);
    };
    EXPECT_EQ(name(a_, a), name(b_, b));
  }
  static void same(const Pose& a, const Pose& b) {
    same(a.x, b.x);
    same(a.y, b.y);
    same(a.z, b.z);
    same(a.heading, b.heading);
  }
  void same(const engine::RecordSpec& a, const engine::RecordSpec& b) {
    const auto& [file, fields, every_s, where, where_fields] = a;
    EXPECT_EQ(file, b.file);
    EXPECT_EQ(fields, b.fields);
    EXPECT_EQ(every_s, b.every_s);
    same(where, b.where);
    same(where_fields, b.where_fields);
  }
  void same(const engine::MeasureSpec& a, const engine::MeasureSpec& b) {
    const auto& [kind, name, of, params, where] = a;
    EXPECT_EQ(kind, b.kind);
    EXPECT_EQ(name, b.name);
    EXPECT_EQ(of, b.of);
    EXPECT_EQ(params, b.params);
    same(where, b.where);
  }
  // Of an experiment no places are kept: what could be wrong with it was found when the world was made.
  static void same(const engine::GroupSpec& a, const engine::GroupSpec& b) {
    const auto& [by, name, count, share] = a;
    EXPECT_EQ(by, b.by);
    EXPECT_EQ(name, b.name);
    EXPECT_EQ(count, b.count);
    EXPECT_EQ(share, b.share);
  }
  void same(const engine::ExperimentSpec& a, const engine::ExperimentSpec& b) {
    const auto& [stop_when, at, faults] = a;
    ASSERT_EQ(stop_when.size(), b.stop_when.size());
    for (std::size_t i = 0; i < stop_when.size(); ++i) {
      const auto& [measure, comparison, value] = stop_when[i];
      EXPECT_EQ(measure.params, b.stop_when[i].measure.params);
      EXPECT_EQ(engine::text_of(stop_when[i]), engine::text_of(b.stop_when[i]));
      EXPECT_EQ(comparison, b.stop_when[i].comparison);
      same(value, b.stop_when[i].value);
    }
    ASSERT_EQ(at.size(), b.at.size());
    for (std::size_t i = 0; i < at.size(); ++i) {
      const auto& [time_s, action, whom, pose, region, setting, where] = at[i];
      static_cast<void>(where);
      const engine::InterventionSpec& other = b.at[i];
      same(time_s, other.time_s);
      EXPECT_EQ(action, other.action);
      same(whom, other.whom);
      EXPECT_EQ(pose, other.pose);
      ASSERT_EQ(region.has_value(), other.region.has_value());
      if (region) {
        EXPECT_EQ(region->min, other.region->min);
        EXPECT_EQ(region->max, other.region->max);
      }
      ASSERT_EQ(setting.has_value(), other.setting.has_value());
      if (!setting) continue;
      const auto& [type, of, index, params] = *setting;
      EXPECT_EQ(type, other.setting->type);
      EXPECT_EQ(of, other.setting->of);
      EXPECT_EQ(index, other.setting->index);
      EXPECT_EQ(params, other.setting->params);
    }
    ASSERT_EQ(faults.size(), b.faults.size());
    for (std::size_t i = 0; i < faults.size(); ++i) {
      const auto& [whom, from_s, ailments, where] = faults[i];
      static_cast<void>(where);
      same(whom, b.faults[i].whom);
      same(from_s, b.faults[i].from_s);
      ASSERT_EQ(ailments.size(), b.faults[i].ailments.size());
      for (std::size_t k = 0; k < ailments.size(); ++k) {
        EXPECT_EQ(ailments[k].kind, b.faults[i].ailments[k].kind);
        EXPECT_EQ(ailments[k].params, b.faults[i].ailments[k].params);
      }
    }
  }
  void same(const engine::PartSpec& a, const engine::PartSpec& b) {
    const auto& [name, alias, kind, parent, joint, pose, size, solids, returns, floor_plan, image, fitted,
                 color, where] = a;
    static_cast<void>(image);  // are not kept
    static_cast<void>(fitted);
    EXPECT_EQ(joint, b.joint);
    EXPECT_EQ(name, b.name);
    EXPECT_EQ(alias, b.alias);
    EXPECT_EQ(kind, b.kind);
    EXPECT_EQ(parent, b.parent);
    same(pose, b.pose_body_part);
    EXPECT_EQ(size, b.size);
    EXPECT_EQ(solids, b.solids);
    EXPECT_EQ(returns, b.returns);
    EXPECT_EQ(floor_plan, b.floor_plan);
    EXPECT_EQ(color, b.color);
    same(where, b.where);
  }
  void same(const engine::JointSpec& a, const engine::JointSpec& b) {
    const auto& [name, parent, pose] = a;
    EXPECT_EQ(name, b.name);
    EXPECT_EQ(parent, b.parent);
    same(pose, b.pose_body_joint);
  }
  void same(const engine::DriveSpec& a, const engine::DriveSpec& b) {
    const auto& [kind, params, period_s, where] = a;
    EXPECT_EQ(kind, b.kind);
    EXPECT_EQ(params, b.params);
    same(period_s, b.period_s);
    same(where, b.where);
  }
  void same(const engine::DeviceSpec& a, const engine::DeviceSpec& b) {
    const auto& [name, kind, part, joint, moves, params, pose, period_s, active, where] = a;
    EXPECT_EQ(joint, b.joint);
    EXPECT_EQ(moves, b.moves);
    EXPECT_EQ(name, b.name);
    EXPECT_EQ(kind, b.kind);
    EXPECT_EQ(params, b.params);
    EXPECT_EQ(part, b.part);
    same(pose, b.pose_body_sensor);
    same(period_s, b.period_s);
    EXPECT_EQ(active, b.active);
    same(where, b.where);
  }
  void same(const engine::ControllerSpec& a, const engine::ControllerSpec& b) {
    const auto& [kind, part, params, period_s, where] = a;
    EXPECT_EQ(kind, b.kind);
    EXPECT_EQ(part, b.part);
    EXPECT_EQ(params, b.params);
    same(period_s, b.period_s);
    same(where, b.where);
  }
  void same(const engine::TypeSpec& a, const engine::TypeSpec& b) {
    const auto& [name, parts, joints, drive, sensors, controllers] = a;
    ASSERT_EQ(joints.size(), b.joints.size());
    for (std::size_t i = 0; i < joints.size(); ++i) same(joints[i], b.joints[i]);
    EXPECT_EQ(name, b.name);
    ASSERT_EQ(parts.size(), b.parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i) same(parts[i], b.parts[i]);
    ASSERT_EQ(drive.has_value(), b.drive.has_value());
    if (drive) same(*drive, *b.drive);
    ASSERT_EQ(sensors.size(), b.devices.size());
    for (std::size_t i = 0; i < sensors.size(); ++i) same(sensors[i], b.devices[i]);
    ASSERT_EQ(controllers.size(), b.controllers.size());
    for (std::size_t i = 0; i < controllers.size(); ++i) same(controllers[i], b.controllers[i]);
  }
  void same(const engine::BodySpec& a, const engine::BodySpec& b) {
    const auto& [name, type, pose, color, fiducial, where] = a;
    EXPECT_EQ(name, b.name);
    EXPECT_EQ(type, b.type);
    same(pose, b.pose_world_body);
    EXPECT_EQ(color, b.color);
    EXPECT_EQ(fiducial, b.fiducial);
    same(where, b.where);
  }

  const WorldSpec& a_;
  const WorldSpec& b_;
};

void expect_comes_back(const WorldSpec& spec) {
  const WorldSpec back = restored(store_spec(spec, make_registry()));
  Comparison(spec, back).compare();
}

WorldSpec loaded(const fs::path& file, std::optional<std::size_t> robots = std::nullopt) {
  Diagnostics diagnostics;
  LoadOptions options;
  if (robots) options.robots = {{"", *robots}};
  WorldSpec spec = load_world(file, make_registry(), options, diagnostics);
  diagnostics.throw_if_errors();
  return spec;
}

/// A spec in which every field has a value that is not its default.
WorldSpec full_spec() {
  const engine::Registry registry = make_registry();
  WorldSpec spec;
  spec.title = "Caf\xe9 \xff, in Latin 1";
  spec.files = std::make_shared<SourceFiles>();
  spec.files->add("a.world");
  const std::uint32_t file = spec.files->add("ma\xdf.inc");
  spec.seed = std::numeric_limits<std::uint64_t>::max();
  spec.tick_s = 0.1 + 1e-17;
  spec.quit_time_s = 1.0 / 3;
  spec.record = engine::RecordSpec{"a.h5", {"pose", "ranges"}, 0.3, {file, 1}, {file, 2}};
  spec.measures = {{"coverage", "fine", "r", {0.1}, {file, 4}}, {"neighbours", "", "", {2.5}, {file, 5}}};
  spec.measure_every_s = 0.7;
  spec.ranging = engine::RangingEngine::grid;
  spec.resolution_m = 0.1;
  spec.resolution_where = {file, 3};
  spec.bounds.emplace();
  spec.bounds->extend(Vec2(-1.0 / 3, -2));
  spec.bounds->extend(Vec2(1e-300, 5e5));
  engine::add_ground(spec);
  engine::TypeSpec type{.name = "bot"};
  engine::PartSpec part{.name = "ranger:0", .alias = "r/\"\\\n\t", .kind = "ranger"};
  part.pose_body_part = {-0.0, 5e-324, 1e5 / 3, 3};
  part.size = {1.0 / 7, 2, 3};
  part.solids = {{{{{0.1, 0.2}, {0.3, -0.0}, {1, 1}}, {}}, {0.1, 0.7}}};
  part.returns = {
      .obstacle = false, .ranger = 0.1f, .fiducial = -7, .fiducial_key = 3, .gripper = true, .blob = false};
  part.floor_plan = true;
  part.color = Color{0.1f, 0.2f, 0.3f, 0.4f};
  part.where = {file, 7};
  type.parts = {part, part, part};
  type.parts[2].parent = 1;
  type.drive = engine::DriveSpec{"omni", registry.drive("omni")->params.defaults(), 0.25, {file, 8}};
  const auto give = [](const engine::FieldTable& table, engine::Record& record, std::string_view name,
                       engine::Value value) {
    record.at(static_cast<std::size_t>(table.find(name))) = std::move(value);
  };
  give(registry.drive("omni")->params, type.drive->params, "velocity_min_x", -1.0 / 3);
  engine::DeviceSpec sensor{
      .name = "eye", .kind = "ranger", .params = registry.device("ranger")->params.defaults()};
  const engine::Record fan = engine::described<engine::TransducerParams>().defaults();
  give(registry.device("ranger")->params, sensor.params, "transducers",
       std::vector<engine::Record>{fan, fan});
  sensor.part = 2;
  sensor.pose_body_sensor = {0.1, 0.2, 0.3, 0.4};
  sensor.period_s = 0.3;
  sensor.active = false;
  sensor.where = {file, 9};
  type.devices = {sensor};
  type.controllers = {{"script", 0, registry.controller("script")->params.defaults(), 0, {file, 10}},
                      {"expand", 1, registry.controller("expand")->params.defaults(), 0.7, {file, 11}}};
  give(registry.controller("script")->params, type.controllers[0].params, "legs",
       std::vector<engine::Record>{{1.5, 0.1, 0.2, -0.3}, {2.5, 0.1, 0.2, -0.3}});
  const engine::FieldTable& expand = registry.controller("expand")->params;
  give(expand, type.controllers[1].params, "clearances", std::vector<double>{0.1, 0.2});
  give(expand, type.controllers[1].params, "invert", true);
  spec.types.push_back(type);
  spec.bodies.push_back({.name = spec.names.add("r", 17),
                         .type = TypeId(1),
                         .pose_world_body = {1e-17, -0.0, 3, 4},
                         .color = {0.5f, 0.25f, 0.1f, 0.9f},
                         .fiducial = -5,
                         .where = {file, 12}});
  spec.bodies.push_back({.name = spec.names.add("b", 0), .type = TypeId(1)});
  spec.bodies.push_back({.name = spec.names.add("b", 1), .type = TypeId(1)});
  spec.reserves = {{"b\xe9", BodyId(2), 2}};
  spec.mortal = true;
  spec.aliases.push_back({spec.names.add("position:0"), BodyId(1)});
  spec.part_aliases["/x\xff"] = {BodyId(1), "ranger:0"};
  spec.experiment.stop_when = {{spec.measures[1], engine::Comparison::at_least, 1.0 / 3},
                               {{"alive", "", "r", {}, {file, 5}}, engine::Comparison::unequal, -2}};
  spec.experiment.stop_when[0].measure.params = {0.1};
  engine::Record faster(registry.drive("omni")->params.fields.size());
  faster[1] = 2.0 / 3;
  engine::Record named(registry.device("ranger")->params.fields.size());
  named[0] = std::vector<engine::Record>{fan};
  using enum engine::InterventionSpec::Action;
  using By = engine::GroupSpec::By;
  Box region;
  region.extend(Vec2(-1.0 / 3, 0));
  region.extend(Vec2(2, 0.1));
  const auto done = [&](double time_s, engine::InterventionSpec::Action action, engine::GroupSpec whom) {
    engine::InterventionSpec& at = spec.experiment.at.emplace_back();
    at.time_s = time_s;
    at.action = action;
    at.whom = std::move(whom);
    at.where = {file, 20};
    return &at;
  };
  done(0.1, remove, {By::population, "r", 3, {}});
  done(1.0 / 3, add, {By::population, "more", {}, {}})->region = region;
  done(2, disable, {By::type, "bot", {}, 1.0 / 3});
  done(3, enable, {By::model, "r17", {}, {}});
  done(4, move, {By::model, "r17", {}, {}})->pose = Pose{0.1, -0.0, 0.3, 1.0 / 3};
  done(5, set, {})->setting = {TypeId(1), engine::SettingSpec::Of::drive, 0, faster};
  done(6, set, {})->setting = {TypeId(1), engine::SettingSpec::Of::device, 0, named};
  done(7, set, {})->setting = {TypeId(1), engine::SettingSpec::Of::controller, 1, {0.1}};
  spec.experiment.at.back().setting->params.resize(registry.controller("expand")->params.fields.size());
  spec.experiment.faults = {
      {{By::type, "bot", {}, 0.1},
       1.0 / 7,
       {{"dead_sensors", {"ranger:0"}}, {"slow_wheels", {0.3}}, {"drop_out", {0.01, 5.0}}},
       {file, 30}}};
  return spec;
}

TEST(SpecJson, EveryFieldComesBackToTheLastBit) { expect_comes_back(full_spec()); }

class ShippedWorld : public ::testing::TestWithParam<scenes::Run> {};
INSTANTIATE_TEST_SUITE_P(SpecJson, ShippedWorld, ::testing::ValuesIn(scenes::runs_of("store")),
                         [](const auto& run) { return run.param.name(); });

TEST_P(ShippedWorld, ComesBackToTheLastBit) {
  const scenes::Run& run = GetParam();
  expect_comes_back(loaded(run.file(), test::k_slow_build ? run.robots_slow : run.robots));
}

TEST(SpecJson, ReadsLikeTheWorldFormat) {
  const auto json = nlohmann::json::parse(
      spec_to_json(loaded(fs::path(TROUPE_SOURCE_DIR) / "worlds/crowd.json"), make_registry()));
  for (const char* key : {"title", "seed", "tick_s", "ranging", "types", "words"})
    EXPECT_TRUE(json.contains(key));
  EXPECT_EQ(json["types"][0]["name"], "ground");
  EXPECT_FALSE(json["types"][0].contains("drive"));
  for (const auto& type : json["types"])
    EXPECT_TRUE(!type.contains("drive") || type["drive"]["params"].contains("velocity_max_x_mps")) << type;
}

TEST(SpecJson, RefusesWhatJsonCannotSay) {
  WorldSpec spec = full_spec();
  spec.types[1].parts[0].size.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(spec_to_json(spec, make_registry()), std::runtime_error);
}

TEST(SpecJson, AFallbackOutsideOfItsOwnLimitsIsLeftOut) {
  engine::Registry registry = make_registry();
  registry.drives[0].params.fields.push_back(
      {.name = "slip", .fallback = 0.0, .min = 0, .text = "nothing is none", .above_min = true});
  WorldSpec spec = full_spec();
  spec.types[1].drive = engine::DriveSpec{"diff", registry.drive("diff")->params.defaults(), 0, {}};
  const StoredSpec stored = store_spec(spec, registry);
  EXPECT_THAT(stored.json, ::testing::Not(HasSubstr("slip")));
  Diagnostics diagnostics;
  const WorldSpec back =
      restore_spec(stored, registry, {}, {diagnostics.files()->add("run.h5"), 0}, diagnostics);
  diagnostics.throw_if_errors();
  EXPECT_EQ(back.types[1].drive->params, spec.types[1].drive->params);
}

TEST(SpecJson, ChangesWhatKeepsTheShapeOfTheState) {
  const StoredSpec stored = store_spec(full_spec(), make_registry());
  const WorldSpec spec = restored(stored, {{"/seed", "9"},
                                           {"/quit_time_s", "70"},
                                           {"/ranging", "exact"},
                                           {"/resolution_m", "0.5"},
                                           {"/bounds_m", "[-1, -2, 3, 4]"},
                                           {"/types/1/drive/period_s", "0.5"},
                                           {"/types/1/drive/params/velocity_max_x_mps", "0.125"},
                                           {"/types/1/sensors/0/active", "true"},
                                           {"/types/1/controllers/1/params/speed_mps", "0.75"}});
  EXPECT_EQ(spec.seed, 9u);
  EXPECT_EQ(spec.quit_time_s, 70);
  EXPECT_EQ(spec.ranging, engine::RangingEngine::exact);
  EXPECT_EQ(spec.resolution_m, 0.5);
  EXPECT_EQ(spec.bounds->max.y(), 4);
  EXPECT_EQ(spec.types[1].drive->period_s, 0.5);
  const engine::Registry registry = make_registry();
  const auto number = [](const engine::FieldTable& table, const engine::Record& record,
                         std::string_view name) { return engine::get(table, record, name).number(); };
  EXPECT_EQ(number(registry.drive("omni")->params, spec.types[1].drive->params, "velocity_max_x"), 0.125);
  EXPECT_TRUE(spec.types[1].devices[0].active);
  EXPECT_EQ(number(registry.controller("expand")->params, spec.types[1].controllers[1].params, "speed"),
            0.75);
}

TEST(SpecJson, RefusesOtherChangesAndWrongValues) {
  const StoredSpec stored = store_spec(full_spec(), make_registry());
  const std::vector<std::pair<Changes::value_type, std::string>> cases{
      {{"/tick_s", "1"},
       "--set /tick_s: error: a world that is under way keeps this; what can change: /seed, "},
      {{"/types/1/parts/0/obstacle", "true"}, "keeps this"},
      {{"/types/1/drive", "{}"}, "keeps this"},
      {{"/types/1/drive/params", "{}"}, "keeps this"},
      {{"/types/1/drive/kind", "diff"}, "keeps this"},
      {{"/types/1/controllers/0/period_s", "1"}, "keeps this"},
      {{"/types/1/sensors/0/name", "x"}, "keeps this"},
      {{"/words/0", "x"}, "keeps this"},
      {{"", "1"}, "keeps this"},
      {{"/seed", "-1"}, "--set /seed: error: /seed: expected a whole number from 0 to 2^64 - 1"},
      {{"/ranging", "gird"}, "unknown ranging \"gird\""},
      {{"/resolution_m", "0"}, "must be from 0.0001 to 100"},
      {{"/bounds_m", "[1, 1, 0, 0]"}, "[x_min, y_min, x_max, y_max]"},
      {{"/types/7/drive/period_s", "1"}, "/types has 2 entries"},
      {{"/types/0/drive/period_s", "1"}, "/types/0 has no \"drive\""},
      {{"/types/1/drive/params/velocity_max_x_mps", "fast"}, "expected a number in m/s"},
      {{"/types/1/drive/params/velocity_max_x_mpss", "1"}, "unknown key \"velocity_max_x_mpss\""},
  };
  for (const auto& [change, message] : cases)
    EXPECT_THAT(errors_of(stored, {change}), HasSubstr(message)) << change.first;
}

TEST(SpecJson, RefusesTextsThatAreNoStoredWorld) {
  const StoredSpec good = store_spec(full_spec(), make_registry());
  for (const auto& [json, message] : std::vector<std::pair<std::string, std::string>>{
           {"", "run.h5: error: "},
           {"[]", "run.h5: error: expected an object"},
           {"{}", "run.h5: error: missing \"title\""},
           {good.json.substr(0, good.json.size() / 2), "run.h5: error: "}}) {
    StoredSpec bad = good;
    bad.json = json;
    EXPECT_THAT(errors_of(bad), HasSubstr(message));
  }
  // Each key in turn is taken out, or holds something else.
  const auto document = nlohmann::ordered_json::parse(good.json);
  const auto leaves = document.flatten();
  const auto other = nlohmann::ordered_json::object();
  for (const auto& leaf : leaves.items()) {
    const nlohmann::ordered_json::json_pointer pointer(leaf.key());
    auto damaged = document;
    if (damaged[pointer] == other) continue;
    damaged[pointer] = other;
    StoredSpec bad = good;
    bad.json = damaged.dump();
    EXPECT_THAT(errors_of(bad), HasSubstr("run.h5: error: ")) << leaf.key();
  }
}

TEST(SpecJson, RefusesBodiesOfAnotherWorld) {
  const StoredSpec good = store_spec(full_spec(), make_registry());
  const auto expect = [&](auto damage, const std::string& message) {
    StoredSpec bad = good;
    damage(bad.bodies);
    EXPECT_EQ(errors_of(bad), "run.h5: error: " + message);
  };
  expect([](BodyColumns& c) { c.pose.pop_back(); }, "the columns of the bodies have not all the same length");
  expect([](BodyColumns& c) { c = {}; }, "there is no body: the first of every world is the ground");
  expect([](BodyColumns& c) { c.type[1] = 2; }, "a body is of a type that is not there");
  expect([](BodyColumns& c) { c.word[1] = 99; }, "a body has a name that is not there");
  expect([](BodyColumns& c) { c.alias_body[0] = 9; }, "a name is of a body that is not there");
  expect([](BodyColumns& c) { c.pose[5] = std::numeric_limits<double>::quiet_NaN(); },
         "a body stands nowhere");
  expect([](BodyColumns& c) { c.type[1] = 0; }, "\"/x\xff\" names a part that is not there");
}

}  // namespace
}  // namespace troupe::worldio
