#pragma once

#include "models/controllers/scan_ahead.hpp"

#include <any>
#include <array>
#include <string>
#include <string_view>

namespace troupe::models {

/// Returns why a robot turns away from obstacles all the time, as a text that continues the words `controller
/// "NAME"`: the ranger of `scanner` reads at most a distance at which the controller already turns away. The
/// result is empty if the ranger reads longer distances.
///
/// distance: the controller turns away while a reading ahead is below this, m
/// parameter: name of the parameter that gives `distance`
std::string always_turns_text(const Scanner& scanner, double distance, std::string_view parameter);

/// As always_turns_text(), for the data `prepared` of a controller (ControllerKind::Prepared::data). The
/// result is also empty if the data are not of the class C, which must have the members `scanner` and
/// `params.min_front`.
template <class C>
std::string always_turns(const std::any& prepared) {
  const C* controller = std::any_cast<C>(&prepared);
  if (controller == nullptr) return {};
  return always_turns_text(controller->scanner, controller->params.min_front, "min_front");
}

/// Each of these functions is always_turns() for one kind of controller, the one in its name.
///@{
std::string beeclust_always_turns(const std::any& prepared);
std::string chain_always_turns(const std::any& prepared);
std::string clustering_always_turns(const std::any& prepared);
std::string collective_perception_always_turns(const std::any& prepared);
std::string expand_always_turns(const std::any& prepared);
std::string gradient_always_turns(const std::any& prepared);
std::string informed_aggregation_always_turns(const std::any& prepared);
std::string wander_always_turns(const std::any& prepared);
///@}

/// All functions of the list above. `troupe lint` calls each of them for each controller of a world. They are
/// no hook of ControllerKind, because a new hook would change the interface of plug-ins.
inline constexpr std::array k_always_turns{beeclust_always_turns,
                                           chain_always_turns,
                                           clustering_always_turns,
                                           collective_perception_always_turns,
                                           expand_always_turns,
                                           gradient_always_turns,
                                           informed_aggregation_always_turns,
                                           wander_always_turns};

}  // namespace troupe::models
