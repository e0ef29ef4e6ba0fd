#pragma once

#include "troupe/picture_source.hpp"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace troupe {

/// Splits the name of a value of the state, COMPONENT.FIELD or COMPONENT.FIELD.COLUMN, into its parts, and
/// returns all possible results. Components are the tables of which the state consists; each has named fields
/// of one or more columns. Because names of components may contain dots, `a.b.3` is column 3 of the field b
/// of the component a, or the field 3 of the component a.b. Does not check that the values exist, and leaves
/// ChosenValue::text, the label, empty. The result is empty if the name has no dot.
std::vector<ChosenValue> readings_of(const std::string& name);

/// Appends the unit to a name: "velocity.x (m/s)". Returns the name alone if the unit is empty.
std::string with_unit(const std::string& name, std::string_view unit);
/// Returns the error for a value whose column index is too large. The error states which columns the field
/// has. columns: number of columns of the field.
Error no_such_column(const ChosenValue& value, std::size_t columns);

}  // namespace troupe
