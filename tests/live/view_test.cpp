#include "live/view.hpp"

#include "engine/world/world.hpp"
#include "tests/support/scratch.hpp"
#include "troupe/acts.hpp"
#include "troupe/session.hpp"
#include "troupe/simulation.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <mutex>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

// Requests whose order in time matters. tests/view_test.py tests `troupe view` as a whole.
namespace troupe::live::view_test {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

constexpr const char* k_one_bot = R"({"troupe": 1, "bounds_m": [[-9, -9], [9, 9]],
  "types": {"bot": {"size_m": [0.4, 0.3, 0.2], "drive": {"kind": "diff"}}},
  "models": [{"name": "a", "type": "bot"}]})";
constexpr std::string_view k_handshake =
    "GET /live HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n";
constexpr time_t k_most_s = 240;  // longest wait for a message of the program

/// A client with the token of an address `http://127.0.0.1:PORT/#TOKEN`.
class Viewer {
 public:
  explicit Viewer(const std::string& address) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(std::stoi(address.substr(address.rfind(':') + 1))));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval most{k_most_s, 0};
    if (::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &most, sizeof most) != 0 ||
        ::connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0)
      throw std::runtime_error("no connection to " + address);
    send_bytes(k_handshake);
    for (std::string head; !head.ends_with("\r\n\r\n");) head += bytes(1);
    send({address.substr(address.find('#') + 1)});
  }
  ~Viewer() { ::close(socket_); }
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  /// Sends short texts, each as a frame with the mask 0, all at once.
  void send(std::initializer_list<std::string> texts) {
    std::string frames;
    for (const std::string& text : texts)
      frames += "\x81" + std::string(1, static_cast<char>(0x80 | text.size())) + std::string(4, '\0') + text;
    send_bytes(frames);
  }
  /// Returns the next text, and acknowledges the pictures before it.
  Json receive() {
    for (;;) {
      const std::string head = bytes(2);
      std::size_t size = static_cast<unsigned char>(head[1]);
      if (size >= 126) {
        const std::string digits = bytes(size == 126 ? 2 : 8);
        size = 0;
        for (const char digit : digits) size = size << 8 | static_cast<unsigned char>(digit);
      }
      const std::string payload = bytes(size);
      if (head[0] == '\x81') return Json::parse(payload);
      if (head[0] == '\x82') send({R"({"do":"drawn"})"});
    }
  }
  /// Returns the next answer to a request.
  Json answer() {
    for (;;)
      if (const Json text = receive(); text["type"] == "done" || text["type"] == "refused") return text;
  }

 private:
  void send_bytes(std::string_view data) const {
    if (::send(socket_, data.data(), data.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(data.size()))
      throw std::runtime_error("the program has closed the connection");
  }
  std::string bytes(std::size_t count) const {
    std::string data(count, '\0');
    for (std::size_t at = 0; at < count;) {
      const ssize_t got = ::recv(socket_, data.data() + at, count - at, 0);
      if (got <= 0) throw std::runtime_error("no message of the program");
      at += static_cast<std::size_t>(got);
    }
    return data;
  }

  int socket_;
};

Simulation make_world(std::string text, unsigned ranks = 1, bool distribute = false) {
  SimulationOptions options;
  options.threads = 1;
  options.mortal = true;
  options.ranks = ranks;
  options.distribute = distribute;
  return Simulation::from_text(std::move(text), "w.json", options);
}

/// A world that a view shows on a thread of its own.
class Shown {
 public:
  explicit Shown(const std::filesystem::path& folder, Simulation world = make_world(k_one_bot))
      : simulation(std::move(world)) {
    View::Options options{.rate = 20, .folder = folder, .is_over = [this] { return is_over(); }};
    view_.emplace(simulation, options);
  }
  ~Shown() { end(); }
  Shown(const Shown&) = delete;
  Shown& operator=(const Shown&) = delete;

