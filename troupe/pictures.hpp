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

/// How pictures of a simulation look. Nothing of it changes a result.
struct PictureOptions {
  /// Pixels; 0: 1280 x 720, or what the world's window asks for where the camera is that.
  int width = 0;
  int height = 0;  ///< as that
  /// `top`: straight down, as a map. `fit`: the same of the part in which robots are. `perspective`: solids,
  /// seen from the side. `follow:all`: the same of the part in which robots are. `follow:NAME`: in
  /// perspective, with that model in the middle. `window`: as the world's own `window` says.
  std::string camera = "top";
  /// What is in the picture's middle, world metres. Not given: everything is in the picture.
  std::optional<std::array<double, 2>> center_m;
  /// Pitch (0 straight down, pi/2 level) and yaw (counter-clockwise; 0: +y is far), rad.
  std::optional<std::array<double, 2>> angle_rad;
  /// Metres that the picture's width shows in its middle.
  std::optional<double> across_m;
  /// `scans,trails,-grid`: layers to be shown beside those that are, and with a minus not to be shown.
  std::string layers;
  /// Robots have the colour of a value of the state, `velocity.x`; of a field of several columns one:
  /// `ranger/ir.ranges.0`. Empty: their own colours.
  std::string color_by;
  /// The values at the ends of the scale of colours. Not given: those of each picture.
  std::optional<std::array<double, 2>> color_range;
  /// `paper` (warm white), `white`, `dark`, or `transparent`: nothing is opaque but what is drawn.
  std::string background = "paper";

  bool operator==(const PictureOptions&) const = default;
};

/// One of the layers of a picture.
struct PictureLayer {
  std::string_view name;  ///< as `layers` says it
  bool on;                ///< unless it is asked for otherwise
  std::string_view text;  ///< what it shows
};
/// All that there are.
std::span<const PictureLayer> picture_layers();
/// Whether all of a list of layers are known; else `unknown layer "scan"; known: ...`.
Result<> check_layers(const std::string& layers);
/// The names of backgrounds.
std::span<const std::string_view> picture_backgrounds();
/// Whether there is such a background; else which there are.
Result<> check_background(const std::string& background);
/// Whether a camera may have this name, whatever the world; else which there are.
Result<> check_camera(const std::string& camera);

/// Pictures of one simulation, any number:
///
///     troupe::Pictures pictures(simulation, {.camera = "perspective", .layers = "scans"});
///     simulation.run_for(60);
///     pictures.write(pictures.take(simulation), "after-a-minute.png");
///
/// take() copies a tick; draw() and write() then work on the copy, on another thread if that is wanted, while
/// the simulation goes on. They change nothing of it.
class Pictures {
 public:
  /// Throws InputError for what the world has not (a model to follow, a window, a field to colour by), and
  /// std::runtime_error where the build draws no pictures.
  Pictures(const Simulation& simulation, PictureOptions options);
  /// Of a recording, or whatever else there is to see. What is not in it is an InputError, too.
  Pictures(const PictureSource& source, PictureOptions options);
  ~Pictures();
  Pictures(Pictures&&) noexcept;             ///< the one moved from is of no use
  Pictures& operator=(Pictures&&) noexcept;  ///< as that

  /// In pixels, as the options or the world's window say.
  int width() const;
  int height() const;  ///< as that

  /// To be called after every step, where trails or coverage are to be shown: they are made of what is seen
  /// here. Does nothing else.
  void see(const Simulation& simulation);
  void see(const PictureSource& source);  ///< the same
  /// Forgets what it saw: trails, coverage, where a robot was that is not there any more.
  void forget();
  /// How far back see() should reach, simulated seconds: 0 where nothing is made of it, infinity for all.
  double history_s() const;

  struct ShotData;
  using Shot = std::shared_ptr<const ShotData>;  ///< a tick, as it will be drawn
  /// Copies one. `times_real_time` is what the clock tells with the layer `speed`; 0: nothing.
  Shot take(const Simulation& simulation, double times_real_time = 0);
  Shot take(const PictureSource& source, double times_real_time = 0);  ///< the same
  /// Between two ticks, where `share` goes from 0 to 1: bodies at poses between theirs, everything else as in
  /// the earlier.
  static Shot between(const Shot& earlier, const Shot& later, double share);

  /// Throws what write() would throw for a file of this name, before there is anything to draw: writes a
  /// small picture beside it and removes that.
  void rehearse(const std::filesystem::path& file);
  /// 8-bit RGBA, row 0 on top. Throws std::runtime_error where OSMesa is missing, with the package to
  /// install, and where the size is beyond what it draws. Of one thread at a time.
  std::vector<std::uint8_t> draw(const Shot& shot);
  /// A picture that says of which world, time, seed and state it is; written beside its name and renamed when
  /// it is whole. A file `.svg` or `.pdf` holds paths and letters (docs/pictures.md), any other is a PNG.
  /// Throws InputError where paths are wanted of what is no map, std::runtime_error where a PDF is wanted and
  /// cairo is missing, with the package to install, and where the file cannot be written.
  void write(const Shot& shot, const std::filesystem::path& file);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe
