#pragma once

#include "apps/check/check_options.hpp"
#include "apps/exit_code.hpp"
#include "engine/kinds/kinds.hpp"

namespace troupe::apps {

/// `troupe check`: loads a world in several variants (numbers of threads, sizes of the tiles that threads
/// process, ...), simulates them step by step and compares their states after each step. Prints the variants
/// and the first difference on standard output, and warnings and errors on standard error. Returns k_finished
/// if all variants agree, k_failed if one differs, and k_bad_input after an InputError. Throws
/// engine::StepError if the step of every variant ends with an error. registry: the kinds (implementations of
/// sensors, drives, controllers and so on) that worlds may use: those of make_registry(), and those that the
/// program adds.
ExitCode check(const CheckOptions& options, const engine::Registry& registry);

}  // namespace troupe::apps
