#pragma once

#include "troupe/picture_source.hpp"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace troupe {

/// All ways to read a name `COMPONENT.FIELD` or `COMPONENT.FIELD.COLUMN`; there may be several, because names
/// of components may contain dots. Empty if there is none.
std::vector<ChosenValue> readings_of(const std::string& name);

/// Appends the unit: "velocity.x (m/s)".
std::string with_unit(const std::string& name, std::string_view unit);
/// The error for a column beyond those of a field. columns: number of columns of the field.
Error no_such_column(const ChosenValue& value, std::size_t columns);

}  // namespace troupe
