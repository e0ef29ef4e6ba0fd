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

/// Controllers and devices in shared libraries (docs/controllers.md), found by name: "dancer" is the
/// controller, or the sensor, of that name in dancer.so, "swarm:leader" one of those in swarm.so; the file is
/// the first of its name on a path.
///
/// A library that was loaded stays loaded as long as the process lives. After each load the floating-point
/// environment of the calling thread is what it was: a library linked with -ffast-math switches denormal
/// numbers off. Not thread-safe.
class Plugins {
 public:
  /// A library in use.
  struct Library {
    std::string name;            ///< of the file, without .so
    std::filesystem::path file;  ///< where it was found
    std::uint64_t contents = 0;  ///< hash of the file's bytes
  };

  /// Looks in these folders, in their order. Names of the registry's controllers, and of its devices, are not
  /// given away again.
  Plugins(std::vector<std::filesystem::path> path, const engine::Registry& registry);
  ~Plugins();
  Plugins(const Plugins&) = delete;
  Plugins& operator=(const Plugins&) = delete;

  /// Registry::plugged_controllers.
  Result<const engine::ControllerKind*> controller(std::string_view name, std::string unknown);
  /// Registry::plugged_devices.
  Result<const engine::DeviceKind*> device(std::string_view name, std::string unknown);
  /// The library of this name, loaded, never null; where there is none that can be used, why:
  /// `there is no dancer.so in plugins, /opt/swarm`, `plugins/dancer.so was built for troupe 0.2.0, ...`.
  Result<const Library*> load(std::string_view name);

  /// Those in use, in the order of their names.
  std::vector<Library> libraries() const;
  /// What loading them did that should not be, as `dancer.so: warning: ...`.
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

/// Lets a registry, and its copies, find controllers and devices on this path.
std::shared_ptr<Plugins> add_plugins(engine::Registry& registry, std::vector<std::filesystem::path> path);

}  // namespace troupe
