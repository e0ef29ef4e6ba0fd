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

/// Where the colour of a triangle comes from.
enum class Paint : std::uint32_t { own, body, edge, mark };

// ---- what lies flat on the picture

struct Vertex {
  float x, y, z;  ///< body frame, in the units that Instance::size scales
  float offset_x,
      offset_y;  ///< added after scaling, pixels, body frame: strokes keep their width at any scale
  Rgba own;      ///< the colour of Paint::own
  Paint paint;
};

/// A triangle list, drawn first to last.
using Mesh = std::vector<Vertex>;

struct Instance {
  float x, y;      ///< of the body's origin: pixels right of and above the picture's centre
  float cos, sin;  ///< of its heading
  float z;         ///< m
  float size;      ///< pixels a unit of the mesh
  Rgba body, edge, mark;
};

/// One mesh at many places. What is higher covers what is lower; at the same height the later covers the
/// earlier.
struct Layer {
  Mesh mesh;
  std::vector<Instance> instances;
  bool on_top = false;  ///< covers all layers before it, whatever their height
};

// ---- what stands in the world

/// What a corner of a triangle is, and what `a` of it means.
enum class Corner : std::uint32_t {
  face,    ///< of a lit surface; `a` is its normal
  plain,   ///< of a surface that is not lit, a little nearer than it is: marks on faces
  stroke,  ///< of a line as wide as `side` says; `a` is its other end
  rim,     ///< as a stroke, but a little farther than strokes are
};

struct SolidVertex {
  float x, y, z;     ///< body frame, in the units that SolidInstance::scale scales
  float ax, ay, az;  ///< as Corner says, in the same frame and units
  float side;        ///< of a stroke: half its width, pixels; to the left of the way to its other end
  Rgba own;          ///< the colour of Paint::own
  Paint paint;
  Corner corner;
};

using SolidMesh = std::vector<SolidVertex>;

struct SolidInstance {
  float x, y, z;  ///< from the projection's origin, m
  float scale;    ///< m a unit of the mesh
  float cos, sin;
  Rgba body, edge, mark;
};

/// One mesh at many places in the world. The nearer covers the farther.
struct SolidLayer {
  enum class Depth : std::uint8_t {
    solid,  ///< is covered, and covers
    air,    ///< is covered, and covers nothing: what is drawn into the air
    floor,  ///< covers what was drawn before, and nothing that comes later
  };
  SolidMesh mesh;
  std::vector<SolidInstance> instances;
  Depth depth = Depth::solid;
  bool shadow = false;  ///< what is drawn is the shadow on the floor
};

// ---- what is too small to have a shape

struct Point {
  float x, y, z;  ///< from the projection's origin, m; of a map pixels right of and above the middle, and m
  Rgba color;
};

/// Squares of one size that face the viewer: a hundred thousand robots take a vertex each.
struct PointLayer {
  std::vector<Point> points;
  float size = 1;       ///< pixels
  bool on_map = false;  ///< flat on the picture, as a Layer; else in the world, as a solid
  bool on_top = false;  ///< as Layer::on_top, on a map
};

using AnyLayer = std::variant<Layer, SolidLayer, PointLayer>;

/// A place to draw on. May be used by any thread, by one at a time.
class Canvas {
 public:
  /// Throws std::runtime_error where there is no OpenGL.
  Canvas();
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  /// Throws std::runtime_error with the limit when a side is not from 1 to what the driver can draw.
  void check_size(int width, int height) const;
  /// Draws layers first to last on a plain ground, with 4 samples a pixel where the driver can.
  /// Throws std::runtime_error for such a size, and where memory runs out.
  Picture paint(const Projection& projection, Rgba ground, std::span<const AnyLayer> layers);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe::render
