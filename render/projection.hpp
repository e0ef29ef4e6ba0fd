#pragma once

#include "render/framing.hpp"

#include <Eigen/Core>

#include <array>
#include <limits>
#include <optional>
#include <span>

namespace troupe::render {

using Vec3 = Eigen::Vector3d;

/// The mapping of world points (m) to the picture. Three unit vectors in the world frame describe the
/// direction of the view. right() and up() are the axes of the picture, and back() points from the picture
/// towards the viewer.
class Projection {
 public:
  /// Returns a parallel view straight down. `framing` gives the size, the centre and the scale of the
  /// picture. The depth buffer does not distinguish the heights of points in this view, so solid layers must
  /// have SolidLayer::Depth::floor.
  static Projection from_above(const Framing& framing);
  /// Makes a view in a direction. The caller must complete it: fit(), look_at() or stand_at() sets the
  /// position of the viewer, and reach() the range of depths.
  ///
  /// width, height  size of the picture, pixels
  /// stroke         pixels per stroke (Framing::stroke)
  /// pitch          rad; 0 looks straight down, pi/2 horizontally
  /// yaw            rad, counter-clockwise seen from above; 0: +y is upwards in the picture
  /// fov            vertical field of view of a perspective view, rad, below pi; 0: parallel view
  Projection(int width, int height, double stroke, double pitch, double yaw, double fov);

  bool perspective() const { return focal_ > 0; }
  int width() const { return width_; }
  int height() const { return height_; }
  /// Returns the number of pixels per stroke. A stroke is the unit of line widths and letter sizes: 1 pixel
  /// in small pictures (Framing::stroke).
  double stroke() const { return stroke_; }

  /// Moves the viewer so that all points are in the picture and fill its width or its height. In a parallel
  /// view, also sets the scale. A margin on all sides and a band below the points (both in pixels) stay free.
  /// `points` (m, world frame) must not be empty.
  void fit(std::span<const Vec3> points, double margin, double band_below);
  /// Moves the viewer so that the world point `center` is in the picture's centre, and the picture shows a
  /// width of `across` metres at the depth of this point. In a parallel view, also sets the scale. `across`
  /// must be above 0.
  void look_at(const Vec3& center, double across);
  /// Moves the viewer to the world point `eye`. Only for perspective views.
  void stand_at(const Vec3& eye);
  /// Sets the range of the depth buffer (near and far plane) to the depths of these points (m, world frame),
  /// with a margin. In a perspective view, points that are much nearer to the viewer than what the view looks
  /// at may be nearer than the near plane. Does nothing without points.
  void reach(std::span<const Vec3> points);

  /// Returns the distance of a world point from the viewer along the view direction, m. It is negative for
  /// points behind the viewer.
  double depth(const Vec3& point) const { return -back_.dot(point - eye_); }
  /// Returns the scale of the picture at a world point, pixels per metre. In a perspective view, the scale is
  /// 0 for points that are behind the viewer or nearer than the near plane.
  double pixels_per_metre(const Vec3& point) const;
  /// Returns the position of a world point in the picture: pixels right of and above the picture's centre.
  /// Empty if pixels_per_metre(point) is 0.
  std::optional<Vec2> to_pixels(const Vec3& point) const;
  /// Returns whether a ball around a world point may be visible; `radius` is in m. The result may be true for
  /// a ball just outside the picture.
  bool may_show(const Vec3& point, double radius) const;
  /// Returns the point of the floor (z = 0) in the picture's centre. If the view is within 2.9 degrees of
  /// horizontal, returns the point of the floor below the viewer.
  Vec3 floor_center() const;

  /// Returns the origin of the coordinates in layers of solids (render/canvas.hpp): a point on the floor
  /// (z = 0), m, world frame. It is near the visible part of the world, so that the coordinates, which are in
  /// single precision, have small rounding errors.
  const Vec3& origin() const { return origin_; }
  /// Returns the column-major matrix that converts points relative to origin() to OpenGL's clip coordinates,
  /// with y up.
  std::array<float, 16> clip_matrix() const;
  /// Returns a number to add to the third clip coordinate of a point. This moves the point towards the viewer
  /// by a distance that is two strokes (Framing::stroke) long in the picture.
  float clip_bias() const;
  /// Returns the distance of the near plane of a perspective view, m; 0 in a parallel view.
  double nearest() const { return perspective() ? near_ : 0; }
  /// Returns the clip units per metre along right() and along up(). In a perspective view, these are units
  /// before the division by the depth.
  Vec2 clip_scale() const;
  /// Returns the position of the viewer relative to origin(), m. In a parallel view, this is a point 10^7 m
  /// away in the direction back().
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
  /// Distance of what a perspective view looks at, m: of the centre of look_at(), or of floor_center().
  double looked_at_m_ = std::numeric_limits<double>::infinity();
  double near_ = 0.1;
  double far_ = 1000;
};

}  // namespace troupe::render
