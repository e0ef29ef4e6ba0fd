#pragma once

#include "python/bindings.hpp"

#include <cstdint>
#include <optional>
#include <string_view>

/// Conversions of arguments that are whole numbers. pybind11 also converts numbers, but its error for a
/// negative number or a fraction is a long list of C++ types that names neither the argument nor its value.
namespace troupe::python {

/// The numbers that whole_number() returns, for the text of an error.
inline constexpr std::string_view k_any_whole_number = "a whole number from 0 to 18446744073709551615";

/// Returns a whole number from 0 to 2^64 - 1. name: name of the argument; allowed: text that says what is
/// allowed. Throws TypeError for a value that is not a whole number, such as 1.5, and ValueError for a number
/// out of range.
std::uint64_t whole_number(std::string_view name, const py::object& value,
                           std::string_view allowed = k_any_whole_number);

/// Returns the argument `seed`. Throws as whole_number() does.
std::uint64_t seed_of(const py::object& seed);
/// Returns the argument `seed`, or nullopt for None.
std::optional<std::uint64_t> optional_seed_of(const py::object& seed);

}  // namespace troupe::python