  std::string address() const { return view_->address(); }
  void run() {
    thread_ = std::thread([this] { view_->run(); });
  }
  /// Stops the thread of the simulation at the next call of is_over(), until release().
  void hold() {
    std::unique_lock lock(mutex_);
    is_held_ = true;
    changed_.wait(lock, [this] { return waits_; });
  }
  void release() {
    const std::scoped_lock lock(mutex_);
    is_held_ = false;
    changed_.notify_all();
  }
  void end() {
    {
      const std::scoped_lock lock(mutex_);
      ends_ = true;
    }
    release();
    if (thread_.joinable()) thread_.join();
  }

  Simulation simulation;

 private:
  bool is_over() {
    std::unique_lock lock(mutex_);
    waits_ = true;
    changed_.notify_all();
    changed_.wait(lock, [this] { return !is_held_; });
    waits_ = false;
    return ends_;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_held_ = false;
  bool waits_ = false;
  bool ends_ = false;
  std::optional<View> view_;
  std::thread thread_;
};

/// Opens files until the process has no free file descriptor but one.
class FewDescriptors {
 public:
  FewDescriptors() {
    getrlimit(RLIMIT_NOFILE, &before_);
    const rlimit fewer{std::min<rlim_t>(before_.rlim_cur, 256), before_.rlim_max};
    setrlimit(RLIMIT_NOFILE, &fewer);
    for (int file; (file = ::open("/dev/null", O_RDONLY | O_CLOEXEC)) >= 0;) files_.push_back(file);
    ::close(files_.back());
    files_.pop_back();
  }
  ~FewDescriptors() {
    for (const int file : files_) ::close(file);
    setrlimit(RLIMIT_NOFILE, &before_);
  }
  FewDescriptors(const FewDescriptors&) = delete;
  FewDescriptors& operator=(const FewDescriptors&) = delete;

