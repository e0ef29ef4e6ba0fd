#include "engine/events.hpp"
#include "engine/world.hpp"
#include "python/bindings.hpp"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace troupe::python {
namespace {

struct HeldMeasures {
  Holder held;
  Measures measures;

  Measures& use() {
    static_cast<void>(held->use());
    return measures;
  }
};

/// Names are kept; dicts become JSON text.
std::vector<std::string> texts_of(const std::vector<std::variant<std::string, py::dict>>& wanted) {
  const py::object dumps = py::module_::import("json").attr("dumps");
  std::vector<std::string> texts;
  for (const auto& one : wanted)
    texts.push_back(std::holds_alternative<std::string>(one)
                        ? std::get<std::string>(one)
                        : dumps(std::get<py::dict>(one)).cast<std::string>());
  return texts;
}

struct Event {
  std::string type;
  std::string robot;
  std::uint32_t id;
  std::optional<std::string> other;
};

struct HeldEvents {
  Holder held;
  engine::EventWatch watch;

  std::vector<Event> see() {
    const engine::World& world = held->use().world();
    std::vector<Event> events;
    for (const engine::Event& event : watch.see(world)) {
      std::optional<std::string> other;
      if (event.other.valid()) other = world.spec().name(event.other);
      events.push_back({std::string(engine::event_name(event.type)), world.spec().name(event.body),
                        event.body.value, std::move(other)});
    }
    return events;
  }
};

struct HeldRecording {
  Holder held;
  Recording recording;
};

}  // namespace

void bind_observers(py::module_& module) {
  py::class_<HeldMeasures>(
      module, "Measures",
      "Measures of a simulation (docs/measures.md): names, `name:of`, or dicts with parameters.\n"
      "Without any: those of the world, or else all that need no parameters.")
      .def(py::init([](const Holder& held, const std::vector<std::variant<std::string, py::dict>>& wanted) {
             return HeldMeasures{held, Measures(held->use(), texts_of(wanted))};
           }),
           py::arg("simulation").none(false), py::arg("wanted") = py::tuple())
      .def(
          "see", [](HeldMeasures& m) { m.use().see(); }, "Updates the measures. Call it after every step.")
      .def_property_readonly("columns",
                             [](const HeldMeasures& m) {
                               return std::vector<std::string>(m.measures.columns().begin(),
                                                               m.measures.columns().end());
                             })
      .def(
          "values", [](HeldMeasures& m) { return m.use().values(); }, "One number per column.")
      .def(
          "__getitem__", [](HeldMeasures& m, const std::string& name) { return m.use().value(name); },
          py::arg("name"), "The value of one column, named with or without its unit.");

  py::class_<Event>(module, "Event",
                    "An event of a robot in a tick: type, robot, id, and the other body or None.")
      .def_readonly("type", &Event::type)
      .def_readonly("robot", &Event::robot)
      .def_readonly("id", &Event::id)
      .def_readonly("other", &Event::other)
      .def("__repr__", [](const Event& event) {
        return "<Event " + event.type + " of " + event.robot + (event.other ? ", " + *event.other : "") + ">";
      });

  py::class_<HeldEvents>(module, "Events", "Detects events of robots (docs/measures.md).")
      .def(py::init([](const Holder& held) {
             return HeldEvents{held, engine::EventWatch(held->use().world())};
           }),
           py::arg("simulation").none(false))
      .def("see", &HeldEvents::see, "The events of the last tick. Call it after every step.");

  py::class_<HeldRecording>(module, "Recording",
                            "A recording: an HDF5 file (docs/recordings.md). Use it as `with Recording(...) "
                            "as recording`, or call close().")
      .def(py::init([](const std::filesystem::path& file, const Holder& held,
                       const std::vector<std::string>& fields, double every_s, bool replace) {
             return HeldRecording{held, Recording(file, held->use(), {fields, every_s, replace})};
           }),
           py::arg("file"), py::arg("simulation").none(false), py::arg("fields") = py::tuple(),
           py::arg("every_s") = 0.0, py::arg("replace") = false)
      .def_static(
          "resume",
          [](const std::filesystem::path& file, const Holder& held) {
            return HeldRecording{held, Recording::resume(file, held->use())};
          },
          py::arg("file"), py::arg("simulation").none(false), "Continues a recording, for a resumed run.")
      .def(
          "observe", [](HeldRecording& r) { r.recording.observe(r.held->use()); },
          "Adds a frame if one is due. Call it after each step.")
      .def(
          "flush", [](HeldRecording& r) { r.recording.flush(); }, "Writes the frames that are in memory.")
      .def(
          "close", [](HeldRecording& r) { r.recording.close(); }, "Flushes and closes the file.")
      .def("__enter__", [](py::object self) { return self; })
      .def("__exit__", [](HeldRecording& r, const py::args&) { r.recording.close(); });
}

}  // namespace troupe::python
