// Runs the fuzz targets on their seeds (the corpora) and on the inputs that once revealed an error (the
// findings), in ordinary builds and with the sanitizers of these builds.

#include "tests/fuzz/draws.hpp"
#include "tests/fuzz/targets.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/slow_build.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace troupe::fuzz::corpus_test {
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
                                           Target{"checkpoint", read_checkpoint},
                                           Target{"sealed", read_sealed}, Target{"study", read_study},
                                           Target{"live", talk_to_view}, Target{"command", run_command}),
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

/// While an object of this class exists, all output of the process is discarded. It hides the output of the
/// command lines that run_command() runs.
class Silence {
 public:
  Silence() {
    std::fflush(nullptr);
    const int nothing = open("/dev/null", O_WRONLY | O_CLOEXEC);
    for (std::size_t i = 0; i < saved_.size(); ++i) {
      saved_[i] = dup(k_streams[i]);
      dup2(nothing, k_streams[i]);
    }
    close(nothing);
  }
  ~Silence() {
    std::fflush(nullptr);
    for (std::size_t i = 0; i < saved_.size(); ++i) {
      dup2(saved_[i], k_streams[i]);
      close(saved_[i]);
    }
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  static constexpr std::array<int, 2> k_streams{STDOUT_FILENO, STDERR_FILENO};
  std::array<int, 2> saved_{};
};

TEST_P(Corpus, IsReadToTheEnd) {
  const std::filesystem::path folder = test::source_dir() / "tests/fuzz";
  const auto start = std::chrono::steady_clock::now();
  std::size_t count = 0;
  for (const char* kind : {"corpus", "findings"})
    for (const std::filesystem::path& file : files_in(folder / kind / GetParam().name)) {
      SCOPED_TRACE(file.string());
      const std::string bytes = content(file);
      const Silence silence;
      GetParam().read(bytes);
      // The first quarter, half and three quarters of the input must not cause a crash either.
      for (const std::size_t part : {1, 2, 3})
        GetParam().read(std::string_view(bytes).substr(0, bytes.size() * part / 4));
      ++count;
    }
  EXPECT_GE(count, 2u);
  if (!test::k_slow_build) {  // usually a few seconds
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(600));
  }
}

TEST(SealedCheckpoints, NoMutantCrashesItsReader) {
  const int mutants = test::k_slow_build ? 200 : 2000;
  Random random(1);
  for (int i = 0; i < mutants; ++i) {
    std::size_t count = 1;
    while (chance(random, 30)) ++count;
    std::string edits(10 * count, '\0');
    for (char& byte : edits) byte = static_cast<char>(below(random, 256));
    SCOPED_TRACE(i);
    read_sealed(edits);
  }
}

}  // namespace
}  // namespace troupe::fuzz::corpus_test
