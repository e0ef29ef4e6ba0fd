#include "worldio/results/replay_data.hpp"

#include "base/diagnostics.hpp"
#include "tests/support/scratch.hpp"
#include "tests/worldio/replay_unpacked.hpp"
#include "troupe/recording.hpp"
#include "worldio/results/recorded_scene.hpp"
#include "worldio/results/replay_plan.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace troupe::worldio::replay_data_test {
namespace {

using test::Unpacked;
using test::unpacked;
using ::testing::HasSubstr;
using ::testing::NanSensitiveDoubleEq;
using ::testing::Pointwise;

// Two types, in an order that is not that of the page; a wall; a sensor of one of them; a part with a colour.
constexpr const char* k_world = R"({
  "troupe": 1, "seed": 4,
  "types": {
    "cart": {"size_m": [0.3, 0.2, 0.2], "drive": {"kind": "diff"}},
    "bot": {"size_m": [0.2, 0.2, 0.1], "drive": {"kind": "diff"}, "controller": {"kind": "wander"},
            "sensors": [{"name": "eye", "kind": "ranger", "transducers": [
              {"range_max_m": 2, "samples": 9, "fov_deg": 90},
              {"pose": {"x_m": -0.1, "heading_deg": 180}, "range_max_m": 1.5}]}]},
    "wall": {"size_m": [4, 0.1, 1]}
  },
  "models": [
    {"name": "b0", "type": "bot", "color": "red"},
    {"name": "c0", "type": "cart", "pose": {"x_m": 1.5}},
    {"name": "b1", "type": "bot", "pose": {"y_m": -1, "heading_deg": 40}, "color": [0, 0.5, 1]},
    {"name": "north", "type": "wall", "pose": {"y_m": 2}, "color": "gray"}
  ]
})";

class Replay : public test::ScratchTest {
 protected:
  void SetUp() override {
    if (!has_hdf5()) GTEST_SKIP() << "built without HDF5";
  }
  /// Runs the world for some seconds and records it.
  std::filesystem::path record(double seconds, const RecordingOptions& options = {},
                               const char* world = k_world) {
    Simulation simulation(write("w.json", world));
    RecordingOptions all = options;
    all.replace = true;
    for (const std::string& name : simulation.robot_names())
      if (name == "c0")
        simulation.find(name).set_speed(0.1, 1);  // it has no controller: it goes round and round
    Recording recording(folder_ / "run.h5", simulation, all);
    while (simulation.time_s() < seconds - 1e-9) {
      simulation.step();
      recording.observe(simulation);
    }
    recording.close();
    return folder_ / "run.h5";
  }
  std::string error_of(const std::filesystem::path& file, const ReplayOptions& options = {}) {
    try {
      replay_data(RecordingReader(file), options);
    } catch (const InputError& error) {
      return error.what();
    } catch (const Hdf5Error& error) {
      return error.what();
    }
    ADD_FAILURE() << "no error";
    return {};
  }
  /// A number of the recording.
  template <class T>
  static T recorded(const RecordingReader& recording, const std::string& component, const std::string& field,
                    std::size_t frame, std::size_t at) {
    for (const RecordingReader::Array& array : recording.arrays()) {
      if (array.component != component || array.field.name != field) continue;
      std::vector<T> values(array.bodies.size() * array.field.columns);
      recording.read(array, frame, std::as_writable_bytes(std::span(values)));
      return values.at(at);
    }
    throw std::out_of_range(field);
  }
};

TEST_F(Replay, ShownColoursAndLightsAreRecordedWithPoses) {
  const char* const world = R"({
    "troupe": 1,
    "types": {
      "bot": {"size_m": [0.3, 0.2, 0.2], "drive": {"kind": "diff"}, "color": "blue",
              "devices": [{"name": "light", "kind": "blinkenlight"},
                          {"name": "lamp", "kind": "led", "shows": [0, 0.5, 1]},
                          {"name": "other", "kind": "led", "shows": [1, 1, 1]}]}
    },
    "models": [{"name": "a", "type": "bot"}, {"name": "b", "type": "bot", "pose": {"x_m": 1}}]
  })";
  const RecordingReader recording(record(0.2, {}, world));
  std::vector<std::string> names;
  for (const RecordingReader::Array& array : recording.arrays())
    if (array.component != "pose") names.push_back(array.component + "/" + array.field.name);
  EXPECT_THAT(names, ::testing::UnorderedElementsAre("sensors/bot/lamp/shown_color", "sensors/bot/light/lit",
                                                     "sensors/bot/other/shown_color"));
  EXPECT_EQ(recorded_scene(recording).types.back().shown_color, "sensors/bot/lamp");

  const Unpacked page = unpacked(replay_data(recording, {.fields = {"pose"}}).bytes);
  EXPECT_EQ(page.header["types"].back()["shown_color"], "sensors/bot/lamp");
  ASSERT_EQ(page.header["fields"].size(), 2u);  // both LEDs: the first is the one to draw
  EXPECT_EQ(page.header["fields"][0]["name"], "shown_color");
}

