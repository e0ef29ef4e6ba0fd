// The instruction sets of the kernels, by name.

#include "partition/simd_target.hpp"

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

/// The set of targets that are compiled in and that this processor supports. hwy::SupportedTargets() also
/// chooses the target on which kernels run, and does so before it removes the targets that may not be used.
/// Therefore it is called only once, and the choice is then corrected.
std::int64_t usable() {
  static const std::int64_t targets = [] {
    const std::int64_t found = hwy::SupportedTargets() & HWY_TARGETS;
    hwy::GetChosenTarget().Update(found);
    return found;
  }();
  return targets;
}

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
      ((usable() & target) != 0 ? out.usable : out.missing).push_back(name_of(target));
    return out;
  }();
  return targets;
}

std::string simd_target() { return name_of(kernel_target()); }

void use_simd_target(std::string_view name) {
  for (const std::int64_t target : each_of(usable())) {
    if (name_of(target) != name) continue;
    hwy::GetChosenTarget().Update(target);
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
