#pragma once

#include "apps/observers/observer.hpp"
#include "apps/run/run_output.hpp"
#include "troupe/simulation.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>

namespace troupe::apps {

/// Writes the images of robots' cameras into a folder, as PNG files. Images are written at each tick
/// (time step) above 0 that is a multiple of `every_ticks`. Each running camera then has two files.
/// `r0.eye-000012.300s-color.png` has the colours, and `r0.eye-000012.300s-depth.png` the depths
/// (docs/sensing.md). In these names, `r0` is the robot, `eye` the camera, and 12.3 s the simulated time.
///
/// A camera runs if the world file sets it active, if a controller reads it, or if Simulation::subscribe()
/// was called for its robot. No image is written before the first reading of the camera, while its robot is
/// not in the world (unborn or dead), or while the camera is stopped: its robot is disabled, a fault has
/// broken the camera, it is switched off, or it has no power. The bytes of a file depend only on the tick,
/// and on the name and the readings of the camera.
class CameraPictures : public Observer {
 public:
  /// Creates the folder if it does not exist; its parent folder must exist. every_ticks: interval of the
  /// images, ticks, at least 1. Throws OutputError if the folder cannot be created.
  CameraPictures(std::filesystem::path folder, std::uint64_t every_ticks);

  void observe(const Simulation& simulation) override;
  bool reads_robots() const override { return false; }  // observe() fetches the robots at each interval

 private:
  std::filesystem::path folder_;
  std::uint64_t every_ticks_;
};

/// Returns the RunOutput for camera images (CameraPictures). A RunOutput is one output of a run, together
/// with its command-line options. The option --camera-png names the folder, and --camera-every sets the
/// interval of the images in simulated seconds. Without --camera-png, nothing is written.
std::unique_ptr<RunOutput> camera_output();

}  // namespace troupe::apps
