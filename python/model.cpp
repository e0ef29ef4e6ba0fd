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

/// A value as an array of what a field of a command is made of. Refuses what that cannot hold.
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

/// All that is asked of the device, once `values` are.
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
  py::class_<Random>(module, "Random", "A sequence of random numbers.")
      .def(
          "uniform", [](Random& random, double low, double high) { return random.uniform(low, high); },
          py::arg("low") = 0.0, py::arg("high") = 1.0, "From low, and below high.")
      .def("normal", &Random::normal, "Of mean 0 and standard deviation 1.")
      .def("exponential", &Random::exponential, "Of mean 1.")
      .def(
          "below",
          [](Random& random, std::uint32_t n) {
            if (n == 0) throw py::value_error("no number is below 0");
            return random.below(n);
          },
          py::arg("n"), "A whole number from 0, and below n.");
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
  py::class_<HeldModel>(module, "Model", "A model of a simulation, found by its name.")
      .def_property_readonly("name", [](const HeldModel& m) { return m.model.name(); })
      .def_property_readonly("id", [](const HeldModel& m) { return m.model.id().value; })
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
          "estimate", [](HeldModel& m) { return m.use().estimate(); }, "Its estimated pose.")
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
      .def("readings", &readings, py::arg("field"), py::arg("device") = "",
           "A field of any sensor, or other device, not copied: the array shows new values after each step.\n"
           "Without a device's name that of the first that has such a field.")
      .def(
          "fields",
          [](HeldModel& m, const std::string& device) {
            const auto fields = m.use().fields(device);
            return std::vector<engine::StateField>(fields.begin(), fields.end());
          },
          py::arg("device"), "What readings() can tell of a device.")
      .def("command", &command, py::arg("device"),
           "Asks a device for something, by the names of its command: robot.command(\"lamp\", shows=1, "
           "red=1).\n"
           "Gives all that is asked of it now. It acts from the next step on.")
      .def(
          "random", [](HeldModel& m, const std::string& name) { return m.use().random(name); },
          py::arg("name"),
          "Its random numbers in this tick, of the seed, the name, the robot and the tick alone.")
      .def(
          "energy",
          [](HeldModel& m) -> py::object {
            if (const auto energy = m.use().energy()) return dict_of(*energy);
            return py::none();
          },
          "Of the pack that it runs on, J; None where it runs on none.")
      .def("flag_count", [](HeldModel& m) { return m.use().flag_count(); });
}

}  // namespace troupe::python
