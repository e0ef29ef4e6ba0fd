#include "apps/pictures/film.hpp"
#include "tests/apps/program.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>
#include <tuple>
#include <vector>

namespace troupe::apps::pictures_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Writes what it is given behind what it was called with, and ends as it is told; or it waits until the
/// folder of the test is removed.
constexpr const char* k_fake_ffmpeg = R"(#!/bin/sh
for last; do :; done
last=${last#file:}
echo "$@" > "$last"
cat >> "$last"
if [ "$FAKE_FFMPEG_WAITS" ]; then
  : > waiting
  while [ -e bin/ffmpeg ]; do sleep 0.05; done
fi
exit ${FAKE_FFMPEG_CODE:-0}
)";

class RunPictures : public ProgramTest {
 protected:
  void SetUp() override {
    write("room.world",
          std::string(k_room) + "\nbot( name \"scout\" pose [3 3 0 0] )\nwindow( size [80 60] scale 8 )\n");
    std::filesystem::create_directory(path("bin"));
    const Outcome outcome = run({"--snapshot", "try.png"});
    if (lacks_pictures(outcome)) GTEST_SKIP() << "no pictures here: " << outcome.err;
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    std::filesystem::remove(path("try.png"));
  }
  void TearDown() override {
    for (const char* name : {"FAKE_FFMPEG_CODE", "FAKE_FFMPEG_WAITS"}) unsetenv(name);
    if (!old_path_.empty()) setenv("PATH", old_path_.c_str(), 1);
  }
  Outcome run(std::vector<std::string> options) const {
    options.insert(options.begin(), {"run", "room.world", "--for", "0.5", "--quiet", "--size", "64x48"});
    return troupe(options);
  }
  /// From here on programs are looked for in the test's own folder first, or there alone.
  void set_path(bool alone) {
    if (const char* path = std::getenv("PATH"); path && old_path_.empty()) old_path_ = path;
    setenv("PATH", (path("bin").string() + (alone ? "" : ":" + old_path_)).c_str(), 1);
  }
  void add_ffmpeg() {
    write("bin/ffmpeg", k_fake_ffmpeg);
    std::filesystem::permissions(path("bin/ffmpeg"), std::filesystem::perms::owner_all);
    set_path(false);
  }

  /// Whether the film that is being made has pictures already.
  bool has_pictures() const {
    std::error_code missing;
    const std::uintmax_t size = std::filesystem::file_size(path("f.mp4.partial.mp4"), missing);
    return !missing && size > 3 * 64 * 48 * 4;
  }

  std::string old_path_;
};

const std::vector<std::string> k_endless_film{"run",    "room.world", "--for",  "1e9",  "--quiet",
                                              "--size", "64x48",      "--film", "f.mp4"};

