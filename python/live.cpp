#include "live/view.hpp"
#include "python/bindings.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace troupe::python {
namespace {

namespace fs = std::filesystem;

/// The live view of a simulation. Python owns the view, which keeps the simulation alive.
class HeldView {
 public:
  HeldView(Holder held, live::View::Options options) : held_(std::move(held)) {
    options.is_over = [this] { return held_->use_while_stepping().time_s() >= end_s_ || is_interrupted(); };
    options.report = [](const std::string& text) { fmt::print(stderr, "view: {}\n", text); };
    view_ = std::make_unique<live::View>(held_->use(), options);
  }

  std::string address() const { return open().address(); }
  std::string look_address() const { return open().look_address(); }
  fs::path session() const { return open().session(); }
  void run(std::optional<double> for_s) {
    live::View& view = open();
    end_s_ = for_s ? held_->use().time_s() + *for_s : k_never;
    held_->work([&view](Simulation&) { view.run(); });
    end_s_ = k_never;
  }
  void close() {
    held_->use();  // throws while another thread steps the simulation
    view_.reset();
  }

 private:
  static constexpr double k_never = std::numeric_limits<double>::infinity();

  live::View& open() const {
    if (!view_) throw std::logic_error("the view is closed: open another one");
    return *view_;
  }

  Holder held_;
  double end_s_ = k_never;  // read only on the thread that steps
  std::unique_ptr<live::View> view_;
};

}  // namespace

void bind_live(py::module_& module, SimulationClass& simulation) {
  py::class_<HeldView>(module, "View",
                       "A running simulation in a browser (docs/live.md), made by Simulation.view(). Users "
                       "can pause and change the\nsimulation there; their actions are written to a session "
                       "file, with which the run can be repeated.")
      .def_property_readonly("address", &HeldView::address, "Address of the page for full control.")
      .def_property_readonly("read_only_address", &HeldView::look_address,
                             "Address of the page for read-only access.")
      .def_property_readonly("session", &HeldView::session, "Path of the session file.")
      .def("run", &HeldView::run, py::arg("for_s") = py::none(),
           "Waits until the first user with full control connects, and then steps the simulation as users "
           "command, until `for_s`\nseconds of world time have passed (None: no limit) or a stop condition "
           "of the world holds. Ctrl-C ends the run with\nKeyboardInterrupt.")
      .def("close", &HeldView::close,
           "Ends the session and disconnects all users. Further calls of other functions of the view raise "
           "RuntimeError.");
  simulation.def(
      "view",
      [](const Holder& held, std::uint16_t port, double rate, const fs::path& out, const std::string& bind,
         const std::vector<std::string>& hosts) {
        return std::make_unique<HeldView>(held, live::View::Options{.port = port,
                                                                    .bind = bind,
                                                                    .hosts = hosts,
                                                                    .rate = rate,
                                                                    .folder = out,
                                                                    .is_over = {},
                                                                    .report = {}});
      },
      py::kw_only(), py::arg("port") = 0, py::arg("rate") = 1.0, py::arg("out") = fs::path(),
      py::arg("bind") = "", py::arg("hosts") = std::vector<std::string>(),
      "Shows the simulation in a browser and returns a View with the address of the page. Either View.run() "
      "steps the\nsimulation, or the program calls step(), which waits while a user has paused the run. "
      "`rate` limits the speed to a\nmultiple of real time; 0 is no limit. The session file is created in "
      "the folder `out`; an empty path is the current\nfolder. With \"mortal\": true in the world file, "
      "users can also remove and disable robots. port, bind and hosts are the\noptions --port, --bind and "
      "--allow-host of `troupe view` (docs/live.md).");
}

}  // namespace troupe::python
