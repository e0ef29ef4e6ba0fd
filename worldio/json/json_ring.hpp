#pragma once

#include "worldio/json/json_reader.hpp"

#include <vector>

namespace troupe::worldio {

/// Whether an entry of a list has the key `ring` (RingDocument) and therefore stands for several entries.
inline bool has_ring(const JsonNode& entry) { return entry.find("ring") != nullptr; }

/// Returns the entries that an entry with a `ring` stands for. Copy i of n is at the angle start + 2 pi i / n
/// around the pose of the entry, at the distance of the radius, and heads away from the centre. The name of
/// the copy, and the names of its own sensors, devices and parts, get the number i at the end. Empty, with
/// errors, if the ring or the pose is wrong.
std::vector<JsonNode> expand_ring(const JsonCursor& at);

}  // namespace troupe::worldio
