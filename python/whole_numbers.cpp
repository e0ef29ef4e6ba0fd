#include "python/whole_numbers.hpp"

#include <fmt/format.h>

#include <string>

namespace troupe::python {

std::uint64_t whole_number(std::string_view name, const py::object& value, std::string_view allowed) {
  const auto index = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
  if (!index) {
    PyErr_Clear();
    throw py::type_error(fmt::format("{}: found {}: give {}", name, short_repr(value), allowed));
  }
  const std::uint64_t number = PyLong_AsUnsignedLongLong(index.ptr());
  if (PyErr_Occurred() != nullptr) {  // negative or too large
    PyErr_Clear();
    throw py::value_error(fmt::format("{}: found {}: give {}", name, std::string(py::str(index)), allowed));
  }
  return number;
}

std::uint64_t seed_of(const py::object& seed) { return whole_number("seed", seed); }

std::optional<std::uint64_t> optional_seed_of(const py::object& seed) {
  if (seed.is_none()) return {};
  return seed_of(seed);
}

}  // namespace troupe::python
