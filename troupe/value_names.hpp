#pragma once

#include "troupe/picture_source.hpp"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace troupe {

/// Splits the name of a value of the state, COMPONENT.FIELD or COMPONENT.FIELD.COLUMN, into its parts. A
/// component is a table of the state; its named fields have one column or more. A name without COLUMN means
/// column 0. Returns all possible results, because the name of a component may contain dots: `a.b.3` is
/// column 3 of the field `b` of the component `a`, or column 0 of the field `3` of the component `a.b`.
/// Returns an empty list if the name has no dot. Does not check that the values exist. ChosenValue::text, a
/// label, is empty in the results.
std::vector<ChosenValue> readings_of(const std::string& name);

/// Appends the unit to a name: "velocity.x (m/s)". Returns the name alone if the unit is empty.
std::string with_unit(const std::string& name, std::string_view unit);
/// Returns the error for a column that does not exist, because value.column is too large. The error states
/// which columns the field has. columns: number of columns of the field.
Error no_such_column(const ChosenValue& value, std::size_t columns);

}  // namespace troupe
