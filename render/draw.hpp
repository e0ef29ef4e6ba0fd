#pragma once

#include "engine/frame.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace troupe::render {

/// The viewpoint of a picture. By default straight down, framed automatically.
struct Camera {
  bool perspective = false;
  double pitch = 0;  ///< rad: 0 straight down, pi/2 level
  double yaw = 0;    ///< rad: counter-clockwise from looking along +y
  /// World point in the picture's centre, m. Not given: framed automatically.
  std::optional<Eigen::Vector3d> center;
  /// Width of the picture at the centre, m. Not given: the scene fits.
  std::optional<double> across_m;
  /// World position of a perspective camera, m; replaces `center` and `across_m`.
  std::optional<Eigen::Vector3d> eye;
  double fov = 0.65;  ///< vertical angle of a perspective view, rad
};

/// Background of a picture. With `transparent`, empty pixels have opacity 0.
enum class Background : std::uint8_t { paper, white, dark, transparent };

/// Layers to draw in addition to the bodies.
struct Layers {
  bool grid = true;
  bool shadows = true;
  bool headings = true;  ///< a mark at the front of each robot
  bool stalls = true;    ///< a red outline with a white rim around robots whose last motion was blocked
  bool scale = true;
  bool clock = true;
  bool speed = false;   ///< speed next to the clock: Frame::times_real_time
  bool legend = true;   ///< legend of the colour scale, if bodies are coloured by a value
  bool bounds = true;   ///< boundary of the area for robots: FrameScene::limits
  bool types = false;   ///< legend of the types of robots, if they are not coloured by a value
  bool scans = false;   ///< transparent areas of range readings: Frame::scans
  bool beams = false;   ///< range readings as lines: Frame::scans
  bool sights = false;  ///< lines from finders to detected objects: Frame::sights
  bool blobs = false;   ///< blobs of blob finders in their colours: Frame::blobs
  bool grips = false;   ///< light beams of grippers (red if broken) and links to held bodies: Frame::grips
  bool links = false;   ///< lines from carriers to carried bodies: Frame::links
  bool trails = false;  ///< past positions of bodies: Frame::trails
  bool names = false;   ///< Frame::names
  bool energy = false;  ///< bars of the remaining energy: Frame::charges
  bool footprints = false;  ///< outlines of the bodies on the floor
  bool coverage = false;    ///< squares of the floor that robots have visited: Frame::covered
  bool density = false;     ///< number of robots per square of the floor
  bool tiles = false;       ///< number of robots per tile of the index
  bool cells = false;       ///< cells of the index that contain a robot
};

struct View {
  int width = 1280;
  int height = 720;
  /// World region that must be visible, m. It fills the picture in one direction; in the other, more is
  /// visible. Not given: the scene's bounds with a margin. The camera's `center`, `across_m` and
  /// `eye` take precedence.
  std::optional<Box> region;
  Camera camera;
  Layers layers;
  Background background = Background::paper;
  /// Values at the ends of the colour scale, if bodies are coloured by a value. Not given: the extremes in
  /// the frame.
  std::optional<std::pair<double, double>> values;
};

/// Whether the view is a map, straight down without perspective. Only maps can be drawn as vector graphics.
bool is_from_above(const Camera& camera);

/// Metadata of a file as keys and values: `world`, `time_s`, ...
using FileTexts = std::vector<std::pair<std::string, std::string>>;
enum class VectorFormat : std::uint8_t { svg, pdf };

/// 8-bit RGBA, row 0 at the top, alpha not premultiplied.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;
};

/// Draws frames of one scene. Data common to all pictures are computed once.
///
/// view    from above (a camera at pitch and yaw 0 without perspective): +x to the right and +y up, bodies as
/// flat
///         shapes, robots on top of the floor plan at any height. Other views: solids with lit faces and
///         edges, with hidden surfaces removed
/// robots  at least 3.5 pixels wide, so that a swarm stays visible; outlines from 7 pixels on, marks from 9;
///         a red outline when stalled
/// errors  std::runtime_error: OSMesa (loaded on first use) is missing, with the package to install; a size
/// above
///         the driver's limit, with the limit; a region that is not finite or has no area
/// checks  equal bytes for equal input on one machine; the caller's floating-point environment is restored;
/// may be
///         called on any thread, but only by one at a time
class Painter {
 public:
  explicit Painter(engine::FrameScene scene);
  ~Painter();
  Painter(Painter&&) noexcept;
  Painter& operator=(Painter&&) noexcept;

  const engine::FrameScene& scene() const;
  Picture draw(const engine::Frame& frame, const View& view);
  /// Draws a view from above as vector graphics and returns the content of an SVG 1.1 or PDF file. Its size
  /// is that of the view in pixels of 1/96 inch. Throws std::runtime_error also for other views, and for a
  /// PDF if cairo is missing, with the package to install.
  std::string draw_vector(const engine::Frame& frame, const View& view, VectorFormat format,
                          const FileTexts& texts);

 private:
  struct Composition;
  Composition compose(const engine::Frame& frame, const View& view);

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Draws one picture. Thread-safe.
Picture draw(const engine::FrameScene& scene, const engine::Frame& frame, const View& view);

}  // namespace troupe::render
