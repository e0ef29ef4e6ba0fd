#pragma once

#include "base/color.hpp"
#include "base/result.hpp"
#include "engine/fields/fields.hpp"
#include "engine/kinds/controller_kind.hpp"
#include "engine/kinds/device_kind.hpp"
#include "engine/kinds/drive_kind.hpp"
#include "engine/kinds/fault_kind.hpp"
#include "engine/kinds/measure_kind.hpp"

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::engine {

/// A model type of world files of the simulator Stage, such as `position` or `ranger`, with its defaults. All
/// loaders of world files use the model kinds in the list Registry::models, and therefore the same defaults.
struct ModelKind {
  std::string_view name;                ///< name in Stage files: "position"
  std::string_view text;                ///< description in one sentence, which `troupe describe` prints
  Eigen::Vector3d size{0.4, 0.4, 1.0};  ///< default size x, y, z, m
  Color color{1, 0, 0, 1};              ///< default colour
  /// Default shape of a model. True: a box of the model's size. False: no solids. A file can give a model
  /// another shape, by blocks (extruded polygons) or by a bitmap (an image of walls).
  bool has_default_body = true;
  std::string_view device;  ///< DeviceKind::name of the device that such a model adds; empty: none
  /// Table of the parameters of the device kind `device`. If `device` is empty: table of the parameters of
  /// the model itself.
  FieldTable params;
};

/// All kinds that a world can use. A registry is passed as an argument and is never global.
/// troupe/registry.cpp assembles the registry with all kinds of Troupe.
struct Registry {
  std::vector<ModelKind> models;            ///< model kinds of Stage files
  std::vector<DeviceKind> devices;          ///< kinds of sensors and of other devices
  std::vector<DriveKind> drives;            ///< kinds of drives
  std::vector<ControllerKind> controllers;  ///< kinds of controllers
  std::vector<MeasureKind> measures;        ///< kinds of measures
  std::vector<FaultKind> faults;            ///< kinds of faults

  /// A name for a controller kind with certain parameters, such as Stage's expand_swarm.
  struct Preset {
    std::string_view name;                                   ///< name in files
    std::string_view kind;                                   ///< name of the controller kind
    std::string_view text;                                   ///< one sentence that `troupe describe` prints
    std::vector<std::pair<std::string_view, Value>> params;  ///< parameters that differ from the defaults
  };
  std::vector<Preset> presets;  ///< presets; no preset has the name of a controller kind

  /// Finds a controller in the plug-ins (troupe/plugins.hpp). It is called for a name that is not in the
  /// lists above. If no plug-in has the name, it returns an error that begins with the text `unknown`;
  /// details such as the searched folders may follow. The returned kind lives as long as the registry and its
  /// copies. Empty: there are no plug-ins. A Simulation sets this callback and the two below in its copy of
  /// the registry.
  std::function<Result<const ControllerKind*>(std::string_view name, std::string unknown)>
      plugged_controllers;
  /// Callbacks that find a device or a measure in the plug-ins, in the same way as `plugged_controllers`
  /// finds a controller.
  ///@{
  std::function<Result<const DeviceKind*>(std::string_view name, std::string unknown)> plugged_devices;
  std::function<Result<const MeasureKind*>(std::string_view name, std::string unknown)> plugged_measures;
  ///@}

  /// The kind with this name in the lists above; null if there is none. device() and controller() also search
  /// the plug-ins. The name of a preset is never searched in plug-ins: controller() returns null for it. The
  /// pointer is valid as long as the lists are not changed.
  ///@{
  const ModelKind* model(std::string_view name) const;
  const DeviceKind* device(std::string_view name) const;
  const DriveKind* drive(std::string_view name) const;
  const ControllerKind* controller(std::string_view name) const;
  ///@}
  /// The device kind with this name, in the list `devices` or in a plug-in; never null. If there is none, the
  /// error is the text `unknown`, to which `plugged_devices` may add details.
  Result<const DeviceKind*> find_device(std::string_view name, std::string unknown) const;
  /// The controller kind with this name, in the list `controllers` or in a plug-in; never null. If there is
  /// none, the error begins with `unknown controller "hover"; known: expand, ...`. A preset is not a
  /// controller kind, so the name of a preset also gives this error.
  Result<const ControllerKind*> find_controller(std::string_view name) const;
  /// The measure with this name, in the list `measures` or in a plug-in; never null. If there is none, the
  /// error begins with `unknown measure "stals"; known: alive, ...`.
  Result<const MeasureKind*> find_measure(std::string_view name) const;
  /// Names of the controllers and presets in the lists, sorted.
  std::vector<std::string_view> controller_names() const;
  /// The preset, measure or fault with this name in the lists; null if there is none. Plug-ins are not
  /// searched.
  ///@{
  const Preset* preset(std::string_view name) const;
  const MeasureKind* measure(std::string_view name) const;
  const FaultKind* fault(std::string_view name) const;
  ///@}

  /// The device kinds of the list `devices` that only sense (DeviceKind::is_sensor()).
  std::vector<DeviceKind> sensors() const;
  std::vector<DeviceKind> other_devices() const;  ///< the kinds of `devices` that are not sensors
};

}  // namespace troupe::engine
