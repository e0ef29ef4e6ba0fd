#include "worldio/files.hpp"

#include "tests/support/scratch.hpp"

#include <filesystem>
#include <string>

namespace troupe::worldio {
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

}  // namespace
}  // namespace troupe::worldio
