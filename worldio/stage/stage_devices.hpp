#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace troupe::worldio {

/// The unit of a number in a `.world` file, the world file of Stage (an older robot simulator); `plain` means
/// no unit. The properties `unit_length` and `unit_angle` of the file select the units `length` and `angle`.
/// The other units are the same in all files.
enum class StageUnit : std::uint8_t { plain, length, angle, degrees, milliseconds };

/// A property of a Stage model that maps directly to one parameter of the device that Troupe makes of the
/// model. The class StageKinds (worldio/stage/stage_kinds.hpp), which reads the properties, has code for
/// every other property.
struct StageParameter {
  std::string_view model;             ///< type of the model, such as "fiducial"
  std::string_view property;          ///< name of the property in the file
  std::string_view field;             ///< name of the parameter, in the field table of the device kind
  StageUnit unit = StageUnit::plain;  ///< unit of the property in the file
  int column = -1;  ///< 0 or 1: index of the parameter in a tuple [a b]; -1: the whole value
};
/// Returns all properties that map directly to one parameter of a device.
std::span<const StageParameter> stage_parameters();

/// A propagation law of radios, with its name in the `wifi` models of Stage 2.
struct StageRadioLaw {
  std::string_view model;  ///< name of the law in the file
  std::string_view law;    ///< value of the parameter `law` of the radio
  std::string_view walls;  ///< with this law: default of the parameter `walls` of the radio
};
/// Returns all propagation laws that the property `model` of a radio can name; the first is the default. Two
/// names can have the same law, with different defaults of `walls`.
std::span<const StageRadioLaw> stage_radio_laws();
/// Default of the range of a radio in a `.world` file, m, for every law except "disc". With "disc", the
/// default is that of the radio's parameter `range`.
inline constexpr double k_stage_radio_range = 1000;

}  // namespace troupe::worldio
