#include "base/diagnostics.hpp"
#include "engine/observing/events.hpp"
#include "engine/spec/ticks.hpp"
#include "engine/world/world.hpp"
#include "python/bindings.hpp"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace troupe::python {
namespace {

using Wanted = std::variant<std::string, py::dict, py::function>;

/// A column of HeldMeasures: a measure of the engine or a function in Python.
struct MeasureColumn {
  py::object function = {};  ///< null: the next column of HeldMeasures::measures
  std::string name = {};     ///< with the suffix of the unit
  std::string bare = {};     ///< of a function: the name without the suffix
};

/// Returns the column of a function. The decorator troupe.measure declares its name and unit; without the
/// decorator, the name is that of the function, and there is no unit. Throws TypeError for a function without
/// a name.
MeasureColumn column_of(const py::object& function) {
  const py::object declared = py::getattr(function, "_troupe_measure", py::none());
  const py::object bare =
      declared.is_none() ? py::getattr(function, "__name__", py::none()) : py::object(declared["name"]);
  if (bare.is_none())  // such as a functools.partial
    throw py::type_error("wanted: the function " + std::string(py::repr(function)) +
                         " has no name: give it one with troupe.measure(function, name=...)");
  const engine::Unit unit = declared.is_none() ? engine::Unit::none : unit_of(py::str(declared["unit"]));
  const std::string name = py::str(bare);
  return {function, name + std::string(engine::unit_suffixes(unit).front().suffix), name};
}

struct HeldMeasures {
  Holder held;
  std::optional<Measures> measures = {};  ///< not set: all columns are functions
  std::vector<MeasureColumn> columns = {};

  void see() {
    static_cast<void>(held->use());
    if (measures) measures->see();
  }
  std::vector<double> values() {
    std::vector<double> rest;
    static_cast<void>(held->use());
    if (measures) rest = measures->values();
    std::vector<double> values;
    std::size_t next = 0;
    for (const MeasureColumn& column : columns)
      values.push_back(column.function ? value_of(column.function) : rest[next++]);
    return values;
  }
  double value(const std::string& name) {
    static_cast<void>(held->use());
    for (const MeasureColumn& column : columns)
      if (column.function && (column.name == name || column.bare == name)) return value_of(column.function);
    if (measures) return measures->value(name);
    const std::vector<std::string> known = names();
    throw std::out_of_range(unknown_name("measure", name, {known.begin(), known.end()}));
  }
  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const MeasureColumn& column : columns) names.push_back(column.name);
    return names;
  }

 private:
  double value_of(const py::object& function) const {
    Simulation& simulation = held->use();
    const auto measuring = simulation.world().measuring();
    return measured(function, simulation.swarm());
  }
};

/// Converts the measures that a program requests to the texts that the constructor of Measures takes: dicts
/// become JSON, names are not changed.
std::vector<std::string> texts_of(const std::vector<Wanted>& wanted) {
  std::vector<std::string> texts;
  for (const Wanted& one : wanted) {
    if (const auto* name = std::get_if<std::string>(&one)) texts.push_back(*name);
    if (const auto* described = std::get_if<py::dict>(&one)) texts.push_back(json_of(*described));
  }
  return texts;
}