 private:
  rlimit before_{};
  std::vector<int> files_;
};

/// Processor time of all threads of this process, s.
double processor_s() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

class ViewTest : public test::ScratchTest {};

TEST_F(ViewTest, WaitsWithoutFreeFileDescriptors) {
  Simulation simulation = Simulation::from_text(k_one_bot, "w.json", {.threads = 1});
  std::mutex mutex;
  std::condition_variable told;
  std::vector<std::string> reports;
  const View view(simulation, View::Options{.folder = folder_, .report = [&](const std::string& text) {
                                              const std::scoped_lock lock(mutex);
                                              reports.push_back(text);
                                              told.notify_all();
                                            }});
  Json first;
  std::thread viewer;
  double used_s = 0;
  {
    const FewDescriptors few;
    // The socket of the viewer has the last descriptor. The connection is not accepted yet, so the thread
    // waits for an answer.
    viewer = std::thread([&] { first = Viewer(view.address()).receive(); });
    std::unique_lock lock(mutex);
    EXPECT_TRUE(told.wait_for(lock, std::chrono::seconds(k_most_s), [&] { return !reports.empty(); }));
    lock.unlock();
    const double before_s = processor_s();
    std::this_thread::sleep_for(std::chrono::seconds(1));
    used_s = processor_s() - before_s;
  }
  viewer.join();
  EXPECT_EQ(first["type"], "hello") << first;
  EXPECT_LT(used_s, 0.3) << "the server tries again without a pause";
  ASSERT_EQ(reports.size(), 1u);
  EXPECT_THAT(reports[0], HasSubstr("a connection, until the system can accept it: Too many open files"));
}

TEST_F(ViewTest, AcceptsNewConnectionsAfterAnError) {
  Simulation simulation = Simulation::from_text(k_one_bot, "w.json", {.threads = 1});
  std::mutex mutex;
  std::vector<std::string> reports;
  const View view(simulation, View::Options{.folder = folder_, .report = [&](const std::string& text) {
                                              const std::scoped_lock lock(mutex);
                                              reports.push_back(text);
                                              if (reports.size() == 1) throw std::bad_alloc();
                                            }});
  Viewer before(view.address());
  EXPECT_EQ(before.receive()["type"], "hello");
  EXPECT_THROW(Viewer(view.address() + "x").receive(), std::runtime_error);
  EXPECT_THROW(before.receive(), std::runtime_error);
  EXPECT_EQ(Viewer(view.address()).receive()["type"], "hello");
  const std::scoped_lock lock(mutex);
  EXPECT_THAT(reports,
              ::testing::ElementsAre("refused: a WebSocket without a valid token",
                                     "refused: all connections, until browsers load the page again, because "
                                     "of an error: not enough memory"));
}

TEST_F(ViewTest, ACheckpointOfAPausedRunDoesNotContainALaterAct) {
  Shown shown(folder_);
  shown.run();
  Viewer viewer(shown.address());
  viewer.send({R"({"do":"pause","id":1})"});
  Json state = viewer.receive();
  while (state["type"] != "state" || state["playing"]) state = viewer.receive();
  shown.hold();
  // The thread of the server refuses the third text itself. Its answer therefore shows that the first two
  // texts wait for the simulation.
  viewer.send({R"({"do":"checkpoint","id":2})", R"({"do":"move","robot":"a","pose":[3,3,0,0],"id":3})", "x"});
  EXPECT_EQ(viewer.answer()["type"], "refused");
  shown.release();
  const Json saved = viewer.answer();
  ASSERT_EQ(saved["id"], 2) << saved;
  EXPECT_EQ(viewer.answer()["id"], 3);
  shown.end();
  Simulation resumed = Simulation::resume(folder_ / saved["file"].get<std::string>());
  EXPECT_EQ(resumed.tick(), state["tick"]);
  EXPECT_EQ(resumed.find("a").pose().x, 0);
}

// Each of the two ranks has one of the robots.
TEST_F(ViewTest, ShowsTheRobotsOfAllDistributedRanks) {
  Shown shown(folder_, make_world(R"({"troupe": 1,
    "types": {"bot": {"size_m": [0.4, 0.3, 0.2], "drive": {"kind": "diff"}}},
    "models": [{"name": "a", "type": "bot", "pose": {"x_m": -90}},
               {"name": "b", "type": "bot", "pose": {"x_m": 90}}]})",
                                  2, true));
  EXPECT_TRUE(shown.simulation.rank_statistics().is_distributed);
  shown.run();
  Viewer viewer(shown.address());
  viewer.send({R"({"do":"pause","id":1})"});
  Json state = viewer.receive();
  while (state["type"] != "state" || state["playing"]) state = viewer.receive();
  const auto expect_place = [&](const std::string& name, double x) {
    viewer.send({R"({"do":"inspect","id":2,"robot":")" + name + "\"}"});
    while (!state.contains("inspected") || state["inspected"]["robot"] != name) state = viewer.receive();
    EXPECT_EQ(state["inspected"]["pose"][0], x);
  };
  expect_place("a", -90);
  expect_place("b", 90);
  viewer.send({R"({"do":"checkpoint","id":3})"});  // the run then pauses between two ticks
  Json saved = viewer.answer();
  while (saved["id"] != 3) saved = viewer.answer();
  EXPECT_EQ(saved["type"], "done") << saved;
  expect_place("a", -90);
}

TEST_F(ViewTest, AViewerDoesNotStopARecordingOfTheProgram) {
  Shown shown(folder_);
  shown.simulation.record(folder_ / "own.h5");
  shown.run();
  Viewer viewer(shown.address());
  viewer.send({R"({"do":"stop_recording","id":1})"});
  const Json answer = viewer.answer();
  EXPECT_EQ(answer["type"], "refused");
  EXPECT_THAT(answer.value("reason", ""), HasSubstr("no viewer has started a recording"));
  shown.end();
  EXPECT_THROW(shown.simulation.record(folder_ / "second.h5"), std::logic_error) << "the first one continues";
}

TEST_F(ViewTest, AnswersRequestsAfterARunThatThrew) {
  Simulation simulation = Simulation::from_text(k_one_bot, "w.json", {.threads = 1});
  View view(simulation, View::Options{.rate = 0, .folder = folder_});
  simulation.on_tick([](Simulation& s) {
    if (s.tick() == 3) throw std::runtime_error("third tick");
  });
  Viewer viewer(view.address());
  EXPECT_THROW(view.run(), std::runtime_error);
  // The thread of the server refuses the second text itself. Its answer shows that the first one has arrived.
  viewer.send({R"({"do":"restart","id":1})", "x"});
  EXPECT_EQ(viewer.answer()["type"], "refused");
  simulation.step();
  const Json answer = viewer.answer();
  EXPECT_EQ(answer["id"], 1);
  EXPECT_THAT(answer.value("reason", ""), HasSubstr("the page cannot restart this run"));
}

