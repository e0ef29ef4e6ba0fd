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

/// Shows a simulation to browsers, and does what they ask for. The simulation's thread calls run(); it never
/// waits for a viewer. docs/live.md has the protocol.
class View : private ViewBackend {
 public:
  struct Options {
    std::uint16_t port = 0;        ///< 0: any that is free
    double rate = 1;               ///< times real time, at most; 0: as fast as it can
    std::filesystem::path folder;  ///< where the session is written
  };
  /// Listens, and begins a session. Throws std::runtime_error. `is_over` ends run().
  View(Simulation& simulation, const Options& options, std::function<bool()> is_over);
  ~View() override;

  /// `http://127.0.0.1:PORT/#TOKEN`, and the one for looking only.
  std::string address() const { return address_of(token_); }
  std::string look_address() const { return address_of(look_token_); }
  const std::filesystem::path& session() const { return session_.file(); }

  /// Steps the simulation as viewers ask for, from the first that may steer on, until `is_over`, or the
  /// world's own end. Throws as Simulation::step() does, and std::runtime_error where the session cannot be
  /// written.
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
    std::string plotted;                 // a measure; empty: none
    std::unique_ptr<Measures> measures;  // of that
  };

  // On the server's thread.
  std::string opened(std::uint64_t client, bool may_steer) override;
  void received(std::uint64_t client, bool may_steer, std::string_view text) override;
  void closed(std::uint64_t client) override;
  std::optional<ViewFrames> picture(std::uint64_t client) override;
  void refused(const std::string& what) override;

  // On the simulation's.
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
  std::vector<std::uint32_t> order_;  // robots of the page
  bool has_z_ = false;
  bool has_colors_ = false;
  std::string greeting_;  // members of the first text
  SessionLog session_;

  // Of the simulation's thread.
  std::map<std::uint64_t, Client> clients_;
  std::map<std::string, std::uint64_t> holders_;  // robot -> client
  bool playing_ = false;
  bool has_begun_ = false;
  std::uint64_t steps_ = 0;  // until it pauses; 0: it does not
  double rate_ = 1;
  std::string line_;  // of the hash log, of the tick at which it paused
  bool is_changed_ = true;
  Clock::time_point due_;        // of the next tick
  Clock::time_point published_;  // the last picture
  Clock::time_point measured_;
  double measured_s_ = 0;  // world time at measured_
  double reached_ = 0;     // times real time
  std::uint64_t pictures_ = 0;

  // Between the two.
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::vector<Message> messages_;
  std::map<std::uint64_t, bool> arrived_;  // clients that opened: whether they may steer
  std::vector<std::uint64_t> gone_;
  std::vector<std::shared_ptr<Picture>> spare_;
  std::shared_ptr<const Picture> newest_;

  // Of the server's thread.
  struct Known {
    std::uint64_t number = 0;
    std::vector<std::int32_t> poses;
    std::vector<std::uint8_t> colors;
  };
  std::map<std::uint64_t, Known> known_;
  std::set<std::string> told_;

  std::unique_ptr<ViewServer> server_;  // last: its thread uses all of the above
};

}  // namespace troupe::apps
