#pragma once

#include "engine/frame.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace troupe::render {

/// From where a picture is seen. All of it at its default: straight down, framed by itself.
struct Camera {
  bool perspective = false;
  double pitch = 0;  ///< rad: 0 straight down, pi/2 level
  double yaw = 0;    ///< rad: counter-clockwise from a view whose far side is +y
  /// What is in the picture's middle, world metres. Not given: framed.
  std::optional<Eigen::Vector3d> center;
  /// Metres that the picture's width shows there. Not given: as many as show the scene.
  std::optional<double> across_m;
  /// Where a perspective camera stands, world metres, instead of both.
  std::optional<Eigen::Vector3d> eye;
  double fov = 0.65;  ///< of a perspective view, vertical, rad
};

/// What a picture lies on. Of `transparent`, what nothing is drawn on has an opacity of 0.
enum class Background : std::uint8_t { paper, white, dark, transparent };

/// What is drawn beside the bodies.
struct Layers {
  bool grid = true;
  bool shadows = true;
  bool headings = true;  ///< a mark at the front of each robot
  bool stalls = true;    ///< a red outline with a white rim around robots whose last motion was blocked
  bool scale = true;
  bool clock = true;
  bool speed = false;       ///< beside the clock: Frame::times_real_time
  bool legend = true;       ///< of the colours, where bodies are coloured by a value
  bool bounds = true;       ///< the line beyond which no robot may go: FrameScene::limits
  bool types = false;       ///< a legend of the types of robots, where they are not coloured by a value
  bool scans = false;       ///< what rangers see, filled and transparent: Frame::scans
  bool beams = false;       ///< the same, each beam a line
  bool sights = false;      ///< lines from finders to what they found: Frame::sights
  bool blobs = false;       ///< what blob finders see, in its colours: Frame::blobs
  bool grips = false;       ///< light beams of grippers, red where broken, and what they hold: Frame::grips
  bool links = false;       ///< lines from carriers to what they carry: Frame::links
  bool trails = false;      ///< where bodies were: Frame::trails
  bool names = false;       ///< Frame::names
  bool energy = false;      ///< bars of what bodies have left: Frame::charges
  bool footprints = false;  ///< outlines on the floor below the bodies
  bool coverage = false;    ///< where on the floor robots have been: Frame::covered
  bool density = false;     ///< how many robots there are in squares of the floor
  bool tiles = false;       ///< the same in the tiles of the index
  bool cells = false;       ///< its cells in which a robot is
};

struct View {
  int width = 1280;
  int height = 720;
  /// What must be seen, world metres: it fills the picture in one direction, and in the other more than it is
  /// seen. Not given: the scene's bounds with a margin. Of a camera with no place of its own.
  std::optional<Box> region;
  Camera camera;
  Layers layers;
  Background background = Background::paper;
  /// The values at the ends of the scale of colours, where bodies are coloured by a value. Not given: those
  /// that are met in the frame.
  std::optional<std::pair<double, double>> values;
};

/// Straight down, as a map: the only view that can be drawn as paths.
bool is_from_above(const Camera& camera);

/// What a file says of itself: `world`, `time_s`, ...
using FileTexts = std::vector<std::pair<std::string, std::string>>;
enum class VectorFormat : std::uint8_t { svg, pdf };

/// 8-bit RGBA, row 0 on top; opacity is not multiplied into the colours.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;
};

/// Draws frames of one scene; what many pictures have in common is made once.
///
/// view    from above (a camera at pitch and yaw 0 without perspective): +x to the right and +y up, bodies as
///         flat shapes, robots on top of the floor plan at any height. From elsewhere: solids with lit faces
///         and edges, which hide what is behind them
/// robots  at least 3.5 pixels wide, so that a swarm stays visible; outlines from 7 pixels on, marks from 9;
///         a red outline when stalled
/// errors  std::runtime_error: no OSMesa (it is opened on first use), with the package to install; a size
///         beyond what the driver draws, with the limit; a region that is not finite or has no size
/// checks  the same bytes for the same input on one machine; the caller's floating-point environment is
///         left as it was; may be called on any thread, on one at a time
class Painter {
 public:
  explicit Painter(engine::FrameScene scene);
  ~Painter();
  Painter(Painter&&) noexcept;
  Painter& operator=(Painter&&) noexcept;

  const engine::FrameScene& scene() const;
  Picture draw(const engine::Frame& frame, const View& view);
  /// The same picture as paths and letters, of a view from above: a file of SVG 1.1 or PDF. Its size is that
  /// of the view in pixels of 1/96 inch. Throws std::runtime_error also for another view, and for a PDF where
  /// cairo is missing, with the package to install.
  std::string draw_vector(const engine::Frame& frame, const View& view, VectorFormat format,
                          const FileTexts& texts);

 private:
  struct Composition;
  Composition compose(const engine::Frame& frame, const View& view);

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// One picture; may be called on several threads at once.
Picture draw(const engine::FrameScene& scene, const engine::Frame& frame, const View& view);

}  // namespace troupe::render
