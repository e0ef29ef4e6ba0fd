#include "tests/apps/program.hpp"
#include "tests/support/paths.hpp"

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace troupe::apps {
namespace fs = std::filesystem;
namespace {

std::string content(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

fs::path fresh_folder() {
  std::string name = (fs::temp_directory_path() / "troupe_apps_XXXXXX").string();
  if (!mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
  return name;
}

int create(const fs::path& file) {
  return open(file.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0600);
}

}  // namespace

ProgramTest::ProgramTest() : folder_(fresh_folder()), streams_(fresh_folder()) {}

ProgramTest::~ProgramTest() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
  fs::remove_all(streams_, ignored);
}

void ProgramTest::write(const std::string& name, std::string_view text) {
  std::ofstream(folder_ / name, std::ios::binary) << text;
}

std::string ProgramTest::read(const std::string& name) const {
  EXPECT_TRUE(fs::exists(folder_ / name)) << name;
  return content(folder_ / name);
}

std::vector<std::string> ProgramTest::files() const {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder_)) names.push_back(entry.path().filename().string());
  std::ranges::sort(names);
  return names;
}

int ProgramTest::start(const std::vector<std::string>& arguments, int out, int err,
                       std::optional<Limit> limit) const {
  std::vector<std::string> words{test::program()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  const int process = fork();
  if (process == 0) {
    std::signal(SIGHUP, SIG_DFL);  // the tests may run under nohup, which ignores it
    dup2(out, STDOUT_FILENO);
    dup2(err, STDERR_FILENO);
    if (limit) {
      const rlimit both{limit->bytes, limit->bytes};
      setrlimit(limit->resource, &both);
      setenv("ASAN_OPTIONS", "detect_leaks=0", 1);  // HDF5 forgets the chunk that it could not write
    }
    if (chdir(folder_.c_str()) == 0) execv(test::program().c_str(), argv.data());
    _exit(127);
  }
  return process;
}

Outcome ProgramTest::finish(int process) const {
  int status = 0;
  waitpid(process, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), content(streams_ / "out"),
          content(streams_ / "err")};
}

Outcome ProgramTest::run(const std::vector<std::string>& arguments, std::optional<Limit> limit) const {
  const int out = create(streams_ / "out");
  const int err = create(streams_ / "err");
  const int process = start(arguments, out, err, limit);
  close(out);
  close(err);
  return finish(process);
}

Outcome ProgramTest::troupe(const std::vector<std::string>& arguments) const { return run(arguments); }

double ProgramTest::messages_of_ranks(const std::string& world, int seconds,
                                      const std::vector<std::string>& outputs) const {
  std::vector<std::string> arguments{"run",     world, "--for",     std::to_string(seconds),
                                     "--ranks", "2",   "--threads", "1"};
  arguments.insert(arguments.end(), {"--tile-size", "1", "--rank-balance", "off", "--distribute", "--json"});
  arguments.insert(arguments.end(), outputs.begin(), outputs.end());
  const Outcome outcome = troupe(arguments);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  return nlohmann::json::parse(outcome.out).at("ranks_messages_mean").get<double>();
}

Outcome ProgramTest::troupe_with_file_limit(const std::vector<std::string>& arguments,
                                            std::size_t bytes) const {
  return run(arguments, Limit{RLIMIT_FSIZE, bytes});
}

Outcome ProgramTest::troupe_with_memory_limit(const std::vector<std::string>& arguments,
                                              std::size_t bytes) const {
  return run(arguments, Limit{RLIMIT_AS, bytes});
}

Outcome ProgramTest::troupe_with_signals(const std::vector<std::string>& arguments,
                                         const std::vector<Signal>& signals) const {
  const int out = create(streams_ / "out");
  const int err = create(streams_ / "err");
  const int process = start(arguments, out, err);
  close(out);
  close(err);
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(240);
  const auto has_ended = [process] {
    siginfo_t ended{};
    waitid(P_PID, static_cast<id_t>(process), &ended, WEXITED | WNOHANG | WNOWAIT);
    return ended.si_pid != 0;
  };
  for (const Signal& signal : signals) {
    while (!signal.when()) {
      if (has_ended() || std::chrono::steady_clock::now() > deadline) {
        ADD_FAILURE() << "the condition of signal " << signal.number << " did not become true";
        break;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    kill(process, signal.number);
  }
  return finish(process);
}

Outcome ProgramTest::troupe_until(const std::vector<std::string>& arguments, const std::string& file,
                                  std::size_t lines, int signal) const {
  return troupe_with_signals(arguments,
                             {{signal, [&] { return lines_of(content(folder_ / file)).size() >= lines; }}});
}

namespace {

/// A new pseudo-terminal: its two sides, or -1 and -1 if the system has none.
std::pair<int, int> open_terminal() {
  const int terminal = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (terminal >= 0 && grantpt(terminal) == 0 && unlockpt(terminal) == 0)
    if (const int program_side = open(ptsname(terminal), O_RDWR | O_NOCTTY | O_CLOEXEC); program_side >= 0)
      return {terminal, program_side};
  if (terminal >= 0) close(terminal);
  return {-1, -1};
}

}  // namespace

bool ProgramTest::has_terminals() {
  const auto [terminal, program_side] = open_terminal();
  if (terminal < 0) return false;
  close(terminal);
  close(program_side);
  return true;
}

Outcome ProgramTest::troupe_on_terminal(const std::vector<std::string>& arguments) const {
  const auto [terminal, program_side] = open_terminal();
  if (terminal < 0) throw std::runtime_error("no terminal");
  const int out = create(streams_ / "out");
  const int process = start(arguments, out, program_side);
  close(out);
  close(program_side);
  std::string shown;
  char bytes[4096];
  for (ssize_t n = 0; (n = ::read(terminal, bytes, sizeof bytes)) > 0;)
    shown.append(bytes, static_cast<std::size_t>(n));
  close(terminal);
  Outcome outcome = finish(process);
  outcome.err = shown;
  return outcome;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

bool lacks_pictures(const Outcome& outcome) {
  return outcome.code == 1 && (outcome.err.find("this build cannot draw pictures") != std::string::npos ||
                               outcome.err.find("neither OSMesa nor EGL is installed") != std::string::npos);
}

const std::string_view k_room = R"(interval_sim 100
define wall model ( color "gray" )
wall( name "north" pose [0 4 0 0] size [8 0.2 1] )
wall( name "south" pose [0 -4 0 0] size [8 0.2 1] )
wall( name "east" pose [4 0 0 0] size [0.2 8 1] )
wall( name "west" pose [-4 0 0 0] size [0.2 8 1] )
define bot position (
  size [0.4 0.3 0.2]
  ranger( pose [0 0 -0.15 0] sensor( fov 180 samples 9 range [0 3] ) )
  ctrl "wander"
)
bot( pose [-2 -2 0 10] )
bot( pose [-2 0 0 60] )
bot( pose [-2 2 0 110] )
bot( pose [0 -2 0 160] )
bot( pose [0 0 0 210] )
bot( pose [0 2 0 260] )
bot( pose [2 -2 0 310] )
bot( pose [2 0 0 0] )
bot( pose [2 2 0 50] )
bot( pose [1 1 0 100] )
bot( pose [-1 1 0 150] )
bot( pose [1 -1 0 200] )
)";

}  // namespace troupe::apps