TEST_F(ViewTest, AProgramThatRemovesItsCallbacksOfOnTickLeavesTheView) {
  Simulation simulation = Simulation::from_text(k_one_bot, "w.json", {.threads = 1});
  const View view(simulation, View::Options{.rate = 0, .folder = folder_});
  simulation.on_tick(nullptr);
  Viewer viewer(view.address());
  viewer.send({R"({"do":"stop_recording","id":1})", "x"});
  EXPECT_EQ(viewer.answer()["type"], "refused") << "the second text, which the server refuses itself";
  simulation.step();
  viewer.send({R"({"do":"disable","robot":"none","id":2})", "x"});
  EXPECT_EQ(viewer.answer()["id"], 1) << "it was answered at the end of the step";
}

TEST_F(ViewTest, ASimulationHasOneView) {
  Simulation simulation = Simulation::from_text(k_one_bot, "w.json", {.threads = 1});
  const View::Options options{.rate = 0, .folder = folder_};
  const auto error_of_view = [&] {
    try {
      const View view(simulation, options);
    } catch (const std::logic_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  {
    const View first(simulation, options);
    EXPECT_THAT(error_of_view(), HasSubstr("already has a view"));
    EXPECT_TRUE(simulation.has_before_tick()) << "the first view works";
  }
  int calls = 0;
  simulation.before_tick([&](Simulation&) { ++calls; });
  EXPECT_THAT(error_of_view(), HasSubstr("another callback of Simulation::before_tick()"));
  simulation.step();
  EXPECT_EQ(calls, 1);
  simulation.before_tick(nullptr);
  EXPECT_EQ(error_of_view(), "");
}

TEST_F(ViewTest, TheSimulationMayBeMovedOrDestroyedFirst) {
  const View::Options options{.rate = 0, .folder = folder_};
  Simulation first = Simulation::from_text(k_one_bot, "w.json", {.threads = 1});
  {
    const View view(first, options);
    Simulation second = std::move(first);
    second.step();
    EXPECT_EQ(second.tick(), 1u);
    first = std::move(second);
  }
  EXPECT_FALSE(first.has_before_tick());
  first.step();
  std::optional<Simulation> short_lived(Simulation::from_text(k_one_bot, "w.json", {.threads = 1}));
  const View view(*short_lived, options);
  short_lived.reset();
}

TEST_F(ViewTest, ASessionHasTheSeedOfAResetBeforeTheFirstStep) {
  Simulation simulation = Simulation::from_text(k_one_bot, "w.json", {.threads = 1});
  const View view(simulation, View::Options{.rate = 0, .folder = folder_});
  simulation.reset(9);
  simulation.step();
  const std::string session = content(view.session());
  const Json header = Json::parse(session.substr(0, session.find('\n')));
  EXPECT_EQ(header["options"]["seed"], "9") << header;
}

TEST_F(ViewTest, ASessionAfterAResetIsRepeatedInAWorldThatChangesAtZeroSeconds) {
  constexpr const char* k_changing = R"({"troupe": 1, "bounds_m": [[-9, -9], [9, 9]],
    "types": {"bot": {"size_m": [0.4, 0.3, 0.2], "drive": {"kind": "diff"}}},
    "models": [{"name": "a", "type": "bot"}], "at": [{"time_s": 0, "disable": {"type": "bot"}}]})";
  const auto world = [&] {
    return Simulation::from_text(k_changing, "w.json", {.threads = 1, .mortal = true});
  };
  std::filesystem::path first;
  std::filesystem::path second;
  {
    Simulation simulation = world();
    const View view(simulation, View::Options{.rate = 0, .folder = folder_});
    first = view.session();
    simulation.run_for(0.3);
    simulation.reset();
    simulation.step();
    second = view.session();
    simulation.step();
    simulation.reset();  // without a step: the destructor of the view ends the session at tick 2
  }
  EXPECT_NE(first, second);
  for (const auto& [session, end] : {std::pair(first, 3u), std::pair(second, 2u)}) {
    Simulation again = world();
    const SessionReplay replay(session, again);  // throws if the state hashes differ
    EXPECT_EQ(replay.end_tick(), end) << session;
  }
}

