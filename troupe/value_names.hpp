#pragma once

#include "troupe/picture_source.hpp"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace troupe {

/// All ways to split a name `COMPONENT.FIELD` or `COMPONENT.FIELD.COLUMN` into its parts. There may be
/// several, because names of components may contain dots. Empty if the name does not have this form.
std::vector<ChosenValue> readings_of(const std::string& name);

/// Appends the unit to a name: "velocity.x (m/s)".
std::string with_unit(const std::string& name, std::string_view unit);
/// The error for a column index that is too large for the field. columns: number of columns of the field.
Error no_such_column(const ChosenValue& value, std::size_t columns);

}  // namespace troupe
