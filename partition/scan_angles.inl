// Finds the beams of a scan (a fan of beams with one origin and equal angular steps) by their angles.
// Included once per instruction set, like partition/simd.inl.
#if defined(TROUPE_PARTITION_SCAN_ANGLES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TROUPE_PARTITION_SCAN_ANGLES_INL
#undef TROUPE_PARTITION_SCAN_ANGLES_INL
#else
#define TROUPE_PARTITION_SCAN_ANGLES_INL
#endif

#include "partition/ranging.hpp"
#include "partition/simd.inl"

HWY_BEFORE_NAMESPACE();
namespace troupe::partition::HWY_NAMESPACE {
namespace {

using namespace simd;

constexpr Full<float> k_f;
using Floats = Vec<Full<float>>;

constexpr float k_quarter = 1.57079633f;  // a quarter of a turn, rad

/// The angle of the direction (x, y) in [-pi, pi], rad. It is accurate to 1e-4 rad, which is enough to
/// discard beams with a margin. For (0, 0) the result is arbitrary.
/// source  Abramowitz and Stegun, Handbook of mathematical functions, 4.4.47
HWY_INLINE Floats angle_of(const Floats& x, const Floats& y) {
  const Floats across = Min(Abs(x), Abs(y));
  const Floats along = Max(Max(Abs(x), Abs(y)), Set(k_f, 1e-30f));
  const Floats q = divide(across, along);
  const Floats q2 = Mul(q, q);
  Floats sum = Set(k_f, 0.0208351f);
  for (const float c : {-0.0851330f, 0.1801410f, -0.3302995f, 0.9998660f})
    sum = Add(Mul(sum, q2), Set(k_f, c));
  Floats angle = Mul(sum, q);
  angle = IfThenElse(Gt(Abs(y), Abs(x)), Sub(Set(k_f, k_quarter), angle), angle);
  angle = IfThenElse(Lt(x, Zero(k_f)), Sub(Set(k_f, 2 * k_quarter), angle), angle);
  return CopySign(angle, y);
}

/// Computes angles relative to the middle of a scan, rad, and the beams between two such angles. A margin of
/// 1e-3 rad, above the error of angle_of(), ensures that no beam is missed.
class ScanAngles {
 public:
  ScanAngles(const Scan& scan, std::size_t count)
      : mx_(static_cast<float>(scan.middle.x())),
        my_(static_cast<float>(scan.middle.y())),
        half_fov_(0.5f * scan.fov),
        per_step_(1 / scan.step),
        last_(static_cast<float>(count - 1)) {}

  HWY_INLINE Floats of(const Floats& x, const Floats& y) const {
    const Floats mx = Set(k_f, mx_);
    const Floats my = Set(k_f, my_);
    return angle_of(Add(Mul(x, mx), Mul(y, my)), Sub(Mul(y, mx), Mul(x, my)));
  }
  /// Computes per lane the numbers of the first and the last beam between the angles `from` and `to`, as
  /// floats; first > last if there is no beam between them. Beams are numbered from 0. In lanes where `all`
  /// holds, the result is all beams. The same is true where an angle is close to +-pi, because angles jump
  /// there.
  template <class Mask>
  HWY_INLINE void beams(const Floats& from, const Floats& to, const Mask& all, Floats& first,
                        Floats& last) const {
    const Floats margin = Set(k_f, 1e-3f);
    const Floats half_fov = Set(k_f, half_fov_);
    const Floats per_step = Set(k_f, per_step_);
    const Floats last_beam = Set(k_f, last_);
    first = Max(Ceil(Mul(Add(Sub(from, margin), half_fov), per_step)), Zero(k_f));
    last = Min(Floor(Mul(Add(Add(to, margin), half_fov), per_step)), last_beam);
    const Floats back = Set(k_f, 2 * k_quarter - 2e-3f);
    const auto whole = Or(all, Or(Lt(from, Neg(back)), Gt(to, back)));
    first = IfThenZeroElse(whole, first);
    last = IfThenElse(whole, last_beam, last);
  }

 private:
  float mx_, my_, half_fov_, per_step_, last_;  // scalars, because an SVE vector cannot be a member
};

}  // namespace
}  // namespace troupe::partition::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
