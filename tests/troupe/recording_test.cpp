#include "troupe/recording.hpp"

#include "base/diagnostics.hpp"
#include "engine/observing/frame.hpp"
#include "engine/world/world.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/rogue_controllers.hpp"
#include "tests/support/scratch.hpp"
#include "troupe/recorded_run.hpp"
#include "troupe/registry.hpp"
#include "troupe/swarm.hpp"
#include "worldio/partial_file.hpp"
#include "worldio/results/descriptor.hpp"
#include "worldio/results/hdf5_file.hpp"
#include "worldio/results/recording_reader.hpp"
#include "worldio/results/recording_writer.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace troupe::recording_test {
namespace {

using test::message_of;
using ::testing::HasSubstr;
using worldio::RecordingReader;

constexpr const char* k_world = R"({
  "troupe": 1,
  "types": {"bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"}, "controller": {"kind": "wander"},
    "sensors": [{"name": "eye", "kind": "ranger", "transducers": [{"range_max_m": 2, "samples": 9, "fov_deg": 90}]}]}},
  "populations": [{"name": "r", "type": "bot", "count": 8,
                   "place": {"rule": "grid", "region_m": [[0, 0], [4, 4]], "pitch_m": 1}}]
})";

class RecordingTest : public test::ScratchTest {
 protected:
  void SetUp() override {
    if (!worldio::has_hdf5()) GTEST_SKIP() << "built without HDF5";
    world_ = write("w.json", k_world);
  }
  static void step(Simulation& simulation, Recording& recording, std::uint64_t until) {
    while (simulation.tick() < until) {
      simulation.step();
      recording.observe(simulation);
    }
  }
  /// Every value of a recording, as text.
  std::string values(const std::string& name) const {
    const RecordingReader recording(folder_ / name);
    std::string all;
    for (std::size_t f = 0; f < recording.frames(); ++f) {
      all += std::to_string(recording.ticks()[f]) + " " + std::to_string(recording.hashes()[f]) + "\n";
      for (const RecordingReader::Array& array : recording.arrays()) {
        std::string bytes(array.bodies.size() * array.row_bytes(), '\0');
        recording.read(array, f, std::as_writable_bytes(std::span(bytes)));
        all += array.component + " " + array.field.name + " " + bytes;
      }
    }
    return all;
  }
  void record_whole(std::uint64_t until) {
    Simulation simulation(world_);
    Recording recording(folder_ / "whole.h5", simulation, options_);
    step(simulation, recording, until);
    recording.close();
  }

  std::filesystem::path world_;
  RecordingOptions options_{.fields = {"all"}, .every_s = 0.2};
};

