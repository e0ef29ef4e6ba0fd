#pragma once

#include "base/ids.hpp"
#include "live/watched.hpp"
#include "troupe/measures.hpp"
#include "troupe/simulation.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace troupe::live {

class Request;

/// What a viewer has selected to see in addition to the poses and colours of the bodies.
class Selection {
 public:
  /// Called as refuse(id of the request to plot, text of the error) if the plotted measure throws. The plot
  /// then ends: an error in a measure that a viewer has chosen must not end the run.
  using Refuse = std::function<void(std::uint64_t, const std::string&)>;

  /// Obeys a request that changes the selection. Returns false if the request is of another sort. Throws
  /// ActRefused if it selects something that does not exist.
  bool obey(const Request& request, Simulation& simulation);
  /// Lets the plotted measure see the state. Call it after each tick.
  void see(const Refuse& refuse);
  /// Returns the part of the state that the viewer has selected: the members `inspected`, `plot`, `shades`
  /// and `lines` in docs/live-protocol.md.
  nlohmann::ordered_json state(Simulation& simulation, const Refuse& refuse);
  /// The value by which the viewer colours robots, or null.
  ColorValue* color() { return color_ ? &*color_ : nullptr; }

 private:
  void use_plot(const Refuse& refuse, const std::function<void(Measures&)>& use);

  std::optional<BodyId> inspected_;
  std::string plotted_;                 // the plotted measure; empty: none
  std::uint64_t plot_request_ = 0;      // id of the request to plot it
  std::unique_ptr<Measures> measures_;  // computes plotted_
  std::optional<ColorValue> color_;
  std::vector<std::string> layers_;  // the layers of lines
};

}  // namespace troupe::live
