#pragma once

#include "python/bindings.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Conversions between NumPy arrays and the data of a group of robots, one row per robot. The Python classes
/// of swarms (groups of robots) and of controllers use them.
namespace troupe::python {

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Where = std::optional<py::array>;

/// Throws ValueError for an argument of a wrong shape. name: name of the argument; given: its value; robots:
/// number of robots; wanted: text that says what is expected, such as "one number, or one per robot".
[[noreturn]] void refuse(std::string_view name, const py::array& given, std::size_t robots,
                         std::string_view wanted);

/// An argument of a command for a swarm, which is one number for all robots or one number per robot. Element
/// i is the number of robot i.
class Column {
 public:
  Column(std::string_view name, const Numbers& numbers, std::size_t robots)
      : first_(numbers.data()), step_(numbers.ndim() == 0 ? 0 : 1) {
    if (numbers.ndim() > 1 || (numbers.ndim() == 1 && static_cast<std::size_t>(numbers.size()) != robots))
      refuse(name, numbers, robots, "one number, or one per robot");
  }
  double operator[](std::size_t i) const { return first_[i * step_]; }

 private:
  const double* first_;
  std::size_t step_;
};

/// Converts the Python argument `where` of a command, which selects robots, to what the C++ class Swarm
/// takes: one byte per robot, 0 if the command skips the robot. The result is empty if `where` is None; the
/// command is then for all robots. Throws ValueError if `where` is neither None nor an array of one bool per
/// robot.
std::vector<std::uint8_t> mask_of(const Where& where, std::size_t robots);

/// Returns a new array for a field (a member of the state of each robot): shape (robots,) or, if the field
/// has several columns, (robots, columns).
py::array empty_rows(const engine::StateField& field, py::ssize_t robots);
/// The memory of a contiguous array, as bytes; valid while the array exists.
std::span<std::byte> bytes_of(py::array& array);
std::span<const std::byte> const_bytes_of(const py::array& array);

/// Returns the field of a command with this name. If there is none, throws std::out_of_range with a message
/// that lists the known names.
/// whose: the beginning of this message, such as `device "lamp"`
const engine::StateField& command_field(std::span<const engine::StateField> fields, std::string_view name,
                                        std::string_view whose);

/// Converts a Python value to an array of the shape (robots, columns) with the element type of a field of a
/// command. A single number sets all elements, and a single row sets the rows of all robots; any other value
/// must have one row per robot. Throws ValueError if the shape does not fit, or if the element type is an
/// integer type that cannot represent one of the numbers.
py::array rows_for(const engine::StateField& field, const py::handle& value, py::ssize_t robots);

/// Returns the command that makes the radios named `device` send `message`, as a dict from names of fields to
/// values. message: a Python `bytes` object, which all robots send, or an array with one row per robot.
/// fields: all fields of the command of these radios.
py::dict message_command(std::span<const engine::StateField> fields, const std::string& device,
                         const py::object& message, py::ssize_t robots);
/// Converts the fields count, length and payload of the readings of radios to the result of Swarm.heard().
/// This is a pair of arrays with one row per robot: the messages as elements of the NumPy type `type`, and
/// bools, True where there is a message of exactly the size of this type. Throws ValueError, whose text names
/// the radios by `device`, if an element of this type has no bytes, or more bytes than the payload of a
/// message.
py::tuple messages_of(const py::object& type, const std::string& device, const py::array& count,
                      const py::array& length, const py::array& payload);

}  // namespace troupe::python
