#pragma once

#include "base/diagnostics.hpp"
#include "base/random.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string_view>

namespace troupe::engine {

/// Calls build(own), where `own` is a new Diagnostics object. Adds each finding in `own` to `diagnostics` as
/// an error, with the JSON pointer `/KEY/INDEX` of the part of the experiment in front of the message.
void build_part(std::string_view key, std::size_t index, Diagnostics& diagnostics,
                const std::function<void(Diagnostics&)>& build);

/// Returns the key by which a random selection orders a body (Candidate::key).
std::uint64_t selection_key(Random random);

}  // namespace troupe::engine
