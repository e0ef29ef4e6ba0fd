#include "worldio/files.hpp"

#include "tests/support/scratch.hpp"
#include "tests/support/small_stack.hpp"

#include <filesystem>
#include <string>

namespace troupe::worldio::files_test {
namespace {

namespace fs = std::filesystem;

using Files = test::ScratchTest;

TEST_F(Files, ALinkToAFileThatDoesNotExistIsResolved) {
  fs::create_symlink("new.csv", folder_ / "link.csv");
  EXPECT_EQ(resolved_path(folder_ / "link.csv"), fs::canonical(folder_) / "new.csv");
}

// Two different files would otherwise count as one.
TEST_F(Files, PathsThatTheSystemCannotResolveRemainDifferent) {
  const fs::path deep = folder_ / std::string(5000, 'x');
  EXPECT_EQ(resolved_path(deep / "." / "a.log"), deep / "a.log");
  EXPECT_NE(resolved_path(deep / "a.log"), resolved_path(deep / "b.log"));
}

TEST_F(Files, AFileIsReadOnASmallStack) {
  const std::string text(200'000, 'x');
  const fs::path file = write("long.txt", text);
  test::on_small_stack([&] { EXPECT_TRUE(read_file(file) == text); });
}

}  // namespace
}  // namespace troupe::worldio::files_test
