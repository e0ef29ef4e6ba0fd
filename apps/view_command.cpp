#include "apps/view_command.hpp"

#include "apps/interrupt.hpp"
#include "apps/messages.hpp"
#include "base/diagnostics.hpp"
#include "base/number_text.hpp"
#include "engine/spec/ticks.hpp"
#include "live/host_name.hpp"
#include "live/view.hpp"
#include "worldio/results/checkpoint.hpp"

#include <CLI/CLI.hpp>
#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>

namespace troupe::apps {
namespace fs = std::filesystem;
namespace {

constexpr const char* k_view_footer = R"(
Shows the world in a browser. The program prints the address of a web page, which it serves itself. In the page, a user
can play, pause, single-step and restart the world, can select, inspect, drag, turn, drive, disable, remove and add
robots, can change parameters, and can request checkpoints and recordings. The run begins when a browser first opens the
page, at --rate times real time, and ends with Ctrl-C, at the time of --for, or when a condition in the stop_when of
the world is met.

The first address contains a token that grants full control; the second address is read-only. To view a world that runs
on another machine (HOST), run ssh -L 8000:127.0.0.1:PORT HOST and open http://127.0.0.1:8000/#TOKEN.
With --bind, other machines can open the page directly; the connection is not encrypted, so prefer ssh -L, or a proxy
with TLS (--allow-host).

WORLD may also be a checkpoint (troupe run --checkpoint); the run then continues from it. All actions of the users, such
as moving a robot, are written to the session file WORLD.session.jsonl (if it exists: WORLD.session-2.jsonl, ...). At
its end, the program prints the command that repeats the run with these actions, with the same bits: troupe run WORLD
--session WORLD.session.jsonl, or troupe resume CHECKPOINT --session FILE. See docs/live.md.

Exit codes: 0 ended by --for or the world's stop_when; 1 failed; 2 bad input or usage; 3 ended by Ctrl-C, SIGTERM or
SIGHUP.

Examples:
  troupe view worlds/cave-simple.json
  troupe view c.h5
  troupe view worlds/hospital.json --robots 2000 --rate 5 --port 8000 --out /tmp)";

/// Returns the folder for temporary files. Throws std::runtime_error if it does not exist.
fs::path temporary_folder() {
  std::error_code error;
  fs::path folder = fs::temp_directory_path(error);
  if (!error) return folder;
  const char* name = "TMPDIR";
  for (const char* each : {"TEMPDIR", "TEMP", "TMP", "TMPDIR"})
    if (std::getenv(each) != nullptr) name = each;  // the last of those that are set counts
  const char* value = std::getenv(name);
  throw std::runtime_error(fmt::format(
      "troupe view: error: --open needs a temporary file, but the folder {} cannot be used: {}: set the "
      "environment variable {} to an existing folder",
      value != nullptr ? value : "/tmp", error.message(), name));
}

/// A temporary HTML file, which only this user can read and which redirects a browser to the address of the
/// view. The address contains the token. The address must not be an argument of a command, because all users
/// of this machine can see the arguments of running commands.
class Redirect {
 public:
  explicit Redirect(const std::string& address) {
    constexpr std::string_view k_suffix = ".html";
    std::string name = (temporary_folder() / fmt::format("troupe-view-XXXXXX{}", k_suffix)).string();
    const int descriptor = ::mkostemps(name.data(), k_suffix.size(), O_CLOEXEC);  // mode 0600
    if (descriptor < 0)
      throw std::runtime_error(
          fmt::format("{}: error: this temporary file, which --open needs, cannot be created: {}", name,
                      std::generic_category().message(errno)));
    file_ = name;
    const std::string page =
        fmt::format("<!doctype html><meta http-equiv=\"refresh\" content=\"0; url={}\">\n", address);
    const bool is_whole = ::write(descriptor, page.data(), page.size()) == static_cast<ssize_t>(page.size());
    ::close(descriptor);
    if (is_whole) return;
    remove();
    throw std::runtime_error(fmt::format(
        "{}: error: this temporary file, which --open needs, cannot be written: the disk may be full", name));
  }
  ~Redirect() { remove(); }
  Redirect(const Redirect&) = delete;
  Redirect& operator=(const Redirect&) = delete;

  /// Opens the page with xdg-open; prints a warning if xdg-open is not installed.
  void open() const {
    std::string program = "xdg-open";
    std::string file = file_.string();
    char* const words[] = {program.data(), file.data(), nullptr};
    // In a session of its own, because Ctrl-C would otherwise also end a browser that xdg-open has started.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    // This program ignores these signals. The browser and the programs that it starts must not inherit this.
    sigset_t defaults{};
    sigemptyset(&defaults);
    for (const int signal : {SIGPIPE, SIGXFSZ}) sigaddset(&defaults, signal);
    posix_spawnattr_setsigdefault(&attributes, &defaults);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGDEF);
    pid_t child = 0;
    const int error = posix_spawnp(&child, "xdg-open", nullptr, &attributes, words, environ);
    posix_spawnattr_destroy(&attributes);
    if (error != 0) {
      print_message("troupe view: warning: xdg-open was not found: open the printed address in a browser\n");
      return;
    }
    try {
      std::thread([child] {
        int ignored = 0;
        waitpid(child, &ignored, 0);
      }).detach();
    } catch (const std::system_error&) {  // ignored: xdg-open remains as a zombie process until the view ends
    }
  }

