#include "apps/messages.hpp"
#include "live/view.hpp"

#include "engine/spec/ticks.hpp"
#include "python/bindings.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace troupe::python {
namespace {

namespace fs = std::filesystem;

/// Name of the attribute of a View that refers to its Simulation, for the callbacks of on_tick(). It is in
/// the object's __dict__ for the reason that k_callbacks explains.
constexpr const char* k_simulation = "_simulation";

/// The live view of a simulation. Python owns the view, which keeps the simulation alive.
class HeldView {
 public:
  HeldView(Holder held, live::View::Options options)
      : held_(std::move(held)), state_(std::make_shared<State>()) {
    options.is_over = [held = held_.get(), state = state_.get()] {
      return state->is_closed || held->use_while_stepping().tick() >= state->end_tick || is_interrupted();
    };
    options.report = [](const std::string& text) { apps::print_message(fmt::format("view: {}\n", text)); };
    state_->view.emplace(held_->use(), options);
    held_->keep_while_stepping(state_);
    held_->use().on_tick(
        [state = state_.get()](Simulation&) {
          if (state->after_tick) state->after_tick();
        },
        state_);
  }
  HeldView(const HeldView&) = delete;
  HeldView& operator=(const HeldView&) = delete;
  ~HeldView() {
    if (state_) state_->is_closed = true;
  }

  std::string address() const { return open()->view->address(); }
  std::string look_address() const { return open()->view->look_address(); }
  fs::path session() const { return open()->view->session(); }
  std::string command() const { return open()->view->command(); }
  /// Implements View.run() in Python. simulation: the Python object, for the callbacks of on_tick().
  void run(const py::object& simulation, const std::optional<double>& for_s) {
    const std::shared_ptr<State> state = open();  // a callback may close the view
    const Simulation& now = held_->use_outside("View.run()");
    if (for_s && !(*for_s >= 0 && *for_s <= engine::k_longest_run_s))
      throw std::invalid_argument(fmt::format("View.run(for_s={}): give a time from 0 to {} s, or None",
                                              *for_s, engine::k_longest_run_s));
    const py::list callbacks = callbacks_of(simulation);
    const Run run(*state);
    if (for_s) state->end_tick = now.tick() + engine::ticks_until(*for_s, now.tick_s());
    if (!callbacks.empty())
      state->after_tick = [&] {
        const py::gil_scoped_acquire lock;
        const Held::Calling calling(*held_);
        for (const py::handle callback : callbacks) call(callback, simulation);
      };
    held_->work([&state](Simulation&) { state->view->run(); });
  }
  /// If another thread is in run(), ends it and waits for it. Throws while another thread steps otherwise.
  void close() {
    if (const std::shared_ptr<State> state = state_; state && state->is_in_run_of_another_thread()) {
      state->is_closed = true;
      const Unlocked unlocked;
      std::unique_lock lock(state->mutex);
      state->run_ended.wait(lock, [&state] { return !state->is_running; });
    }
    held_->use();
    if (state_) state_->is_closed = true;
    state_.reset();
  }

 private:
  static constexpr std::uint64_t k_never = std::numeric_limits<std::uint64_t>::max();

  /// Owned by this object and, while the simulation steps, by `held_`.
  struct State {
    std::atomic<bool> is_closed = false;  // Python has released or closed the view
    std::mutex mutex;                     // guards is_running and runner
    std::condition_variable run_ended;
    bool is_running = false;  // run() is being executed, by the thread `runner`
    std::thread::id runner;
    std::uint64_t end_tick = k_never;  // read only on the thread that steps
    std::function<void()> after_tick;  // null: no call; used only on the thread that steps
    std::optional<live::View> view;    // last, because it uses the members above

