// `stop_when`, `at` and `faults` of JSON worlds: how they are read, and the errors.

#include "worldio/json/experiment_json.hpp"
#include "tests/worldio/json_test_world.hpp"
#include "troupe/registry.hpp"
#include "worldio/json/json_document.hpp"
#include "worldio/json/json_text.hpp"
#include "worldio/json/json_world.hpp"
#include "worldio/json/spec_difference.hpp"
#include "worldio/load.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace troupe::worldio::experiment_json_test {
namespace {

using engine::Comparison;
using engine::GroupSpec;
using engine::InterventionSpec;
using engine::SettingSpec;
using engine::WorldSpec;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Action = InterventionSpec::Action;
using By = GroupSpec::By;

struct Loaded {
  Diagnostics diagnostics;
  WorldSpec spec;
  std::vector<std::string> found;

  explicit Loaded(const std::string& keys) {
    const std::string text = fmt::format(R"({{"troupe": 1,
"types": {{
  "bot": {{"size_m": [0.2, 0.2, 0.1], "drive": {{"kind": "diff"}},
          "sensors": [{{"name": "ir", "kind": "ranger", "transducers": [{{"range_max_m": 2}}]}}],
          "controller": {{"kind": "expand_swarm"}}}},
  "crate": {{"name": "Big crate", "size_m": [1, 1, 1]}}
}},
"populations": [{{"name": "r", "type": "bot", "count": 4, "reserve": 2,
  "place": {{"rule": "grid", "region_m": [[0, 0], [1, 1]], "pitch_m": 0.25}}}}],
{}
}})",
                                         keys);
    spec = load_json_world("maze.json", text, registry(), {}, diagnostics);
    found = findings(diagnostics);
  }
  static const engine::Registry& registry() {
    static const engine::Registry kinds = make_registry();
    return kinds;
  }
};

TEST(ExperimentJson, ConditionsAreRead) {
  const Loaded loaded(R"("stop_when": ["coverage >= 0.9", "stalls:r>100", " alive == 0 ",
    {"measure": {"kind": "coverage", "cell_m": 0.5, "name": "fine"}, "is": "!= -1.5e3"}, "alive<=4", "alive < 4"])");
  ASSERT_THAT(loaded.found, IsEmpty());
  const auto& conditions = loaded.spec.experiment.stop_when;
  std::vector<std::string> texts;
  for (const engine::StopSpec& condition : conditions) texts.push_back(engine::text_of(condition));
  EXPECT_THAT(texts, ElementsAre("coverage >= 0.9", "stalls:r > 100", "alive == 0", "fine != -1500",
                                 "alive <= 4", "alive < 4"));
  EXPECT_EQ(conditions[0].comparison, Comparison::at_least);
  EXPECT_EQ(conditions[1].measure.of, "r");
  EXPECT_EQ(conditions[3].measure.params, (engine::Record{0.5}));
  EXPECT_EQ(conditions[0].measure.where.line, 10u);
}

TEST(ExperimentJson, ManySettingsOfManyTypesFindTheirTypes) {
  constexpr std::size_t k_many = 100000;  // searching all types for each setting would take a minute or more
  WorldSpec spec;
  spec.types.resize(k_many);
  std::vector<std::string> keys;
  for (std::size_t t = 0; t < k_many; ++t) keys.push_back(fmt::format("type {:06}", t));
  ExperimentDocument document;
  document.at.resize(k_many);
  for (InterventionDocument& entry : document.at) entry.set.emplace().type = keys.back();
  Diagnostics diagnostics;
  expand_experiment(document, DocumentPath({}, diagnostics), {}, keys, Loaded::registry(), spec);
  EXPECT_THAT(findings(diagnostics), IsEmpty());
  ASSERT_EQ(spec.experiment.at.size(), k_many);
  EXPECT_EQ(spec.experiment.at.back().setting.value().type, TypeId(k_many - 1));
}

