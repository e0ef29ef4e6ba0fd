#include "base/diagnostics.hpp"
#include "engine/spec/ticks.hpp"
#include "python/bindings.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace troupe::python {
PictureOptions picture_options(int width, int height, const std::string& camera, const std::string& layers,
                               const Two& center_m, const Two& angle_rad,
                               const std::optional<double>& across_m, const std::string& color_by,
                               const Two& color_range, const std::string& background) {
  if (width < 1 || height < 1)
    throw std::invalid_argument(
        fmt::format("picture of {} x {} pixels: width and height must be 1 or more", width, height));
  return {width, height, camera, center_m, angle_rad, across_m, layers, color_by, color_range, background};
}

double from_zero(std::string_view what, double value, double most) {
  if (value >= 0 && value <= most) return value;
  throw std::invalid_argument(
      fmt::format("{} is {}: give a number from 0, which means the default, to {}", what, value, most));
}

namespace {

/// Name of the attribute of a Simulation that contains the list of callbacks of on_tick(). Because it is in
/// the object's __dict__, Python's garbage collector sees the callbacks, which often refer to the simulation
/// that calls them.
constexpr const char* k_callbacks = "_on_tick";

}  // namespace

py::list callbacks_of(const py::object& simulation) {
  return py::getattr(simulation, k_callbacks, py::list()).cast<py::list>();
}

