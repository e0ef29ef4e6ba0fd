#pragma once

#include "apps/observers/observer.hpp"
#include "apps/run/run_output.hpp"
#include "troupe/simulation.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>

namespace troupe::apps {

/// Writes camera images into a folder: for each running camera, at each tick (simulation step) above 0 that
/// is a multiple of `every_ticks`, one PNG with the colours (`r0.eye-000012.300s-color.png`: body, camera,
/// simulated time) and one with the depths (`...-depth.png`; docs/sensing.md). A camera runs if the world
/// file sets it active, if a controller reads it, or after a call of Simulation::subscribe() for its body.
/// The bytes of a file depend only on the readings of the camera, its name and the tick. No image is written
/// for a camera that has no reading yet, or whose robot is not in the world (unborn or dead).
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

/// Returns the output of a run (an object with command-line options, see RunOutput) that writes camera images
/// (CameraPictures). It adds the options --camera-png and --camera-every to the command line, and writes the
/// images into the folder that --camera-png names. Without --camera-png, nothing is written.
std::unique_ptr<RunOutput> camera_output();

}  // namespace troupe::apps
