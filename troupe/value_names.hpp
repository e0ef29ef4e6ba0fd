#pragma once

#include "troupe/picture_source.hpp"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace troupe {

/// A name of a field and its column, `COMPONENT.FIELD` or `COMPONENT.FIELD.COLUMN`, in every way that it can
/// be read: components may have dots in their names, too. Empty where it can be none.
std::vector<ChosenValue> readings_of(const std::string& name);

/// "velocity.x (m/s)".
std::string with_unit(const std::string& name, std::string_view unit);
/// What is said of a column beyond a field's. columns: the field's.
Error no_such_column(const ChosenValue& value, std::size_t columns);

}  // namespace troupe
