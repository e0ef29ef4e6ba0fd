#include "python/bindings.hpp"
#include "python/columns.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <cstring>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace troupe::python {
namespace {

py::array readings(HeldModel& m, const std::string& field, const std::string& device) {
  const Model::Reading reading = m.use().reading(field, device);
  const py::dtype type = dtype_of(reading.field->element);
  return view(type, {static_cast<py::ssize_t>(reading.field->columns)}, {type.itemsize()},
              reading.bytes.data(), m.held);
}

/// Converts a value to an array with the element type of a field of a command. Throws ValueError if the value
/// has another number of elements than the field, or if the field has an integer type that cannot represent
/// the value.
py::array elements_of(const engine::StateField& field, const py::handle& value) {
  const py::module_ numpy = py::module_::import("numpy");
  const py::array given = numpy.attr("ascontiguousarray")(value).attr("reshape")(-1);
  if (given.size() != static_cast<py::ssize_t>(field.columns))
    throw py::value_error(
        fmt::format("\"{}\" takes exactly {} numbers, found {}", field.name, field.columns, given.size()));
  return converted(field, given, value);
}

/// Sets fields of the command of a device; values: names of fields and their new values. Returns all fields
/// of the command as a dict. Changes nothing if a name or a value is invalid.
py::dict command(HeldModel& m, const std::string& device, const py::kwargs& values) {
  const Model::Asked asked = m.use().asked(device);
  std::vector<std::pair<const engine::StateField*, py::array>> set;
  for (const auto& [key, value] : values) {
    const std::string name = key.cast<std::string>();
    const engine::StateField& field =
        command_field(asked.fields, name, fmt::format("device \"{}\" of \"{}\"", device, m.model.name()));
    set.emplace_back(&field, elements_of(field, value));
    refuse_nan(field, set.back().second);
  }
  for (const auto& [field, made] : set)
    std::memcpy(asked.bytes.data() + field->offset, made.data(), static_cast<std::size_t>(made.nbytes()));
  py::dict now;
  for (const engine::StateField& field : asked.fields) {
    const py::array shown(dtype_of(field.element), {static_cast<py::ssize_t>(field.columns)},
                          asked.bytes.data() + field.offset);
    const py::list values_now = shown.attr("tolist")();
    now[py::str(field.name)] = field.columns == 1 ? py::object(values_now[0]) : py::object(values_now);
  }
  return now;
}

void bind_random(py::module_& module) {
  py::class_<Random>(module, "Random", "A stream of random numbers, from Model.random().")
      .def(
          "uniform", [](Random& random, double low, double high) { return random.uniform(low, high); },
          py::arg("low") = 0.0, py::arg("high") = 1.0,
          "Returns a number that is uniformly distributed in [low, high). If high is not above low, returns "
          "low.")
      .def("normal", &Random::normal,
           "Returns a normally distributed number with mean 0 and standard deviation 1.")
      .def("exponential", &Random::exponential, "Returns an exponentially distributed number with mean 1.")
      .def(
          "below",
          [](Random& random, std::uint32_t n) {
            if (n == 0) throw py::value_error("below(0): n must be 1 or more");
            return random.below(n);
          },
          py::arg("n"),
          "Returns a uniformly distributed integer from 0 to n - 1. Raises ValueError if n is 0.");
}

}  // namespace

py::dict dict_of(const Model::Energy& energy) {
  using namespace py::literals;
  return py::dict("stored_j"_a = energy.stored_j, "capacity_j"_a = energy.capacity_j,
                  "dissipated_j"_a = energy.dissipated_j, "received_j"_a = energy.received_j,
                  "given_j"_a = energy.given_j, "infinite"_a = energy.infinite,
                  "charging"_a = energy.charging);
}

