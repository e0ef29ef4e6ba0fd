#pragma once

#include "engine/kinds/kinds.hpp"
#include "engine/kinds/sensor_params.hpp"
#include "engine/spec/world_spec.hpp"
#include "worldio/stage/stage_models.hpp"
#include "worldio/stage/stage_values.hpp"

#include <optional>
#include <string_view>
#include <vector>

namespace troupe::worldio {

/// Converts the properties of models in the `.world` files of Stage, an older robot simulator, to Troupe's
/// devices, drives and controllers. A position model is a robot, or a part with wheels of its own. A kind is
/// a sort of device, drive or controller, with its own parameters; `registry` lists all kinds. A property of
/// a drive is ignored if the kind of the drive has no parameter for it. If a property is wrong, the functions
/// report an error; those that return a std::optional then return an empty one. The caller must set the name,
/// the part, the joint and the pose of a returned device, and the part of a returned controller.
class StageKinds {
 public:
  StageKinds(const StageDocument& document, const engine::Registry& registry, StageValues& values)
      : document_(document), registry_(registry), values_(values) {}

  /// Returns the time between two updates of a model (`update_interval`), s; 0: every tick (simulation step).
  /// The time is 0.1 s if the model does not have the property, or if its value is not a number. A number
  /// beyond the limits is reported as an error, but is still returned.
  double period_s(const StageModel& model);

  /// Reads a ranger and its `sensor` children. A model of the older types `laser` and `sonar` without such
  /// children is its own sensor. For any other ranger without `sensor` children, the function warns and
  /// returns nothing.
  std::optional<engine::DeviceSpec> ranger(const StageModel& model, const std::vector<StageModel>& sensors);
  /// Reads a model that is a device of this kind, which must be neither a ranger (see ranger()) nor a gripper
  /// (see gripper()).
  std::optional<engine::DeviceSpec> device(const StageModel& model, const engine::DeviceKind& kind);
  /// Like device(), for a gripper. `size` is the size of its model, m.
  std::optional<engine::DeviceSpec> gripper(const StageModel& model, const engine::DeviceKind& kind,
                                            const Eigen::Vector3d& size);
  /// Reads the drive of a position model. The kind of the drive is "diff" if the model does not have the
  /// property `drive`.
  std::optional<engine::DriveSpec> drive(const StageModel& model);
  /// Reads the drive of a position model inside another model, as a device. `kind` is the device kind
  /// "wheels".
  std::optional<engine::DeviceSpec> wheels(const StageModel& model, const engine::DeviceKind& kind);
  /// Reads the property `ctrl`, one or more strings "name arguments". Arguments are in SI units and in the
  /// order of the parameters of the controller, or are written as parameter=value, where the name of the
  /// parameter may end in a unit: `turn_degps=30`. A wrong string is reported, and omitted from the result.
  /// Empty if the model does not have the property.
  std::vector<engine::ControllerSpec> controllers(const StageModel& model);

 private:
  /// Reads `velocity_bounds` or `acceleration_bounds`: [xmin xmax ymin ymax zmin zmax amin amax], in m and
  /// rad per second or per second squared. Returns the defaults of Stage if the model does not have the
  /// property.
  std::optional<std::vector<double>> drive_bounds(const StageModel& model, std::string_view key);
  /// Reads the properties that say how the robot estimates its pose (GPS or odometry). Returns false if a
  /// property is wrong.
  bool localize(const StageModel& model, const engine::FieldTable& table, engine::Record& params);
  bool is_always_on(const StageModel& model);
  std::optional<engine::Value> value(const StageProperty& property, const engine::Field& field, double to_si,
                                     int column);
  // The next three functions are defined in worldio/stage/stage_sensors.cpp. If a property is wrong, they
  // report an error and return false.
  bool add_blob_colors(const StageModel& model, const engine::DeviceKind& kind, engine::DeviceSpec& spec);
  bool add_bumpers(const StageModel& model, engine::DeviceSpec& spec);
  bool add_radio_law(const StageModel& model, const engine::DeviceKind& kind, engine::DeviceSpec& spec);
  std::optional<engine::TransducerParams> transducer(const StageModel& sensor);
  std::optional<engine::ControllerSpec> controller(std::string_view call, Where where);
  bool set_argument(const engine::Field& field, double to_si, std::string_view text,
                    std::string_view controller, Where where, engine::Value& value);

  const StageDocument& document_;
  const engine::Registry& registry_;
  StageValues& values_;
};

}  // namespace troupe::worldio
