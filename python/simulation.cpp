#include "base/diagnostics.hpp"
#include "engine/ticks.hpp"
#include "python/bindings.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace troupe::python {
namespace {

namespace fs = std::filesystem;
using Paths = std::vector<fs::path>;

/// A model with the simulation that it is of.
struct HeldModel {
  Holder held;
  Model model;

  Model& use() {
    static_cast<void>(held->use());
    return model;
  }
};

// ---- options

std::string json_of(const py::object& value, const py::object& indent = py::none()) {
  return py::module_::import("json")
      .attr("dumps")(value, py::arg("allow_nan") = false, py::arg("indent") = indent)
      .cast<std::string>();
}

/// JSON pointer -> value.
std::vector<std::pair<std::string, std::string>> settings_of(const std::optional<py::dict>& set) {
  std::vector<std::pair<std::string, std::string>> settings;
  if (set)
    for (const auto& [pointer, value] : *set)
      settings.emplace_back(pointer.cast<std::string>(), json_of(py::reinterpret_borrow<py::object>(value)));
  return settings;
}

/// A size for the only population, or name -> size.
using Robots = std::variant<std::monostate, std::size_t, py::dict>;

std::vector<std::pair<std::string, std::size_t>> robots_of(const Robots& robots) {
  if (const std::size_t* count = std::get_if<std::size_t>(&robots)) return {{"", *count}};
  std::vector<std::pair<std::string, std::size_t>> sizes;
  if (const py::dict* named = std::get_if<py::dict>(&robots))
    for (const auto& [name, count] : *named)
      sizes.emplace_back(name.cast<std::string>(), count.cast<std::size_t>());
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

using Seed = std::optional<std::uint64_t>;
using Text = std::optional<std::string>;
using Settings = std::optional<py::dict>;

SimulationOptions options_of(const Robots& robots, unsigned threads, const Seed& seed, const Text& ranging,
                             const Settings& set, Paths search_path, Paths plugin_path, double tile_size_m) {
  return {threads,
          tile_size_m,
          seed,
          ranging_of(ranging),
          robots_of(robots),
          settings_of(set),
          std::move(search_path),
          std::move(plugin_path)};
}

/// make(), without the interpreter's lock: worlds may take long to load.
template <class Make>
Holder hold(Make&& make) {
  const py::gil_scoped_release released;
  return std::make_shared<Held>(make());
}

Holder load(const std::variant<py::dict, fs::path>& world, const Robots& robots, unsigned threads,
            const Seed& seed, const Text& ranging, const Settings& set, const fs::path& name,
            Paths search_path, Paths plugin_path, double tile_size_m) {
  const SimulationOptions options = options_of(robots, threads, seed, ranging, set, std::move(search_path),
                                               std::move(plugin_path), tile_size_m);
  if (const fs::path* file = std::get_if<fs::path>(&world))
    return hold([&] { return Simulation(*file, options); });
  const std::string text = json_of(std::get<py::dict>(world), py::int_(1));
  return hold([&] { return Simulation::from_text(text, name, options); });
}

Holder from_text(const std::string& text, const fs::path& name, const Robots& robots, unsigned threads,
                 const Seed& seed, const Text& ranging, const Settings& set, Paths search_path,
                 Paths plugin_path, double tile_size_m) {
  const SimulationOptions options = options_of(robots, threads, seed, ranging, set, std::move(search_path),
                                               std::move(plugin_path), tile_size_m);
  return hold([&] { return Simulation::from_text(text, name, options); });
}

Holder resume(const fs::path& checkpoint, unsigned threads, const Settings& set, bool across_versions,
              Paths plugin_path, bool across_plugins, double tile_size_m) {
  const ResumeOptions options{
      threads, tile_size_m, settings_of(set), across_versions, std::move(plugin_path), across_plugins};
  return hold([&] { return Simulation::resume(checkpoint, options); });
}

// ---- the run

void run_for(const Holder& held, double seconds, const std::optional<py::function>& on_tick) {
  Simulation& simulation = held->use();
  if (!(seconds >= 0 && seconds <= 1e12)) simulation.run_for(seconds);  // says what is wrong with it
  std::uint64_t ticks = engine::ticks_until(seconds, simulation.tick_s());
  if (!on_tick) return held->step(ticks);
  const py::object self = py::cast(held);
  for (; ticks > 0; --ticks) {
    held->step(1);
    (*on_tick)(self);
  }
}

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

py::dict dict_of(const Model::Energy& energy) {
  using namespace py::literals;
  return py::dict("stored_j"_a = energy.stored_j, "capacity_j"_a = energy.capacity_j,
                  "dissipated_j"_a = energy.dissipated_j, "received_j"_a = energy.received_j,
                  "given_j"_a = energy.given_j, "infinite"_a = energy.infinite,
                  "charging"_a = energy.charging);
}

py::array_t<std::uint8_t> picture_of(const Holder& held, int width, int height) {
  const std::vector<std::uint8_t> rgb = held->use().picture(width, height);
  return py::array_t<std::uint8_t>({py::ssize_t{height}, py::ssize_t{width}, py::ssize_t{3}}, rgb.data());
}

std::optional<HeldModel> spawn(const Holder& held, const std::string& population, const Pose& pose) {
  std::optional<Model> born = held->use().spawn(population, pose);
  if (!born) return {};
  return HeldModel{held, std::move(*born)};
}

void bind_values(py::module_& module) {
  py::class_<Pose>(module, "Pose",
                   "m and rad; +x forward, +y left, headings counter-clockwise. Also as (x, y, heading).")
      .def(py::init([](double x, double y, double heading, double z) {
             return Pose{x, y, z, heading};
           }),
           py::arg("x") = 0.0, py::arg("y") = 0.0, py::arg("heading") = 0.0, py::arg("z") = 0.0)
      .def(py::init([](const py::tuple& three) {
             if (three.size() != 3)
               throw py::value_error(fmt::format("a pose of {} numbers: give (x, y, heading)", three.size()));
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

  py::class_<Model::Speed>(module, "Speed", "Of the last tick, body frame: m/s forward and left, rad/s.")
      .def_readonly("forward", &Model::Speed::forward)
      .def_readonly("left", &Model::Speed::left)
      .def_readonly("turn", &Model::Speed::turn)
      .def("__iter__",
           [](const Model::Speed& s) { return py::iter(py::make_tuple(s.forward, s.left, s.turn)); })
      .def("__repr__", [](const Model::Speed& s) {
        return fmt::format("Speed(forward={}, left={}, turn={})", s.forward, s.left, s.turn);
      });
}

void bind_model(py::module_& module) {
  py::class_<HeldModel>(module, "Model", "A model of a simulation, found by its name.")
      .def_property_readonly("name", [](const HeldModel& m) { return m.model.name(); })
      .def("__repr__", [](const HeldModel& m) { return fmt::format("<Model {}>", m.model.name()); })
      .def(
          "pose", [](HeldModel& m) { return m.use().pose(); }, "In the world's frame.")
      .def(
          "size",
          [](HeldModel& m) {
            const Eigen::Vector3d size = m.use().size();
            return py::make_tuple(size.x(), size.y(), size.z());
          },
          "As declared, m.")
      .def(
          "set_speed",
          [](HeldModel& m, double forward, double turn, double left) {
            m.use().set_speed(forward, left, turn);
          },
          py::arg("forward"), py::arg("turn"), py::kw_only(), py::arg("left") = 0.0,
          "m/s and rad/s, from the next tick on until replaced; a controller of the robot overrides it.")
      .def(
          "accelerate",
          [](HeldModel& m, double forward, double turn, double left) {
            m.use().accelerate(forward, left, turn);
          },
          py::arg("forward"), py::arg("turn"), py::kw_only(), py::arg("left") = 0.0, "m/s^2 and rad/s^2.")
      .def(
          "go_to", [](HeldModel& m, const Pose& goal) { m.use().go_to(goal); }, py::arg("goal"),
          "A goal in the frame of estimate(), where it then stays.")
      .def("speed", [](HeldModel& m) { return m.use().speed(); })
      .def("is_alive", [](HeldModel& m) { return m.use().is_alive(); })
      .def("stalled", [](HeldModel& m) { return m.use().stalled(); })
      .def(
          "estimate", [](HeldModel& m) { return m.use().estimate(); }, "Where it believes to be.")
      .def(
          "set_estimate", [](HeldModel& m, const Pose& pose) { m.use().set_estimate(pose); }, py::arg("pose"))
      .def(
          "set_pose", [](HeldModel& m, const Pose& pose) { m.use().set_pose(pose); }, py::arg("pose"),
          "Puts it elsewhere between two steps; nothing is asked of the place.")
      .def(
          "is_free", [](HeldModel& m, const Pose& pose) { return m.use().is_free(pose); }, py::arg("pose"))
      .def("sensors", [](HeldModel& m) { return m.use().sensors(); })
      .def(
          "ranges",
          [](HeldModel& m, const std::string& sensor) { return view(m.use().ranges(sensor), m.held); },
          py::arg("sensor") = "", "m, one a beam; not copied: the array shows new readings after each step.")
      .def(
          "intensities",
          [](HeldModel& m, const std::string& sensor) { return view(m.use().intensities(sensor), m.held); },
          py::arg("sensor") = "")
      .def(
          "energy",
          [](HeldModel& m) -> py::object {
            if (const auto energy = m.use().energy()) return dict_of(*energy);
            return py::none();
          },
          "Of the pack that it runs on, J; None where it runs on none.")
      .def("flag_count", [](HeldModel& m) { return m.use().flag_count(); });
}

}  // namespace

SimulationClass bind_simulation(py::module_& module) {
  bind_values(module);
  bind_model(module);
  SimulationClass simulation(module, "Simulation", "A world and its state. Of one thread at a time.");
  simulation
      .def(py::init(&load), py::arg("world"), py::kw_only(), py::arg("robots") = py::none(),
           py::arg("threads") = 0, py::arg("seed") = py::none(), py::arg("ranging") = py::none(),
           py::arg("set") = py::none(), py::arg("name") = "world.json", py::arg("search_path") = py::tuple(),
           py::arg("plugin_path") = py::tuple(), py::arg("tile_size_m") = 0.0,
           "Loads a world: a file, Stage's .world or JSON, or a dict as JSON would have it, whose relative "
           "paths count\n"
           "from the folder of `name`.")
      .def_static("from_text", &from_text, py::arg("text"), py::arg("name") = "world.json", py::kw_only(),
                  py::arg("robots") = py::none(), py::arg("threads") = 0, py::arg("seed") = py::none(),
                  py::arg("ranging") = py::none(), py::arg("set") = py::none(),
                  py::arg("search_path") = py::tuple(), py::arg("plugin_path") = py::tuple(),
                  py::arg("tile_size_m") = 0.0,
                  "Loads a world from its text, in the syntax that the ending of `name` says.")
      .def_static("resume", &resume, py::arg("checkpoint"), py::kw_only(), py::arg("threads") = 0,
                  py::arg("set") = py::none(), py::arg("across_versions") = false,
                  py::arg("plugin_path") = py::tuple(), py::arg("across_plugins") = false,
                  py::arg("tile_size_m") = 0.0, "Goes on from a checkpoint, with the same bits.")
      .def("__repr__",
           [](const Holder& held) {
             Simulation& s = held->use();
             return fmt::format("<Simulation \"{}\": {} robots, {:g} s>", s.title(), s.robots(), s.time_s());
           })
      .def_property_readonly("warnings", [](const Holder& held) { return held->use().warnings(); })
      .def_property_readonly("options",
                             [](const Holder& held) {
                               py::dict options;
                               for (const auto& [key, value] : held->use().effective_options())
                                 options[py::str(key)] = value;
                               return options;
                             })
      .def_property_readonly("time_s", [](const Holder& held) { return held->use().time_s(); })
      .def_property_readonly("tick", [](const Holder& held) { return held->use().tick(); })
      .def_property_readonly("tick_s", [](const Holder& held) { return held->use().tick_s(); })
      .def_property_readonly("robots", [](const Holder& held) { return held->use().robots(); })
      .def_property_readonly("title", [](const Holder& held) { return held->use().title(); })
      .def_property_readonly("threads", [](const Holder& held) { return held->use().threads(); })
      .def_property_readonly("quit_time_s", [](const Holder& held) { return held->use().quit_time_s(); })
      .def(
          "step", [](const Holder& held, std::uint64_t ticks) { held->step(ticks); }, py::arg("ticks") = 1,
          "So many ticks, without the interpreter's lock.")
      .def("run_for", &run_for, py::arg("seconds"), py::arg("on_tick") = py::none(),
           "Steps until so much world time has passed; calls on_tick(simulation) after each tick.")
      .def(
          "reset", [](const Holder& held) { held->use().reset(); }, "Back to tick 0, bit for bit.")
      .def(
          "save", [](const Holder& held, const fs::path& checkpoint) { held->use().save(checkpoint); },
          py::arg("checkpoint"))
      .def("state_hash", [](const Holder& held) { return held->use().state_hash(); })
      .def("hashes", &hashes_of, "state, and by group: pose, velocity, sensor, memory.")
      .def("statistics", &statistics_of)
      .def(
          "find",
          [](const Holder& held, const std::string& name) {
            return HeldModel{held, held->use().find(name)};
          },
          py::arg("name"))
      .def_property_readonly("robot_names", [](const Holder& held) { return held->use().robot_names(); })
      .def(
          "subscribe", [](const Holder& held, const std::string& model) { held->use().subscribe(model); },
          py::arg("model"), "Runs every sensor of a robot; before the first step.")
      .def("spawn", &spawn, py::arg("population"), py::arg("pose"),
           "Bears the next of a population's reserve; None where that place is taken, or nobody is left.")
      .def(
          "unborn", [](const Holder& held, const std::string& p) { return held->use().unborn(p); },
          py::arg("population"))
      .def(
          "remove", [](const Holder& held, const HeldModel& model) { held->use().remove(model.model); },
          py::arg("model"))
      .def("energy", [](const Holder& held) { return dict_of(held->use().energy()); })
      .def(
          "snapshot",
          [](const Holder& held, const fs::path& png, int width, int height) {
            held->use().snapshot(png, width, height);
          },
          py::arg("png"), py::arg("width") = 1280, py::arg("height") = 720)
      .def("picture", &picture_of, py::arg("width") = 1280, py::arg("height") = 720,
           "The world from above: height x width x 3, uint8.");
  return simulation;
}

}  // namespace troupe::python
