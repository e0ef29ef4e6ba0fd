#include "apps/exit_code.hpp"
#include "tests/apps/program.hpp"
#include "troupe/simulation.hpp"
#include "worldio/results/hdf5_file.hpp"
#include "worldio/results/recording_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

namespace troupe::apps::record_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;
using ::testing::Not;
using ::testing::StartsWith;
using worldio::RecordingReader;

const RecordingReader::Array& array(const RecordingReader& recording, const std::string& component,
                                    const std::string& field) {
  for (const RecordingReader::Array& array : recording.arrays())
    if (array.component == component && array.field.name == field) return array;
  throw std::out_of_range(component + " " + field);
}

/// One frame of an array, as numbers of type T.
template <class T>
std::vector<T> values(const RecordingReader& recording, const RecordingReader::Array& array,
                      std::size_t frame) {
  std::vector<T> values(array.bodies.size() * array.field.columns);
  recording.read(array, frame, std::as_writable_bytes(std::span(values)));
  return values;
}

/// Two kinds of robots: one that reads ranges and wanders, one that has neither.
constexpr std::string_view k_mixed = R"({
  "troupe": 1,
  "types": {
    "bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"}, "controller": {"kind": "wander"},
            "sensors": [{"name": "eye", "kind": "ranger", "transducers": [{"range_max_m": 2, "samples": 9, "fov_deg": 90}]}]},
    "cart": {"size_m": [0.3, 0.2, 0.2], "drive": {"kind": "diff"}}
  },
  "models": [
    {"name": "c0", "type": "cart", "pose": {"x_m": -3, "y_m": -3}},
    {"name": "b0", "type": "bot", "pose": {"x_m": 1, "y_m": 0}},
    {"name": "c1", "type": "cart", "pose": {"x_m": 2, "y_m": 0.1}},
    {"name": "b1", "type": "bot", "pose": {"x_m": -1, "y_m": 0.5, "heading_deg": 40}}
  ]
})";

class Record : public ProgramTest {
 protected:
  void SetUp() override {
    if (!worldio::has_hdf5()) GTEST_SKIP() << "built without HDF5";
    write("room.world", k_room);
    write("mixed.json", k_mixed);
  }
  /// Records and expects that to work.
  void record(const std::string& file, std::vector<std::string> options = {},
              const std::string& world = "room.world") {
    options.insert(options.begin(), {"run", world, "--quiet", "--record", file});
    if (std::ranges::find(options, "--for") == options.end()) options.insert(options.end(), {"--for", "2"});
    const Outcome outcome = troupe(options);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    ASSERT_THAT(outcome.err, IsEmpty());
  }
  /// An error that leaves no file behind.
  std::string error_of(const std::vector<std::string>& options) {
    const std::vector<std::string> before = files();
    const Outcome outcome = troupe(options);
    EXPECT_EQ(outcome.code, k_bad_input);
    EXPECT_EQ(files(), before);
    return outcome.err;
  }
  RecordingReader recording(const std::string& file) const { return RecordingReader(path(file)); }
};

/// A run on ranks that divide the robots among themselves: only recorded ticks need the robots of all ranks.
TEST_F(Record, DistributedRanksSendRobotsOnlyForFrames) {
  const auto messages = [&](const std::vector<std::string>& outputs) {
    return messages_of_ranks("mixed.json", 20, outputs);
  };
  const double none = messages({});
  EXPECT_GE(messages({"--record", "all.h5", "--record-fields", "all"}), none + 0.9)
      << "200 ticks, 200 frames";
  EXPECT_LE(messages({"--record", "few.h5", "--record-fields", "all", "--record-every", "5"}), none + 0.1);
  record("one.h5", {"--for", "20", "--record-fields", "all", "--record-every", "5"}, "mixed.json");
  EXPECT_EQ(troupe({"diff", "one.h5", "few.h5"}).code, 0);
}

