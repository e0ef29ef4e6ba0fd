#include "tests/apps/program.hpp"
#include "worldio/hdf5_file.hpp"

#include <string>
#include <utility>
#include <vector>

namespace troupe::apps {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class Render : public ProgramTest {
 protected:
  void SetUp() override {
    write("room.world", k_room);
    const Outcome outcome = draw({"room.world"});
    if (outcome.code == 1) GTEST_SKIP() << "no pictures here: " << outcome.err;
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    first_ = pixels("p.png");
  }
  Outcome draw(std::vector<std::string> options) const {
    options.insert(options.begin(), "render");
    options.insert(options.end(), {"-o", "p.png", "--size", "96x64"});
    return troupe(options);
  }
  void record() {
    if (!worldio::has_hdf5()) GTEST_SKIP() << "built without HDF5";
    ASSERT_EQ(
        troupe({"run", "room.world", "--for", "1", "--quiet", "--record", "run.h5", "--checkpoint", "c.h5"})
            .code,
        0);
  }
  /// The compressed pixels of a picture, without the texts about it.
  std::string pixels(const std::string& png) const {
    const std::string bytes = read(png);
    const std::size_t begin = bytes.find("IDAT");
    return begin == bytes.npos ? "" : bytes.substr(begin);
  }

  std::string first_;  // the world as it begins
};

TEST_F(Render, AWorldIsDrawnAsItBeginsAndAtOtherTimes) {
  ASSERT_EQ(
      troupe({"run", "room.world", "--for", "0.5", "--quiet", "--snapshot", "run.png", "--size", "96x64"})
          .code,
      0);
  EXPECT_EQ(draw({"room.world", "--at", "0"}).code, 0);
  EXPECT_EQ(pixels("p.png"), first_);
  EXPECT_EQ(draw({"room.world", "--at", "0.5"}).code, 0);
  EXPECT_EQ(read("p.png"), read("run.png"));
  EXPECT_NE(pixels("p.png"), first_);
}

TEST_F(Render, SeveralTimesAreSeveralPictures) {
  const Outcome outcome =
      troupe({"render", "room.world", "-o", "q-{time}.png", "--at", "0.2,0", "--size", "96x64"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(files(), ElementsAre("p.png", "q-0.2.png", "q-0.png", "room.world"));
}

TEST_F(Render, ACheckpointIsDrawnAsItWasSaved) {
  record();
  if (IsSkipped()) return;
  ASSERT_EQ(draw({"room.world", "--at", "1", "--layers", "scans"}).code, 0);
  const std::string at_its_end = pixels("p.png");
  EXPECT_EQ(draw({"c.h5", "--layers", "scans"}).code, 0);
  EXPECT_EQ(pixels("p.png"), at_its_end);
  const Outcome earlier = draw({"c.h5", "--at", "0.5"});
  EXPECT_EQ(earlier.code, 2);
  EXPECT_EQ(earlier.err, "c.h5: error: --at 0.5: the run is at 1 s already\n");
}

TEST_F(Render, ARecordingIsDrawnByItsPoses) {
  record();
  if (IsSkipped()) return;
  EXPECT_EQ(draw({"run.h5", "--at", "0"}).code, 0);
  EXPECT_EQ(pixels("p.png"), first_);
  // Stalled robots have red outlines, which poses do not tell.
  for (const auto& [options, time] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"run.h5"}, "1"}, {{"run.h5", "--at", "0.45"}, "0.4"}}) {
    std::vector<std::string> of_recording = options;
    of_recording.insert(of_recording.end(), {"--layers=-stalls"});
    EXPECT_EQ(draw(of_recording).code, 0);
    const std::string seen = pixels("p.png");
    EXPECT_EQ(draw({"room.world", "--at", time, "--layers=-stalls"}).code, 0);
    EXPECT_EQ(seen, pixels("p.png")) << time;
  }
}

TEST_F(Render, WhatARecordingHasNotIsRefused) {
  record();
  if (IsSkipped()) return;
  const auto refusal = [&](std::vector<std::string> options) {
    const Outcome outcome = draw(std::move(options));
    EXPECT_EQ(outcome.code, 2);
    return outcome.err;
  };
  EXPECT_EQ(refusal({"run.h5", "--layers", "scans"}),
            "run.h5: error: a recording is drawn by its poses: it has no scans\n");
  EXPECT_EQ(refusal({"run.h5", "--color-by", "velocity.x"}),
            "run.h5: error: a recording is drawn by its poses: it has no values to colour by\n");
  EXPECT_EQ(refusal({"run.h5", "--at", "2"}), "run.h5: error: 2 s is not in it: it goes from 0 s to 1 s\n");
  ASSERT_EQ(troupe({"run", "room.world", "--for", "1", "--quiet", "--record", "v.h5", "--record-fields",
                    "velocity"})
                .code,
            0);
  EXPECT_EQ(refusal({"v.h5"}),
            "v.h5: error: the recording has no poses: --record-fields chooses what is recorded\n");
  write("room.world", std::string(k_room) + "\nbot( pose [3 3 0 0] )\n");
  EXPECT_EQ(refusal({"run.h5"}), "run.h5: error: the recording is of other robots than room.world has now\n");
}

TEST_F(Render, BadInputIsOneLine) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"render"}, "troupe render: error: "},
      {{"render", "room.world"}, "troupe render: error: "},
      {{"render", "room.world", "-o", "q.jpg"},
       "troupe render: error: --output: \"q.jpg\" is not the name of a picture, as in --output crowd.png; "
       "see"},
      {{"render", "room.world", "-o", "q.png", "--at", "1,2"},
       "troupe render: error: --at: several pictures need names of their own: write {time} in the name, as "
       "in "
       "--output q-{time}.png; see"},
      {{"render", "nothing.world", "-o", "q.png"}, "nothing.world: error: "},
      {{"render", "room.world", "-o", "none/q.png"},
       "none/q.png: error: cannot be written: there is no folder none"},
      {{"render", "room.world", "-o", "q.png", "--camera", "window"},
       "room.world: error: the world has no window"},
  };
  for (const auto& [arguments, message] : cases) {
    const Outcome outcome = troupe(arguments);
    EXPECT_EQ(outcome.code, 2) << message;
    EXPECT_THAT(outcome.out, IsEmpty());
    EXPECT_THAT(lines_of(outcome.err), ElementsAre(HasSubstr(message)));
    EXPECT_THAT(files(), ElementsAre("p.png", "room.world"));
  }
}

}  // namespace
}  // namespace troupe::apps
