// The seeds of the fuzz targets, and whatever they found once, in ordinary builds and with whatever sanitizer
// these have.

#include "tests/fuzz/targets.hpp"
#include "tests/support/slow_build.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace troupe::fuzz {
namespace {

struct Target {
  std::string name;
  void (*read)(std::string_view);
};

class Corpus : public ::testing::TestWithParam<Target> {};
INSTANTIATE_TEST_SUITE_P(Fuzz, Corpus,
                         ::testing::Values(Target{"stage", read_stage}, Target{"json", read_json},
                                           Target{"bitmap", read_bitmap}, Target{"map", read_map},
                                           Target{"recording", read_recording},
                                           Target{"checkpoint", read_checkpoint}),
                         [](const auto& target) { return target.param.name; });

std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  if (std::filesystem::exists(folder))
    for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

std::string content(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST_P(Corpus, IsReadToTheEnd) {
  const std::filesystem::path folder = std::filesystem::path(TROUPE_SOURCE_DIR) / "tests/fuzz";
  const auto start = std::chrono::steady_clock::now();
  std::size_t count = 0;
  for (const char* kind : {"corpus", "findings"})
    for (const std::filesystem::path& file : files_in(folder / kind / GetParam().name)) {
      SCOPED_TRACE(file.string());
      const std::string bytes = content(file);
      GetParam().read(bytes);
      // Nothing that is cut off does harm either.
      for (const std::size_t part : {1, 2, 3})
        GetParam().read(std::string_view(bytes).substr(0, bytes.size() * part / 4));
      ++count;
    }
  EXPECT_GE(count, 2u);
  if (!test::k_slow_build) {
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(60));
  }
}

}  // namespace
}  // namespace troupe::fuzz