TEST_F(Record, PosesOfEveryTick) {
  record("run.h5", {"--seed", "5"});
  const RecordingReader run = recording("run.h5");
  EXPECT_FALSE(run.unfinished());
  EXPECT_EQ(run.meta().at("world"), "room.world");
  EXPECT_EQ(run.meta().at("seed"), "5");
  EXPECT_EQ(run.meta().at("layout"), "1");
  EXPECT_EQ(run.meta().at("version"), version_line());
  ASSERT_EQ(run.frames(), 21u);

  Simulation simulation(path("room.world"), {.seed = 5});
  const std::vector<std::string> names = simulation.robot_names();
  EXPECT_THAT(std::vector<std::string>(run.names().begin(), run.names().end()),
              ::testing::ElementsAreArray(names));
  for (std::size_t frame = 0; frame < run.frames(); ++frame, simulation.step()) {
    EXPECT_EQ(run.ticks()[frame], simulation.tick());
    EXPECT_EQ(run.times_s()[frame], simulation.time_s());
    EXPECT_EQ(run.hashes()[frame], simulation.state_hash());
    for (const char* field : {"x", "y", "z", "heading"}) {
      const std::vector<double> recorded = values<double>(run, array(run, "pose", field), frame);
      for (std::size_t i = 0; i < names.size(); ++i) {
        const Pose pose = simulation.find(names[i]).pose();
        const double expected = *field == 'x'   ? pose.x
                                : *field == 'y' ? pose.y
                                : *field == 'z' ? pose.z
                                                : pose.heading;
        ASSERT_EQ(recorded[i], expected) << field << " of " << names[i] << " in frame " << frame;
      }
    }
  }
  EXPECT_EQ(array(run, "pose", "heading").field.unit, "rad");
  EXPECT_EQ(array(run, "pose", "x").frame, "world");
}

TEST_F(Record, ReadingsAndMemoriesOfThoseThatHaveThem) {
  record("run.h5", {"--record-fields", "ranges,wander,stall"}, "mixed.json");
  const RecordingReader run = recording("run.h5");
  EXPECT_THAT(std::vector<std::string>(run.names().begin(), run.names().end()),
              ElementsAre("c0", "b0", "c1", "b1"));
  EXPECT_THAT(std::vector<std::string>(run.types().begin(), run.types().end()),
              ElementsAre("cart", "bot", "cart", "bot"));
  EXPECT_EQ(array(run, "stall", "stalled").field.element, engine::Element::u8);

  const RecordingReader::Array& ranges = array(run, "sensors/bot/eye", "ranges");
  EXPECT_THAT(ranges.bodies, ElementsAre(1, 3));
  Simulation simulation(path("mixed.json"));
  for (std::size_t frame = 0; frame < run.frames(); ++frame, simulation.step()) {
    const std::vector<float> recorded = values<float>(run, ranges, frame);
    std::vector<float> expected;
    for (const char* name : {"b0", "b1"})
      for (const float range : simulation.find(name).ranges()) expected.push_back(range);
    ASSERT_EQ(recorded, expected) << frame;
  }

  // Only the bots have memories; those of the others are 0, and /bodies/has says that they mean nothing.
  std::size_t memories = 0;
  for (const RecordingReader::Array& memory : run.arrays()) {
    if (memory.component != "wander/0") continue;
    ++memories;
    ASSERT_EQ(memory.bodies.size(), 4u);
    const std::vector<std::int32_t> recorded = values<std::int32_t>(run, memory, 5);
    EXPECT_EQ(recorded[0], 0);
    EXPECT_GT(recorded[1], 0) << "it avoids c1, which is before it";
    EXPECT_EQ(recorded[2], 0);
  }
  EXPECT_GT(memories, 0u);
  EXPECT_THAT(worldio::Hdf5File::open(path("run.h5"))
                  .group("bodies")
                  .group("has")
                  .group("wander")
                  .dataset("0")
                  .read<std::uint8_t>(),
              ElementsAre(0, 1, 0, 1));
}

TEST_F(Record, ThreadsAndTilesLeaveNoTrace) {
  record("one.h5", {"--threads", "1", "--record-fields", "all"});
  record("three.h5", {"--threads", "3", "--tile-size", "0.9", "--record-fields", "all"});
  const RecordingReader one = recording("one.h5");
  const RecordingReader three = recording("three.h5");
  ASSERT_EQ(one.arrays().size(), three.arrays().size());
  for (std::size_t a = 0; a < one.arrays().size(); ++a)
    for (std::size_t frame = 0; frame < one.frames(); ++frame) {
      const std::size_t bytes = one.arrays()[a].bodies.size() * one.arrays()[a].row_bytes();
      std::vector<std::byte> first(bytes);
      std::vector<std::byte> second(bytes);
      one.read(one.arrays()[a], frame, first);
      three.read(three.arrays()[a], frame, second);
      ASSERT_EQ(first, second) << one.arrays()[a].component << " " << frame;
    }
  const Outcome same = troupe({"diff", "one.h5", "three.h5"});
  EXPECT_EQ(same.code, 0) << same.err;
  EXPECT_THAT(same.out,
              MatchesRegex("same bits, tick 0 to 20, in 21 frames of sensors/.*, pose; the last state has "
                           "the hash [0-9a-f]{16}\n"));
}

