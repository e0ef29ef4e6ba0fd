#include "python/robot_batch.hpp"

#include "base/diagnostics.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace troupe::python {
namespace {

/// Returns the value of a parameter of a controller. A list becomes a tuple.
py::object object_of(const engine::Value& value) {
  if (const auto* x = std::get_if<bool>(&value.v)) return py::bool_(*x);
  if (const auto* x = std::get_if<std::int64_t>(&value.v)) return py::int_(*x);
  if (const auto* x = std::get_if<double>(&value.v)) return py::float_(*x);
  if (const auto* x = std::get_if<std::string>(&value.v)) return py::str(*x);
  return py::tuple(py::cast(std::get<std::vector<double>>(value.v)));
}

}  // namespace

py::object RobotBatch::params() const {
  const std::vector<std::string>& names = prepared().controller->params;
  py::dict values;
  for (std::size_t i = 0; i < names.size(); ++i) values[py::str(names[i])] = object_of(prepared().params[i]);
  const py::object named = py::module_::import("troupe._script").attr("Parameters")(values);
  return py::module_::import("types").attr("MappingProxyType")(named);
}

std::size_t RobotBatch::device_named(const std::string& name, bool takes_commands) const {
  std::vector<std::string_view> known;
  for (std::size_t d = 0; d < devices().size(); ++d) {
    const UsedDevice& device = devices()[d];
    if (takes_commands && device.command.empty()) continue;
    if (device.name == name) return d;
    known.push_back(device.name);
  }
  throw std::out_of_range(
      unknown_name(takes_commands ? "device that takes commands" : "device", name, known));
}

py::array RobotBatch::readings(const std::string& field, const std::string& device) const {
  const auto field_in = [&field](const UsedDevice& of) { return engine::field_named(of.readings, field); };
  const std::size_t d =
      device.empty() ? static_cast<std::size_t>(std::ranges::find_if(devices(), field_in) - devices().begin())
                     : device_named(device, false);
  const engine::StateField* const found = d < devices().size() ? field_in(devices()[d]) : nullptr;
  if (found == nullptr) {
    std::vector<std::string_view> known;
    for (const UsedDevice& each : devices())
      if (device.empty() || each.name == device)
        for (const engine::StateField& other : each.readings) known.push_back(other.name);
    throw std::out_of_range(unknown_name("field", field, std::move(known)));
  }
  const auto f = static_cast<std::size_t>(found - devices()[d].readings.data());
  py::array out = empty_rows(*found, size());
  const std::span<std::byte> to = bytes_of(out);
  const std::size_t bytes = to.size() / std::max<std::size_t>(batch().size(), 1);
  for (std::size_t i = 0; i < batch().size(); ++i)
    std::memcpy(to.data() + i * bytes, batch().percepts[d]->cell<std::byte>(batch().slot(i), f).data(),
                bytes);
  return out;
}

std::size_t RobotBatch::ranger_named(const std::string& name) const {
  if (!name.empty()) return device_named(name, false);
  for (std::size_t d = 0; d < devices().size(); ++d)
    if (!devices()[d].bearings.empty()) return d;
  throw std::out_of_range(
      "the controller uses no ranger: the robots have no ranger, or `uses` does not list one");
}

std::string RobotBatch::radio_named(const std::string& name) const {
  if (!name.empty()) return name;
  std::vector<std::string_view> radios;
  for (const UsedDevice& device : devices())
    if (engine::field_named(device.command, k_payload) != nullptr) radios.push_back(device.name);
  return std::string(default_radio(radios));
}

py::array RobotBatch::ranges(const std::string& sensor) const {
  const UsedDevice& device = devices()[ranger_named(sensor)];
  const py::array all = readings("ranges", device.name);
  return all.ndim() > 1 ? all : py::array(all.attr("reshape")(-1, 1));
}

py::array_t<double> RobotBatch::bearings(const std::string& sensor) const {
  const std::vector<double>& bearings = devices()[ranger_named(sensor)].bearings;
  return py::array_t<double>(static_cast<py::ssize_t>(bearings.size()), bearings.data());
}

