#pragma once

#include "apps/exit_code.hpp"
#include "engine/kinds.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace troupe::apps {

/// Every model, sensor, drive, controller, preset, measure and event, a line each.
std::string list_kinds(const engine::Registry& registry);

/// The names of all kinds, sorted, each once.
std::vector<std::string_view> kind_names(const engine::Registry& registry);

/// The fields of every kind of this name (a model and a sensor may share one): JSON key with its units,
/// default, range and meaning; also of a controller of a plug-in that the registry finds. Throws InputError
/// with near names when there is none.
std::string describe_kind(const engine::Registry& registry, std::string_view name);

}  // namespace troupe::apps
