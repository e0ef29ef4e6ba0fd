#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace troupe {
class Simulation;
}  // namespace troupe

namespace troupe::live {

/// Smallest speed that a viewer (see View) may request, in multiples of real time. The request 0 is also
/// allowed, and means as fast as possible.
inline constexpr double k_least_rate = 0.001;
inline constexpr double k_most_rate = 1e6;  ///< largest speed that a viewer may request
/// Whether a limit of the speed is valid: 0, or a number from k_least_rate to k_most_rate.
constexpr bool is_rate(double rate) { return rate == 0 || (rate >= k_least_rate && rate <= k_most_rate); }

/// Shows a running simulation in browsers, where users can pause it, change it and drive its robots
/// (docs/live.md). A web page or program that is connected to the view is called a viewer. The view writes
/// the actions of the users to a file, the session file. Example:
///
///     troupe::Simulation simulation("cave.world", {.mortal = true});  // lets users remove robots
///     troupe::live::View view(simulation);
///     std::cout << view.address() << '\n';
///     view.run();
///
/// Instead of calling run(), the program can step the simulation itself, for example with Simulation::step().
/// Each step then applies the commands of the users before it moves the robots. A step also waits while a
/// user has paused the run, and it waits as long as the speed limit (Options::rate) requires. It does not
/// wait for browsers to draw pictures.
///
/// The view uses the callbacks of Simulation::before_step() and Simulation::before_tick(), and the destructor
/// of the view removes them. A simulation therefore has at most one view at a time, and no other such
/// callbacks meanwhile: a callback that the program sets replaces that of the view, which then no longer has
/// an effect. The view also adds a callback of Simulation::on_tick(), which ends with the view.
///
/// The program may move or destroy the Simulation object meanwhile: the view keeps the simulation alive. Not
/// thread-safe: use a view only on the thread that steps the simulation. The view serves the page on a thread
/// of its own.
class View {
 public:
  /// Options of a view. All have a default.
  struct Options {
    std::uint16_t port = 0;  ///< TCP port; 0: any free port
    /// IP address on which the server of the page listens. Empty: 127.0.0.1 and, if the machine has it, ::1,
    /// so that only programs on this machine can reach the page. If the address is not a loopback address,
    /// other machines can also reach the page, and their connections are not encrypted.
    std::string bind = {};
    std::vector<std::string> hosts = {};  ///< host names of proxies through which browsers reach the page
    /// Greatest speed of the run, in multiples of real time; 0: no limit. During the run, viewers with full
    /// control can change this limit. If it is not 0, it must be from k_least_rate to k_most_rate.
    double rate = 1;
    /// Folder for the files that the view writes: the session file, and the recordings and checkpoints that
    /// viewers request. The folder must exist. Empty: the current folder.
    std::filesystem::path folder = {};
    /// Returns true if the run must end: run() then returns. Also, a step of the simulation that waits in the
    /// view then stops waiting, and is computed even if the run is paused. The view calls the function on the
    /// thread that steps the simulation; while it waits, at least every 50 ms. Null: the run does not end for
    /// this reason.
    std::function<bool()> is_over;
    /// Called with one line of text when run() ends, with command(); when the server refuses something, such
    /// as a request with a wrong token; and when a recording that a viewer has started ends because it cannot
    /// be written, or because the files that viewers requested have reached 10 GB. The same refusal is
    /// reported only once. May be called on the thread of the server. Null: the texts are dropped.
    std::function<void(const std::string&)> report;
  };
  /// Starts the server and creates the session file. Throws std::runtime_error if Options::bind is not an IP
  /// address, if the address or the port is not available, or if the session file cannot be written. Throws
  /// std::invalid_argument if is_rate(Options::rate) is false, or if an entry of Options::hosts is not a
  /// host name. If the CMake option TROUPE_VIEW is off, always throws std::runtime_error. Throws
  /// std::logic_error if the simulation already has a view or another callback of Simulation::before_tick().
  View(Simulation& simulation, const Options& options);
  explicit View(Simulation& simulation);  ///< the same as View(simulation, Options())
  /// Completes the session file and disconnects all viewers.
  ~View();
  View(const View&) = delete;
  View& operator=(const View&) = delete;

  /// URL of the page for full control: `http://HOST:PORT/#TOKEN`. TOKEN is a secret text, which each view
  /// makes at random.
  std::string address() const;
  /// URL of the page for read-only access. It differs from address() only in the token.
  std::string look_address() const;
  /// Path of the current session file. The view begins a new file when a viewer restarts the run, and in the
  /// first step after the program has reset the simulation (unless no step was made before a reset to the
  /// same seed).
  std::filesystem::path session() const;
  /// The shell command that repeats the current session: `troupe run cave.world --session
  /// cave.session.jsonl`. Empty if a program built the world, because no command can load it.
  std::string command() const;

  /// Steps the simulation, and pauses and changes it as the viewers command. First waits until a viewer with
  /// full control has connected. Returns when Options::is_over returns true, or when a stop condition of the
  /// world file (key `stop_when`) holds.
  ///
  /// Throws the exceptions of Simulation::step(), and std::runtime_error if the session file cannot be
  /// written.
  void run();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe::live