namespace {

using ModelClass = py::class_<HeldModel>;

void bind_model_motion(ModelClass& model) {
  model
      .def(
          "set_speed",
          [](HeldModel& m, double forward, double turn, double left) {
            m.use().set_speed(forward, left, turn);
          },
          py::arg("forward"), py::arg("turn"), py::kw_only(), py::arg("left") = 0.0,
          "Commands speeds in the body frame: forward and left in m/s, turn in rad/s (for a car drive: the "
          "steering angle, rad).\nThey apply from the next tick on, until another command replaces them. If "
          "the robot has a controller, its next\ndecision replaces them. Raises RuntimeError if "
          "the model has no drive or its body is not in the world, and\nValueError if a number is not "
          "finite.")
      .def(
          "accelerate",
          [](HeldModel& m, double forward, double turn, double left) {
            m.use().accelerate(forward, left, turn);
          },
          py::arg("forward"), py::arg("turn"), py::kw_only(), py::arg("left") = 0.0,
          "Commands accelerations in the body frame: forward and left in m/s^2, turn in rad/s^2 (for a car "
          "drive: the steering\nangle, rad). As with set_speed(), they apply from the next tick on, until "
          "another command replaces them. Raises the\nsame errors as set_speed().")
      .def(
          "go_to", [](HeldModel& m, const Pose& goal) { m.use().go_to(goal); }, py::arg("goal"),
          "Commands a goal pose in the frame of estimate(), m and rad: the robot drives there and stays "
          "until another command\nreplaces this one; goal.z is ignored. Raises the same errors as "
          "set_speed().")
      .def(
          "speed", [](HeldModel& m) { return m.use().speed(); },
          "Velocity that the drive of this model computed in the last tick, in the body frame, m/s and "
          "rad/s. An obstacle that\nblocks the motion does not change this velocity; see stalled().")
      .def(
          "is_alive", [](HeldModel& m) { return m.use().is_alive(); },
          "Whether the body is in the world: spawned or present from the start, and not removed. Static "
          "geometry is always in the\nworld.")
      .def(
          "stalled", [](HeldModel& m) { return m.use().stalled(); },
          "Whether the robot's motion in the last tick was blocked by an obstacle or would have left the "
          "bounds of the world.")
      .def(
          "blocked_by",
          [](HeldModel& m) -> py::object {
            const engine::Contact contact = m.use().blocked_by();
            if (contact.cause == engine::Contact::k_none) return py::none();
            const auto id = [](BodyId body) -> py::object {
              return body.valid() ? py::cast(body.value) : py::none();
            };
            return py::dict(py::arg("cause") = engine::Contact::k_causes.at(contact.cause),
                            py::arg("body") = id(contact.blocker()),
                            py::arg("behind") = id(contact.stopper()));
          },
          "What blocked the robot in the last tick: None, or a dict. Its \"cause\" is \"body\", \"pushed\" "
          "(a "
          "body that it pushes\ncannot go on), \"bounds\" or \"joint\"; \"body\" is the id of the body that "
          "blocked it, and \"behind\" that of the body that\nstops a pushed body; None if there is none. "
          "Raises "
          "RuntimeError unless the world has \"contacts\": true (docs/driving.md).")
      .def(
          "estimate", [](HeldModel& m) { return m.use().estimate(); },
          "Estimated pose, m and rad: with the localization `gps` the true pose, with `odom` the odometry "
          "estimate. The\nparameter `localization_origin` of the drive defines the frame; without it, this "
          "is the world frame for `gps`,\nand the frame of the robot's first pose for `odom`.")
      .def(
          "set_estimate", [](HeldModel& m, const Pose& pose) { m.use().set_estimate(pose); }, py::arg("pose"),
          "Overwrites the odometry estimate, m and rad, in the frame of estimate(). pose.z is ignored. "
          "Raises RuntimeError if the\nlocalization of the robot is not `odom` or if the robot is not in the "
          "world, and ValueError if a number is not\nfinite.")
      .def(
          "set_pose", [](HeldModel& m, const Pose& pose) { m.use().set_pose(pose); }, py::arg("pose"),
          "Places the body at a pose in the world frame, m and rad, between two steps. The place may overlap "
          "other bodies; see\nis_free(). Raises ValueError if the pose is not finite or is outside the "
          "bounds of the world, if another body carries\nthis one, or if this body is not in the world, and "
          "RuntimeError for a part of a body and for static geometry.")
      .def(
          "is_free", [](HeldModel& m, const Pose& pose) { return m.use().is_free(pose); }, py::arg("pose"),
          "Whether the body would fit at this pose in the world frame: its origin would be inside the bounds "
          "of the world, and\nthe body would not overlap a wall or another body that is an obstacle. Raises "
          "RuntimeError for a part of a body and\nfor static geometry.");
}

void bind_model_devices(ModelClass& model) {
  model
      .def(
          "sensors", [](HeldModel& m) { return m.use().sensors(); },
          "Names of the sensors of this model, in the order of the world file: for a body those of all its "
          "parts, for a part only\nits own.")
      .def(
          "ranges",
          [](HeldModel& m, const std::string& sensor) { return view(m.use().ranges(sensor), m.held); },
          py::arg("sensor") = "",
          "Ranges that the ranger named `sensor` measured, m, float32, one per beam; an empty name means the "
          "first ranger. The\narray is read-only and refers to the memory of the simulation: its content "
          "changes with each step. Raises LookupError if\nthere is no such ranger, and RuntimeError if the "
          "ranger does not run (see Simulation.subscribe()).")
      .def(
          "intensities",
          [](HeldModel& m, const std::string& sensor) { return view(m.use().intensities(sensor), m.held); },
          py::arg("sensor") = "",
          "Intensities that the ranger named `sensor` measured, float32, one per value of ranges(); empty "
          "unless the parameter\n`intensity` of the ranger is true. The array and the errors are as in "
          "ranges().")
      .def("readings", &readings, py::arg("field"), py::arg("device") = "",
           "The values of a field of a sensor or another device, an array of one dimension with the type of "
           "the field; an empty\n`device` means the first device that has this field. `device` may also be "
           "the memory of a controller, such as\n\"wander/0\". The array is read-only and refers to the "
           "memory of the simulation: its content changes with each step.\nRaises LookupError, whose text "
           "lists the known names, for an unknown field or device, and RuntimeError for a sensor\nthat does "
           "not run (see Simulation.subscribe()).")
      .def(
          "fields",
          [](HeldModel& m, const std::string& device) {
            const auto fields = m.use().fields(device);
            return std::vector<engine::StateField>(fields.begin(), fields.end());
          },
          py::arg("device"),
          "The fields of a device, or of the memory of a controller, that readings() can return: a list of "
          "Field, whose member\n`text` describes the field. Raises LookupError for an unknown device.")
      .def("command", &command, py::arg("device"),
           "Sets fields of the command of a device by name: robot.command(\"lamp\", shows=1, red=1). Other "
           "fields of the\ncommand keep their values. The command applies from the next step on. Returns the "
           "whole command as a dict.\nRaises LookupError for an unknown device or field, ValueError for NaN "
           "and for a value that the field cannot represent,\nTypeError for a text, and RuntimeError for a "
           "robot that is not in the world.")
      .def(
          "random", [](HeldModel& m, const std::string& name) { return m.use().random(name); },
          py::arg("name"),
          "Returns a random number stream that depends only on the seed of the simulation, `name`, the robot "
          "and the\ncurrent tick. A second call with this name in the same tick returns the same numbers: "
          "use one name per purpose.")
      .def(
          "energy",
          [](HeldModel& m) -> py::object {
            if (const auto energy = m.use().energy()) return dict_of(*energy);
            return py::none();
          },
          "Energy of the power pack that supplies this model, as a dict: stored_j and capacity_j (J); "
          "dissipated_j, received_j and\ngiven_j (J, sums since tick 0); infinite (whether the pack never "
          "becomes empty) and charging (whether it received energy\nin the last tick). None if there is no "
          "such pack.")
      .def(
          "flag_count", [](HeldModel& m) { return m.use().flag_count(); },
          "Number of flags (coloured tokens that bodies exchange, docs/energy.md) that the device of the "
          "kind `flags` on this part\nholds; 0 if the part has no such device. Devices on other parts of the "
          "body do not count.");
}

}  // namespace