TEST_F(ViewTest, ASessionEndsAfterTheLastStepThatBegan) {
  const auto end_after = [this](auto&& use) {
    const auto world = [] {
      return Simulation::from_text(k_one_bot, "w.json", {.threads = 1, .mortal = true});
    };
    Simulation simulation = world();
    std::filesystem::path session;
    {
      const View view(simulation, View::Options{.rate = 0, .folder = folder_});
      session = view.session();
      use(simulation);
    }
    Simulation again = world();
    return SessionReplay(session, again).end_tick();
  };
  EXPECT_EQ(end_after([](Simulation&) {}), 0u);
  EXPECT_EQ(end_after([](Simulation& simulation) { simulation.step(); }), 1u);
  EXPECT_EQ(end_after([](Simulation& simulation) {
              simulation.step();
              simulation.reset();
            }),
            1u);
  EXPECT_EQ(end_after([](Simulation& simulation) {
              simulation.on_phase([](std::optional<Phase>) { throw std::runtime_error("phase"); });
              EXPECT_THROW(simulation.step(), std::runtime_error);
            }),
            1u);
}

TEST_F(ViewTest, ParametersOfAWorldInLatin1AreShown) {
  Simulation simulation = Simulation::from_text(
      "position ( name \"a\" size [0.4 0.3 0.2] drive \"diff\"\n"
      "  ranger ( name \"\xff\" sensor ( range [0 2] fov 90 samples 3 ) ) )\n",
      "w.world", {.threads = 1});
  const std::string type = simulation.world().spec().type(simulation.find("a").id()).name;
  const View view(simulation, View::Options{.rate = 0, .folder = folder_});
  Viewer viewer(view.address());
  viewer.send({R"({"do":"parameters","id":1,"type":")" + type + "\"}", "x"});
  EXPECT_EQ(viewer.answer()["type"], "refused") << "the second text, which the server refuses itself";
  simulation.step();
  const Json answer = viewer.answer();
  EXPECT_EQ(answer["id"], 1) << answer;
  EXPECT_THAT(answer.dump(), HasSubstr("\"\u00ff\""));
}

TEST_F(ViewTest, AnotherViewerCannotDriveARobotByAnotherNameOfIt) {
  Simulation simulation = Simulation::from_text("position ( name \"r\" size [0.4 0.3 0.2] drive \"diff\" )\n",
                                                "w.world", {.threads = 1});
  ASSERT_EQ(simulation.find("position:0").id(), simulation.find("r").id());
  const View view(simulation, View::Options{.rate = 0, .folder = folder_});
  Viewer first(view.address());
  Viewer second(view.address());
  const auto answer_to = [&](Viewer& viewer, const std::string& request) {
    viewer.send({request, "x"});
    EXPECT_EQ(viewer.answer()["type"], "refused") << "the second text, which the server refuses itself";
    simulation.step();
    return viewer.answer();
  };
  EXPECT_EQ(answer_to(first, R"({"do":"hold","robot":"r","speed":[1,0,0],"id":1})")["type"], "done");
  for (const std::string name : {"r", "position:0"})
    for (const std::string act : {R"("hold","speed":[0,0,1])", R"("release")"}) {
      const Json answer = answer_to(second, R"({"id":2,"robot":")" + name + R"(","do":)" + act + "}");
      EXPECT_THAT(answer.value("reason", ""), HasSubstr("another viewer drives")) << name << act;
    }
  EXPECT_EQ(answer_to(first, R"({"do":"release","robot":"position:0","id":1})")["type"], "done");
}

