#pragma once

#include "engine/kinds/act.hpp"
#include "live/connections.hpp"
#include "live/run_clock.hpp"
#include "live/selection.hpp"
#include "live/view.hpp"
#include "live/viewer_files.hpp"
#include "troupe/session.hpp"
#include "troupe/simulation.hpp"
#include "worldio/results/replay_header.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace troupe::live {

class Request;

/// The implementation of View (live/view.hpp): executes the commands of viewers, which are the pages and
/// programs that are connected to the view. docs/live-protocol.md describes the protocol. All functions are
/// called on the thread of the simulation.
class View::Impl {
 public:
  Impl(Simulation& simulation, const Options& options);
  ~Impl();
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  std::string address() const { return connections_->address(); }
  std::string look_address() const { return connections_->look_address(); }
  const std::filesystem::path& session() const { return session_->file(); }
  std::string command() const { return simulation_.command(session_->file()); }
  void run();

 private:
  using Clock = RunClock::Clock;
  struct Client {
    bool may_steer = false;
    Selection selection;
  };
  // A viewer that drives a robot.
  struct Holder {
    std::uint64_t client = 0;
    std::string robot;  // one of the names of the robot
  };
  // Work that a viewer requested and that is done between two ticks.
  struct Job {
    enum class What : std::uint8_t { restart, checkpoint, record, stop_recording };
    What what = What::restart;
    std::uint64_t client = 0;
    std::uint64_t id = 0;               // id of the request, for the answer
    std::optional<std::uint64_t> seed;  // for `restart`; not set: the same seed
  };

  void before_step();
  void before_tick();
  void wait();
  void after_tick();
  bool take_messages();
  bool obey(const Connections::Message& message);
  bool obey_question(const Request& request, std::uint64_t client);
  bool postpone(const Request& request, std::uint64_t client);
  Selection::Refuse refuser(std::uint64_t client);
  void carry_out(std::uint64_t client, const engine::Act& act);
  void log(const engine::Act& act);
  void release_all(std::uint64_t client);
  void do_jobs();
  std::string do_job(const Job& job);
  void check_restart() const;
  void restart(std::optional<std::uint64_t> seed);
  void begin_run(std::uint64_t end, std::unique_ptr<SessionLog> next);
  bool is_over() const { return is_over_ && is_over_(); }
  void greet_again();
  void publish();
  nlohmann::ordered_json state() const;
  std::string make_greeting(const std::string& header) const;

  Simulation simulation_;
  std::function<bool()> is_over_;
  RunClock clock_;
  std::function<void(const std::string&)> report_;  // may be null
  ViewerFiles files_;
  std::vector<std::uint32_t> order_;   // ids of the robots of the page
  std::vector<std::uint32_t> places_;  // by id: index in order_, or order_.size()
  std::vector<worldio::ShownPart> shown_parts_;
  bool has_colors_ = false;
  std::unique_ptr<SessionLog> session_;
  std::map<std::uint64_t, Client> clients_;
  std::map<std::uint32_t, Holder> holders_;  // by id: the robots that viewers drive
  bool has_begun_ = false;
  bool is_running_ = false;  // true: run() steps the simulation; false: the program does
  // True while run() waits between two ticks: the state is then that of the end of a tick, so that jobs can
  // be done at once. In before_tick(), the changes that the world schedules are already part of the state.
  bool is_between_ticks_ = false;
  std::uint64_t next_tick_ = 0;  // tick of the next step, unless the program resets the simulation
  std::string line_;             // line of the hash log for the tick at which the world is paused
  bool is_changed_ = true;
  Clock::time_point published_;  // when the last picture was published
  std::uint64_t pictures_ = 0;
  std::uint64_t seed_ = 0;  // of this run
  std::uint64_t runs_ = 1;  // 1, and 1 more after each restart
  std::vector<Job> jobs_;   // work to do when the current tick has ended
  // Owns the callback of on_tick(), which therefore ends with this object.
  std::shared_ptr<const void> alive_ = std::make_shared<bool>();
  std::unique_ptr<Connections> connections_;
};

}  // namespace troupe::live
