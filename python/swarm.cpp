#include "troupe/swarm.hpp"

#include "python/bindings.hpp"
#include "python/columns.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::python {
namespace {

template <class Row>
py::array_t<double> rows_of(HeldSwarm& held, py::ssize_t columns, void (Swarm::*read)(std::span<Row>) const) {
  py::array_t<double> out({held.size(), columns});
  (held.use().*read)(elements<Row>(out));
  return out;
}

py::array_t<bool> flags_of(HeldSwarm& held, void (Swarm::*read)(std::span<std::uint8_t>) const) {
  py::array_t<bool> out(held.size());
  (held.use().*read)(elements<std::uint8_t>(out));
  return out;
}

py::array_t<std::int64_t> blocked_by(HeldSwarm& held) {
  const Swarm& swarm = held.use();
  std::vector<BodyId> bodies(swarm.size());
  swarm.blocked_by(bodies);
  return body_ids(bodies);
}

template <void (Swarm::*k_command)(std::span<const Model::Speed>, std::span<const std::uint8_t>)>
void command(HeldSwarm& held, const py::object& forward, const py::object& turn, const py::object& left,
             const Where& where) {
  Swarm& swarm = held.use();
  const std::size_t n = swarm.size();
  const Column f("forward", forward, n);
  const Column l("left", left, n);
  const Column t("turn", turn, n);
  std::vector<Model::Speed> speeds(n);
  for (std::size_t i = 0; i < n; ++i) speeds[i] = {f[i], l[i], t[i]};
  (swarm.*k_command)(speeds, mask_of(where, n));
}

void go_to(HeldSwarm& held, const py::object& x, const py::object& y, const py::object& heading,
           const Where& where) {
  Swarm& swarm = held.use();
  const std::size_t n = swarm.size();
  const Column xs("x", x, n);
  const Column ys("y", y, n);
  const Column headings("heading", heading, n);
  std::vector<Pose> goals(n);
  for (std::size_t i = 0; i < n; ++i) goals[i] = {xs[i], ys[i], 0, headings[i]};
  swarm.go_to(goals, mask_of(where, n));
}

void set_poses(HeldSwarm& held, const py::object& given, const Where& where) {
  constexpr std::string_view k_wanted = "x, y, z (m) and heading (rad) per robot";
  Swarm& swarm = held.use();
  const std::size_t n = swarm.size();
  const Numbers poses = numbers_of("poses", given, k_wanted);
  if (poses.ndim() != 2 || static_cast<std::size_t>(poses.shape(0)) != n || poses.shape(1) != 4)
    refuse("poses", poses, n, k_wanted);
  swarm.set_poses({reinterpret_cast<const Pose*>(poses.data()), n}, mask_of(where, n));
}

py::array readings_of(HeldSwarm& held, const std::string& field, const std::string& device) {
  const Swarm& swarm = held.use();
  py::array out = empty_rows(swarm.reading_field(field, device), held.size());
  swarm.readings(bytes_of(out), field, device);
  return out;
}

py::dict commands_of(HeldSwarm& held, const std::string& device) {
  const Swarm& swarm = held.use();
  py::dict all;
  for (const engine::StateField& field : swarm.command_fields(device)) {
    py::array out = empty_rows(field, held.size());
    swarm.commands(bytes_of(out), field.name, device);
    all[py::str(field.name)] = std::move(out);
  }
  return all;
}

/// Sets fields of the commands of a device; values: names of fields and their new values. Changes nothing if
/// a name or a value is invalid.
void command_device(HeldSwarm& held, const std::string& device, const Where& where,
                    const py::kwargs& values) {
  Swarm& swarm = held.use();
  const std::span<const engine::StateField> fields = swarm.command_fields(device);
  const std::vector<std::uint8_t> mask = mask_of(where, swarm.size());
  const CommandRows set = command_rows(fields, device, values, held.size(), mask);
  for (const auto& [field, rows] : set) {  // checks every device before the first change
    std::vector<std::byte> ignored(static_cast<std::size_t>(rows.nbytes()));
    swarm.commands(ignored, field->name, device);
  }
  for (const auto& [field, rows] : set) swarm.set_commands(const_bytes_of(rows), field->name, device, mask);
}

std::string radio_named(HeldSwarm& held, const std::string& name) {
  return name.empty() ? std::string(default_radio(held.use().devices_with_command(k_payload))) : name;
}

void say(HeldSwarm& held, const py::object& message, const std::string& device, const Where& where) {
  const std::string radio = radio_named(held, device);
  const py::dict values = message_command(held.use().command_fields(radio), radio, message, held.size());
  command_device(held, radio, where, py::reinterpret_borrow<py::kwargs>(values));
}

py::tuple heard(HeldSwarm& held, const py::object& type, const std::string& device) {
  const std::string radio = radio_named(held, device);
  return messages_of(type, radio, readings_of(held, "count", radio), readings_of(held, "length", radio),
                     readings_of(held, k_payload, radio));
}

using SwarmClass = py::class_<HeldSwarm>;

void bind_swarm_state(SwarmClass& type) {
  type.def(
          "alive", [](HeldSwarm& s) { return flags_of(s, &Swarm::alive); },
          "One bool per robot: whether it is in the world.")
      .def(
          "stalled", [](HeldSwarm& s) { return flags_of(s, &Swarm::stalled); },
          "One bool per robot: whether its motion in the last tick was blocked or would have left the bounds "
          "of the world.")
      .def("blocked_by", &blocked_by,
           "One int64 per robot: id of the body that blocked its motion, or one of its joints, in the last "
           "tick; "
           "-1 if no body did.\nRaises RuntimeError unless the world has \"contacts\": true "
           "(docs/driving.md).")
      .def(
          "poses", [](HeldSwarm& s) { return rows_of(s, 4, &Swarm::poses); },
          "Poses in the world frame, n x 4: x, y, z (m), heading (rad). Robots that were removed keep their "
          "last poses; all numbers\nare NaN for robots that are not yet born.")
      .def(
          "estimates", [](HeldSwarm& s) { return rows_of(s, 4, &Swarm::estimates); },
          "Estimated poses, n x 4: x, y, z (m), heading (rad). With the localization `gps` they are the true "
          "poses, with `odom` the\nodometry estimates, in the frame that Model.estimate() states. All "
          "numbers are 0 for robots that are not yet born.")
      .def(
          "speeds", [](HeldSwarm& s) { return rows_of(s, 3, &Swarm::speeds); },
          "Velocities that the drives computed in the last tick, in the body frame, n x 3: forward, left "
          "(m/s), turn (rad/s). An\nobstacle that blocks a motion does not change them.")
      .def(
          "ranges",
          [](HeldSwarm& s, const std::string& sensor) {
            Swarm& swarm = s.use();
            py::array_t<float> out({s.size(), static_cast<py::ssize_t>(swarm.beams(sensor))});
            swarm.ranges(elements<float>(out), sensor);
            return out;
          },
          py::arg("sensor") = "",
          "Ranges that the ranger named `sensor` of each robot measured, m: n x beams, float32. An empty "
          "name means the\nfirst ranger of each robot. Raises LookupError if a robot has no such ranger, "
          "ValueError if the numbers of beams\ndiffer between robots, and RuntimeError if a ranger does not "
          "run; call subscribe() before the first step.")
      .def(
          "bearings",
          [](HeldSwarm& s, const std::string& sensor) {
            const std::vector<double> bearings = s.use().bearings(sensor);
            return py::array_t<double>(static_cast<py::ssize_t>(bearings.size()), bearings.data());
          },
          py::arg("sensor") = "",
          "Headings of the beams of the ranger named `sensor` of the first robot, rad, in the frame of the "
          "ranger; they have the\norder of ranges(). An empty name means its first ranger. Raises "
          "LookupError if the first robot has no such ranger.")
      .def(
          "range_bound", [](HeldSwarm& s, const std::string& sensor) { return s.use().range_bound(sensor); },
          py::arg("sensor") = "",
          "An upper bound of the ranges of the ranger named `sensor` of the first robot, m: the largest "
          "range_max of its\ntransducers (fans of beams), plus the distances by which the ranger and these "
          "transducers are away from the origin of\nthe body. An empty name means its first ranger. Raises "
          "LookupError if the first robot has no such ranger.")
      .def(
          "subscribe", [](HeldSwarm& s) { s.use().subscribe(); },
          "Makes all sensors of the robots of this group run, also sensors that the world file makes "
          "inactive (see\nSimulation.subscribe()). Call it before the first step: later calls raise "
          "RuntimeError.");
}

void bind_swarm_commands(SwarmClass& type) {
  type.def("set_speeds", &command<&Swarm::set_speeds>, py::arg("forward"), py::arg("turn"), py::kw_only(),
           py::arg("left") = 0.0, py::arg("where") = py::none(),
           "Commands speeds in the body frame: forward and left in m/s, turn in rad/s (for a car drive: the "
           "steering angle, rad).\nThey apply from the next tick on, until another command replaces them.")
      .def("accelerate", &command<&Swarm::accelerate>, py::arg("forward"), py::arg("turn"), py::kw_only(),
           py::arg("left") = 0.0, py::arg("where") = py::none(),
           "Commands accelerations in the body frame: forward and left in m/s^2, turn in rad/s^2 (for a car "
           "drive: the steering\nangle, rad). They apply from the next tick on, until another command "
           "replaces them.")
      .def("go_to", &go_to, py::arg("x"), py::arg("y"), py::arg("heading"), py::kw_only(),
           py::arg("where") = py::none(),
           "Commands goal poses in the frame of estimates(), m and rad: the robots drive there and stay "
           "until another command\nreplaces this one.")
      .def("readings", &readings_of, py::arg("field"), py::arg("device") = "",
           "The values of a field of a sensor or another device, an array with the type of the field: shape "
           "(n,) or, if the field\nhas several columns, (n, columns). An empty `device` means the first "
           "device of each robot that has this field. `device`\nmay also be the memory of a controller, such "
           "as \"wander/0\". Raises LookupError, whose text lists the known names, for an\nunknown field or "
           "device, ValueError if the fields of the robots differ, and RuntimeError if a sensor does not "
           "run.")
      .def("commands", &commands_of, py::arg("device"),
           "The present commands of the device named `device` of each robot: a dict with one array per field "
           "of the command, of the\nshape that readings() returns. Raises LookupError if a robot has no "
           "device of this name that takes commands, ValueError\nif the fields of the robots differ, and "
           "RuntimeError for a swarm without robots.")
      .def("command", &command_device, py::arg("device"), py::kw_only(), py::arg("where") = py::none(),
           "Sets fields of the commands of a device by name: swarm.command(\"lamp\", shows=1, "
           "red=brightness). A value is one number\n"
           "for all robots or one per robot. For a field of several columns it is one row for all robots, "
           "one row per robot, or,\n"
           "for a field of bytes, a bytes, bytearray or memoryview object or a list of one such object per "
           "robot, padded with\n"
           "zeros. Other fields keep their values. The commands apply from the next step on. Raises "
           "LookupError for an unknown\n"
           "device or field, ValueError for values that do not fit and for NaN, and TypeError for texts.")
      .def("say", &say, py::arg("message"), py::arg("device") = "", py::kw_only(),
           py::arg("where") = py::none(),
           "Sets the messages that the radios named `device` send in each tick from the next one on, until "
           "another command\nreplaces them. An empty name means the radio called `radio` or, if the first "
           "robot has no such radio, its first radio.\nmessage: a bytes, bytearray or memoryview object, "
           "which is the message of all robots, a list of one such\nobject per robot, or an array with one "
           "row per robot, whose bytes are the message of the robot. command(device, mode=2)\nmakes radios "
           "silent. Raises ValueError for a message of more bytes than the parameter `payload` of the radios "
           "allows.")
      .def("heard", &heard, py::arg("dtype"), py::arg("device") = "",
           "The messages that the radios named `device` heard in the last tick, as two arrays of shape (n, "
           "most_heard): the messages\nas elements of the NumPy type `dtype`, and bools, True where there is "
           "a message of exactly the size of `dtype`. An empty\nname means the same radio as in say(). "
           "most_heard is a parameter of the radio. readings() returns the senders, ranges\nand bearings of "
           "the messages in the same order.")
      .def("set_poses", &set_poses, py::arg("poses"), py::kw_only(), py::arg("where") = py::none(),
           "Places the robots at poses in the world frame, n x 4: x, y, z (m), heading (rad). If the pose of "
           "a selected robot is not\nfinite or outside the bounds of the world, or if another body carries "
           "the robot, the function raises ValueError and\nmoves no robot.");
}

}  // namespace

