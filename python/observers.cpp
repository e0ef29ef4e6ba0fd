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

/// Converts the measures that a program requests to the texts that the constructor of Measures takes: dicts
/// become JSON, names are not changed.
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
      "Numbers that are computed from the state of a simulation, such as the covered area "
      "(docs/measures.md). wanted: a\nlist of names of measures (\"stalls\"), names with the type, "
      "population or robot that they are computed for\n(\"stalls:leaders\"), or dicts with a kind and "
      "parameters ({\"kind\": \"coverage\", \"cell_m\": 0.5}).\nAn empty list means the measures of the "
      "world file, or, if it has none, all that need no parameters.")
      .def(py::init([](const Holder& held, const std::vector<std::variant<std::string, py::dict>>& wanted) {
             return HeldMeasures{held, Measures(held->use(), texts_of(wanted))};
           }),
           py::arg("simulation").none(false), py::arg("wanted") = py::tuple())
      .def(
          "see", [](HeldMeasures& m) { m.use().see(); },
          "Updates measures that depend on earlier ticks. Call it after every step.")
      .def_property_readonly("columns",
                             [](const HeldMeasures& m) {
                               return std::vector<std::string>(m.measures.columns().begin(),
                                                               m.measures.columns().end());
                             })
      .def(
          "values", [](HeldMeasures& m) { return m.use().values(); },
          "One number per column for the current state; NaN if a measure has no value.")
      .def(
          "__getitem__", [](HeldMeasures& m, const std::string& name) { return m.use().value(name); },
          py::arg("name"), "The value of one column, whose name may omit the unit.");

  py::class_<Event>(module, "Event",
                    "An event of a robot in a tick. type: what happened (docs/measures.md); robot and id: "
                    "name and id of the robot;\nother: name of the other body that took part, or None.")
      .def_readonly("type", &Event::type)
      .def_readonly("robot", &Event::robot)
      .def_readonly("id", &Event::id)
      .def_readonly("other", &Event::other)
      .def("__repr__", [](const Event& event) {
        return "<Event " + event.type + " of " + event.robot + (event.other ? ", " + *event.other : "") + ">";
      });

  py::class_<HeldEvents>(module, "Events",
                         "Detects events of robots, such as stalls, by comparing ticks (docs/measures.md).")
      .def(py::init([](const Holder& held) {
             return HeldEvents{held, engine::EventWatch(held->use().world())};
           }),
           py::arg("simulation").none(false))
      .def("see", &HeldEvents::see, "Returns the list of events of the last tick. Call it after every step.");

  py::class_<HeldRecording>(
      module, "Recording",
      "A recording of a simulation: an HDF5 file (docs/recordings.md). fields: names of components or sensor "
      "fields;\nevery_s: simulated time between two frames, s. Without fields, or without every_s, the value "
      "that the world file\nsets under \"record\" is used. replace: whether an existing file is "
      "replaced.\nUse it as `with Recording(...) as recording`, or call close() at the end.")
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
          py::arg("file"), py::arg("simulation").none(false),
          "Continues the recording of a run that was resumed from a checkpoint, from the current tick on. "
          "Frames after the\ncurrent tick are removed.")
      .def(
          "observe", [](HeldRecording& r) { r.recording.observe(r.held->use()); },
          "Records the current state if its tick is a multiple of the recording interval. Call it after each "
          "step.")
      .def(
          "flush", [](HeldRecording& r) { r.recording.flush(); },
          "Writes the frames that are still in memory to the file, so that other programs can read them.")
      .def(
          "close", [](HeldRecording& r) { r.recording.close(); },
          "Writes the remaining frames and closes the file.")
      .def("__enter__", [](py::object self) { return self; })
      .def("__exit__", [](HeldRecording& r, const py::args&) { r.recording.close(); });
}

}  // namespace troupe::python