TEST_F(RecordingTest, TheIntervalIsChecked) {
  const Simulation simulation(world_);
  for (const double every_s : {std::nan(""), 1e10}) {
    options_.every_s = every_s;
    EXPECT_THAT(message_of<std::invalid_argument>(
                    [&] { const Recording recording(folder_ / "run.h5", simulation, options_); }),
                HasSubstr("RecordingOptions::every_s is "));
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run.h5"));
}

TEST_F(RecordingTest, HasNoFrameForATimeThatIsNoNumber) {
  record_whole(4);
  RecordedRun run(folder_ / "whole.h5");
  run.go_to(0);
  for (const double time_s : {std::nan(""), -1.0, 9.0, HUGE_VAL})
    EXPECT_THAT(message_of<InputError>([&] { run.go_to(time_s); }),
                HasSubstr(" s is not recorded: the recording contains 0 s to 0.4 s"));
  EXPECT_EQ(run.frame_index(), 0u);
}

TEST_F(RecordingTest, GoesOnWithoutGapOrRepeat) {
  record_whole(30);
  const std::string whole = values("whole.h5");
  for (const std::uint64_t stop : {0u, 1u, 16u, 17u, 30u}) {
    Simulation simulation(world_);
    {
      Recording first(folder_ / "run.h5", simulation, options_);
      step(simulation, first, stop);
    }
    {
      Recording second = Recording::resume(folder_ / "run.h5", simulation);
      step(simulation, second, 30);
    }
    EXPECT_EQ(values("run.h5"), whole) << stop;
    std::filesystem::remove(folder_ / "run.h5");
  }
}

TEST_F(RecordingTest, WithoutFramesGoesOnFromTheTickAtWhichItBegan) {
  options_.every_s = 1;
  Simulation simulation(world_);
  for (int i = 0; i < 5; ++i) simulation.step();
  {
    Recording first(folder_ / "run.h5", simulation, options_);  // between two frames
    step(simulation, first, 8);
  }
  {
    Recording second = Recording::resume(folder_ / "run.h5", simulation);
    step(simulation, second, 9);
  }
  const auto resume = [&] { Recording::resume(folder_ / "run.h5", simulation); };
  simulation.run_for(0.2);
  EXPECT_THAT(message_of<std::runtime_error>(resume),
              HasSubstr("run.h5: error: /frames/tick ends before tick 10, but the run continues at tick 11"));
  simulation.reset();
  for (int i = 0; i < 4; ++i) simulation.step();
  EXPECT_THAT(message_of<std::runtime_error>(resume),
              HasSubstr("run.h5: error: /frames/tick begins at tick 5, after tick 4, at which the run "
                        "continues: give --record a new file"));
  simulation.step();
  Recording third = Recording::resume(folder_ / "run.h5", simulation);
  step(simulation, third, 25);
  third.close();
  EXPECT_THAT(RecordingReader(folder_ / "run.h5").ticks(), ::testing::ElementsAre(10, 20));
}

TEST_F(RecordingTest, CutsOffWhatTheResumedRunDoesAgain) {
  record_whole(30);
  Simulation simulation(world_);
  {
    Recording first(folder_ / "run.h5", simulation, options_);
    step(simulation, first, 25);
  }
  simulation.reset();
  for (int i = 0; i < 11; ++i) simulation.step();
  {
    Recording second = Recording::resume(folder_ / "run.h5", simulation);
    step(simulation, second, 30);
  }
  EXPECT_EQ(values("run.h5"), values("whole.h5"));
}

TEST_F(RecordingTest, TheSpaceOfRemovedFramesIsNotLost) {
  // Each robot has 4,000 readings, so that the frames of a few ticks are larger than what may stay unused.
  std::string json = k_world;
  const std::string few = R"("samples": 9)";
  json.replace(json.find(few), few.size(), R"("samples": 4000)");
  world_ = write("large.json", json);
  options_.every_s = 0.1;
  record_whole(60);
  const std::filesystem::path file = folder_ / "run.h5";
  std::filesystem::copy_file(folder_ / "whole.h5", file);
  // HDF5 only returns space at the end of the file to the system, and this dataset lies there.
  worldio::Hdf5File::open_to_write(file).write("last", std::span<const double>(std::vector<double>(100)));
  Simulation simulation(world_);
  for (int i = 0; i < 20; ++i) simulation.step();
  Recording recording = Recording::resume(file, simulation);
  EXPECT_LT(std::filesystem::file_size(file), std::filesystem::file_size(folder_ / "whole.h5") * 2 / 3);
  step(simulation, recording, 60);
  recording.close();
  EXPECT_EQ(values("run.h5"), values("whole.h5"));
  EXPECT_LT(std::filesystem::file_size(file),
            std::filesystem::file_size(folder_ / "whole.h5") + (std::size_t{1} << 20));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 4);  // the worlds and recordings
}

TEST_F(RecordingTest, DoesNotGoOnWhereItCannot) {
  Simulation simulation(world_);
  const auto resume = [&] { Recording::resume(folder_ / "run.h5", simulation); };
  EXPECT_THAT(message_of<std::runtime_error>(resume), HasSubstr("there is no such file"));
  {
    Recording first(folder_ / "run.h5", simulation, options_);
    step(simulation, first, 5);
  }
  simulation.run_for(1);
  EXPECT_THAT(
      message_of<std::runtime_error>(resume),
      HasSubstr(
          "run.h5: error: /frames/tick ends before tick 6, but the run continues at tick 15, so frames would "
          "be missing"));
  Simulation other(world_, {.robots = {{"r", 7}}});
  EXPECT_THAT(message_of<std::runtime_error>([&] { Recording::resume(folder_ / "run.h5", other); }),
              HasSubstr("run.h5: error: robots is \"8\" in the recording, but \"7\" in this run: the "
                        "recording belongs to another run; choose another file"));
}