    bool is_in_run_of_another_thread() {
      const std::scoped_lock lock(mutex);
      return is_running && runner != std::this_thread::get_id();
    }
  };
  /// Marks the end of a call of run().
  class Run {
   public:
    explicit Run(State& state) : state_(state) {
      const std::scoped_lock lock(state_.mutex);
      state_.is_running = true;
      state_.runner = std::this_thread::get_id();
    }
    ~Run() {
      state_.end_tick = k_never;
      state_.after_tick = nullptr;
      const std::scoped_lock lock(state_.mutex);
      state_.is_running = false;
      state_.run_ended.notify_all();
    }
    Run(const Run&) = delete;
    Run& operator=(const Run&) = delete;

   private:
    State& state_;
  };

  const std::shared_ptr<State>& open() const {
    if (!state_) throw std::logic_error("the view is closed: open another one");
    return state_;
  }

  Holder held_;
  std::shared_ptr<State> state_;  // null: closed
};

}  // namespace

void bind_live(py::module_& module, SimulationClass& simulation) {
  py::class_<HeldView>(module, "View",
                       "A running simulation in a browser (docs/live.md), made by Simulation.view(). Users "
                       "can pause and change the\nsimulation there; their actions are written to a session "
                       "file, with which the run can be repeated.",
                       py::dynamic_attr())
      .def_property_readonly("address", &HeldView::address, "Address of the page for full control.")
      .def_property_readonly("read_only_address", &HeldView::look_address,
                             "Address of the page for read-only access.")
      .def_property_readonly("session", &HeldView::session, "Path of the session file.")
      .def_property_readonly(
          "command", &HeldView::command,
          "The shell command that repeats the session; empty if a program built the world.")
      .def(
          "run",
          [](const py::object& self, const std::optional<double>& for_s) {
            self.cast<HeldView&>().run(self.attr(k_simulation), for_s);
          },
          py::arg("for_s") = py::none(),
          "Waits until the first user with full control connects, and then steps the simulation as users "
          "command, until `for_s`\n"
          "seconds of simulated time have passed (None: no limit) or a stop condition of the world holds. "
          "Calls the callbacks of\n"
          "Simulation.on_tick() after each step. Ctrl-C ends the run with KeyboardInterrupt. Raises "
          "ValueError if `for_s` is\n"
          "negative, NaN or more than 1e12, and RuntimeError in a callback of on_tick().")
      .def(
          "close", &HeldView::close,
          "Ends the session and disconnects all users; also ends run() in another thread, and waits until it "
          "has returned.\n"
          "Further calls of other functions of the view raise RuntimeError, as does close() while another "
          "thread "
          "steps the\nsimulation itself.");
  simulation.def(
      "view",
      [](const py::object& self, std::uint16_t port, double rate, const fs::path& out,
         const std::string& bind, const std::vector<std::string>& hosts) {
        py::object view = py::cast(std::make_unique<HeldView>(
            self.cast<Holder>(),
            live::View::Options{.port = port, .bind = bind, .hosts = hosts, .rate = rate, .folder = out}));
        view.attr(k_simulation) = self;
        return view;
      },
      py::kw_only(), py::arg("port") = 0, py::arg("rate") = 1.0, py::arg("out") = fs::path(),
      py::arg("bind") = "", py::arg("hosts") = std::vector<std::string>(),
      "Shows the simulation in a browser and returns a View with the address of the page. Either View.run() "
      "steps the\n"
      "simulation, or the program calls step(), which waits while a user has paused the run. `rate` limits "
      "the speed to a\n"
      "multiple of real time, from 0.001 to 1e6; 0 is no limit. The session file is created in the folder "
      "`out`; an empty\n"
      "path is the current folder. With \"mortal\": true in the world file, users can also remove and "
      "disable robots. port,\n"
      "bind and hosts are the options --port, --bind and --allow-host of `troupe view` (docs/live.md). "
      "Raises RuntimeError\n"
      "while the simulation has another view: close() that one first. Raises ValueError for another rate, "
      "and for a host that\n"
      "is no host name.");
}

}  // namespace troupe::python