TEST(ExperimentJson, AWrongValueCausesNoErrorInWhatDependsOnIt) {
  const auto found = [](const std::string& types, const std::string& keys) {
    Diagnostics diagnostics;
    load_json_world("maze.json", "{\"troupe\": 1,\n\"types\": " + types + ",\n\"models\": [" + keys + "}",
                    Loaded::registry(), {}, diagnostics);
    return findings(diagnostics);
  };
  const auto only = [](const std::string& error) {
    return ElementsAre(testing::StartsWith("maze.json:2: error: " + error));
  };
  const std::string model =
      R"({"name": "m", "type": "bot", "global_parts": ["arm"], "fiducial_return": 2}],)";
  // Each type has one error. What refers to the type, or to what it would have, causes no other.
  const std::string uses = model + R"(
  "at": [{"time_s": 1, "set": {"type": "bot", "drive": {"velocity_max_x_mps": 1}}},
         {"time_s": 1, "set": {"type": "bot", "device": {"name": "lamp", "shows": [1, 1, 1]}}},
         {"time_s": 1, "set": {"type": "bot", "controller": {"kind": "wander", "cruise_speed_mps": 1}}}])";
  const std::string bot = R"({"bot": {"size_m": [1, 1, 1], )";
  EXPECT_THAT(found("3", uses), only("/types: expected an object"));
  EXPECT_THAT(found(R"({"bot": 3})", uses), only("/types/bot: expected an object, found the number 3"));
  EXPECT_THAT(found(bot + R"("drive": {"kind": "dif"}, "controllers": 3}})", uses),
              ElementsAre(testing::HasSubstr("/types/bot/drive/kind: unknown drive"),
                          testing::HasSubstr("/types/bot/controllers: expected a list")));
  // A device that could not be read may be the one that another device stands on or that a list names.
  EXPECT_THAT(
      found(
          bot +
              R"("devices": [{"name": "pan", "kind": "actuatr"}, {"name": "lamp", "kind": "led", "on": "pan"}],
    "sensors": [{"name": "eye", "kind": "camera", "on": "pan"}], "device_order": ["eye", "pan", "lamp"]}})",
          model + R"("same_names": "warn")"),
      only("/types/bot/devices/0/kind: unknown device \"actuatr\""));
  EXPECT_THAT(found(bot + R"("device_order": [3]}})", R"({"name": "m", "type": "bot"}])"),
              only("/types/bot/device_order/0: expected the name of a device, found the number 3"));
  // A model without a right type.
  EXPECT_THAT(found(R"({"box": {"size_m": [1, 1, 1]}})", model + R"("same_names": "warn")"),
              ElementsAre(testing::HasSubstr("/models/0/type: unknown type \"bot\"")));
  // A condition on a measure that could not be read.
  for (const char* measures : {"3", "[3]", R"([{"kind": "coverage", "name": 3}])"})
    EXPECT_THAT(
        found("{}", "],\n\"measures\": " + std::string(measures) + R"(, "stop_when": ["fine >= 0.9"])"),
        ElementsAre(testing::HasSubstr("/measures")));
  EXPECT_THAT(found("{}", R"(], "floorplans": [{"name": "f"}])"),
              ElementsAre(testing::HasSubstr("/floorplans/0: a floor plan needs \"bitmap\"")));
  // The kind of a device that is a part follows from the model type, so that an heir need not name it either.
  EXPECT_THAT(
      found(bot + R"("kind": "ranger", "device": {"transducers": []}},
    "heir": {"extends": "bot", "device": {"activ": true}}})",
            "]"),
      ElementsAre(testing::StartsWith("maze.json:3: error: /types/heir/device: unknown key \"activ\"")));
}

TEST(ExperimentJson, AnEmptyListOfMeasuresIsAnError) {
  EXPECT_THAT(
      Loaded(R"("measures": [])").found,
      ElementsAre("maze.json:10: error: /measures: the list is empty: give at least one entry, or remove "
                  "the key, for all measures that need no parameters"));
}

