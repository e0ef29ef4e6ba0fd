#include "base/diagnostics.hpp"
#include "python/bindings.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <stdexcept>
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

/// A value as an array with the element type of a field of a command. Throws if the field cannot hold it.
py::array elements_of(const engine::StateField& field, const py::handle& value) {
  const py::module_ numpy = py::module_::import("numpy");
  const py::array given = numpy.attr("asarray")(value);
  py::array made =
      numpy.attr("ascontiguousarray")(given.attr("reshape")(-1).attr("astype")(dtype_of(field.element)));
  if (made.size() != static_cast<py::ssize_t>(field.columns))
    throw py::value_error(fmt::format("{} takes {} numbers, not {}", field.name, field.columns, made.size()));
  const bool is_whole = field.element != engine::Element::f64 && field.element != engine::Element::f32;
  if (is_whole && !numpy.attr("array_equal")(made, given.attr("reshape")(-1)).cast<bool>())
    throw py::value_error(fmt::format("{} is {}, which cannot be {}", field.name,
                                      engine::element_name(field.element), std::string(py::str(value))));
  return made;
}

/// Sets `values` in the command of the device. Returns the whole command.
py::dict command(HeldModel& m, const std::string& device, const py::kwargs& values) {
  const Model::Asked asked = m.use().asked(device);
  std::vector<std::pair<const engine::StateField*, py::array>> set;
  for (const auto& [key, value] : values) {
    const std::string name = key.cast<std::string>();
    const auto field = std::ranges::find(asked.fields, name, &engine::StateField::name);
    if (field == asked.fields.end()) {
      std::vector<std::string_view> known;
      for (const engine::StateField& each : asked.fields) known.push_back(each.name);
      throw std::out_of_range(
          unknown_name(fmt::format("command of \"{}\" of \"{}\"", device, m.model.name()), name, known));
    }
    set.emplace_back(&*field, elements_of(*field, value));
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
  py::class_<Random>(module, "Random", "A stream of random numbers.")
      .def(
          "uniform", [](Random& random, double low, double high) { return random.uniform(low, high); },
          py::arg("low") = 0.0, py::arg("high") = 1.0, "Uniform in [low, high).")
      .def("normal", &Random::normal, "Normal, with mean 0 and standard deviation 1.")
      .def("exponential", &Random::exponential, "Exponential, with mean 1.")
      .def(
          "below",
          [](Random& random, std::uint32_t n) {
            if (n == 0) throw py::value_error("below(0): give 1 or more");
            return random.below(n);
          },
          py::arg("n"), "A uniform integer from 0 to n - 1.");
}

}  // namespace

py::dict dict_of(const Model::Energy& energy) {
  using namespace py::literals;
  return py::dict("stored_j"_a = energy.stored_j, "capacity_j"_a = energy.capacity_j,
                  "dissipated_j"_a = energy.dissipated_j, "received_j"_a = energy.received_j,
                  "given_j"_a = energy.given_j, "infinite"_a = energy.infinite,
                  "charging"_a = energy.charging);
}

void bind_models(py::module_& module) {
  bind_random(module);
  py::class_<HeldModel>(module, "Model", "A model of a simulation: a body, or a part of one.")
      .def_property_readonly("name", [](const HeldModel& m) { return m.model.name(); })
      .def_property_readonly("id", [](const HeldModel& m) { return m.model.id().value; })
      .def("__repr__", [](const HeldModel& m) { return fmt::format("<Model {}>", m.model.name()); })
      .def(
          "pose", [](HeldModel& m) { return m.use().pose(); }, "Global pose, m and rad.")
      .def(
          "size",
          [](HeldModel& m) {
            const Eigen::Vector3d size = m.use().size();
            return py::make_tuple(size.x(), size.y(), size.z());
          },
          "Size as declared in the world, m.")
      .def(
          "set_speed",
          [](HeldModel& m, double forward, double turn, double left) {
            m.use().set_speed(forward, left, turn);
          },
          py::arg("forward"), py::arg("turn"), py::kw_only(), py::arg("left") = 0.0,
          "Commands speeds, m/s and rad/s, from the next tick on until replaced; a controller overrides "
          "them.")
      .def(
          "accelerate",
          [](HeldModel& m, double forward, double turn, double left) {
            m.use().accelerate(forward, left, turn);
          },
          py::arg("forward"), py::arg("turn"), py::kw_only(), py::arg("left") = 0.0,
          "Commands accelerations, m/s^2 and rad/s^2.")
      .def(
          "go_to", [](HeldModel& m, const Pose& goal) { m.use().go_to(goal); }, py::arg("goal"),
          "Commands a pose in the frame of estimate(): the robot drives there and stays.")
      .def(
          "speed", [](HeldModel& m) { return m.use().speed(); }, "Velocity of the last tick, body frame.")
      .def(
          "is_alive", [](HeldModel& m) { return m.use().is_alive(); }, "Whether it is in the world.")
      .def(
          "stalled", [](HeldModel& m) { return m.use().stalled(); }, "Whether its last motion was blocked.")
      .def(
          "estimate", [](HeldModel& m) { return m.use().estimate(); },
          "Estimated pose: the true one with gps, else the odometry estimate.")
      .def(
          "set_estimate", [](HeldModel& m, const Pose& pose) { m.use().set_estimate(pose); }, py::arg("pose"),
          "Overwrites the odometry estimate.")
      .def(
          "set_pose", [](HeldModel& m, const Pose& pose) { m.use().set_pose(pose); }, py::arg("pose"),
          "Moves it to a pose in the world's frame, between two steps; the place need not be free.")
      .def(
          "is_free", [](HeldModel& m, const Pose& pose) { return m.use().is_free(pose); }, py::arg("pose"),
          "Whether it would fit at this pose.")
      .def(
          "sensors", [](HeldModel& m) { return m.use().sensors(); }, "Names of its sensors.")
      .def(
          "ranges",
          [](HeldModel& m, const std::string& sensor) { return view(m.use().ranges(sensor), m.held); },
          py::arg("sensor") = "",
          "Readings of a ranger, m, one per beam. Not copied: the array shows new readings after each step.")
      .def(
          "intensities",
          [](HeldModel& m, const std::string& sensor) { return view(m.use().intensities(sensor), m.held); },
          py::arg("sensor") = "", "Intensities, one per value of ranges().")
      .def("readings", &readings, py::arg("field"), py::arg("device") = "",
           "A field of a sensor or another device. Not copied: the array shows new values after each step.\n"
           "Without `device`: of the first device that has this field.")
      .def(
          "fields",
          [](HeldModel& m, const std::string& device) {
            const auto fields = m.use().fields(device);
            return std::vector<engine::StateField>(fields.begin(), fields.end());
          },
          py::arg("device"), "The fields that readings() can return of a device.")
      .def("command", &command, py::arg("device"),
           "Sets fields of a device's command by name: robot.command(\"lamp\", shows=1, red=1). They take\n"
           "effect from the next step on. Returns the whole command as a dict.")
      .def(
          "random", [](HeldModel& m, const std::string& name) { return m.use().random(name); },
          py::arg("name"),
          "The random stream of this robot, name and tick; a function of these and the seed alone.")
      .def(
          "energy",
          [](HeldModel& m) -> py::object {
            if (const auto energy = m.use().energy()) return dict_of(*energy);
            return py::none();
          },
          "Energy of the power pack that supplies it, J; None if there is none.")
      .def(
          "flag_count", [](HeldModel& m) { return m.use().flag_count(); },
          "Number of flags that it holds itself.");
}

}  // namespace troupe::python