TEST_F(Record, ChangesNothing) {
  ASSERT_EQ(troupe({"run", "room.world", "--for", "2", "--quiet", "--hash-log", "without.log"}).code, 0);
  record("run.h5", {"--record-fields", "all", "--hash-log", "with.log"});
  EXPECT_EQ(read("with.log"), read("without.log"));
}

TEST_F(Record, AFrameEverySoManySeconds) {
  record("half.h5", {"--record-every", "0.5"});
  EXPECT_THAT(recording("half.h5").ticks(), ElementsAre(0, 5, 10, 15, 20));
  record("odd.h5", {"--record-every", "0.65"});
  EXPECT_THAT(recording("odd.h5").ticks(), ElementsAre(0, 7, 14));
  record("once.h5", {"--record-every", "1000", "--for", "0"});
  EXPECT_THAT(recording("once.h5").ticks(), ElementsAre(0));
}

TEST_F(Record, AnExistingFileStaysWithoutForce) {
  write("run.h5", "precious");
  EXPECT_THAT(error_of({"run", "room.world", "--for", "1", "--record", "run.h5"}),
              HasSubstr("run.h5: error: the file exists; --force replaces it"));
  EXPECT_EQ(read("run.h5"), "precious");
  record("run.h5", {"--force"});
  EXPECT_EQ(recording("run.h5").frames(), 21u);
}

/// Two runs that write one file would destroy each other's frames.
TEST_F(Record, AFileThatAnotherProcessWritesStaysEvenWithForce) {
  record("run.h5");
  const std::string bytes = read("run.h5");
  const std::ofstream other(path("run.h5"), std::ios::app);
  EXPECT_THAT(
      error_of({"run", "room.world", "--for", "1", "--quiet", "--record", "run.h5", "--force"}),
      MatchesRegex("run.h5: error: process [0-9]+ is still writing the file: choose another file, or wait "
                   "until the process has ended\n"));
  EXPECT_EQ(read("run.h5"), bytes);
}

TEST_F(Record, WrongInputIsRefusedBeforeAnythingIsWritten) {
  const std::vector<std::string> run = {"run", "room.world", "--for", "1", "--record"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), run.begin(), run.end());
    return error_of(more);
  };
  EXPECT_THAT(with({"run.h5", "--record-fields", "pose,velocty"}),
              AllOf(StartsWith("run.h5: error: unknown field \"velocty\"; known: all, command, pose, ranger"),
                    HasSubstr("did you mean \"velocity\"?")));
  EXPECT_THAT(with({"run.h5", "--record-fields", "pose,,stall"}), HasSubstr("is not a list of names"));
  EXPECT_THAT(with({"run.h5", "--record-every", "0"}), HasSubstr("\"0\" is not a time in seconds, above 0"));
  EXPECT_THAT(with({"run.h5", "--record-fields", "speed", "--hash-log", "run.log"}),
              HasSubstr("unknown field"));
  EXPECT_THAT(error_of({"run", "room.world", "--for", "1", "--record-every", "1"}),
              HasSubstr("need a recording, but the world has no \"record\": give --record FILE.h5"));
  EXPECT_THAT(with({"none/run.h5"}),
              HasSubstr("none/run.h5: error: cannot be written: there is no folder none"));
  EXPECT_THAT(with({"room.world"}), HasSubstr("room.world: error: cannot be written: it is the world, which "
                                              "this command reads: choose another file name"));
  EXPECT_THAT(with({"run.h5", "--hash-log", "run.h5"}), HasSubstr("another output has the same name"));
}

