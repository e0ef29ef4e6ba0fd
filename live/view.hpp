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

/// Smallest speed that a viewer may request, in multiples of real time. A viewer may also request 0, which
/// means as fast as possible.
inline constexpr double k_least_rate = 0.001;
inline constexpr double k_most_rate = 1e6;  ///< largest speed that a viewer may request

/// Shows a running simulation in browsers, where users can pause it, change it and drive its robots
/// (docs/live.md). A page or program that has connected to the view is called a viewer. The view writes the
/// actions of the users to a session file. Example:
///
///     troupe::Simulation simulation("cave.world", {.mortal = true});  // lets users remove robots
///     troupe::live::View view(simulation);
///     std::cout << view.address() << '\n';
///     view.run();
///
/// Instead of calling run(), the program can step the simulation itself. Each step then waits while a user
/// has paused the run, waits as long as the limit of the speed (Options::rate) requires, and applies the
/// commands of the users. The simulation never waits until a browser has drawn a picture.
///
/// The view replaces the callback that the program has set with Simulation::before_tick() (called in each
/// time step, before robots sense and move), and the destructor of the view removes the callback. The
/// simulation must outlive the view. Not thread-safe: use a view on the thread that steps the simulation. The
/// view serves the page on a thread of its own.
class View {
 public:
  /// Options of a view. All have a default.
  struct Options {
    std::uint16_t port = 0;  ///< TCP port; 0: any free port
    /// IP address on which the server listens. Empty: 127.0.0.1, and ::1 if the machine has it; other
    /// machines cannot reach these two. With any other address, other machines can reach the page, and the
    /// connection is not encrypted.
    std::string bind;
    std::vector<std::string> hosts;  ///< names of proxies through which browsers reach the page
    /// Limit of the speed at the start, in multiples of real time; 0: no limit. Viewers with full control can
    /// change it.
    double rate = 1;
    /// Folder for the session file, and for the recordings and checkpoints that viewers request. It must
    /// exist; empty: the current folder.
    std::filesystem::path folder;
    /// A function by which the program ends run(): run() returns once the function returns true. A step that
    /// waits because the run is paused then also stops waiting. The function is called at least every 50 ms
    /// while the view waits, on the thread that steps. Null: the same as a function that returns false.
    std::function<bool()> is_over;
    /// Called with one line of text when the server refuses a request or a message (once for each reason),
    /// and when a recording ends early. May be called on the thread of the server. Null: such texts are
    /// dropped.
    std::function<void(const std::string&)> report;
  };
  /// Starts the server and creates the session file, which stores the actions of the users. Throws
  /// std::runtime_error if Options::bind is not an IP address, if the address or the port is not available,
  /// if the file cannot be written, and in builds without TROUPE_VIEW.
  View(Simulation& simulation, const Options& options);
  explicit View(Simulation& simulation);  ///< the same as View(simulation, Options())
  /// Ends the session and disconnects all viewers.
  ~View();
  View(const View&) = delete;
  View& operator=(const View&) = delete;

  /// The address of the page for full control: `http://HOST:PORT/#TOKEN`.
  std::string address() const;
  /// The address of the page for read-only access: the same page, with another token.
  std::string look_address() const;
  /// Path of the current session file. A new file begins when a viewer restarts the run, and at the first
  /// step after the program has reset the simulation.
  std::filesystem::path session() const;

  /// Waits for the first viewer with full control, and then steps, pauses and changes the simulation as
  /// viewers command, until Options::is_over returns true or a condition of the world's `stop_when` holds.
  /// Throws as Simulation::step() does, and std::runtime_error if the session cannot be written.
  void run();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe::live