TEST_F(RecordingTest, ChecksFindErrorsAndChangeNothing) {
  Simulation simulation(world_);
  const std::filesystem::path file = folder_ / "run.h5";
  const auto check_resume = [&] { Recording::check_resume(file, simulation); };
  Recording::check(file, simulation);
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_THAT(message_of<InputError>([&] { Recording::check(file, simulation, {.fields = {"rangs"}}); }),
              HasSubstr("run.h5: error: unknown field \"rangs\"; known: "));
  EXPECT_THAT(message_of<std::runtime_error>(check_resume), HasSubstr("there is no such file"));
  {
    Recording first(file, simulation, options_);
    step(simulation, first, 9);
    first.flush();
    EXPECT_THAT(message_of<std::runtime_error>(check_resume), HasSubstr("is still writing the file"));
  }
  EXPECT_THAT(message_of<InputError>([&] { Recording::check(file, simulation); }),
              HasSubstr("the file exists"));
  const std::string before = content(file);
  simulation.reset();
  for (int i = 0; i < 4; ++i) simulation.step();
  check_resume();  // resume() would remove the later frames
  EXPECT_THAT(message_of<std::runtime_error>(
                  [&] { Recording::check_resume(file, simulation, {.fields = {"pose"}}); }),
              HasSubstr("the recording has the fields all, which cannot change"));
  simulation.run_for(2);
  EXPECT_THAT(message_of<std::runtime_error>(check_resume),
              HasSubstr("ends before tick 10, but the run continues at tick 24"));
  EXPECT_EQ(content(file), before);
}

TEST_F(RecordingTest, ForgottenToCloseIsClosedAllTheSame) {
  Simulation simulation(world_);
  {
    Recording recording(folder_ / "run.h5", simulation);
    step(simulation, recording, 3);
  }
  const RecordingReader recording(folder_ / "run.h5");
  EXPECT_FALSE(recording.unfinished());
  EXPECT_EQ(recording.frames(), 4u);
  EXPECT_EQ(recording.arrays().size(), 4u);
}

TEST_F(RecordingTest, RefusesWhatIsThereAndWhatTheWorldDoesNotHave) {
  Simulation simulation(world_);
  write("run.h5", "precious");
  EXPECT_THAT(message_of<InputError>([&] { Recording(folder_ / "run.h5", simulation); }),
              HasSubstr("the file exists"));
  EXPECT_EQ(content(folder_ / "run.h5"), "precious");
  EXPECT_THAT(
      message_of<InputError>([&] { Recording(folder_ / "new.h5", simulation, {.fields = {"rangs"}}); }),
      HasSubstr("new.h5: error: unknown field \"rangs\"; known: "));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "new.h5"));
}

// Two runs that start at the same time may both find that the file does not exist.
TEST_F(RecordingTest, OnlyOneProcessAtATimeCreatesAFile) {
  Simulation simulation(world_);
  const std::filesystem::path file = folder_ / "run.h5";
  for (const bool replace : {false, true}) {
    {
      const worldio::PartialFile turn_of_another(file);
      EXPECT_EQ(message_of<InputError>([&] { Recording(file, simulation, {.replace = replace}); }),
                file.string() +
                    ": error: another process is creating the file: choose another file, or wait until "
                    "the process has ended");
    }
    EXPECT_EQ(std::filesystem::exists(file), replace);
    Recording(file, simulation, {.replace = replace}).close();
  }
  EXPECT_EQ(RecordingReader(file).frames(), 1u);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run.h5.partial"));
  std::filesystem::remove(file);
  std::filesystem::create_directory(folder_ / "run.h5.partial");
  Recording(file, simulation).close();
  EXPECT_EQ(RecordingReader(file).frames(), 1u);
}

// h5py locks the files that it reads.
TEST_F(RecordingTest, AFileThatAnotherProgramReadsIsNotChanged) {
  Simulation simulation(world_);
  const std::filesystem::path file = folder_ / "run.h5";
  Recording(file, simulation).close();
  const std::string before = content(file);
  {
    const worldio::Descriptor reader(file, O_RDONLY);
    ASSERT_EQ(flock(reader.get(), LOCK_SH), 0);
    const std::string error =
        file.string() +
        ": error: the file is open elsewhere, for example in a notebook: close it there, or "
        "choose another file";
    EXPECT_EQ(message_of<InputError>([&] { Recording(file, simulation, {.replace = true}); }), error);
    EXPECT_EQ(message_of<InputError>([&] { Recording::check_resume(file, simulation); }), error);
    EXPECT_EQ(content(file), before);
  }
  Recording::check_resume(file, simulation);
  Recording(file, simulation, {.replace = true}).close();
}