TEST_F(Record, AsTheWorldSays) {
  const auto world = [&](const std::string& record) {
    write("w.json", std::string(k_mixed.substr(0, 17)) + "\"record\": " + record + ",\n" +
                        std::string(k_mixed.substr(17)));
  };
  world(R"({"file": "world.h5", "every_s": 0.5, "fields": ["velocity"]})");
  ASSERT_EQ(troupe({"run", "w.json", "--for", "2", "--quiet"}).code, 0);
  EXPECT_THAT(recording("world.h5").ticks(), ElementsAre(0, 5, 10, 15, 20));
  EXPECT_EQ(recording("world.h5").arrays()[0].component, "velocity");
  ASSERT_EQ(
      troupe({"run", "w.json", "--for", "2", "--quiet", "--record", "mine.h5", "--record-every", "1"}).code,
      0);
  EXPECT_THAT(recording("mine.h5").ticks(), ElementsAre(0, 10, 20));
  EXPECT_EQ(recording("mine.h5").arrays()[0].component, "velocity");
  EXPECT_THAT(error_of({"run", "w.json", "--for", "2"}), HasSubstr("world.h5: error: the file exists"));

  world(R"({"every_s": 0.5})");
  ASSERT_EQ(troupe({"run", "w.json", "--for", "2", "--quiet"}).code, 0);
  EXPECT_THAT(files(), Not(::testing::Contains("run.h5")));

  world(R"({"file": "x.png"})");
  EXPECT_EQ(error_of({"run", "w.json", "--for", "2"}),
            "w.json:3: error: /record/file: must be the name of an HDF5 file, such as \"run.h5\", found "
            "\"x.png\"\n");
  EXPECT_THAT(files(), Not(::testing::Contains("x.png")));

  world(R"({"file": "x.h5", "fields": ["velocity", "speed"]})");
  EXPECT_THAT(error_of({"run", "w.json", "--for", "2"}),
              StartsWith("w.json:3: error: /record/fields: unknown field \"speed\"; known: all, command, "
                         "eye, pose, ranger"));
  EXPECT_THAT(
      error_of({"run", "w.json", "--for", "2", "--set", R"(/record/fields=["speed"])"}),
      StartsWith("--set /record/fields: error: /record/fields: unknown field \"speed\"; known: all, "));
  world(R"({"file": 3, "every_s": 0, "fields": [], "field": 1})");
  EXPECT_THAT(error_of({"run", "w.json", "--for", "2"}),
              AllOf(HasSubstr("w.json:3: error: /record/file: expected the name of a file"),
                    HasSubstr("w.json:3: error: /record/every_s: "),
                    HasSubstr("w.json:3: error: /record/fields: expected at least one name of a field"),
                    HasSubstr("w.json:3: error: /record: unknown key \"field\"")));
}

TEST_F(Record, InterruptedRunsCloseTheirFile) {
  const Outcome outcome = troupe_until(
      {"run", "room.world", "--for", "100000", "--quiet", "--record", "run.h5", "--hash-log", "run.log"},
      "run.log", 30, SIGTERM);
  EXPECT_EQ(outcome.code, k_stopped);
  const RecordingReader run = recording("run.h5");
  EXPECT_FALSE(run.unfinished());
  EXPECT_EQ(run.frames() + 10, lines_of(read("run.log")).size());
}

TEST_F(Record, ARecordingOfAnotherRunDoesNotGoOn) {
  record("run.h5", {"--checkpoint", "c.h5"});
  record("other.h5", {"--seed", "7"});
  const auto resume = [&](const std::string& file, std::vector<std::string> options = {}) {
    options.insert(options.begin(), {"resume", "c.h5", "--for", "4", "--quiet", "--record", file});
    return troupe(options);
  };
  const std::string other = read("other.h5");
  const Outcome refused = resume("other.h5");
  EXPECT_EQ(refused.code, k_bad_input);
  EXPECT_EQ(refused.err,
            "other.h5: error: seed is \"7\" in the recording, but \"1\" in this run: the recording belongs "
            "to another run; choose another file\n");
  EXPECT_EQ(read("other.h5"), other);
  EXPECT_THAT(resume("room.world").err, HasSubstr("room.world: error: has no complete HDF5 header"));

  ASSERT_EQ(resume("other.h5", {"--force"}).code, 0);
  EXPECT_EQ(recording("other.h5").ticks().front(), 20u);
  ASSERT_EQ(resume("run.h5").code, 0);
  EXPECT_EQ(recording("run.h5").frames(), 41u);
}