TEST_F(ViewTest, TheEndOfAViewReleasesTheRobotsThatUsersDrive) {
  Simulation simulation = Simulation::from_text(k_one_bot, "w.json", {.threads = 1, .mortal = true});
  std::filesystem::path session;
  {
    const View view(simulation, View::Options{.rate = 0, .folder = folder_});
    session = view.session();
    Viewer viewer(view.address());
    viewer.send({R"({"do":"hold","robot":"a","speed":[0.5,0,0],"id":1})", "x"});
    EXPECT_EQ(viewer.answer()["type"], "refused") << "the second text, which the server refuses itself";
    simulation.step();
    EXPECT_EQ(viewer.answer()["type"], "done");
  }
  EXPECT_THROW(simulation.act({.kind = Act::Kind::release, .whom = "a"}), ActRefused) << "it is not held";
  const std::string lines = content(session);
  EXPECT_THAT(lines, HasSubstr(R"({"tick":1,"n":2,"do":"release","robot":"a"})"));
  EXPECT_THAT(lines, HasSubstr(R"({"tick":1,"n":3,"do":"end"})"));
}

TEST_F(ViewTest, ARestartWithoutASessionFileLeavesTheRunAsItIs) {
  const std::filesystem::path out = folder_ / "out";
  std::filesystem::create_directory(out);
  Shown shown(out);
  shown.run();
  Viewer viewer(shown.address());
  viewer.send({R"({"do":"step","ticks":3,"id":1})"});
  Json state = viewer.receive();
  while (state["type"] != "state" || state["playing"]) state = viewer.receive();
  std::filesystem::rename(out, folder_ / "moved");
  viewer.send({R"({"do":"restart","id":2})"});
  Json answer = viewer.answer();
  EXPECT_EQ(answer["type"], "refused") << answer;
  EXPECT_THAT(answer.value("reason", ""), HasSubstr("w.session.jsonl: error: cannot be written"));
  viewer.send({R"({"do":"step","id":3})"});
  EXPECT_EQ(viewer.answer()["type"], "done");
  std::filesystem::rename(folder_ / "moved", out);
  viewer.send({R"({"do":"restart","id":4})"});
  EXPECT_EQ(viewer.answer()["type"], "done");
  shown.end();
  EXPECT_EQ(shown.simulation.tick(), 0u);
  const std::string first = content(out / "w.session.jsonl");
  EXPECT_EQ(std::ranges::count(first, '\n'), 2) << first;  // the header and one end
  EXPECT_TRUE(std::filesystem::exists(out / "w.session-2.jsonl"));
}

TEST_F(ViewTest, ARecordingThatCannotBeWrittenEndsWithoutTheRun) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "this build has no HDF5";
  Simulation simulation = Simulation::from_text(k_one_bot, "w.json", {.threads = 1});
  const View view(simulation, View::Options{.rate = 0, .folder = folder_});
  Viewer viewer(view.address());
  viewer.send({R"({"do":"record","id":7})", "x"});
  EXPECT_EQ(viewer.answer()["type"], "refused") << "the second text, which the server refuses itself";
  simulation.step();
  Json answer = viewer.answer();
  ASSERT_EQ(answer["type"], "done") << answer;
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit less{std::filesystem::file_size(folder_ / "w.recording.h5"), before.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &less);
  EXPECT_NO_THROW(simulation.run_for(100));
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(simulation.tick(), 1001u);
  answer = viewer.answer();
  EXPECT_EQ(answer["type"], "refused") << answer;
  EXPECT_EQ(answer["id"], 7);
  EXPECT_THAT(answer.value("reason", ""), HasSubstr("the recording ends, because it cannot be written"));
}

