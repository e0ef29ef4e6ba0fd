#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::apps {

/// The exit code and the output of one finished run of the program `troupe`.
struct Outcome {
  int code = -1;    ///< exit code; 128 + number of the signal if a signal ended the program
  std::string out;  ///< text that the program wrote to its standard output
  std::string err;  ///< text that the program wrote to its standard error
};

/// A test that runs the program `troupe` as a separate process. The working folder of the process is a
/// temporary folder. It is empty at the start of the test and is removed at its end.
class ProgramTest : public ::testing::Test {
 protected:
  ProgramTest();
  ~ProgramTest() override;

  /// Writes a file into the temporary folder.
  void write(const std::string& name, std::string_view text);
  /// Returns the content of a file in the temporary folder. If the file does not exist, the test fails, and
  /// the result is empty.
  std::string read(const std::string& name) const;
  /// Returns the path of a file in the temporary folder. The file need not exist.
  std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  /// Returns the names of all files and folders in the temporary folder, sorted.
  std::vector<std::string> files() const;

  /// Runs `troupe ARGUMENTS...` and waits until it ends.
  Outcome troupe(const std::vector<std::string>& arguments) const;
  /// Runs a world in the temporary folder for `seconds` on two ranks that divide the robots, and returns the
  /// mean number of messages per rank and tick. outputs: further arguments
  double messages_of_ranks(const std::string& world, int seconds,
                           const std::vector<std::string>& outputs) const;
  /// A signal to the program, such as SIGINT.
  struct Signal {
    int number;                  ///< number of the signal
    std::function<bool()> when;  ///< condition; the signal is sent as soon as it returns true
  };
  /// Runs `troupe ARGUMENTS...` and sends it signals in the given order. Sends each signal as soon as its
  /// condition `when` is true. Then waits until the program ends. If the program ends before, or after 240 s,
  /// the test fails, and the remaining signals are sent at once.
  Outcome troupe_with_signals(const std::vector<std::string>& arguments,
                              const std::vector<Signal>& signals) const;
  /// Runs `troupe ARGUMENTS...`, and sends it a signal as soon as a file in the temporary folder has `lines`
  /// lines, as troupe_with_signals() does.
  Outcome troupe_until(const std::vector<std::string>& arguments, const std::string& file, std::size_t lines,
                       int signal) const;
  /// Runs `troupe ARGUMENTS...` as on a full disk: an attempt of the program to make a file longer than
  /// `bytes` fails.
  Outcome troupe_with_file_limit(const std::vector<std::string>& arguments, std::size_t bytes) const;
  /// Runs `troupe ARGUMENTS...` with at most `bytes` of address space. Not for builds with the address
  /// sanitizer, which reserves more.
  Outcome troupe_with_memory_limit(const std::vector<std::string>& arguments, std::size_t bytes) const;
  /// Whether the system has pseudo-terminals, for troupe_on_terminal(). Some containers have none.
  static bool has_terminals();
  /// Runs `troupe ARGUMENTS...` with a pseudo-terminal as its standard error. The result's member `err`
  /// contains all bytes that the terminal received.
  Outcome troupe_on_terminal(const std::vector<std::string>& arguments) const;

 private:
  struct Limit {
    int resource = 0;  ///< RLIMIT_FSIZE or another resource of setrlimit(2)
    std::size_t bytes = 0;
  };
  int start(const std::vector<std::string>& arguments, int out, int err,
            std::optional<Limit> limit = std::nullopt) const;
  Outcome run(const std::vector<std::string>& arguments, std::optional<Limit> limit = std::nullopt) const;
  Outcome finish(int process) const;

  std::filesystem::path folder_;   // the program's working folder
  std::filesystem::path streams_;  // where its output goes, outside of it
};

std::vector<std::string> lines_of(const std::string& text);

/// Whether the program ended because this build has no pictures, or because neither OSMesa nor EGL is
/// installed. Tests of pictures are then skipped. Any other error is a failure.
bool lacks_pictures(const Outcome& outcome);

/// A small world in the syntax of the simulator Stage: twelve robots with rangers (range sensors) wander in a
/// room with four walls.
extern const std::string_view k_room;

}  // namespace troupe::apps