TEST_F(Replay, SensorsWithEqualNamesAreNumberedAsInTheRun) {
  Simulation simulation(write("equal.world", R"(
    define bot position (size [0.2 0.2 0.2] drive "diff"
      ranger(name "eye" sensor(range [0 2] samples 3))
      ranger(name "eye#2" sensor(range [0 2] samples 4))
      ranger(name "eye" sensor(range [0 2] samples 5)))
    bot(name "a")
  )"));
  Recording(folder_ / "run.h5", simulation, {.fields = {"pose", "ranges"}}).close();
  const RecordingReader recording(folder_ / "run.h5");
  const RecordedScene scene = recorded_scene(recording);
  const RecordedScene::Type& bot = scene.types[scene.bodies[1].type];
  ASSERT_EQ(bot.rangers.size(), 3u);
  EXPECT_EQ(bot.rangers[1].name, "eye#2");
  EXPECT_EQ(bot.rangers[2].name, "eye#3");
  for (const RecordedScene::Ranger& ranger : bot.rangers) {
    const auto array = std::ranges::find(recording.arrays(), "sensors/bot/" + ranger.name,
                                         &RecordingReader::Array::component);
    ASSERT_NE(array, recording.arrays().end()) << ranger.name;
    EXPECT_EQ(array->field.columns, ranger.transducers.at(0).beams) << ranger.name;
  }
}

TEST_F(Replay, TheSceneIsThatOfTheWorld) {
  const RecordingReader recording(record(0.2));
  const RecordedScene scene = recorded_scene(recording);
  ASSERT_EQ(scene.bodies.size(), 5u);
  EXPECT_EQ(scene.bodies[1].name, "b0");
  EXPECT_EQ(scene.bodies[1].color, (Color{1, 0, 0, 1}));
  EXPECT_EQ(scene.bodies[4].name, "north");
  EXPECT_EQ(scene.bodies[4].pose_world_body, (Pose{0, 2, 0, 0}));
  const RecordedScene::Type& wall = scene.types[scene.bodies[4].type];
  EXPECT_EQ(wall.name, "wall");
  EXPECT_FALSE(wall.look.mobile);
  ASSERT_EQ(wall.look.shapes.size(), 1u);
  EXPECT_EQ(wall.look.shapes[0].solid.z, (ZInterval{0, 1}));
  EXPECT_NEAR(wall.look.radius, std::hypot(2, 0.05), 1e-9);

  const RecordedScene::Type& bot = scene.types[scene.bodies[1].type];
  EXPECT_TRUE(bot.look.mobile);
  ASSERT_EQ(bot.rangers.size(), 1u);
  EXPECT_EQ(bot.rangers[0].name, "eye");
  ASSERT_EQ(bot.rangers[0].transducers.size(), 2u);
  EXPECT_EQ(bot.rangers[0].transducers[0].beams, 9u);
  EXPECT_NEAR(bot.rangers[0].transducers[0].fov_rad, radians(90), 1e-12);
  EXPECT_NEAR(bot.rangers[0].transducers[1].pose_body_transducer.x, -0.1, 1e-12);
  EXPECT_NEAR(std::abs(bot.rangers[0].transducers[1].pose_body_transducer.heading), radians(180), 1e-12);
  EXPECT_EQ(bot.rangers[0].transducers[1].range_max_m, 1.5);
}

TEST_F(Replay, PosesAreThoseOfTheRunToAMillimetre) {
  const RecordingReader recording(record(20));
  const ReplayData data = replay_data(recording, {});
  EXPECT_EQ(data.robots, 3u);
  EXPECT_EQ(data.frames, 201u);
  EXPECT_EQ(data.recorded, 201u);
  EXPECT_EQ(data.stride, 1u);
  EXPECT_NEAR(data.every_s, 0.1, 1e-12);
  const Unpacked page = unpacked(data.bytes);
  EXPECT_EQ(page.header.at("format"), 1);
  // By type, then by id: carts were named first.
  EXPECT_EQ(page.header.at("robots").at("name"), (std::vector<std::string>{"c0", "b0", "b1"}));
  EXPECT_EQ(page.header.at("robots").at("color")[2], "#0080ff");
  EXPECT_FALSE(page.header.at("pose").at("has_z").get<bool>());
  EXPECT_EQ(page.header.at("times_s").size(), 201u);
  ASSERT_EQ(page.x.size(), 201u);
  const std::vector<std::size_t> rows{1, 0, 2};  // of the recording, by row of the page
  for (std::size_t frame = 0; frame < 201; ++frame)
    for (std::size_t row = 0; row < 3; ++row) {
      ASSERT_NEAR(page.x[frame][row], recorded<double>(recording, "pose", "x", frame, rows[row]), 0.000501);
      ASSERT_NEAR(page.y[frame][row], recorded<double>(recording, "pose", "y", frame, rows[row]), 0.000501);
      const double off =
          page.heading[frame][row] - recorded<double>(recording, "pose", "heading", frame, rows[row]);
      ASSERT_NEAR(std::remainder(off, 2 * k_pi), 0, 2 * k_pi / 4096 + 1e-9);
    }
  ASSERT_EQ(page.header.at("fixed").size(), 1u);
  EXPECT_EQ(page.header.at("fixed")[0].at("pose")[1], 2.0);
}

TEST_F(Replay, HeadingsRunOnWhereTheyPassHalfATurn) {
  const RecordingReader recording(record(10));
  const Unpacked page = unpacked(replay_data(recording, {}).bytes);
  const std::size_t block = page.header.at("block_frames").get<std::size_t>();
  double furthest = 0;
  for (std::size_t frame = 1; frame < page.heading.size(); ++frame)
    for (std::size_t row = 0; row < 3 && frame % block != 0; ++row) {
      ASSERT_LE(std::abs(page.heading[frame][row] - page.heading[frame - 1][row]), k_pi + 0.01);
      furthest = std::max(furthest, std::abs(page.heading[frame][row]));
    }
  EXPECT_NEAR(furthest, 10, 0.2) << "of the cart, which turns by 1 rad/s";
}

TEST_F(Replay, FieldsAreOfThoseThatHaveThem) {
  const RecordingReader recording(record(3, {.fields = {"pose", "stall", "ranges", "wander"}}));
  const Unpacked page = unpacked(replay_data(recording, {}).bytes);
  const auto& fields = page.header.at("fields");
  std::size_t seen = 0;
  for (std::size_t f = 0; f < fields.size(); ++f) {
    const std::string name = fields[f].at("name").get<std::string>();
    if (name == "ranges") {
      ++seen;
      EXPECT_EQ(fields[f].at("component"), "sensors/bot/eye");
      EXPECT_EQ(fields[f].at("columns"), 10);
      EXPECT_EQ(fields[f].at("unit"), "m");
      EXPECT_EQ(fields[f].at("rows").dump(), "[[1,2]]");
      const double step = fields[f].at("step").get<double>();
      EXPECT_EQ(step, 0.001);
      for (std::size_t frame = 0; frame < page.fields[f].size(); ++frame)
        for (std::size_t at = 0; at < 20; ++at)
          ASSERT_NEAR(page.fields[f][frame][at],
                      static_cast<double>(recorded<float>(recording, "sensors/bot/eye", "ranges", frame, at)),
                      step / 2 + 1e-6);
    }
    if (name == "stalled") {
      ++seen;
      EXPECT_EQ(fields[f].at("rows").dump(), "[[0,3]]");
      EXPECT_EQ(fields[f].at("step"), 1.0);
    }
    if (fields[f].at("component") == "wander/0") {
      ++seen;
      EXPECT_EQ(fields[f].at("rows").dump(), "[[1,2]]") << "carts have no memory";
    }
  }
  EXPECT_GE(seen, 3u);

  EXPECT_TRUE(unpacked(replay_data(recording, {.fields = {"pose"}}).bytes).fields.empty());
  for (const char* name : {"stall/stalled", "stall.stalled", "stall"})  // the first is of earlier versions
    EXPECT_EQ(unpacked(replay_data(recording, {.fields = {name, "ranges"}}).bytes).fields.size(), 2u) << name;
}

TEST_F(Replay, FramesAreLeftOutUntilTheyFit) {
  const RecordingReader recording(record(60));
  const std::size_t whole = replay_data(recording, {}).bytes.size();
  const std::size_t fewer = replay_data(recording, {.most_bytes = whole - 1}).stride;
  EXPECT_GE(fewer, 2u);
  const ReplayData small = replay_data(recording, {.most_bytes = whole * 6 / 10});
  EXPECT_LE(small.bytes.size(), whole * 6 / 10);
  EXPECT_GT(small.stride, fewer);
  EXPECT_EQ(small.recorded, 601u);
  const Unpacked page = unpacked(small.bytes);
  const auto times = page.header.at("times_s").get<std::vector<double>>();
  EXPECT_EQ(times.size(), small.frames);
  EXPECT_NEAR(times[1], 0.1 * static_cast<double>(small.stride), 1e-9);
  EXPECT_NEAR(times.back(), 60, 1e-9) << "the end is always there";
  EXPECT_NEAR(page.x[1][1], recorded<double>(recording, "pose", "x", small.stride, 0), 0.000501);
  EXPECT_THAT(error_of(recording.file(), {.most_bytes = 100}),
              HasSubstr("too small for even two frames (bodies per frame: 3)"));
}

TEST_F(Replay, TheSameRecordingGivesTheSameBytes) {
  const RecordingReader recording(record(2));
  EXPECT_EQ(replay_data(recording, {}).bytes, replay_data(recording, {}).bytes);
}

TEST_F(Replay, RefusesARecordingWithoutWhatItNeeds) {
  EXPECT_THAT(error_of(record(0.5, {.fields = {"stall"}})),
              HasSubstr("run.h5: error: has no poses, so there is nothing to show: record the run with "
                        "--record-fields pose,..."));
  EXPECT_THAT(error_of(record(0.5), {.fields = {"ranges"}}),
              HasSubstr("run.h5: error: unknown field \"ranges\"; known: pose.heading, "));
  EXPECT_THAT(error_of(record(0.5, {}, R"({"troupe": 1, "types": {"wall": {"size_m": [4, 0.1, 1]}},
                                          "models": [{"name": "w", "type": "wall"}]})")),
              HasSubstr("run.h5: error: has only static bodies, so there is nothing to show"));
}

// A crane whose arm goes up by 0.3 m/s from 1 s on and turns a hand that looks around; ants in reserve.
constexpr const char* k_cranes = R"({
  "troupe": 1,
  "types": {
    "crane": {"size_m": [0.3, 0.3, 0.2], "devices": [
        {"name": "a/m", "kind": "actuator", "pose": {"x_m": 0.2, "z_m": 0.3}, "axis": [0, 0, 1], "max_position": 0.6, "max_speed": 0.3, "size_m": [0.4, 0.1, 0.1]},
        {"name": "wrist", "kind": "actuator", "on": "a/m", "pose": {"x_m": 0.3}, "type": "rotational", "max_position": 3, "max_speed": 1, "size_m": [0.1, 0.1, 0.1]}],
      "sensors": [{"name": "eye", "kind": "ranger", "on": "wrist", "transducers": [{"range_max_m": 2}]}],
      "controller": {"kind": "operate", "orders": [{"at_s": 1, "device": "a/m", "order": "go_to", "value": 0.6},
                                                   {"at_s": 2, "device": "wrist", "order": "go_to", "value": 1.5}]}},
    "ant": {"size_m": [0.1, 0.1, 0.1], "drive": {"kind": "diff"}}
  },
  "models": [{"name": "crane", "type": "crane"}],
  "populations": [{"name": "ant", "type": "ant", "count": 1, "reserve": 2, "place": {"rule": "uniform", "region_m": [[3, 3], [4, 4]]}}],
  "bounds_m": [[-5, -5], [5, 5]]
})";

