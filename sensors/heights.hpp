#pragma once

#include "base/geometry.hpp"
#include "engine/observing/lint_view.hpp"

#include <cstddef>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <string_view>

namespace troupe::sensors {

/// Counts the solids at each height: at(z) returns the number of solids whose z interval, including both
/// ends, contains z.
class Heights {
 public:
  void add(const ZInterval& z, std::size_t count);
  /// Sums the counts. Call it after the last add() and before the first at().
  void sum();
  std::size_t at(double z) const;
  bool empty() const { return begins_.empty(); }
  const ZInterval& extent() const { return extent_; }  ///< smallest interval that contains all solids

 private:
  // Per height: the number of solids that begin or end there; after sum() also of those below.
  std::map<double, std::size_t> begins_;
  std::map<double, std::size_t> ends_;
  ZInterval extent_{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
};

/// The solids that a sensor can detect if they are at its height.
struct DetectableSolids {
  const Heights& all;              ///< the solids of all bodies, world frame
  std::span<const ZInterval> own;  ///< those of one body of the sensor's type, body frame
  std::string_view none;           ///< how a finding names them: "no other body that rangers see"
  std::string_view name;           ///< the same in the plural: "bodies that rangers see"
};
/// Returns why a sensor of the view's type detects none of the solids at any height of its bodies, as the
/// second half of a finding; empty if it may detect one. A sensor does not detect its own body. A body that
/// is the only one of its type counts at each height to which interventions move it.
///
/// sensor_z: the heights at which the sensor looks, body frame, m; at least one
std::string why_at_no_height(const engine::LintView& view, const DetectableSolids& solids,
                             std::span<const double> sensor_z);

}  // namespace troupe::sensors