namespace {

namespace fs = std::filesystem;
/// A list of folders, or one folder.
using Paths = std::variant<std::vector<fs::path>, fs::path>;

std::vector<fs::path> folders_of(Paths paths) {
  if (auto* folder = std::get_if<fs::path>(&paths)) return {std::move(*folder)};
  return std::get<std::vector<fs::path>>(std::move(paths));
}

// ---- options

std::string json_of(const py::object& value, const py::object& indent = py::none()) {
  return py::module_::import("json")
      .attr("dumps")(value, py::arg("allow_nan") = false, py::arg("indent") = indent)
      .cast<std::string>();
}

/// Converts a value of the option `set` to JSON. Throws ValueError for a text with half of a surrogate pair:
/// its JSON is invalid, and the reader of settings treats invalid JSON as a text without quotes.
std::string setting_of(const py::object& value) {
  std::string json = json_of(value);
  const py::object text = py::module_::import("json").attr("dumps")(value, py::arg("ensure_ascii") = false);
  if (PyUnicode_AsUTF8(text.ptr()) != nullptr) return json;
  PyErr_Clear();
  throw py::value_error(fmt::format(
      "set: the value {} contains half of a surrogate pair: give a text that UTF-8 can represent", json));
}

/// The option `set`: a dict from JSON pointers to values, or a list of pairs (JSON pointer, value), in which
/// a pointer such as /models/- may occur several times.
using Settings = std::optional<std::variant<py::dict, py::list>>;

/// Converts the option `set` to pairs of pointer and JSON text.
std::vector<std::pair<std::string, std::string>> settings_of(const Settings& set) {
  std::vector<std::pair<std::string, std::string>> settings;
  if (!set) return settings;
  const auto add = [&settings](const py::handle& pointer, const py::handle& value) {
    try {
      settings.emplace_back(pointer.cast<std::string>(),
                            setting_of(py::reinterpret_borrow<py::object>(value)));
    } catch (const py::cast_error&) {
      throw py::type_error(fmt::format("set: the key {} is not a JSON pointer: give a text such as \"/seed\"",
                                       std::string(py::repr(pointer))));
    }
  };
  if (const py::dict* named = std::get_if<py::dict>(&*set)) {
    for (const auto& [pointer, value] : *named) add(pointer, value);
    return settings;
  }
  for (const py::handle each : std::get<py::list>(*set)) {
    if (!py::isinstance<py::tuple>(each) || py::len(each) != 2)
      throw py::type_error(
          fmt::format("set: the list has the element {}: give tuples of a JSON pointer and a value",
                      std::string(py::repr(each))));
    const auto pair = py::reinterpret_borrow<py::tuple>(each);
    add(pair[0], pair[1]);
  }
  return settings;
}

/// The option `robots`: the size of the only population, or a dict from names of populations to sizes.
using Robots = std::variant<std::monostate, std::size_t, py::dict>;

std::vector<std::pair<std::string, std::size_t>> robots_of(const Robots& robots) {
  if (const std::size_t* count = std::get_if<std::size_t>(&robots)) return {{"", *count}};
  std::vector<std::pair<std::string, std::size_t>> sizes;
  if (const py::dict* named = std::get_if<py::dict>(&robots))
    for (const auto& [name, count] : *named) try {
        sizes.emplace_back(name.cast<std::string>(), count.cast<std::size_t>());
      } catch (const py::cast_error&) {
        throw py::type_error(
            fmt::format("robots: found {}: {}; give the name of a population and a whole number from 0",
                        std::string(py::repr(name)), std::string(py::repr(count))));
      }
  return sizes;
}

std::optional<RangingEngine> ranging_of(const std::optional<std::string>& name) {
  if (!name) return {};
  const auto found = std::ranges::find(engine::k_ranging_engines, *name);
  if (found == engine::k_ranging_engines.end())
    throw std::invalid_argument(
        unknown_name("ranging", *name, {engine::k_ranging_engines.begin(), engine::k_ranging_engines.end()}));
  return static_cast<RangingEngine>(found - engine::k_ranging_engines.begin());
}

double tile_size(double metres) {
  return from_zero("tile_size_m", metres, std::numeric_limits<double>::max());
}

using Seed = std::optional<std::uint64_t>;
using Text = std::optional<std::string>;

SimulationOptions options_of(const Robots& robots, unsigned threads, const Seed& seed, const Text& ranging,
                             const Settings& set, Paths search_path, Paths plugin_path,
                             const py::object& controllers, double tile_size_m, unsigned ranks) {
  return {.threads = threads,
          .tile_size_m = tile_size(tile_size_m),
          .seed = seed,
          .ranging = ranging_of(ranging),
          .robots = robots_of(robots),
          .set = settings_of(set),
          .search_path = folders_of(std::move(search_path)),
          .plugin_path = folders_of(std::move(plugin_path)),
          .scripts = scripts_of(controllers),
          .ranks = ranks};
}

/// Returns the simulation that make() makes. make() runs without the interpreter's lock, because worlds may
/// take long to load.
template <class Make>
Holder hold(Make&& make) {
  const Unlocked unlocked;
  return std::make_shared<Held>(make());
}

Holder load(const std::variant<py::dict, fs::path>& world, const Robots& robots, unsigned threads,
            const Seed& seed, const Text& ranging, const Settings& set, const fs::path& name,
            Paths search_path, Paths plugin_path, const py::object& controllers, double tile_size_m,
            unsigned ranks) {
  const SimulationOptions options = options_of(robots, threads, seed, ranging, set, std::move(search_path),
                                               std::move(plugin_path), controllers, tile_size_m, ranks);
  if (const fs::path* file = std::get_if<fs::path>(&world))
    return hold([&] { return Simulation(*file, options); });
  const std::string text = json_of(std::get<py::dict>(world), py::int_(1));
  return hold([&] { return Simulation::from_text(text, name, options); });
}

Holder from_text(const std::string& text, const fs::path& name, const Robots& robots, unsigned threads,
                 const Seed& seed, const Text& ranging, const Settings& set, Paths search_path,
                 Paths plugin_path, const py::object& controllers, double tile_size_m, unsigned ranks) {
  const SimulationOptions options = options_of(robots, threads, seed, ranging, set, std::move(search_path),
                                               std::move(plugin_path), controllers, tile_size_m, ranks);
  return hold([&] { return Simulation::from_text(text, name, options); });
}

Holder resume(const fs::path& checkpoint, unsigned threads, const Settings& set, bool across_versions,
              Paths plugin_path, const py::object& controllers, bool across_plugins, double tile_size_m,
              unsigned ranks) {
  const ResumeOptions options{.threads = threads,
                              .tile_size_m = tile_size(tile_size_m),
                              .set = settings_of(set),
                              .across_versions = across_versions,
                              .plugin_path = folders_of(std::move(plugin_path)),
                              .scripts = scripts_of(controllers),
                              .across_plugins = across_plugins,
                              .ranks = ranks};
  return hold([&] { return Simulation::resume(checkpoint, options); });
}

// ---- the run

/// Makes one tick and calls the callbacks of on_tick().
void step_and_call(const py::object& self, const Holder& held, const py::list& callbacks) {
  held->step(1);
  const Held::Calling calling(*held);
  for (const py::handle callback : callbacks) call(callback, self);
}

/// Makes `ticks` ticks. After each tick, calls the callbacks of on_tick() and then `after`. to_its_end:
/// whether to stop early if a stop condition of the world ends the run.
void advance(const py::object& self, std::uint64_t ticks, bool to_its_end,
             const std::optional<py::function>& after = {}) {
  const Holder held = self.cast<Holder>();
  const py::list callbacks = callbacks_of(self);
  if (callbacks.empty() && !after) return held->step(ticks, to_its_end);
  for (; ticks > 0 && !(to_its_end && held->use().stopped()); --ticks) {
    step_and_call(self, held, callbacks);
    if (!after) continue;
    const Held::Calling calling(*held);
    call(*after, self);
  }
}

void step(const py::object& self, std::uint64_t ticks) {
  self.cast<Holder>()->use_outside("step()");
  advance(self, ticks, false);
}

bool is_time(double seconds) { return seconds >= 0 && seconds <= engine::k_longest_run_s; }

void run_for(const py::object& self, double seconds, const std::optional<py::function>& on_tick) {
  Simulation& simulation = self.cast<Holder>()->use_outside("run_for()");
  if (!is_time(seconds)) simulation.run_for(seconds);  // throws the error of the C++ function
  advance(self, engine::ticks_until(seconds, simulation.tick_s()), true, on_tick);
}

bool run_until(const py::object& self, const py::function& done, double at_most_s) {
  const Holder held = self.cast<Holder>();
  Simulation& simulation = held->use_outside("run_until()");
  if (!is_time(at_most_s)) simulation.run_until([](const Simulation&) { return true; }, at_most_s);
  std::uint64_t ticks = engine::ticks_until(at_most_s, simulation.tick_s());
  for (; ticks > 0 && !held->use().stopped(); --ticks) {
    advance(self, 1, true);
    const Held::Calling calling(*held);
    if (call(done, self).cast<bool>()) return true;
  }
  return false;
}

py::object on_tick(const py::object& self, const py::object& callback) {
  self.cast<Holder>()->use_outside("on_tick()");
  if (!callback.is_none() && PyCallable_Check(callback.ptr()) == 0)
    throw py::type_error(
        fmt::format("on_tick() takes a function, or None, which removes all callbacks; found {}",
                    std::string(py::repr(callback))));
  py::list callbacks = callback.is_none() ? py::list() : callbacks_of(self);
  if (!callback.is_none()) callbacks.append(callback);
  py::setattr(self, k_callbacks, callbacks);
  return callback;
}

// ---- rays

struct Hit {
  double range_m;
  std::optional<std::uint32_t> body;
  std::uint32_t part;
};

Hit cast_one(const Holder& held, const Pose& start, double range_max, HeldModel* without) {
  const RayHit hit = held->use().cast(start, range_max, without != nullptr ? &without->use() : nullptr);
  return {hit.range_m, hit.met() ? std::optional(hit.body.value) : std::nullopt, hit.part};
}

/// Casts many rays. starts: one row (x, y, z, heading) per ray, m and rad. Returns two arrays: the distance
/// at which each ray meets a surface, m, and the id of the body, or -1 if it meets nothing.
py::tuple cast_many(const Holder& held,
                    const py::array_t<double, py::array::c_style | py::array::forcecast>& starts,
                    double range_max, HeldModel* without) {
  if (starts.ndim() != 2 || starts.shape(1) != 4)
    throw py::value_error(
        fmt::format("starts has shape {}; give an array of n x 4: x, y, z (m) and heading (rad) of each ray",
                    std::string(py::str(starts.attr("shape")))));
  Simulation& simulation = held->use();
  const Model* passes = without != nullptr ? &without->use() : nullptr;
  py::array_t<double> ranges(starts.shape(0));
  py::array_t<std::int64_t> bodies(starts.shape(0));
  for (py::ssize_t i = 0; i < starts.shape(0); ++i) {
    const double* start = starts.data(i, 0);
    const RayHit hit = simulation.cast({start[0], start[1], start[2], start[3]}, range_max, passes);
    ranges.mutable_at(i) = hit.range_m;
    bodies.mutable_at(i) = hit.met() ? std::int64_t{hit.body.value} : -1;
  }
  return py::make_tuple(ranges, bodies);
}

// ---- hashes, counters and pictures

py::dict hashes_of(const Holder& held) {
  const Simulation::Hashes hashes = held->use().hashes();
  using namespace py::literals;
  return py::dict("state"_a = hashes.state, "pose"_a = hashes.pose, "velocity"_a = hashes.velocity,
                  "sensor"_a = hashes.sensor, "memory"_a = hashes.memory);
}

py::dict statistics_of(const Holder& held) {
  const Statistics s = held->use().statistics();
  using namespace py::literals;
  return py::dict("robots"_a = s.robots, "ticks"_a = s.ticks, "time_s"_a = s.time_s, "beams"_a = s.beams,
                  "stalled"_a = s.stalled, "held_at_bounds"_a = s.held_at_bounds,
                  "mean_displacement_m"_a = s.mean_displacement_m, "conflict_rounds"_a = s.conflict_rounds,
                  "state_bytes"_a = s.state_bytes);
}

void snapshot(const Holder& held, const fs::path& file, int width, int height, const std::string& camera,
              const std::string& layers, const Two& center_m, const Two& angle_rad,
              const std::optional<double>& across_m, const std::string& color_by, const Two& color_range,
              const std::string& background) {
  held->use().snapshot(file, picture_options(width, height, camera, layers, center_m, angle_rad, across_m,
                                             color_by, color_range, background));
}

py::array_t<std::uint8_t> picture(const Holder& held, int width, int height, const std::string& camera,
                                  const std::string& layers, const Two& center_m, const Two& angle_rad,
                                  const std::optional<double>& across_m, const std::string& color_by,
                                  const Two& color_range, const std::string& background) {
  const std::vector<std::uint8_t> bytes = held->use().picture(picture_options(
      width, height, camera, layers, center_m, angle_rad, across_m, color_by, color_range, background));
  py::array_t<std::uint8_t> rgb({py::ssize_t{height}, py::ssize_t{width}, py::ssize_t{3}});
  std::ranges::copy(bytes, rgb.mutable_data());
  return rgb;
}

std::optional<HeldModel> spawn(const Holder& held, const std::string& population, const Pose& pose) {
  std::optional<Model> born = held->use().spawn(population, pose);
  if (!born) return {};
  return HeldModel{held, std::move(*born)};
}

void bind_values(py::module_& module) {
  py::class_<Pose>(
      module, "Pose",
      "A pose: position x, y, z in m, and heading in rad, counter-clockwise from the x axis of the frame in "
      "which the pose is\ngiven. In the frame of a body, +x is forward and +y is left. Functions that take a "
      "Pose also take a tuple (x, y,\nheading), with z = 0. Iterating over a Pose gives x, y and heading.")
      .def(py::init([](double x, double y, double heading, double z) {
             return Pose{x, y, z, heading};
           }),
           py::arg("x") = 0.0, py::arg("y") = 0.0, py::arg("heading") = 0.0, py::arg("z") = 0.0)
      .def(py::init([](const py::tuple& three) {
             if (three.size() != 3)
               throw py::value_error(fmt::format(
                   "a pose cannot be made from a tuple of {} numbers: give (x, y, heading)", three.size()));
             return Pose{three[0].cast<double>(), three[1].cast<double>(), 0, three[2].cast<double>()};
           }),
           py::arg("x_y_heading"))
      .def_readwrite("x", &Pose::x)
      .def_readwrite("y", &Pose::y)
      .def_readwrite("z", &Pose::z)
      .def_readwrite("heading", &Pose::heading)
      .def("__iter__", [](const Pose& p) { return py::iter(py::make_tuple(p.x, p.y, p.heading)); })
      .def(
          "__eq__", [](const Pose& a, const Pose& b) { return a == b; }, py::is_operator())
      .def("__repr__", [](const Pose& p) {
        return fmt::format("Pose(x={}, y={}, heading={}, z={})", p.x, p.y, p.heading, p.z);
      });
  py::implicitly_convertible<py::tuple, Pose>();

  py::class_<Model::Speed>(module, "Speed",
                           "A velocity in the body frame: forward and left in m/s, turn in rad/s. It can be "
                           "unpacked: forward, left, turn =\nspeed.")
      .def_readonly("forward", &Model::Speed::forward)
      .def_readonly("left", &Model::Speed::left)
      .def_readonly("turn", &Model::Speed::turn)
      .def("__iter__",
           [](const Model::Speed& s) { return py::iter(py::make_tuple(s.forward, s.left, s.turn)); })
      .def("__repr__", [](const Model::Speed& s) {
        return fmt::format("Speed(forward={}, left={}, turn={})", s.forward, s.left, s.turn);
      });
}

}  // namespace

