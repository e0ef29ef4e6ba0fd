#pragma once

#include "apps/check/check_options.hpp"
#include "apps/exit_code.hpp"
#include "engine/kinds.hpp"

namespace troupe::apps {

/// `troupe check`: loads a world in several variants (numbers of threads, tile sizes, ...), steps them tick
/// by tick and compares their states after each tick. Prints the variants and the first difference on
/// standard output, and everything else on standard error. registry: the kinds that worlds may use, that is,
/// the result of make_registry(), to which a program may have added kinds.
ExitCode check(const CheckOptions& options, const engine::Registry& registry);

}  // namespace troupe::apps
