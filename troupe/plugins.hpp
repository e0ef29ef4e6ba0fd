#pragma once

#include "base/result.hpp"
#include "engine/kinds/registry.hpp"
#include "troupe/script.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe {

/// Loads kinds by name from plug-ins, which are shared libraries in certain folders (docs/controllers.md). A
/// kind is an implementation of a controller, of a sensor or other device, or of a measure (a number computed
/// from the state). Several threads may call its functions at the same time.
///
/// The name "dancer" refers to the kind "dancer" in dancer.so, and "swarm:leader" to the kind "leader" in
/// swarm.so. If several folders have a file dancer.so, the first of these folders is used. A script (such as
/// a Python file) that add() has added also counts as a library.
///
/// A library stays loaded until the process ends. If a library was linked with -ffast-math, loading it
/// switches denormal numbers off in the calling thread. Plugins then restores the floating-point environment
/// of this thread.
class Plugins {
 public:
  /// A loaded library or an added script.
  struct Library {
    std::string name;            ///< name of the file without its ending, .so or .py
    std::filesystem::path file;  ///< path of the library or script
    std::uint64_t contents = 0;  ///< hash of the file's bytes
  };

  /// path: the folders to search, in this order. registry: the kinds that the program already has. A plug-in
  /// cannot be used if one of its controllers has the same name as a controller in `registry`. The name is
  /// the one that world files use: "dancer", "swarm:leader". The same rule applies to devices and to
  /// measures.
  Plugins(std::vector<std::filesystem::path> path, const engine::Registry& registry);
  ~Plugins();
  Plugins(const Plugins&) = delete;
  Plugins& operator=(const Plugins&) = delete;

  /// Returns the controller of this name, such as "dancer" or "swarm:leader". The first call for a library
  /// loads it. The pointer is never null and is valid while this object lives. If there is no library for the
  /// name, the error begins with the text `unknown`, lists the searched folders, and says how to give a
  /// script. A registry (the list of the kinds that a world can use) calls this function for names that it
  /// does not contain (Registry::plugged_controllers).
  Result<const engine::ControllerKind*> controller(std::string_view name, std::string unknown);
  /// Returns the sensor or other device of this name, as controller() does for controllers. Scripts contain
  /// none.
  Result<const engine::DeviceKind*> device(std::string_view name, std::string unknown);
  /// Returns the measure of this name, as controller() does for controllers.
  Result<const engine::MeasureKind*> measure(std::string_view name, std::string unknown);
  /// Returns the error for a name that no controller, device or measure has. It is that of controller(), but
  /// if the library of the name exists, it lists the kinds of all these sorts that the library has.
  std::string unknown_kind(std::string_view name, std::string unknown);
  /// Adds the controllers and measures of a script, as if they came from a loaded library with the name of
  /// the script. Throws InputError if this name is not valid or already in use. Also throws InputError if the
  /// script defines no controller and no measure, two of them with the same name, or one with a name that
  /// Troupe uses.
  void add(std::shared_ptr<const Script> script);
  /// Loads the library of this name unless it is loaded, and returns it. The pointer is never null and is
  /// valid while this object lives. The error states why the library cannot be used, for example `there is no
  /// dancer.so in plugins, /opt/swarm` or `plugins/dancer.so was built for troupe 0.3.0, ...`.
  /// may_be_script: whether the error for a missing library also says how to give a script.
  Result<const Library*> load(std::string_view name, bool may_be_script);

  /// The loaded libraries and added scripts whose kinds this program can use, in the order of their names.
  /// Libraries whose loading failed are not in the list.
  std::vector<Library> libraries() const;
  /// Warnings about side effects of loading a library, such as a changed floating-point environment:
  /// `plugins/dancer.so: warning: ...`.
  std::vector<std::string> warnings() const;

 private:
  struct KindNames;
  template <class K>
  struct Group;
  struct Loaded;
  // The caller of these functions must hold mutex_.
  Loaded& add_library(std::string_view name);
  Loaded& loaded(std::string_view name);
  Result<> open(Loaded& library);
  struct Kinds;
  Result<> keep_kinds(Loaded& library, Kinds kinds) const;
  template <class K>
  Result<const K*> find(std::string_view name, Group<K> Loaded::*group, std::string unknown);

  std::vector<std::filesystem::path> path_;
  std::vector<std::string> taken_controllers_, taken_devices_, taken_measures_;
  mutable std::mutex mutex_;                                            // for the members below
  std::map<std::string, std::unique_ptr<Loaded>, std::less<>> loaded_;  // by name
  std::vector<std::string> warnings_;
};

/// Lets `registry` use the kinds of `scripts`, and load controllers, devices and measures from plug-ins in
/// the folders `path`. Copies of `registry` that are made after this call can do the same. Returns the object
/// that loads the kinds. `registry` and its copies keep this object alive. Throws InputError as
/// Plugins::add() does. Throws std::invalid_argument if a script is null. Also throws std::invalid_argument
/// if a kind or a preset of the registry is wrong, for example because a kind, or a parameter of a kind, has
/// a name that JSON worlds, checkpoints or recordings use for another purpose (worldio/json/kind_checks.hpp).
std::shared_ptr<Plugins> add_plugins(engine::Registry& registry, std::vector<std::filesystem::path> path,
                                     std::span<const std::shared_ptr<const Script>> scripts = {});

}  // namespace troupe
