// The instruction sets of the kernels, by name.

#include "partition/simd_target.hpp"

#include "partition/kernel_check.hpp"
#include "partition/kernel_target.hpp"

#include <fmt/format.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cstdint>
#include <stdexcept>

namespace troupe::partition {
namespace {

/// The name of a target. Highway's own name for AVX-512 is AVX3. Its two portable targets get the same name
/// here, because a program contains only one of them.
std::string name_of(std::int64_t target) {
  if (target == HWY_SCALAR || target == HWY_EMU128) return "scalar";
  std::string name = hwy::TargetName(target);
  std::ranges::transform(name, name.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return name.starts_with("avx3") ? "avx512" + name.substr(4) : name;
}

/// Splits a set of targets, one bit each, into single targets. The list begins with the target of the lowest
/// bit, which is the best target.
std::vector<std::int64_t> each_of(std::int64_t targets) {
  std::vector<std::int64_t> list;
  for (; targets != 0; targets &= targets - 1) list.push_back(targets & -targets);
  return list;
}

/// The targets that are compiled in and that this processor supports, and the one on which the kernels run.
/// There is one object per process.
class Targets {
 public:
  static Targets& get() {
    static Targets targets;
    return targets;
  }

  std::int64_t usable() const { return usable_; }
  std::int64_t asked() const { return asked_; }  ///< the last argument of choose(); at first the best target

  /// Makes kernels run on the target, or, if it computes wrong results, on the best target that does not.
  void choose(std::int64_t target) {
    std::vector<std::int64_t> candidates = each_of(usable_ & ~target);
    candidates.insert(candidates.begin(), target);
    if (std::ranges::none_of(candidates, [&](std::int64_t candidate) { return runs_on(candidate); }))
      throw std::runtime_error(
          "every instruction set computes wrong ranges in this build of Troupe, because of an error of the "
          "compiler or of the library Highway: build Troupe with other versions of them");
    asked_ = target;
  }

 private:
  /// hwy::SupportedTargets() also chooses the target on which kernels run, and does so before it removes the
  /// targets that may not be used. Therefore it is called only once, and the choice is then corrected.
  Targets() : usable_(hwy::SupportedTargets() & HWY_TARGETS) { choose(each_of(usable_).front()); }

  /// Makes kernels run on the target. Returns whether it computes right results.
  bool runs_on(std::int64_t target) {
    hwy::GetChosenTarget().Update(target);
    if ((checked_ & target) == 0 && kernels_are_right()) right_ |= target;
    checked_ |= target;
    return (right_ & target) != 0;
  }

  std::int64_t usable_;
  std::int64_t asked_ = 0;
  std::int64_t checked_ = 0, right_ = 0;
};

std::string list_of(const std::vector<std::string>& names) {
  std::string text = names.front();
  for (std::size_t i = 1; i < names.size(); ++i)
    text += fmt::format("{}{}", i + 1 < names.size() ? ", " : " and ", names[i]);
  return text;
}

}  // namespace

const SimdTargets& simd_targets() {
  static const SimdTargets targets = [] {
    SimdTargets out;
    for (const std::int64_t target : each_of(HWY_TARGETS))
      ((Targets::get().usable() & target) != 0 ? out.usable : out.missing).push_back(name_of(target));
    return out;
  }();
  return targets;
}

std::string simd_target() {
  Targets::get();
  return name_of(kernel_target());
}

std::optional<std::string> simd_warning() {
  const std::int64_t asked = Targets::get().asked();
  if (kernel_target() == asked) return std::nullopt;
  return fmt::format(
      "the instruction set {} computes wrong ranges in this build of Troupe, because of an error of the "
      "compiler "
      "or of the library Highway; {}, which computes the right ranges, is used instead",
      name_of(asked), simd_target());
}

void use_simd_target(std::string_view name) {
  for (const std::int64_t target : each_of(Targets::get().usable())) {
    if (name_of(target) != name) continue;
    Targets::get().choose(target);
    return;
  }
  const SimdTargets& targets = simd_targets();
  const bool is_compiled = std::ranges::find(targets.missing, name) != targets.missing.end();
  throw std::invalid_argument(
      fmt::format("\"{}\" is not an instruction set {}; {} {}", name,
                  is_compiled ? "of this processor" : "that this program is compiled for",
                  is_compiled ? "this processor has" : "this processor can use", list_of(targets.usable)));
}

}  // namespace troupe::partition
