#include "worldio/results/sealed_file.hpp"
#include "base/diagnostics.hpp"
#include "base/hash.hpp"
#include "tests/support/scratch.hpp"
#include "worldio/partial_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

namespace troupe::worldio::sealed_file_test {
namespace {

namespace fs = std::filesystem;
using ::testing::StartsWith;

class SealedFile : public test::ScratchTest {
 protected:
  fs::path file_ = folder_ / "a.kept";

  void seal(std::string_view text) const {
    const std::string bytes = std::string(k_seal_bytes, '\0') + std::string(text);
    write_sealed(file_, "test", 2, std::as_bytes(std::span(bytes)));
  }
  /// What check_seal() says of a file with these bytes, behind its name; empty when nothing.
  std::string error_of(std::string_view bytes, std::string_view kind = "test", unsigned layout = 2) const {
    write("b.kept", bytes);
    try {
      check_seal(folder_ / "b.kept", kind, layout);
    } catch (const InputError& error) {
      const std::string begin = (folder_ / "b.kept").string() + ": error: ";
      EXPECT_THAT(error.what(), StartsWith(begin));
      return std::string(error.what()).substr(begin.size());
    }
    return {};
  }
};

TEST_F(SealedFile, SaysWhatItIsAndHashesTheRest) {
  seal("some bytes");
  const std::string bytes = content(file_);
  EXPECT_EQ(bytes.size(), k_seal_bytes + 10);
  EXPECT_THAT(bytes,
              StartsWith("troupe test\nlayout 2\nbytes 10\nxxh3 " + hex(hash_text("some bytes")) + "\n  "));
  EXPECT_EQ(error_of(bytes), "");
  EXPECT_TRUE(has_seal(file_, "test"));
  EXPECT_FALSE(has_seal(file_, "other"));
  EXPECT_FALSE(fs::exists(file_.string() + ".partial"));
}

TEST_F(SealedFile, MayHoldNothing) {
  seal("");
  EXPECT_EQ(error_of(content(file_)), "");
}

TEST_F(SealedFile, EveryByteThatChangedShows) {
  seal(std::string(300, 'x'));
  const std::string good = content(file_);
  for (std::size_t i = 0; i < good.size(); i += i < 100 ? 1 : 13) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ (1 << (i % 8)));
    EXPECT_NE(error_of(bad), "") << "byte " << i;
  }
}

TEST_F(SealedFile, EveryCutShows) {
  seal(std::string(1000, 'x'));
  const std::string good = content(file_);
  for (std::size_t size = 1; size < good.size(); size += 57)
    EXPECT_THAT(error_of(good.substr(0, size)),
                StartsWith("the file was cut off: it has " + std::to_string(size) + " bytes"));
  EXPECT_THAT(error_of(good + "x"), StartsWith("the file is damaged"));
}

TEST_F(SealedFile, SaysWhyItRefuses) {
  seal("abc");
  const std::string good = content(file_);
  EXPECT_THAT(error_of(good, "checkpoint"), StartsWith("this is not a checkpoint"));
  EXPECT_EQ(error_of(good, "test", 1),
            "the file has layout 2, that of a newer version of Troupe; this program reads layout 1");
  EXPECT_EQ(error_of(good, "test", 3),
            "the file has layout 2, that of an older version of Troupe; this program reads layout 3");
  EXPECT_EQ(error_of(""), "this is not a test: the file is empty");
  EXPECT_EQ(error_of("\x89HDF\r\n\x1a\n and so on"), "this is an HDF5 file, but not a test");
  EXPECT_EQ(error_of(std::string(2000, 'z')), "this is not a test");
  EXPECT_EQ(error_of(good.substr(0, 514)), "the file was cut off: it has 514 bytes instead of 515");
  EXPECT_THROW(check_seal(folder_ / "nowhere", "test", 2), InputError);
  EXPECT_THROW(check_seal(folder_, "test", 2), InputError);
}

