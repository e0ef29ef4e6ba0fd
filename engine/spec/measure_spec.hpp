#pragma once

#include "base/diagnostics.hpp"
#include "engine/fields/fields.hpp"

#include <string>

namespace troupe::engine {

/// A measure that is computed during a run (engine/kinds/measure_kind.hpp).
struct MeasureSpec {
  std::string kind;  ///< name of a kind of Registry::measures or of a plug-in
  std::string name;  ///< name of its column, without the unit; empty: `kind`, or `kind:of` if `of` is set
  std::string of;    ///< name of a type, a population or a robot: robots_of(); empty: all robots
  Record params;     ///< one value for each parameter of the kind (MeasureKind::params)
  Where where;       ///< position in the file, for messages
};

}  // namespace troupe::engine
