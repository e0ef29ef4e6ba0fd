#pragma once

#include "render/color.hpp"
#include "render/draw.hpp"
#include "render/projection.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <variant>
#include <vector>

namespace troupe::render {

/// Selects the colour of a triangle of a mesh. `own` is the colour stored in the mesh, such as Vertex::own.
/// `body`, `edge` and `mark` are the members with these names of the drawn Instance or SolidInstance, so that
/// instances of one mesh can have different colours. The Paint and the colour of a triangle are those of the
/// last of its three vertices.
enum class Paint : std::uint32_t { own, body, edge, mark };

// ---- flat layers, in the plane of the picture

/// A corner of a triangle in a flat layer.
struct Vertex {
  /// Position in the frame of the instance. x and y are in mesh units of Instance::size pixels. z is the
  /// height above the origin of the instance, m.
  float x, y, z;
  /// Offset that is added to x and y after scaling, pixels, frame of the instance. It gives lines a width
  /// that does not depend on the scale.
  float offset_x, offset_y;
  Rgba own;  ///< colour for Paint::own
  Paint paint;
};

/// A list of triangles, three vertices each. They are drawn in the order of the list.
using Mesh = std::vector<Vertex>;

/// A body, or another thing, that is drawn with a mesh.
struct Instance {
  float x, y;             ///< position of its origin: pixels right of and above the picture's centre
  float cos, sin;         ///< cosine and sine of its heading
  float z;                ///< height of its origin, m
  float size;             ///< pixels per unit of the mesh
  Rgba body, edge, mark;  ///< its colours for Paint::body, edge and mark
};

/// Instances of one mesh. Where triangles overlap, the highest one is visible, even if it belongs to an
/// earlier layer (see `on_top` for the exception). Of triangles at equal height, the last one is visible.
struct Layer {
  Mesh mesh;
  std::vector<Instance> instances;
  bool on_top = false;  ///< true: this layer and later ones cover all earlier layers, at any height
};

// ---- layers of solids in the world

/// What a triangle of a solid mesh shows: a part of a surface, or one of the two triangles that form a line.
/// The three corners of a triangle have the same value. The value also determines the meaning of the vector
/// a = (ax, ay, az) of a SolidVertex.
enum class Corner : std::uint32_t {
  face,    ///< lit surface; a is its normal, of unit length
  plain,   ///< unlit surface, such as a mark on a face, drawn slightly nearer to the viewer; a is not used
  stroke,  ///< line from the position (x, y, z) to the position a
  rim,     ///< like `stroke`, but drawn slightly farther away, so that strokes cover it
};

/// A corner of a triangle in a solid layer.
struct SolidVertex {
  float x, y, z;     ///< position, frame of the instance, mesh units (SolidInstance::scale m per unit)
  float ax, ay, az;  ///< the vector a of Corner, frame of the instance; if a position, in mesh units
  /// For lines (Corner::stroke and Corner::rim): half the width of the line, pixels, with a sign. A positive
  /// sign means that the corner is on the left side of the line, seen from (x, y, z) towards a; a negative
  /// sign means the right side. Not used for surfaces.
  float side;
  Rgba own;  ///< colour for Paint::own
  Paint paint;
  Corner corner;
};

/// A list of triangles, three vertices each.
using SolidMesh = std::vector<SolidVertex>;

/// A body, or another thing, that is drawn with a solid mesh.
struct SolidInstance {
  /// Position of its origin relative to Projection::origin() (a point near the visible scene), m.
  float x, y, z;
  float scale;            ///< metres per unit of the mesh
  float cos, sin;         ///< cosine and sine of its heading
  Rgba body, edge, mark;  ///< its colours for Paint::body, edge and mark
};

/// Instances of one mesh in the world. `depth` determines how the layer and other layers cover each other.
struct SolidLayer {
  /// How the layer uses the depth buffer.
  enum class Depth : std::uint8_t {
    solid,  ///< depth is tested and written: nearer triangles cover farther ones
    air,    ///< depth is tested but not written, for transparent overlays: all later layers cover it
    floor,  ///< depth is neither tested nor written: covers all earlier layers, covered by all later ones
  };
  SolidMesh mesh;
  std::vector<SolidInstance> instances;
  Depth depth = Depth::solid;
  /// If true, the layer shows the shadow of the mesh on the floor (z = 0) instead of the mesh, in the colour
  /// SolidInstance::edge.
  bool shadow = false;
};

// ---- layers of bodies too small for a shape

/// A body drawn as a small square.
struct Point {
  /// If PointLayer::on_map: x and y are pixels right of and above the picture's centre, z is the height, m.
  /// Otherwise: position relative to Projection::origin(), which is a point near the visible part of the
  /// world, m.
  float x, y, z;
  Rgba color;
};

/// Squares of one size that face the viewer. A square needs only one vertex, so that 100,000 robots are drawn
/// quickly.
struct PointLayer {
  std::vector<Point> points;
  float size = 1;       ///< edge length of the squares, pixels
  bool on_map = false;  ///< true: flat in the picture, like a Layer; false: in the world, like a SolidLayer
  bool on_top = false;  ///< as Layer::on_top; may be true only if on_map is true
};

using AnyLayer = std::variant<Layer, SolidLayer, PointLayer>;

/// An OpenGL renderer for layers. A canvas may be used on any thread, but only by one thread at a time.
class Canvas {
 public:
  /// Creates an OpenGL context without a window. Throws std::runtime_error if OpenGL is not available.
  Canvas();
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  /// Throws std::runtime_error if the width or height of a picture (pixels) is below 1 or above the limit of
  /// the OpenGL driver. The message of the error names the limit.
  void check_size(int width, int height) const;
  /// Draws layers in order on a background of the colour `ground`. The projection gives the size of the
  /// picture. Each pixel is the mean of 4 samples, if the driver supports that. Throws std::runtime_error as
  /// check_size() does, and if OpenGL reports an error, such as too little memory.
  Picture paint(const Projection& projection, Rgba ground, std::span<const AnyLayer> layers);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe::render
