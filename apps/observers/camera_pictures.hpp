#pragma once

#include "apps/observers/observer.hpp"
#include "apps/run/run_output.hpp"
#include "troupe/simulation.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>

namespace troupe::apps {

/// Writes camera images into a folder: for each running camera, at each tick above 0 that is a multiple of
/// `every_ticks`, one PNG with the colours (`r0.eye-000012.300s-color.png`: body, camera, world time) and one
/// with the depths (`...-depth.png`; docs/sensing.md). The bytes of a file depend only on the readings of the
/// camera, its name and the tick. No image is written for a camera that has no reading yet, or whose robot is
/// not in the world (unborn or dead).
class CameraPictures : public Observer {
 public:
  /// Creates the folder if it does not exist; its parent folder must exist. every_ticks: interval of the
  /// images, ticks, at least 1. Throws OutputError if creating the folder fails.
  CameraPictures(std::filesystem::path folder, std::uint64_t every_ticks);

  void observe(const Simulation& simulation) override;

 private:
  std::filesystem::path folder_;
  std::uint64_t every_ticks_;
};

/// Returns a new output with the options --camera-png and --camera-every.
std::unique_ptr<RunOutput> camera_output();

}  // namespace troupe::apps
