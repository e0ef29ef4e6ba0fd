#pragma once

#include "worldio/json/json_reader.hpp"

#include <vector>

namespace troupe::worldio {

/// Whether an entry of a list has the key `ring` (RingDocument) and therefore stands for several entries.
inline bool has_ring(const JsonNode& entry) { return entry.find("ring") != nullptr; }

/// Returns the entries that an entry with a `ring` stands for: its copies, without `ring`. Copy i of n,
/// counted from 0, is on the circle with the ring's `radius` around the pose of the entry, in the direction
/// `start` + i/n of a turn from the heading of this pose, and heads away from the centre. The number i is
/// appended to the name of the copy and to the names of its own sensors, devices and parts. Empty, with
/// errors, if the ring or the pose is wrong.
std::vector<JsonNode> expand_ring(const JsonCursor& at);

}  // namespace troupe::worldio