// A reader of frames in order reads several of them at once; a new one reads only the first that it is asked
// for.
TEST_F(Replay, FramesAreTheSameInWhateverOrderTheyAreRead) {
  const RecordingReader recording(record(4, {.fields = {"all"}}, R"({
    "troupe": 1,
    "types": {"bot": {"size_m": [0.2, 0.2, 0.1], "drive": {"kind": "diff"}, "controller": {"kind": "wander"},
                      "sensors": [{"name": "eye", "kind": "ranger", "transducers": [
                        {"range_max_m": 2, "samples": 9, "fov_deg": 90}]}]}},
    "models": [{"name": "a", "type": "bot"}, {"name": "b", "type": "bot", "pose": {"x_m": 1}}],
    "at": [{"time_s": 1.25, "remove": {"model": "a"}}]
  })"));
  ASSERT_GT(recording.frames(), 40u);
  const auto expect_same = [&](FrameReader& reader, const RecordingReader::Array& array, std::size_t frame) {
    std::vector<double> expected;
    std::vector<double> values;
    FrameReader(recording).read(array, frame, expected);
    reader.read(array, frame, values);
    EXPECT_THAT(values, Pointwise(NanSensitiveDoubleEq(), expected)) << array.field.name << " " << frame;
  };
  FrameReader reader(recording);
  for (const RecordingReader::Array& array : recording.arrays())
    for (std::size_t frame = 0; frame < recording.frames(); ++frame) expect_same(reader, array, frame);
  for (const RecordingReader::Array& array : recording.arrays())
    for (const std::size_t frame : {0, 1, 2, 3, 2, 8, 9, 10, 13, 4, 40}) expect_same(reader, array, frame);
  std::vector<double> first;
  reader.read(recording.arrays().front(), 40, first);
  EXPECT_THAT(first, ::testing::Contains(::testing::IsNan()));  // of the removed robot
}

