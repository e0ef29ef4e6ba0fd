#pragma once

#include "engine/observing/frame.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace troupe::render {

/// The viewpoint of a picture. By default the camera looks straight down and shows the whole scene.
struct Camera {
  bool perspective = false;  ///< true: perspective view; false: parallel (orthographic) view
  double pitch = 0;          ///< rad, 0 to pi/2: 0 looks straight down, pi/2 looks horizontally
  double yaw = 0;            ///< rad, counter-clockwise seen from above; 0: +y is upwards in the picture
  /// World point in the centre of the picture, m; views from above ignore its z. If not given, the picture is
  /// centred on the region that View::region describes.
  std::optional<Eigen::Vector3d> center;
  /// Width of the part of the world that the picture shows, m, above 0. In a perspective view, this is the
  /// width at the depth of `center`. If not given, the scale is that at which the whole region (see
  /// View::region) fits into the picture.
  std::optional<double> across_m;
  /// World position of a perspective camera, m. If given, `center` and `across_m` are ignored. Parallel views
  /// ignore `eye`.
  std::optional<Eigen::Vector3d> eye;
  double fov = 0.65;  ///< vertical field of view of a perspective view, rad, above 0 and below pi
};

/// Background of a picture: light beige (paper), white, dark or transparent. On a transparent background,
/// empty pixels have the opacity 0.
enum class Background : std::uint8_t { paper, white, dark, transparent };

/// What is drawn in addition to the bodies. The data to draw are in an engine::FrameScene (data that are
/// constant during a run, such as static bodies) and an engine::Frame (the robots and other data at one
/// time). The comments of some members name the member of Frame or FrameScene that has the data to draw; if
/// it has no data, nothing is drawn. The scale bar, the simulated time and the legends are drawn only in
/// pictures of at least 240 x 160 pixels.
struct Layers {
  bool grid = true;      ///< grid lines on the floor
  bool shadows = true;   ///< shadows of the bodies on the floor
  bool headings = true;  ///< a mark at the front of each robot
  /// A red outline with a white rim around stalled bodies (FrameBody::stalled). The last motion of a stalled
  /// body was blocked, or would have ended out of bounds.
  bool stalls = true;
  /// In a view from above: a scale bar. In other views: the distance between grid lines as text, if `grid` is
  /// set.
  bool scale = true;
  bool clock = true;   ///< the simulated time as text: "12.5 s"
  bool speed = false;  ///< only with `clock`: the speed of the simulation, Frame::times_real_time, if above 0
  bool legend = true;  ///< legend of the colour scale, if bodies are coloured by Frame::values
  bool bounds = true;  ///< bounds of the world, which robots cannot leave: FrameScene::limits
  bool types = false;  ///< legend of the types of robots, if `legend` draws no colour scale
  bool scans = false;  ///< range readings as transparent areas: Frame::scans
  bool beams = false;  ///< range readings as lines: Frame::scans
  bool sights = false;  ///< lines from fiducial finders (marker sensors) to detected bodies: Frame::sights
  bool blobs = false;   ///< blobs that blob finders (colour sensors) see: Frame::blobs
  bool grips = false;   ///< light beams of grippers (red: interrupted), lines to held bodies: Frame::grips
  bool links = false;   ///< lines from carriers to carried bodies: Frame::links
  bool trails = false;  ///< past positions of bodies: Frame::trails
  bool names = false;   ///< names of bodies: Frame::names
  bool energy = false;  ///< bars that show the remaining energy: Frame::charges
  bool footprints = false;  ///< outlines of the mobile bodies (Frame::mobile) on the floor
  bool coverage = false;    ///< squares of the floor that robots have visited: Frame::covered
  bool density = false;     ///< squares of the floor, coloured by the number of robots in each
  bool tiles = false;  ///< tiles (squares) of the spatial index, coloured by the number of robots in each
  bool cells = false;  ///< outlines of the cells (parts of tiles) of the spatial index that contain robots
};

/// How a picture shows an engine::Frame, the state of a world at one time.
struct View {
  int width = 1280;  ///< width of the picture, pixels
  int height = 720;  ///< height of the picture, pixels
  /// World region to show, m. The members `center`, `across_m` and `eye` of the camera take precedence.
  ///
  /// If given: a view from above shows it without a margin. The region fills the picture along x or y; along
  /// the other axis, more of the world may be visible. Other views show the region with a margin.
  ///
  /// If not given: the region is FrameScene::bounds, extended by FrameScene::limits if Layers::bounds is set,
  /// and is shown with a margin. If this region is empty, the region is 10 m x 10 m about the origin.
  std::optional<Box> region;
  Camera camera;
  Layers layers;
  Background background = Background::paper;
  /// The two values at the ends of the colour scale, the lower one first, if bodies are coloured by
  /// Frame::values. If not given, they are the smallest and the largest finite value in the frame. If all
  /// finite values are equal to x, they are x - 0.5 and x + 0.5. If there are no finite values, they are 0
  /// and 1.
  std::optional<std::pair<double, double>> values;
};

