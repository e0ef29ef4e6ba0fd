#pragma once

#include "apps/check/check_options.hpp"
#include "apps/exit_code.hpp"
#include "engine/kinds/registry.hpp"

namespace troupe::apps {

/// `troupe check`: loads a world in several variants, which differ for example in the number of threads.
/// Simulates all variants step by step, and compares their states after each step. Prints the variants and
/// the first difference on standard output, and warnings and errors on standard error.
///
/// Returns k_finished if all variants agree, and k_failed if one differs. After an InputError, prints it and
/// returns k_bad_input. If the same step ends with an error in every variant, throws engine::StepError.
///
/// registry: the kinds that the world may use. A kind is an implementation of a sensor, a drive, a controller
/// and so on.
ExitCode check(const CheckOptions& options, const engine::Registry& registry);

}  // namespace troupe::apps
