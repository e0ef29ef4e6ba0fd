#include "render/projection.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace troupe::render {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();
/// Largest ratio of the far to the near depth, limited by the 24 bits of the depth buffer. Views that look at
/// something very near have a larger ratio: faraway solids may then be drawn in the wrong order.
constexpr double k_most_depth_ratio = 4000;
constexpr double k_most_near = 0.1;  // distance of the near plane, fraction of that of what is looked at
constexpr double k_least_looked_at_m = 1e-3;  // for viewers just above the floor
constexpr double k_bias_pixels = 2;
/// Largest distance from the floor of points that a view from above shows, m.
constexpr double k_any_height = 1e12;

/// The largest value of the function `of` over the points.
template <class Of>
double largest(std::span<const Vec3> points, Of&& of) {
  double most = -k_infinity;
  for (const Vec3& point : points) most = std::max(most, of(point));
  return most;
}

}  // namespace

Projection::Projection(int width, int height, double stroke, double pitch, double yaw, double fov)
    : width_(width), height_(height), stroke_(stroke) {
  const SinCos p = sincos(pitch);
  const Rotation turn(yaw);
  const auto turned = [&](const Vec3& v) {
    const Vec2 flat = turn * Vec2(v.x(), v.y());
    return Vec3(flat.x(), flat.y(), v.z());
  };
  right_ = turned({1, 0, 0});
  up_ = turned({0, p.cos, p.sin});
  back_ = turned({0, -p.sin, p.cos});
  if (fov > 0) focal_ = 0.5 * height / std::tan(fov / 2);
}

Projection Projection::from_above(const Framing& framing) {
  Projection view(framing.width, framing.height, framing.stroke, 0, 0, 0);
  view.pixels_per_metre_ = framing.pixels_per_metre;
  view.origin_ = {framing.center.x(), framing.center.y(), 0};
  view.eye_ = view.origin_;
  view.near_ = -k_any_height;
  view.far_ = k_any_height;
  return view;
}

void Projection::fit(std::span<const Vec3> points, double margin, double band_below) {
  // Half the extent of the picture that is available for the points, pixels.
  const double side = std::max(0.5 * width_ - margin, 1.0);
  const double above = std::max(0.5 * height_ - margin, 1.0);
  const double below = std::max(0.5 * height_ - margin - band_below, 1.0);
  const auto along = [&](const Vec3& axis) {
    return std::pair(-largest(points, [&](const Vec3& p) { return -axis.dot(p); }),
                     largest(points, [&](const Vec3& p) { return axis.dot(p); }));
  };
  if (!perspective()) {
    const auto [left, right] = along(right_);
    const auto [bottom, top] = along(up_);
    pixels_per_metre_ =
        std::min(2 * side / std::max(right - left, 1e-6), (above + below) / std::max(top - bottom, 1e-6));
    const double center_up = 0.5 * (bottom + top) - 0.5 * (above - below) / pixels_per_metre_;
    const double farthest = along(back_).second;
    eye_ = 0.5 * (left + right) * right_ + center_up * up_ + (farthest + 1) * back_;
  } else {
    // Let e be the position of the eye. A point p is below the upper side of the picture if up.(p - e) <=
    // above / focal * depth(p), and likewise for the other three sides. So each side and each point bound e
    // by a plane; of all points, only the strictest plane of each side counts. With forward = -back and e in
    // the axes (right, up, forward), the planes of two opposite sides together bound the forward coordinate
    // of e.
    const Vec3 forward = -back_;
    const auto bound = [&](const Vec3& axis, double half) {
      return largest(points, [&](const Vec3& p) { return axis.dot(p) - half / focal_ * forward.dot(p); });
    };
    const double top = bound(up_, above);
    const double bottom = bound(-up_, below);
    const double left = bound(-right_, side);
    const double right = bound(right_, side);
    const double nearest = largest(points, [&](const Vec3& p) { return -forward.dot(p); });
    double e = std::min(-(top + bottom) * focal_ / (above + below), -(left + right) * focal_ / (2 * side));
    e = std::min(e, -nearest - 1e-3);  // a single point has no extent; keep it in front of the eye
    const double e_up = 0.5 * ((top + above / focal_ * e) - (bottom + below / focal_ * e));
    const double e_right = 0.5 * (right - left);
    eye_ = e_right * right_ + e_up * up_ + e * forward;
  }
  const Vec3 center = floor_center();
  origin_ = {center.x(), center.y(), 0};
}

void Projection::look_at(const Vec3& center, double across) {
  if (perspective()) {
    looked_at_m_ = across * focal_ / width_;
    eye_ = center + looked_at_m_ * back_;
  } else {
    pixels_per_metre_ = width_ / across;
    eye_ = center;
  }
  origin_ = {center.x(), center.y(), 0};
}

void Projection::stand_at(const Vec3& eye) {
  eye_ = eye;
  const Vec3 center = floor_center();
  if (eye.z() > 0) looked_at_m_ = std::max((eye - center).norm(), k_least_looked_at_m);
  origin_ = {center.x(), center.y(), 0};
}

void Projection::reach(std::span<const Vec3> points) {
  if (points.empty()) return;
  const double farthest = largest(points, [&](const Vec3& p) { return depth(p); });
  const double nearest = -largest(points, [&](const Vec3& p) { return -depth(p); });
  if (perspective()) {
    far_ = std::max(1.1 * farthest, 1e-3);
    near_ = std::max(0.8 * nearest, std::min(far_ / k_most_depth_ratio, k_most_near * looked_at_m_));
  } else {
    // The margin is larger than clip_bias(), which must not move lines and marks beyond the near plane.
    const double bias = k_bias_pixels * stroke_ / pixels_per_metre_;
    const double more = std::max(0.05 * (farthest - nearest) + 1, 2 * bias);
    near_ = nearest - more;
    far_ = farthest + more;
  }
}

double Projection::pixels_per_metre(const Vec3& point) const {
  if (!perspective()) return pixels_per_metre_;
  const double d = depth(point);
  return d > near_ ? focal_ / d : 0;
}

std::optional<Vec2> Projection::to_pixels(const Vec3& point) const {
  const double scale = pixels_per_metre(point);
  if (scale <= 0) return std::nullopt;
  const Vec3 seen = point - eye_;
  return scale * Vec2(right_.dot(seen), up_.dot(seen));
}

bool Projection::may_show(const Vec3& point, double radius) const {
  const Vec3 seen = point - eye_;
  const double x = std::abs(right_.dot(seen));
  const double y = std::abs(up_.dot(seen));
  if (!perspective())
    return (x - radius) * pixels_per_metre_ <= 0.5 * width_ &&
           (y - radius) * pixels_per_metre_ <= 0.5 * height_;
  const double d = -back_.dot(seen);
  if (d + radius < near_) return false;
  // The planes through the eye and the sides of the picture are oblique. So the distance of a point from such
  // a plane is shorter than its distance measured across the view, by the factor sqrt(1 + slope^2).
  const double wide = 0.5 * width_ / focal_;
  const double high = 0.5 * height_ / focal_;
  return x - wide * d <= radius * std::sqrt(1 + wide * wide) &&
         y - high * d <= radius * std::sqrt(1 + high * high);
}

Vec3 Projection::floor_center() const {
  // If the view is nearly horizontal, the floor in the picture's centre is so far away that single-precision
  // coordinates relative to it would be inexact.
  constexpr double k_least_slope = 0.05;
  if (back_.z() < k_least_slope) return {eye_.x(), eye_.y(), 0};
  const Vec3 center = eye_ - eye_.z() / back_.z() * back_;
  return {center.x(), center.y(), 0};
}

Vec2 Projection::clip_scale() const {
  const double scale = perspective() ? focal_ : pixels_per_metre_;
  return {2 * scale / width_, 2 * scale / height_};
}

Vec3 Projection::viewer_from_origin() const {
  constexpr double k_far_away = 1e7;  // m
  const Vec3 eye = eye_ - origin_;
  return perspective() ? eye : Vec3(eye + k_far_away * back_);
}

std::array<float, 16> Projection::clip_matrix() const {
  const Vec2 scale = clip_scale();
  const Vec3 eye = eye_ - origin_;
  const Vec3 forward = -back_;
  std::array<Vec3, 4> rows = {scale.x() * right_, scale.y() * up_, Vec3::Zero(), Vec3::Zero()};
  std::array<double, 4> last = {-rows[0].dot(eye), -rows[1].dot(eye), 0, 1};
  if (perspective()) {
    const double a = (far_ + near_) / (far_ - near_);
    const double b = -2 * far_ * near_ / (far_ - near_);
    rows[2] = a * forward;
    last[2] = b - a * forward.dot(eye);
    rows[3] = forward;
    last[3] = -forward.dot(eye);
  } else {
    const double a = 2 / (far_ - near_);
    rows[2] = a * forward;
    last[2] = -a * (forward.dot(eye) + near_) - 1;
  }
  std::array<float, 16> matrix{};
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t column = 0; column < 3; ++column)
      matrix[4 * column + row] = static_cast<float>(rows[row][static_cast<Eigen::Index>(column)]);
    matrix[12 + row] = static_cast<float>(last[row]);
  }
  return matrix;
}

float Projection::clip_bias() const {
  const double metres = k_bias_pixels * stroke_ / (perspective() ? focal_ : pixels_per_metre_);
  // In a perspective view, `metres` is the length at a depth of 1 m; the bias grows in proportion to the
  // depth.
  const double range = perspective() ? 2 * far_ * near_ / (far_ - near_) : 2 / (far_ - near_);
  return static_cast<float>(-metres * range);
}

}  // namespace troupe::render
