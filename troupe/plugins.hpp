#pragma once

#include "base/result.hpp"
#include "engine/kinds.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe {

/// Loads controllers and devices from shared libraries (docs/controllers.md) by name: "dancer" is the kind of
/// that name in dancer.so, "swarm:leader" the kind "leader" in swarm.so. The first file of that name on the
/// path is used.
///
/// A loaded library stays loaded until the process ends. Each load restores the floating-point environment of
/// the calling thread, because a library linked with -ffast-math switches denormal numbers off. Not
/// thread-safe.
class Plugins {
 public:
  /// A loaded library.
  struct Library {
    std::string name;            ///< name of the file, without .so
    std::filesystem::path file;  ///< where it was found
    std::uint64_t contents = 0;  ///< hash of the file's bytes
  };

  /// Searches these folders, in this order. Kinds of the registry keep their names: plug-ins cannot replace
  /// them.
  Plugins(std::vector<std::filesystem::path> path, const engine::Registry& registry);
  ~Plugins();
  Plugins(const Plugins&) = delete;
  Plugins& operator=(const Plugins&) = delete;

  /// The controller of this name, for Registry::plugged_controllers.
  Result<const engine::ControllerKind*> controller(std::string_view name, std::string unknown);
  /// The device of this name, for Registry::plugged_devices.
  Result<const engine::DeviceKind*> device(std::string_view name, std::string unknown);
  /// Loads the library of this name; the pointer is never null. The error states why it cannot be used:
  /// `there is no dancer.so in plugins, /opt/swarm`, `plugins/dancer.so was built for troupe 0.2.0, ...`.
  Result<const Library*> load(std::string_view name);

  /// The loaded libraries, in the order of their names.
  std::vector<Library> libraries() const;
  /// Warnings about side effects of loading, `dancer.so: warning: ...`.
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  struct Loaded;
  Loaded& loaded(std::string_view name);
  Result<> open(Loaded& library);
  using List = void (*)(std::vector<engine::ControllerKind>&, std::vector<engine::DeviceKind>&);
  Result<> read_kinds(Loaded& library, List list) const;
  template <class Kinds>
  auto find(std::string_view name, Kinds Loaded::*kinds, std::string unknown)
      -> Result<const typename Kinds::Kind*>;

  std::vector<std::filesystem::path> path_;
  std::vector<std::string> taken_controllers_, taken_devices_;
  std::vector<std::unique_ptr<Loaded>> loaded_;
  std::vector<std::string> warnings_;
};

/// Lets a registry, and its copies, load controllers and devices from this path.
std::shared_ptr<Plugins> add_plugins(engine::Registry& registry, std::vector<std::filesystem::path> path);

}  // namespace troupe