TEST_F(RecordingTest, HasNoNameOfAnotherFormat) {
  Simulation simulation(world_);
  for (const char* name : {"run.csv", "run.json", "run.PNG"}) {
    const std::filesystem::path file = folder_ / name;
    for (const auto& write :
         std::vector<std::function<void()>>{[&] { Recording(file, simulation); },
                                            [&] { simulation.record(file); }, [&] { simulation.save(file); }})
      EXPECT_EQ(
          message_of<InputError>(write),
          fmt::format("{}: error: the file would be in the format HDF5, but {} is the ending of another "
                      "format: choose another ending, such as .h5",
                      file.string(), file.extension().string()));
    EXPECT_FALSE(std::filesystem::exists(file));
  }
  for (const char* name : {"run", "run.hdf5"}) simulation.save(folder_ / name);
}

TEST_F(RecordingTest, DevicesHaveTheNamesThatTheWorldGivesThem) {
  Simulation simulation(world_);
  const auto recorded = [&](const std::string& name) {
    Recording(folder_ / "run.h5", simulation, {.fields = {name}, .replace = true}).close();
    const RecordingReader recording(folder_ / "run.h5");
    std::string all;
    for (const RecordingReader::Array& array : recording.arrays())
      all += array.component + "." + array.field.name + " ";
    return all;
  };
  for (const char* name : {"eye", "eye.ranges", "ranger/eye", "ranger", "ranger.ranges", "ranges"})
    EXPECT_EQ(recorded(name), "sensors/bot/eye.ranges ") << name;
  EXPECT_EQ(recorded("velocity.turn"), "velocity.turn ");
  EXPECT_THAT(message_of<InputError>([&] { recorded("eye.rangs"); }),
              HasSubstr("unknown field \"eye.rangs\""));
  EXPECT_THAT(message_of<InputError>([&] { recorded("eyee"); }), HasSubstr("(did you mean \"eye\"?)"));
}

TEST_F(RecordingTest, NamesOfATypeWithoutBodiesSelectNothing) {
  Simulation simulation(world_, {.robots = {{"r", 0}}});
  const auto recorded = [&](const std::string& name) {
    Recording(folder_ / "run.h5", simulation, {.fields = {name}, .replace = true}).close();
    const RecordingReader recording(folder_ / "run.h5");
    EXPECT_EQ(recording.frames(), 1u);
    return recording.arrays().size();
  };
  for (const char* name : {"eye", "eye.ranges", "ranger/eye", "ranger", "ranger.ranges", "ranges", "wander",
                           "wander/0", "wander/0.avoid_updates"})
    EXPECT_EQ(recorded(name), 0u) << name;
  EXPECT_THAT(message_of<InputError>([&] { recorded("eye.rangs"); }),
              HasSubstr("unknown field \"eye.rangs\"; known: all, command, eye, pose, ranger, ranges, "));
  EXPECT_THAT(message_of<InputError>([&] { recorded("sensors/bot/eye/ranges"); }),
              HasSubstr("unknown field \"sensors/bot/eye/ranges\": write \"eye.ranges\" instead"));
}

TEST_F(RecordingTest, ReadingsOfSensorsThatDoNotRunAreNoNumbers) {
  write("resting.json", R"({"troupe": 1, "arena": {"size_m": [4, 4]},
    "types": {"bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"}, "sensors": [
      {"name": "sonar", "kind": "ranger", "active": false, "transducers": [{"range_max_m": 5}]},
      {"name": "eye", "kind": "ranger", "transducers": [{"range_max_m": 5}]}]}},
    "models": [{"name": "a", "type": "bot"}, {"name": "b", "type": "bot", "pose": {"y_m": 1}}]})");
  Simulation simulation(folder_ / "resting.json");
  simulation.subscribe("b");
  {
    Recording recording(folder_ / "run.h5", simulation, {.fields = {"ranges"}});
    step(simulation, recording, 2);
  }
  const worldio::Hdf5File file = worldio::Hdf5File::open(folder_ / "run.h5");
  const auto ranges = [&](const char* sensor) {
    return file.group("sensors").group("bot").group(sensor).dataset("ranges").read<float>();
  };
  const std::vector<float> resting = ranges("sonar");
  const std::vector<float> running = ranges("eye");
  ASSERT_EQ(resting.size(), 3u * 2);
  for (std::size_t frame = 0; frame < 3; ++frame) {
    EXPECT_TRUE(std::isnan(resting[2 * frame])) << frame;
    EXPECT_EQ(resting[2 * frame + 1], frame > 0 ? 2 : 0) << frame;
    EXPECT_EQ(running[2 * frame], frame > 0 ? 2 : 0) << frame;
  }
}