/// Returns whether the view is a map: without perspective, and with a pitch and a yaw of exactly 0. Only maps
/// can be drawn as vector graphics.
bool is_from_above(const Camera& camera);

/// Metadata of a file: pairs of a key, such as `world` or `time_s`, and its value.
using FileTexts = std::vector<std::pair<std::string, std::string>>;
/// The file formats of vector graphics.
enum class VectorFormat : std::uint8_t { svg, pdf };

/// A picture. `rgba` has 4 bytes per pixel: red, green, blue and opacity. The rows are stored from the top,
/// and the pixels of a row from the left. The colours are not multiplied by the opacity.
struct Picture {
  int width = 0;   ///< width of the picture, pixels
  int height = 0;  ///< height of the picture, pixels
  std::vector<std::uint8_t> rgba;
};

/// Draws pictures of one simulation. The constructor takes the data that are constant during a run
/// (engine::FrameScene); each call of draw() takes the data of one time (engine::Frame). Data that all
/// pictures need are computed only once.
///
/// view    A view from above (is_from_above()) is a map: +x points right, +y up. Bodies are flat shapes, and
///         robots cover the floor plan even if it is higher. Other views show solids with lit faces and
///         edges, without hidden surfaces.
/// robots  Robots that are small in the picture are drawn in a simpler way. On a map, a robot is drawn as a
///         square with sides of 3.5 pixels if its width is below 5 pixels. Its outline is drawn from a width
///         of 7 pixels, and its heading mark from 9 pixels. In other views, a robot is drawn as a square with
///         sides of 3.5 pixels if its width is below 3.5 pixels, and as a box without outline and mark if its
///         width is below 10 pixels. In pictures whose smaller side is larger than 900 pixels, all these
///         lengths are larger in proportion: twice as large for 1800 pixels.
/// errors  draw() throws std::runtime_error in these cases:
///         - OSMesa or EGL, which the first call loads, is missing or too old. The message names
///           the package to install.
///         - A side of the picture is below 1 pixel or larger than the driver allows. The message names the
///           limit.
///         - OpenGL reports an error, such as too little memory.
///         - View::region is not finite or has no area.
/// output  Equal input gives equal bytes on one machine. The floating-point environment of the caller is
///         restored.
/// threads A painter may be used on any thread, but only by one thread at a time.
class Painter {
 public:
  /// Computes the data that all pictures share. Does not load OSMesa or EGL.
  explicit Painter(engine::FrameScene scene);
  ~Painter();
  Painter(Painter&&) noexcept;
  Painter& operator=(Painter&&) noexcept;

  /// Returns the scene passed to the constructor or, later, to set_scene().
  const engine::FrameScene& scene() const;
  /// Replaces the scene. This is faster than a new painter, because the OpenGL context is kept.
  void set_scene(engine::FrameScene scene);
  /// Draws one picture as pixels. Errors: see the class. The indices in `frame`, such as those of body types,
  /// must be valid for scene().
  Picture draw(const engine::Frame& frame, const View& view);
  /// Draws a view from above as vector graphics and returns the content of an SVG 1.1 or PDF file. The size
  /// of the picture is that of the view, with pixels of 1/96 inch. `texts` are stored in the file as
  /// metadata; in their values, question marks replace characters that the formats do not allow. OSMesa and
  /// EGL are not needed.
  ///
  /// Throws std::runtime_error in these cases:
  /// - The view is not from above, or its width or height is below 1.
  /// - View::region is not finite or has no area.
  /// - For a PDF: the library cairo is missing or too old (the message names the package to install), or
  ///   fails.
  std::string draw_vector(const engine::Frame& frame, const View& view, VectorFormat format,
                          const FileTexts& texts);

 private:
  struct Composition;
  Composition compose(const engine::Frame& frame, const View& view);

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Draws one picture with a new Painter. Throws as Painter::draw() does. Several threads may call this
/// function at the same time. For several pictures of a scene, one Painter is faster.
Picture draw(const engine::FrameScene& scene, const engine::Frame& frame, const View& view);

}  // namespace troupe::render
