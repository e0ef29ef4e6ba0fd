#pragma once

#include "base/diagnostics.hpp"
#include "engine/kinds/kinds.hpp"
#include "engine/kinds/measure_kind.hpp"
#include "engine/spec/world_spec.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace troupe {

/// Controllers (code that commands robots) and measures (numbers computed from the state) that a program has
/// read from a script, such as a Python file. A simulation uses them as if they came from a plug-in (a shared
/// library) that has the name of the script: `my.py` with a class `Wander` gives the controller `my:Wander`,
/// and with a class `my` the controller `my`. A checkpoint (a file with the whole state of a run) stores the
/// name and the hash of the script. To resume the run, the script must be given again.
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

  /// The name under which simulations find the controllers and measures of the script, as if it were a
  /// plug-in: "my" for my.py.
  std::string name() const { return file.stem().string(); }
};

/// Makes the controllers of scripts the controllers of their robots, in place of those that the world gives
/// them. Controllers belong to types (the properties that bodies of the same construction share). Therefore
/// each controller replaces all controllers of the types of its robots. Reports an error to `diagnostics`, at
/// the line of the class, for a controller whose robots do not exist or share their type with other robots,
/// and for a second controller of one type.
void assign_controllers(std::span<const std::shared_ptr<const Script>> scripts, engine::WorldSpec& world,
                        Diagnostics& diagnostics);

}  // namespace troupe
