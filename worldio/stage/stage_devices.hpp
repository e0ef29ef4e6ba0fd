#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace troupe::worldio {

/// The unit of a number in a `.world` file, the world file of Stage (an older robot simulator); `plain` means
/// no unit. The properties `unit_length` and `unit_angle` of the file select the units `length` and `angle`.
/// The other units are the same in all files.
enum class StageUnit : std::uint8_t { plain, length, angle, degrees, milliseconds };

/// A property of a Stage model that sets one parameter of a device. The device is the one that Troupe makes
/// from the model. The class StageKinds (worldio/stage/stage_kinds.hpp) reads these properties. Properties
/// that need code of their own are not in stage_parameters().
struct StageParameter {
  std::string_view model;             ///< type of the model, such as "fiducial"
  std::string_view property;          ///< name of the property in the file
  std::string_view field;             ///< name of the parameter of the device
  StageUnit unit = StageUnit::plain;  ///< unit of the property in the file
  int column = -1;  ///< 0 or 1: index in the value [a b] of the property; -1: the whole value
};
/// Returns all properties that set one parameter of a device.
std::span<const StageParameter> stage_parameters();

/// A propagation law of radios, and its name in the `wifi` models of Stage 2.
struct StageRadioLaw {
  std::string_view model;  ///< name of the law in the file
  std::string_view law;    ///< value of the parameter `law` of the radio
  std::string_view walls;  ///< default of the parameter `walls` of the radio, for this name
};
/// Returns the propagation laws for all values of the property `model` of a radio; the first one is the
/// default. Two values may have the same law and differ only in the default of `walls`, which says what walls
/// do to a signal.
std::span<const StageRadioLaw> stage_radio_laws();
/// Default range of a radio in a `.world` file, m, for every law except "disc". With "disc", the default is
/// that of the radio's parameter `range`.
inline constexpr double k_stage_radio_range = 1000;

}  // namespace troupe::worldio
