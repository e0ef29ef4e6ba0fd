#pragma once

#include "engine/kinds/registry.hpp"

#include <string>

namespace troupe::apps {

/// Returns, as text, what a kind of controller needs of a robot, and for how many robots one call of the
/// controller decides. `params` describes the parameters of the controller: ControllerKind::params, or that
/// table with the defaults of a preset.
///
/// The devices are found by calls of ControllerKind::prepare for robots with one device of each of several
/// kinds of `registry`. A drive that only some parameters need is found by a call of
/// ControllerKind::bind_world for a robot without a drive. The devices have wide ranges of readings, so that
/// they are of use to most controllers. The text contains no devices that a controller finds by their names.
std::string needs_text(const engine::Registry& registry, const engine::ControllerKind& kind,
                       const engine::FieldTable& params);

}  // namespace troupe::apps
