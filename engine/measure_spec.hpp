#pragma once

#include "base/diagnostics.hpp"
#include "engine/fields.hpp"

#include <string>

namespace troupe::engine {

/// A measure to be taken of the run (engine/measure_kind.hpp).
struct MeasureSpec {
  std::string kind;  ///< of Registry::measures
  std::string name;  ///< of its column, without the unit; empty: the kind's, with `:of` behind it
  std::string of;    ///< a type, a population or a robot; empty: all robots
  Record params;     ///< by the kind's field table
  Where where;       ///< for messages
};

}  // namespace troupe::engine
