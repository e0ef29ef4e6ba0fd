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

/// Smallest width of the part of the world that a picture can show (PictureOptions::across_m), m.
inline constexpr double k_least_across_m = 1e-6;

/// How a picture of a simulation is drawn. No option changes a simulated result.
struct PictureOptions {
  /// Width, pixels. 0 or less: 1280, or, with the camera `window`, the width of the entry `window` of the
  /// world file.
  int width = 0;
  /// Height, pixels. 0 or less: 720, or, with the camera `window`, the height of the entry `window` of the
  /// world file.
  int height = 0;
  /// The view:
  /// - `top`: the whole world, from straight above, as a map
  /// - `fit`: like `top`, but only the region that contains the robots
  /// - `perspective`: the whole world, in perspective, from an oblique angle
  /// - `follow:all`: like `perspective`, but only the region that contains the robots
  /// - `follow:NAME`: like `perspective`, but with the body NAME in the centre
  /// - `window`: the view that the entry `window` of the world file describes
  std::string camera = "top";
  /// Point at the centre of the picture, m, in the world frame. Not given: the camera chooses it.
  std::optional<std::array<double, 2>> center_m = {};
  /// Pitch and yaw of the camera, rad. Pitch: 0 looks straight down, pi/2 looks horizontally. Yaw turns the
  /// camera counter-clockwise, seen from above; with a yaw of 0, +y points away from the viewer (on a map:
  /// up). Not given: the camera chooses both.
  std::optional<std::array<double, 2>> angle_rad = {};
  /// Width of the part of the world that the picture shows, measured through the centre of the picture, m.
  /// At least k_least_across_m. Not given: the camera chooses it.
  std::optional<double> across_m = {};
  /// Names of layers (picture_layers()), separated by commas: layers to show in addition to the default ones,
  /// and, with a minus sign, default layers to hide, as in `scans,trails,-grid`.
  std::string layers = {};
  /// The value that determines the colour of each robot: COMPONENT.FIELD, such as `velocity.x`, or
  /// COMPONENT.FIELD.COLUMN for one column of a field, such as `ranger/ir.ranges.0`. Components are the
  /// tables of which the state of the robots consists; each has named fields. Empty: robots have the colours
  /// of the world file.
  std::string color_by = {};
  /// Values at the two ends of the colour scale, in the unit of the value that `color_by` names: the lower
  /// value first. Not given: the smallest and the largest value in each picture. An error without `color_by`.
  std::optional<std::array<double, 2>> color_range = {};
  /// Background: `paper` (warm white), `white`, `dark`, or `transparent` (opaque only where something is
  /// drawn).
  std::string background = "paper";

  bool operator==(const PictureOptions&) const = default;
};

/// A layer of a picture: one sort of drawn data, such as the paths of the robots, that can be shown or
/// hidden.
struct PictureLayer {
  std::string_view name;  ///< name of the layer in PictureOptions::layers
  bool on;                ///< whether pictures show the layer by default
  std::string_view text;  ///< what the layer shows
};
/// Returns all layers that pictures can have, each with its default and its description.
std::span<const PictureLayer> picture_layers();
/// Returns success if all names in a list of layers (PictureOptions::layers) are known or the list is empty,
/// else the error `unknown layer "scan"; known: ...`.
Result<> check_layers(const std::string& layers);
/// Returns success if there is a background of this name, else an error that lists the known names.
Result<> check_background(const std::string& background);
/// Returns success if this is the name of a camera, else an error that lists the known names. Does not check
/// that the world has the body NAME of `follow:NAME`, or the entry `window`.
Result<> check_camera(const std::string& camera);

/// Draws pictures of one simulation:
///
///     troupe::Pictures pictures(simulation, {.camera = "perspective", .layers = "scans"});
///     simulation.run_for(60);
///     pictures.write(pictures.take(simulation), "after-a-minute.png");
///
/// take() copies the state of the current tick (time step) into a Shot. draw() and write() use only the Shot,
/// so another thread may call them while the simulation continues. No function changes the simulation. The
/// simulation passed to see() and take() must be that of the constructor or have the same world, and draw()
/// and write() need a Shot of this world: for a state with types of bodies or rangers that the world of the
/// constructor does not have, they throw std::invalid_argument. The constructor copies the static bodies:
/// after Simulation::reset(seed), which may place them elsewhere, call update_scene().
class Pictures {
 public:
  /// Throws InputError for unknown cameras, layers and backgrounds. Also throws InputError if the options
  /// name something that the world does not have: a body to follow, an entry `window`, or a field to colour
  /// by. Throws std::invalid_argument if a number in the options is not finite, if `across_m` is too small,
  /// if the first number of `color_range` is not below the second, or if `color_range` is given without
  /// `color_by`. Throws std::runtime_error if the build has no renderer.
  Pictures(const Simulation& simulation, PictureOptions options);
  /// Draws pictures of a recording or of another source (troupe/picture_source.hpp is the interface of
  /// sources). Throws as the constructor for a simulation does, and InputError also for layers and values
  /// whose data the source does not contain.
  Pictures(const PictureSource& source, PictureOptions options);
  ~Pictures();
  Pictures(Pictures&&) noexcept;             ///< a moved-from object may only be destroyed or assigned to
  Pictures& operator=(Pictures&&) noexcept;  ///< a moved-from object may only be destroyed or assigned to

