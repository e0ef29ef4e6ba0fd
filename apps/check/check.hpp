#pragma once

#include "apps/check/check_options.hpp"
#include "apps/exit_code.hpp"
#include "engine/kinds.hpp"

namespace troupe::apps {

/// `troupe check`: steps variants of a world in lock-step and compares their states. What was compared goes
/// to standard output, with the first difference; everything else to standard error. The registry is
/// make_registry()'s, or one with kinds of the caller's own.
ExitCode check(const CheckOptions& options, const engine::Registry& registry);

}  // namespace troupe::apps