TEST(ExperimentJson, ConditionsMayNameMeasuresOfTheWorld) {
  const Loaded loaded(R"("measures": [{"kind": "coverage", "cell_m": 0.5, "name": "fine"},
    {"kind": "coverage", "cell_m": 0.25, "name": "stalls"}],
    "stop_when": ["fine >= 0.9", "stalls > 3"])");
  ASSERT_THAT(loaded.found, IsEmpty());
  const auto& conditions = loaded.spec.experiment.stop_when;
  ASSERT_EQ(conditions.size(), 2u);
  EXPECT_EQ(engine::text_of(conditions[0]), "fine >= 0.9");
  EXPECT_EQ(conditions[0].measure.kind, "coverage");
  EXPECT_EQ(conditions[0].measure.params, (engine::Record{0.5}));
  EXPECT_EQ(conditions[0].measure.where.line, 12u);
  EXPECT_EQ(conditions[1].measure.kind, "stalls") << "kinds of measures come first";

  const Loaded wrong(R"("measures": [{"kind": "coverage", "cell": 0.5, "name": "fine"}],
    "stop_when": ["fine >= 0.9"])");
  EXPECT_THAT(wrong.found, ElementsAre(HasSubstr("maze.json:10: error: /measures/0: ")));
}

TEST(ExperimentJson, AConditionOnAMisspelledMeasureOfTheWorldIsTold) {
  const Loaded wrong(R"("measures": [{"kind": "coverage", "name": "visited"}],
    "stop_when": ["visitd >= 0.9"])");
  EXPECT_THAT(wrong.found,
              ElementsAre(testing::AllOf(
                  HasSubstr("maze.json:11: error: /stop_when/0: unknown measure \"visitd\"; known: alive, "),
                  testing::EndsWith(", visited (did you mean \"visited\"?)"))));
}

TEST(ExperimentJson, WrongConditionsAreTold) {
  const auto found = [](const std::string& condition) {
    const Loaded loaded("\"stop_when\": [\n" + condition + "]");
    return loaded.found.empty() ? std::string("nothing") : loaded.found.front();
  };
  EXPECT_THAT(found(R"("covrage >= 0.9")"),
              HasSubstr("maze.json:11: error: /stop_when/0: unknown measure \"covrage\"; known: alive, "));
  EXPECT_THAT(found(R"("covrage >= 0.9")"), HasSubstr("(did you mean \"coverage\"?)"));
  EXPECT_THAT(
      found(R"("coverage")"),
      HasSubstr(
          "expected a condition on a measure, as in \"coverage >= 0.9\", with one of <, <=, >, >=, ==, != "
          "and a number, found the text \"coverage\""));
  EXPECT_THAT(found(R"("coverage = 0.9")"), HasSubstr("\"= 0.9\" is not a comparison"));
  EXPECT_THAT(found(R"("coverage >= 90 %")"), HasSubstr("\">= 90 %\" is not a comparison"));
  EXPECT_THAT(found(R"("coverage >= nan")"), HasSubstr("is not a comparison"));
  EXPECT_THAT(found(R"("> 3")"), HasSubstr("expected a condition on a measure"));
  EXPECT_THAT(found("3"), HasSubstr("expected a condition on a measure"));
  EXPECT_THAT(found(R"({"measure": "alive"})"), HasSubstr("missing \"is\""));
  EXPECT_THAT(found(R"({"measure": "alive", "is": "0"})"), HasSubstr("is not a comparison"));
  EXPECT_THAT(found(R"({"measure": "alive", "is": "> 0", "at": 1})"), HasSubstr("unknown key \"at\""));
}

