#pragma once

#include "render/draw.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace troupe::render {

using Rgba = std::array<std::uint8_t, 4>;

/// Where the colour of a triangle comes from.
enum class Paint : std::uint32_t { own, body, edge, mark };

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

/// Draws layers first to last on a plain ground, with 4 samples a pixel where the driver can.
/// Throws std::runtime_error with the limit when a side is not from 1 to what the driver can draw.
Picture paint(int width, int height, Rgba ground, std::span<const Layer> layers);

}  // namespace troupe::render