TEST_F(SealedFile, AFullDiskLeavesTheFileBefore) {
  seal("before");
  const std::string before = content(file_);
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1000, old.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  std::string error;
  try {
    seal(std::string(5000, 'x'));
  } catch (const std::runtime_error& thrown) {
    error = thrown.what();
  }
  setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_EQ(error, file_.string() + ": error: cannot be written: File too large");
  EXPECT_EQ(content(file_), before);
  EXPECT_FALSE(fs::exists(file_.string() + ".partial"));
}

TEST_F(SealedFile, TwoWritersOfOneFileDoNotWriteIntoEachOther) {
  const PartialFile one(file_);
  EXPECT_EQ(one.path(), file_.string() + ".partial");
  {
    const PartialFile other(file_);
    EXPECT_EQ(other.path(), file_.string() + ".2.partial");
    seal("whole");  // a third
    EXPECT_EQ(error_of(content(file_)), "");
    EXPECT_TRUE(fs::exists(one.path()));
    EXPECT_TRUE(fs::exists(other.path()));
  }
  EXPECT_FALSE(fs::exists(file_.string() + ".2.partial"));
  EXPECT_FALSE(fs::exists(file_.string() + ".3.partial"));
}

TEST_F(SealedFile, ManyWritersOfOneFileLeaveAWholeOne) {
  constexpr int k_writers = 4;
  std::vector<pid_t> writers;
  for (int w = 0; w < k_writers; ++w) {
    const pid_t child = fork();
    if (child == 0) {
      try {
        for (int i = 0; i < 20; ++i) seal(std::string(200000, static_cast<char>('a' + w)));
        _exit(0);
      } catch (...) {
        _exit(1);
      }
    }
    writers.push_back(child);
  }
  for (const pid_t writer : writers) {
    int status = 0;
    waitpid(writer, &status, 0);
    EXPECT_EQ(status, 0);
  }
  EXPECT_EQ(error_of(content(file_)), "");
  fs::remove(folder_ / "b.kept");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1) << "leftovers";
}

TEST_F(SealedFile, TakesTheNameThatALinkOrAFolderHasForAnother) {
  fs::create_directory(file_.string() + ".partial");
  fs::create_symlink("elsewhere", file_.string() + ".2.partial");
  seal("new");
  EXPECT_EQ(error_of(content(file_)), "");
  EXPECT_FALSE(fs::exists(folder_ / "elsewhere"));
}

TEST_F(SealedFile, ReplacesTheFileToWhichALinkPoints) {
  fs::create_directory(folder_ / "real");
  write("real/a.kept", "old");
  fs::create_symlink("real/a.kept", file_);
  EXPECT_EQ(PartialFile(file_).path(), fs::canonical(folder_) / "real" / "a.kept.partial");
  seal("new");
  EXPECT_TRUE(fs::is_symlink(file_));
  EXPECT_EQ(error_of(content(folder_ / "real" / "a.kept")), "");
}

TEST_F(SealedFile, CreatesTheFileToWhichALinkPoints) {
  fs::create_directory(folder_ / "real");
  fs::create_symlink("real/a.kept", file_);  // the file real/a.kept does not exist
  EXPECT_EQ(PartialFile(file_).path(), fs::canonical(folder_) / "real" / "a.kept.partial");
  seal("new");
  EXPECT_TRUE(fs::is_symlink(file_));
  EXPECT_FALSE(fs::is_symlink(folder_ / "real" / "a.kept"));
  EXPECT_EQ(error_of(content(folder_ / "real" / "a.kept")), "");
}

TEST_F(SealedFile, RefusesALinkThatLeadsToNoFolderOrToItself) {
  for (const auto& [target, reason] : {std::pair("none/a.kept", std::errc::no_such_file_or_directory),
                                       std::pair("a.kept", std::errc::too_many_symbolic_link_levels)}) {
    fs::remove(file_);
    fs::create_symlink(target, file_);
    std::error_code code;
    try {
      const PartialFile partial(file_);
    } catch (const std::system_error& error) {
      code = error.code();
    }
    EXPECT_EQ(code, reason);
    EXPECT_TRUE(fs::is_symlink(file_));
  }
}

