// The vector kernels of the exact ray engine. They are compiled once for each instruction set that Highway
// supports, and one version is chosen when the program starts. For a scan, a vector contains a few beams, and
// the kernels project one edge on these beams at a time. For any other fan, a vector contains a few edges,
// and the kernels project these edges on one beam at a time. On every instruction set the results have the
// bits of inverse_range().

#include "partition/ranging.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "partition/ranging_kernels.cpp"
#include <hwy/foreach_target.h>

#include "partition/scan_angles.inl"

HWY_BEFORE_NAMESPACE();
namespace troupe::partition {
namespace HWY_NAMESPACE {
namespace {

constexpr Full<double> k_d;
constexpr Rebind<std::int32_t, Full<float>> k_i;
constexpr Rebind<float, Full<double>> k_half;  // as many floats as doubles in a vector
using Few = Capped<float, 8>;
constexpr Few k_few;

/// The edges of an EdgeBlock relative to the reference point (see Fan), in one array per component. The
/// components are those of RayEdge, as relative_edge() computes them, except that relate() computes `area`
/// differently. Edge j runs from vertex j to vertex j + 1. `magnitude` is the sum of the magnitudes of the
/// coordinates of both ends, m. `grazing` is the limit of |d x e| below which the angle is grazing
/// (k_grazing).
struct Relative {
  static constexpr std::size_t k_size = EdgeBlock::k_capacity + 3 * EdgeBlock::k_piece;
  alignas(64) float x[k_size], y[k_size];    // per vertex
  alignas(64) float ex[k_size], ey[k_size];  // per edge, like all below
  alignas(64) float area[k_size], magnitude[k_size];
  alignas(64) float grazing[k_size];  // NaN for edges that look tiny: no comparison with it is true
};

/// Computes the edges relative to the reference. Entries between chains are meaningless. If kCommon, all
/// beams start at the reference. Then `area` holds the inverse of the area, and edges that look tiny from the
/// reference get a NaN in `grazing`: they miss every beam in the kernels and are left to project_carefully().
///
/// relative_edge() sets an area to exactly 0 if it is only rounding noise, at most 2^-50 of its two terms.
/// This function does not: such an area is tiny for every beam, whether it is 0 or noise, and
/// project_carefully() computes it again. (Proof: let the origin of a beam be at o from the reference, and t
/// = o x e, so that the area seen from the origin is A - t. If |t| is so small that noise could change A - t,
/// this area is below the limit of k_tiny with and without the noise. If |t| is larger, the noise is less
/// than half a float step of A - t.)
template <bool kCommon>
HWY_INLINE void relate(const EdgeBlock& edges, const Vec2& reference, Relative& out) {
  const auto rx = Set(k_d, reference.x());
  const auto ry = Set(k_d, reference.y());
  // Kernels read all k_piece lanes of the last piece, also those without an edge, and their vertices.
  const std::size_t end = edges.pieces().back().first + EdgeBlock::k_piece + 1;
  for (std::size_t i = 0; i < end; i += Lanes(k_d)) {
    Vec<Full<double>> from_x, from_y, to_x, to_y;
    load_points(k_d, edges.xy() + 2 * i, from_x, from_y);
    load_points(k_d, edges.xy() + 2 * (i + 1), to_x, to_y);
    const auto ax = Sub(from_x, rx);
    const auto ay = Sub(from_y, ry);
    const auto bx = Sub(to_x, rx);
    const auto by = Sub(to_y, ry);
    Store(DemoteTo(k_half, ax), k_half, out.x + i);
    Store(DemoteTo(k_half, ay), k_half, out.y + i);
    Store(DemoteTo(k_half, Sub(to_x, from_x)), k_half, out.ex + i);
    Store(DemoteTo(k_half, Sub(to_y, from_y)), k_half, out.ey + i);
    Store(DemoteTo(k_half, Sub(Mul(ax, by), Mul(ay, bx))), k_half, out.area + i);
  }
  for (std::size_t i = 0; i < end; i += Lanes(k_f)) {
    const Floats size = Add(Abs(Load(k_f, out.ex + i)), Abs(Load(k_f, out.ey + i)));
    const Floats grazing = Mul(Set(k_f, k_grazing), size);
    const Floats m =
        Add(Add(Add(Abs(Load(k_f, out.x + i)), Abs(Load(k_f, out.y + i))), Abs(LoadU(k_f, out.x + i + 1))),
            Abs(LoadU(k_f, out.y + i + 1)));
    if constexpr (!kCommon) {
      Store(m, k_f, out.magnitude + i);
      Store(grazing, k_f, out.grazing + i);
      continue;
    }
    const Floats area = Load(k_f, out.area + i);
    const auto tiny = Le(Abs(area), Mul(Set(k_f, k_tiny), Mul(m, m)));
    Store(IfThenElse(tiny, Set(k_f, std::numeric_limits<float>::quiet_NaN()), grazing), k_f, out.grazing + i);
    Store(divide(Set(k_f, 1.0f), area), k_f, out.area + i);
  }
}

/// A vector of edges, one per lane, with the components of Relative; a and b are the ends of an edge.
/// BeamVector is a vector of beams, one per lane, with the direction of each beam and its origin relative to
/// the reference. The members of both are references, because an SVE vector cannot be a member. Temporaries
/// that initialise them in braces live as long as the struct.
template <class V>
struct EdgeVector {
  const V &ax, &ay, &bx, &by, &ex, &ey, &area, &magnitude, &grazing;
};
template <class V>
struct BeamVector {
  const V &dx, &dy, &ox, &oy, &offset;  // offset: |ox| + |oy|
};

/// Computes inverse_range() per lane, for beams that start at the reference, with two differences. The result
/// is negative if the edge is behind the origin. It is 0 if the edge needs project_carefully(), and the lane
/// is then added to `unsure`.
template <class Tag>
HWY_INLINE Vec<Tag> inverse_common(Tag tag, const EdgeVector<Vec<Tag>>& e, const BeamVector<Vec<Tag>>& beam,
                                   Mask<Tag>& unsure) {
  const auto zero = Zero(tag);
  const auto ca = Sub(Mul(e.ax, beam.dy), Mul(e.ay, beam.dx));
  const auto cb = Sub(Mul(e.bx, beam.dy), Mul(e.by, beam.dx));
  const auto across = Sub(Mul(beam.dx, e.ey), Mul(beam.dy, e.ex));
  const auto crosses = And(Le(Min(ca, cb), zero), Ge(Max(ca, cb), zero));
  const auto met = And(crosses, Ge(Abs(across), e.grazing));
  unsure = Or(unsure, Xor(crosses, met));
  return IfThenElseZero(met, Mul(across, e.area));
}

/// The same as inverse_common(), for beams with different origins.
template <class Tag>
HWY_INLINE Vec<Tag> inverse_apart(Tag tag, const EdgeVector<Vec<Tag>>& e, const BeamVector<Vec<Tag>>& beam,
                                  Mask<Tag>& unsure) {
  const auto zero = Zero(tag);
  const auto ca = Sub(Mul(Sub(e.ax, beam.ox), beam.dy), Mul(Sub(e.ay, beam.oy), beam.dx));
  const auto cb = Sub(Mul(Sub(e.bx, beam.ox), beam.dy), Mul(Sub(e.by, beam.oy), beam.dx));
  const auto across = Sub(Mul(beam.dx, e.ey), Mul(beam.dy, e.ex));
  const auto area = Sub(e.area, Sub(Mul(beam.ox, e.ey), Mul(beam.oy, e.ex)));
  const auto m = Add(e.magnitude, beam.offset);
  const auto tiny = Le(Abs(area), Mul(Set(tag, k_tiny), Mul(m, m)));
  const auto crosses = And(Le(Min(ca, cb), zero), Ge(Max(ca, cb), zero));
  const auto met = AndNot(tiny, And(crosses, Ge(Abs(across), e.grazing)));
  unsure = Or(unsure, Or(tiny, Xor(crosses, met)));
  return IfThenElseZero(met, Mul(across, divide(Set(tag, 1.0f), area)));
}

/// Whether the beams of a fan start at the reference or at different points.
enum class Origin { common, apart };

/// The inverse ranges at which beam i of a fan hits each edge of a vector, as inverse_common() or
/// inverse_apart() computes them. offsets: |ox| + |oy| of each beam, metres, used only for Origin::apart.
template <Origin kOrigin>
HWY_INLINE Vec<Few> on_beam(const EdgeVector<Vec<Few>>& edges, const Fan& fan, const float* offsets,
                            std::size_t i, Mask<Few>& unsure) {
  const auto dx = Set(k_few, fan.dx[i]);
  const auto dy = Set(k_few, fan.dy[i]);
  if constexpr (kOrigin == Origin::common)
    return inverse_common(k_few, edges, {dx, dy, Zero(k_few), Zero(k_few), Zero(k_few)}, unsure);
  return inverse_apart(
      k_few, edges, {dx, dy, Set(k_few, fan.ox[i]), Set(k_few, fan.oy[i]), Set(k_few, offsets[i])}, unsure);
}

/// Raises the inverse range of one beam to `value` if that is larger, and updates the ranger_return that the
/// beam reads.
HWY_INLINE void raise_beam(float value, float ranger_return, float& inverse, float* returns) {
  if (returns != nullptr) {
    if (value > inverse)
      *returns = ranger_return;
    else if (value == inverse && value > 0)
      *returns = std::max(*returns, ranger_return);
  }
  inverse = std::max(inverse, value);
}

/// Projects one edge on beams first to past - 1 with inverse_range(), which also handles grazing angles and
/// edges that look tiny.
HWY_NOINLINE void project_carefully(const RayEdge& edge, const Fan& fan, std::size_t first, std::size_t past,
                                    float* inverse, float* returns) {
  for (std::size_t i = first; i < past; ++i)
    raise_beam(inverse_range(edge, fan.dx[i], fan.dy[i], fan.ox[i], fan.oy[i]), edge.ranger_return,
               inverse[i], returns == nullptr ? nullptr : returns + i);
}

/// Marks the lanes that have no edge. For a piece of n edges, a vector is read from k_edges_then_none, from
/// the index k_piece - n on: its first n lanes are 0, and the lanes after them are NaN.
constexpr float k_no_edge = std::numeric_limits<float>::quiet_NaN();
alignas(64) constexpr float k_edges_then_none[2 * EdgeBlock::k_piece] = {
    0,         0,         0,         0,         0,         0,         0,         0,
    k_no_edge, k_no_edge, k_no_edge, k_no_edge, k_no_edge, k_no_edge, k_no_edge, k_no_edge};

/// The largest inverse range of each beam of a fan so far, separately for each lane, that is, for each place
/// of an edge in its piece. The lanes of a beam are compared only once, at the end, instead of after each
/// piece.
template <bool kReturns>
struct Nearest {
  static constexpr std::size_t k_lanes = EdgeBlock::k_piece;
  alignas(64) float inverse[k_most_beams * k_lanes];
  alignas(64) float returns[kReturns ? k_most_beams * k_lanes : 1];

  /// The number of lanes of all beams, rounded up to the whole vectors that fold_into() processes.
  static HWY_INLINE std::size_t lanes_of(const Fan& fan) {
    const std::size_t whole = 4 * Lanes(k_f);
    return (fan.count * k_lanes + whole - 1) / whole * whole;
  }
  HWY_INLINE explicit Nearest(const Fan& fan) {
    const auto clear = [](float* lanes, std::size_t count) {
      for (std::size_t i = 0; i < count; i += Lanes(k_f)) Store(Zero(k_f), k_f, lanes + i);
    };
    clear(inverse, lanes_of(fan));
    if constexpr (kReturns) clear(returns, lanes_of(fan));
  }
  HWY_INLINE void update(std::size_t at, const Vec<Few>& candidate, float ranger_return) {
    const auto before = Load(k_few, inverse + at);
    if constexpr (kReturns) {
      const auto value = Set(k_few, ranger_return);
      const auto old = Load(k_few, returns + at);
      const auto level = And(Eq(candidate, before), Gt(candidate, Zero(k_few)));
      Store(IfThenElse(Gt(candidate, before), value, IfThenElse(level, Max(old, value), old)), k_few,
            returns + at);
    }
    Store(Max(before, candidate), k_few, inverse + at);
  }
  HWY_INLINE void fold_into(const Fan& fan, float* to_inverse, float* to_returns) const {
    if constexpr (kReturns) {
      for (std::size_t i = 0; i < fan.count * k_lanes; ++i)
        raise_beam(inverse[i], returns[i], to_inverse[i / k_lanes], to_returns + i / k_lanes);
      return;
    }
    static_assert(k_lanes == 8, "lanes are folded by four, then by two");
    alignas(64) float two[2 * k_most_beams];
    for (std::size_t i = 0; i < lanes_of(fan) / 4; i += Lanes(k_f)) {
      Floats a, b, c, d;
      LoadInterleaved4(k_f, inverse + 4 * i, a, b, c, d);
      Store(Max(Max(a, b), Max(c, d)), k_f, two + i);
    }
    for (std::size_t i = 0; i < fan.padded(); i += Lanes(k_f)) {
      Floats a, b;
      LoadInterleaved2(k_f, two + 2 * i, a, b);
      StoreU(Max(LoadU(k_f, to_inverse + i), Max(a, b)), k_f, to_inverse + i);
    }
  }
};

template <Origin kOrigin, bool kReturns>
void project_on_fan(const EdgeBlock& edges, const Vec2& reference, const Fan& fan, float* inverse,
                    float* returns) {
  Relative relative;
  relate<kOrigin == Origin::common>(edges, reference, relative);
  Nearest<kReturns> nearest(fan);
  alignas(64) float offsets[k_most_beams];
  if constexpr (kOrigin == Origin::apart)
    for (std::size_t i = 0; i < fan.count; i += Lanes(k_f))
      Store(Add(Abs(LoadU(k_f, fan.ox + i)), Abs(LoadU(k_f, fan.oy + i))), k_f, offsets + i);
  for (const EdgeBlock::Piece& piece : edges.pieces()) {
    for (std::size_t lane = 0; lane < EdgeBlock::k_piece; lane += Lanes(k_few)) {
      if (lane > 0 && lane >= piece.edges) break;
      const std::size_t j = piece.first + lane;
      const Relative& e = relative;
      const auto none = LoadU(k_few, k_edges_then_none + (EdgeBlock::k_piece - piece.edges) + lane);
      const auto is_edge = Eq(none, Zero(k_few));
      const EdgeVector<Vec<Few>> few{
          LoadU(k_few, e.x + j),     LoadU(k_few, e.y + j),         LoadU(k_few, e.x + j + 1),
          LoadU(k_few, e.y + j + 1), LoadU(k_few, e.ex + j),        LoadU(k_few, e.ey + j),
          LoadU(k_few, e.area + j),  LoadU(k_few, e.magnitude + j), Add(LoadU(k_few, e.grazing + j), none)};
      auto unsure = AndNot(Ge(few.grazing, Zero(k_few)), is_edge);  // NaN: looks tiny (common origin only)
      for (BeamSet rest = piece.met_by; rest != 0; rest &= rest - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(rest));
        nearest.update(i * EdgeBlock::k_piece + lane, on_beam<kOrigin>(few, fan, offsets, i, unsure),
                       piece.ranger_return);
      }
      unsure = And(unsure, is_edge);
      if (HWY_LIKELY(AllFalse(k_few, unsure))) continue;
      alignas(64) float marks[EdgeBlock::k_piece];
      Store(IfThenElseZero(unsure, Set(k_few, 1.0f)), k_few, marks);
      for (std::size_t k = 0; k < Lanes(k_few); ++k)
        if (marks[k] != 0)
          project_carefully(edges.relative(j + k, reference, piece.ranger_return), fan, 0, fan.count, inverse,
                            kReturns ? returns : nullptr);
    }
  }
  nearest.fold_into(fan, inverse, returns);
  std::fill(inverse + fan.count, inverse + fan.padded(), inverse[fan.count - 1]);
}

/// Raises the inverse ranges of a vector of beams to those of `candidate` where these are larger, and updates
/// the ranger_return that each beam reads.
template <bool kReturns>
HWY_INLINE void raise_beams(const Vec<Few>& candidate, float ranger_return, float* inverse, float* returns) {
  const auto before = LoadU(k_few, inverse);
  if constexpr (kReturns) {
    const auto value = Set(k_few, ranger_return);
    const auto old = LoadU(k_few, returns);
    const auto level = And(Eq(candidate, before), Gt(candidate, Zero(k_few)));
    StoreU(IfThenElse(Gt(candidate, before), value, IfThenElse(level, Max(old, value), old)), k_few, returns);
  }
  StoreU(Max(before, candidate), k_few, inverse);
}

/// A step is a unit of work for scans: one edge is projected on one vector of neighbouring beams. The number
/// of the edge and that of the first beam are packed into one integer.
constexpr int k_edge_bits = 8;
static_assert(Relative::k_size <= 1 << k_edge_bits);
HWY_INLINE std::size_t edge_of(std::int32_t step) {
  return static_cast<std::size_t>(step) & ((1u << k_edge_bits) - 1);
}
HWY_INLINE std::size_t beam_of(std::int32_t step) { return static_cast<std::size_t>(step) >> k_edge_bits; }

/// Writes the steps for the lanes where the mask holds to `steps`, and returns their number.
HWY_INLINE std::size_t append(const Vec<decltype(k_i)>& beams, const Vec<decltype(k_i)>& edges,
                              const Mask<decltype(k_i)>& where, std::int32_t* steps) {
  StoreU(compress(Or(ShiftLeft<k_edge_bits>(beams), edges), where), k_i, steps);
  return count_true(k_i, where);
}

/// The beams of a scan that the edges span, as steps. An edge spans the beams whose directions are between
/// the directions to its two ends. Most edges span one or two vectors of beams. A vector starts at a beam
/// whose number is a multiple of the vector's length, so that neighbouring edges update the same vectors.
struct Spans {
  alignas(64) std::int32_t ends[2 * Relative::k_size];  // the first vector, and the last if it is another one
  std::size_t ends_count = 0;
  // For edges that span more than two vectors of beams: the second vector, and the last one, at which the
  // vectors in between end.
  alignas(64) std::int32_t between[Relative::k_size];
  alignas(64) std::int32_t past[Relative::k_size];
  std::size_t between_count = 0;
};

/// Collects in `out` the beams that edges span. Omits edges that look tiny. The loop has no branch that
/// depends on the data, because such a branch would be unpredictable. count: number of vertices.
HWY_INLINE void note_spans(std::size_t count, const Relative& relative, const Fan& fan, Spans& out) {
  const ScanAngles angles(*fan.scan, fan.count);
  alignas(64) float angle[Relative::k_size];
  for (std::size_t i = 0; i < count; i += Lanes(k_f))
    Store(angles.of(Load(k_f, relative.x + i), Load(k_f, relative.y + i)), k_f, angle + i);

  const auto few = static_cast<std::int32_t>(Lanes(k_few));
  std::size_t ends = 0;
  std::size_t between = 0;
  const auto end_of_edges = Set(k_i, static_cast<std::int32_t>(count - 1));
  auto edge = Iota(k_i, 0);  // incremented, because on some targets another Iota would go through memory
  for (std::size_t i = 0; i < count; i += Lanes(k_f)) {
    const Floats a = Load(k_f, angle + i);
    const Floats b = LoadU(k_f, angle + i + 1);
    const Floats from = Min(a, b);
    const Floats to = Max(a, b);
    // If the angles of the two ends differ by nearly half a turn or more, the edge passes close to the
    // origin, or behind it, where angles jump from pi to -pi. All beams are then tested.
    const auto all = Gt(Sub(to, from), Set(k_f, 3.0f));
    Floats first, last;
    angles.beams(from, to, all, first, last);
    const auto some = And(Le(first, last), Ge(Load(k_f, relative.grazing + i), Zero(k_f)));
    const auto spans = And(RebindMask(k_i, some), Lt(edge, end_of_edges));
    const auto begin = And(ConvertTo(k_i, first), Set(k_i, -few));
    const auto second = Add(begin, Set(k_i, few));
    const auto end = And(ConvertTo(k_i, last), Set(k_i, -few));
    const auto wide = And(spans, Gt(end, second));
    ends += append(begin, edge, spans, out.ends + ends);
    ends += append(end, edge, And(spans, Gt(end, begin)), out.ends + ends);
    append(second, edge, wide, out.between + between);
    between += append(end, edge, wide, out.past + between);
    edge = Add(edge, Set(k_i, static_cast<std::int32_t>(Lanes(k_i))));
  }
  out.ends_count = ends;
  out.between_count = between;
}

/// Marks the gaps between chains, where there is no edge, by a negative `grazing`. If kReturns, writes the
/// ranger_return of each edge to returns_of. Returns the number of vertices.
template <bool kReturns>
HWY_INLINE std::size_t part_chains(const EdgeBlock& edges, Relative& relative, float* returns_of) {
  const std::size_t count = edges.vertices();
  std::size_t end = 0;  // of the previous piece
  for (const EdgeBlock::Piece& piece : edges.pieces()) {
    if (piece.first != end) relative.grazing[end] = -1;
    end = piece.first + piece.edges;
    if constexpr (kReturns) std::fill_n(returns_of + piece.first, piece.edges, piece.ranger_return);
  }
  return count;
}

template <bool kReturns>
void project_on_scan(const EdgeBlock& edges, const Vec2& reference, const Fan& fan, float* inverse,
                     float* returns) {
  Relative relative;
  relate<true>(edges, reference, relative);
  float returns_of[kReturns ? Relative::k_size : 1];
  const std::size_t count = part_chains<kReturns>(edges, relative, returns_of);
  const auto take = [&](std::int32_t step) {
    const std::size_t j = edge_of(step);
    const std::size_t at = beam_of(step);
    const EdgeVector<Vec<Few>> edge{Set(k_few, relative.x[j]),      Set(k_few, relative.y[j]),
                                    Set(k_few, relative.x[j + 1]),  Set(k_few, relative.y[j + 1]),
                                    Set(k_few, relative.ex[j]),     Set(k_few, relative.ey[j]),
                                    Set(k_few, relative.area[j]),   Zero(k_few),
                                    Set(k_few, relative.grazing[j])};
    const BeamVector<Vec<Few>> beams{LoadU(k_few, fan.dx + at), LoadU(k_few, fan.dy + at), Zero(k_few),
                                     Zero(k_few), Zero(k_few)};
    auto unsure = Ne(Zero(k_few), Zero(k_few));
    const auto candidate = inverse_common(k_few, edge, beams, unsure);
    raise_beams<kReturns>(candidate, kReturns ? returns_of[j] : 0, inverse + at,
                          kReturns ? returns + at : nullptr);
    if (HWY_UNLIKELY(!AllFalse(k_few, unsure)))
      project_carefully(edges.relative(j, reference, kReturns ? returns_of[j] : 0), fan, at,
                        at + Lanes(k_few), inverse, kReturns ? returns : nullptr);
  };
  Spans spans;
  note_spans(count, relative, fan, spans);
  for (std::size_t k = 0; k < spans.ends_count; ++k) take(spans.ends[k]);
  const auto next = static_cast<std::int32_t>(Lanes(k_few) << k_edge_bits);
  for (std::size_t k = 0; k < spans.between_count; ++k)
    for (std::int32_t step = spans.between[k]; step < spans.past[k]; step += next) take(step);

  // Edges that look tiny may be hit by any beam, so they are projected on all beams.
  for (std::size_t j = 0; j < count; j += Lanes(k_f)) {
    const Floats grazing = Load(k_f, relative.grazing + j);
    const auto tiny =
        AndNot(Eq(grazing, grazing), Eq(Zero(k_f), Zero(k_f)));  // on some targets, Ne is false for NaN
    if (HWY_LIKELY(AllFalse(k_f, tiny))) continue;
    for (std::size_t k = j; k < std::min(j + Lanes(k_f), count - 1); ++k)
      if (std::isnan(relative.grazing[k]))
        project_carefully(edges.relative(k, reference, kReturns ? returns_of[k] : 0), fan, 0, fan.count,
                          inverse, kReturns ? returns : nullptr);
  }
}

void project_on(const EdgeBlock& edges, const Vec2& reference, const Fan& fan, float* inverse,
                float* returns) {
  const auto choose = [&](auto&& without, auto&& with) {
    (returns == nullptr ? without : with)(edges, reference, fan, inverse, returns);
  };
  if (fan.scan != nullptr)
    choose(project_on_scan<false>, project_on_scan<true>);
  else if (fan.common_origin)
    choose(project_on_fan<Origin::common, false>, project_on_fan<Origin::common, true>);
  else
    choose(project_on_fan<Origin::apart, false>, project_on_fan<Origin::apart, true>);
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
    return IfThenElse(Gt(value, divide(one, most)), Min(divide(one, value), most), most);
  };
  const std::size_t whole = fan.count / Lanes(k_f) * Lanes(k_f);
  for (std::size_t i = 0; i < whole; i += Lanes(k_f)) StoreU(range(i), k_f, ranges + i);
  if (whole == fan.count) return;
  alignas(64) float rest[k_beam_padding];
  Store(range(whole), k_f, rest);
  std::copy_n(rest, fan.count - whole, ranges + whole);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace troupe::partition
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace troupe::partition {

HWY_EXPORT(project_on);
HWY_EXPORT(turn_beams);
HWY_EXPORT(ranges_of_fan);

void project(const EdgeBlock& edges, const Vec2& reference, const Fan& fan, float* inverse, float* returns) {
  if (edges.empty()) return;
  HWY_DYNAMIC_DISPATCH(project_on)(edges, reference, fan, inverse, returns);
}

void turn(const Rotation& rotation, const double* x, const double* y, std::size_t count, float* out_x,
          float* out_y) {
  HWY_DYNAMIC_DISPATCH(turn_beams)(rotation, x, y, count, out_x, out_y);
}

void ranges_of(const Fan& fan, const float* inverse, const float* range_max, float* ranges) {
  HWY_DYNAMIC_DISPATCH(ranges_of_fan)(fan, inverse, range_max, ranges);
}

}  // namespace troupe::partition
#endif
