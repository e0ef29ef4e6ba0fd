#pragma once

#include "base/diagnostics.hpp"
#include "engine/fields/fields.hpp"

#include <string>

namespace troupe::engine {

/// A measure: a number that is computed from the state of the world during a run, such as the covered area.
/// The kind of a measure is the code that computes the measure (engine/kinds/measure_kind.hpp). The results
/// of a run have a column for each measure.
struct MeasureSpec {
  std::string kind;  ///< name of a measure kind (MeasureKind::name), which may come from a plug-in
  std::string name;  ///< name of the column, without the unit; empty: `kind`, or `kind:of` if `of` is set
  /// The robots for which the measure is computed: the name of a body type, of one robot, or of a population
  /// (NAME for the robots NAME0, NAME1, ...). Empty: all robots.
  std::string of;
  Record params;  ///< one value for each parameter of the kind (MeasureKind::params)
  Where where;    ///< position in the file, for messages
};

}  // namespace troupe::engine