TEST_F(RecordingTest, ReadingsInTheWorldFrameSaySo) {
  write("frames.json", R"({"troupe": 1,
    "types": {"bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"}, "sensors": [
      {"name": "needle", "kind": "compass", "active": true},
      {"name": "finder", "kind": "fiducial", "active": true, "range_max_m": 4}]}},
    "models": [{"name": "a", "type": "bot"}]})");
  const Simulation simulation(folder_ / "frames.json");
  Recording(folder_ / "run.h5", simulation, {.fields = {"pose", "needle", "finder"}}).close();
  const RecordingReader recording(folder_ / "run.h5");
  std::map<std::string, std::string> frames;
  for (const RecordingReader::Array& array : recording.arrays())
    frames[array.component + "." + array.field.name] = array.frame;
  EXPECT_EQ(frames.at("pose.heading"), "world");
  EXPECT_EQ(frames.at("sensors/bot/needle.heading"), "world");
  EXPECT_EQ(frames.at("sensors/bot/finder.pose"), "world");
  EXPECT_EQ(frames.at("sensors/bot/finder.heading"), "sensor");
}

TEST_F(RecordingTest, NamesWithCommasAreReadBack) {
  std::string text = k_world;
  text.replace(text.find("\"eye\""), 5, "\"front,left\\\\\"");
  Simulation simulation(write("comma.json", text));
  const RecordingOptions options{.fields = {"pose", "front,left\\"}};
  { Recording first(folder_ / "run.h5", simulation, options); }
  {
    Recording second = Recording::resume(folder_ / "run.h5", simulation, options);
    step(simulation, second, 1);
  }
  const worldio::Hdf5File file = worldio::Hdf5File::open(folder_ / "run.h5");
  EXPECT_EQ(file.group("meta").text("record_fields"), "pose,front\\,left\\\\");
  EXPECT_EQ(RecordingReader(folder_ / "run.h5").frames(), 2u);
}

TEST_F(RecordingTest, ARecordingThatCannotBeginLeavesNoFile) {
  const Simulation simulation(world_);
  const worldio::RecordingHead head{.meta = {{"kind", "other"}}, .world_json = "{}", .every_ticks = 1};
  EXPECT_THROW(worldio::RecordingWriter(folder_ / "run.h5", simulation.world(), {}, head),
               worldio::Hdf5Error);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run.h5"));
}

TEST_F(RecordingTest, WhatABodyLacksIsNoNumber) {
  engine::Registry registry = make_registry();
  registry.controllers.push_back(engine::make_controller_kind<test::Honest>("honest", "for this test"));
  write("mixed.json", R"({"troupe": 1,
    "types": {"thinker": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"}, "controller": {"kind": "honest"}},
              "cart": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"}}},
    "models": [{"name": "a", "type": "cart"}, {"name": "b", "type": "thinker", "pose": {"x_m": 1}},
               {"name": "c", "type": "cart", "pose": {"x_m": 2}}]})");
  Simulation simulation(folder_ / "mixed.json", {}, std::move(registry));
  {
    Recording recording(folder_ / "run.h5", simulation, {.fields = {"honest", "pose"}});
    step(simulation, recording, 7);
  }
  const worldio::Hdf5File file = worldio::Hdf5File::open(folder_ / "run.h5");
  const worldio::Hdf5Group memory = file.group("state").group("honest").group("0");
  const std::vector<double> sums = memory.dataset("sum").read<double>();
  ASSERT_EQ(sums.size(), 8u * 3);
  for (std::size_t frame = 0; frame < 8; ++frame) {
    EXPECT_TRUE(std::isnan(sums[3 * frame]) && std::isnan(sums[3 * frame + 2])) << frame;
    EXPECT_EQ(sums[3 * frame + 1] > 0, frame > 0) << frame;
  }
  EXPECT_THAT(memory.dataset("odd").read<std::uint8_t>(),
              ::testing::ElementsAre(0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0));
  EXPECT_THAT(file.group("bodies").group("has").group("honest").dataset("0").read<std::uint8_t>(),
              ::testing::ElementsAre(0, 1, 0));
}

