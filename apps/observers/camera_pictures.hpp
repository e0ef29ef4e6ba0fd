#pragma once

#include "apps/observers/observer.hpp"
#include "apps/run/run_output.hpp"
#include "troupe/simulation.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>

namespace troupe::apps {

/// What cameras see, as pictures in a folder: for each camera and time one PNG of its colours and one of its
/// depths, `r0.eye-000012.300s-color.png` and `-depth.png` (docs/sensing.md). Their bytes depend on the
/// readings alone. Every camera that runs has its picture taken, from the first tick on in which it has
/// looked.
class CameraPictures : public Observer {
 public:
  /// Makes the folder where it is not there. Throws OutputError where it cannot.
  CameraPictures(std::filesystem::path folder, std::uint64_t every_ticks);

  void observe(const Simulation& simulation) override;

 private:
  std::filesystem::path folder_;
  std::uint64_t every_ticks_;
};

/// --camera-png and --camera-every.
std::unique_ptr<RunOutput> camera_output();

}  // namespace troupe::apps
