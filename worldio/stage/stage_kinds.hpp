#pragma once

#include "engine/kinds/registry.hpp"
#include "engine/kinds/sensor_params.hpp"
#include "engine/spec/world_spec.hpp"
#include "worldio/stage/stage_devices.hpp"
#include "worldio/stage/stage_models.hpp"
#include "worldio/stage/stage_values.hpp"

#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace troupe::worldio {

/// Converts models in the `.world` files of Stage, an older robot simulator, to Troupe's devices, drives and
/// controllers. A position model is a robot, or a part with wheels of its own. A kind is a sort of device,
/// drive or controller, with its own parameters; `registry` has all kinds.
///
/// If a property is wrong, the functions report an error. A function that returns a std::optional may then
/// return std::nullopt. A property of a drive is ignored without an error if the kind of the drive has no
/// parameter for it.
///
/// The caller must set the name, the part, the joint and the pose of a returned device, and the part of a
/// returned controller.
class StageKinds {
 public:
  StageKinds(const StageDocument& document, const engine::Registry& registry, StageValues& values)
      : document_(document), registry_(registry), values_(values) {}

  /// Returns the time between two updates of a model, s, from its property `update_interval`. The result 0
  /// means that the model is updated in every tick (time step). Returns 0.1 s if the model does not
  /// have the property, or if the value is not a number. A number below 0, or above the largest allowed
  /// period, is reported as an error but still returned.
  double period_s(const StageModel& model);

  /// Reads a ranger. `sensors` are its `sensor` children. A model of the older types `laser` and `sonar`
  /// without such children is its own sensor. For any other ranger without `sensor` children, warns and
  /// returns std::nullopt.
  std::optional<engine::DeviceSpec> ranger(const StageModel& model, const std::vector<StageModel>& sensors);
  /// Reads a model that is a device of this kind. Use ranger() for rangers and gripper() for grippers.
  std::optional<engine::DeviceSpec> device(const StageModel& model, const engine::DeviceKind& kind);
  /// Like device(), for a gripper. `size` is the size of its model, m.
  std::optional<engine::DeviceSpec> gripper(const StageModel& model, const engine::DeviceKind& kind,
                                            const Eigen::Vector3d& size);
  /// Reads the drive of a position model. The kind of the drive is "diff" if the model does not have the
  /// property `drive`. is_nested: whether the model is inside another model; its localization is not read
  std::optional<engine::DriveSpec> drive(const StageModel& model, bool is_nested = false);
  /// Reads the drive of a position model inside another model. Such a drive is a device: `kind` must be the
  /// device kind "wheels".
  std::optional<engine::DeviceSpec> wheels(const StageModel& model, const engine::DeviceKind& kind);
  /// Reads the property `ctrl`, which has one or more strings. Each string has the name of a controller and
  /// then its arguments, separated by blanks. Arguments are the values of the controller's parameters, in SI
  /// units and in the order of the parameters. An argument may also be written as parameter=value. In this
  /// form, a unit at the end of the name is the unit of the value: `turn_degps=30`. A wrong string is
  /// reported, and is missing in the result. The result is empty if the model does not have the property.
  std::vector<engine::ControllerSpec> controllers(const StageModel& model);

 private:
  /// Reads the property with the name `key`, which must be `velocity_bounds` or `acceleration_bounds`.
  /// Returns the eight numbers [xmin xmax ymin ymax zmin zmax amin amax]. Velocities are in m/s (x, y, z) and
  /// rad/s (a), accelerations in m/s^2 and rad/s^2. Returns the defaults of Stage if the model does not have
  /// the property.
  std::optional<std::vector<double>> drive_bounds(const StageModel& model, std::string_view key);
  /// Reads the properties that say how the robot estimates its pose (GPS or odometry), and stores them in
  /// `params`, which has one value per field of `table`. Returns false if a property is wrong.
  bool localize(const StageModel& model, const engine::FieldTable& table, engine::Record& params);
  bool read_parameter(const StageModel& model, const StageParameter& parameter,
                      const engine::FieldTable& table, engine::Record& params);
  /// unused: why the property has no effect, as in StageValues::may_exceed()
  std::optional<engine::Value> value(const StageProperty& property, const engine::Field& field, double to_si,
                                     int column, const std::string& unused = {});
  // The next three functions are defined in worldio/stage/stage_sensors.cpp. If a property is wrong, they
  // report an error and return false.
  bool add_blob_colors(const StageModel& model, const engine::DeviceKind& kind, engine::DeviceSpec& spec);
  bool add_bumpers(const StageModel& model, engine::DeviceSpec& spec);
  bool add_radio_law(const StageModel& model, const engine::DeviceKind& kind, engine::DeviceSpec& spec);
  std::optional<engine::TransducerParams> transducer(const StageModel& sensor);
  std::optional<engine::ControllerSpec> controller(std::string_view call, Where where);
  /// An argument of a controller in the property `ctrl`.
  struct Argument {
    std::size_t field = 0;  ///< index of its parameter
    double to_si = 1;       ///< factor from its unit to the SI unit
    std::string_view text;  ///< its value
  };
  /// Reads an argument: `speed=0.2`, the same with a unit as in JSON (`turn_degps=30`), or only a value,
  /// which is that of the parameter `positional`, and increases `positional`. Reports an error if the
  /// controller has no such parameter.
  std::optional<Argument> argument(std::string_view word, std::span<const engine::Field> fields,
                                   std::string_view controller, Where where, std::size_t& positional);

  const StageDocument& document_;
  const engine::Registry& registry_;
  StageValues& values_;
};

}  // namespace troupe::worldio