TEST_F(Record, AFullDiskEndsTheRunWithAReadableFile) {
  const Outcome outcome = troupe_with_file_limit(
      {"run", "room.world", "--for", "100000", "--quiet", "--record", "run.h5"}, std::size_t{1} << 20);
  EXPECT_EQ(outcome.code, k_failed);
  EXPECT_THAT(outcome.err, MatchesRegex("run.h5: error: (/[a-z/_]+ )?cannot be written: File too large\n"));
  const RecordingReader run = recording("run.h5");
  EXPECT_FALSE(run.unfinished());
  EXPECT_GT(run.frames(), 100u);
  record("whole.h5", {"--for", fmt::format("{}", run.times_s().back())});
  EXPECT_EQ(troupe({"diff", "run.h5", "whole.h5"}).code, 0);
  const Outcome repaired = troupe({"repair", "run.h5"});
  EXPECT_EQ(repaired.code, 0) << repaired.err;
  EXPECT_EQ(recording("run.h5").frames(), run.frames());
}

/// Here the program uses HDF5 first to read the checkpoint. HDF5 must not write the recording at the exit of
/// the program, after the recording was given up.
TEST_F(Record, AFullDiskEndsAResumedRunInTheSameWay) {
  record("run.h5", {"--checkpoint", "c.h5"});
  const Outcome outcome = troupe_with_file_limit(
      {"resume", "c.h5", "--for", "100000", "--quiet", "--record", "run.h5"}, std::size_t{1} << 20);
  EXPECT_EQ(outcome.code, k_failed);
  EXPECT_THAT(outcome.err, MatchesRegex("run.h5: error: (/[a-z/_]+ )?cannot be written: File too large\n"));
  const RecordingReader run = recording("run.h5");
  EXPECT_FALSE(run.unfinished());
  EXPECT_GT(run.frames(), 100u);
}

TEST_F(Record, DiffNamesTheFirstValueThatDiffers) {
  record("a.h5", {"--record-fields", "pose,ranges"});
  record("first.h5", {"--record-fields", "all"});
  record("seed.h5", {"--seed", "7", "--record-fields", "all"});
  EXPECT_THAT(error_of({"diff", "a.h5", "seed.h5"}),
              StartsWith("seed.h5: error: seed is \"7\", but \"1\" in a.h5: these are different runs; "
                         "--across-runs compares"));
  const Outcome other = troupe({"diff", "first.h5", "seed.h5", "--across-runs"});
  EXPECT_EQ(other.code, 1);
  EXPECT_THAT(other.out,
              MatchesRegex(
                  "differs at tick [0-9]+ \\([0-9.]+ s\\):\n[a-z0-9/]+: [a-z_]+ of \".*\" \\(id [0-9]+\\) is "
                  "0x[0-9a-f]+ \\(.*\\) in seed.h5, but 0x[0-9a-f]+ \\(.*\\) in first.h5; [0-9]+ bod.*\n"));

  record("short.h5", {"--for", "1"});
  const Outcome length = troupe({"diff", "short.h5", "a.h5"});
  EXPECT_EQ(length.code, 1);
  EXPECT_EQ(
      length.out,
      "differs in length: short.h5 ends at tick 10, but a.h5 continues; same bits from tick 0 until then\n");

  record("rare.h5", {"--record-every", "0.7", "--record-fields", "stall"});
  const Outcome rare = troupe({"diff", "a.h5", "rare.h5"});
  EXPECT_EQ(rare.code, 0) << rare.out << rare.err;
  EXPECT_THAT(rare.out, StartsWith("same bits, tick 0 to 14, in 3 frames of nothing but hashes"));

  write("log", "# troupe hash log 1\n");
  EXPECT_THAT(error_of({"diff", "a.h5", "log"}),
              HasSubstr("log: error: not a recording (troupe run --record), but a.h5 is one: give two "
                        "recordings or two hash logs"));
  EXPECT_THAT(error_of({"diff", "a.h5", "none.h5"}), HasSubstr("none.h5: error: there is no such file"));
}

TEST_F(Record, DiffNeedsTheSameBodiesAndACommonTick) {
  record("a.h5", {"--for", "0.4"});
  ASSERT_EQ(troupe({"run", "room.world", "--for", "0.8", "--quiet", "--checkpoint", "c.h5"}).code, 0);
  ASSERT_EQ(troupe({"resume", "c.h5", "--for", "1", "--quiet", "--record", "late.h5"}).code, 0);
  EXPECT_EQ(error_of({"diff", "a.h5", "late.h5"}),
            "late.h5: error: the recording has no tick in common with a.h5: record both runs with the same "
            "--record-every, over the same time\n");
  record("mixed.h5", {}, "mixed.json");
  EXPECT_EQ(
      error_of({"diff", "a.h5", "mixed.h5", "--across-runs"}),
      "mixed.h5: error: the recording has other bodies than a.h5: give two recordings of the same world\n");
}