TEST(ExperimentJson, InterventionsAreRead) {
  const Loaded loaded(R"("at": [
    {"time_s": 30, "remove": {"population": "r", "count": 2}},
    {"time_ms": 500, "add": {"population": "r", "count": 1, "region_m": [[0, 1], [2, 3]]}},
    {"time_s": 1, "add": {"population": "r", "pose": {"x_m": 4, "heading_deg": 90}}},
    {"time_s": 2, "disable": {"type": "bot", "share": 0.5}},
    {"time_s": 3, "enable": {"model": "r0"}},
    {"time_s": 4, "move": {"model": "r1", "pose": {"x_m": 7}}},
    {"time_s": 5, "set": {"type": "bot", "drive": {"velocity_max_x_mps": 0.1}}},
    {"time_s": 6, "set": {"type": "bot", "device": {"name": "ir", "transducers": [{"range_max_m": 1}]}}},
    {"time_s": 7, "set": {"type": "bot", "controller": {"kind": "expand_swarm", "speed_mps": 0.2}}}
  ])");
  ASSERT_THAT(loaded.found, IsEmpty());
  const auto& at = loaded.spec.experiment.at;
  ASSERT_EQ(at.size(), 9u);
  EXPECT_EQ(at[0].time_s, 30);
  EXPECT_EQ(at[0].action, Action::remove);
  EXPECT_EQ(at[0].whom.by, By::population);
  EXPECT_EQ(at[0].whom.name, "r");
  EXPECT_EQ(at[0].whom.count, 2);
  EXPECT_EQ(at[0].where.line, 11u);
  EXPECT_EQ(at[1].time_s, 0.5);
  EXPECT_EQ(at[1].action, Action::add);
  EXPECT_EQ(at[1].region->max, Vec2(2, 3));
  EXPECT_EQ(at[2].pose, (Pose{4, 0, 0, radians(90)}));
  EXPECT_FALSE(at[2].whom.count);
  EXPECT_EQ(at[3].action, Action::disable);
  EXPECT_EQ(at[3].whom.by, By::type);
  EXPECT_EQ(at[3].whom.share, 0.5);
  EXPECT_EQ(at[4].action, Action::enable);
  EXPECT_EQ(at[5].action, Action::move);
  EXPECT_EQ(at[5].pose, (Pose{7, 0, 0, 0}));
  const engine::FieldTable& drive = Loaded::registry().drive("diff")->params;
  EXPECT_EQ(at[6].setting->of, SettingSpec::Of::drive);
  EXPECT_EQ(engine::get(drive, at[6].setting->params, "velocity_max_x"), engine::Value(0.1));
  EXPECT_FALSE(engine::get(drive, at[6].setting->params, "velocity_min_x").given());
  EXPECT_EQ(at[7].setting->of, SettingSpec::Of::device);
  const engine::FieldTable& ranger = Loaded::registry().device("ranger")->params;
  EXPECT_EQ(engine::get(ranger, at[7].setting->params, "transducers").records().size(), 1u);
  EXPECT_EQ(at[8].setting->of, SettingSpec::Of::controller);
  const engine::FieldTable& expand = Loaded::registry().controller("expand")->params;
  EXPECT_EQ(engine::get(expand, at[8].setting->params, "speed"), engine::Value(0.2));
}

