#include "base/diagnostics.hpp"
#include "engine/spec/ticks.hpp"
#include "python/bindings.hpp"
#include "python/columns.hpp"
#include "python/whole_numbers.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
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

py::array_t<std::uint8_t> picture_array(std::span<const std::uint8_t> rgb, const PictureOptions& options) {
  py::array_t<std::uint8_t> picture(
      {py::ssize_t{options.height}, py::ssize_t{options.width}, py::ssize_t{3}});
  std::ranges::copy(rgb, picture.mutable_data());
  return picture;
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

using PlacedModel = std::pair<HeldModel, Pose>;

std::vector<std::pair<Model, Pose>> models_of(const std::vector<PlacedModel>& given) {
  std::vector<std::pair<Model, Pose>> placed;
  for (const auto& [model, pose] : given) placed.emplace_back(model.model, pose);
  return placed;
}

void bind_properties(SimulationClass& simulation) {
  simulation
      .def_property_readonly(
          "warnings",
          [](const Holder& held) {
            py::list warnings;
            for (const std::string& warning : held->use().warnings()) warnings.append(decoded(warning));
            return warnings;
          },
          "Warnings about the world file, the checkpoint and plug-ins, one text each.")
      .def_property_readonly(
          "options",
          [](const Holder& held) {
            py::dict options;
            for (const auto& [key, value] : held->use().effective_options())
              options[decoded(key)] = decoded(value);
            return options;
          },
          "The options that the simulation uses (world, seed, threads, ...): a dict of texts, for logs.")
      .def_property_readonly(
          "time_s", [](const Holder& held) { return held->use().time_s(); }, "Simulated time, s.")
      .def_property_readonly(
          "tick", [](const Holder& held) { return held->use().tick(); }, "Number of completed ticks.")
      .def_property_readonly(
          "tick_s", [](const Holder& held) { return held->use().tick_s(); }, "Length of a tick, s.")
      .def_property_readonly(
          "robots", [](const Holder& held) { return held->use().robots(); },
          "Number of robots that are in the world now.")
      .def_property_readonly(
          "title", [](const Holder& held) { return decoded(held->use().title()); },
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
          "Tick of the checkpoint from which the run was resumed, or None.");
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

void step(const py::object& self, const py::object& ticks) {
  self.cast<Holder>()->use_outside("step()");
  advance(self, whole_number("ticks", ticks), false);
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
    const int is_done = PyObject_IsTrue(call(done, self).ptr());
    if (is_done < 0) throw py::error_already_set();  // an array of several elements is neither true nor false
    if (is_done > 0) return true;
  }
  return false;
}

py::object on_tick(const py::object& self, const py::object& callback) {
  self.cast<Holder>()->use_outside("on_tick()");
  if (!callback.is_none() && PyCallable_Check(callback.ptr()) == 0)
    throw py::type_error(fmt::format(
        "on_tick() takes a function, or None, which removes all callbacks; found {}", short_repr(callback)));
  py::list callbacks = callback.is_none() ? py::list() : callbacks_of(self);
  if (!callback.is_none()) callbacks.append(callback);
  py::setattr(self, k_callbacks, callbacks);
  return callback;
}

void bind_run(SimulationClass& simulation) {
  simulation
      .def("step", &step, py::arg("ticks") = 1,
           "Advances the simulation by this many ticks. Stop conditions of the world do not end the call. "
           "Other Python threads can\nrun meanwhile, because the interpreter's lock is released. Raises "
           "StepError if a tick fails, and RuntimeError in a\ncallback of on_tick().")
      .def("run_for", &run_for, py::arg("seconds"), py::arg("on_tick") = py::none(),
           "Steps until `seconds` more of simulated time have passed, or until a condition of `stop_when` in "
           "the world file ends the\nrun. If the callback on_tick is given, it is called as "
           "on_tick(simulation) "
           "after each tick. Raises ValueError if\n`seconds` is negative, NaN or above 1e12.")
      .def("run_until", &run_until, py::arg("done"), py::arg("at_most_s"),
           "Steps until the callback done(simulation), which is called after each step, returns a true "
           "value. Returns True in this\n"
           "case, and False if `at_most_s` seconds of simulated time pass first or a condition of "
           "`stop_when` in the world file\n"
           "ends the run first. Raises ValueError if `at_most_s` is negative, NaN or above 1e12.")
      .def("on_tick", &on_tick, py::arg("callback").none(true),
           "Adds a callback: callback(simulation) is called at the end of every step, after the recording of "
           "record() has received\nthe tick. None removes all callbacks. A callback may do everything that a "
           "program may do between two steps, except\ncalls of step(), run_for(), run_until(), reset() and "
           "on_tick(), which raise RuntimeError. An exception in a callback\nends the step and reaches the "
           "caller of the step. on_tick() returns the callback, so it can be used as a "
           "decorator:\n@simulation.on_tick.")
      .def(
          "reset",
          [](const Holder& held, const py::object& seed, const std::vector<PlacedModel>& starts) {
            static_cast<void>(held->use_outside("reset()"));
            const std::optional<std::uint64_t> given = optional_seed_of(seed);
            const std::vector<std::pair<Model, Pose>> placed = models_of(starts);
            held->work([&](Simulation& used) {
              if (given || !placed.empty())
                used.reset(given.value_or(used.seed()), placed);
              else
                used.reset();
            });
          },
          py::arg("seed") = py::none(), py::arg("starts") = py::tuple(),
          "Resets the simulation to tick 0 and to its state after loading, bit for bit. If `seed` is given, "
          "the new state is that\nof the world loaded with this seed. With a seed, the function raises "
          "RuntimeError if the run was resumed from a\ncheckpoint. Models, swarms, callbacks and "
          "subscriptions stay valid; a recording of record() is closed.\n\nstarts: pairs (model, pose in the "
          "world frame, m and rad) of models that begin at these poses instead of the places that\nthe world "
          "gives them. A later reset() without arguments returns to these poses. Raises ValueError for a "
          "pose "
          "that is not\nfinite or outside the bounds of the world, and for a body that is not in the world "
          "at "
          "the start, and RuntimeError for\nparts of bodies, for models of another simulation, and as for a "
          "seed. Nothing changes then.");
}

// ---- the state and its recording

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

void bind_state(SimulationClass& simulation) {
  simulation
      .def(
          "save",
          [](const Holder& held, const fs::path& checkpoint) {
            held->work([&](const Simulation& own) { own.save(checkpoint); });
          },
          py::arg("checkpoint"),
          "Saves the whole state in a checkpoint, an HDF5 file, from which resume() continues the run. An "
          "existing file is replaced\nwhen the new one is complete. Raises RuntimeError if the file cannot "
          "be written, and InputError if the ending of its\nname is that of another format than HDF5, such "
          "as .csv.")
      .def(
          "state_hash", [](const Holder& held) { return held->use().state_hash(); },
          "Returns a hash of the whole state, an integer of 64 bits. Equal states have equal hashes.")
      .def("hashes", &hashes_of,
           "Returns a dict with the hash of the whole state (\"state\") and the hashes of four groups of it: "
           "\"pose\",\n\"velocity\", \"sensor\" and \"memory\" (docs/determinism.md).")
      .def(
          "hash_log_header", [](const Holder& held) { return decoded(held->use().hash_log_header()); },
          "Returns the first lines of a hash log (a file with the state hashes of every tick), `# key: "
          "value`, which state the\nversion of Troupe and the options of the run.")
      .def(
          "hash_log_line", [](const Holder& held) { return held->use().hash_log_line(); },
          "Returns the line of a hash log for the current tick: the tick and its state hashes, `TICK STATE "
          "pose=... velocity=...\nsensor=... memory=...`, with hashes as 16 hexadecimal digits.")
      .def("statistics", &statistics_of,
           "Returns a dict of numbers that describe the run: robots (number in the world now), ticks "
           "(completed), time_s (simulated\ntime, s), beams (rays cast since tick 0), stalled (robots whose "
           "last motion was blocked or would have left the bounds),\nheld_at_bounds (those that would have "
           "left the bounds), mean_displacement_m (mean distance of the robots from their\nstart, m), "
           "conflict_rounds (rounds in which conflicting motions were resolved, since tick 0) and "
           "state_bytes (memory of\nthe state, bytes).")
      .def(
          "energy", [](const Holder& held) { return dict_of(held->use().energy()); },
          "The energies of all power packs as a dict with the keys of Model.energy(): sums, J; infinite and "
          "charging are True\nif they are True for one or more packs.");
}

void bind_recording(SimulationClass& simulation) {
  simulation
      .def(
          "record",
          [](const Holder& held, const fs::path& file, const std::vector<std::string>& fields, double every_s,
             bool replace) {
            const RecordingOptions options{fields, from_zero("every_s", every_s, engine::k_most_seconds),
                                           replace};
            held->work([&](Simulation& own) { own.record(file, options); });
          },
          py::arg("file"), py::kw_only(), py::arg("fields") = py::tuple(), py::arg("every_s") = 0.0,
          py::arg("replace") = false,
          "Starts to record the run in an HDF5 file (docs/recordings.md), until stop_recording() or reset() "
          "is called or the\nSimulation object is deleted. fields: names of components of the state "
          "(\"pose\") or of fields of sensors (\"ranges\");\nevery_s: simulated time between two frames, s. "
          "Without fields, or without every_s, the value that the world file sets\nunder \"record\" is used. "
          "replace: whether an existing file is replaced. Raises InputError for an unknown field, for "
          "an\nexisting file without `replace`, for an ending of another format than HDF5, such as .csv, and "
          "if the file cannot be\nwritten, and RuntimeError if a recording is already running.")
      .def(
          "stop_recording",
          [](const Holder& held) { held->work([](Simulation& own) { own.stop_recording(); }); },
          "Closes the recording that record() started; all HDF5 tools can then read the file. Does nothing "
          "if no recording is\nrunning. Raises RuntimeError if the file cannot be written.");
}

// ---- bodies

std::optional<HeldModel> spawn(const Holder& held, const std::string& population, const Pose& pose) {
  std::optional<Model> born = held->use().spawn(population, pose);
  if (!born) return {};
  return HeldModel{held, std::move(*born)};
}

void bind_bodies(SimulationClass& simulation) {
  simulation
      .def(
          "find",
          [](const Holder& held, const std::string& name) {
            return HeldModel{held, held->use().find(name)};
          },
          py::arg("name"),
          "Returns the model of this name: a body (\"r0\") or a part of one (\"r0.ranger:1\"). Raises "
          "LookupError, whose text lists\n"
          "similar names, if there is none.")
      .def(
          "model",
          [](const Holder& held, std::uint32_t id) {
            return HeldModel{held, held->use().model(BodyId(id))};
          },
          py::arg("id"),
          "Returns the body with this id. Sensors and cast() report such ids. Raises LookupError if there is "
          "none.")
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
      .def(
          "set_poses",
          [](const Holder& held, const std::vector<PlacedModel>& poses) {
            held->use().set_poses(models_of(poses));
          },
          py::arg("poses"),
          "Places many bodies at once. poses: pairs (model, pose in the world frame, m and rad). If a pose "
          "is not finite or outside\nthe bounds of the world, or if a body is carried by another body or not "
          "in the world, the function raises ValueError and\nmoves no body. Raises RuntimeError for parts of "
          "bodies, static geometry and models of another simulation.")
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
          "removed: the world has no reserve, no device and no\nintervention that removes bodies, and no "
          "\"mortal\": true.")
      .def(
          "set",
          [](const Holder& held, const std::string& type, const py::dict& setting) {
            held->use().set(type, json_of(setting));
          },
          py::arg("type"), py::arg("setting"),
          "Changes parameters of a type, for all its bodies: {\"drive\": {\"velocity_max_x_mps\": 0.5}}, "
          "{\"device\": {\"name\": \"eye\",\n...}} or {\"controller\": {\"kind\": \"wander\", ...}}, as "
          "\"set\" in the list \"at\" of a world file. The change lasts until\nreset(). Checkpoints contain "
          "it: after reset() of a run that is resumed from such a checkpoint, it is made again at the\nsame "
          "time. Raises ValueError, and changes nothing, if there is no such type or parameter, or if the "
          "value is not\nallowed or cannot change during a run.")
      .def(
          "parameters",
          [](const Holder& held, const std::string& type) {
            return py::module_::import("json").attr("loads")(held->use().parameters(type));
          },
          py::arg("type"),
          "The present parameters of a type: a list of dicts of the form that set() takes, one for the drive "
          "and for each device\nand controller. Infinite values, and lists of objects such as transducers, "
          "are left out. Raises LookupError if there is\nno such type.");
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

/// Casts many rays. given: one row (x, y, z, heading) per ray, m and rad. Returns two arrays: the distance at
/// which each ray meets a surface, m, and the id of the body, or -1 if it meets nothing.
py::tuple cast_many(const Holder& held, const py::object& given, double range_max, HeldModel* without) {
  constexpr std::string_view k_wanted = "an array of n x 4: x, y, z (m) and heading (rad) of each ray";
  const Numbers starts = numbers_of("starts", given, k_wanted);
  if (starts.ndim() != 2 || starts.shape(1) != 4)
    throw py::value_error(
        fmt::format("starts has shape {}; give {}", std::string(py::str(starts.attr("shape"))), k_wanted));
  const Model* passes = without != nullptr ? &without->use() : nullptr;
  py::array_t<double> ranges(starts.shape(0));
  py::array_t<std::int64_t> bodies(starts.shape(0));
  const double* start = starts.data();
  const std::span<double> range = elements<double>(ranges);
  const std::span<std::int64_t> body = elements<std::int64_t>(bodies);
  held->work([&](const Simulation& simulation) {
    for (std::size_t i = 0; i < range.size(); ++i, start += 4) {
      if (!std::all_of(start, start + 4, [](double number) { return std::isfinite(number); }))
        throw std::invalid_argument(fmt::format("row {} of starts is {}, {}, {}, {}: give finite numbers", i,
                                                start[0], start[1], start[2], start[3]));
      const RayHit hit = simulation.cast({start[0], start[1], start[2], start[3]}, range_max, passes);
      range[i] = hit.range_m;
      body[i] = hit.met() ? std::int64_t{hit.body.value} : -1;
    }
  });
  return py::make_tuple(ranges, bodies);
}

void bind_rays(py::module_& module, SimulationClass& simulation) {
  py::class_<Hit>(module, "Hit",
                  "The first surface that a ray meets. range_m: distance to the surface, m; the length of "
                  "the ray if it met nothing. body:\nid of the body, or None if the ray met nothing. part: "
                  "index of the part of the body; 0: the body itself. met(): whether\nthe ray met a surface.")
      .def_readonly("range_m", &Hit::range_m)
      .def_readonly("body", &Hit::body)
      .def_readonly("part", &Hit::part)
      .def("met", [](const Hit& hit) { return hit.body.has_value(); })
      .def("__repr__",
           [](const Hit& hit) {
             return hit.body ? fmt::format("<Hit of body {} after {:g} m>", *hit.body, hit.range_m)
                             : std::string("<Hit of nothing>");
           })
      .def(py::pickle([](const Hit& hit) { return py::make_tuple(hit.range_m, hit.body, hit.part); },
                      [](const py::tuple& state) {
                        return Hit{state[0].cast<double>(), state[1].cast<std::optional<std::uint32_t>>(),
                                   state[2].cast<std::uint32_t>()};
                      }));
  simulation
      .def("cast", &cast_one, py::arg("start"), py::arg("range_max"), py::kw_only(),
           py::arg("without") = py::none(),
           "Casts a ray and returns the first surface that it meets, computed by exact intersection. start: "
           "start and direction of\nthe ray, m and rad, in the world frame; the ray stays at the height "
           "start.z. range_max: length of the ray, m. without: a\nmodel; the ray passes through its body and "
           "through all bodies that move with this body (one carries the other, or a\nthird body carries "
           "both). The ray meets surfaces that rangers detect, nearer than range_max. Raises ValueError if "
           "a\nnumber is not finite, or if range_max is negative or above 300 km.")
      .def("cast_many", &cast_many, py::arg("starts"), py::arg("range_max"), py::kw_only(),
           py::arg("without") = py::none(),
           "Casts n rays. starts: n x 4, x, y, z (m) and heading (rad) of each ray in the world frame; "
           "range_max and without are\nas in cast(). Returns two arrays: for each ray the distance at which "
           "it meets a surface, m (range_max if it meets\nnothing), and the id of the body that it meets "
           "(int64; -1 if it meets nothing). Raises ValueError as cast() does, and\nfor `starts` of another "
           "shape.");
}

// ---- pictures

void snapshot(const Holder& held, const fs::path& file, const PictureOptions& options) {
  held->work([&](const Simulation& simulation) { simulation.snapshot(file, options); });
}

py::array_t<std::uint8_t> picture(const Holder& held, const PictureOptions& options) {
  std::vector<std::uint8_t> bytes;
  held->work([&](const Simulation& simulation) { bytes = simulation.picture(options); });
  return picture_array(bytes, options);
}

void bind_pictures(SimulationClass& simulation) {
  with_look([&](const auto&... look) {
    simulation
        .def("snapshot", drawing<const Holder&, const fs::path&>(&snapshot), py::arg("file"),
             py::arg("width") = 1280, py::arg("height") = 720, look...,
             "Draws the world into a file, whose name must end in .png, .svg or .pdf; .svg and .pdf show the "
             "world only from\n"
             "straight above. width and height are in pixels; docs/pictures.md describes the other options. "
             "Raises ValueError for a\n"
             "size below 1 and for other numbers that cannot be drawn, InputError for unknown names, and "
             "RuntimeError if the file\n"
             "cannot be written or a library is missing.")
        .def(
            "picture", drawing<const Holder&>(&picture), py::arg("width") = 1280, py::arg("height") = 720,
            look...,
            "Draws the world into an array: height x width x 3, uint8, RGB, row 0 on top. width and height "
            "are in pixels;\n"
            "docs/pictures.md describes the other options. Raises ValueError for a size below 1, for other "
            "numbers that cannot be\n"
            "drawn and for the background \"transparent\", InputError for unknown names, and RuntimeError if "
            "the libraries OSMesa\n"
            "and EGL are missing.");
  });
}

// ---- poses and speeds

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
             try {
               return Pose{three[0].cast<double>(), three[1].cast<double>(), 0, three[2].cast<double>()};
             } catch (const py::cast_error&) {
               throw py::type_error(
                   fmt::format("x_y_heading: found {}: give three numbers", std::string(py::repr(three))));
             }
           }),
           py::arg("x_y_heading"))
      .def_readwrite("x", &Pose::x)
      .def_readwrite("y", &Pose::y)
      .def_readwrite("z", &Pose::z)
      .def_readwrite("heading", &Pose::heading)
      .def("__iter__", [](const Pose& p) { return py::iter(py::make_tuple(p.x, p.y, p.heading)); })
      .def(
          "__eq__", [](const Pose& a, const Pose& b) { return a == b; }, py::is_operator())
      .def("__repr__",
           [](const Pose& p) {
             return fmt::format("Pose(x={}, y={}, heading={}, z={})", p.x, p.y, p.heading, p.z);
           })
      .def(py::pickle([](const Pose& p) { return py::make_tuple(p.x, p.y, p.z, p.heading); },
                      [](const py::tuple& state) {
                        return Pose{state[0].cast<double>(), state[1].cast<double>(), state[2].cast<double>(),
                                    state[3].cast<double>()};
                      }));
  py::implicitly_convertible<py::tuple, Pose>();

  py::class_<Model::Speed>(module, "Speed",
                           "A velocity in the body frame: forward and left in m/s, turn in rad/s. It can be "
                           "unpacked: forward, left, turn =\nspeed.")
      .def_readonly("forward", &Model::Speed::forward)
      .def_readonly("left", &Model::Speed::left)
      .def_readonly("turn", &Model::Speed::turn)
      .def("__iter__",
           [](const Model::Speed& s) { return py::iter(py::make_tuple(s.forward, s.left, s.turn)); })
      .def("__repr__",
           [](const Model::Speed& s) {
             return fmt::format("Speed(forward={}, left={}, turn={})", s.forward, s.left, s.turn);
           })
      .def(py::pickle(
          [](const Model::Speed& s) { return py::make_tuple(s.forward, s.left, s.turn); },
          [](const py::tuple& state) {
            return Model::Speed{state[0].cast<double>(), state[1].cast<double>(), state[2].cast<double>()};
          }));
}

}  // namespace

SimulationClass bind_simulation(py::module_& module) {
  bind_values(module);
  bind_models(module);
  SimulationClass simulation(module, "Simulation",
                             "A world and its state. Only one thread at a time may use a simulation: calls "
                             "from another thread during a step raise\nRuntimeError. After a StepError, "
                             "functions that read or change the state raise RuntimeError until reset().",
                             py::dynamic_attr());
  module.def("_seed_of", &seed_of, py::arg("seed"));
  bind_loading(simulation);
  bind_properties(simulation);
  bind_run(simulation);
  bind_state(simulation);
  bind_bodies(simulation);
  bind_rays(module, simulation);
  bind_recording(simulation);
  bind_pictures(simulation);
  return simulation;
}

}  // namespace troupe::python
