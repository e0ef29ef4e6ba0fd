// The vector form of the exact ray engine, compiled once for each instruction set that Highway knows and
// chosen as the program starts. Beams are lanes where edges are projected; circles are lanes where they are
// culled. The bits of an inverse range are those of inverse_range(), on every target.

#include "partition/ranging.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "partition/ranging_kernels.cpp"
#include <hwy/foreach_target.h>

#include "partition/simd.inl"

HWY_BEFORE_NAMESPACE();
namespace troupe::partition {
namespace HWY_NAMESPACE {
namespace {

using namespace simd;

constexpr Full<float> k_f;
constexpr Full<double> k_d;
constexpr Rebind<std::uint32_t, Full<float>> k_u;
constexpr Rebind<std::int32_t, Full<float>> k_i;
constexpr Rebind<float, Full<double>> k_half;  // as many floats as doubles in a vector
using Floats = Vec<Full<float>>;
using Few = Capped<float, 8>;
constexpr Few k_few;

constexpr float k_quarter = 1.57079633f;  // of a turn, rad

/// A block's edges relative to the reference, each number an array: what relative_edge() makes.
struct Relative {
  static constexpr std::size_t k_size = EdgeBlock::k_capacity;
  alignas(64) float ax[k_size], ay[k_size], bx[k_size], by[k_size], ex[k_size], ey[k_size];
  alignas(64) float area[k_size], per_area[k_size], magnitude[k_size], grazing[k_size];

  /// A bit for each edge for which some beam wants care: inverse_range() does those, one by one.
  std::uint64_t careful[k_size / 64] = {};
  void mark(std::size_t i) { careful[i / 64] |= std::uint64_t{1} << (i % 64); }
};

/// Edges relative to the reference.
HWY_INLINE void relate(const EdgeBlock& edges, const Vec2& reference, Relative& out) {
  const auto rx = Set(k_d, reference.x());
  const auto ry = Set(k_d, reference.y());
  const auto noise = Set(k_d, 0x1p-50);
  for (std::size_t i = 0; i < edges.count(); i += Lanes(k_d)) {
    Vec<Full<double>> from_x, from_y, to_x, to_y;
    LoadInterleaved4(k_d, edges.ends() + 4 * i, from_x, from_y, to_x, to_y);
    const auto ax = Sub(from_x, rx);
    const auto ay = Sub(from_y, ry);
    const auto bx = Sub(to_x, rx);
    const auto by = Sub(to_y, ry);
    const auto p = Mul(ax, by);
    const auto q = Mul(ay, bx);
    const auto difference = Sub(p, q);
    const auto on_line = Le(Abs(difference), Mul(noise, Add(Abs(p), Abs(q))));
    Store(DemoteTo(k_half, ax), k_half, out.ax + i);
    Store(DemoteTo(k_half, ay), k_half, out.ay + i);
    Store(DemoteTo(k_half, bx), k_half, out.bx + i);
    Store(DemoteTo(k_half, by), k_half, out.by + i);
    Store(DemoteTo(k_half, Sub(to_x, from_x)), k_half, out.ex + i);
    Store(DemoteTo(k_half, Sub(to_y, from_y)), k_half, out.ey + i);
    Store(DemoteTo(k_half, IfThenZeroElse(on_line, difference)), k_half, out.area + i);
  }
}

HWY_INLINE Floats magnitude_of(const Relative& e, std::size_t i) {
  return Add(Add(Add(Abs(Load(k_f, e.ax + i)), Abs(Load(k_f, e.ay + i))), Abs(Load(k_f, e.bx + i))),
             Abs(Load(k_f, e.by + i)));
}

HWY_INLINE Floats grazing_of(const Relative& e, std::size_t i) {
  return Mul(Set(k_f, k_grazing), Add(Abs(Load(k_f, e.ex + i)), Abs(Load(k_f, e.ey + i))));
}

/// For origins that lie apart.
HWY_INLINE void prepare_apart(std::size_t count, Relative& e) {
  for (std::size_t i = 0; i < count; i += Lanes(k_f)) {
    Store(magnitude_of(e, i), k_f, e.magnitude + i);
    Store(grazing_of(e, i), k_f, e.grazing + i);
  }
}

/// For a common origin: turns edges so that their areas are positive. Those that look tiny from the reference
/// are marked for care at once, and no beam meets them the fast way.
HWY_INLINE void prepare_common(std::size_t count, Relative& e) {
  for (std::size_t i = 0; i < count; i += Lanes(k_f)) {
    const Floats area = Load(k_f, e.area + i);
    const Floats m = magnitude_of(e, i);
    const auto tiny = Le(Abs(area), Mul(Set(k_f, k_tiny), Mul(m, m)));
    Store(IfThenElse(tiny, Set(k_f, 1e30f), grazing_of(e, i)), k_f, e.grazing + i);
    Store(Div(Set(k_f, 1.0f), Abs(area)), k_f, e.per_area + i);
    const Floats turn = CopySign(Set(k_f, 1.0f), area);
    for (float* number : {e.ax + i, e.ay + i, e.bx + i, e.by + i, e.ex + i, e.ey + i})
      Store(Mul(turn, Load(k_f, number)), k_f, number);
    if (HWY_UNLIKELY(!AllFalse(k_f, tiny))) {
      alignas(64) float marks[Relative::k_size];
      Store(IfThenElseZero(tiny, Set(k_f, 1.0f)), k_f, marks);
      for (std::size_t j = i; j < std::min(i + Lanes(k_f), count); ++j)
        if (marks[j - i] != 0) e.mark(j);
    }
  }
}

/// One vector of beams and the nearest that each has met so far.
template <bool kReturns, class Tag>
struct Met {
  static constexpr Tag k_tag{};
  Vec<Tag> inverse, returns;

  HWY_INLINE Met(const float* from_inverse, const float* from_returns)
      : inverse(LoadU(k_tag, from_inverse)), returns(kReturns ? LoadU(k_tag, from_returns) : Zero(k_tag)) {}
  HWY_INLINE void raise(const Vec<Tag>& candidate, float ranger_return) {
    if constexpr (kReturns) {
      const auto value = Set(k_tag, ranger_return);
      const auto nearer = Gt(candidate, inverse);
      const auto level = And(Eq(candidate, inverse), Gt(candidate, Zero(k_tag)));
      returns = IfThenElse(nearer, value, IfThenElse(level, Max(returns, value), returns));
    }
    inverse = Max(inverse, candidate);
  }
  HWY_INLINE void store(float* to_inverse, float* to_returns) const {
    StoreU(inverse, k_tag, to_inverse);
    if constexpr (kReturns) StoreU(returns, k_tag, to_returns);
  }
};

/// Edge j on one vector of beams from the reference; true when some beam wants care.
template <bool kReturns, class Tag>
HWY_INLINE bool project_common(const Relative& e, std::size_t j, const Vec<Tag>& dx, const Vec<Tag>& dy,
                               float ranger_return, Met<kReturns, Tag>& met) {
  constexpr Tag k_tag{};
  // Turned so that the area is positive, the edge is met from c_a >= 0 to c_b <= 0 and lies behind otherwise.
  const auto ca = Sub(Mul(Set(k_tag, e.ax[j]), dy), Mul(Set(k_tag, e.ay[j]), dx));
  const auto minus_cb = Sub(Mul(Set(k_tag, e.by[j]), dx), Mul(Set(k_tag, e.bx[j]), dy));
  const auto across = Sub(Mul(dx, Set(k_tag, e.ey[j])), Mul(dy, Set(k_tag, e.ex[j])));
  const auto sides = Min(ca, minus_cb);
  const auto sharp = Min(sides, Sub(across, Set(k_tag, e.grazing[j])));  // >= 0: met, and not grazing
  const auto met_sharply = Ge(sharp, Zero(k_tag));
  met.raise(IfThenElseZero(met_sharply, Mul(across, Set(k_tag, e.per_area[j]))), ranger_return);
  return !AllFalse(k_tag, Xor(Ge(sides, Zero(k_tag)), met_sharply));
}

/// The same for beams whose origins lie apart. (Noting first which edges some beam meets, to save the rest
/// their division, lost.)
template <bool kReturns>
HWY_INLINE bool project_apart(const Relative& e, std::size_t j, const Floats& dx, const Floats& dy,
                              const Floats& ox, const Floats& oy, float ranger_return,
                              Met<kReturns, Full<float>>& met) {
  const Floats ex = Set(k_f, e.ex[j]);
  const Floats ey = Set(k_f, e.ey[j]);
  const Floats ca = Sub(Mul(Sub(Set(k_f, e.ax[j]), ox), dy), Mul(Sub(Set(k_f, e.ay[j]), oy), dx));
  const Floats cb = Sub(Mul(Sub(Set(k_f, e.bx[j]), ox), dy), Mul(Sub(Set(k_f, e.by[j]), oy), dx));
  const Floats across = Sub(Mul(dx, ey), Mul(dy, ex));
  const Floats area = Sub(Set(k_f, e.area[j]), Sub(Mul(ox, ey), Mul(oy, ex)));
  const Floats m = Add(Set(k_f, e.magnitude[j]), Add(Abs(ox), Abs(oy)));
  const auto tiny = Le(Abs(area), Mul(Set(k_f, k_tiny), Mul(m, m)));
  const Floats sides = Min(Max(ca, cb), Neg(Min(ca, cb)));  // >= 0: different ones
  const Floats sharp = Min(sides, Sub(Abs(across), Set(k_f, e.grazing[j])));
  const auto met_sharply = Ge(sharp, Zero(k_f));
  const Floats candidate = Mul(across, Div(Set(k_f, 1.0f), area));
  met.raise(IfThenZeroElse(tiny, IfThenElseZero(met_sharply, candidate)), ranger_return);
  return !AllFalse(k_f, Or(tiny, Xor(Ge(sides, Zero(k_f)), met_sharply)));
}

/// Beams of a fan: all, or those that an edge spans.
struct Span {
  std::size_t first, last;
};

/// What the loops left out.
template <class SpanOf>
HWY_INLINE void project_carefully(const EdgeBlock& edges, const Vec2& reference, const Fan& fan,
                                  const Relative& relative, SpanOf&& span_of, float* inverse,
                                  float* returns) {
  for (std::size_t j = 0; j < edges.count(); ++j) {
    if (j % 64 == 0 && relative.careful[j / 64] == 0) {  // nearly always
      j += 63;
      continue;
    }
    if ((relative.careful[j / 64] >> (j % 64) & 1) == 0) continue;
    const RayEdge e = edges.relative(j, reference);
    const Span span = span_of(j);
    for (std::size_t i = span.first; i <= span.last; ++i) {
      const float value = inverse_range(e, fan.dx[i], fan.dy[i], fan.ox[i], fan.oy[i]);
      if (returns != nullptr) {
        if (value > inverse[i])
          returns[i] = e.ranger_return;
        else if (value == inverse[i] && value > 0)
          returns[i] = std::max(returns[i], e.ranger_return);
      }
      inverse[i] = std::max(inverse[i], value);
    }
  }
}

HWY_INLINE auto all_beams(const Fan& fan) {
  return [last = fan.padded() - 1](std::size_t) { return Span{0, last}; };
}

template <bool kReturns>
void project_from_one_origin(const EdgeBlock& edges, const Vec2& reference, const Fan& fan, float* inverse,
                             float* returns) {
  Relative relative;
  relate(edges, reference, relative);
  prepare_common(edges.count(), relative);
  for (std::size_t i = 0; i < fan.padded(); i += Lanes(k_f)) {
    const Floats dx = LoadU(k_f, fan.dx + i);
    const Floats dy = LoadU(k_f, fan.dy + i);
    Met<kReturns, Full<float>> met(inverse + i, returns + i);
    for (std::size_t j = 0; j < edges.count(); ++j) {
      const float ranger_return = kReturns ? edges.ranger_return(j) : 0;
      if (HWY_UNLIKELY(project_common(relative, j, dx, dy, ranger_return, met))) relative.mark(j);
    }
    met.store(inverse + i, returns + i);
  }
  project_carefully(edges, reference, fan, relative, all_beams(fan), inverse, returns);
}

template <bool kReturns>
void project_from_apart(const EdgeBlock& edges, const Vec2& reference, const Fan& fan, float* inverse,
                        float* returns) {
  Relative relative;
  relate(edges, reference, relative);
  prepare_apart(edges.count(), relative);
  for (std::size_t i = 0; i < fan.padded(); i += Lanes(k_f)) {
    const Floats dx = LoadU(k_f, fan.dx + i);
    const Floats dy = LoadU(k_f, fan.dy + i);
    const Floats ox = LoadU(k_f, fan.ox + i);
    const Floats oy = LoadU(k_f, fan.oy + i);
    Met<kReturns, Full<float>> met(inverse + i, returns + i);
    for (std::size_t j = 0; j < edges.count(); ++j) {
      const float ranger_return = kReturns ? edges.ranger_return(j) : 0;
      if (HWY_UNLIKELY(project_apart(relative, j, dx, dy, ox, oy, ranger_return, met))) relative.mark(j);
    }
    met.store(inverse + i, returns + i);
  }
  project_carefully(edges, reference, fan, relative, all_beams(fan), inverse, returns);
}

void project_fan(const EdgeBlock& edges, const Vec2& reference, const Fan& fan, float* inverse,
                 float* returns) {
  if (fan.common_origin) {
    if (returns == nullptr)
      project_from_one_origin<false>(edges, reference, fan, inverse, returns);
    else
      project_from_one_origin<true>(edges, reference, fan, inverse, returns);
  } else if (returns == nullptr) {
    project_from_apart<false>(edges, reference, fan, inverse, returns);
  } else {
    project_from_apart<true>(edges, reference, fan, inverse, returns);
  }
}

/// The angle of (x, y), rad in [-pi, pi], to 1e-4: for culls. Any angle for (0, 0).
/// source  Abramowitz and Stegun, Handbook of mathematical functions, 4.4.47
HWY_INLINE Floats angle_of(const Floats& x, const Floats& y) {
  const Floats across = Min(Abs(x), Abs(y));
  const Floats along = Max(Max(Abs(x), Abs(y)), Set(k_f, 1e-30f));
  const Floats q = Div(across, along);
  const Floats q2 = Mul(q, q);
  Floats sum = Set(k_f, 0.0208351f);
  for (const float c : {-0.0851330f, 0.1801410f, -0.3302995f, 0.9998660f})
    sum = Add(Mul(sum, q2), Set(k_f, c));
  Floats angle = Mul(sum, q);
  angle = IfThenElse(Gt(Abs(y), Abs(x)), Sub(Set(k_f, k_quarter), angle), angle);
  angle = IfThenElse(Lt(x, Zero(k_f)), Sub(Set(k_f, 2 * k_quarter), angle), angle);
  return CopySign(angle, y);
}

/// Angles from the middle of a scan and numbers of beams, each with a margin above what angle_of() is off.
class ScanAngles {
 public:
  ScanAngles(const Scan& scan, std::size_t count)
      : mx_(Set(k_f, static_cast<float>(scan.middle.x()))),
        my_(Set(k_f, static_cast<float>(scan.middle.y()))),
        half_fov_(Set(k_f, 0.5f * scan.fov)),
        per_step_(Set(k_f, 1 / scan.step)),
        last_(Set(k_f, static_cast<float>(count - 1))) {}

  HWY_INLINE Floats of(const Floats& x, const Floats& y) const {
    return angle_of(Add(Mul(x, mx_), Mul(y, my_)), Sub(Mul(y, mx_), Mul(x, my_)));
  }
  /// The first and the last beam between two angles, as floats; first > last where there is none. All beams
  /// where `all` holds or the angles come to the back, where they jump.
  template <class Mask>
  HWY_INLINE void beams(const Floats& from, const Floats& to, const Mask& all, Floats& first,
                        Floats& last) const {
    const Floats margin = Set(k_f, 1e-3f);
    first = Max(Ceil(Mul(Add(Sub(from, margin), half_fov_), per_step_)), Zero(k_f));
    last = Min(Floor(Mul(Add(Add(to, margin), half_fov_), per_step_)), last_);
    const Floats back = Set(k_f, 2 * k_quarter - 2e-3f);
    const auto whole = Or(all, Or(Lt(from, Neg(back)), Gt(to, back)));
    first = IfThenZeroElse(whole, first);
    last = IfThenElse(whole, last_, last);
  }

 private:
  Floats mx_, my_, half_fov_, per_step_, last_;
};

template <bool kReturns>
void project_on_spans(const EdgeBlock& edges, const Vec2& reference, const Fan& fan, const Scan& scan,
                      float* inverse, float* returns) {
  Relative relative;
  relate(edges, reference, relative);
  alignas(64) std::int32_t first[Relative::k_size];
  alignas(64) std::int32_t last[Relative::k_size];
  const ScanAngles angles(scan, fan.count);
  for (std::size_t i = 0; i < edges.count(); i += Lanes(k_f)) {
    const Floats a = angles.of(Load(k_f, relative.ax + i), Load(k_f, relative.ay + i));
    const Floats b = angles.of(Load(k_f, relative.bx + i), Load(k_f, relative.by + i));
    const Floats from = Min(a, b);
    const Floats to = Max(a, b);
    // Seen under nearly half a turn or more, it passes the origin closely or behind.
    const auto all = Gt(Sub(to, from), Set(k_f, 3.0f));
    Floats first_beam, last_beam;
    angles.beams(from, to, all, first_beam, last_beam);
    Store(ConvertTo(k_i, first_beam), k_i, first + i);
    Store(ConvertTo(k_i, last_beam), k_i, last + i);
  }
  prepare_common(edges.count(), relative);

  const auto project_step = [&](std::size_t j, std::size_t at) {
    Met<kReturns, Few> met(inverse + at, returns + at);
    const float ranger_return = kReturns ? edges.ranger_return(j) : 0;
    if (HWY_UNLIKELY(project_common(relative, j, LoadU(k_few, fan.dx + at), LoadU(k_few, fan.dy + at),
                                    ranger_return, met)))
      relative.mark(j);
    met.store(inverse + at, returns + at);
  };
  // Most edges span few beams: one vector of them or two, which are noted without a branch that nobody could
  // foretell. Vectors begin at multiples of their length, so that edges side by side write the same ones.
  struct Step {
    std::uint32_t edge, at;
  };
  Step steps[2 * Relative::k_size + 1];
  std::size_t count = 0;
  const auto lanes = static_cast<std::uint32_t>(Lanes(k_few));
  for (std::uint32_t j = 0; j < edges.count(); ++j) {
    const std::uint32_t begin = static_cast<std::uint32_t>(first[j]) / lanes * lanes;
    const std::uint32_t end = static_cast<std::uint32_t>(last[j]) / lanes * lanes;
    const auto some = static_cast<std::uint32_t>(first[j] <= last[j]);
    steps[count] = {j, begin};
    count += some;
    steps[count] = {j, end};
    count += some & static_cast<std::uint32_t>(end != begin);
    if (HWY_UNLIKELY((some & static_cast<std::uint32_t>(end > begin + lanes)) != 0))
      for (std::uint32_t at = begin + lanes; at < end; at += lanes) project_step(j, at);
  }
  for (std::size_t k = 0; k < count; ++k) project_step(steps[k].edge, steps[k].at);

  // What looks tiny may be met in any direction.
  const auto span_of = [&](std::size_t j) {
    if (relative.grazing[j] >= 1e30f || first[j] > last[j]) return Span{0, fan.padded() - 1};
    return Span{static_cast<std::size_t>(first[j]), static_cast<std::size_t>(last[j])};
  };
  project_carefully(edges, reference, fan, relative, span_of, inverse, returns);
}

void project_scan(const EdgeBlock& edges, const Vec2& reference, const Fan& fan, const Scan& scan,
                  float* inverse, float* returns) {
  if (returns == nullptr)
    project_on_spans<false>(edges, reference, fan, scan, inverse, returns);
  else
    project_on_spans<true>(edges, reference, fan, scan, inverse, returns);
}

float limits_of(const Fan& fan, const float* inverse, const float* range_max, float* limits) {
  // An inverse of 0 makes infinity, and range_max the limit. The bits of a limit do not matter.
  Floats farthest = Zero(k_f);
  for (std::size_t i = 0; i < fan.padded(); i += Lanes(k_f)) {
    const Floats range = Min(Div(Set(k_f, 1.0f), LoadU(k_f, inverse + i)), LoadU(k_f, range_max + i));
    const Floats limit =
        Add(Mul(range, Set(k_f, 1 + static_cast<float>(k_range_slack))), Set(k_f, k_cull_slack));
    StoreU(limit, k_f, limits + i);
    farthest = Max(farthest, limit);
  }
  return GetLane(MaxOfLanes(k_f, farthest));
}

enum class Beams { mirrored, common, apart };

/// Of a vector of circles relative to the reference, those that some beam may meet.
template <Beams kBeams>
HWY_INLINE Mask<Full<float>> circles_met(const Floats& x, const Floats& y, const Floats& radius,
                                         const Fan& fan, const float* limits) {
  // How far the circle's middle lies outside the part of each beam that is still to be seen: the least of it.
  Floats outside = Set(k_f, std::numeric_limits<float>::infinity());
  const std::size_t lines = kBeams == Beams::mirrored ? fan.count / 2 : fan.count;
  for (std::size_t b = 0; b < lines; ++b) {
    const Floats dx = Set(k_f, fan.dx[b]);
    const Floats dy = Set(k_f, fan.dy[b]);
    const Floats ex = kBeams == Beams::apart ? Sub(x, Set(k_f, fan.ox[b])) : x;
    const Floats ey = kBeams == Beams::apart ? Sub(y, Set(k_f, fan.oy[b])) : y;
    const Floats aside = Abs(Sub(Mul(ex, dy), Mul(ey, dx)));
    const Floats along = Add(Mul(ex, dx), Mul(ey, dy));
    const Floats ahead = Set(k_f, limits[b]);
    Floats beyond;
    if constexpr (kBeams == Beams::mirrored) {
      const Floats behind = Set(k_f, limits[b + lines]);
      beyond = Sub(Abs(along), IfThenElse(Lt(along, Zero(k_f)), behind, ahead));
    } else {
      beyond = Max(Sub(along, ahead), Neg(along));
    }
    outside = Min(outside, Max(aside, beyond));
  }
  return Le(outside, radius);
}

template <Beams kBeams>
std::size_t keep_met(std::size_t count, const Fan& fan, const float* limits, CircleArrays& met) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; i += Lanes(k_f)) {
    const auto meets = circles_met<kBeams>(LoadU(k_f, &met.x[i]), LoadU(k_f, &met.y[i]),
                                           LoadU(k_f, &met.radius[i]), fan, limits);
    const auto rows = LoadU(k_u, &met.row[i]);
    StoreU(Compress(rows, RebindMask(k_u, meets)), k_u, &met.row[kept]);
    kept += CountTrue(k_f, meets);
  }
  return kept;
}

void turn_beams(const Rotation& rotation, const double* x, const double* y, std::size_t count, float* out_x,
                float* out_y) {
  const auto c = Set(k_d, rotation.cos);
  const auto s = Set(k_d, rotation.sin);
  for (std::size_t i = 0; i < padded_beams(count); i += Lanes(k_d)) {
    const auto bx = LoadU(k_d, x + i);
    const auto by = LoadU(k_d, y + i);
    StoreU(DemoteTo(k_half, Sub(Mul(bx, c), Mul(by, s))), k_half, out_x + i);
    StoreU(DemoteTo(k_half, Add(Mul(bx, s), Mul(by, c))), k_half, out_y + i);
  }
}

void ranges_of_fan(const Fan& fan, const float* inverse, const float* range_max, float* ranges) {
  const auto range = [&](std::size_t i) {
    const Floats most = LoadU(k_f, range_max + i);
    const Floats value = LoadU(k_f, inverse + i);
    const Floats one = Set(k_f, 1.0f);
    return IfThenElse(Gt(value, Div(one, most)), Min(Div(one, value), most), most);
  };
  const std::size_t whole = fan.count / Lanes(k_f) * Lanes(k_f);
  for (std::size_t i = 0; i < whole; i += Lanes(k_f)) StoreU(range(i), k_f, ranges + i);
  if (whole == fan.count) return;
  alignas(64) float rest[k_beam_padding];
  Store(range(whole), k_f, rest);
  std::copy_n(rest, fan.count - whole, ranges + whole);
}

/// Circles whose nearest point lies from low to high away, relative to the reference and with their margins;
/// padded with one vector that nothing meets.
HWY_INLINE std::size_t keep_between(const CircleArrays& circles, std::size_t begin, std::size_t end,
                                    const Vec2& reference, float low, float high, CircleArrays& kept) {
  const Floats rx = Set(k_f, static_cast<float>(reference.x()));
  const Floats ry = Set(k_f, static_cast<float>(reference.y()));
  const auto shift = static_cast<float>(0x1p-23 * (std::abs(reference.x()) + std::abs(reference.y())));
  const Floats slack = Set(k_f, k_cull_slack + shift);  // by rounding of the reference, too
  kept.make_room(end - begin + 2 * k_circle_padding);
  std::size_t count = 0;
  for (std::size_t i = begin; i < end; i += Lanes(k_f)) {
    const Floats x = Sub(LoadU(k_f, &circles.x[i]), rx);
    const Floats y = Sub(LoadU(k_f, &circles.y[i]), ry);
    // Float errors of sides grow with the distance: ten times their bound.
    const Floats radius = Add(Add(Mul(LoadU(k_f, &circles.radius[i]), Set(k_f, 1 + 1e-5f)),
                                  Mul(Add(Abs(x), Abs(y)), Set(k_f, 2e-6f))),
                              slack);
    const Floats distance2 = Add(Mul(x, x), Mul(y, y));
    const Floats outer = Max(Add(radius, Set(k_f, high)), Zero(k_f));
    const Floats inner = Max(Add(radius, Set(k_f, low)), Zero(k_f));
    const auto here = And(Le(distance2, Mul(outer, outer)), Ge(distance2, Mul(inner, inner)));
    if (AllFalse(k_f, here)) continue;
    StoreU(Compress(x, here), k_f, &kept.x[count]);
    StoreU(Compress(y, here), k_f, &kept.y[count]);
    StoreU(Compress(radius, here), k_f, &kept.radius[count]);
    StoreU(Compress(LoadU(k_u, &circles.row[i]), RebindMask(k_u, here)), k_u, &kept.row[count]);
    count += CountTrue(k_f, here);
  }
  for (std::size_t i = count; i < count + k_circle_padding; ++i)
    kept.radius[i] = -std::numeric_limits<float>::infinity();
  return count;
}

std::size_t fan_may_meet(const CircleArrays& circles, std::size_t begin, std::size_t end,
                         const Vec2& reference, const Fan& fan, const float* limits, float low, float high,
                         CircleArrays& met) {
  const std::size_t count = keep_between(circles, begin, end, reference, low, high, met);
  if (!fan.common_origin) return keep_met<Beams::apart>(count, fan, limits, met);
  return fan.mirrored ? keep_met<Beams::mirrored>(count, fan, limits, met)
                      : keep_met<Beams::common>(count, fan, limits, met);
}

std::size_t scan_may_meet(const CircleArrays& circles, std::size_t begin, std::size_t end,
                          const Vec2& reference, const Fan& fan, const Scan& scan, const float* limits,
                          float low, float high, CircleArrays& met) {
  const std::size_t count = keep_between(circles, begin, end, reference, low, high, met);
  const ScanAngles angles(scan, fan.count);
  for (std::size_t i = 0; i < count; i += Lanes(k_f)) {
    const Floats x = LoadU(k_f, &met.x[i]);
    const Floats y = LoadU(k_f, &met.y[i]);
    const Floats radius = LoadU(k_f, &met.radius[i]);
    const Floats distance = Sqrt(Add(Mul(x, x), Mul(y, y)));
    const Floats angle = angles.of(x, y);
    // asin q <= q + (pi/2 - 1) q^3 on [0, 1]
    const Floats q = Div(radius, distance);
    const Floats width = Add(q, Mul(Set(k_f, 0.5708f), Mul(Mul(q, q), q)));
    const Floats from = Sub(angle, width);
    const Floats to = Add(angle, width);
    Floats first, last;
    angles.beams(from, to, Ge(radius, distance), first, last);
    StoreU(first, k_f, &met.x[i]);
    StoreU(last, k_f, &met.y[i]);
    StoreU(Sub(distance, radius), k_f, &met.radius[i]);
  }
  const std::size_t highest = fan.padded() - Lanes(k_f);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!(met.x[i] <= met.y[i])) continue;
    const auto past = static_cast<std::size_t>(met.y[i]) + 1;
    const Floats nearest = Set(k_f, met.radius[i]);
    bool seen = false;
    for (auto b = static_cast<std::size_t>(met.x[i]); b < past && !seen; b += Lanes(k_f))
      seen = !AllFalse(k_f, Le(nearest, LoadU(k_f, limits + std::min(b, highest))));
    met.row[kept] = met.row[i];
    kept += seen ? 1 : 0;
  }
  return kept;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace troupe::partition
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace troupe::partition {

HWY_EXPORT(project_fan);
HWY_EXPORT(project_scan);
HWY_EXPORT(turn_beams);
HWY_EXPORT(limits_of);
HWY_EXPORT(ranges_of_fan);
HWY_EXPORT(fan_may_meet);
HWY_EXPORT(scan_may_meet);

void project(const EdgeBlock& edges, const Vec2& reference, const Fan& fan, float* inverse, float* returns) {
  HWY_DYNAMIC_DISPATCH(project_fan)(edges, reference, fan, inverse, returns);
}

void project(const EdgeBlock& edges, const Vec2& reference, const Fan& fan, const Scan& scan, float* inverse,
             float* returns) {
  HWY_DYNAMIC_DISPATCH(project_scan)(edges, reference, fan, scan, inverse, returns);
}

void turn(const Rotation& rotation, const double* x, const double* y, std::size_t count, float* out_x,
          float* out_y) {
  HWY_DYNAMIC_DISPATCH(turn_beams)(rotation, x, y, count, out_x, out_y);
}

void ranges_of(const Fan& fan, const float* inverse, const float* range_max, float* ranges) {
  HWY_DYNAMIC_DISPATCH(ranges_of_fan)(fan, inverse, range_max, ranges);
}

float limits_of(const Fan& fan, const float* inverse, const float* range_max, float* limits) {
  return HWY_DYNAMIC_DISPATCH(limits_of)(fan, inverse, range_max, limits);
}

std::size_t may_meet(const CircleArrays& circles, std::size_t begin, std::size_t end, const Vec2& reference,
                     const Fan& fan, const float* limits, float low, float high, CircleArrays& met) {
  return HWY_DYNAMIC_DISPATCH(fan_may_meet)(circles, begin, end, reference, fan, limits, low, high, met);
}

std::size_t may_meet(const CircleArrays& circles, std::size_t begin, std::size_t end, const Vec2& reference,
                     const Fan& fan, const Scan& scan, const float* limits, float low, float high,
                     CircleArrays& met) {
  return HWY_DYNAMIC_DISPATCH(scan_may_meet)(circles, begin, end, reference, fan, scan, limits, low, high,
                                             met);
}

}  // namespace troupe::partition
#endif
