#pragma once

#include "engine/kinds/act.hpp"
#include "live/picture.hpp"
#include "live/server.hpp"
#include "live/view.hpp"
#include "live/watched.hpp"
#include "troupe/measures.hpp"
#include "troupe/session.hpp"
#include "troupe/simulation.hpp"

#include <nlohmann/json.hpp>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::live {

class Request;

/// The implementation of View (live/view.hpp): executes the commands of viewers, which are the pages and
/// programs that are connected to the view. docs/live.md describes the protocol.
class View::Impl : private ViewBackend {
 public:
  Impl(Simulation& simulation, const Options& options);
  ~Impl() override;
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  std::string address() const { return address_of(token_); }
  std::string look_address() const { return address_of(look_token_); }
  const std::filesystem::path& session() const { return session_->file(); }
  void run();

 private:
  using Clock = std::chrono::steady_clock;
  struct Message {
    std::uint64_t client;
    std::string text;
  };
  struct Client {
    bool may_steer = false;
    std::optional<BodyId> inspected;
    std::string plotted;                 // the plotted measure; empty: none
    std::uint64_t plot_request = 0;      // id of the request to plot it
    std::unique_ptr<Measures> measures;  // computes `plotted`
    std::optional<ColorValue> color;     // the value by which it colours robots
    std::vector<std::string> layers;     // the layers of lines that it shows
  };
  // Work that a viewer requested and that is done between two ticks.
  struct Job {
    enum class What : std::uint8_t { restart, checkpoint, record, stop_recording };
    What what = What::restart;
    std::uint64_t client = 0;
    std::uint64_t id = 0;               // id of the request, for the answer
    std::optional<std::uint64_t> seed;  // for `restart`; not set: the same seed
  };

  // Called on the server's thread.
  std::string opened(std::uint64_t client, bool may_steer) override;
  void received(std::uint64_t client, bool may_steer, std::string_view text) override;
  void closed(std::uint64_t client) override;
  std::optional<ViewFrames> picture(std::uint64_t client) override;
  void refused(const std::string& what) override;

  // Called on the simulation's thread.
  std::string address_of(const std::string& token) const;
  void before_tick();
  void wait();
  void after_tick();
  bool take_messages();
  bool obey(const Message& message);
  bool obey_question(const Request& request, std::uint64_t client);
  bool obey_clock(const Request& request);
  bool obey_watch(const Request& request, Client& client);
  void use_plot(std::uint64_t id, Client& client, const std::function<void(Measures&)>& use);
  bool postpone(const Request& request, std::uint64_t client);
  void restart_clock();
  void play(std::uint64_t ticks);
  void carry_out(std::uint64_t client, const engine::Act& act);
  void release_all(std::uint64_t client);
  void answer(std::uint64_t client, std::uint64_t id,
              const nlohmann::ordered_json& members = nlohmann::ordered_json::object());
  void refuse(std::uint64_t client, std::optional<std::uint64_t> id, const std::string& reason);
  void do_jobs();
  std::string do_job(const Job& job);
  void check_restart() const;
  void restart(std::optional<std::uint64_t> seed);
  void begin_run(std::uint64_t end);
  bool is_over() const { return is_over_ && is_over_(); }
  std::string save_checkpoint();
  std::string start_recording();
  void stop_recording();
  void limit_recording();
  std::filesystem::path new_file(std::string_view what) const;
  void greet_again();
  void publish();
  nlohmann::ordered_json state() const;
  nlohmann::ordered_json own_state(std::uint64_t id, Client& client);
  std::string make_greeting(const std::string& header) const;

  Simulation& simulation_;
  std::function<bool()> is_over_;
  std::function<void(const std::string&)> report_;
  std::string token_;
  std::string look_token_;
  std::vector<std::uint32_t> order_;   // ids of the robots of the page
  std::vector<std::uint32_t> places_;  // by id: index in order_, or order_.size()
  std::vector<worldio::ShownPart> shown_parts_;
  bool has_colors_ = false;
  std::filesystem::path folder_;
  std::unique_ptr<SessionLog> session_;

  // Used only by the simulation's thread.
  std::map<std::uint64_t, Client> clients_;
  std::map<std::string, std::uint64_t> holders_;  // name of a robot that a viewer drives -> that client
  bool playing_ = false;
  bool has_begun_ = false;
  bool is_running_ = false;  // true: run() steps the simulation; false: the program does
  // True while run() waits between two ticks: the state is then that of the end of a tick, so that jobs can
  // be done at once. In before_tick(), the changes that the world schedules are already part of the state.
  bool is_between_ticks_ = false;
  std::uint64_t next_tick_ = 0;  // tick of the next step, unless the program resets the simulation
  std::uint64_t steps_ = 0;      // ticks until the next pause; 0: no pause
  double rate_ = 1;
  std::string line_;  // line of the hash log for the tick at which the world is paused
  bool is_changed_ = true;
  Clock::time_point due_;        // when the next tick is due
  Clock::time_point published_;  // when the last picture was published
  Clock::time_point measured_;   // when the speed was last measured
  double measured_s_ = 0;        // world time at measured_
  double reached_ = 0;           // current speed, times real time
  std::uint64_t pictures_ = 0;
  std::uint64_t seed_ = 0;           // of this run
  std::uint64_t runs_ = 1;           // 1, and 1 more after each restart
  std::vector<Job> jobs_;            // work to do when the current tick has ended
  std::filesystem::path recording_;  // file of the recording that a viewer started; empty: none
  std::uintmax_t file_bytes_ = 0;    // size of all finished files that viewers requested

  // Shared by both threads, guarded by mutex_.
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::vector<Message> messages_;
  std::map<std::uint64_t, bool> arrived_;        // new clients and whether they may steer
  std::vector<std::uint64_t> gone_;              // clients that have disconnected
  std::vector<std::shared_ptr<Picture>> spare_;  // all pictures; those without another owner can be filled
  std::shared_ptr<const Picture> newest_;
  std::string greeting_;  // JSON members of the first text to a client

  // Used only by the server's thread.
  std::map<std::uint64_t, SentPicture> sent_;
  std::set<std::string> told_;  // refusals that have been reported, so that each is reported once

  std::shared_ptr<Impl*> self_;         // expires with this object, for the callback of on_tick()
  std::unique_ptr<ViewServer> server_;  // last, because its thread uses the members above
};

}  // namespace troupe::live