 private:
  void remove() const {
    std::error_code ignored;
    fs::remove(file_, ignored);
  }

  fs::path file_;
};

/// Loads a world, or resumes a checkpoint. In a loaded world, users can remove any robot. In a resumed run,
/// users can remove or add only the bodies that could be removed or added in the run that wrote the
/// checkpoint. Throws InputError if the world or the checkpoint is invalid.
Simulation load(const ViewOptions& options) {
  const SimulationOptions& simulation = options.simulation;
  const bool is_checkpoint = worldio::is_checkpoint(options.world);
  if (is_checkpoint &&
      (simulation.seed || simulation.ranging || !simulation.robots.empty() || simulation.spare > 0))
    throw InputError(
        fmt::format("{}: error: --seed, --raytracer, --robots and --spare are only for world files; a "
                    "checkpoint keeps the values of the run that wrote it: omit these options",
                    options.world.string()));
  if (is_checkpoint) return Simulation::resume(options.world, resume_options(options));
  refuse_across_options(options);
  SimulationOptions given = with_environment(options.simulation);
  given.mortal = true;
  return Simulation(options.world, given);
}

}  // namespace

void add_view_options(CLI::App& view, ViewOptions& options) {
  view.footer(k_view_footer);
  add_world_options(view, options);
  add_across_options(view, options);
  add_threads_option(view, options);
  add_value(view, "--bind", "ADDRESS", "IP address to listen on (default: 127.0.0.1 and ::1; see below)",
            [&options](const std::string& text) {
              in6_addr ignored{};
              if (inet_pton(AF_INET, text.c_str(), &ignored) != 1 &&
                  inet_pton(AF_INET6, text.c_str(), &ignored) != 1)
                refuse("--bind", text, "an IP address, as in --bind 127.0.0.1");
              options.bind = text;
            });
  add_values(view, "--allow-host", "NAME",
             "Host name under which a proxy serves the page to browsers; repeatable",
             [&options](const std::string& text) {
               if (live::host_name(text).empty())
                 refuse("--allow-host", text, "a host name, as in --allow-host example.org");
               options.hosts.push_back(text);
             });
  add_value(view, "--port", "N", "TCP port to listen on (default: 0, any free port)",
            [&options](const std::string& text) {
              const auto port = number_of<std::uint16_t>(text);
              if (!port) refuse("--port", text, "a port from 0 to 65535");
              options.port = *port;
            });
  add_value(view, "--rate", "R", "Limit the speed to R times real time; 0: no limit (default: 1)",
            [&options](const std::string& text) {
              const auto rate = finite_number_of(text);
              if (!rate || !live::is_rate(*rate))
                refuse("--rate", text,
                       fmt::format("0, or a multiple of real time from {} to {}", live::k_least_rate,
                                   live::k_most_rate));
              options.rate = *rate;
            });
  add_value(view, "--out", "DIR",
            "Folder for the session file, checkpoints and recordings (default: the working folder)",
            [&options](const std::string& text) { options.folder = file_name("--out", text); });
  add_switch(view, "--open", options.open, "Open the page in the default browser");
}

ExitCode view_world(const ViewOptions& options) {
  std::error_code ignored;
  if (!options.folder.empty() && !fs::is_directory(options.folder, ignored))
    throw InputError(
        fmt::format("{}: error: there is no such folder: create it, or name an existing folder with --out",
                    options.folder.string()));
  Simulation simulation = load(options);
  if (options.for_s) check_end(options, simulation, *options.for_s);
  print_lines(simulation.warnings());
  stop_on_signals("troupe view: ending");
  const std::uint64_t end_tick = options.for_s ? engine::ticks_until(*options.for_s, simulation.tick_s())
                                               : std::numeric_limits<std::uint64_t>::max();
  const auto is_over = [&] { return stop_requested() || simulation.tick() >= end_tick; };
  live::View view(simulation, {.port = options.port,
                               .bind = options.bind,
                               .hosts = options.hosts,
                               .rate = options.rate,
                               .folder = options.folder,
                               .is_over = is_over,
                               .report = [](const std::string& text) {
                                 print_message(fmt::format("troupe view: {}\n", text));
                               }});
  print("{}\n  view          {}\n  read-only     {}\n  session       {}\n", simulation.title(),
        view.address(), view.look_address(), view.session().string());
  std::fflush(stdout);
  std::optional<Redirect> redirect;
  if (options.open) redirect.emplace(view.address()).open();
  view.run();
  fmt::print("{}\n",
             simulation.hash_log_line());  // of the last tick; repeating the session prints the same line
  return stop_requested() ? k_stopped : k_finished;
}

}  // namespace troupe::apps
