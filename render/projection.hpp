#pragma once

#include "render/framing.hpp"

#include <Eigen/Core>

#include <array>
#include <optional>
#include <span>

namespace troupe::render {

using Vec3 = Eigen::Vector3d;

/// The mapping of world points to the picture. The picture's axes in the world are right, up, and back
/// (towards the viewer).
class Projection {
 public:
  /// Straight down, with the given framing; `heights` is the interval that the depth buffer must resolve.
  static Projection from_above(const Framing& framing, const ZInterval& heights);
  /// With pitch (rad, 0 straight down, pi/2 level) and yaw (rad, counter-clockwise from looking along +y).
  /// `fov` is the vertical angle of a perspective view, rad; 0: parallel.
  Projection(int width, int height, double stroke, double pitch, double yaw, double fov);

  bool perspective() const { return focal_ > 0; }
  int width() const { return width_; }
  int height() const { return height_; }
  /// Pixels per stroke unit, as in Framing.
  double stroke() const { return stroke_; }

  /// Moves the viewer so that all points are in the picture and fill it, with margins in pixels. `points`
  /// must not be empty.
  void fit(std::span<const Vec3> points, double margin, double band_below);
  /// Moves the viewer so that `center` is in the picture's centre, where the picture is `across` metres wide.
  void look_at(const Vec3& center, double across);
  /// Moves the viewer to this point; perspective views only.
  void stand_at(const Vec3& eye);
  /// Sets the range of the depth buffer to the depths of these points, with a margin.
  void reach(std::span<const Vec3> points);

  /// Distance from the viewer along the view direction, m; negative: behind the viewer.
  double depth(const Vec3& point) const { return -back_.dot(point - eye_); }
  /// Scale at a point; 0 if it is not in front of the viewer.
  double pixels_per_metre(const Vec3& point) const;
  /// Pixels right of and above the picture's centre; nothing if the point is not in front of the viewer.
  std::optional<Vec2> to_pixels(const Vec3& point) const;
  /// Whether a ball around the point may be visible.
  bool may_show(const Vec3& point, double radius) const;
  /// The point of the floor in the picture's centre, or below the viewer if there is no floor in the centre.
  Vec3 floor_center() const;

  /// Single-precision coordinates are relative to this point, m, to limit rounding; its height is 0.
  const Vec3& origin() const { return origin_; }
  /// Matrix from points relative to the origin to OpenGL's clip coordinates, column-major, y up.
  std::array<float, 16> clip_matrix() const;
  /// Offset of the third clip coordinate that moves a point about two pixels nearer.
  float clip_bias() const;
  /// Distance of the near plane of a perspective view, m; 0 in a parallel view.
  double nearest() const { return perspective() ? near_ : 0; }
  /// Clip units per metre across the view, before the division by depth.
  Vec2 clip_scale() const;
  /// Position of the viewer relative to the origin; far away in a parallel view.
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
  double pixels_per_metre_ = 1;  ///< scale of a parallel view
  Vec3 eye_ = Vec3::Zero();
  Vec3 origin_ = Vec3::Zero();
  double near_ = 0.1;
  double far_ = 1000;
};

}  // namespace troupe::render