py::dict RobotBatch::commands(const std::string& device) const {
  const std::size_t d = device_named(device, true);
  py::dict all;
  for (const engine::StateField& field : devices()[d].command) {
    py::array out = empty_rows(field, size());
    const std::span<std::byte> to = bytes_of(out);
    const std::size_t bytes = to.size() / std::max<std::size_t>(batch().size(), 1);
    for (std::size_t i = 0; i < batch().size(); ++i)
      std::memcpy(to.data() + i * bytes, batch().device_command(d, i) + field.offset, bytes);
    all[py::str(field.name)] = std::move(out);
  }
  return all;
}

void RobotBatch::command(const std::string& device, const Where& where, const py::kwargs& values) const {
  const std::size_t d = device_named(device, true);
  const std::vector<engine::StateField>& fields = devices()[d].command;
  const std::vector<std::uint8_t> mask = mask_of(where, batch().size());
  for (const auto& [field, rows] : command_rows(fields, device, values, size(), mask)) {
    const std::span<const std::byte> from = const_bytes_of(rows);
    const std::size_t bytes = from.size() / std::max<std::size_t>(batch().size(), 1);
    for (std::size_t i = 0; i < batch().size(); ++i)
      if (mask.empty() || mask[i] != 0)
        std::memcpy(batch().device_command(d, i) + field->offset, from.data() + i * bytes, bytes);
  }
}

py::array_t<std::int64_t> RobotBatch::blocked_by() const {
  if (batch().size() > 0 && batch().contacts.empty()) engine::throw_no_contacts();
  std::vector<BodyId> bodies;
  for (std::size_t i = 0; i < batch().size(); ++i) bodies.push_back(batch().blocked_by(i).blocker());
  return body_ids(bodies);
}

template <engine::ControlMode k_mode>
void RobotBatch::drive(const py::object& x, const py::object& turn, const py::object& y,
                       const Where& where) const {
  const std::size_t n = batch().size();
  constexpr bool k_is_goal = k_mode == engine::ControlMode::position;
  const Column xs(k_is_goal ? "x" : "forward", x, n);
  const Column ys(k_is_goal ? "y" : "left", y, n);
  const Column turns(k_is_goal ? "heading" : "turn", turn, n);
  const std::vector<std::uint8_t> mask = mask_of(where, n);
  for (std::size_t i = 0; i < n; ++i) {
    if (!mask.empty() && mask[i] == 0) continue;
    for (const Column* column : {&xs, &ys, &turns}) column->check_finite(i);
    batch().command(i) = {xs[i], ys[i], turns[i], k_mode};
  }
}

