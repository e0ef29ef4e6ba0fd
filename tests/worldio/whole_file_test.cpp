#include "worldio/whole_file.hpp"

#include "tests/support/scratch.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <iterator>
#include <system_error>

namespace troupe::worldio::whole_file_test {
namespace {

namespace fs = std::filesystem;

using WholeFile = test::ScratchTest;

TEST_F(WholeFile, ACheckLeavesNothingBehind) {
  const fs::path old = write("old.png", "old");
  check_replaceable(old);
  check_replaceable(folder_ / "new.png");
  EXPECT_EQ(content(old), "old");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

// A temporary file in the folder of a device must not replace the device.
TEST_F(WholeFile, ACheckAcceptsDevices) { EXPECT_NO_THROW(check_replaceable("/dev/null")); }

TEST_F(WholeFile, ACheckThrowsTheErrorOfWriting) {
  const auto code_of = [](auto&& call) -> std::error_code {
    try {
      call();
    } catch (const std::system_error& error) {
      return error.code();
    }
    return {};
  };
  for (const fs::path& file : {folder_, folder_ / "none" / "p.png"}) {
    const std::error_code expected = code_of([&] { write_whole(file, {"text"}); });
    EXPECT_TRUE(expected) << file;
    EXPECT_EQ(code_of([&] { check_replaceable(file); }), expected) << file;
  }
}

}  // namespace
}  // namespace troupe::worldio::whole_file_test