void bind_models(py::module_& module) {
  bind_random(module);
  ModelClass model(
      module, "Model",
      "A model of a simulation: a body, or a part that is mounted on a body, such as a sensor. It keeps its "
      "simulation alive\nand stays valid after reset(). Poses are in m and rad. Two models are equal if they "
      "are the same body or part of one\nsimulation.");
  model.def_property_readonly("name", [](const HeldModel& m) { return m.model.name(); })
      .def_property_readonly("id", [](const HeldModel& m) { return m.model.id().value; })
      .def("__repr__", [](const HeldModel& m) { return fmt::format("<Model {}>", m.model.name()); })
      .def(
          "__eq__", [](const HeldModel& a, const HeldModel& b) { return a.model == b.model; },
          py::is_operator())
      .def("__hash__",
           [](const HeldModel& m) { return std::hash<const Held*>()(m.held.get()) + m.model.id().value; })
      .def(
          "pose", [](HeldModel& m) { return m.use().pose(); },
          "Pose in the world frame, m and rad. A body that was removed keeps its last pose; all numbers are "
          "NaN for a body that is\nnot yet born.")
      .def(
          "size",
          [](HeldModel& m) {
            const Eigen::Vector3d size = m.use().size();
            return py::make_tuple(size.x(), size.y(), size.z());
          },
          "The tuple (x, y, z): size as declared in the world file, m.");
  bind_model_motion(model);
  bind_model_devices(model);
}

}  // namespace troupe::python