TEST_F(ViewTest, DeletedFilesDoNotCountAndLinksAreNotFollowed) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "this build has no HDF5";
  Simulation simulation = Simulation::from_text(k_one_bot, "w.json", {.threads = 1});
  const View view(simulation, View::Options{.rate = 0, .folder = folder_});
  Viewer viewer(view.address());
  const auto answer_to = [&](const std::string& request) {
    viewer.send({request, "x"});
    EXPECT_EQ(viewer.answer()["type"], "refused") << "the second text, which the server refuses itself";
    simulation.step();
    return viewer.answer();
  };
  EXPECT_EQ(answer_to(R"({"do":"record","id":1})")["file"], "w.recording.h5");
  std::filesystem::remove(folder_ / "w.recording.h5");
  EXPECT_EQ(answer_to(R"({"do":"stop_recording","id":2})")["type"], "done");
  std::filesystem::create_symlink(folder_ / "target", folder_ / "w.checkpoint.h5");
  const Json saved = answer_to(R"({"do":"checkpoint","id":3})");
  EXPECT_EQ(saved["type"], "done") << saved;
  EXPECT_EQ(saved.value("file", ""), "w.checkpoint-2.h5");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "target"));
}

TEST_F(ViewTest, ReadOnlyViewersDoNotFillTheQueue) {
  Simulation simulation = Simulation::from_text(k_one_bot, "w.json", {.threads = 1});
  const View view(simulation, View::Options{.rate = 0, .folder = folder_});
  Viewer looker(view.look_address());
  for (int i = 0; i < 257; ++i)
    looker.send({R"({"do":"inspect","robot":"a","id":)" + std::to_string(i) + "}"});
  const Json refused = looker.answer();  // the simulation has not answered any message yet
  EXPECT_EQ(refused["id"], 256) << refused;
  EXPECT_THAT(refused.value("reason", ""), HasSubstr("too many messages are waiting"));
  Viewer viewer(view.address());
  viewer.send({R"({"do":"disable","robot":"a","id":1})", R"({"do":"rate","rate":0,"id":2})", "x"});
  EXPECT_FALSE(viewer.answer().contains("id")) << "the third text, which the server refuses itself";
  simulation.step();
  for (int id = 1; id <= 2; ++id) EXPECT_EQ(viewer.answer()["id"], id);
}

TEST_F(ViewTest, TheRateIsChecked) {
  Simulation simulation = Simulation::from_text(k_one_bot, "w.json", {.threads = 1});
  for (const double rate : {-1.0, std::numeric_limits<double>::quiet_NaN(), 1e-300, 1e-4, 1e7,
                            std::numeric_limits<double>::infinity()})
    EXPECT_THAT([&] { const View view(simulation, View::Options{.rate = rate, .folder = folder_}); },
                ::testing::ThrowsMessage<std::invalid_argument>(HasSubstr(
                    "give 0 (as fast as possible), or a multiple of real time from 0.001 to 1000000")))
        << rate;
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(ViewTest, APausedRunOnRanksIsShown) {
  Simulation simulation = Simulation::from_text(
      R"({"troupe": 1, "bounds_m": [[-40, -9], [40, 9]],
          "types": {"bot": {"size_m": [0.4, 0.3, 0.2], "drive": {"kind": "diff"}}},
          "models": [{"name": "a", "type": "bot", "pose": {"x_m": -30}}, {"name": "b", "type": "bot", "pose": {"x_m": -20}},
                     {"name": "c", "type": "bot", "pose": {"x_m": 20}}, {"name": "d", "type": "bot", "pose": {"x_m": 30}}]})",
      "w.json", {.threads = 1, .ranks = 2, .distribute = true});
  std::atomic<bool> ends = false;
  View view(simulation, View::Options{.rate = 0, .folder = folder_, .is_over = [&] { return ends.load(); }});
  std::thread viewer([&] {
    Viewer client(view.address());
    client.send({R"({"do":"step","ticks":3,"id":1})", R"({"do":"inspect","robot":"d","id":2})"});
    Json state = client.receive();
    while (state["type"] != "state" || state["playing"] || state["tick"] == 0) state = client.receive();
    EXPECT_EQ(state["robots"], 4);
    while (!state.contains("inspected")) state = client.receive();
    EXPECT_EQ(state["inspected"]["pose"][0], 30);
    ends = true;
  });
  EXPECT_NO_THROW(view.run());
  viewer.join();
}

}  // namespace
}  // namespace troupe::live::view_test
