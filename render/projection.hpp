#pragma once

#include "render/framing.hpp"

#include <Eigen/Core>

#include <array>
#include <optional>
#include <span>

namespace troupe::render {

using Vec3 = Eigen::Vector3d;

/// The mapping of world points to the picture. World points are in metres. right(), up() and back() are unit
/// vectors in the world frame: the axes of the picture, and the direction from the picture towards the
/// viewer.
class Projection {
 public:
  /// A parallel view straight down. The framing gives the size, the centre and the scale of the picture. The
  /// view shows points at any height, but the depth buffer does not resolve their heights. Solid layers in
  /// this view must therefore have the depth SolidLayer::Depth::floor.
  static Projection from_above(const Framing& framing);
  /// A view of width x height pixels. stroke: pixels per stroke (Framing::stroke). pitch: rad, 0 looks
  /// straight down, pi/2 horizontally. yaw: rad, counter-clockwise seen from above; 0: +y is upwards in the
  /// picture. fov: vertical field of view of a perspective view, rad, below pi; 0: parallel view. The caller
  /// must then set the position of the viewer by fit(), look_at() or stand_at(), and the range of depths by
  /// reach().
  Projection(int width, int height, double stroke, double pitch, double yaw, double fov);

  bool perspective() const { return focal_ > 0; }
  int width() const { return width_; }
  int height() const { return height_; }
  /// Pixels per stroke, the unit of line widths and letter sizes; 1 in small pictures (Framing::stroke).
  double stroke() const { return stroke_; }

  /// Moves the viewer, and sets the scale of a parallel view, so that all points are in the picture and fill
  /// its width or its height. A margin on all sides and a band below the points (both in pixels) stay free.
  /// `points` (m, world frame) must not be empty.
  void fit(std::span<const Vec3> points, double margin, double band_below);
  /// Moves the viewer, and sets the scale of a parallel view, so that the world point `center` is in the
  /// picture's centre, where the picture is `across` metres wide. `across` must be above 0.
  void look_at(const Vec3& center, double across);
  /// Moves the viewer to the world point `eye`. Only for perspective views.
  void stand_at(const Vec3& eye);
  /// Sets the range of the depth buffer (near and far plane) to the depths of these points (m, world frame),
  /// with a margin. Does nothing without points.
  void reach(std::span<const Vec3> points);

  /// Distance of a world point from the viewer along the view direction, m; negative: behind the viewer.
  double depth(const Vec3& point) const { return -back_.dot(point - eye_); }
  /// Scale of the picture at a world point, pixels per metre. In a perspective view, the scale is 0 for
  /// points that are behind the viewer or nearer than the near plane.
  double pixels_per_metre(const Vec3& point) const;
  /// Position of a world point in the picture: pixels right of and above its centre. Empty if
  /// pixels_per_metre() is 0 there.
  std::optional<Vec2> to_pixels(const Vec3& point) const;
  /// Whether a ball around a world point may be visible; `radius` is in m. The result may be true for a ball
  /// just outside the picture.
  bool may_show(const Vec3& point, double radius) const;
  /// The point of the floor (z = 0) in the picture's centre. If the view is within 2.9 degrees of horizontal,
  /// the point of the floor below the viewer.
  Vec3 floor_center() const;

  /// Origin of the single-precision coordinates of SolidLayer and, without on_map, PointLayer
  /// (render/canvas.hpp): a point, m, world frame, at the height 0. It is near the visible part of the world,
  /// so that the coordinates and their rounding errors are small.
  const Vec3& origin() const { return origin_; }
  /// Column-major matrix that converts points relative to origin() to OpenGL's clip coordinates, with y up.
  std::array<float, 16> clip_matrix() const;
  /// Offset to add to the third clip coordinate of a point, so that the point is drawn nearer to the viewer.
  /// The point moves by a depth of about two strokes (Framing::stroke) in the picture.
  float clip_bias() const;
  /// Distance of the near plane of a perspective view, m; 0 in a parallel view.
  double nearest() const { return perspective() ? near_ : 0; }
  /// Clip units per metre to the right and upwards in the picture, before the division by depth.
  Vec2 clip_scale() const;
  /// Position of the viewer relative to origin(), m; in a parallel view, a point 10^7 m away in the direction
  /// of the viewer.
  Vec3 viewer_from_origin() const;
  const Vec3& right() const { return right_; }
  const Vec3& up() const { return up_; }
  const Vec3& back() const { return back_; }

 private:
  int width_;
  int height_;
  double stroke_;
  Vec3 right_, up_, back_;
  double focal_ = 0;             ///< pixels per metre at a depth of 1 m; 0: parallel view
  double pixels_per_metre_ = 1;  ///< scale of a parallel view
  Vec3 eye_ = Vec3::Zero();
  Vec3 origin_ = Vec3::Zero();
  double near_ = 0.1;
  double far_ = 1000;
};

}  // namespace troupe::render
