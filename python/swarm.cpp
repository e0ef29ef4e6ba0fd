#include "troupe/swarm.hpp"

#include "python/bindings.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace troupe::python {
namespace {

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

struct HeldSwarm {
  Holder held;
  Swarm swarm;

  Swarm& use() {
    static_cast<void>(held->use());
    return swarm;
  }
  py::ssize_t size() const { return static_cast<py::ssize_t>(swarm.size()); }
};

[[noreturn]] void refuse(std::string_view name, const py::array& given, std::size_t robots,
                         std::string_view wanted) {
  throw py::value_error(fmt::format("{} has shape {}; for a swarm of {} robots give {}", name,
                                    std::string(py::str(given.attr("shape"))), robots, wanted));
}

/// An argument of a command for a swarm, which is one number for all robots or one number per robot. Element
/// i is the number of robot i.
class Column {
 public:
  Column(std::string_view name, const Numbers& numbers, std::size_t robots)
      : first_(numbers.data()), step_(numbers.ndim() == 0 ? 0 : 1) {
    if (numbers.ndim() > 1 || (numbers.ndim() == 1 && static_cast<std::size_t>(numbers.size()) != robots))
      refuse(name, numbers, robots, "one number, or one for each");
  }
  double operator[](std::size_t i) const { return first_[i * step_]; }

