#pragma once

#include "base/diagnostics.hpp"
#include "engine/fields/fields.hpp"

#include <string>

namespace troupe::engine {

/// A measure that is computed during a run: a number that a measure kind computes from the states of the run
/// (engine/kinds/measure_kind.hpp). Its values are a column of the results. A population is the set of robots
/// NAME0, NAME1, ... .
struct MeasureSpec {
  std::string kind;  ///< name of a measure kind (MeasureKind::name), which may come from a plug-in
  std::string name;  ///< name of its column, without the unit; empty: `kind`, or `kind:of` if `of` is set
  /// The robots that it is computed for: name of a body type, of a population or of one robot; empty: all
  /// robots.
  std::string of;
  Record params;  ///< one value for each parameter of the kind (MeasureKind::params)
  Where where;    ///< position in the file, for messages
};

}  // namespace troupe::engine