TEST_F(RecordingTest, RowsOfTypesWithShorterFieldsEndInZeros) {
  for (const auto& [of_a, of_b] : {std::pair(2, 8), std::pair(8, 2)}) {
    const auto type = [](int payload) {
      return fmt::format(R"({{"size_m": [0.2, 0.2, 0.2], "drive": {{"kind": "diff"}},
        "sensors": [{{"name": "radio", "kind": "radio", "payload": {}}}]}})",
                         payload);
    };
    Simulation simulation(
        write("radios.json", fmt::format(R"({{"troupe": 1, "types": {{"a": {}, "b": {}}}, "models": [
          {{"name": "a0", "type": "a"}}, {{"name": "b0", "type": "b", "pose": {{"x_m": 1}}}},
          {{"name": "a1", "type": "a", "pose": {{"x_m": 2}}}}]}})",
                                         type(of_a), type(of_b))));
    const std::vector<std::uint8_t> words{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};
    const std::span<const std::byte> bytes = std::as_bytes(std::span(words));
    simulation.swarm("a").set_commands(bytes.first(2 * static_cast<std::size_t>(of_a)), "payload", "radio");
    simulation.swarm("b").set_commands(bytes.first(static_cast<std::size_t>(of_b)), "payload", "radio");
    {
      Recording recording(folder_ / "run.h5", simulation, {.fields = {"radio"}, .replace = true});
      step(simulation, recording, 2);
    }
    const worldio::Hdf5File file = worldio::Hdf5File::open(folder_ / "run.h5");
    const worldio::Hdf5Dataset payload =
        file.group("state").group("radio").group("radio").group("command").dataset("payload");
    EXPECT_THAT(payload.extent(), ::testing::ElementsAre(3, 3, 8));
    std::vector<std::uint8_t> last = payload.read<std::uint8_t>();
    ASSERT_EQ(last.size(), 3u * 3 * 8);
    last.erase(last.begin(), last.begin() + 2 * 3 * 8);
    EXPECT_THAT(last, of_a == 2 ? ::testing::ElementsAre(1, 2, 0, 0, 0, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8,  //
                                                         3, 4, 0, 0, 0, 0, 0, 0)
                                : ::testing::ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 1, 2, 0, 0, 0, 0, 0, 0,  //
                                                         9, 10, 11, 12, 13, 14, 15, 16));
  }
}

/// Viewers draw all bodies of one look at once, one look after the other.
TEST_F(RecordingTest, BodiesHaveTheLooksOfTheRunInTheSameOrder) {
  const auto world = write("looks.json", R"({"troupe": 1, "types": {
    "open": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"},
             "devices": [{"kind": "gripper", "pose": {"x_m": 0.1, "y_m": 0.03, "heading_deg": 7}}]},
    "closed": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"},
               "devices": [{"kind": "gripper", "paddles": "closed"}]},
    "lifted": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"},
               "devices": [{"kind": "gripper", "lift": "up"}]},
    "lit": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"},
            "parts": [{"name": "mast", "size_m": [0.1, 0.1, 0.1], "pose": {"z_m": 0.2},
                       "devices": [{"kind": "led", "shows": [0, 1, 0]}]}]}},
    "models": [{"name": "a", "type": "lit"},
               {"name": "b", "type": "lifted", "pose": {"x_m": 1}},
               {"name": "c", "type": "open", "pose": {"x_m": 2}},
               {"name": "d", "type": "closed", "pose": {"x_m": 3}},
               {"name": "e", "type": "lit", "pose": {"x_m": 4}},
               {"name": "f", "type": "lifted", "pose": {"x_m": 5}}]})");
  Simulation simulation(world);
  {
    Recording recording(folder_ / "run.h5", simulation);
    step(simulation, recording, 3);
  }
  const auto looks = [](const engine::Frame& frame) {
    std::vector<std::uint32_t> types;
    for (const engine::FrameBody& body : frame.mobile) types.push_back(body.type);
    return types;
  };
  const std::vector<std::uint32_t> of_run = looks(engine::make_frame(simulation.world()));
  const auto n = static_cast<std::uint32_t>(simulation.world().view().types().size());
  ASSERT_THAT(of_run, ::testing::ElementsAre(n, n + 1, ::testing::Lt(n), n + 2, n, n + 3));
  EXPECT_EQ(looks(RecordedRun(folder_ / "run.h5").frame({})), of_run);
}

