// The vector operations of the library Highway for the kernels of this folder. hwy/foreach_target.h includes
// this file once per target (instruction set), so it has a guard that Highway toggles instead of a #pragma
// once.
#if defined(TROUPE_PARTITION_SIMD_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TROUPE_PARTITION_SIMD_INL
#undef TROUPE_PARTITION_SIMD_INL
#else
#define TROUPE_PARTITION_SIMD_INL
#endif

#include "partition/compress_tables.hpp"

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace troupe::partition::HWY_NAMESPACE {

/// The operations that kernels may use: those that give the same bits on every target. MulAdd and its
/// relatives are excluded because they round once on targets that have them and twice on others. Highway's
/// Approximate operations are excluded because their results differ between targets. A test checks that
/// kernels use only this list.
namespace simd {
namespace hn = hwy::HWY_NAMESPACE;

// A whole vector, but at most 512 bits, because arrays are padded for that; SVE vectors may have 2048 bits.
template <class T>
using Full = hn::CappedTag<T, 64 / sizeof(T)>;
template <class T, std::size_t N>
using Capped = hn::CappedTag<T, N>;  // at most N lanes
using hn::Mask;
using hn::Rebind;
using hn::Vec;

using hn::GetLane;
using hn::Iota;
using hn::Lanes;
using hn::Load;
using hn::LoadInterleaved2;
using hn::LoadInterleaved4;
using hn::LoadU;
using hn::Set;
using hn::Store;
using hn::StoreU;
using hn::Zero;

using hn::Abs;
using hn::Add;
using hn::Ceil;
using hn::ConvertTo;
using hn::CopySign;
using hn::DemoteTo;
using hn::Floor;
using hn::Max;
using hn::Min;
using hn::Mul;
using hn::Neg;
using hn::Sqrt;
using hn::Sub;

using hn::AllFalse;
using hn::And;
using hn::AndNot;
using hn::BitCast;
using hn::Eq;
using hn::Ge;
using hn::Gt;
using hn::IfThenElse;
using hn::IfThenElseZero;
using hn::IfThenZeroElse;
using hn::Le;
using hn::Lt;
using hn::Ne;
using hn::Or;
using hn::RebindMask;
using hn::ShiftLeft;
using hn::ShiftLeftSame;
using hn::VecFromMask;
using hn::Xor;

using hn::MaxOfLanes;
using hn::MinOfLanes;

/// a / b of IEEE 754. Highway's Div is not that on its portable target EMU128: from Highway 1.2 on, it gives
/// 0 where b is 0.
template <class V>
HWY_INLINE V divide(const V& a, const V& b) {
#if HWY_TARGET == HWY_EMU128
  using T = hn::TFromV<V>;
  constexpr hn::DFromV<V> k_tag;
  alignas(16) T quotients[16 / sizeof(T)];
  alignas(16) T divisors[16 / sizeof(T)];
  Store(a, k_tag, quotients);
  Store(b, k_tag, divisors);
  for (std::size_t i = 0; i < Lanes(k_tag); ++i) quotients[i] /= divisors[i];
  return Load(k_tag, quotients);
#else
  return hn::Div(a, b);
#endif
}

// On targets without a compress instruction, Highway 1.0.3 keeps the permutations of its Compress in an array
// inside the function. gcc 12 copies this array, up to a kilobyte, to the stack at every call, which took
// three quarters of the time of the kernel may_meet(). Highway's CountTrue is a function call on the targets
// without popcnt: SSSE3 and, from Highway 1.1 on, SSE2.

/// The bits of a mask of at most eight lanes.
template <class Tag>
HWY_INLINE std::uint8_t bits_of(Tag tag, const Mask<Tag>& mask) {
  std::uint8_t bits = 0;
  hn::StoreMaskBits(tag, mask, &bits);
  return bits;
}

#if HWY_TARGET == HWY_SSSE3 || HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_NEON

/// Moves the lanes where the mask holds to the front, in their order. The lanes after them are arbitrary.
/// Works only for whole vectors of 32-bit lanes.
template <class V>
HWY_INLINE V compress(const V& v, const Mask<hn::DFromV<V>>& mask) {
  constexpr hn::DFromV<V> k_tag;
  const std::size_t bits = bits_of(k_tag, mask);
#if HWY_TARGET == HWY_AVX2
  constexpr Rebind<std::uint8_t, hn::DFromV<V>> k_lanes;
  constexpr Rebind<std::uint32_t, hn::DFromV<V>> k_indices;
  const auto from = hn::PromoteTo(k_indices, Load(k_lanes, &k_compress_lanes[8 * bits]));
  return hn::TableLookupLanes(v, hn::IndicesFromVec(k_tag, from));
#else
  constexpr hn::Repartition<std::uint8_t, hn::DFromV<V>> k_bytes;
  const auto from = Load(k_bytes, &k_compress_bytes[16 * bits]);
  return BitCast(k_tag, hn::TableLookupBytes(BitCast(k_bytes, v), from));
#endif
}

#else

template <class V>
HWY_INLINE V compress(const V& v, const Mask<hn::DFromV<V>>& mask) {
  return hn::Compress(v, mask);
}

#endif

/// The number of lanes where the mask holds.
template <class Tag>
HWY_INLINE std::size_t count_true(Tag tag, const Mask<Tag>& mask) {
#if HWY_TARGET == HWY_SSSE3 || (defined(HWY_SSE2) && HWY_TARGET == HWY_SSE2)
  constexpr std::uint64_t k_counts = 0x4332'3221'3221'2110;  // one digit per mask of four lanes
  return k_counts >> (4 * bits_of(tag, mask)) & 0xF;
#else
  return hn::CountTrue(tag, mask);
#endif
}

/// Loads points, whose x and y alternate in memory, into a vector of all x and one of all y.
template <class Tag>
HWY_INLINE void load_points(Tag tag, const double* xy, Vec<Tag>& x, Vec<Tag>& y) {
#if HWY_TARGET == HWY_AVX2
  // Highway loads whole vectors, whose halves must then be exchanged. Loading halves needs no exchange.
  const hn::Half<Tag> half;
  const auto apart = [&](const double* from) { return hn::Combine(tag, LoadU(half, from + 4), LoadU(half, from)); };
  const auto even = apart(xy);
  const auto odd = apart(xy + 2);
  x = hn::InterleaveLower(tag, even, odd);
  y = hn::InterleaveUpper(tag, even, odd);
#else
  LoadInterleaved2(tag, xy, x, y);
#endif
}

}  // namespace simd
}  // namespace troupe::partition::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
