#pragma once

#include "base/diagnostics.hpp"
#include "engine/kinds/controller_kind.hpp"
#include "engine/kinds/measure_kind.hpp"
#include "engine/spec/world_spec.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe {

/// A script, such as a Python file, with controllers (code that commands robots) and measures (numbers
/// computed from the state). A simulation uses a script like a plug-in (a shared library) of the same name.
/// For example, the class `Wander` in my.py is the controller `my:Wander`, and the class `my` in my.py is the
/// controller `my`.
///
/// A checkpoint (a file with the whole state of a run) stores only the name and the hash of the script. To
/// resume the run, the script must be given again.
struct Script {
  /// A controller of the script, and the robots that get it.
  struct Controller {
    engine::ControllerKind kind;  ///< the controller, with the name of its class
    std::string robots;           ///< name of a type, population or robot; empty: all types with a drive
    std::uint32_t line = 0;       ///< line of the class in the file
  };
  std::filesystem::path file;                 ///< path of the script
  std::uint64_t contents = 0;                 ///< hash of the bytes of the file
  std::vector<Controller> controllers;        ///< controllers of the script, in the order of the file
  std::vector<engine::MeasureKind> measures;  ///< measures of the script, in the order of the file

  /// The name of the script, by which simulations find its controllers and measures: "my" for my.py.
  std::string name() const { return file.stem().string(); }
  /// The name that a controller or measure of this script has in worlds: "my:Wander" for the class `Wander`
  /// in my.py, "my" for the class `my`.
  std::string name_in_worlds(std::string_view own_name) const {
    return own_name == name() ? name() : name() + ":" + std::string(own_name);
  }
};

/// Gives each controller of the scripts to its robots (Script::Controller::robots). The controller replaces
/// all controllers that the world gives to the types of these robots, because all robots of a type have the
/// same controllers. If one of them is this same controller, it keeps the parameters that the world gives.
/// Otherwise the parameters have their defaults. A type states the properties that bodies of the same
/// construction share.
///
/// Reports an error to `diagnostics`, at the line of the class of the controller, in these cases:
/// - The world has no robots with the name that the script gives.
/// - Other robots have the same type as the robots of the controller.
/// - Another controller of a script has already been given to the type.
/// It also reports an error for each intervention that sets parameters of a replaced controller, at the line
/// of the intervention.
void assign_controllers(std::span<const std::shared_ptr<const Script>> scripts, engine::WorldSpec& world,
                        Diagnostics& diagnostics);

}  // namespace troupe
