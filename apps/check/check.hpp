#pragma once

#include "apps/check/check_options.hpp"
#include "apps/exit_code.hpp"
#include "engine/kinds.hpp"

namespace troupe::apps {

/// `troupe check`: steps variants of a world in lock-step and compares their states. Prints the variants and
/// the first difference on standard output, everything else on standard error. `registry` is that of
/// make_registry(), or one with further kinds.
ExitCode check(const CheckOptions& options, const engine::Registry& registry);

}  // namespace troupe::apps