TEST_F(Replay, JointsComeWithPoses) {
  const RecordingReader recording(record(5, {}, k_cranes));
  const RecordedScene scene = recorded_scene(recording);
  const RecordedScene::Type& crane = scene.types[scene.bodies[1].type];
  ASSERT_EQ(crane.joints.size(), 2u);
  EXPECT_EQ(crane.joints[1].parent, 0);
  EXPECT_NEAR(crane.joints[1].pose_body_joint.x, 0.5, 1e-12);
  EXPECT_EQ(crane.shape_joints, (std::vector<std::int32_t>{-1, 0, 1}));
  ASSERT_EQ(crane.rangers.size(), 1u);
  EXPECT_EQ(crane.rangers[0].joint, 1);

  const ReplayData data = replay_data(recording, {.fields = {"pose"}});
  EXPECT_FALSE(data.at_rest);
  EXPECT_EQ(data.robots, 3u);
  EXPECT_EQ(data.others, 1u);
  const Unpacked page = unpacked(data.bytes);
  const auto& type = page.header.at("types").at(scene.bodies[1].type);
  EXPECT_EQ(type.at("eyes").at("eye").at("joint"), 1);
  EXPECT_EQ(type.at("shapes").at(2).at("joint"), 1);
  const auto& fields = page.header.at("fields");
  const auto field_of = [&](int joint, const char* axis) -> const Unpacked::Table& {
    for (std::size_t f = 0; f < fields.size(); ++f)
      if (fields[f].at("component") == type.at("joints").at(joint).at("component") &&
          fields[f].at("name") == axis)
        return page.fields[f];
    throw std::out_of_range(axis);
  };
  EXPECT_NEAR(field_of(0, "z").at(10).at(0), 0, 1e-9);
  EXPECT_NEAR(field_of(0, "z").at(50).at(0), 0.6, 0.000501);
  EXPECT_NEAR(field_of(0, "z").at(25).at(0),
              recorded<double>(recording, crane.joints[0].component, "z", 25, 0), 0.000501);
  EXPECT_NEAR(field_of(1, "heading").at(50).at(0), 1.5, 0.000501);
  EXPECT_NEAR(field_of(1, "x").at(50).at(0), 0, 1e-9);
}