TEST_F(Record, DiffSeesOneBit) {
  record("a.h5");
  record("b.h5");
  {
    worldio::Hdf5File file = worldio::Hdf5File::open_to_write(path("b.h5"));
    worldio::Hdf5Dataset x = file.group("state").group("pose").dataset("x");
    std::vector<double> all = x.read<double>();
    double& value = all[4 * 12 + 7];
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, 8);
    bits ^= 1;
    std::memcpy(&value, &bits, 8);
    x.write(std::span<const double>(all));
  }
  const Outcome outcome = troupe({"diff", "a.h5", "b.h5"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.out, StartsWith("differs at tick 4 (0.4 s):\npose: x of "));
  EXPECT_THAT(outcome.out, HasSubstr("; 1 body differs\n"));
}

TEST_F(Record, RepairLeavesAloneWhatIsWhole) {
  record("run.h5");
  const std::string bytes = read("run.h5");
  const Outcome outcome = troupe({"repair", "run.h5"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.out, "run.h5: nothing to repair: 21 frames\n");
  EXPECT_EQ(read("run.h5"), bytes);

  write("cut.h5", bytes.substr(0, bytes.size() - 100));
  for (const char* command : {"repair", "info", "replay"})
    EXPECT_EQ(
        error_of({command, "cut.h5"}),
        fmt::format("cut.h5: error: is incomplete: it has {} of {} bytes, as after an interrupted copy, and "
                    "cannot be repaired: copy the file again\n",
                    bytes.size() - 100, bytes.size()));
  write("text", "no recording");
  EXPECT_THAT(error_of({"repair", "text"}),
              HasSubstr("text: error: has no complete HDF5 header: the file is not a recording"));
  EXPECT_THAT(error_of({"repair", "none"}), HasSubstr("none: error: there is no such file"));
  { worldio::Hdf5File::create(path("other.h5")).create_group("data"); }
  EXPECT_THAT(error_of({"repair", "other.h5"}), HasSubstr("the file is not a recording"));
}

TEST_F(Record, RepairClosesWhatAKilledRunLeft) {
  const Outcome killed = troupe_until(
      {"run", "room.world", "--for", "100000", "--quiet", "--record", "run.h5", "--hash-log", "run.log"},
      "run.log", 1500, SIGKILL);
  EXPECT_EQ(killed.code, 128 + SIGKILL);
  std::size_t frames = 0;
  {
    const RecordingReader cut_off = recording("run.h5");
    EXPECT_TRUE(cut_off.unfinished());
    frames = cut_off.frames();
    EXPECT_GT(frames, 1000u);
  }
  EXPECT_THROW(worldio::Hdf5File::open(path("run.h5")), worldio::Hdf5Error);
  std::filesystem::create_directory(path("real"));
  std::filesystem::rename(path("run.h5"), path("real/run.h5"));
  std::filesystem::create_symlink("real/run.h5", path("run.h5"));
  // What a repair left that was killed is taken over, so that it never adds up.
  write("real/run.h5.partial", "");
  write("real/run.h5.partial.copy", "half a copy");
  const Outcome outcome = troupe({"repair", "run.h5"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, fmt::format("run.h5: repaired: {} frames\n", frames));
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path("")))
    EXPECT_THAT(entry.path().string(), Not(HasSubstr("partial")));
  EXPECT_TRUE(std::filesystem::is_symlink(path("run.h5")));
  const RecordingReader repaired = recording("real/run.h5");
  EXPECT_FALSE(repaired.unfinished());
  EXPECT_EQ(repaired.frames(), frames);
  record("whole.h5", {"--for", fmt::format("{}", repaired.times_s().back())});
  EXPECT_EQ(troupe({"diff", "run.h5", "whole.h5"}).code, 0);
  EXPECT_THAT(troupe({"repair", "run.h5"}).out, HasSubstr("nothing to repair"));
}

}  // namespace
}  // namespace troupe::apps::record_test
