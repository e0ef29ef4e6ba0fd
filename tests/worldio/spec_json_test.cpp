// A stored world reads back to the last bit, without the files from which it was loaded.

#include "worldio/json/spec_json.hpp"
#include "engine/kinds/sensor_params.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/registry.hpp"
#include "worldio/json/spec_difference.hpp"
#include "worldio/load.hpp"
#include "worldio/window_fields.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <limits>

namespace troupe::worldio::spec_json_test {
namespace {

namespace fs = std::filesystem;
using engine::WorldSpec;
using ::testing::HasSubstr;

using Changes = std::vector<std::pair<std::string, std::string>>;

WorldSpec restored(const StoredSpec& stored, const Changes& changes, std::vector<ParameterChange>& parameters,
                   const engine::Registry& registry = make_registry()) {
  Diagnostics diagnostics;
  WorldSpec spec = restore_spec(stored, registry, changes, {diagnostics.files()->add("run.h5"), 0},
                                diagnostics, parameters);
  diagnostics.throw_if_errors();
  return spec;
}

WorldSpec restored(const StoredSpec& stored, const Changes& changes = {}) {
  std::vector<ParameterChange> parameters;
  return restored(stored, changes, parameters);
}

std::string errors_of(const StoredSpec& stored, const Changes& changes = {}) {
  try {
    restored(stored, changes);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

void expect_comes_back(const WorldSpec& spec) {
  const WorldSpec back = restored(store_spec(spec, make_registry()));
  EXPECT_EQ(spec_difference(spec, back, Places::compared), "");
  EXPECT_EQ(hash_of_content(spec), hash_of_content(back));
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
  const std::uint32_t first = spec.files->add("a.world");
  const std::uint32_t file = spec.files->add("ma\xdf.inc");
  spec.seed = std::numeric_limits<std::uint64_t>::max();
  spec.tick_s = 0.1 + 1e-17;
  spec.quit_time_s = 1.0 / 3;
  spec.record = engine::RecordSpec{"a.h5", {"pose", "ranges"}, 0.3, {file, 1}, {file, 2}};
  spec.measures = {{"coverage", "fine", "r", {0.1}, {file, 4}}, {"neighbours", "", "", {2.5}, {file, 5}}};
  spec.measure_every_s = 0.7;
  spec.ranging = engine::RangingEngine::grid;
  spec.resolution_m = 0.1;
  spec.resolution_where = {first, 3};
  spec.watch = {.clock = true, .clock_ticks = 7, .rate = 1.0 / 3, .paused = true};
  spec.window = window_fields().defaults();
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
  const auto put = [](const engine::FieldTable& table, engine::Record& record, std::string_view name,
                      engine::Value value) {
    record.at(static_cast<std::size_t>(table.find(name))) = std::move(value);
  };
  put(registry.drive("omni")->params, type.drive->params, "velocity_min_x", -1.0 / 3);
  engine::DeviceSpec sensor{
      .name = "eye", .kind = "ranger", .params = registry.device("ranger")->params.defaults()};
  const engine::Record fan = engine::described<engine::TransducerParams>().defaults();
  put(registry.device("ranger")->params, sensor.params, "transducers", std::vector{fan, fan});
  sensor.part = 2;
  sensor.pose_body_device = {0.1, 0.2, 0.3, 0.4};
  sensor.period_s = 0.3;
  sensor.active = false;
  sensor.where = {file, 9};
  type.devices = {sensor};
  type.controllers = {{"script", 0, registry.controller("script")->params.defaults(), 0, {file, 10}},
                      {"expand", 1, registry.controller("expand")->params.defaults(), 0.7, {file, 11}}};
  put(registry.controller("script")->params, type.controllers[0].params, "legs",
      std::vector<engine::Record>{{1.5, 0.1, 0.2, -0.3}, {2.5, 0.1, 0.2, -0.3}});
  const engine::FieldTable& expand = registry.controller("expand")->params;
  put(expand, type.controllers[1].params, "clearances", std::vector<double>{0.1, 0.2});
  put(expand, type.controllers[1].params, "invert", true);
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
  spec.empty_populations = {{"none", TypeId(0)}, {"n\xe9", TypeId(1)}};
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

/// Another value of the same type.
nlohmann::ordered_json other_than(const nlohmann::ordered_json& value) {
  if (value.is_boolean()) return !value.get<bool>();
  if (value.is_string()) return value.get<std::string>() + "x";
  if (value.is_number_unsigned()) return value.get<std::uint64_t>() / 2 + 1;
  if (value.is_number_integer()) return value.get<std::int64_t>() + 1;
  return value.get<double>() / 2 + 1.0 / 1024;
}

TEST(SpecJson, AnyOtherValueIsAnotherWorldOrNone) {
  const WorldSpec spec = full_spec();
  const StoredSpec good = store_spec(spec, make_registry());
  const auto document = nlohmann::ordered_json::parse(good.json);
  const auto leaves = document.flatten();
  std::size_t others = 0;
  for (const auto& leaf : leaves.items()) {
    if (leaf.value().is_null() || leaf.value().is_structured()) continue;  // an empty list or object
    const auto changed = other_than(leaf.value());
    if (changed == leaf.value() || leaf.value() == Where::k_no_file) continue;  // another no-file is none too
    auto damaged = document;
    damaged[nlohmann::ordered_json::json_pointer(leaf.key())] = changed;
    StoredSpec bad = good;
    bad.json = damaged.dump();
    try {
      EXPECT_NE(spec_difference(spec, restored(bad), Places::compared), "") << leaf.key();
      ++others;
    } catch (const InputError&) {
    }
  }
  EXPECT_GT(others, 250u);
}

TEST(SpecJson, ADifferenceSaysWhereItIs) {
  const WorldSpec spec = full_spec();
  const auto difference = [&spec](auto change, Places places = Places::ignored) {
    WorldSpec other = spec;
    change(other);
    return spec_difference(spec, other, places);
  };
  EXPECT_EQ(difference([](WorldSpec& s) { s.types[1].parts[2].solids[0].contours[0][1].y() = 0; }),
            "types[1].parts[2].solids[0].contours[0][1]");
  EXPECT_EQ(difference([](WorldSpec& s) { s.types[1].parts[1].returns.pushable = true; }),
            "types[1].parts[1].pushable");
  EXPECT_EQ(difference([](WorldSpec& s) { s.types[1].drive.reset(); }), "types[1].drive");
  EXPECT_EQ(difference([](WorldSpec& s) { s.types[1].devices[0].params.front() = 1.0; }),
            "types[1].sensors[0].params");
  EXPECT_EQ(difference([](WorldSpec& s) { s.bodies[1].pose_world_body.y = 0.0; }), "bodies[1].pose.y");
  EXPECT_EQ(difference([](WorldSpec& s) { s.bodies[2].name = s.names.add("c", 0); }), "bodies[2].name");
  EXPECT_EQ(difference([](WorldSpec& s) { s.part_aliases.clear(); }), "part_names");
  EXPECT_EQ(difference([](WorldSpec& s) { s.experiment.at[2].whom.share.reset(); }),
            "experiment.at[2].whom.share");
  EXPECT_EQ(difference([](WorldSpec& s) { s.experiment.at[2].where.line = 1; }, Places::compared), "");
  EXPECT_EQ(difference([](WorldSpec& s) { s.names.add("unused"); }, Places::compared), "");
  EXPECT_EQ(difference([](WorldSpec& s) { s.bodies[1].where.line = 1; }), "");
  EXPECT_EQ(difference([](WorldSpec& s) { s.bodies[1].where.line = 1; }, Places::compared),
            "bodies[1].where");
  EXPECT_EQ(difference([](WorldSpec& s) { s.types[1].parts[0].image.emplace(); }, Places::compared), "");
}

TEST(SpecJson, TheHashOfTheContentShowsWhatAffectsStates) {
  const WorldSpec spec = full_spec();
  const auto differs = [&spec](auto change) {
    WorldSpec other = spec;
    change(other);
    return hash_of_content(spec) != hash_of_content(other);
  };
  EXPECT_TRUE(differs([](WorldSpec& s) { s.types[1].parts[2].solids[0].contours[0][1].y() = 0; }));
  EXPECT_TRUE(differs([](WorldSpec& s) { s.types[1].devices[0].params.front() = 1.0; }));
  EXPECT_TRUE(differs([](WorldSpec& s) { s.bodies[1].pose_world_body.y = 0.0; }));
  EXPECT_TRUE(differs([](WorldSpec& s) { s.bodies[2].name = s.names.add("c", 0); }));
  EXPECT_TRUE(differs([](WorldSpec& s) { s.part_aliases.clear(); }));
  EXPECT_TRUE(differs([](WorldSpec& s) { s.aliases.pop_back(); }));
  EXPECT_TRUE(differs([](WorldSpec& s) { s.experiment.at[2].whom.share.reset(); }));
  EXPECT_FALSE(differs([](WorldSpec& s) {
    s.title += "x";
    s.quit_time_s = 77;
    s.record.reset();
    s.watch = {};
    s.mortal = !s.mortal;
    s.names.add("unused");
    s.bodies[1].where.line = 1;
    s.types[1].drive->where.line = 1;
    s.experiment.at[2].where.line = 1;
  }));
}

class ShippedWorld : public ::testing::TestWithParam<scenes::Run> {};
INSTANTIATE_TEST_SUITE_P(SpecJson, ShippedWorld, ::testing::ValuesIn(scenes::runs_of("store")),
                         [](const auto& run) { return run.param.name(); });

TEST_P(ShippedWorld, ComesBackToTheLastBit) {
  const scenes::Run& run = GetParam();
  expect_comes_back(loaded(run.file(), test::k_slow_build ? run.robots_slow : run.robots));
}

TEST(SpecJson, ReadsLikeTheWorldFormat) {
  const auto json =
      nlohmann::json::parse(spec_to_json(loaded(test::source_dir() / "worlds/crowd.json"), make_registry()));
  for (const char* key : {"title", "seed", "tick_s", "ranging", "types", "words"})
    EXPECT_TRUE(json.contains(key));
  EXPECT_EQ(json["types"][0]["name"], "ground");
  EXPECT_FALSE(json["types"][0].contains("drive"));
  for (const auto& type : json["types"])
    EXPECT_TRUE(!type.contains("drive") || type["drive"]["params"].contains("velocity_max_x_mps")) << type;
}

TEST(SpecJson, StoresEmptyPopulationsOnlyIfThereAreSome) {
  WorldSpec spec = full_spec();
  EXPECT_THAT(spec_to_json(spec, make_registry()), ::testing::HasSubstr("empty_populations"));
  spec.empty_populations.clear();
  EXPECT_THAT(spec_to_json(spec, make_registry()), ::testing::Not(::testing::HasSubstr("empty_populations")));
  expect_comes_back(spec);
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
  std::vector<ParameterChange> parameters;
  const WorldSpec back = restored(stored, {}, parameters, registry);
  EXPECT_EQ(back.types[1].drive->params, spec.types[1].drive->params);
}

TEST(SpecJson, ChangesWhatKeepsTheShapeOfTheState) {
  const WorldSpec full = full_spec();
  const StoredSpec stored = store_spec(full, make_registry());
  std::vector<ParameterChange> parameters;
  const WorldSpec spec = restored(stored,
                                  {{"/seed", "9"},
                                   {"/quit_time_s", "70"},
                                   {"/ranging", "exact"},
                                   {"/resolution_m", "0.5"},
                                   {"/bounds_m", "[-1, -2, 3, 4]"},
                                   {"/types/1/drive/period_s", "0.5"},
                                   {"/types/1/drive/params/velocity_max_x_mps", "0.125"},
                                   {"/types/1/sensors/0/active", "true"},
                                   {"/types/1/controllers/1/params/speed_mps", "0.75"},
                                   {"/types/1/drive/params/velocity_min_x_mps", "-0.25"}},
                                  parameters);
  EXPECT_EQ(spec.seed, 9u);
  EXPECT_EQ(spec.quit_time_s, 70);
  EXPECT_EQ(spec.ranging, engine::RangingEngine::exact);
  EXPECT_EQ(spec.resolution_m, 0.5);
  EXPECT_EQ(spec.bounds->max.y(), 4);
  std::vector<ParameterChange> none;
  const WorldSpec as_in_a_world = restored(stored, {{"/bounds_m", "[[-1, -2], [3, 4]]"}}, none);
  EXPECT_EQ(as_in_a_world.bounds->min, spec.bounds->min);
  EXPECT_EQ(as_in_a_world.bounds->max, spec.bounds->max);
  EXPECT_EQ(spec.types[1].drive->period_s, 0.5);
  const engine::Registry registry = make_registry();
  const auto number = [](const engine::FieldTable& table, const engine::Record& record,
                         std::string_view name) { return engine::get(table, record, name).number(); };
  EXPECT_TRUE(spec.types[1].devices[0].active);

  // Parameters do not change in the spec, but are returned: one entry for each drive, device or controller.
  EXPECT_EQ(spec.types[1].drive->params, full.types[1].drive->params);
  EXPECT_EQ(spec.types[1].controllers[1].params, full.types[1].controllers[1].params);
  ASSERT_EQ(parameters.size(), 2u);
  const engine::SettingSpec& drive = parameters[0].setting;
  EXPECT_EQ(parameters[0].pointer, "/types/1/drive/params/velocity_max_x_mps");
  EXPECT_EQ(drive.type.value, 1u);
  EXPECT_EQ(drive.of, engine::SettingSpec::Of::drive);
  EXPECT_EQ(number(registry.drive("omni")->params, drive.params, "velocity_max_x"), 0.125);
  EXPECT_EQ(number(registry.drive("omni")->params, drive.params, "velocity_min_x"), -0.25);
  EXPECT_EQ(std::ranges::count_if(drive.params, &engine::Value::given), 2);
  const engine::SettingSpec& controller = parameters[1].setting;
  EXPECT_EQ(controller.of, engine::SettingSpec::Of::controller);
  EXPECT_EQ(controller.index, 1u);
  EXPECT_EQ(number(registry.controller("expand")->params, controller.params, "speed"), 0.75);
}

TEST(SpecJson, RefusesOtherChangesAndWrongValues) {
  const StoredSpec stored = store_spec(full_spec(), make_registry());
  const std::vector<std::pair<Changes::value_type, std::string>> cases{
      {{"/tick_s", "1"},
       "--set /tick_s: error: this value of the world in a checkpoint cannot be changed; these values "
       "can: /seed, "},
      {{"/types/1/parts/0/obstacle", "true"}, "cannot be changed"},
      {{"/types/1/drive", "{}"}, "cannot be changed"},
      {{"/types/1/drive/params", "{}"}, "cannot be changed"},
      {{"/types/1/drive/kind", "diff"}, "cannot be changed"},
      {{"/types/1/controllers/0/period_s", "1"}, "cannot be changed"},
      {{"/types/1/sensors/0/name", "x"}, "cannot be changed"},
      {{"/words/0", "x"}, "cannot be changed"},
      {{"", "1"}, "cannot be changed"},
      {{"/seed", "-1"}, "--set /seed: error: /seed: expected a whole number from 0 to 2^64 - 1"},
      {{"/ranging", "gird"}, "unknown ranging \"gird\""},
      {{"/resolution_m", "fine"}, "expected a number in m"},
      {{"/bounds_m", "[1, 1, 0, 0]"}, "[x_min, y_min, x_max, y_max]"},
      {{"/bounds_m", "[[1, 1], [0]]"}, "/bounds_m: expected a list of 4 numbers"},
      {{"/types/7/drive/period_s", "1"}, "/types is a list of length 2"},
      {{"/types/0/drive/period_s", "1"}, "/types/0 has no key \"drive\""},
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

TEST(SpecJson, RefusesWordsThatNoNamesHave) {
  const StoredSpec good = store_spec(full_spec(), make_registry());
  const auto error_of = [&](auto damage) {
    auto document = nlohmann::ordered_json::parse(good.json);
    damage(document["words"]);
    StoredSpec bad = good;
    bad.json = document.dump();
    return errors_of(bad);
  };
  EXPECT_THAT(error_of([](auto& words) { words.clear(); }),
              HasSubstr("/words: Names(): the list of words is empty: the first word must be \"\""));
  EXPECT_THAT(error_of([](auto& words) { words[0] = "x"; }),
              HasSubstr("/words: Names(): the first word is \"x\": the first word must be \"\""));
  EXPECT_THAT(error_of([](auto& words) { words[1] = words[2]; }),
              HasSubstr("occurs twice: words must be unique"));
}

TEST(SpecJson, RefusesBodiesOfAnotherWorld) {
  const StoredSpec good = store_spec(full_spec(), make_registry());
  const auto expect = [&](auto damage, const std::string& message) {
    StoredSpec bad = good;
    damage(bad.bodies);
    EXPECT_EQ(errors_of(bad), "run.h5: error: " + message);
  };
  expect([](BodyColumns& c) { c.pose.pop_back(); },
         "the file is damaged: the columns of the bodies differ in length");
  expect([](BodyColumns& c) { c = {}; },
         "the file is damaged: it has no bodies, but every world has at least the ground");
  expect([](BodyColumns& c) { c.type[1] = 2; },
         "bodies[1].type: the world has 2 types, found index 2 (counted from 0)");
  expect([](BodyColumns& c) { c.word[1] = 99; },
         "bodies[1].name: the list of name words has 5 entries, found index 99 (counted from 0)");
  expect([](BodyColumns& c) { c.alias_word[0] = 99; },
         "aliases[0].name: the list of name words has 5 entries, found index 99 (counted from 0)");
  expect([](BodyColumns& c) { c.alias_body[0] = 9; },
         "aliases[0].body: the world has 4 bodies, found index 9 (counted from 0)");
  expect([](BodyColumns& c) { c.pose[5] = std::numeric_limits<double>::quiet_NaN(); },
         "the file is damaged: bodies[1].pose.y: must be from -1000000 to 1000000, found nan");
  expect([](BodyColumns& c) { c.type[1] = 0; },
         "part_names: \"/x\xff\" refers to a part that does not exist");
}

}  // namespace
}  // namespace troupe::worldio::spec_json_test