TEST_F(Replay, WhoIsBornAndDiesComesAndGoes) {
  Simulation simulation(write("w.json", k_cranes));
  Recording recording(folder_ / "run.h5", simulation, {.fields = {"pose", "stall"}});
  for (int tick = 0; tick < 10; ++tick) {
    if (tick == 3) {
      ASSERT_TRUE(simulation.spawn("ant", {-3, -3, 0, 0}));
    }
    if (tick == 6) simulation.remove(simulation.find("ant0"));
    simulation.step();
    recording.observe(simulation);
  }
  recording.close();
  const Unpacked page = unpacked(replay_data(RecordingReader(folder_ / "run.h5"), {}).bytes);
  const auto names = page.header.at("robots").at("name").get<std::vector<std::string>>();
  const auto row = [&](const char* name) {
    return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  };
  ASSERT_EQ(page.header.at("fields").back().at("name"), "stalled");
  const Unpacked::Table& stalled = page.fields.back();
  for (std::size_t frame = 0; frame <= 10; ++frame) {
    EXPECT_EQ(std::isnan(page.x[frame][row("ant0")]), frame >= 7) << frame;
    EXPECT_EQ(std::isnan(page.x[frame][row("ant1")]), frame < 4) << frame;
    EXPECT_EQ(std::isnan(stalled[frame][row("ant1")]), frame < 4) << "0 is not what it said";
    EXPECT_TRUE(std::isnan(page.x[frame][row("ant2")]));
    EXPECT_FALSE(std::isnan(page.x[frame][row("crane")]));
  }
  EXPECT_NEAR(page.x[4][row("ant1")], -3, 1e-9);
}

/// One body over three frames, written by hand from docs/recordings.md.
struct ByHand {
  bool with_scene = true;
  std::string world =
      R"({"title": "t", "words": ["", "a"], "types": [{"name": "bot", "parts": [{"solids": []}], "sensors": []}]})";
  std::uint32_t type = 0;
  float color = 1;
  std::vector<double> x = {0.5, 1.5, 2.5};
  std::vector<std::uint8_t> alive = {1, 1, 1};

  template <class T>
  static Hdf5Dataset array(Hdf5Group& group, const std::string& name, const std::vector<std::size_t>& row,
                           const std::vector<T>& values) {
    std::vector<std::size_t> chunk{1};
    chunk.insert(chunk.end(), row.begin(), row.end());
    Hdf5Dataset dataset = group.create_extendible(name, engine::element_of<T>(), row, {.extent = chunk});
    for (const char* key : {"unit", "frame", "text"}) dataset.set_text(key, "");
    dataset.append(std::span<const T>(values));
    return dataset;
  }

  void write(const std::filesystem::path& name) const {
    Hdf5File file = Hdf5File::create(name);
    Hdf5Group meta = file.create_group("meta");
    meta.set_text("kind", "troupe recording");
    meta.set_integer("layout", 1);
    meta.set_integer("record_every_ticks", 1);
    file.write_text("world", world);
    Hdf5Group bodies = file.create_group("bodies");
    bodies.write("id", std::span<const std::uint32_t>(std::vector<std::uint32_t>{1}));
    bodies.write_texts("type", std::vector<std::string>{"bot"});
    bodies.write_texts("name", std::vector<std::string>{"a"});
    if (with_scene) {
      Hdf5Group scene = file.create_group("scene");
      scene.write("word", std::span<const std::uint32_t>(std::vector<std::uint32_t>{0, 1}));
      scene.write("number", std::span<const std::uint32_t>(std::vector<std::uint32_t>{~0u, ~0u}));
      scene.write("type", std::span<const std::uint32_t>(std::vector<std::uint32_t>{0, type}));
      scene.create_dataset("pose", engine::Element::f64, {2, 4})
          .write(std::span<const double>(std::vector<double>(8, 0.0)));
      scene.create_dataset("color", engine::Element::f32, {2, 4})
          .write(std::span<const float>(std::vector<float>(8, color)));
    }
    Hdf5Group state = file.create_group("state");
    array(state, "alive", {1}, alive);
    Hdf5Group pose = state.create_group("pose");
    array(pose, "x", {1, 1}, x);
    array(pose, "y", {1, 1}, std::vector<double>{0, 0, 0});
    array(pose, "heading", {1, 1}, std::vector<double>{0, 0, 0});
    Hdf5Group frames = file.create_group("frames");
    frames.write("tick", std::span<const std::uint64_t>(std::vector<std::uint64_t>{0, 1, 2}));
    frames.write("time_s", std::span<const double>(std::vector<double>{0, 0.1, 0.2}));
    frames.write("hash", std::span<const std::uint64_t>(std::vector<std::uint64_t>{0, 0, 0}));
  }
};