TEST(ExperimentJson, WrongInterventionsAreTold) {
  const auto found = [](const std::string& entry) {
    const Loaded loaded("\"at\": [\n" + entry + "]");
    return loaded.found.empty() ? std::string("nothing") : loaded.found.front();
  };
  EXPECT_THAT(found(R"({"remove": {"population": "r"}})"),
              HasSubstr("maze.json:11: error: /at/0: missing \"time_s\" or \"time_ms\": simulated time of "
                        "the intervention"));
  EXPECT_THAT(found(R"({"time": 3, "remove": {"population": "r"}})"), HasSubstr("\"time\" needs its unit"));
  EXPECT_THAT(found(R"({"time_s": -1, "remove": {"population": "r"}})"), HasSubstr("/at/0/time_s: must be"));
  EXPECT_THAT(found(R"({"time_s": 1})"),
              HasSubstr("no action: give one of remove, add, disable, enable, move, set"));
  EXPECT_THAT(found(R"({"time_s": 1, "remvoe": {"population": "r"}})"), HasSubstr("unknown key \"remvoe\""));
  EXPECT_THAT(found(R"({"time_s": 1, "remove": {"model": "r1"}, "enable": {"model": "r2"}})"),
              HasSubstr("give each action an entry of its own"));
  EXPECT_THAT(found(R"({"time_s": 1, "remove": {"count": 3}})"),
              HasSubstr("/at/0/remove: give exactly one of \"population\", \"type\" and \"model\""));
  EXPECT_THAT(found(R"({"time_s": 1, "remove": {"model": "r1", "type": "bot"}})"),
              HasSubstr("\"type\" and \"model\", not several"));
  EXPECT_THAT(found(R"({"time_s": 1, "remove": {"population": "r", "count": 1, "share": 0.2}})"),
              HasSubstr("give \"count\" or \"share\", not both"));
  EXPECT_THAT(found(R"({"time_s": 1, "remove": {"population": "r", "share": 2}})"),
              HasSubstr("/at/0/remove/share: must be from 0 to 1, found 2"));
  EXPECT_THAT(found(R"({"time_s": 1, "add": {"count": 2}})"), HasSubstr("missing \"population\""));
  EXPECT_THAT(found(R"({"time_s": 1, "add": {"population": "r", "region_m": [[3, 3], [1, 1]]}})"),
              HasSubstr("the corners are in the wrong order"));
  EXPECT_THAT(found(R"({"time_s": 1, "move": {"model": "r1"}})"),
              HasSubstr("missing \"pose\": the new pose"));
  EXPECT_THAT(found(R"({"time_s": 1, "set": {"type": "bto", "drive": {"turn_max_degps": 3}}})"),
              HasSubstr("/at/0/set/type: unknown type \"bto\"; known: bot, crate (did you mean \"bot\"?)"));
  EXPECT_THAT(found(R"({"time_s": 1, "set": {"type": "Big crate", "drive": {"turn_max_degps": 3}}})"),
              HasSubstr("; \"Big crate\" is the \"name\" of a type: give its key in \"types\", \"crate\""));
  EXPECT_THAT(found(R"({"time_s": 1, "set": {"type": "crate", "drive": {"turn_max_degps": 3}}})"),
              HasSubstr("type \"crate\" has no drive"));
  EXPECT_THAT(found(R"({"time_s": 1, "set": {"type": "bot"}})"),
              HasSubstr("give exactly one of \"drive\", \"device\" and \"controller\""));
  EXPECT_THAT(found(R"({"time_s": 1, "set": {"type": "bot", "drive": {}}})"),
              HasSubstr("expected at least one parameter"));
  EXPECT_THAT(found(R"({"time_s": 1, "set": {"type": "bot", "device": {"name": "it"}}})"),
              HasSubstr("unknown device \"it\"; known: ir"));
  EXPECT_THAT(found(R"({"time_s": 1, "set": {"type": "bot", "controller": {"kind": "wander"}}})"),
              HasSubstr("unknown controller of this type \"wander\"; known: expand"));
  EXPECT_THAT(found(R"({"time_s": 1, "set": {"type": "bot", "drive": {"speed": 3}}})"),
              HasSubstr("unknown key \"speed\""));
  EXPECT_THAT(found("3"), HasSubstr("/at/0: expected an object"));
}

