#pragma once

#include "troupe/model_place.hpp"  // command_field()
#include "python/bindings.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Conversions between NumPy arrays and the data of a group of robots. Unless stated otherwise, element i of
/// the first axis of an array (its row i) belongs to robot i of the group. The Python classes of swarms
/// (groups of robots) and of controllers use these functions.
///
/// A field is a variable in the state of each robot, such as the range readings of a sensor. It has one or
/// more numbers per robot, which are called its columns. A command of a device is a list of fields.
namespace troupe::python {

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;
/// Throws TypeError if the elements of an array are not numbers, such as texts, which NumPy would convert.
/// name: name of the argument.
void require_numbers(std::string_view name, const py::array& given);
/// Converts a Python value to an array of numbers. Throws TypeError for None and for a value that is no
/// number and no array of numbers. name: name of the argument; wanted: text that says what is expected.
Numbers numbers_of(std::string_view name, const py::object& given, std::string_view wanted);

using Where = std::optional<py::object>;

/// Throws ValueError for an argument of a wrong shape. name: name of the argument; given: its value; robots:
/// number of robots; wanted: text that says what is expected, such as "one number, or one per robot".
[[noreturn]] void refuse(std::string_view name, const py::array& given, std::size_t robots,
                         std::string_view wanted);

/// An argument of a command for a swarm: one number for all robots, or one number per robot. Element i is the
/// number for robot i.
class Column {
 public:
  /// name: name of the argument, for errors; must outlive the object. Throws TypeError for a value that is
  /// not a number or an array of numbers, and ValueError for an array of a wrong shape.
  Column(std::string_view name, const py::object& given, std::size_t robots);
  double operator[](std::size_t i) const { return first_[i * step_]; }
  /// Throws ValueError if the number for robot i is infinite or NaN.
  void check_finite(std::size_t i) const {
    if (!std::isfinite((*this)[i]))
      throw py::value_error(fmt::format("{} of row {} is {}: give a finite number", name_, i, (*this)[i]));
  }

 private:
  std::string_view name_;
  Numbers numbers_;  ///< holds the memory of `first_`
  const double* first_ = nullptr;
  std::size_t step_ = 0;
};

/// Converts the Python argument `where`, which selects the robots that get a command. It is an array or a
/// list of one bool per robot, or None, which selects all robots. Returns one byte per robot, 1 for a
/// selected robot and 0 for others; for None, returns an empty vector. Throws ValueError for any other
/// argument.
std::vector<std::uint8_t> mask_of(const Where& where, std::size_t robots);

/// Returns a new array for the values of a field, with the element type of the field. The shape is (robots,)
/// for a field with one column, and otherwise (robots, columns). The elements are not initialised.
py::array empty_rows(const engine::StateField& field, py::ssize_t robots);
/// Returns the memory of a contiguous array, as bytes. The result is valid while the array exists.
std::span<std::byte> bytes_of(py::array& array);
std::span<const std::byte> const_bytes_of(const py::array& array);

/// Converts an array to the element type of a field. value: the Python value that the array was made from,
/// for the text of the error. Throws ValueError if the field has integers or bools and a number is not
/// exactly representable, or if a finite number is above the largest number of the field's floating-point
/// type. Throws TypeError if an element is not a number.
py::array converted(const engine::StateField& field, const py::array& given, const py::handle& value);
/// Throws ValueError if an element of `rows`, values of a field of a command, is NaN. rows: a contiguous
/// array with one row per robot, or the row of one robot. mask: as mask_of() returns it; rows of other robots
/// are not checked.
void refuse_nan(const engine::StateField& field, const py::array& rows,
                std::span<const std::uint8_t> mask = {});
/// Converts a Python value to the values of a field of a command: an array of the shape (robots, columns)
/// with the element type of the field. The value may be:
/// - a single number, for all elements
/// - a row of `columns` numbers, for all robots
/// - an array of one row per robot
/// - a `bytes`, `bytearray` or `memoryview` object, or a list of them, instead of rows of bytes. Short ones
///   are padded with zeros.
/// Throws ValueError if the value has another shape or if a `bytes` object is too long, and the exceptions of
/// converted().
py::array rows_for(const engine::StateField& field, const py::handle& value, py::ssize_t robots);
/// Fields of a command of a device, with their new values as rows_for() returns them.
using CommandRows = std::vector<std::pair<const engine::StateField*, py::array>>;
/// Converts the keyword arguments of a command: the names of fields and their new values. fields: all fields
/// of the command; they must outlive the result. device: name of the device, for the text of errors. mask: as
/// mask_of() returns it. Throws as command_field(), rows_for() and refuse_nan() do.
CommandRows command_rows(std::span<const engine::StateField> fields, const std::string& device,
                         const py::kwargs& values, py::ssize_t robots, std::span<const std::uint8_t> mask);

/// The field of the command of a radio by which say() and heard() recognise radios.
/// The ids of bodies as int64; -1 for an id that is not valid().
py::array_t<std::int64_t> body_ids(std::span<const BodyId> bodies);

inline constexpr const char* k_payload = "payload";
/// Returns the name of the radio that say() and heard() use if the caller names none: "radio" if there is a
/// radio of this name, or no radio at all, else the first one. radios: the names of the radios, in the order
/// of the devices of a robot.
std::string_view default_radio(std::span<const std::string_view> radios);
/// Returns the command that makes radios send `message`, as a dict from names of fields to values. message: a
/// Python `bytes`, `bytearray` or `memoryview` object, which all robots send, a list of one such object per
/// robot, or an array with one row per robot. In an array, the bytes of a row are the message of the robot.
/// fields: all fields of the command of the radios. device: name of the radios, for the text of errors.
///
/// Throws std::out_of_range if `fields` contains no payload, because the device is not a radio. If `message`
/// is a list or an array, throws ValueError if it does not have one row per robot, if the elements of the
/// array are Python objects or texts, or if a message is longer than the payload.
py::dict message_command(std::span<const engine::StateField> fields, const std::string& device,
                         const py::object& message, py::ssize_t robots);
/// Returns the messages that radios received, as Swarm.heard() in Python does. The result is a pair of arrays
/// with one row per robot and one column per message that a radio can receive in a tick. The first array has
/// the messages; the bytes of each message are interpreted as one element of the NumPy type `type`. The
/// second array has bools: True if there is a message and its size is that of `type`. Where the bool is
/// False, the element of the first array is meaningless.
///
/// count, length and payload: the fields with these names of the readings of the radios. device: name of the
/// radios, for the text of errors. Throws ValueError if `type` has 0 bytes, or more bytes than the payload of
/// a message.
py::tuple messages_of(const py::object& type, const std::string& device, const py::array& count,
                      const py::array& length, const py::array& payload);

}  // namespace troupe::python