/// 8,600 arrays. HDF5 1.10 could not create the index of some of them when its cache was limited to 2 MiB.
/// The time for a batch was proportional to the square of the number of arrays: minutes for this world.
TEST_F(RecordingTest, ThousandsOfArraysAreWrittenAndContinued) {
  constexpr int k_types = 200;
  std::string types;
  std::string models;
  for (int t = 0; t < k_types; ++t) {
    const std::string comma = t == 0 ? "" : ",";
    types += fmt::format(
        R"({}"t{}": {{"size_m": [0.2, 0.2, 0.2], "drive": {{"kind": "diff"}},
          "sensors": [{{"kind": "compass"}}, {{"kind": "fiducial"}}, {{"kind": "blobfinder"}}],
          "devices": [{{"kind": "gripper"}}, {{"kind": "led"}}, {{"kind": "power_pack"}}, {{"kind": "flags"}},
                      {{"kind": "blinkenlight"}}]}})",
        comma, t);
    models += fmt::format(R"({0}{{"name": "r{1}", "type": "t{1}", "pose": {{"x_m": {2}, "y_m": {3}}}}})",
                          comma, t, t % 20, t / 20);
  }
  const std::filesystem::path world =
      write("types.json", fmt::format(R"({{"troupe": 1, "types": {{{}}}, "models": [{}]}})", types, models));
  Simulation simulation(world);
  {
    Recording first(folder_ / "run.h5", simulation, options_);
    step(simulation, first, 2);
    first.close();
  }
  {
    Recording second = Recording::resume(folder_ / "run.h5", simulation);
    step(simulation, second, 4);
    second.close();
  }
  const RecordingReader recording(folder_ / "run.h5");
  EXPECT_THAT(recording.ticks(), ::testing::ElementsAre(0, 2, 4));
  EXPECT_GT(recording.arrays().size(), std::size_t{40} * k_types);
  for (const RecordingReader::Array& array : recording.arrays())
    ASSERT_EQ(array.dataset.rows(), 3) << array.component;
}

TEST_F(RecordingTest, SeveralAtOnce) {
  Simulation simulation(world_);
  {
    Recording often(folder_ / "often.h5", simulation, {.fields = {"pose"}, .every_s = 0.1});
    Recording rarely(folder_ / "rarely.h5", simulation, {.fields = {"velocity"}, .every_s = 0.5});
    while (simulation.tick() < 10) {
      simulation.step();
      often.observe(simulation);
      rarely.observe(simulation);
    }
  }
  EXPECT_EQ(RecordingReader(folder_ / "often.h5").frames(), 11u);
  EXPECT_EQ(RecordingReader(folder_ / "rarely.h5").frames(), 3u);
}

/// Bytes that this thread has handed to the operating system; nothing where the system does not count them.
std::optional<std::uint64_t> bytes_written_here() {
  std::ifstream counters("/proc/thread-self/io");
  for (std::string name; counters >> name;)
    if (std::uint64_t bytes = 0; name == "wchar:" && counters >> bytes) return bytes;
  return std::nullopt;
}