TEST(ExperimentJson, FaultsAreReadAndWrongOnesTold) {
  const Loaded loaded(R"("faults": [
    {"population": "r", "share": 0.3, "from_s": 5, "slow_wheels": {"factor": 0.5}, "dead_sensors": {}},
    {"type": "bot", "drop_out": {"rate_per_s": 0.01, "for_s": 20}}])");
  ASSERT_THAT(loaded.found, IsEmpty());
  const auto& faults = loaded.spec.experiment.faults;
  ASSERT_EQ(faults.size(), 2u);
  EXPECT_EQ(faults[0].from_s, 5);
  EXPECT_EQ(faults[0].whom.share, 0.3);
  ASSERT_EQ(faults[0].impairments.size(), 2u);
  EXPECT_EQ(faults[0].impairments[0].kind, "dead_sensors") << "in the order of the registry";
  EXPECT_EQ(faults[0].impairments[1].params, (engine::Record{0.5}));
  EXPECT_EQ(faults[1].from_s, 0);
  EXPECT_EQ(faults[1].impairments[0].params, (engine::Record{0.01, 20.0}));

  const auto found = [](const std::string& entry) {
    const Loaded wrong("\"faults\": [\n" + entry + "]");
    return wrong.found.empty() ? std::string("nothing") : wrong.found.front();
  };
  EXPECT_THAT(found(R"({"population": "r"})"),
              HasSubstr("maze.json:11: error: /faults/0: the entry names no fault: add at least one of the "
                        "keys dead_sensors, slow_wheels, "
                        "drop_out"));
  EXPECT_THAT(found(R"({"population": "r", "slow_wheel": {"factor": 1}})"),
              HasSubstr("unknown key \"slow_wheel\""));
  EXPECT_THAT(found(R"({"population": "r", "slow_wheels": {"factor": 0}})"),
              HasSubstr("/faults/0/slow_wheels/factor: must be above 0 and at most 1, found 0"));
  EXPECT_THAT(found(R"({"population": "r", "drop_out": {}})"), HasSubstr("missing \"rate_per_s\""));
}

TEST(ExperimentJson, IsWrittenAsItReadsBack) {
  const Loaded loaded(
      R"("stop_when": ["coverage >= 0.9", {"measure": {"kind": "coverage", "cell_m": 0.5, "name": "fine"}, "is": "> 0.8"}],
  "at": [{"time_s": 30, "remove": {"population": "r", "count": 2}},
    {"time_s": 1, "add": {"population": "r", "pose": {"x_m": 4, "heading_deg": 90}}},
    {"time_s": 2, "disable": {"type": "bot", "share": 0.5}},
    {"time_s": 7, "set": {"type": "bot", "controller": {"kind": "expand", "speed_mps": 0.2}}}],
  "faults": [{"type": "bot", "drop_out": {"rate_per_s": 0.01, "for_s": 20}, "dead_sensors": {"sensors": "ir"}}])");
  ASSERT_THAT(loaded.found, IsEmpty());
  Diagnostics diagnostics;
  const auto document = write_json_world(loaded.spec, "out.json", Loaded::registry(), diagnostics);
  ASSERT_TRUE(document) << (diagnostics.has_errors() ? findings(diagnostics).front() : "");
  const std::string text = json_text(*document);
  EXPECT_THAT(text, HasSubstr("\"coverage >= 0.9\""));
  EXPECT_THAT(text, HasSubstr("\"is\": \"> 0.8\""));
  const WorldSpec back = load_json_world("out.json", text, Loaded::registry(), {}, diagnostics);
  EXPECT_EQ(spec_difference(loaded.spec, back), "");
  WorldSpec other = back;
  other.experiment.at[2].whom.share = 0.4;
  EXPECT_EQ(spec_difference(loaded.spec, other), "experiment.at[2].whom.share");
}

TEST(ExperimentJson, ConditionsOfNamesThatNoTextHoldsAreWrittenAsObjects) {
  for (const std::string of : {"a<b", "a>b", "a=b", "go!", "r ", " r"}) {
    const Loaded loaded(
        fmt::format(R"("stop_when": [{{"measure": {{"kind": "stalls", "of": "{}"}}, "is": ">= 3"}}])", of));
    ASSERT_THAT(loaded.found, IsEmpty()) << of;
    Diagnostics diagnostics;
    const auto document = write_json_world(loaded.spec, "out.json", Loaded::registry(), diagnostics);
    ASSERT_TRUE(document) << of;
    const WorldSpec back =
        load_json_world("out.json", json_text(*document), Loaded::registry(), {}, diagnostics);
    EXPECT_EQ(spec_difference(loaded.spec, back), "") << of;
  }
}

