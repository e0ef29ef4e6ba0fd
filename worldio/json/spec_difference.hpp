#pragma once

#include "engine/world_spec.hpp"

#include <string>

namespace troupe::worldio {

/// In what two worlds differ that may change a run, or what is called how: the first thing, in words, as in
/// `type "pioneer", part "ranger:0": its solids`. Empty: they are the same to the last bit. Where things
/// stand in files, files themselves (images too), and a title that is empty do not count.
std::string spec_difference(const engine::WorldSpec& a, const engine::WorldSpec& b);

/// Whether two parts of a type are the same in the same sense.
bool same_part(const engine::PartSpec& a, const engine::PartSpec& b);

}  // namespace troupe::worldio
