#include "python/columns.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <span>
#include <stdexcept>
#include <utility>

namespace troupe::python {
namespace {

constexpr std::string_view k_column = "one number, or one per robot";

/// Whether a value is a bytes object, or a bytearray or a memoryview, which are treated in the same way.
bool is_bytes(const py::handle& value) {
  return py::isinstance<py::bytes>(value) || py::isinstance<py::bytearray>(value) ||
         PyMemoryView_Check(value.ptr()) != 0;
}

py::bytes bytes_copy(const py::handle& value) {
  PyObject* const copy = PyBytes_FromObject(value.ptr());
  if (copy == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::bytes>(copy);
}

/// Converts a `bytes`, or a list of several, to an array with one row per `bytes`, padded with zeros to the
/// length of the field. Throws ValueError if a `bytes` is longer than the field.
py::array padded(const engine::StateField& field, const py::handle& value) {
  std::vector<py::bytes> texts;
  if (is_bytes(value))
    texts.push_back(bytes_copy(value));
  else
    for (const py::handle each : value) texts.push_back(bytes_copy(each));
  py::array_t<std::uint8_t> rows(
      {static_cast<py::ssize_t>(texts.size()), static_cast<py::ssize_t>(field.columns)});
  std::memset(rows.mutable_data(), 0, static_cast<std::size_t>(rows.nbytes()));
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const std::string_view text = texts[i];
    if (text.size() > field.columns)
      throw py::value_error(
          fmt::format("\"{}\" takes at most {} bytes, found {}", field.name, field.columns, text.size()));
    std::memcpy(rows.mutable_data(static_cast<py::ssize_t>(i), 0), text.data(), text.size());
  }
  return rows;
}

bool is_of_bytes(const py::handle& value) {
  if (is_bytes(value)) return true;
  return (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) && py::len(value) > 0 &&
         is_bytes(*py::iter(value));
}

/// Returns whether no finite number is above the largest float or below the lowest one.
bool fit_float(const Numbers& numbers) {
  return std::ranges::all_of(
      std::span(numbers.data(), static_cast<std::size_t>(numbers.size())), [](double x) {
        return !std::isfinite(x) || std::abs(x) <= static_cast<double>(std::numeric_limits<float>::max());
      });
}

}  // namespace

void refuse(std::string_view name, const py::array& given, std::size_t robots, std::string_view wanted) {
  throw py::value_error(fmt::format("{} has shape {}; for a swarm of {} robots give {}", name,
                                    std::string(py::str(given.attr("shape"))), robots, wanted));
}

void require_numbers(std::string_view name, const py::array& given) {
  // Kinds of NumPy types. Python objects (O) are converted one by one.
  constexpr std::string_view k_numbers = "biufO";
  if (k_numbers.find(given.dtype().kind()) == std::string_view::npos)
    throw py::type_error(fmt::format("{}: found {}: give numbers", name, short_repr(given.attr("tolist")())));
}

Numbers numbers_of(std::string_view name, const py::object& given, std::string_view wanted) {
  if (!given.is_none()) {  // NumPy converts None to NaN
    if (const py::array values = py::array::ensure(given)) {
      require_numbers(name, values);
      if (Numbers numbers = Numbers::ensure(values)) return numbers;
    }
  }
  throw py::type_error(fmt::format("{}: found {}: give {}", name, short_repr(given), wanted));
}

Column::Column(std::string_view name, const py::object& given, std::size_t robots)
    : name_(name), numbers_(numbers_of(name, given, k_column)) {
  if (numbers_.ndim() > 1 || (numbers_.ndim() == 1 && static_cast<std::size_t>(numbers_.size()) != robots))
    refuse(name, numbers_, robots, k_column);
  first_ = numbers_.data();
  step_ = numbers_.ndim() == 0 ? 0 : 1;
}

std::vector<std::uint8_t> mask_of(const Where& where, std::size_t robots) {
  if (!where) return {};
  const py::array given(*where);
  if (robots == 0 && given.ndim() == 1 && given.size() == 0) return {};  // NumPy makes floats of []
  if (given.dtype().kind() != 'b' || given.ndim() != 1 || static_cast<std::size_t>(given.size()) != robots)
    refuse(fmt::format("where, an array of {},", std::string(py::str(given.dtype()))), given, robots,
           "one bool per robot");
  const py::array_t<bool, py::array::c_style | py::array::forcecast> marks(given);
  return {marks.data(), marks.data() + marks.size()};
}

py::array empty_rows(const engine::StateField& field, py::ssize_t robots) {
  std::vector<py::ssize_t> shape{robots};
  if (field.columns > 1) shape.push_back(field.columns);
  return {dtype_of(field.element), shape};
}

std::span<std::byte> bytes_of(py::array& array) {
  return {static_cast<std::byte*>(array.mutable_data()), static_cast<std::size_t>(array.nbytes())};
}

std::span<const std::byte> const_bytes_of(const py::array& array) {
  return {static_cast<const std::byte*>(array.data()), static_cast<std::size_t>(array.nbytes())};
}

py::array converted(const engine::StateField& field, const py::array& given, const py::handle& value) {
  require_numbers(field.name, given);
  py::array made;
  bool fits = true;
  try {
    fits = field.element != engine::Element::f32 || fit_float(Numbers(given));
    if (fits) made = given.attr("astype")(dtype_of(field.element));
  } catch (const py::error_already_set& error) {  // for an array of Python objects, such as 2**70 or None
    if (error.matches(PyExc_TypeError) || error.matches(PyExc_ValueError))
      throw py::type_error(fmt::format("{}: found {}: give numbers", field.name, short_repr(value)));
    if (!error.matches(PyExc_OverflowError)) throw;
    fits = false;
  }
  const bool is_whole = field.element != engine::Element::f64 && field.element != engine::Element::f32;
  if (fits && is_whole) fits = py::module_::import("numpy").attr("array_equal")(made, given).cast<bool>();
  if (fits && field.is_bool)
    fits = std::ranges::all_of(const_bytes_of(made), [](std::byte part) { return part <= std::byte{1}; });
  if (!fits)
    throw py::value_error(fmt::format("\"{}\" has the type {}, which cannot represent {}", field.name,
                                      field.is_bool ? "bool" : engine::element_name(field.element),
                                      short_repr(value)));
  return made;
}

void refuse_nan(const engine::StateField& field, const py::array& rows, std::span<const std::uint8_t> mask) {
  if (field.element != engine::Element::f64 && field.element != engine::Element::f32) return;
  const py::array marks = py::module_::import("numpy").attr("isnan")(rows);
  const auto* marked = static_cast<const bool*>(marks.data());
  for (std::size_t k = 0; k < static_cast<std::size_t>(marks.size()); ++k)
    if (const std::size_t i = k / field.columns; marked[k] && (mask.empty() || mask[i] != 0))
      throw py::value_error(fmt::format("\"{}\"{} is nan: give a number", field.name,
                                        rows.ndim() == 2 ? fmt::format(" of row {}", i) : ""));
}

py::array rows_for(const engine::StateField& field, const py::handle& value, py::ssize_t robots) {
  const py::module_ numpy = py::module_::import("numpy");
  const auto columns = static_cast<py::ssize_t>(field.columns);
  const bool has_bytes = field.element == engine::Element::u8 && is_of_bytes(value);
  py::array given = has_bytes ? padded(field, value) : py::array(numpy.attr("asarray")(value));
  if (columns == 1 && given.ndim() == 1) given = given.attr("reshape")(-1, 1);
  const bool is_one_row = (has_bytes && is_bytes(value)) || (given.ndim() == 1 && given.shape(0) == columns);
  const bool has_rows = given.ndim() == 2 && given.shape(0) == robots && given.shape(1) == columns;
  const bool fits = given.ndim() == 0 || is_one_row || has_rows;
  if (!fits)
    refuse(
        fmt::format("\"{}\"", field.name), py::array(numpy.attr("asarray")(value)),
        static_cast<std::size_t>(robots),
        columns == 1 ? std::string(k_column) : fmt::format("{} numbers, or {} per robot", columns, columns));
  const py::array made = converted(field, given, value);
  return numpy.attr("ascontiguousarray")(numpy.attr("broadcast_to")(made, py::make_tuple(robots, columns)));
}

CommandRows command_rows(std::span<const engine::StateField> fields, const std::string& device,
                         const py::kwargs& values, py::ssize_t robots, std::span<const std::uint8_t> mask) {
  CommandRows set;
  for (const auto& [key, value] : values) {
    const std::string name = key.cast<std::string>();
    const engine::StateField& field = command_field(fields, name, fmt::format("device \"{}\"", device));
    set.emplace_back(&field, rows_for(field, value, robots));
    refuse_nan(field, set.back().second, mask);
  }
  return set;
}

std::string_view default_radio(std::span<const std::string_view> radios) {
  constexpr std::string_view k_usual = "radio";
  if (radios.empty() || std::ranges::find(radios, k_usual) != radios.end()) return k_usual;
  return radios.front();
}

py::dict message_command(std::span<const engine::StateField> fields, const std::string& device,
                         const py::object& message, py::ssize_t robots) {
  const engine::StateField* const field = engine::field_named(fields, k_payload);
  if (field == nullptr) throw std::out_of_range(fmt::format("the device \"{}\" is not a radio", device));
  const auto columns = static_cast<py::ssize_t>(field->columns);
  const auto require_room = [&](py::ssize_t length) {
    if (length > columns)
      throw py::value_error(
          fmt::format("a message of {} bytes is longer than the payload of \"{}\", which is {} bytes", length,
                      device, columns));
  };
  py::dict values;
  values["mode"] = 1;
  if (is_bytes(message)) {
    const py::bytes copy = bytes_copy(message);
    require_room(static_cast<py::ssize_t>(py::len(copy)));
    values["length"] = py::len(copy);
    values["payload"] = copy;
    return values;
  }
  const py::module_ numpy = py::module_::import("numpy");
  if (is_of_bytes(message)) {  // NumPy would pad the messages to the length of the longest
    py::list lengths;
    for (const py::handle each : message) {
      const auto length = static_cast<py::ssize_t>(py::len(bytes_copy(each)));
      require_room(length);
      lengths.append(length);
    }
    if (static_cast<py::ssize_t>(lengths.size()) != robots)
      refuse("message", py::array(numpy.attr("asarray")(lengths)), static_cast<std::size_t>(robots),
             "a bytes object, or a list of one such object per robot");
    values["length"] = lengths;
    values["payload"] = padded(*field, message);
    return values;
  }
  const py::array rows = numpy.attr("ascontiguousarray")(message);
  if (rows.dtype().kind() == 'U')
    throw py::value_error(
        fmt::format("message: found the text {}: give bytes, as in text.encode()", short_repr(message)));
  if (rows.ndim() == 0 || rows.shape(0) != robots)
    refuse("message", rows, static_cast<std::size_t>(robots),
           "a bytes object, or an array with one row per robot");
  if (rows.dtype().attr("hasobject").cast<bool>())
    throw py::value_error(fmt::format(
        "message: the elements of the array are Python objects (dtype {}), whose bytes are addresses: give a "
        "bytes object, or an array of numbers or bytes",
        std::string(py::str(rows.dtype()))));
  const py::ssize_t length = robots > 0 ? rows.nbytes() / robots : 0;
  require_room(length);
  py::array_t<std::uint8_t> payload({robots, columns});
  std::memset(payload.mutable_data(), 0, static_cast<std::size_t>(payload.nbytes()));
  for (py::ssize_t i = 0; i < robots; ++i)
    std::memcpy(payload.mutable_data(i, 0), static_cast<const std::byte*>(rows.data()) + i * length,
                static_cast<std::size_t>(length));
  values["length"] = length;
  values["payload"] = payload;
  return values;
}

py::tuple messages_of(const py::object& type, const std::string& device, const py::array& count,
                      const py::array& length, const py::array& payload) {
  const py::module_ numpy = py::module_::import("numpy");
  const py::object dtype = numpy.attr("dtype")(type);
  const auto size = dtype.attr("itemsize").cast<py::ssize_t>();
  const py::ssize_t robots = count.shape(0);
  const py::ssize_t places = length.ndim() > 1 ? length.shape(1) : 1;
  const py::ssize_t room = (payload.ndim() > 1 ? payload.shape(1) : 1) / places;
  if (size == 0 || size > room)
    throw py::value_error(fmt::format(
        "dtype: an element has {} bytes, but must have 1 to {} bytes, the size of the payload of \"{}\"",
        size, room, device));
  const py::object bytes = payload.attr("reshape")(robots, places, room);
  const py::object part = bytes[py::make_tuple(py::ellipsis(), py::slice(0, size, 1))];
  const py::object shape = py::make_tuple(robots, places).attr("__add__")(dtype.attr("shape"));
  const py::object values =
      numpy.attr("ascontiguousarray")(part).attr("view")(dtype.attr("base")).attr("reshape")(shape);
  const py::object there = numpy.attr("less")(numpy.attr("arange")(places), count.attr("reshape")(-1, 1));
  const py::object fits = numpy.attr("equal")(length.attr("reshape")(robots, places), size);
  return py::make_tuple(values, numpy.attr("logical_and")(there, fits));
}

py::array_t<std::int64_t> body_ids(std::span<const BodyId> bodies) {
  py::array_t<std::int64_t> ids(static_cast<py::ssize_t>(bodies.size()));
  std::ranges::transform(bodies, ids.mutable_data(),
                         [](BodyId body) { return body.valid() ? std::int64_t{body.value} : -1; });
  return ids;
}

}  // namespace troupe::python