// ---- places

TEST(PlacementJson, RulesAreReadAndWhatDoesNotFitIsCounted) {
  const auto found = [](const std::string& place, const std::string& size = "[0.2, 0.2, 0.1]") {
    Diagnostics diagnostics;
    load_json_world(
        "maze.json",
        fmt::format(R"({{"troupe": 1, "types": {{"bot": {{"size_m": {}, "drive": {{"kind": "diff"}}}}}},
"populations": [{{"name": "r", "type": "bot", "count": 200,
"place": {}}}]}})",
                    size, place),
        Loaded::registry(), {}, diagnostics);
    const auto lines = findings(diagnostics);
    return lines.empty() ? std::string("nothing") : lines.front();
  };
  EXPECT_EQ(found(R"({"rule": "gaussian", "mean_m": [3, 4], "deviation_m": [2, 2]})"), "nothing");
  EXPECT_EQ(found(R"({"rule": "poisson_disc", "distance_m": 0.5, "region_m": [[0, 0], [20, 20]]})"),
            "nothing");
  EXPECT_EQ(found(R"({"rule": "uniform", "polygon_m": [[0, 0], [20, 0], [0, 20]]})"), "nothing");
  EXPECT_EQ(found(R"({"rule": "free_floor", "region_m": [[0, 0], [9, 9]], "from_m": [1, 1], "cell_m": 0.2})"),
            "nothing");
  EXPECT_THAT(
      found(R"({"rule": "poisson_disc", "distance_m": 1, "region_m": [[0, 0], [5, 5]]})"),
      ::testing::MatchesRegex(
          "maze.json:3: error: /populations/0/place: placed [12][0-9] of 200 bodies: "
          "none of 1000 random poses for the next body was free; enlarge the region or lower the count"));
  EXPECT_THAT(found(R"({"rule": "gaussian", "mean_m": [3, 4], "deviation_m": [0, 0]})"),
              HasSubstr("placed 1 of 200 bodies"));
  EXPECT_THAT(found(R"({"rule": "gaussian", "mean_m": [3, 4]})"), HasSubstr("missing \"deviation_m\""));
  EXPECT_THAT(found(R"({"rule": "uniform"})"),
              HasSubstr("(or \"polygon_m\"), which is needed because the world has no bounds"));
  EXPECT_THAT(found(R"({"rule": "uniform", "polygon_m": [[0, 0], [2, 2], [2, 0], [0, 2]]})"),
              HasSubstr("/populations/0/place/polygon_m: "));
  std::string points = "[0, 0]";
  for (int i = 1; i < 100000; ++i) points += fmt::format(", [{}, 1]", i);  // its check would take minutes
  EXPECT_THAT(found(fmt::format(R"({{"rule": "uniform", "polygon_m": [{}]}})", points)),
              HasSubstr("/populations/0/place/polygon_m: expected 3 to 1000 points, found 100000"));
  EXPECT_THAT(found(R"({"rule": "poison_disc"})"),
              HasSubstr("known: free_floor, gaussian, grid, poisson_disc, "
                        "uniform (did you mean \"poisson_disc\"?)"));
  EXPECT_THAT(found(R"({"rule": "free_floor", "region_m": [[0, 0], [90000, 90000]]})"),
              HasSubstr("give a larger \"cell_m\""));
  EXPECT_THAT(found(R"({"rule": "uniform", "region_m": [[0, 0], [9, 9]], "pitch_m": 1})"),
              HasSubstr("unknown key \"pitch_m\""));
}

}  // namespace
}  // namespace troupe::worldio::experiment_json_test