TEST_F(RunPictures, SnapshotsAreTakenWhenTheyAreAskedFor) {
  const Outcome outcome =
      run({"--snapshot", "p-{time}.png", "--snapshot-at", "0.25,0,0.5", "--hash-log", "h.log"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(files(), ElementsAre("bin", "h.log", "p-0.25.png", "p-0.5.png", "p-0.png", "room.world"));
  const std::vector<std::string> lines = lines_of(read("h.log"));
  const std::string hash = lines.back().substr(lines.back().find(' ') + 1, 16);
  EXPECT_THAT(read("p-0.5.png"), HasSubstr(hash));
  EXPECT_THAT(read("p-0.png"), Not(HasSubstr(hash)));
}

/// Ranks that divide the robots among themselves send them to rank 0 only when it draws them.
TEST_F(RunPictures, DistributedRanksSendRobotsOnlyForPictures) {
  const auto messages = [&](const std::vector<std::string>& outputs) {
    return messages_of_ranks("room.world", 10, outputs);
  };
  const double none = messages({});
  EXPECT_LE(messages({"--size", "64x48", "--snapshot", "end.png"}), none + 0.1);
  EXPECT_LE(messages({"--size", "64x48", "--snapshot", "{time}.png", "--snapshot-at", "3,7"}), none + 0.1);
  EXPECT_LE(messages({"--size", "64x48", "--film", "%06d.png", "--fps", "0.2"}), none + 0.1)
      << "100 ticks, 3 frames";
  const Outcome one =
      troupe({"run", "room.world", "--for", "10", "--quiet", "--size", "64x48", "--snapshot", "one.png"});
  EXPECT_EQ(one.code, 0) << one.err;
  EXPECT_EQ(read("end.png"), read("one.png"));
}

TEST_F(RunPictures, SnapshotsThatTheRunDoesNotReachAreNamed) {
  write("w.json", R"({"troupe": 1, "stop_when": ["displacement >= 0.95"],
  "types": {"bot": {"size_m": [0.4, 0.4, 0.4], "drive": {"kind": "diff"},
    "controller": {"kind": "script", "legs": [{"until_s": 1000, "forward_mps": 1}]}}},
  "models": [{"name": "r", "type": "bot"}]})");
  const Outcome outcome = troupe({"run", "w.json", "--for", "60", "--snapshot", "p-{time}.png",
                                  "--snapshot-at", "0.5,2,60", "--size", "64x48"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.err,
            "w.json: warning: the run ended at 1.1 s: these times of --snapshot-at were not drawn: 2, 60\n");
  EXPECT_THAT(files(), ElementsAre("bin", "p-0.5.png", "room.world", "w.json"));
}

TEST_F(RunPictures, TheySeeThroughAnyCamera) {
  for (const std::vector<std::string>& camera : std::vector<std::vector<std::string>>{
           {"--camera", "perspective", "--angle", "60,-30"},
           {"--camera", "window"},
           {"--camera", "follow:scout", "--across", "3"},
           {"--center", "-1,0.5", "--across", "4"},
           {"--layers", "scans,trails,names,-grid", "--color-by", "velocity.x", "--color-range", "0,0.5"}}) {
    std::vector<std::string> options = camera;
    options.insert(options.end(), {"--snapshot", "p.png"});
    const Outcome outcome = run(options);
    EXPECT_EQ(outcome.code, 0) << camera[1] << ": " << outcome.err;
    EXPECT_THAT(read("p.png"), HasSubstr("state_hash")) << camera[1];
  }
}

TEST_F(RunPictures, AMapMayBePathsAndLetters) {
  const Outcome outcome = run({"--snapshot", "map.svg", "--background", "transparent", "--layers", "types"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(files(), ElementsAre("bin", "map.svg", "room.world"));
  const std::string svg = read("map.svg");
  EXPECT_THAT(svg, AllOf(HasSubstr("<svg "), HasSubstr("world: room.world"), HasSubstr("time_s: 0.5"),
                         ::testing::EndsWith("</svg>\n")));
  EXPECT_EQ(run({"--snapshot", "fit.svg", "--camera", "fit"}).code, 0);
  EXPECT_NE(read("fit.svg"), svg);
  const Outcome solid = run({"--snapshot", "side.svg", "--camera", "perspective"});
  EXPECT_EQ(solid.code, 2);
  EXPECT_EQ(solid.err,
            "room.world: error: side.svg: .svg and .pdf need a view from straight above: the camera top "
            "or fit, without an angle; a .png takes any view\n");
  EXPECT_FALSE(std::filesystem::exists(path("side.svg")));
}

TEST_F(RunPictures, APdfNeedsCairo) {
  const Outcome drawn = run({"--snapshot", "map.pdf"});
  if (drawn.code == 0) {
    EXPECT_THAT(read("map.pdf"), ::testing::StartsWith("%PDF-"));
    std::filesystem::remove(path("map.pdf"));
  }
  for (const char* name : {"libcairo.so.2", "libcairo.so"}) write(name, "no library");
  setenv("LD_LIBRARY_PATH", ".", 1);
  const Outcome outcome = run({"--snapshot", "map.pdf", "--hash-log", "h.log"});
  unsetenv("LD_LIBRARY_PATH");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(lines_of(outcome.err),
              ElementsAre(HasSubstr("cairo is not installed (Debian, Ubuntu: apt install "
                                    "libcairo2)")));
  EXPECT_THAT(files(), ElementsAre("bin", "libcairo.so", "libcairo.so.2", "room.world"));
}

TEST_F(RunPictures, CamerasFollowAllRobots) {
  for (const char* camera : {"fit", "follow:all"}) {
    const Outcome outcome = run({"--snapshot", "p.png", "--camera", camera});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
  }
  const Outcome unknown = run({"--snapshot", "p.png", "--camera", "fitt"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("did you mean \"fit\""));
}

TEST_F(RunPictures, AFilmHasThirtyPicturesASecond) {
  add_ffmpeg();
  const Outcome outcome = run({"--film", "f.mp4"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(files(), ElementsAre("bin", "f.mp4", "room.world"));
  const std::string film = read("f.mp4");
  const std::size_t head = film.find('\n') + 1;
  EXPECT_THAT(film.substr(0, head), AllOf(HasSubstr("-video_size 64x48"), HasSubstr("-framerate 30 ")));
  EXPECT_EQ((film.size() - head) % (64 * 48 * 4), 0u);
  EXPECT_EQ((film.size() - head) / (64 * 48 * 4), 16u);  // 0 to 0.5 s
}

TEST_F(RunPictures, AFilmStatesTheMatrixOfItsColours) {
  add_ffmpeg();
  EXPECT_EQ(run({"--film", "f.mp4"}).code, 0);
  const std::string film = read("f.mp4");
  EXPECT_THAT(film.substr(0, film.find('\n')), AllOf(HasSubstr("scale=out_color_matrix=bt709:out_range=tv "),
                                                     HasSubstr("-colorspace bt709 ")));
}

TEST_F(RunPictures, AResumedRunReplacesNoFilm) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "this build has no HDF5";
  add_ffmpeg();
  std::filesystem::create_directory(path("f"));
  const auto resume = [&](const std::string& film) {
    return troupe({"resume", "c.h5", "--for", "1", "--quiet", "--size", "64x48", "--film", film});
  };
  const std::string error = ": error: a film cannot be continued after the checkpoint, and ";
  const std::string advice = " exists: choose another file name, or remove the file\n";
  EXPECT_EQ(run({"--film", "f/%06d.png", "--checkpoint", "c.h5"}).code, 0);
  write("f.mp4", "a film");
  for (const auto& [film, first, what] : {std::tuple("f/%06d.png", "f/000000.png", "f/000000.png"),
                                          std::tuple("f.mp4", "f.mp4", "this file")}) {
    const std::string before = read(first);
    const Outcome outcome = resume(film);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(outcome.err, film + error + what + advice);
    EXPECT_EQ(read(first), before);
  }
  EXPECT_EQ(resume("second.mp4").code, 0);
}

TEST_F(RunPictures, TheSummaryNamesTheFilm) {
  add_ffmpeg();
  const Outcome outcome = troupe({"run", "room.world", "--for", "0.5", "--film", "f.mp4", "--size", "64x48"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(lines_of(outcome.out),
              ::testing::Contains("  written            f.mp4: 16 pictures, 0.5333 s"));
}

TEST_F(RunPictures, AFilmMayBeFasterOrOfFewerPictures) {
  add_ffmpeg();
  EXPECT_EQ(run({"--film", "f.mp4", "--fps", "10", "--film-speed", "2"}).code, 0);
  const std::string film = read("f.mp4");
  EXPECT_EQ((film.size() - film.find('\n') - 1) / (64 * 48 * 4), 3u);  // at 0, 0.2 and 0.4 s
}

TEST_F(RunPictures, AFilmMayBeAFolderOfPictures) {
  std::filesystem::create_directory(path("frames"));
  const Outcome outcome = run({"--film", "frames/%06d.png", "--fps", "10"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  for (const char* name : {"frames/000000.png", "frames/000005.png"})
    EXPECT_THAT(read(name), HasSubstr("time_s"));
  EXPECT_FALSE(std::filesystem::exists(path("frames/000006.png")));
}

TEST_F(RunPictures, WithoutFfmpegNothingIsBegun) {
  set_path(true);
  const Outcome outcome = run({"--film", "f.mp4", "--hash-log", "h.log"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("f.mp4: error: cannot be written: ffmpeg is not installed"),
                                 HasSubstr("apt install ffmpeg")));
  EXPECT_THAT(files(), ElementsAre("bin", "room.world"));
}

TEST_F(RunPictures, RenderOpensTheFilmBeforeItDrawsPictures) {
  add_ffmpeg();
  ASSERT_EQ(mkfifo(path("f.mp4").c_str(), 0600), 0);
  const Outcome outcome =
      troupe({"render", "room.world", "-o", "p.png", "--film", "f.mp4", "--for", "0.5", "--size", "64x48"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("f.mp4: error: cannot be written: "));
  EXPECT_THAT(files(), ElementsAre("bin", "f.mp4", "room.world"));
}

TEST_F(RunPictures, AFilmThatFailsIsAFailureAndLeavesNothing) {
  add_ffmpeg();
  setenv("FAKE_FFMPEG_CODE", "7", 1);
  const Outcome outcome = run({"--film", "f.mp4"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("f.mp4: error: writing failed: ffmpeg ended with exit code 7"));
  EXPECT_THAT(files(), ElementsAre("bin", "room.world"));
}

TEST_F(RunPictures, AFilmOnAFullDiskIsAFailureAndLeavesNothing) {
  if (find_ffmpeg().empty()) GTEST_SKIP() << "ffmpeg is not installed";
  const Outcome outcome = troupe_with_file_limit(
      {"run", "room.world", "--for", "0.2", "--quiet", "--size", "64x48", "--film", "f.mp4"}, 1024);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("f.mp4: error: writing failed: ffmpeg ended with exit code 1"));
  EXPECT_THAT(files(), ElementsAre("bin", "room.world"));
}

// The first signal lets the run end with a whole film; the second one ends the program at once.
TEST_F(RunPictures, AFilmThatIsInterruptedTwiceLeavesNoPartialFile) {
  add_ffmpeg();
  setenv("FAKE_FFMPEG_WAITS", "1", 1);
  const Outcome killed = troupe_with_signals(
      k_endless_film, {{SIGTERM, [&] { return has_pictures(); }},
                       {SIGTERM, [&] { return std::filesystem::exists(path("waiting")); }}});
  EXPECT_EQ(killed.code, 128 + SIGTERM) << killed.err;
  EXPECT_THAT(files(), ElementsAre("bin", "room.world", "waiting"));
}

TEST_F(RunPictures, TheNextFilmReplacesThePartialFileOfAKilledOne) {
  add_ffmpeg();
  const Outcome killed = troupe_with_signals(k_endless_film, {{SIGKILL, [&] { return has_pictures(); }}});
  EXPECT_EQ(killed.code, 128 + SIGKILL) << killed.err;
  EXPECT_THAT(files(), ElementsAre("bin", "f.mp4.partial.mp4", "room.world"));
  // ffmpeg keeps the lock until it ends.
  const int partial = open(path("f.mp4.partial.mp4").c_str(), O_RDONLY | O_CLOEXEC);
  EXPECT_EQ(flock(partial, LOCK_EX), 0);
  close(partial);
  const Outcome outcome = run({"--film", "f.mp4"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(files(), ElementsAre("bin", "f.mp4", "room.world"));
}

// The folders have all names that the temporary file of the second picture may have.
TEST_F(RunPictures, APictureThatCannotBeWrittenIsRefusedBeforeTheRun) {
  std::filesystem::create_directory(path("p-0.4.svg.partial"));
  for (int n = 2; n <= 1000; ++n)
    std::filesystem::create_directory(path("p-0.4.svg." + std::to_string(n) + ".partial"));
  const std::vector<std::string> before = files();
  const Outcome outcome =
      run({"--snapshot", "p-{time}.svg", "--snapshot-at", "0.2,0.4", "--hash-log", "h.log"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.err, "p-0.4.svg: error: cannot be written: Is a directory\n");
  EXPECT_EQ(files(), before);
  EXPECT_EQ(troupe({"render", "room.world", "-o", "p-0.4.svg"}).code, 2);
  EXPECT_EQ(files(), before);
}

TEST_F(RunPictures, APictureOnAFullDiskIsRefusedBeforeTheRun) {
  constexpr std::size_t k_less_than_a_picture = 300;
  const std::vector<std::string> before = files();
  const Outcome outcome = troupe_with_file_limit(
      {"run", "room.world", "--for", "0.5", "--quiet", "--snapshot", "p.svg"}, k_less_than_a_picture);
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.err, "p.svg: error: cannot be written: File too large\n");
  EXPECT_EQ(files(), before);
}

TEST_F(RunPictures, WhatCannotBeIsRefusedBeforeTheRun) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"--snapshot", "p.png", "--camera", "follow:missing"},
       "room.world: error: there is no model \"missing\" to follow"},
      {{"--snapshot", "p.png", "--color-by", "velocity.q"},
       "room.world: error: unknown value \"velocity.q\""},
      {{"--snapshot", "p-{time}.png", "--snapshot-at", "0.2,0.8"},
       "room.world: error: --snapshot-at 0.8: give times within the run, which goes from 0 s to 0.5 s"},
      {{"--snapshot", "p.png", "--snapshot-at", "0.2,0.3"},
       "troupe run: error: --snapshot-at: several pictures need different names: write {time} in the name, "
       "as in --snapshot p-{time}.png; see"},
      {{"--snapshot", "p-{time}.png"},
       "troupe run: error: --snapshot: {time} in the name of a picture is the time that --snapshot-at gives: "
       "give --snapshot-at, or another name; see"},
      {{"--film", "none/%06d.png"}, "none/%06d.png: error: cannot be written: there is no folder none"},
      {{"--snapshot", "none/p.png"}, "none/p.png: error: cannot be written: there is no folder none"},
      {{"--snapshot", "none/p.svg"}, "none/p.svg: error: cannot be written: there is no folder none"},
      {{"--snapshot", "p.gif"},
       "--snapshot: \"p.gif\" is not the name of a picture, as in --snapshot crowd.png, crowd.svg or "
       "crowd.pdf"},
      {{"--snapshot", "p.png", "--background", "pink"},
       "--background: unknown background \"pink\"; known: dark, paper, transparent, white"},
      {{"--film", "f.mp4", "--background", "transparent"},
       "f.mp4: error: cannot be written: a film cannot be transparent: give another --background"},
      {{"--snapshot", "p.svg", "--angle", "30"},
       "room.world: error: p.svg: .svg and .pdf need a view from straight above"},
  };
  for (const auto& [options, message] : cases) {
    std::vector<std::string> with_log = options;
    with_log.insert(with_log.end(), {"--hash-log", "h.log"});
    const Outcome outcome = run(with_log);
    EXPECT_EQ(outcome.code, 2) << message;
    EXPECT_THAT(outcome.out, IsEmpty());
    EXPECT_THAT(outcome.err, HasSubstr(message));
    EXPECT_THAT(files(), ElementsAre("bin", "room.world"));
  }
}

}  // namespace
}  // namespace troupe::apps::pictures_test