TEST_F(Replay, WhoIsNotThereIsAbsent) {
  const std::filesystem::path file = folder_ / "hand.h5";
  ByHand{.alive = {0, 1, 0}}.write(file);
  Unpacked page = unpacked(replay_data(RecordingReader(file), {}).bytes);
  EXPECT_EQ(page.header.at("robots").at("name")[0], "a");
  EXPECT_TRUE(std::isnan(page.x[0][0]) && std::isnan(page.heading[0][0]) && std::isnan(page.x[2][0]));
  EXPECT_NEAR(page.x[1][0], 1.5, 1e-9);

  ByHand{.x = {0.5, std::nan(""), 2.5}}.write(file);
  page = unpacked(replay_data(RecordingReader(file), {}).bytes);
  EXPECT_NEAR(page.x[0][0], 0.5, 1e-9);
  EXPECT_TRUE(std::isnan(page.x[1][0]));
  EXPECT_NEAR(page.x[2][0], 2.5, 1e-9);
}

TEST_F(Replay, SaysThatPartsAreDrawnAtRest) {
  const std::filesystem::path file = folder_ / "hand.h5";
  ByHand{.world = R"({"title": "t", "words": ["", "a"], "types": [{"name": "bot", "parts": [{"solids": []}],
                      "joints": [{"name": "arm", "pose": [0, 0, 0, 0]}], "sensors": []}]})"}
      .write(file);
  EXPECT_TRUE(replay_data(RecordingReader(file), {}).at_rest);
  ByHand{}.write(file);
  EXPECT_FALSE(replay_data(RecordingReader(file), {}).at_rest);
}

TEST_F(Replay, RefusesARecordingOfBeforeThereWereScenes) {
  ByHand{.with_scene = false}.write(folder_ / "old.h5");
  EXPECT_THAT(error_of(folder_ / "old.h5"),
              HasSubstr("old.h5: error: has no group /scene (walls and colours)"));
}

TEST_F(Replay, RefusesADamagedScene) {
  const std::filesystem::path file = folder_ / "hand.h5";
  for (const char* world :
       {"{", "[]", R"({"title": "t"})", R"({"title": 1, "words": ["", "a"], "types": []})"}) {
    ByHand{.world = world}.write(file);
    EXPECT_THAT(error_of(file), HasSubstr("hand.h5: error: /world is not a valid world: the file is damaged"))
        << world;
  }
  for (const std::string type :
       {R"("joints": [{"name": "arm", "parent": 0, "pose": [0, 0, 0, 0]}], "parts": [])",
        R"("parts": [{"solids": [{"z_m": [0, 1], "contours_m": []}], "joint": 0}])"}) {
    ByHand{.world = R"({"title": "t", "words": ["", "a"], "types": [{"name": "bot", "sensors": [], )" + type +
                    "}]}"}
        .write(file);
    EXPECT_THAT(error_of(file), HasSubstr("/world or /scene has values that are not allowed in a world"))
        << type;
  }
  for (const ByHand& recording : {ByHand{.type = 1}, ByHand{.color = std::nanf("")}}) {
    recording.write(file);
    EXPECT_THAT(error_of(file),
                HasSubstr("hand.h5: error: /world or /scene has values that are not allowed in "
                          "a world"));
  }
}

}  // namespace
}  // namespace troupe::worldio::replay_data_test