SimulationClass bind_simulation(py::module_& module) {
  bind_values(module);
  bind_models(module);
  py::class_<Hit>(module, "Hit",
                  "The first surface that a ray meets. range_m: distance to the surface, m; the length of "
                  "the ray if it met nothing. body:\nid of the body, or None if the ray met nothing. part: "
                  "index of the part of the body; 0: the body itself. met(): whether\nthe ray met a surface.")
      .def_readonly("range_m", &Hit::range_m)
      .def_readonly("body", &Hit::body)
      .def_readonly("part", &Hit::part)
      .def("met", [](const Hit& hit) { return hit.body.has_value(); })
      .def("__repr__", [](const Hit& hit) {
        return hit.body ? fmt::format("<Hit of body {} after {:g} m>", *hit.body, hit.range_m)
                        : std::string("<Hit of nothing>");
      });
  SimulationClass simulation(module, "Simulation",
                             "A world and its state. Only one thread at a time may use a simulation: calls "
                             "from another thread during a step raise\nRuntimeError. After a StepError, "
                             "functions that read or change the state raise RuntimeError until reset().",
                             py::dynamic_attr());
  simulation
      .def(
          py::init(&load), py::arg("world"), py::kw_only(), py::arg("robots") = py::none(),
          py::arg("threads") = 0, py::arg("seed") = py::none(), py::arg("ranging") = py::none(),
          py::arg("set") = py::none(), py::arg("name") = "world.json", py::arg("search_path") = py::tuple(),
          py::arg("plugin_path") = py::tuple(), py::arg("controllers") = py::tuple(),
          py::arg("tile_size_m") = 0.0, py::arg("ranks") = 1,
          "Loads a world. world: a file name (Stage .world or JSON), or a dict with the content of a JSON "
          "world file, whose\nrelative paths are resolved from the folder of `name`. robots: number of "
          "robots of the only population, or a dict from\nnames of populations to numbers of robots. "
          "threads: number of worker threads, at most 1024; 0: one per processor that\nthe process may use. "
          "ranks: number of ranks; each rank is a group of `threads` threads of this process that has its "
          "own\ncopy of the world and computes some of the robots (docs/cluster.md); no result depends on "
          "this number. seed and ranging\n(\"exact\" or \"grid\") replace the values of the world file. "
          "set: other values of the world file to replace, a dict from\nJSON pointers to new values, or a "
          "list of tuples (JSON pointer, new value), in which /models/- and other pointers to\nthe end of a "
          "list may occur several times. controllers: a script (file name), a class derived from Controller, "
          "or a\nlist of these. search_path: folders in which the world file and included files are searched "
          "by their names if they do\nnot exist at their paths. plugin_path: folders in which plug-ins are "
          "searched. Either may also be a single folder.\ntile_size_m: edge length of the tiles of the "
          "spatial index, m, which affects only the speed; 0: automatic. Raises\nInputError if the world is "
          "invalid.")
      .def_static(
          "from_text", &from_text, py::arg("text"), py::arg("name") = "world.json", py::kw_only(),
          py::arg("robots") = py::none(), py::arg("threads") = 0, py::arg("seed") = py::none(),
          py::arg("ranging") = py::none(), py::arg("set") = py::none(), py::arg("search_path") = py::tuple(),
          py::arg("plugin_path") = py::tuple(), py::arg("controllers") = py::tuple(),
          py::arg("tile_size_m") = 0.0, py::arg("ranks") = 1,
          "Loads a world from the text of a world file. `name` is used in place of a file name: its ending, "
          ".world or\n.json, selects the syntax, and relative paths are resolved from its folder. The other "
          "parameters are those of\nSimulation(). Raises InputError if the world is invalid.")
      .def_static("resume", &resume, py::arg("checkpoint"), py::kw_only(), py::arg("threads") = 0,
                  py::arg("set") = py::none(), py::arg("across_versions") = false,
                  py::arg("plugin_path") = py::tuple(), py::arg("controllers") = py::tuple(),
                  py::arg("across_plugins") = false, py::arg("tile_size_m") = 0.0, py::arg("ranks") = 1,
                  "Resumes a run from a checkpoint of save(), with the same results, bit for bit, as if "
                  "it had never stopped. set: as in\nSimulation(), for values of the world that may "
                  "change in a resumed run (docs/checkpoints.md). plugin_path, controllers:\nas in "
                  "Simulation(); they must contain all plug-ins and scripts that the run used. threads, "
                  "tile_size_m, ranks: as in\nSimulation(). across_versions: whether a checkpoint of "
                  "another version of Troupe is accepted. across_plugins: whether\nplug-ins and scripts "
                  "are accepted whose files have changed since the checkpoint was saved. Raises "
                  "InputError if the file\nis not a usable checkpoint, or if a plug-in or script of the "
                  "run is missing.")
      .def("__repr__",
           [](const Holder& held) {
             Simulation& s = held->use();
             return fmt::format("<Simulation \"{}\": {} robots, {:g} s>", s.title(), s.robots(), s.time_s());
           })
      .def_property_readonly(
          "warnings", [](const Holder& held) { return held->use().warnings(); },
          "Warnings about the world file, the checkpoint and plug-ins, one text each.")
      .def_property_readonly(
          "options",
          [](const Holder& held) {
            py::dict options;
            for (const auto& [key, value] : held->use().effective_options()) options[py::str(key)] = value;
            return options;
          },
          "The options that the simulation uses (world, seed, threads, ...): a dict of texts, for logs.")
      .def_property_readonly(
          "time_s", [](const Holder& held) { return held->use().time_s(); }, "World time, s.")
      .def_property_readonly(
          "tick", [](const Holder& held) { return held->use().tick(); }, "Number of completed ticks.")
      .def_property_readonly(
          "tick_s", [](const Holder& held) { return held->use().tick_s(); }, "Length of a tick, s.")
      .def_property_readonly(
          "robots", [](const Holder& held) { return held->use().robots(); },
          "Number of robots that are in the world now.")
      .def_property_readonly(
          "title", [](const Holder& held) { return held->use().title(); },
          "Title in the world file, or else the name of the file.")
      .def_property_readonly(
          "threads", [](const Holder& held) { return held->use().threads(); },
          "Number of worker threads, per rank.")
      .def_property_readonly("ranks", [](const Holder& held) { return held->use().ranks(); })
      .def_property_readonly(
          "quit_time_s", [](const Holder& held) { return held->use().quit_time_s(); },
          "Time at which the run ends according to the world file, s; None: the file gives no such time. "
          "run_for() and step() do\nnot end at this time.")
      .def_property_readonly("seed", [](const Holder& held) { return held->use().seed(); })
      .def_property_readonly(
          "stopped", [](const Holder& held) { return held->use().stopped(); },
          "The condition of `stop_when` in the world file that ended the run, as a text, or None.")
      .def_property_readonly(
          "resumed_at_tick", [](const Holder& held) { return held->use().resumed_at_tick(); },
          "Tick of the checkpoint from which the run was resumed, or None.")
      .def("step", &step, py::arg("ticks") = 1,
           "Advances the simulation by this many ticks. Stop conditions of the world do not end the call. "
           "Other Python threads can\nrun meanwhile, because the interpreter's lock is released. Raises "
           "StepError if a tick fails, and RuntimeError in a\ncallback of on_tick().")
      .def("run_for", &run_for, py::arg("seconds"), py::arg("on_tick") = py::none(),
           "Steps until `seconds` more of world time have passed, or until a condition of `stop_when` in the "
           "world file ends the\nrun. If the callback on_tick is given, it is called as on_tick(simulation) "
           "after each tick. Raises ValueError if\n`seconds` is negative, NaN or above 1e12.")
      .def("run_until", &run_until, py::arg("done"), py::arg("at_most_s"),
           "Steps until the callback done(simulation), which is called after each step, returns a true "
           "value. Returns True in this\ncase, and False if `at_most_s` seconds of world time pass first or "
           "a condition of `stop_when` in the world file ends the\nrun first. Raises ValueError if "
           "`at_most_s` is negative, NaN or above 1e12.")
      .def("on_tick", &on_tick, py::arg("callback").none(true),
           "Adds a callback: callback(simulation) is called at the end of every step, after the recording of "
           "record() has received\nthe tick. None removes all callbacks. A callback may do everything that a "
           "program may do between two steps, except\ncalls of step(), run_for(), run_until(), reset() and "
           "on_tick(), which raise RuntimeError. An exception in a callback\nends the step and reaches the "
           "caller of the step. on_tick() returns the callback, so it can be used as a "
           "decorator:\n@simulation.on_tick.")
      .def(
          "reset",
          [](const Holder& held, const Seed& seed) {
            Simulation& used = held->use_outside("reset()");
            if (seed)
              used.reset(*seed);
            else
              used.reset();
          },
          py::arg("seed") = py::none(),
          "Resets the simulation to tick 0 and to its state after loading, bit for bit. If `seed` is given, "
          "the new state is that\nof the world loaded with this seed. With a seed, the function raises "
          "RuntimeError if the run was resumed from a\ncheckpoint. Models, swarms, callbacks and "
          "subscriptions stay valid; a recording of record() is closed.")
      .def(
          "save", [](const Holder& held, const fs::path& checkpoint) { held->use().save(checkpoint); },
          py::arg("checkpoint"),
          "Saves the whole state in a checkpoint, an HDF5 file, from which resume() continues the run. An "
          "existing file is replaced\nwhen the new one is complete. Raises RuntimeError if the file cannot "
          "be written.")
      .def(
          "state_hash", [](const Holder& held) { return held->use().state_hash(); },
          "Returns a hash of the whole state, an integer of 64 bits. Equal states have equal hashes.")
      .def("hashes", &hashes_of,
           "Returns a dict with the hash of the whole state (\"state\") and the hashes of four groups of it: "
           "\"pose\",\n\"velocity\", \"sensor\" and \"memory\" (docs/determinism.md).")
      .def("statistics", &statistics_of,
           "Returns a dict of numbers that describe the run: robots (number in the world now), ticks "
           "(completed), time_s (world\ntime, s), beams (rays cast since tick 0), stalled (robots whose last "
           "motion was blocked or would have left the bounds),\nheld_at_bounds (those that would have left "
           "the bounds), mean_displacement_m (mean distance of the robots from their\nstart, m), "
           "conflict_rounds (rounds in which conflicting motions were resolved, since tick 0) and "
           "state_bytes (memory of\nthe state, bytes).")
      .def(
          "find",
          [](const Holder& held, const std::string& name) {
            return HeldModel{held, held->use().find(name)};
          },
          py::arg("name"),
          "Returns the model of this name: a body (\"r0\") or a part of one (\"r0.ranger:1\"). Raises "
          "LookupError, whose\ntext lists similar names, if there is none.")
      .def(
          "model",
          [](const Holder& held, std::uint32_t id) {
            return HeldModel{held, held->use().model(BodyId(id))};
          },
          py::arg("id"),
          "Returns the body with this id. Sensors and cast() report such ids. Raises LookupError if there is "
          "none.")
      .def("cast", &cast_one, py::arg("start"), py::arg("range_max"), py::kw_only(),
           py::arg("without") = py::none(),
           "Casts a ray and returns the first surface that it meets, computed by exact intersection. start: "
           "start and direction of\nthe ray, m and rad, in the world frame; the ray stays at the height "
           "start.z. range_max: length of the ray, m. without: a\nmodel; the ray passes through its body and "
           "through all bodies that move with this body (one carries the other, or a\nthird body carries "
           "both). The ray meets surfaces that rangers detect, nearer than range_max. Raises ValueError if "
           "a\nnumber is not finite, or if range_max is negative or above 300 km.")
      .def("cast_many", &cast_many, py::arg("starts").none(false), py::arg("range_max"), py::kw_only(),
           py::arg("without") = py::none(),
           "Casts n rays. starts: n x 4, x, y, z (m) and heading (rad) of each ray in the world frame; "
           "range_max and without are\nas in cast(). Returns two arrays: for each ray the distance at which "
           "it meets a surface, m (range_max if it meets\nnothing), and the id of the body that it meets "
           "(int64; -1 if it meets nothing). Raises ValueError as cast() does, and\nfor `starts` of another "
           "shape.")
      .def(
          "set_poses",
          [](const Holder& held, const std::vector<std::pair<HeldModel, Pose>>& poses) {
            std::vector<std::pair<Model, Pose>> placed;
            for (const auto& [model, pose] : poses) placed.emplace_back(model.model, pose);
            held->use().set_poses(placed);
          },
          py::arg("poses"),
          "Places many bodies at once. poses: pairs (model, pose in the world frame, m and rad). If a pose "
          "is not finite or outside\nthe bounds of the world, or if a body is carried by another body or not "
          "in the world, the function raises ValueError and\nmoves no body. Raises RuntimeError for parts of "
          "bodies, static geometry and models of another simulation.")
      .def(
          "record",
          [](const Holder& held, const fs::path& file, const std::vector<std::string>& fields, double every_s,
             bool replace) {
            held->use().record(file,
                               {fields, from_zero("every_s", every_s, engine::k_most_seconds), replace});
          },
          py::arg("file"), py::kw_only(), py::arg("fields") = py::tuple(), py::arg("every_s") = 0.0,
          py::arg("replace") = false,
          "Starts to record the run in an HDF5 file (docs/recordings.md), until stop_recording() or reset() "
          "is called or the\nSimulation object is deleted. fields: names of components of the state "
          "(\"pose\") or of fields of sensors (\"ranges\");\nevery_s: simulated time between two frames, s. "
          "Without fields, or without every_s, the value that the world file sets\nunder \"record\" is used. "
          "replace: whether an existing file is replaced. Raises InputError for an unknown field, for "
          "an\nexisting file without `replace`, and if the file cannot be written, and RuntimeError if a "
          "recording is already running.")
      .def(
          "stop_recording", [](const Holder& held) { held->use().stop_recording(); },
          "Closes the recording that record() started; all HDF5 tools can then read the file. Does nothing "
          "if no recording is\nrunning. Raises RuntimeError if the file cannot be written.")
      .def(
          "hash_log_header", [](const Holder& held) { return held->use().hash_log_header(); },
          "Returns the first lines of a hash log (a file with the state hashes of every tick), `# key: "
          "value`, which state the\nversion of Troupe and the options of the run.")
      .def(
          "hash_log_line", [](const Holder& held) { return held->use().hash_log_line(); },
          "Returns the line of a hash log for the current tick: the tick and its state hashes, `TICK STATE "
          "pose=... velocity=...\nsensor=... memory=...`, with hashes as 16 hexadecimal digits.")
      .def_property_readonly(
          "robot_names", [](const Holder& held) { return held->use().robot_names(); },
          "Names of all robots in the world, in the order of their ids.")
      .def(
          "subscribe", [](const Holder& held, const std::string& model) { held->use().subscribe(model); },
          py::arg("model"),
          "Makes all sensors of the body named `model` run. Without this call, a sensor does not run if no "
          "controller reads it and\nthe world file makes it inactive (\"active\": false in JSON, no "
          "`alwayson 1` in a .world file). Call it before the first\nstep: later calls raise RuntimeError. "
          "Raises LookupError for an unknown name.")
      .def("spawn", &spawn, py::arg("population"), py::arg("pose"),
           "Spawns a robot: places the next unborn body of a population's reserve (the bodies that are not "
           "in the world at the\nstart, docs/lives.md) at a pose in the world frame, m and rad. Returns the "
           "Model of the robot, or None if the place is\noccupied or outside the bounds of the world, or if "
           "the reserve is used up. Raises LookupError for a population without a\nreserve, and ValueError "
           "for a pose that is not finite.")
      .def(
          "unborn", [](const Holder& held, const std::string& p) { return held->use().unborn(p); },
          py::arg("population"),
          "Returns the number of bodies in the reserve of a population that spawn() can still add. Raises "
          "LookupError for a\npopulation without a reserve.")
      .def(
          "remove", [](const Holder& held, const HeldModel& model) { held->use().remove(model.model); },
          py::arg("model"),
          "Removes a body from the world for good; does nothing if the body is not in the world. Raises "
          "RuntimeError for a part of\na body, for static geometry, and if no body of the world can be "
          "removed: the world has no reserve, no device and no\nevent that removes bodies, and no "
          "\"mortal\": true.")
      .def(
          "set",
          [](const Holder& held, const std::string& type, const py::dict& setting) {
            held->use().set(type, json_of(setting));
          },
          py::arg("type"), py::arg("setting"),
          "Changes parameters of a type, for all its bodies: {\"drive\": {\"velocity_max_x_mps\": 0.5}}, "
          "{\"device\": {\"name\": \"eye\",\n...}} or {\"controller\": {\"kind\": \"wander\", ...}}, as "
          "\"set\" in the list \"at\" of a world file. The change lasts until\nreset(); checkpoints contain "
          "it. Raises ValueError, and changes nothing, if there is no such type or parameter, or if\nthe "
          "value is not allowed or cannot change during a run.")
      .def(
          "parameters",
          [](const Holder& held, const std::string& type) {
            return py::module_::import("json").attr("loads")(held->use().parameters(type));
          },
          py::arg("type"),
          "The present parameters of a type: a list of dicts of the form that set() takes, one for the drive "
          "and for each device\nand controller. Infinite values, and lists of objects such as transducers, "
          "are left out. Raises LookupError if there is\nno such type.")
      .def(
          "energy", [](const Holder& held) { return dict_of(held->use().energy()); },
          "The energies of all power packs as a dict with the keys of Model.energy(): sums, J; infinite and "
          "charging are True\nif they are True for one or more packs.")
      .def("snapshot", &snapshot, py::arg("file"), py::arg("width") = 1280, py::arg("height") = 720,
           py::kw_only(), py::arg("camera") = "top", py::arg("layers") = "", py::arg("center_m") = py::none(),
           py::arg("angle_rad") = py::none(), py::arg("across_m") = py::none(), py::arg("color_by") = "",
           py::arg("color_range") = py::none(), py::arg("background") = "paper",
           "Draws the world into a file, whose name must end in .png, .svg or .pdf; .svg and .pdf show the "
           "world only from straight\nabove. width and height are in pixels; docs/pictures.md describes the "
           "other options. Raises ValueError for a size below\n1 and for other numbers that cannot be drawn, "
           "InputError for\nunknown names, and RuntimeError if the file cannot be written or a library is "
           "missing.")
      .def(
          "picture", &picture, py::arg("width") = 1280, py::arg("height") = 720, py::kw_only(),
          py::arg("camera") = "top", py::arg("layers") = "", py::arg("center_m") = py::none(),
          py::arg("angle_rad") = py::none(), py::arg("across_m") = py::none(), py::arg("color_by") = "",
          py::arg("color_range") = py::none(), py::arg("background") = "paper",
          "Draws the world into an array: height x width x 3, uint8, RGB, row 0 on top. width and height "
          "are in pixels;\ndocs/pictures.md describes the other options. Raises ValueError for a size below "
          "1, for other numbers that\ncannot be drawn and for the background \"transparent\", InputError for "
          "unknown names, and RuntimeError\nif the library OSMesa is missing.");
  return simulation;
}

}  // namespace troupe::python
