#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::apps {

/// What a finished run of the program left.
struct Outcome {
  int code = -1;  ///< exit code; 128 + signal when a signal killed it
  std::string out;
  std::string err;
};

/// The program as a user meets it: started in a fresh folder of its own, which is removed with the test.
class ProgramTest : public ::testing::Test {
 protected:
  ProgramTest();
  ~ProgramTest() override;

  /// Writes a file into the folder.
  void write(const std::string& name, std::string_view text);
  /// Reads one from it; a missing file fails the test and reads as nothing.
  std::string read(const std::string& name) const;
  /// Where a file of the folder lies.
  std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  /// Names of all files in the folder, sorted.
  std::vector<std::string> files() const;

  /// Runs `troupe ARGUMENTS...` to its end.
  Outcome troupe(const std::vector<std::string>& arguments) const;
  /// A signal, and a condition as soon as which it is sent.
  struct Signal {
    int number;
    std::function<bool()> when;
  };
  /// The same; it is sent signals, one after the other.
  Outcome troupe_with_signals(const std::vector<std::string>& arguments,
                              const std::vector<Signal>& signals) const;
  /// The same; as soon as `file` has `lines` lines it is sent `signal`.
  Outcome troupe_until(const std::vector<std::string>& arguments, const std::string& file, std::size_t lines,
                       int signal) const;
  /// The same on a disk that is full: no file may be longer than `bytes`.
  Outcome troupe_with_file_limit(const std::vector<std::string>& arguments, std::size_t bytes) const;
  /// The same with a terminal for its standard error, whose every byte lands in `err`.
  Outcome troupe_on_terminal(const std::vector<std::string>& arguments) const;

 private:
  int start(const std::vector<std::string>& arguments, int out, int err, std::size_t file_bytes = 0) const;
  Outcome finish(int process) const;

  std::filesystem::path folder_;   // the program's working folder
  std::filesystem::path streams_;  // where its output goes, outside of it
};

std::vector<std::string> lines_of(const std::string& text);

/// Twelve robots that wander in a walled room, with rangers: everything a run has, in two dozen lines.
extern const std::string_view k_room;

}  // namespace troupe::apps
