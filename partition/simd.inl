// Highway's vectors for the kernels of this folder, once a target (hwy/foreach_target.h includes it again and
// again): so there is a guard that Highway toggles instead of a #pragma once.
#if defined(TROUPE_PARTITION_SIMD_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TROUPE_PARTITION_SIMD_INL
#undef TROUPE_PARTITION_SIMD_INL
#else
#define TROUPE_PARTITION_SIMD_INL
#endif

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
using hn::CountTrue;
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
using hn::Xor;

using hn::Compress;
using hn::MaxOfLanes;

}  // namespace simd
}  // namespace troupe::partition::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
