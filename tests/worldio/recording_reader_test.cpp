#include "worldio/results/recording_reader.hpp"

#include "tests/support/message_of.hpp"
#include "tests/support/scratch.hpp"
#include "tests/worldio/recording_by_hand.hpp"
#include "worldio/results/hdf5_superblock.hpp"
#include "worldio/results/recording_repair.hpp"
#include "worldio/results/recording_writer.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <grp.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <exception>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

namespace troupe::worldio::recording_reader_test {
namespace {

namespace fs = std::filesystem;
using engine::Element;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Reader : public test::ScratchTest {
 protected:
  void SetUp() override {
    if (!has_hdf5()) GTEST_SKIP() << "built without HDF5";
  }
  std::string error_of(const RecordingByHand& recording) {
    recording.write(file_);
    const std::string error = test::message_of<Hdf5Error>([&] { RecordingReader reader(file_); });
    EXPECT_THAT(error, ::testing::StartsWith(file_.string() + ": error: "));
    return error;
  }
  fs::path file_ = folder_ / "run.h5";
};

TEST_F(Reader, ReadsWhatStandsInTheLayout) {
  RecordingByHand().write(file_);
  const RecordingReader recording(file_);
  EXPECT_EQ(recording.every_ticks(), 2u);
  EXPECT_EQ(recording.meta().at("seed"), "5");
  EXPECT_EQ(recording.world_json(), "{}");
  EXPECT_THAT(recording.ids(), ElementsAre(1, 3, 4));
  EXPECT_THAT(recording.ticks(), ElementsAre(0, 2, 4));
  ASSERT_EQ(recording.arrays().size(), 2u);
  const RecordingReader::Array& ranges = recording.arrays()[0];
  EXPECT_EQ(ranges.component, "sensors/bot/eye");
  EXPECT_THAT(ranges.bodies, ElementsAre(0, 2));
  std::vector<float> values(4);
  recording.read(ranges, 1, std::as_writable_bytes(std::span(values)));
  EXPECT_THAT(values, ElementsAre(4, 5, 6, 7));
  EXPECT_EQ(recording.arrays()[1].component, "pose");
  EXPECT_EQ(recording.arrays()[1].field.unit, "m");
}

TEST_F(Reader, CountsWholeFramesOnly) {
  for (const RecordingByHand& recording :
       {RecordingByHand{.ticks = {0, 2, k_no_tick}}, RecordingByHand{.times_s = {0, 1}},
        RecordingByHand{.x_frames = 2}, RecordingByHand{.alive = {2, 3}}}) {
    recording.write(file_);
    EXPECT_EQ(RecordingReader(file_).frames(), 2u);
  }
}

TEST_F(Reader, RefusesWhatIsNoRecording) {
  EXPECT_THAT(error_of({.kind = "troupe checkpoint"}), HasSubstr("the file is not a recording"));
  EXPECT_THAT(
      error_of({.layout = 2}),
      HasSubstr("/meta has layout 2, which another version of Troupe wrote; this program reads layout 1"));
  { Hdf5File::create(file_).create_group("data"); }
  EXPECT_THROW(RecordingReader reader(file_), Hdf5Error);
}

TEST_F(Reader, RefusesWhatDoesNotFitTogether) {
  EXPECT_THAT(error_of({.every = 0}), HasSubstr("has a record_every_ticks of 0, which must be at least 1"));
  EXPECT_THAT(error_of({.types = {"bot"}}), HasSubstr(" 1 types and "));
  EXPECT_THAT(error_of({.names = {}}), HasSubstr(" and 0 names, but needs the same number of each"));
  EXPECT_THAT(error_of({.ticks = {0, 4, 2}}),
              HasSubstr("/frames has tick 2 after tick 4, but ticks must increase"));
  EXPECT_THAT(error_of({.ids = {1, 3, 3}}), HasSubstr("/bodies has id 3 after id 3, but ids must increase"));
  EXPECT_THAT(error_of({.times_s = {0, std::nan(""), 1}}),
              HasSubstr("/frames has the time nan s at tick 2, after 0 s, "));
  EXPECT_THAT(
      error_of({.times_s = {0, 1, 0.5}}),
      HasSubstr("has the time 0.5 s at tick 4, after 1 s, but times must be finite and must not decrease"));
  EXPECT_THAT(
      error_of({.alive = {3, 2}}),
      HasSubstr("/state/alive has the shape [3 x 2] and values of type uint8, but must have the shape "
                "[frames x 3] and values of type uint8"));
  EXPECT_THAT(error_of({.x_row = {2, 1}}), HasSubstr(" x 2 x 1], but must have the shape [frames x 3 x "
                                                     "values]"));
  EXPECT_THAT(error_of({.x_row = {3}}), HasSubstr(" x 3], but must have the shape [frames x 3 x values]"));
  EXPECT_THAT(error_of({.sensor_rows = 3}), HasSubstr("but must have the shape [frames x 2 x values]"));
  EXPECT_THAT(error_of({.with_frames = false}), HasSubstr("there is no group /frames"));
}

TEST_F(Reader, TheHeadSaysWhetherAWriterHasTheFile) {
  {
    Hdf5File file = Hdf5File::create(file_);
    Hdf5Dataset x = file.create_extendible("x", Element::u32, {}, {.extent = {16}});
    file.flush();
    EXPECT_TRUE(read_superblock(file_)->writing());
    file.start_swmr();
    EXPECT_TRUE(read_superblock(file_)->swmr_writing());
    fs::copy_file(file_, folder_ / "copy.h5");
  }
  EXPECT_FALSE(read_superblock(file_)->writing());
  EXPECT_EQ(read_superblock(file_)->end, fs::file_size(file_));

  EXPECT_THROW(Hdf5File::open(folder_ / "copy.h5"), Hdf5Error);
  std::ofstream(folder_ / "copy.h5", std::ios::binary | std::ios::app) << "more than the head knows of";
  close_superblock(folder_ / "copy.h5");
  EXPECT_FALSE(read_superblock(folder_ / "copy.h5")->writing());
  EXPECT_EQ(read_superblock(folder_ / "copy.h5")->end, fs::file_size(folder_ / "copy.h5"));
  EXPECT_EQ(Hdf5File::open(folder_ / "copy.h5").dataset("x").rows(), 0u);

  write("text", "no HDF5");
  EXPECT_FALSE(read_superblock(folder_ / "text"));
  EXPECT_FALSE(read_superblock(folder_ / "none"));
  EXPECT_THROW(close_superblock(folder_ / "text"), std::runtime_error);
  EXPECT_EQ(content(folder_ / "text"), "no HDF5");
}

/// Each flush of a recording overwrites the head. Without a second attempt, some of these reads see a half of
/// it.
TEST_F(Reader, TheHeadIsReadWhileItIsOverwritten) {
  const fs::path other = folder_ / "other.h5";
  {
    Hdf5File file = Hdf5File::create(file_);
    file.flush();
    fs::copy_file(file_, other);
  }
  const std::string closed = content(file_);
  const std::string open = content(other);
  ASSERT_NE(closed.substr(0, 48), open.substr(0, 48));
  std::atomic<bool> done = false;
  std::jthread writer([&] {
    const int descriptor = ::open(file_.c_str(), O_WRONLY | O_CLOEXEC);
    while (!done)
      for (const std::string& head : {closed, open}) EXPECT_EQ(pwrite(descriptor, head.data(), 48, 0), 48);
    close(descriptor);
  });
  int missing = 0;
  for (int i = 0; i < 100000; ++i) missing += !read_superblock(file_);
  done = true;
  EXPECT_EQ(missing, 0);
}

TEST_F(Reader, RepairKeepsTheFileWhereItCannotHelp) {
  RecordingByHand{.kind = "another"}.write(file_);
  const std::string before = content(file_);
  EXPECT_THROW(repair_recording(file_), Hdf5Error);
  EXPECT_EQ(content(file_), before);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
}

TEST_F(Reader, ErrorsOfRepairNameTheRecording) {
  {
    Hdf5File file = Hdf5File::create(file_);
    Hdf5Dataset x = file.create_extendible("x", Element::u32, {}, {.extent = {16}});
    file.flush();
    file.start_swmr();
    fs::copy_file(file_, folder_ / "cut.h5");
  }
  const std::uint64_t shorter = read_superblock(folder_ / "cut.h5")->end - 1;
  fs::resize_file(folder_ / "cut.h5", shorter);
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{shorter, old.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  EXPECT_THAT([&] { repair_recording(folder_ / "cut.h5"); },
              ::testing::ThrowsMessage<Hdf5Error>((folder_ / "cut.h5").string() +
                                                  ": error: cannot be marked as finished: File too large"));
  const rlimit half{shorter / 2, old.rlim_max};
  setrlimit(RLIMIT_FSIZE, &half);
  EXPECT_THAT([&] { repair_recording(folder_ / "cut.h5"); },
              ::testing::ThrowsMessage<Hdf5Error>((folder_ / "cut.h5").string() +
                                                  ": error: cannot be repaired: File too large"));
  setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, old_handler);
}

/// Added rows of /state/alive would be 0: all bodies would be absent.
TEST_F(Reader, RepairCutsToTheFramesOfWhichItIsKnownWhoIsThere) {
  RecordingByHand{.alive = {2, 3}}.write(file_);
  EXPECT_EQ(repair_recording(file_).frames, 2u);
  EXPECT_EQ(Hdf5File::open(file_).group("state").dataset("alive").rows(), 2u);
}

class Repaired : public Reader {
 protected:
  /// Writes a recording whose repair removes unused space. Returns the size of the file without this space.
  std::uintmax_t write_with_unused_space() const {
    RecordingByHand().write(file_);
    const std::uintmax_t size = fs::file_size(file_);
    Hdf5File file = Hdf5File::open_to_write(file_);
    Hdf5Dataset removed = file.create_extendible("removed", Element::u64, {}, {.extent = {1 << 18}});
    removed.append(std::span<const std::uint64_t>(std::vector<std::uint64_t>(1 << 18)));  // 2 MiB
    file.write("last", std::span<const double>(std::vector<double>(100)));
    removed.resize(0);
    return size;
  }
};

TEST_F(Repaired, HasNoUnusedSpace) {
  const std::uintmax_t size = write_with_unused_space();
  EXPECT_GT(fs::file_size(file_), size + (2 << 20));
  constexpr uid_t k_owner = 1234;
  const bool is_owned = chown(file_.c_str(), k_owner, k_owner) == 0;  // only root can change the owner
  const Repair done = repair_recording(file_);
  EXPECT_TRUE(done.needed);
  EXPECT_EQ(done.frames, 3u);
  EXPECT_LT(fs::file_size(file_), size + 10000);
  struct stat status {};
  EXPECT_EQ(stat(file_.c_str(), &status), 0);
  EXPECT_EQ(status.st_uid == k_owner, is_owned);
  EXPECT_THAT(RecordingReader(file_).ticks(), ElementsAre(0, 2, 4));
  EXPECT_FALSE(repair_recording(file_).needed);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
}

// A user who may not give a file to its owner can nevertheless keep its group, which may have rights to it.
TEST_F(Repaired, KeepsTheGroupIfNotTheOwner) {
  write_with_unused_space();
  constexpr uid_t k_owner = 1234;
  constexpr gid_t k_group = 2345;
  constexpr uid_t k_user = 3456;
  if (chown(file_.c_str(), k_owner, k_group) != 0) GTEST_SKIP() << "only root can change the owner";
  fs::permissions(file_, fs::perms(0660));
  fs::permissions(folder_, fs::perms(0777));
  const pid_t child = fork();
  if (child == 0) {
    const bool is_user = setgroups(1, &k_group) == 0 && setgid(k_user) == 0 && setuid(k_user) == 0;
    try {
      _exit(is_user && repair_recording(file_).needed ? 0 : 1);
    } catch (const std::exception&) {
      _exit(2);
    }
  }
  int ended = 0;
  waitpid(child, &ended, 0);
  ASSERT_EQ(ended, 0);
  struct stat status {};
  ASSERT_EQ(stat(file_.c_str(), &status), 0);
  EXPECT_EQ(status.st_uid, k_user);
  EXPECT_EQ(status.st_gid, k_group);
  EXPECT_EQ(status.st_mode & 0777, 0660u);
}

TEST_F(Repaired, IsNotWrittenThroughALink) {
  const fs::path other = write("other", "of another user");
  for (const char* name : {"run.h5.partial.copy", "run.h5.partial.copy.packed", "run.h5.partial.packed"})
    fs::create_symlink(other, folder_ / name);
  write_with_unused_space();
  EXPECT_TRUE(remove_unused_space(file_));
  EXPECT_FALSE(fs::is_symlink(file_));
  write_with_unused_space();
  EXPECT_TRUE(repair_recording(file_).needed);
  EXPECT_FALSE(fs::is_symlink(file_));
  EXPECT_THAT(RecordingReader(file_).ticks(), ElementsAre(0, 2, 4));
  EXPECT_EQ(content(other), "of another user");
}

}  // namespace
}  // namespace troupe::worldio::recording_reader_test
