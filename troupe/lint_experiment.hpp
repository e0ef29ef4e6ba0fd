#pragma once

#include "base/diagnostics.hpp"
#include "engine/kinds/registry.hpp"
#include "engine/observing/lint_view.hpp"

#include <set>
#include <string>

namespace troupe {

/// Reports probable mistakes in the experiment of a world (its interventions, faults and stop conditions) and
/// in its measures, for lint() (troupe/lint.hpp). base_types: names of the types that other types extend
void lint_experiment(const engine::World& world, const engine::LintWorld& linted,
                     const engine::Registry& registry, const std::set<std::string>& base_types,
                     Diagnostics& diagnostics);

}  // namespace troupe