void bind_swarm(py::module_& module, SimulationClass& simulation) {
  static_assert(sizeof(Pose) == 4 * sizeof(double) && sizeof(Model::Speed) == 3 * sizeof(double));
  SwarmClass swarm(
      module, "Swarm",
      "A group of n robots of one simulation, in ascending order of their ids. Most functions do for all "
      "robots, in one call,\nwhat the function of Model with the same name (in the singular) does for one "
      "robot. Except for bearings() and\nrange_bound(), which describe one ranger, functions that read "
      "values return them in new arrays with one row per robot,\nalso for robots that are not in the world. "
      "The functions with the parameter `where` command or place robots: `where`\nselects robots by one bool "
      "per robot; None selects all. These functions skip robots that are not in the world.\nset_speeds(), "
      "accelerate() and go_to() take one number for all robots or one number per robot. Arrays whose shape "
      "does\nnot fit, and numbers that are not finite, raise ValueError; texts raise TypeError.");
  swarm.def("__len__", [](const HeldSwarm& s) { return s.read().size(); })
      .def("__repr__", [](const HeldSwarm& s) { return fmt::format("<Swarm of {} robots>", s.swarm.size()); })
      .def_property_readonly("ids",
                             [](const HeldSwarm& s) {
                               py::array_t<std::uint32_t> out(s.size());
                               for (std::size_t i = 0; i < s.swarm.size(); ++i)
                                 out.mutable_at(i) = s.read().ids()[i].value;
                               return out;
                             })
      .def_property_readonly("names", [](const HeldSwarm& s) { return s.read().names(); })
      .def_property_readonly("tick", [](const HeldSwarm& s) { return s.read().tick(); })
      .def_property_readonly("time_s", [](const HeldSwarm& s) { return s.read().time_s(); })
      .def_property_readonly("types", [](const HeldSwarm& s) { return s.read().types(); });
  bind_swarm_state(swarm);
  bind_swarm_commands(swarm);

  simulation.def(
      "swarm",
      [](const Holder& held, const std::string& of) {
        return HeldSwarm{held, held->use().swarm(of)};
      },
      py::arg("of") = "",
      "Returns a group of robots. `of` names a type, a population or one robot; an empty name means all "
      "robots. Raises\nLookupError, whose text lists the known names, for an unknown name.");
  simulation.def(
      "swarm",
      [](const Holder& held, HeldModel& robot) {
        return HeldSwarm{held, held->use().swarm(robot.use())};
      },
      py::arg("of"),
      "Returns the group of one robot, also if a type or a population has its name. of: a Model. Raises "
      "LookupError if the\n"
      "model is not a robot, and RuntimeError for a model of another simulation.");
}

}  // namespace troupe::python