TEST_F(SealedFile, KeepsThePermissionsOfAReplacedFile) {
  for (const auto permissions : {fs::perms(0640), fs::perms(0600), fs::perms(0666)}) {
    write("a.kept", "old");
    fs::permissions(file_, permissions);
    seal("new");
    EXPECT_EQ(fs::status(file_).permissions(), permissions);
  }
}

/// Calls `prepare` in a child process and then makes a PartialFile for `file` there. Returns the error of the
/// constructor, 0 if there is none, or nothing if `prepare` returns false.
std::optional<int> error_in_child(const fs::path& file, const std::function<bool()>& prepare) {
  constexpr int k_unprepared = 255;
  const pid_t child = fork();
  if (child == 0) {
    if (!prepare()) _exit(k_unprepared);
    try {
      const PartialFile partial(file);
      _exit(0);
    } catch (const std::system_error& error) {
      _exit(error.code().value());
    }
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (WEXITSTATUS(status) == k_unprepared) return std::nullopt;
  return WEXITSTATUS(status);
}

// The rename at the end of a run would fail, and the results of the run would be lost.
TEST_F(SealedFile, RefusesAtOnceAFileThatCannotBeReplaced) {
  write("a.kept", "old");
  const auto mount_point = error_in_child(file_, [&] {  // such as a single file of a container
    return unshare(CLONE_NEWNS) == 0 && mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
           mount(file_.c_str(), file_.c_str(), nullptr, MS_BIND, nullptr) == 0;
  });
  constexpr uid_t k_other = 65534;
  fs::permissions(folder_, fs::perms(01777));
  fs::permissions(file_, fs::perms(0666));
  const auto foreign = error_in_child(file_, [&] { return setuid(k_other) == 0; });
  fs::permissions(folder_, fs::perms(0777));
  const auto shared = error_in_child(file_, [&] { return setuid(k_other) == 0; });
  EXPECT_EQ(content(file_), "old");
  if (!foreign || !shared) GTEST_SKIP() << "only root can change the user";
  EXPECT_EQ(*foreign, EPERM);
  EXPECT_EQ(*shared, 0);
  if (!mount_point) GTEST_SKIP() << "this process cannot mount";
  EXPECT_EQ(*mount_point, EBUSY);
}

TEST_F(SealedFile, KeepsTheOwnerOfAReplacedFile) {
  write("a.kept", "old");
  constexpr uid_t k_owner = 1234;
  if (chown(file_.c_str(), k_owner, k_owner + 1) != 0) GTEST_SKIP() << "only root can change the owner";
  seal("new");
  struct stat status {};
  ASSERT_EQ(stat(file_.c_str(), &status), 0);
  EXPECT_EQ(status.st_uid, k_owner);
  EXPECT_EQ(status.st_gid, k_owner + 1);
}

TEST_F(SealedFile, ReplacesWhatAKilledWriterLeft) {
  write("a.kept.partial", std::string(5000, 'y'));
  seal("new");
  EXPECT_EQ(error_of(content(file_)), "");
  EXPECT_FALSE(fs::exists(file_.string() + ".partial"));
}

TEST_F(SealedFile, SaysThatTooManyFilesAreOpen) {
  PartialFile out(file_);
  rlimit before{};
  getrlimit(RLIMIT_NOFILE, &before);
  const rlimit none{0, before.rlim_max};
  setrlimit(RLIMIT_NOFILE, &none);
  std::error_code code;
  try {
    out.commit();
  } catch (const std::system_error& error) {
    code = error.code();
  }
  setrlimit(RLIMIT_NOFILE, &before);
  EXPECT_EQ(code, std::errc::too_many_files_open);
}

TEST_F(SealedFile, NamesTheFileThatCannotBeWritten) {
  try {
    const std::vector<std::byte> bytes(k_seal_bytes);
    write_sealed(folder_ / "no" / "a.kept", "test", 2, bytes);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(),
                StartsWith((folder_ / "no" / "a.kept").string() + ": error: cannot be written: "));
  }
}

}  // namespace
}  // namespace troupe::worldio::sealed_file_test
