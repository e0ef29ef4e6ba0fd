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
  /// World point in the picture's centre, m; views from above ignore its z. If only `across_m` is given, the
  /// picture's centre shows the centre of the region that View::region describes. If neither is given, the
  /// whole region is visible.
  std::optional<Eigen::Vector3d> center;
  /// Width, m, above 0, of the part of the world that the picture shows at the distance of `center`. If not
  /// given, the scale is the one at which the whole region that View::region describes fits into the picture;
  /// if `center` is given, parts of the region may still be outside.
  std::optional<double> across_m;
  /// World position of a perspective camera, m. If given, `center` and `across_m` are ignored. Parallel views
  /// ignore `eye`.
  std::optional<Eigen::Vector3d> eye;
  double fov = 0.65;  ///< vertical field of view of a perspective view, rad, above 0 and below pi
};

/// Background of a picture: light beige (paper), white, dark, or transparent, where empty pixels have opacity
/// 0.
enum class Background : std::uint8_t { paper, white, dark, transparent };

/// What is drawn in addition to the bodies. The data to draw are in an engine::FrameScene (data that are
/// constant during a run, such as static bodies) and an engine::Frame (the robots and other data at one
/// time). Some layers name the member of Frame or FrameScene that holds their data; a layer without data
/// draws nothing. The scale bar, the simulated time and the legends are drawn only in pictures of at least
/// 240 x 160 pixels.
struct Layers {
  bool grid = true;      ///< grid lines on the floor
  bool shadows = true;   ///< shadows of the bodies on the floor
  bool headings = true;  ///< a mark at the front of each robot
  /// A red outline with a white rim around bodies whose last motion was blocked or would have ended out of
  /// bounds (FrameBody::stalled).
  bool stalls = true;
  /// In a view from above: a scale bar. In other views, if `grid` is set: the distance between grid lines.
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
  /// World region that must be visible, m. In a view from above, the region fills the picture in one
  /// direction, x or y; in the other direction more of the world may be visible. Other views show the region
  /// with a margin. If not given, the region is FrameScene::bounds with a margin; if Layers::bounds is set,
  /// the region also contains FrameScene::limits. If the scene has neither, the region is 10 m x 10 m about
  /// the origin. The members `center`, `across_m` and `eye` of the camera take precedence.
  std::optional<Box> region;
  Camera camera;
  Layers layers;
  Background background = Background::paper;
  /// Values at the ends of the colour scale, the lower one first, if bodies are coloured by Frame::values. If
  /// not given, the ends are the smallest and the largest finite value in the frame. If these are equal, the
  /// ends are 0.5 below and above them; if no value is finite, 0 and 1.
  std::optional<std::pair<double, double>> values;
};

/// Whether the view is a map: without perspective, and with a pitch and a yaw of exactly 0. Only maps can be
/// drawn as vector graphics.
bool is_from_above(const Camera& camera);

/// Metadata of a file: pairs of a key, such as `world` or `time_s`, and its value.
using FileTexts = std::vector<std::pair<std::string, std::string>>;
/// The file formats of vector graphics.
enum class VectorFormat : std::uint8_t { svg, pdf };

/// A picture. `rgba` has 4 bytes per pixel (red, green, blue, opacity), row by row from the top, each row
/// from the left. The colours are not multiplied by the opacity.
struct Picture {
  int width = 0;   ///< width of the picture, pixels
  int height = 0;  ///< height of the picture, pixels
  std::vector<std::uint8_t> rgba;
};

/// Draws pictures of one simulation: of one engine::FrameScene, which has the data that are constant during a
/// run, and of any number of engine::Frame, each of which has the data of one time. Data that all pictures
/// need are computed only once.
///
/// view    A view from above (is_from_above()) is a map: +x points right, +y up. Bodies are flat shapes, and
///         robots are drawn over the floor plan whatever its height. Other views show solids with lit faces
///         and edges, without hidden surfaces.
/// robots  Small robots are drawn in a simpler way, but stay visible. On a map, a robot whose width would be
///         below 5 pixels is drawn as a square with sides of 3.5 pixels. Robots have outlines from a width of
///         7 pixels, and heading marks from 9 pixels. In other views, a robot below 3.5 pixels is drawn as a
///         square with sides of 3.5 pixels, and a robot from 3.5 to 10 pixels as a box without outline and
///         mark. Outlines of stalled robots are red. In pictures whose smaller side has more than 900 pixels,
///         all these numbers of pixels grow in proportion.
/// errors  draw() loads the OpenGL library OSMesa on first use. It throws std::runtime_error if OSMesa is
///         missing (the message names the package to install), if a side of the picture is below 1 pixel or
///         larger than the driver allows (the message names the limit), if OpenGL reports an error, such as
///         too little memory, or if View::region is not finite or has no area.
/// output  Equal input gives equal bytes on one machine. The floating-point environment of the caller is
///         restored.
/// threads A painter may be used on any thread, but only by one thread at a time.
class Painter {
 public:
  /// Computes the data that all pictures share; OSMesa is not needed yet.
  explicit Painter(engine::FrameScene scene);
  ~Painter();
  Painter(Painter&&) noexcept;
  Painter& operator=(Painter&&) noexcept;

  /// The scene passed to the constructor.
  const engine::FrameScene& scene() const;
  /// Draws one picture as pixels. Errors: see the class. The indices in `frame`, such as those of body types,
  /// must be valid for scene().
  Picture draw(const engine::Frame& frame, const View& view);
  /// Draws a view from above as vector graphics and returns the content of an SVG 1.1 or PDF file. The size
  /// of the picture is that of the view, with pixels of 1/96 inch. `texts` are stored in the file; characters
  /// of their values that the formats do not allow become question marks. Throws std::runtime_error if the
  /// view is not from above, if its width or height is below 1, or if View::region is not finite or has no
  /// area. For a PDF it also throws if cairo is missing or too old, with a message that names the package to
  /// install, or if cairo fails. OSMesa is not needed.
  std::string draw_vector(const engine::Frame& frame, const View& view, VectorFormat format,
                          const FileTexts& texts);

 private:
  struct Composition;
  Composition compose(const engine::Frame& frame, const View& view);

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Draws one picture with a new Painter; errors are those of Painter::draw(). Several threads may call this
/// function at the same time. For several pictures of a scene, one Painter is faster.
Picture draw(const engine::FrameScene& scene, const engine::Frame& frame, const View& view);

}  // namespace troupe::render
