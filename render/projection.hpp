#pragma once

#include "render/framing.hpp"

#include <Eigen/Core>

#include <array>
#include <optional>
#include <span>

namespace troupe::render {

using Vec3 = Eigen::Vector3d;

/// How points of the world come to lie in the picture. The picture's axes in the world: right, up, and back
/// towards the viewer.
class Projection {
 public:
  /// Straight down on what the framing shows; `heights` is what the depth buffer has to tell apart.
  static Projection from_above(const Framing& framing, const ZInterval& heights);
  /// From pitch (rad, 0 straight down, pi/2 level) and yaw (rad, counter-clockwise from looking along +y).
  /// `fov` is the vertical opening angle of a perspective view, rad; 0: parallel.
  Projection(int width, int height, double stroke, double pitch, double yaw, double fov);

  bool perspective() const { return focal_ > 0; }
  int width() const { return width_; }
  int height() const { return height_; }
  /// Pixels a stroke unit, as in Framing.
  double stroke() const { return stroke_; }

  /// Stands where all points are in the picture and fill it, but for margins in pixels. Not empty.
  void fit(std::span<const Vec3> points, double margin, double band_below);
  /// Stands where `center` is in the picture's middle, and the picture's width is `across` metres there.
  void look_at(const Vec3& center, double across);
  /// Stands at this point; perspective views only.
  void stand_at(const Vec3& eye);
  /// Sets the depths that the depth buffer has to tell apart to those of these points, and some more.
  void reach(std::span<const Vec3> points);

  /// Metres from the viewer along the view; below 0: behind.
  double depth(const Vec3& point) const { return -back_.dot(point - eye_); }
  /// At a point; 0 where it is not in front of the viewer.
  double pixels_per_metre(const Vec3& point) const;
  /// Pixels right of and above the picture's middle; none where it is not in front of the viewer.
  std::optional<Vec2> to_pixels(const Vec3& point) const;
  /// True where a ball around the point may be seen.
  bool may_show(const Vec3& point, double radius) const;
  /// The point of the floor in the picture's middle; that below the viewer where it sees no floor there.
  Vec3 floor_center() const;

  /// Floats are kept relative to this point, m; its height is 0.
  const Vec3& origin() const { return origin_; }
  /// Of points relative to the origin, column-major: OpenGL's clip coordinates, with y up.
  std::array<float, 16> clip_matrix() const;
  /// What to add to the third clip coordinate for a point to be about two pixels nearer.
  float clip_bias() const;
  /// Of a perspective view: what lies nearer, m, is cut off. 0 in a parallel one.
  double nearest() const { return perspective() ? near_ : 0; }
  /// Clip units a metre across the view, before the division by depth.
  Vec2 clip_scale() const;
  /// Where the viewer stands, relative to the origin; of a parallel view far away.
  Vec3 viewer_from_origin() const;
  const Vec3& right() const { return right_; }
  const Vec3& up() const { return up_; }
  const Vec3& back() const { return back_; }

 private:
  int width_;
  int height_;
  double stroke_;
  Vec3 right_, up_, back_;
  double focal_ = 0;             ///< pixels at a depth of 1 m; 0: parallel
  double pixels_per_metre_ = 1;  ///< of a parallel view
  Vec3 eye_ = Vec3::Zero();
  Vec3 origin_ = Vec3::Zero();
  double near_ = 0.1;
  double far_ = 1000;
};

}  // namespace troupe::render
