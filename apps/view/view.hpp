#pragma once

#include "apps/view/picture.hpp"
#include "apps/view/server.hpp"
#include "engine/act.hpp"
#include "troupe/measures.hpp"
#include "troupe/session.hpp"
#include "troupe/simulation.hpp"

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

namespace troupe::apps {

/// Smallest and largest speed that a viewer may request, in multiples of real time. A viewer may also request
/// 0, which means as fast as possible.
inline constexpr double k_least_rate = 0.001;
inline constexpr double k_most_rate = 1e6;

/// Shows a simulation in browsers and executes the commands that viewers (pages or programs that have
/// connected) send. run() steps the simulation on the calling thread and never waits for a viewer.
/// docs/live.md describes the protocol.
class View : private ViewBackend {
 public:
  struct Options {
    std::uint16_t port = 0;        ///< 0: any free port
    double rate = 1;               ///< limit of the speed, times real time; 0: no limit
    std::filesystem::path folder;  ///< folder for the session file
  };
  /// Starts the server and creates the session file. run() ends when `is_over` returns true. Throws
  /// std::runtime_error if the port is not available or the file cannot be written.
  View(Simulation& simulation, const Options& options, std::function<bool()> is_over);
  ~View() override;

  /// The address of the page for full control: `http://127.0.0.1:PORT/#TOKEN`.
  std::string address() const { return address_of(token_); }
  /// The address of the page for read-only access, which has another token.
  std::string look_address() const { return address_of(look_token_); }
  /// Path of the session file.
  const std::filesystem::path& session() const { return session_.file(); }

  /// Waits for the first viewer that may steer, and then steps, pauses and changes the simulation as viewers
  /// command, until `is_over` returns true or a condition of the world's `stop_when` holds. Throws as
  /// Simulation::step() does, and std::runtime_error if the session cannot be written.
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
    std::unique_ptr<Measures> measures;  // computes `plotted`
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
  void after_tick();
  void take_messages();
  void obey(const Message& message);
  void carry_out(std::uint64_t client, const engine::Act& act);
  void release_all(std::uint64_t client);
  void answer(std::uint64_t client, std::uint64_t id, const std::string& refusal = {});
  void publish();
  std::string state_members() const;
  std::string own_members(Client& client);
  std::string inspection(BodyId id);

  Simulation& simulation_;
  std::function<bool()> is_over_;
  std::string token_;
  std::string look_token_;
  std::vector<std::uint32_t> order_;  // ids of the robots of the page
  bool has_z_ = false;
  bool has_colors_ = false;
  std::string greeting_;  // JSON members of the first text to a client
  SessionLog session_;

  // Used only by the simulation's thread.
  std::map<std::uint64_t, Client> clients_;
  std::map<std::string, std::uint64_t> holders_;  // held robot -> the client that holds it
  bool playing_ = false;
  bool has_begun_ = false;
  std::uint64_t steps_ = 0;  // ticks until the next pause; 0: no pause
  double rate_ = 1;
  std::string line_;  // line of the hash log for the tick at which the world is paused
  bool is_changed_ = true;
  Clock::time_point due_;        // when the next tick is due
  Clock::time_point published_;  // when the last picture was published
  Clock::time_point measured_;
  double measured_s_ = 0;  // world time at measured_
  double reached_ = 0;     // current speed, times real time
  std::uint64_t pictures_ = 0;

  // Shared by both threads, guarded by mutex_.
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::vector<Message> messages_;
  std::map<std::uint64_t, bool> arrived_;  // new clients and whether they may steer
  std::vector<std::uint64_t> gone_;
  std::vector<std::shared_ptr<Picture>> spare_;
  std::shared_ptr<const Picture> newest_;

  // Used only by the server's thread.
  struct Known {
    std::uint64_t number = 0;
    std::vector<std::int32_t> poses;
    std::vector<std::uint8_t> colors;
  };
  std::map<std::uint64_t, Known> known_;
  std::set<std::string> told_;

  std::unique_ptr<ViewServer> server_;  // last, because its thread uses the members above
};

}  // namespace troupe::apps
