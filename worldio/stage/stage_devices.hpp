#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace troupe::worldio {

/// How Stage writes a number of a property: whether the file's units apply to it is a matter of each.
enum class StageUnit : std::uint8_t { plain, length, angle, degrees, milliseconds };

/// A property of a Stage model that is, as it stands, a parameter of the device that the model is. Properties
/// that need more thought have code of their own in StageKinds.
struct StageParameter {
  std::string_view model;     ///< type of the model: "fiducial"
  std::string_view property;  ///< as in the file
  std::string_view field;     ///< of the device kind's table; its type says what the value must be
  StageUnit unit = StageUnit::plain;
  int column = -1;  ///< the number of a tuple [a b ...] that it is; -1: the property is the parameter
};
std::span<const StageParameter> stage_parameters();

/// How radios weaken, by the names that the `wifi` models of Stage 2 had for it.
struct StageRadioLaw {
  std::string_view model;
  std::string_view law;    ///< parameter of the radio
  std::string_view walls;  ///< the same, where the file does not say it
};
std::span<const StageRadioLaw> stage_radio_laws();
/// How far the radios of a law that has a limit of its own are heard, m, where the file does not say it.
inline constexpr double k_stage_radio_range = 1000;

}  // namespace troupe::worldio
