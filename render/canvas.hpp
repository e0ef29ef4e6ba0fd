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

/// Source of the colour of a triangle: the vertex's own colour or one of the instance's colours.
enum class Paint : std::uint32_t { own, body, edge, mark };

// ---- flat layers, in the plane of the picture

struct Vertex {
  float x, y, z;  ///< body frame, in the units of Instance::size
  float offset_x,
      offset_y;  ///< added after scaling, pixels, body frame: strokes keep their width at any scale
  Rgba own;      ///< colour for Paint::own
  Paint paint;
};

/// A triangle list, drawn in order.
using Mesh = std::vector<Vertex>;

struct Instance {
  float x, y;      ///< position of the body's origin: pixels right of and above the picture's centre
  float cos, sin;  ///< cosine and sine of its heading
  float z;         ///< height, m
  float size;      ///< pixels per unit of the mesh
  Rgba body, edge, mark;
};

/// Instances of one mesh. Higher triangles cover lower ones; at equal height, later ones cover earlier ones.
struct Layer {
  Mesh mesh;
  std::vector<Instance> instances;
  bool on_top = false;  ///< covers all earlier layers, whatever their height
};

// ---- layers of solids in the world

/// Type of a corner of a triangle. It determines the meaning of SolidVertex::ax, ay, az (`a`).
enum class Corner : std::uint32_t {
  face,    ///< lit surface; `a` is its normal
  plain,   ///< unlit surface, drawn slightly nearer to the viewer: marks on faces
  stroke,  ///< line with half width `side`; `a` is its other end
  rim,     ///< like a stroke, but drawn slightly farther away than strokes
};

struct SolidVertex {
  float x, y, z;     ///< body frame, in the units of SolidInstance::scale
  float ax, ay, az;  ///< see Corner; same frame and units
  float side;  ///< half the width of a stroke, pixels; positive to the left of the direction to its other end
  Rgba own;    ///< colour for Paint::own
  Paint paint;
  Corner corner;
};

using SolidMesh = std::vector<SolidVertex>;

struct SolidInstance {
  float x, y, z;  ///< relative to the projection's origin, m
  float scale;    ///< metres per unit of the mesh
  float cos, sin;
  Rgba body, edge, mark;
};

/// Instances of one mesh in the world. Nearer triangles cover farther ones.
struct SolidLayer {
  enum class Depth : std::uint8_t {
    solid,  ///< depth is tested and written
    air,    ///< depth is tested but not written: transparent overlays
    floor,  ///< drawn over everything before it, below everything after it
  };
  SolidMesh mesh;
  std::vector<SolidInstance> instances;
  Depth depth = Depth::solid;
  bool shadow = false;  ///< draw the shadow on the floor instead of the mesh
};

// ---- layers of bodies too small for a shape

struct Point {
  float x, y,
      z;  ///< relative to the projection's origin, m; on a map: pixels right of and above the centre, and m
  Rgba color;
};

/// Squares of one size that face the viewer, one vertex each, so that 100,000 robots are drawn quickly.
struct PointLayer {
  std::vector<Point> points;
  float size = 1;       ///< pixels
  bool on_map = false;  ///< flat in the picture, like a Layer; else in the world, like a SolidLayer
  bool on_top = false;  ///< like Layer::on_top, on a map
};

using AnyLayer = std::variant<Layer, SolidLayer, PointLayer>;

/// An OpenGL renderer for layers. May be used on any thread, but only by one at a time.
class Canvas {
 public:
  /// Throws std::runtime_error if OpenGL is not available.
  Canvas();
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  /// Throws std::runtime_error, with the limit, if a side is below 1 or above the driver's limit.
  void check_size(int width, int height) const;
  /// Draws layers in order on a ground of one colour, with 4 samples per pixel if the driver supports it.
  /// Throws std::runtime_error as check_size() does, and when memory runs out.
  Picture paint(const Projection& projection, Rgba ground, std::span<const AnyLayer> layers);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe::render
