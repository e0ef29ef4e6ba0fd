#pragma once

#include "base/result.hpp"
#include "engine/kinds/kinds.hpp"
#include "troupe/script.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe {

/// Loads kinds by name from plug-ins, which are shared libraries (docs/controllers.md). A kind is an
/// implementation of a controller, of a sensor or other device, or of a measure (a number computed from the
/// state). The name "dancer" refers to the kind "dancer" in dancer.so, and "swarm:leader" to the kind
/// "leader" in swarm.so. Scripts (such as Python files) that add() has added also count as libraries. If
/// several of the searched folders have a file dancer.so, the one in the first of these folders is used.
///
/// A library stays loaded until the process ends. After each load, the floating-point environment of the
/// calling thread is restored, because a library that was linked with -ffast-math switches denormal numbers
/// off. Not thread-safe.
class Plugins {
 public:
  /// A loaded library or an added script.
  struct Library {
    std::string name;            ///< name of the file without its ending, .so or .py
    std::filesystem::path file;  ///< path of the library or script
    std::uint64_t contents = 0;  ///< hash of the file's bytes
  };

  /// path: the folders to search, in this order. registry: the kinds that the program already has. A plug-in
  /// cannot be used if the name of one of its controllers in worlds ("dancer", "swarm:leader") is also the
  /// name of a controller in `registry`. The same holds for devices and for measures.
  Plugins(std::vector<std::filesystem::path> path, const engine::Registry& registry);
  ~Plugins();
  Plugins(const Plugins&) = delete;
  Plugins& operator=(const Plugins&) = delete;

  /// Returns the controller of this name; loads its library at the first call. A registry, which lists the
  /// kinds that a world can use, calls this function through Registry::plugged_controllers for a name that is
  /// not in its list. The pointer is never null and is valid while this object lives. unknown: the text with
  /// which the error begins if there is no such plug-in; the searched folders follow.
  Result<const engine::ControllerKind*> controller(std::string_view name, std::string unknown);
  /// Returns the sensor or other device of this name, as controller() does for controllers. A registry calls
  /// this function through Registry::plugged_devices.
  Result<const engine::DeviceKind*> device(std::string_view name, std::string unknown);
  /// Returns the measure of this name, as controller() does for controllers. A registry calls this function
  /// through Registry::plugged_measures.
  Result<const engine::MeasureKind*> measure(std::string_view name, std::string unknown);
  /// Adds the controllers and measures of a script, as if they came from a loaded library with the name of
  /// the script. Throws InputError if this name is not valid or already in use, and if the script defines no
  /// kind, two kinds of one name, or a kind with a name that Troupe uses.
  void add(std::shared_ptr<const Script> script);
  /// Loads the library of this name unless it is loaded, and returns it. The pointer is never null and is
  /// valid while this object lives. The error states why the library cannot be used: `there is no dancer.so
  /// in plugins, /opt/swarm`, `plugins/dancer.so was built for troupe 0.2.0, ...`.
  Result<const Library*> load(std::string_view name);

  /// The loaded libraries and added scripts whose kinds this program can use, in the order of their names.
  /// Libraries whose loading failed are not in the list.
  std::vector<Library> libraries() const;
  /// Warnings about side effects of loading a library, such as a changed floating-point environment:
  /// `plugins/dancer.so: warning: ...`.
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  struct Loaded;
  Loaded& loaded(std::string_view name);
  Result<> open(Loaded& library);
  struct Kinds;
  Result<> keep_kinds(Loaded& library, Kinds kinds) const;
  template <class Group>
  auto find(std::string_view name, Group Loaded::*kinds, std::string unknown)
      -> Result<const typename Group::Kind*>;

  std::vector<std::filesystem::path> path_;
  std::vector<std::string> taken_controllers_, taken_devices_, taken_measures_;
  std::vector<std::unique_ptr<Loaded>> loaded_;
  std::vector<std::string> warnings_;
};

/// Allows `registry`, and later copies of it, to use the kinds of the scripts `scripts` and to load
/// controllers, devices and measures from plug-ins in the folders `path`. Returns the object that loads them,
/// which the registry also owns. Throws InputError as Plugins::add() does, and std::invalid_argument if a
/// kind of the registry, or a parameter of such a kind, has a name that JSON worlds, checkpoints or
/// recordings use for another purpose (worldio/json/kind_keys.hpp).
std::shared_ptr<Plugins> add_plugins(engine::Registry& registry, std::vector<std::filesystem::path> path,
                                     std::span<const std::shared_ptr<const Script>> scripts = {});

}  // namespace troupe
