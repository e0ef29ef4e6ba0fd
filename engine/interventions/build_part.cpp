#include "engine/interventions/build_part.hpp"

#include <fmt/format.h>

namespace troupe::engine {

void build_part(std::string_view key, std::size_t index, Diagnostics& diagnostics,
                const std::function<void(Diagnostics&)>& build) {
  Diagnostics own(diagnostics.files());
  build(own);
  for (const Finding& finding : own.findings())
    diagnostics.error(finding.where, fmt::format("/{}/{}: {}", key, index, finding.message));
}

std::uint64_t selection_key(Random random) {
  const std::uint64_t high = random.bits();
  return high << 32 | random.bits();
}

}  // namespace troupe::engine
