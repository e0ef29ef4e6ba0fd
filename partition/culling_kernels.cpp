// Culling kernels of the exact ray engine. They process a vector of circles at a time and discard the circles
// that no beam can reach. This file is compiled once for each instruction set that Highway supports.

#include "partition/kernel_target.hpp"
#include "partition/ranging.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "partition/culling_kernels.cpp"
#include <hwy/foreach_target.h>

#include "partition/scan_angles.inl"

HWY_BEFORE_NAMESPACE();
namespace troupe::partition {
namespace HWY_NAMESPACE {
namespace {

// Compiled once for each instruction set like the kernels, so that simd_target() reports which version the
// library Highway really runs.
std::int64_t compiled_for() { return HWY_TARGET; }

constexpr Rebind<std::uint32_t, Full<float>> k_u;

float limits_of(const Fan& fan, const float* inverse, const float* range_max, float* limits) {
  // If the inverse range is 0, the quotient is infinite and the limit is range_max plus the margins. Limits
  // only serve to discard edges that are too far away, so their last bits do not matter.
  Floats farthest = Zero(k_f);
  for (std::size_t i = 0; i < fan.padded(); i += Lanes(k_f)) {
    const Floats range = Min(divide(Set(k_f, 1.0f), LoadU(k_f, inverse + i)), LoadU(k_f, range_max + i));
    const Floats limit =
        Add(Mul(range, Set(k_f, 1 + static_cast<float>(k_range_slack))), Set(k_f, k_cull_slack));
    StoreU(limit, k_f, limits + i);
    farthest = Max(farthest, limit);
  }
  return GetLane(MaxOfLanes(k_f, farthest));
}

/// Two properties of a fan (see Fan). There is a specialised kernel for each combination of their values.
struct Shape {
  bool common_origin;
  bool mirrored;
};

/// The beams as line segments. Let p be the centre of a circle relative to the reference point (see Fan), d
/// the direction of a beam, and x the cross product in the plane. The centre is |p x d - aside| away from the
/// line of the beam. Along the beam, it is |p . d - middle| - half beyond the nearer end of the segment, or
/// between the two ends if this number is negative.
///
/// A segment ends at the limit of its beam (limits_of()), but is at most `high` + |ox| + |oy| long. `high` is
/// the largest distance from the reference of this search, so no circle of the search is beyond such a
/// segment. Because segments are short, rounding errors do not grow with the length of a beam.
struct Parts {
  alignas(64) float aside[k_most_beams];   // offset of the beam's line from the reference
  alignas(64) float middle[k_most_beams];  // middle of the segment, along the beam
  alignas(64) float half[k_most_beams];    // half the length of the segment

  HWY_INLINE Parts(const Fan& fan, const float* limits, float high) {
    for (std::size_t i = 0; i < fan.count; i += Lanes(k_f)) {
      const Floats dx = LoadU(k_f, fan.dx + i);
      const Floats dy = LoadU(k_f, fan.dy + i);
      const Floats ox = LoadU(k_f, fan.ox + i);
      const Floats oy = LoadU(k_f, fan.oy + i);
      const Floats end = Add(Set(k_f, high), Add(Abs(ox), Abs(oy)));
      const Floats length = Mul(Set(k_f, 0.5f), Min(LoadU(k_f, limits + i), end));
      Store(Sub(Mul(ox, dy), Mul(oy, dx)), k_f, aside + i);
      Store(Add(Add(Mul(ox, dx), Mul(oy, dy)), length), k_f, middle + i);
      Store(length, k_f, half + i);
    }
  }
};

/// For each circle of a vector of circles (x, y relative to the reference): the set of beams that may hit it,
/// one bit per beam.
template <Shape kShape>
HWY_INLINE Vec<decltype(k_u)> beams_that_meet(const Floats& x, const Floats& y, const Floats& radius,
                                              const Fan& fan, const Parts& parts) {
  // The bits of a set are shifted in from below, so that no bit needs its own constant. Subtracting the mask
  // sets the new bit where the mask holds, because a true lane is the integer -1.
  const auto mark_beam = [&](Vec<decltype(k_u)>& beams, const Floats& aside, const Floats& past) {
    const auto meets = RebindMask(k_u, Le(Max(aside, past), radius));
    beams = Sub(Add(beams, beams), VecFromMask(k_u, meets));
  };
  const std::size_t lines = kShape.mirrored ? fan.count / 2 : fan.count;
  auto forwards = Zero(k_u);
  auto backwards = Zero(k_u);
  for (std::size_t b = lines; b-- > 0;) {
    const Floats dx = Set(k_f, fan.dx[b]);
    const Floats dy = Set(k_f, fan.dy[b]);
    const Floats aside = Sub(Mul(x, dy), Mul(y, dx));
    const Floats along = Add(Mul(x, dx), Mul(y, dy));
    const auto past = [&](const Floats& from_middle, std::size_t beam) {
      return Sub(Abs(from_middle), Set(k_f, parts.half[beam]));
    };
    if constexpr (kShape.common_origin) {
      const Floats off = Abs(aside);
      mark_beam(forwards, off, past(Sub(along, Set(k_f, parts.middle[b])), b));
      if constexpr (kShape.mirrored)
        mark_beam(backwards, off, past(Add(along, Set(k_f, parts.middle[b + lines])), b + lines));
    } else {
      mark_beam(forwards, Abs(Sub(aside, Set(k_f, parts.aside[b]))),
                past(Sub(along, Set(k_f, parts.middle[b])), b));
      if constexpr (kShape.mirrored)
        mark_beam(backwards, Abs(Add(aside, Set(k_f, parts.aside[b + lines]))),
                  past(Add(along, Set(k_f, parts.middle[b + lines])), b + lines));
    }
  }
  if constexpr (kShape.mirrored) return Or(forwards, ShiftLeftSame(backwards, static_cast<int>(lines)));
  return forwards;
}

template <Shape kShape>
std::size_t keep_met(std::size_t count, const Fan& fan, const float* limits, float high, MetCircles& met) {
  if (count == 0) return 0;
  const Parts parts(fan, limits, high);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; i += Lanes(k_f)) {
    const auto beams = beams_that_meet<kShape>(LoadU(k_f, &met.x[i]), LoadU(k_f, &met.y[i]),
                                               LoadU(k_f, &met.radius[i]), fan, parts);
    const auto meets = Ne(beams, Zero(k_u));
    const auto rows = LoadU(k_u, &met.row[i]);
    StoreU(compress(rows, meets), k_u, &met.row[kept]);
    StoreU(compress(beams, meets), k_u, &met.beams[kept]);
    kept += count_true(k_u, meets);
  }
  return kept;
}

/// A rectangle with sides along the axes, relative to the reference.
struct Rectangle {
  float x, y;            // centre
  float half_x, half_y;  // half the width, half the height
};

/// The smallest rectangle that contains the reference and the beams whose limits are at least `low` away from
/// it. A beam counts with its whole length, even if the search ends nearer: the distance of the nearest point
/// of a circle decides in which search the circle is tested, but a beam may hit the circle farther away.
template <bool kCommonOrigin>
HWY_INLINE Rectangle around_beams(const Fan& fan, const float* limits, float low) {
  Floats low_x = Zero(k_f), low_y = low_x, high_x = low_x, high_y = low_x;
  const auto include = [&](const Floats& x, const Floats& y) {
    low_x = Min(low_x, x);
    low_y = Min(low_y, y);
    high_x = Max(high_x, x);
    high_y = Max(high_y, y);
  };
  for (std::size_t i = 0; i < fan.padded(); i += Lanes(k_f)) {
    const Floats dx = LoadU(k_f, fan.dx + i);
    const Floats dy = LoadU(k_f, fan.dy + i);
    const Floats limit = LoadU(k_f, limits + i);
    if constexpr (kCommonOrigin) {
      const Floats length = IfThenElseZero(Ge(limit, Set(k_f, low)), limit);
      include(Mul(dx, length), Mul(dy, length));
    } else {
      const Floats ox = LoadU(k_f, fan.ox + i);
      const Floats oy = LoadU(k_f, fan.oy + i);
      const Floats farthest = Add(limit, Add(Abs(ox), Abs(oy)));
      const Floats length = IfThenElseZero(Ge(farthest, Set(k_f, low)), limit);
      include(ox, oy);
      include(Add(ox, Mul(dx, length)), Add(oy, Mul(dy, length)));
    }
  }
  const float left = GetLane(MinOfLanes(k_f, low_x));
  const float right = GetLane(MaxOfLanes(k_f, high_x));
  const float bottom = GetLane(MinOfLanes(k_f, low_y));
  const float top = GetLane(MaxOfLanes(k_f, high_y));
  return {(left + right) / 2, (bottom + top) / 2, (right - left) / 2, (top - bottom) / 2};
}

/// A margin, m, for tests of circles up to `distance` (m) away from the reference. It is ten times the bound
/// on the rounding errors of the distances of circles from beams, which grow with |x| + |y|.
float margin_at(float distance, const Vec2& reference) {
  const auto shift = static_cast<float>(0x1p-23 * (std::abs(reference.x()) + std::abs(reference.y())));
  return k_cull_slack + shift + 3e-6f * distance;
}

/// Copies to `kept` the circles in [begin, end) for which is_near(x, y, radius, wider) holds, and makes their
/// coordinates relative to the reference. (x, y) are the relative centres, `radius` is the radii of the
/// circles and `wider` the radii that are copied, which are larger by at least `margin`. Returns the number
/// of circles. Pads them with one vector of circles that no beam hits, so `kept` needs room for two more
/// vectors than there are circles. The loop has no branch that depends on the data, because such a branch
/// would be unpredictable.
template <class IsNear>
HWY_INLINE std::size_t keep_near(const CircleArrays& circles, std::size_t begin, std::size_t end,
                                 const Vec2& reference, float margin, IsNear&& is_near, MetCircles& kept) {
  const Floats rx = Set(k_f, static_cast<float>(reference.x()));
  const Floats ry = Set(k_f, static_cast<float>(reference.y()));
  std::size_t count = 0;
  for (std::size_t i = begin; i < end; i += Lanes(k_f)) {
    const Floats x = Sub(LoadU(k_f, &circles.x[i]), rx);
    const Floats y = Sub(LoadU(k_f, &circles.y[i]), ry);
    const Floats radius = LoadU(k_f, &circles.radius[i]);
    const Floats wider = Add(Mul(radius, Set(k_f, 1 + 1.5e-5f)), Set(k_f, margin));
    const auto near = is_near(x, y, radius, wider);
    StoreU(compress(x, near), k_f, &kept.x[count]);
    StoreU(compress(y, near), k_f, &kept.y[count]);
    StoreU(compress(wider, near), k_f, &kept.radius[count]);
    StoreU(compress(LoadU(k_u, &circles.row[i]), RebindMask(k_u, near)), k_u, &kept.row[count]);
    count += count_true(k_f, near);
  }
  for (std::size_t i = count; i < count + k_circle_padding; ++i)
    kept.radius[i] = -std::numeric_limits<float>::infinity();
  return count;
}

/// Keeps the circles of keep_near() whose nearest point is at most `high` (m) away from the reference.
HWY_INLINE std::size_t keep_within(const CircleArrays& circles, std::size_t begin, std::size_t end,
                                   const Vec2& reference, float high, MetCircles& kept) {
  const auto is_near = [&](const Floats& x, const Floats& y, const Floats&, const Floats& wider) {
    const Floats outer = Max(Add(wider, Set(k_f, high)), Zero(k_f));
    return Le(Add(Mul(x, x), Mul(y, y)), Mul(outer, outer));
  };
  return keep_near(circles, begin, end, reference, margin_at(high, reference), is_near, kept);
}

/// Keeps the circles of keep_near() whose nearest point is at least `low` (m) away from the reference and
/// that reach into the rectangle around the beams that are so long. If few beams are so long, this rectangle
/// is much smaller than a disc.
HWY_INLINE std::size_t keep_beyond(const CircleArrays& circles, std::size_t begin, std::size_t end,
                                   const Vec2& reference, const Fan& fan, const float* limits, float low,
                                   float high, MetCircles& kept) {
  // Twice the margin, because a circle has a larger radius than what it encloses (enclosing_circle()).
  const float nearest = std::max(0.0f, low - 2 * margin_at(low, reference));
  const Rectangle beams = fan.common_origin ? around_beams<true>(fan, limits, nearest)
                                            : around_beams<false>(fan, limits, nearest);
  const auto is_near = [&](const Floats& x, const Floats& y, const Floats& radius, const Floats& wider) {
    const Floats inner = Add(Mul(radius, Set(k_f, 1 - 1e-5f)), Set(k_f, nearest));
    const auto in_x = Le(Abs(Sub(x, Set(k_f, beams.x))), Add(wider, Set(k_f, beams.half_x)));
    const auto in_y = Le(Abs(Sub(y, Set(k_f, beams.y))), Add(wider, Set(k_f, beams.half_y)));
    return And(And(in_x, in_y), Ge(Add(Mul(x, x), Mul(y, y)), Mul(inner, inner)));
  };
  return keep_near(circles, begin, end, reference, margin_at(high, reference), is_near, kept);
}

std::size_t keep_met_by_scan(std::size_t count, const Fan& fan, const float* limits, MetCircles& met) {
  const ScanAngles angles(*fan.scan, fan.count);
  // The number of circles so far that span beams: a circle spans the beams whose directions it subtends, seen
  // from the origin of the scan. These circles come first in `met`. Their x and y are replaced by the numbers
  // of the first and the last beam that they span, and their radius by the distance of their nearest point.
  std::size_t spanning = 0;
  for (std::size_t i = 0; i < count; i += Lanes(k_f)) {
    const Floats x = LoadU(k_f, &met.x[i]);
    const Floats y = LoadU(k_f, &met.y[i]);
    const Floats radius = LoadU(k_f, &met.radius[i]);
    const auto rows = LoadU(k_u, &met.row[i]);
    const Floats distance = Sqrt(Add(Mul(x, x), Mul(y, y)));
    const Floats angle = angles.of(x, y);
    // The circle subtends the angles up to asin(radius / distance) on each side of its centre. An upper bound
    // is asin(q) <= q + (pi/2 - 1) q^3 for q in [0, 1].
    const Floats q = divide(radius, distance);
    const Floats width = Add(q, Mul(Set(k_f, 0.5708f), Mul(Mul(q, q), q)));
    const Floats from = Sub(angle, width);
    const Floats to = Add(angle, width);
    Floats first, last;
    angles.beams(from, to, Ge(radius, distance), first, last);
    const auto circle = Ge(radius, Zero(k_f));  // false for the padding of the last vector
    const auto spans = And(Le(first, last), circle);
    StoreU(compress(first, spans), k_f, &met.x[spanning]);
    StoreU(compress(last, spans), k_f, &met.y[spanning]);
    StoreU(compress(Sub(distance, radius), spans), k_f, &met.radius[spanning]);
    StoreU(compress(rows, RebindMask(k_u, spans)), k_u, &met.row[spanning]);
    spanning += count_true(k_f, spans);
  }
  const auto lanes = static_cast<std::int32_t>(Lanes(k_f));
  const std::int32_t highest = static_cast<std::int32_t>(fan.padded()) - lanes;
  const auto lane = Iota(k_f, 0.0f);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < spanning; ++i) {
    const Floats from = Set(k_f, met.x[i]);
    const Floats to = Set(k_f, met.y[i]);
    // The limits of beams that the circle does not span are replaced by 0. Otherwise a circle could be kept
    // because of the long limit of a beam that cannot hit it.
    const auto limits_at = [&](std::int32_t at) {
      const Floats beam = Add(lane, Set(k_f, static_cast<float>(at)));
      return IfThenElseZero(And(Ge(beam, from), Le(beam, to)), LoadU(k_f, limits + at));
    };
    // Most circles span at most two vectors of beams: one that begins with the first beam and one that ends
    // with the last beam. These two are tested without a branch, because a branch would be unpredictable.
    const auto first = std::min(static_cast<std::int32_t>(met.x[i]), highest);
    const auto end = static_cast<std::int32_t>(met.y[i]) + 1 - lanes;
    Floats farthest = Max(limits_at(first), limits_at(std::max(first, end)));
    for (std::int32_t beam = first + lanes; beam < end; beam += lanes)
      farthest = Max(farthest, LoadU(k_f, limits + beam));
    met.row[kept] = met.row[i];
    met.beams[kept] = all_beams(fan);
    kept += AllFalse(k_f, Le(Set(k_f, met.radius[i]), farthest)) ? 0 : 1;
  }
  return kept;
}

std::size_t fan_may_meet(const CircleArrays& circles, std::size_t begin, std::size_t end,
                         const Vec2& reference, const Fan& fan, const float* limits, float low, float high,
                         MetCircles& met) {
  const std::size_t count = low < 0
                                ? keep_within(circles, begin, end, reference, high, met)
                                : keep_beyond(circles, begin, end, reference, fan, limits, low, high, met);
  if (fan.scan != nullptr) return keep_met_by_scan(count, fan, limits, met);
  if (!fan.common_origin)
    return fan.mirrored ? keep_met<Shape{false, true}>(count, fan, limits, high, met)
                        : keep_met<Shape{false, false}>(count, fan, limits, high, met);
  return fan.mirrored ? keep_met<Shape{true, true}>(count, fan, limits, high, met)
                      : keep_met<Shape{true, false}>(count, fan, limits, high, met);
}

void unpack_runs(std::span<const CircleRun> runs, std::uint32_t mark, std::size_t size, CircleArrays& out) {
  constexpr Capped<std::uint32_t, 4> k_four;  // runs are short
  constexpr Rebind<float, decltype(k_four)> k_floats;
  static_assert(sizeof(BodyCircle) == 4 * sizeof(float));
  const auto bits = Set(k_four, mark);
  for (const CircleRun& run : runs) {
    for (std::size_t i = 0; i < run.size(); i += Lanes(k_four)) {
      Vec<decltype(k_floats)> x, y, radius, row;
      LoadInterleaved4(k_floats, &run[i].x, x, y, radius, row);
      StoreU(x, k_floats, &out.x[size + i]);
      StoreU(y, k_floats, &out.y[size + i]);
      StoreU(radius, k_floats, &out.radius[size + i]);
      StoreU(Or(BitCast(k_four, row), bits), k_four, &out.row[size + i]);
    }
    size += run.size();
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace troupe::partition
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace troupe::partition {

HWY_EXPORT(compiled_for);
HWY_EXPORT(limits_of);
HWY_EXPORT(fan_may_meet);
HWY_EXPORT(unpack_runs);

std::int64_t kernel_target() { return HWY_DYNAMIC_DISPATCH(compiled_for)(); }

float limits_of(const Fan& fan, const float* inverse, const float* range_max, float* limits) {
  return HWY_DYNAMIC_DISPATCH(limits_of)(fan, inverse, range_max, limits);
}

std::size_t may_meet(const CircleArrays& circles, std::size_t begin, std::size_t end, const Vec2& reference,
                     const Fan& fan, const float* limits, float low, float high, MetCircles& met) {
  met.change_capacity(end - begin + 2 * k_circle_padding);
  return HWY_DYNAMIC_DISPATCH(fan_may_meet)(circles, begin, end, reference, fan, limits, low, high, met);
}

void unpack(std::span<const CircleRun> runs, std::uint32_t mark, std::size_t size, CircleArrays& out) {
  HWY_DYNAMIC_DISPATCH(unpack_runs)(runs, mark, size, out);
}

}  // namespace troupe::partition
#endif