  /// Width of the pictures, pixels.
  int width() const;
  int height() const;  ///< height of the pictures, pixels

  /// Collects the data of the current tick for the layers `trails` (past paths of bodies) and `coverage`
  /// (squares of the floor that robots have visited). Call it after every step. Without these layers it does
  /// nothing. If the current tick is earlier than that of the previous call, for example after a reset, the
  /// data collected before are discarded.
  void see(const Simulation& simulation);
  void see(const PictureSource& source);  ///< collects the data for `trails` and `coverage` from `source`
  /// Discards the data that see() collected for the layers `trails` and `coverage`. Also discards the last
  /// view of a camera that follows robots: such a camera keeps its last view while none of these robots is in
  /// the world.
  void forget();
  /// Copies the static bodies of the simulation again. Do not call it while another thread is in draw() or
  /// write().
  void update_scene(const Simulation& simulation);
  /// How far back in simulated time a picture looks, s. For a picture at the time t, see() must be called
  /// after every step from t - history_s() to t. For example, the layer `trails` shows the last 20 s, and
  /// needs slightly more, because it shows only some of the states. 0: see() need not be called. Infinity:
  /// see() must be called from the start of the run.
  double history_s() const;

  struct ShotData;
  using Shot = std::shared_ptr<const ShotData>;  ///< copy of the state of a tick, which draw() draws
  /// Copies the state of the current tick, with the trails and coverage that see() has collected.
  /// times_real_time: the speed that the layer `speed` shows, simulated time divided by wall time; 0: no
  /// speed is shown.
  Shot take(const Simulation& simulation, double times_real_time = 0);
  Shot take(const PictureSource& source, double times_real_time = 0);  ///< copies the state of `source`
  /// Returns a Shot for a time between two ticks. share: position of this time between the ticks, from 0
  /// (`earlier`) to 1 (`later`). The time, the poses of bodies that both shots contain, and the region that
  /// the camera shows are interpolated. Each trail ends at the interpolated position of its body. All other
  /// data are copied from `earlier`. The metadata contain no state hash. `earlier` and `later` must come from
  /// take() of the same Pictures. Throws std::invalid_argument for a null Shot, and for a share that is not
  /// from 0 to 1.
  static Shot between(const Shot& earlier, const Shot& later, double share);

  /// Checks that a file of this name, a picture or a film of pictures, can be written and can replace an
  /// existing one: writes a small picture to another file in the same folder, and removes that file. Throws
  /// as write() and draw() do. Call it before a long run, to find errors early.
  void rehearse(const std::filesystem::path& file);
  /// Returns a picture of width() x height() pixels: 8-bit RGBA, four bytes per pixel, row by row from the
  /// top. Throws std::runtime_error if OSMesa and EGL are missing (the text names the package to install),
  /// and if the size exceeds the limit of Mesa, and std::invalid_argument for a null Shot. Do not call
  /// draw() or write() while another thread is in one of them.
  std::vector<std::uint8_t> draw(const Shot& shot);
  /// Writes a picture to a file, and replaces an existing file. The name must end in `.png`, or in `.svg` or
  /// `.pdf` for vector graphics (docs/pictures.md). The metadata of the file state world, time, seed and
  /// state hash. The file is written under a temporary name and renamed when complete. Do not call draw() or
  /// write() while another thread is in one of them.
  ///
  /// Throws InputError for a name with another ending, and for vector graphics of a view that is not from
  /// straight above, and std::invalid_argument for a null Shot. Throws std::runtime_error if the file cannot
  /// be written; the exception is a std::system_error if it has the error code of the system. For PNG, also
  /// throws as draw() does. For PDF, also throws std::runtime_error if the library cairo is missing (the text
  /// names the package to install).
  void write(const Shot& shot, const std::filesystem::path& file);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe
