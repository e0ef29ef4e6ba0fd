// Highway's vectors for the kernels of this folder, once a target (hwy/foreach_target.h includes it again and
// again): so there is a guard that Highway toggles instead of a #pragma once.
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

/// The operations that kernels may use: those that give the same bits on every target. Left out on purpose
/// are MulAdd and its kin, which round once where a target has them and twice where it has not, and the
/// Approximate ones. A test holds kernels to this list.
namespace simd {
namespace hn = hwy::HWY_NAMESPACE;

// A whole vector, of 512 bits at most: that is what arrays are padded for, and SVE's may have 2048.
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
using hn::Div;
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

// Highway 1.0.3 holds the permutations of its Compress in an array inside the function, where the target has no
// instruction for it, and gcc 12 copies that array to the stack at every call: up to a kilobyte, which took
// three quarters of the time of a cull. Highway's CountTrue is a call on the one target without popcnt.
#if HWY_TARGET == HWY_SSSE3 || HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_NEON

/// A bit for each lane of a mask of at most eight lanes.
template <class Tag>
HWY_INLINE std::uint8_t bits_of(Tag tag, const Mask<Tag>& mask) {
  std::uint8_t bits = 0;
  hn::StoreMaskBits(tag, mask, &bits);
  return bits;
}

/// The lanes where the mask holds, in their order, then others. Lanes of 32 bits, a whole vector of them.
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

/// In how many lanes the mask holds.
template <class Tag>
HWY_INLINE std::size_t count_true(Tag tag, const Mask<Tag>& mask) {
#if HWY_TARGET == HWY_SSSE3
  constexpr std::uint64_t k_counts = 0x4332'3221'3221'2110;  // a digit for each mask of four lanes
  return k_counts >> (4 * bits_of(tag, mask)) & 0xF;
#else
  return hn::CountTrue(tag, mask);
#endif
}

}  // namespace simd
}  // namespace troupe::partition::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
