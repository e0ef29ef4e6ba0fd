#pragma once

#include "base/result.hpp"
#include "troupe/simulation.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe {

class PictureSource;

/// How a simulation is drawn. No option changes a result.
struct PictureOptions {
  /// Width, pixels. 0: 1280 x 720, or the size of the world's window with the camera `window`.
  int width = 0;
  int height = 0;  ///< height, pixels; 0 as for `width`
  /// `top`: straight down, as a map. `fit`: straight down on the region that contains the robots.
  /// `perspective`: solid bodies from an oblique angle. `follow:all`: perspective on the region that contains
  /// the robots. `follow:NAME`: perspective, centred on that model. `window`: as the world's `window`.
  std::string camera = "top";
  /// Point at the centre of the picture, m, in the world frame. Not given: the whole world is shown.
  std::optional<std::array<double, 2>> center_m;
  /// Pitch (0: straight down, pi/2: level) and yaw (counter-clockwise; 0: +y is far), rad.
  std::optional<std::array<double, 2>> angle_rad;
  /// World length across the width of the picture at its centre, m.
  std::optional<double> across_m;
  /// Layers to add to the default ones, and, with a minus, to remove: `scans,trails,-grid`.
  std::string layers;
  /// Colours robots by a value of the state, `velocity.x`; for a field of several columns by one of them:
  /// `ranger/ir.ranges.0`. Empty: robots keep their own colours.
  std::string color_by;
  /// Values at the ends of the colour scale. Not given: the least and the greatest value of each picture.
  std::optional<std::array<double, 2>> color_range;
  /// `paper` (warm white), `white`, `dark`, or `transparent` (opaque only where something is drawn).
  std::string background = "paper";

  bool operator==(const PictureOptions&) const = default;
};

/// A layer of a picture.
struct PictureLayer {
  std::string_view name;  ///< its name in PictureOptions::layers
  bool on;                ///< whether it is shown by default
  std::string_view text;  ///< description
};
/// All layers.
std::span<const PictureLayer> picture_layers();
/// Whether all names of a list of layers are known; else the error `unknown layer "scan"; known: ...`.
Result<> check_layers(const std::string& layers);
/// The names of all backgrounds.
std::span<const std::string_view> picture_backgrounds();
/// Whether a background has this name; else an error that lists the known ones.
Result<> check_background(const std::string& background);
/// Whether a camera may have this name, whatever the world; else an error that lists the known ones.
Result<> check_camera(const std::string& camera);

/// Draws pictures of one simulation:
///
///     troupe::Pictures pictures(simulation, {.camera = "perspective", .layers = "scans"});
///     simulation.run_for(60);
///     pictures.write(pictures.take(simulation), "after-a-minute.png");
///
/// take() copies a tick; draw() and write() work on the copy, possibly on another thread, while the
/// simulation goes on. None of them changes the simulation.
class Pictures {
 public:
  /// Throws InputError for options that name something that the world does not have (a model to follow, a
  /// window, a field to colour by), and std::runtime_error if the build has no renderer.
  Pictures(const Simulation& simulation, PictureOptions options);
  /// Draws a recording or another source. Throws InputError also for what the source does not contain.
  Pictures(const PictureSource& source, PictureOptions options);
  ~Pictures();
  Pictures(Pictures&&) noexcept;             ///< the source may only be destroyed or assigned
  Pictures& operator=(Pictures&&) noexcept;  ///< the source may only be destroyed or assigned

  /// Width of the pictures, pixels, from the options or the world's window.
  int width() const;
  int height() const;  ///< height of the pictures, pixels

  /// Collects data for the layers `trails` and `coverage`; without these layers it does nothing. Call it
  /// after every step.
  void see(const Simulation& simulation);
  void see(const PictureSource& source);  ///< collects data of another source
  /// Discards the collected data: trails, coverage, last poses of robots that have left the world.
  void forget();
  /// Simulated time, s, before a picture for which see() must be called: 0 if no layer needs it, infinity for
  /// the whole run.
  double history_s() const;

  struct ShotData;
  using Shot = std::shared_ptr<const ShotData>;  ///< the copy of a tick to be drawn
  /// Copies the current tick. `times_real_time` is the speed that the layer `speed` shows; 0: none.
  Shot take(const Simulation& simulation, double times_real_time = 0);
  Shot take(const PictureSource& source, double times_real_time = 0);  ///< copies the state of another source
  /// Interpolates between two ticks, with `share` from 0 to 1: poses of bodies are interpolated, everything
  /// else is that of `earlier`.
  static Shot between(const Shot& earlier, const Shot& later, double share);

  /// Throws the errors of write() for a file of this name before there is anything to draw: it writes a small
  /// picture next to the file and removes it.
  void rehearse(const std::filesystem::path& file);
  /// Draws 8-bit RGBA, row 0 on top. Throws std::runtime_error if OSMesa is missing, with the package to
  /// install, and if the size exceeds its limit. Call it from one thread at a time.
  std::vector<std::uint8_t> draw(const Shot& shot);
  /// Writes a picture that states its world, time, seed and state hash. It is written under a temporary name
  /// and renamed when complete. A file `.svg` or `.pdf` holds vector graphics (docs/pictures.md), any other
  /// is a PNG. Throws InputError for vector graphics of a perspective view; std::runtime_error if a PDF is
  /// requested and cairo is missing, with the package to install, and if the file cannot be written.
  void write(const Shot& shot, const std::filesystem::path& file);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe
