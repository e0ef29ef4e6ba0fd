// A compiler or a version of the library Highway can make the kernels of one instruction set compute other
// results than those of all others: Highway 1.2, for example, defines the division by zero of its portable
// code as zero. This check finds that before a kernel computes a reading.

#include "partition/kernel_check.hpp"

#include "base/math.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace troupe::partition {
namespace {

constexpr float k_infinity = std::numeric_limits<float>::infinity();

bool same_bits(std::span<const float> a, std::span<const float> b) {
  return std::ranges::equal(a, b, {}, std::bit_cast<std::uint32_t, float>,
                            std::bit_cast<std::uint32_t, float>);
}

Vec2 direction(double angle) {
  const SinCos at = sincos(angle);
  return {at.cos, at.sin};
}

/// A chain of edges, world frame, metres.
struct Outline {
  std::size_t edges;
  float ranger_return;
  Vec2 centre;  // of a circle around the outline
  double radius;
  // More than the outline has, because EdgeBlock::add() reads some beyond the end.
  std::vector<Vec2> vertices = std::vector<Vec2>(edges + 1 + EdgeBlock::k_piece, Vec2::Zero());
};

struct Scene {
  Vec2 reference{37.25, -11.5};
  std::vector<Outline> outlines;

  Scene() {
    // Squares around the reference point, in a spiral. The first ones are so close that they cover others.
    for (int i = 0; i < 12; ++i) {
      const double size = 0.05 + 0.04 * i;
      add_square(reference + (0.3 + 0.35 * i) * direction(2.4 * i), size, 0.7 * i, static_cast<float>(i % 3));
    }
    add_edge({0.5, -1}, {0.5, 1}, 5);          // hit at right angles by the beam along x
    add_edge({0.5, 0}, {1.5, 0.001}, 6);       // hit at a grazing angle, and begins on the edge before
    add_edge({-2, 0}, {-1, 0}, 7);             // seen end on
    add_edge({1e-7, -1e-7}, {2e-7, 1e-7}, 8);  // looks tiny
  }

 private:
  void add_square(const Vec2& centre, double size, double heading, float ranger_return) {
    Outline& outline = outlines.emplace_back(Outline{4, ranger_return, centre, size});
    for (int corner = 0; corner < 5; ++corner)
      outline.vertices[static_cast<std::size_t>(corner)] =
          centre + size * direction(heading + corner % 4 * (k_pi / 2));
  }
  void add_edge(const Vec2& a, const Vec2& b, float ranger_return) {
    const Vec2 half = (b - a) / 2;
    Outline& outline = outlines.emplace_back(Outline{1, ranger_return, reference + a + half, half.norm()});
    outline.vertices[0] = reference + a;
    outline.vertices[1] = reference + b;
  }
};

/// The beams of a fan, as a range sensor has them: in the frame of its robot.
struct Beams {
  std::vector<double> dx, dy, ox, oy;
  bool common_origin = true;
  bool mirrored = false;
  std::optional<Scan> scan;

  std::size_t count = 0;
  void add(double angle, const Vec2& origin = Vec2::Zero()) {
    const Vec2 d = direction(angle);
    dx.push_back(d.x());
    dy.push_back(d.y());
    ox.push_back(origin.x());
    oy.push_back(origin.y());
    ++count;
  }
  void pad() {
    for (std::vector<double>* array : {&dx, &dy, &ox, &oy}) array->resize(padded_beams(count), array->back());
  }
};

std::vector<Beams> fans(double heading) {
  std::vector<Beams> all(4);
  for (int i = 0; i < 12; ++i) all[0].add(i * (k_pi / 6));
  for (int i = 0; i < 10; ++i) {
    const double angle = i % 5 * 0.5 + (i < 5 ? 0 : k_pi);
    all[1].add(0.6 * i - 1.2, 0.15 * direction(0.6 * i));
    all[2].add(angle, 0.1 * direction(angle));
  }
  constexpr int k_samples = 45;
  constexpr double k_step = 0.1;
  const double fov = (k_samples - 1) * k_step;
  for (int i = 0; i < k_samples; ++i) all[3].add(i * k_step - fov / 2);
  all[3].scan = Scan{direction(heading), static_cast<float>(fov), static_cast<float>(k_step)};
  all[0].mirrored = all[2].mirrored = true;
  all[1].common_origin = all[2].common_origin = false;
  for (Beams& beams : all) beams.pad();
  return all;
}

/// Computes the scene for one fan with the kernels, and with plain loops.
class FanCheck {
 public:
  FanCheck(const Kernels& kernels, const Scene& scene, const Beams& beams, const Rotation& rotation)
      : kernels_(kernels),
        scene_(scene),
        beams_(beams),
        rotation_(rotation),
        size_(padded_beams(beams.count)) {}

  bool is_right() { return turns() && projects() && limits() && reads() && culls(); }

 private:
  using Floats = std::vector<float>;

  bool turns() {
    const auto turned = [&](const std::vector<double>& x, const std::vector<double>& y, Floats& out_x,
                            Floats& out_y) {
      kernels_.turn(rotation_, x.data(), y.data(), beams_.count, out_x.data(), out_y.data());
      for (std::size_t i = 0; i < size_; ++i) {
        const Vec2 v = rotation_ * Vec2(x[i], y[i]);
        if (!same_bits(std::array{out_x[i], out_y[i]},
                       std::array{static_cast<float>(v.x()), static_cast<float>(v.y())}))
          return false;
      }
      return true;
    };
    const bool is_right = turned(beams_.dx, beams_.dy, dx_, dy_) && turned(beams_.ox, beams_.oy, ox_, oy_);
    fan_ = {dx_.data(),   dy_.data(),           ox_.data(),      oy_.data(),
            beams_.count, beams_.common_origin, beams_.mirrored, beams_.scan ? &*beams_.scan : nullptr};
    return is_right;
  }

  /// The outlines with even numbers, so that the circles of the others can raise readings.
  bool projects() {
    EdgeBlock block;
    Floats expected(size_), expected_returns(size_);
    for (std::size_t o = 0; o < scene_.outlines.size(); o += 2) {
      const Outline& outline = scene_.outlines[o];
      block.add(outline.vertices[0], &outline.vertices[1], outline.edges, outline.ranger_return,
                all_beams(fan_));
      for (std::size_t e = 0; e < outline.edges; ++e)
        for (std::size_t i = 0; i < beams_.count; ++i) {
          const float value = inverse_range_of(outline, e, i);
          if (value > expected[i])
            expected_returns[i] = outline.ranger_return;
          else if (value == expected[i] && value > 0)
            expected_returns[i] = std::max(expected_returns[i], outline.ranger_return);
          expected[i] = std::max(expected[i], value);
        }
    }
    Floats alone(size_), returns(size_);
    kernels_.project(block, scene_.reference, fan_, alone.data(), nullptr);
    kernels_.project(block, scene_.reference, fan_, inverse_.data(), returns.data());
    const auto first = [&](const Floats& array) { return std::span(array).first(beams_.count); };
    return same_bits(first(alone), first(expected)) && same_bits(first(inverse_), first(expected)) &&
           same_bits(first(returns), first(expected_returns));
  }

  bool limits() {
    std::fill(inverse_.begin() + static_cast<std::ptrdiff_t>(beams_.count), inverse_.end(),
              inverse_[beams_.count - 1]);
    Floats expected(size_);
    float farthest = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const float range = std::min(1 / inverse_[i], range_max_[i]);
      expected[i] = range * (1 + static_cast<float>(k_range_slack)) + k_cull_slack;
      farthest = std::max(farthest, expected[i]);
    }
    farthest_ = kernels_.limits_of(fan_, inverse_.data(), range_max_.data(), limits_.data());
    return farthest_ == farthest && same_bits(limits_, expected);
  }

  bool reads() {
    Floats ranges(beams_.count), expected(beams_.count);
    for (std::size_t i = 0; i < beams_.count; ++i) expected[i] = range_of(inverse_[i], range_max_[i]);
    kernels_.ranges_of(fan_, inverse_.data(), range_max_.data(), ranges.data());
    return same_bits(ranges, expected);
  }

  bool culls() {
    constexpr std::uint32_t k_mark = 1u << 31;
    // One circle for each outline, and none that counts after them.
    std::vector<BodyCircle> all;
    for (const Outline& outline : scene_.outlines)
      all.push_back(enclosing_circle(outline.centre, outline.radius, static_cast<std::uint32_t>(all.size())));
    const std::size_t count = (all.size() + k_circle_padding - 1) / k_circle_padding * k_circle_padding;
    all.resize(count + 3, {0, 0, -k_infinity, 0});  // unpack() reads three more
    CircleArrays circles;
    circles.change_capacity(count + 3);
    const std::array<CircleRun, 2> runs{CircleRun(all.data(), 5), CircleRun(all.data() + 5, count - 5)};
    kernels_.unpack(runs, k_mark, 0, circles);
    for (std::size_t c = 0; c < count; ++c)
      if (!same_bits(std::array{circles.x[c], circles.y[c], circles.radius[c]},
                     std::array{all[c].x, all[c].y, all[c].radius}) ||
          circles.row[c] != (all[c].row | k_mark))
        return false;

    std::vector<BeamSet> met_by(scene_.outlines.size());
    MetCircles met;
    constexpr float k_near = 1.5f;
    constexpr float k_apart = 0.2f;  // above the distance of any origin from the reference
    for (const auto& [low, high] : {std::pair(-k_infinity, k_near), std::pair(k_near, farthest_ + k_apart)}) {
      const std::size_t n =
          kernels_.may_meet(circles, 0, count, scene_.reference, fan_, limits_.data(), low, high, met);
      for (std::size_t i = 0; i < n; ++i) {
        if ((met.row[i] & ~k_mark) >= met_by.size()) return false;
        met_by[met.row[i] & ~k_mark] |= met.beams[i];
      }
    }
    for (std::size_t o = 0; o < scene_.outlines.size(); ++o)
      for (std::size_t e = 0; e < scene_.outlines[o].edges; ++e)
        for (std::size_t i = 0; i < beams_.count; ++i) {
          const float value = inverse_range_of(scene_.outlines[o], e, i);
          const bool counts = value > inverse_[i] && range_of(value, range_max_[i]) < range_max_[i];
          const BeamSet beam = beams_.scan ? ~BeamSet{0} : BeamSet{1} << i;
          if (counts && (met_by[o] & beam) == 0) return false;
        }
    return true;
  }

  float inverse_range_of(const Outline& outline, std::size_t edge, std::size_t beam) const {
    const RayEdge e = relative_edge(outline.vertices[edge], outline.vertices[edge + 1], scene_.reference,
                                    outline.ranger_return);
    return inverse_range(e, dx_[beam], dy_[beam], ox_[beam], oy_[beam]);
  }

  const Kernels& kernels_;
  const Scene& scene_;
  const Beams& beams_;
  const Rotation& rotation_;
  std::size_t size_;
  Fan fan_;
  Floats dx_ = Floats(size_), dy_ = dx_, ox_ = dx_, oy_ = dx_;
  Floats inverse_ = dx_, limits_ = dx_;
  Floats range_max_ = Floats(size_, 4.0f);
  float farthest_ = 0;
};

}  // namespace

bool kernels_are_right(const Kernels& kernels) {
  constexpr double k_heading = 0.3;
  const Scene scene;
  const Rotation rotation(k_heading);
  return std::ranges::all_of(fans(k_heading), [&](const Beams& beams) {
    return FanCheck(kernels, scene, beams, rotation).is_right();
  });
}

}  // namespace troupe::partition