TEST_F(RecordingTest, ContainsOneRun) {
  Simulation simulation(world_);
  const auto error_of_observe = [&](Recording& recording) {
    try {
      recording.observe(simulation);
    } catch (const std::logic_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  {
    Recording recording(folder_ / "run.h5", simulation, {.fields = {"pose"}, .every_s = 0.5});
    step(simulation, recording, 7);
    simulation.reset();
    while (simulation.tick() < 6) simulation.step();  // after the last frame, but before the last tick
    EXPECT_THAT(error_of_observe(recording), HasSubstr("the simulation was reset after tick 7"));
  }
  EXPECT_EQ(RecordingReader(folder_ / "run.h5").frames(), 2u);
  simulation.reset();
  Recording other(folder_ / "other.h5", simulation, {.fields = {"pose"}, .every_s = 0.1});
  simulation.reset(simulation.seed() + 1);
  simulation.step();
  EXPECT_THAT(error_of_observe(other), HasSubstr("other.h5: error: the simulation was reset after tick 0"));
  other.close();
  EXPECT_EQ(error_of_observe(other), "");
}

TEST_F(RecordingTest, RefusesAnotherSimulation) {
  Simulation simulation(world_);
  Recording recording(folder_ / "run.h5", simulation, {.fields = {"pose"}, .every_s = 0.1});
  simulation.step();
  Simulation other(world_);
  other.step();
  EXPECT_THAT(message_of<std::logic_error>([&] { recording.observe(other); }),
              HasSubstr("run.h5: error: the recording is of another simulation: give the "
                        "simulation with which it was made"));
  recording.observe(simulation);
  Simulation moved(std::move(simulation));
  moved.step();
  recording.observe(moved);
  recording.close();
  EXPECT_EQ(RecordingReader(folder_ / "run.h5").frames(), 3u);
}

TEST_F(RecordingTest, InTheBackgroundTheFileHasTheSameBytes) {
  const auto record = [&](const char* name, std::uint64_t from, std::uint64_t until, bool in_background) {
    Simulation simulation(world_);
    while (simulation.tick() < from) simulation.step();
    RecordingOptions options{.fields = {"all"}, .every_s = 0.1, .in_background = in_background};
    Recording recording = from == 0 ? Recording(folder_ / name, simulation, options)
                                    : Recording::resume(folder_ / name, simulation, options);
    const std::uint64_t before = bytes_written_here().value_or(0);
    step(simulation, recording, from + 300);  // a batch has 256 frames
    recording.start_flush();
    step(simulation, recording, until - 20);
    const std::uint64_t bytes = bytes_written_here().value_or(0) - before;
    recording.flush();
    std::filesystem::copy_file(folder_ / name, folder_ / "flushed.h5",
                               std::filesystem::copy_options::overwrite_existing);
    EXPECT_EQ(RecordingReader(folder_ / "flushed.h5").frames(), until - 19);
    step(simulation, recording, until);
    recording.close();
    return bytes;
  };
  // Less than the poses of a frame. The undefined-behaviour sanitizer writes 16 bytes to a pipe now and then,
  // to find out whether an address is readable.
  constexpr std::uint64_t k_frame_bytes = 8 * 32;
  EXPECT_LT(record("background.h5", 0, 900, true), k_frame_bytes) << "the stepping thread wrote";
  const std::uint64_t bytes = record("here.h5", 0, 900, false);
  EXPECT_TRUE(bytes > 900 * k_frame_bytes || !bytes_written_here()) << "does not count what is written";
  EXPECT_EQ(content(folder_ / "background.h5"), content(folder_ / "here.h5"));

  EXPECT_LT(record("background.h5", 700, 1500, true), k_frame_bytes) << "the stepping thread wrote";
  record("here.h5", 700, 1500, false);
  EXPECT_EQ(content(folder_ / "background.h5"), content(folder_ / "here.h5"));
}

TEST_F(RecordingTest, SeveralInTheBackgroundBesideCheckpoints) {
  const auto record = [&](const std::string& suffix, bool in_background) {
    Simulation simulation(world_);
    RecordingOptions options{.fields = {"all"}, .every_s = 0.1, .in_background = in_background};
    Recording first(folder_ / ("first" + suffix), simulation, options);
    Recording second(folder_ / ("second" + suffix), simulation, options);
    for (int i = 0; i < 100; ++i) {
      simulation.step();
      for (Recording* recording : {&first, &second}) {
        recording->observe(simulation);
        recording->start_flush();
      }
      if (in_background) simulation.save(folder_ / "c.h5");
    }
  };
  record("-here.h5", false);
  record("-beside.h5", true);
  for (const std::string name : {"first", "second"})
    EXPECT_EQ(content(folder_ / (name + "-beside.h5")), content(folder_ / (name + "-here.h5"))) << name;
  EXPECT_EQ(Simulation::resume(folder_ / "c.h5").tick(), 100u);
}

}  // namespace
}  // namespace troupe::recording_test