void bind_robot_batch(py::module_& module) {
  py::class_<RobotBatch, std::shared_ptr<RobotBatch>>(
      module, "Robots",
      "The n robots for which a controller decides, in ascending order of their ids: the argument of "
      "decide(). Functions with\nthe name of a function of Swarm work as that function does, but only with "
      "the devices that the controller uses\n(Controller.uses). The object can be used only during the call "
      "of decide(); later calls raise RuntimeError.")
      .def("__len__", [](const RobotBatch& robots) { return robots.size(); })
      .def_property_readonly("ids", &RobotBatch::ids)
      .def_property_readonly("tick", [](const RobotBatch& robots) { return robots.batch().tick; })
      .def_property_readonly("time_s", [](const RobotBatch& robots) { return robots.batch().time_s; })
      .def_property_readonly("tick_s", [](const RobotBatch& robots) { return robots.batch().tick_s; })
      .def_property_readonly(
          "period_s", [](const RobotBatch& robots) { return robots.batch().period_s; },
          "Time from one decision of a robot to its next one, s.")
      .def_property_readonly(
          "memory", &RobotBatch::memory,
          "The memories of the robots: a structured array with one row per robot and the fields of "
          "Controller.memory. The next call\nof decide() finds the values that this call writes to the "
          "array. Raises AttributeError if the controller declares no\nmemory.")
      .def_property_readonly(
          "params", &RobotBatch::params,
          "The parameters of the controller (Controller.params): a mapping from names to values, which "
          "cannot be changed. Lists are\ntuples.")
      .def("estimates", &RobotBatch::estimates, "Estimated poses, n x 4: x, y, z (m), heading (rad).")
      .def("stalled", &RobotBatch::stalled, "As Swarm.stalled().")
      .def("blocked_by", &RobotBatch::blocked_by, "As Swarm.blocked_by().")
      .def("readings", &RobotBatch::readings, py::arg("field"), py::arg("device") = "",
           "The values of a field of a sensor or another device: shape (n,) or, if the field has several "
           "columns, (n, columns). An\nempty `device` means the first device that has this field. Raises "
           "LookupError for a field or device that does not exist\nor that the controller does not use.")
      .def("ranges", &RobotBatch::ranges, py::arg("sensor") = "",
           "Ranges that the ranger named `sensor` measured, m: n x beams, float32. An empty name means the "
           "first ranger. Raises\nLookupError if the controller uses no such ranger.")
      .def("bearings", &RobotBatch::bearings, py::arg("sensor") = "",
           "Headings of the beams of the ranger named `sensor`, rad, in the frame of the ranger. An empty "
           "name means the first\n"
           "ranger.")
      .def(
          "heard", &RobotBatch::heard, py::arg("dtype"), py::arg("device") = "",
          "The messages that the radios named `device` heard in this tick, as Swarm.heard() returns them. An "
          "empty name means the\nradio called `radio` or, without such a radio, the first radio.")
      .def("commands", &RobotBatch::commands, py::arg("device"),
           "The present commands of the device named `device`, as Swarm.commands() returns them: a dict with "
           "one array per field of\nthe command.")
      .def("command", &RobotBatch::command, py::arg("device"), py::kw_only(), py::arg("where") = py::none(),
           "Sets fields of the commands of the device named `device` by name, as Swarm.command() does.")
      .def("say", &RobotBatch::say, py::arg("message"), py::arg("device") = "", py::kw_only(),
           py::arg("where") = py::none(),
           "Sets the messages that the radios named `device` send, as Swarm.say() does. An empty name means "
           "the radio called `radio`\nor, without such a radio, the first radio.")
      .def("set_speeds", &RobotBatch::drive<engine::ControlMode::velocity>, py::arg("forward"),
           py::arg("turn"), py::kw_only(), py::arg("left") = 0.0, py::arg("where") = py::none(),
           "Commands speeds in the body frame, as Swarm.set_speeds() does: forward and left in m/s, turn in "
           "rad/s.")
      .def("accelerate", &RobotBatch::drive<engine::ControlMode::acceleration>, py::arg("forward"),
           py::arg("turn"), py::kw_only(), py::arg("left") = 0.0, py::arg("where") = py::none(),
           "Commands accelerations in the body frame, as Swarm.accelerate() does: forward and left in m/s^2, "
           "turn in rad/s^2.")
      .def("go_to", &RobotBatch::go_to, py::arg("x"), py::arg("y"), py::arg("heading"), py::kw_only(),
           py::arg("where") = py::none(), "Commands goal poses in the frame of estimates(), m and rad.")
      .def(
          "uniform",
          [](RobotBatch& robots, double low, double high) {
            return robots.drawn<double>([&](Random& random) { return random.uniform(low, high); });
          },
          py::arg("low") = 0.0, py::arg("high") = 1.0,
          "One uniformly distributed number in [low, high) per robot, float64; low if high is not above low. "
          "Each call takes the\nnext number of each robot's random stream of this tick, as a call of "
          "Random::uniform() in a controller in C++ does.")
      .def(
          "normal",
          [](RobotBatch& robots) {
            return robots.drawn<double>([](Random& random) { return random.normal(); });
          },
          "One normally distributed number with mean 0 and standard deviation 1 per robot, from the same "
          "streams as uniform().")
      .def(
          "exponential",
          [](RobotBatch& robots) {
            return robots.drawn<double>([](Random& random) { return random.exponential(); });
          },
          "One exponentially distributed number with mean 1 per robot, from the same streams as uniform().")
      .def(
          "below",
          [](RobotBatch& robots, std::uint32_t n) {
            if (n == 0) throw py::value_error("below(0): n must be 1 or more");
            return robots.drawn<std::uint32_t>([n](Random& random) { return random.below(n); });
          },
          py::arg("n"),
          "One uniformly distributed integer from 0 to n - 1 per robot, from the same streams as uniform(). "
          "Raises ValueError if n\nis 0.");
}

}  // namespace troupe::python