 private:
  const double* first_;
  std::size_t step_;
};

/// Converts the argument `where` of a command to the form of Swarm: one byte per robot, 0 skips the robot;
/// empty: all robots.
std::vector<std::uint8_t> mask_of(const std::optional<py::array>& where, std::size_t robots) {
  if (!where) return {};
  if (where->dtype().kind() != 'b' || where->ndim() != 1 || static_cast<std::size_t>(where->size()) != robots)
    refuse(fmt::format("where, of {},", std::string(py::str(where->dtype()))), *where, robots,
           "one bool for each");
  const py::array_t<bool, py::array::c_style | py::array::forcecast> marks(*where);
  return {marks.data(), marks.data() + marks.size()};
}

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

using Where = std::optional<py::array>;

template <void (Swarm::*k_command)(std::span<const Model::Speed>, std::span<const std::uint8_t>)>
void command(HeldSwarm& held, const Numbers& forward, const Numbers& turn, const Numbers& left,
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

void go_to(HeldSwarm& held, const Numbers& x, const Numbers& y, const Numbers& heading, const Where& where) {
  Swarm& swarm = held.use();
  const std::size_t n = swarm.size();
  const Column xs("x", x, n);
  const Column ys("y", y, n);
  const Column headings("heading", heading, n);
  std::vector<Pose> goals(n);
  for (std::size_t i = 0; i < n; ++i) goals[i] = {xs[i], ys[i], 0, headings[i]};
  swarm.go_to(goals, mask_of(where, n));
}

void set_poses(HeldSwarm& held, const Numbers& poses, const Where& where) {
  Swarm& swarm = held.use();
  const std::size_t n = swarm.size();
  if (poses.ndim() != 2 || static_cast<std::size_t>(poses.shape(0)) != n || poses.shape(1) != 4)
    refuse("poses", poses, n, "x, y, z, heading for each");
  swarm.set_poses({reinterpret_cast<const Pose*>(poses.data()), n}, mask_of(where, n));
}

}  // namespace

void bind_swarm(py::module_& module, SimulationClass& simulation) {
  static_assert(sizeof(Pose) == 4 * sizeof(double) && sizeof(Model::Speed) == 3 * sizeof(double));
  py::class_<HeldSwarm>(module, "Swarm",
                        "A group of robots of one simulation, in ascending order of their ids. Its functions "
                        "do for all robots in one call\nwhat those of Model do for one robot. They return "
                        "new arrays, with one row per robot (n rows).\nCommands take one number for all "
                        "robots or one number per robot. Their parameter `where` selects robots by one\nbool "
                        "per robot; None selects all. Commands skip robots that are not in the world.")
      .def("__len__", [](const HeldSwarm& s) { return s.swarm.size(); })
      .def("__repr__", [](const HeldSwarm& s) { return fmt::format("<Swarm of {} robots>", s.swarm.size()); })
      .def_property_readonly("ids",
                             [](const HeldSwarm& s) {
                               py::array_t<std::uint32_t> out(s.size());
                               for (std::size_t i = 0; i < s.swarm.size(); ++i)
                                 out.mutable_at(i) = s.swarm.ids()[i].value;
                               return out;
                             })
      .def_property_readonly("names", [](const HeldSwarm& s) { return s.swarm.names(); })
      .def_property_readonly("types", [](const HeldSwarm& s) { return s.swarm.types(); })
      .def(
          "alive", [](HeldSwarm& s) { return flags_of(s, &Swarm::alive); },
          "One bool per robot: whether it is in the world.")
      .def(
          "stalled", [](HeldSwarm& s) { return flags_of(s, &Swarm::stalled); },
          "One bool per robot: whether its motion was blocked in the last tick.")
      .def(
          "poses", [](HeldSwarm& s) { return rows_of(s, 4, &Swarm::poses); },
          "Poses in the world frame, n x 4: x, y, z (m), heading (rad).")
      .def(
          "estimates", [](HeldSwarm& s) { return rows_of(s, 4, &Swarm::estimates); },
          "Estimated poses, n x 4: x, y, z (m), heading (rad). With the localization `gps` they are the true "
          "poses, with\n`odom` the odometry estimates.")
      .def(
          "speeds", [](HeldSwarm& s) { return rows_of(s, 3, &Swarm::speeds); },
          "Velocities during the last tick in the body frame, n x 3: forward, left (m/s), turn (rad/s).")
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
          "Headings of the beams of the ranger of the first robot, rad, in the frame of the sensor.")
      .def(
          "range_bound", [](HeldSwarm& s, const std::string& sensor) { return s.use().range_bound(sensor); },
          py::arg("sensor") = "", "Largest range that the ranger of the first robot can report, m.")
      .def(
          "subscribe", [](HeldSwarm& s) { s.use().subscribe(); },
          "Makes all sensors of all robots run. Call it before the first step.")
      .def("set_speeds", &command<&Swarm::set_speeds>, py::arg("forward").none(false),
           py::arg("turn").none(false), py::kw_only(), py::arg("left").none(false) = 0.0,
           py::arg("where") = py::none(),
           "Commands speeds in the body frame: forward and left in m/s, turn in rad/s. They apply from the "
           "next tick on,\nuntil another command replaces them.")
      .def("accelerate", &command<&Swarm::accelerate>, py::arg("forward").none(false),
           py::arg("turn").none(false), py::kw_only(), py::arg("left").none(false) = 0.0,
           py::arg("where") = py::none(),
           "Commands accelerations in the body frame: forward and left in m/s^2, turn in rad/s^2.")
      .def("go_to", &go_to, py::arg("x").none(false), py::arg("y").none(false),
           py::arg("heading").none(false), py::kw_only(), py::arg("where") = py::none(),
           "Commands goal poses in the frame of estimates(), m and rad: the robots drive there and stay.")
      .def("set_poses", &set_poses, py::arg("poses").none(false), py::kw_only(),
           py::arg("where") = py::none(),
           "Places the robots at poses in the world frame, n x 4: x, y, z (m), heading (rad). If one pose is "
           "invalid, it\nraises ValueError and moves no robot.");

  simulation.def(
      "swarm",
      [](const Holder& held, const std::string& of) {
        return HeldSwarm{held, held->use().swarm(of)};
      },
      py::arg("of") = "",
      "Returns a group of robots. `of` names a type, a population or one robot; an empty name means all "
      "robots. Raises\nLookupError, whose text lists the known names, for an unknown name.");
}

}  // namespace troupe::python
