#pragma once

#include "engine/kinds.hpp"
#include "engine/sensor_params.hpp"
#include "engine/world_spec.hpp"
#include "worldio/stage/stage_models.hpp"
#include "worldio/stage/stage_values.hpp"

#include <optional>
#include <string_view>
#include <vector>

namespace troupe::worldio {

/// Turns what Stage says of rangers, drives and controllers into the parameters of our kinds, by field name.
class StageKinds {
 public:
  StageKinds(const StageDocument& document, const engine::Registry& registry, StageValues& values)
      : document_(document), registry_(registry), values_(values) {}

  /// Seconds between updates; 0: every tick.
  double period_s(const StageModel& model);

  /// Of a ranger and its `sensor` children; empty, with a warning, when it has none.
  std::optional<engine::DeviceSpec> ranger(const StageModel& model, const std::vector<StageModel>& sensors);
  /// Of a model that is a device of this kind; empty, with errors, where its properties are wrong.
  std::optional<engine::DeviceSpec> device(const StageModel& model, const engine::DeviceKind& kind);
  /// Of a gripper whose model is of this size.
  std::optional<engine::DeviceSpec> gripper(const StageModel& model, const engine::DeviceKind& kind,
                                            const Eigen::Vector3d& size);
  std::optional<engine::DriveSpec> drive(const StageModel& model);
  /// Of a position inside another model, which has a drive of its own; empty, with errors, where its
  /// properties are wrong.
  std::optional<engine::DeviceSpec> wheels(const StageModel& model, const engine::DeviceKind& kind);
  /// Of the words of `ctrl`: "name arguments", the arguments in the order of the kind's parameters or as
  /// parameter=value.
  std::vector<engine::ControllerSpec> controllers(const StageModel& model);

 private:
  /// [xmin xmax ymin ymax zmin zmax amin amax], m and rad a second or a second squared; Stage's where the
  /// model does not say, empty where it says them wrongly.
  std::optional<std::vector<double>> drive_bounds(const StageModel& model, std::string_view key);
  /// How the robot knows its pose; false where the model says it wrongly.
  bool localize(const StageModel& model, const engine::FieldTable& table, engine::Record& params);
  bool is_always_on(const StageModel& model);
  std::optional<engine::Value> value(const StageProperty& property, const engine::Field& field, double to_si,
                                     int column);
  // worldio/stage/stage_sensors.cpp; each says whether what it read is right.
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
