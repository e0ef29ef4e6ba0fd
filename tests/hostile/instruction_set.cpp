// A library to be preloaded (LD_PRELOAD) by scripts/prove: the kernels run on the one instruction set of
// Highway that TROUPE_INSTRUCTION_SET names (as `hwy::TargetName` does: SSSE3, SSE4, AVX2, AVX3, EMU128). At
// the end of the program the one that they were really dispatched to is written to the file
// TROUPE_INSTRUCTION_SET_FILE.
#include <hwy/highway.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

std::int64_t target_named(const char* name) {
  for (int bit = 0; bit < 63; ++bit)
    if (const std::int64_t target = std::int64_t{1} << bit; std::strcmp(hwy::TargetName(target), name) == 0)
      return target;
  return 0;
}

__attribute__((constructor)) void force() {
  const char* name = std::getenv("TROUPE_INSTRUCTION_SET");
  const std::int64_t target = name ? target_named(name) : 0;
  if (target == 0 || (target != HWY_EMU128 && (hwy::SupportedTargets() & target) == 0)) {
    std::fprintf(stderr, "instruction_set: this processor has no %s\n", name ? name : "(none named)");
    std::_Exit(77);
  }
  hwy::SetSupportedTargetsForTest(target);
  hwy::GetChosenTarget().DeInit();
}

__attribute__((destructor)) void tell() {
  const char* file = std::getenv("TROUPE_INSTRUCTION_SET_FILE");
  std::FILE* out = file ? std::fopen(file, "w") : nullptr;
  if (!out) return;
  // Bit 0 of the chosen ones says that nothing was dispatched yet.
  const std::int64_t all = hwy::SupportedTargets();
  const bool dispatched = hwy::GetChosenTarget().IsInitialized();
  std::fputs(dispatched ? hwy::TargetName(all & -all) : "none", out);
  std::fclose(out);
}

}  // namespace