HeldMeasures measures_of(const Holder& held, const std::vector<Wanted>& wanted) {
  HeldMeasures made{held};
  const std::vector<std::string> texts = texts_of(wanted);
  if (wanted.empty() || !texts.empty()) made.measures.emplace(held->use(), texts);
  const auto names = made.measures ? made.measures->columns() : std::span<const std::string>();
  if (wanted.empty())
    for (const std::string& name : names) made.columns.push_back({.name = name});
  std::size_t next = 0;
  for (const Wanted& one : wanted) {
    const auto* function = std::get_if<py::function>(&one);
    MeasureColumn column = function ? column_of(*function) : MeasureColumn{.name = names[next++]};
    if (std::ranges::find(made.columns, column.name, &MeasureColumn::name) != made.columns.end())
      throw InputError(
          "two measures have the column \"" + column.name +
          "\": give one of them another name; a function gets one with @troupe.measure(name=...)");
    made.columns.push_back(std::move(column));
  }
  return made;
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

/// A recording. Its functions run as tasks of Held::work(): only one thread at a time may use it, and it may
/// write much.
class HeldRecording {
 public:
  /// make: makes the recording from a `const Simulation&`
  template <class Make>
  HeldRecording(Holder held, Make&& make) : held_(std::move(held)) {
    held_->work([&](const Simulation& simulation) { recording_.emplace(make(simulation)); });
  }

  /// Recording::observe() does nothing after close(), so that frames would be missing without an error.
  void observe() {
    if (is_closed_) throw std::logic_error("observe(): the recording is closed: make another one");
    held_->work([&](const Simulation& simulation) { recording_->observe(simulation); });
  }
  void flush() {
    held_->work([&](const Simulation&) { recording_->flush(); });
  }
  void close() {
    held_->work([&](const Simulation&) {
      is_closed_ = true;
      recording_->close();
    });
  }

 private:
  Holder held_;
  std::optional<Recording> recording_;
  bool is_closed_ = false;
};

void bind_measures(py::module_& module) {
  py::class_<HeldMeasures>(module, "Measures",
                           "Numbers that are computed from the state of a simulation, such as the covered "
                           "area (docs/measures.md). wanted: a list\n"
                           "of names of measures (\"stalls\"), names with the type, population or robot that "
                           "they are computed for\n"
                           "(\"stalls:leaders\"), or dicts with a kind and parameters ({\"kind\": "
                           "\"coverage\", \"cell_m\": 0.5}), or functions that take\n"
                           "the Swarm of all robots and return a number. Such a function must not change the "
                           "world, and can use the swarm only\n"
                           "during the call. An empty list means the measures of the world file, or, if it "
                           "has none, all measures that need no\n"
                           "parameters. Raises InputError for an unknown measure, robot or parameter, and "
                           "for two measures with the same column.")
      .def(py::init(&measures_of), py::arg("simulation").none(false), py::arg("wanted") = py::tuple())
      .def("see", &HeldMeasures::see,
           "Updates measures that depend on earlier ticks, such as the covered area. Call it after every "
           "step.")
      .def_property_readonly("columns", &HeldMeasures::names,
                             "Names of the values, with their units, in the order of `wanted`.")
      .def("values", &HeldMeasures::values,
           "One number per column for the current state; NaN if a measure has no value.")
      .def("__getitem__", &HeldMeasures::value, py::arg("name"),
           "The value of one column for the current state, as in values(). The name may omit the unit. "
           "Raises LookupError for an\nunknown column.")
      .def("keys", &HeldMeasures::names,
           "The names in `columns`; dict(measures) is a dict from these names to the values.")
      .def("__iter__", [](const HeldMeasures& measures) { return py::iter(py::cast(measures.names())); });
}

void bind_events(py::module_& module) {
  py::class_<Event>(module, "Event",
                    "An event of a robot or another body in a tick. type: what happened, such as "
                    "\"stall_begins\" (docs/measures.md); robot and\nid: name and id of this body; other: "
                    "name of the body that it gripped or released, or None for other events.")
      .def_readonly("type", &Event::type)
      .def_readonly("robot", &Event::robot)
      .def_readonly("id", &Event::id)
      .def_readonly("other", &Event::other)
      .def("__repr__",
           [](const Event& event) {
             return "<Event " + event.type + " of " + event.robot + (event.other ? ", " + *event.other : "") +
                    ">";
           })
      .def(py::pickle(
          [](const Event& event) { return py::make_tuple(event.type, event.robot, event.id, event.other); },
          [](const py::tuple& state) {
            return Event{state[0].cast<std::string>(), state[1].cast<std::string>(),
                         state[2].cast<std::uint32_t>(), state[3].cast<std::optional<std::string>>()};
          }));

  py::class_<HeldEvents>(module, "Events",
                         "Detects events of robots, such as beginnings of stalls, by comparing the state of "
                         "each tick with that of the previous\none (docs/measures.md).")
      .def(py::init([](const Holder& held) {
             return HeldEvents{held, engine::EventWatch(held->use().world())};
           }),
           py::arg("simulation").none(false))
      .def("see", &HeldEvents::see,
           "Returns the list of events of the last tick, sorted by id. Call it after every step: after a "
           "longer interval, or after a\nreset, the list is empty.");
}

void bind_recordings(py::module_& module) {
  py::class_<HeldRecording>(
      module, "Recording",
      "A recording of a simulation: an HDF5 file (docs/recordings.md). fields: names of components of the "
      "state (\"pose\") or of\nfields of sensors (\"ranges\"); every_s: simulated time between two frames, "
      "s. Without fields, or without every_s, the\nvalue that the world file sets under \"record\" is used. "
      "replace: whether an existing file is replaced; False: an existing\nfile raises InputError. Use the "
      "object as in `with Recording(...) as recording`, or call close() at the end.")
      .def(py::init([](const std::filesystem::path& file, const Holder& held,
                       const std::vector<std::string>& fields, double every_s, bool replace) {
             const RecordingOptions options{fields, from_zero("every_s", every_s, engine::k_most_seconds),
                                            replace};
             return HeldRecording(held, [&](const Simulation& s) { return Recording(file, s, options); });
           }),
           py::arg("file"), py::arg("simulation").none(false), py::arg("fields") = py::tuple(),
           py::arg("every_s") = 0.0, py::arg("replace") = false)
      .def_static(
          "resume",
          [](const std::filesystem::path& file, const Holder& held) {
            return HeldRecording(held, [&](const Simulation& s) { return Recording::resume(file, s); });
          },
          py::arg("file"), py::arg("simulation").none(false),
          "Continues an existing recording, for a run that was resumed from a checkpoint, from the current "
          "tick on. Frames after\nthe current tick are removed from the file. Raises RuntimeError if the "
          "file is not a recording of this run.")
      .def(
          "observe", &HeldRecording::observe,
          "Records the current state if its tick is a multiple of the recording interval. Call it after each "
          "step. Raises\nRuntimeError after close() and after a reset of the simulation: make a new "
          "recording then.")
      .def("flush", &HeldRecording::flush,
           "Writes the frames that are still in memory to the file. Readers that opened it in SWMR mode "
           "(h5py: swmr=True) can\nthen read them.")
      .def("close", &HeldRecording::close,
           "Writes the frames that are still in memory and closes the file. All HDF5 tools can then read it.")
      .def("__enter__", [](py::object self) { return self; })
      .def("__exit__", [](HeldRecording& r, const py::args&) { r.close(); });
}

}  // namespace

void bind_observers(py::module_& module) {
  bind_measures(module);
  bind_events(module);
  bind_recordings(module);
}

}  // namespace troupe::python
