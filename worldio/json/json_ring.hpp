#pragma once

#include "worldio/json/json_reader.hpp"

#include <cstddef>
#include <vector>

namespace troupe::worldio {

/// Whether an entry of a list has the key `ring`: the loader then replaces the entry by several copies, at
/// equal angles on a circle. RingDocument (worldio/json/world_document.hpp) has the parameters of the ring.
inline bool has_ring(const JsonNode& entry) { return entry.find("ring") != nullptr; }

/// Returns the copies of the list entry at `at`, which must have the key `ring`. The copies do not have the
/// key `ring`. Let n be the `count` of the ring. Copy i, counted from 0, is on the circle with the ring's
/// `radius` around the position of the entry. Seen from the centre of the circle, the copy is in the
/// direction `start` + i/n of a turn, counter-clockwise from the heading of the entry. The copy heads away
/// from the centre and has the height of the entry. The number i is appended to the name of the copy and to
/// the names of all sensors, devices and parts inside the copy. Empty, with errors, if the ring or the pose
/// is wrong.
std::vector<JsonNode> expand_ring(const JsonCursor& at);

/// The greatest number of JSON objects that the rings of a document may make: the copies and the objects in
/// the copies. Rings in rings multiply, so a short file could otherwise ask for any amount of memory.
inline constexpr std::size_t k_most_ring_objects = 1000000;
/// Checks the number of objects that the rings of the document at `root` make. If it exceeds
/// k_most_ring_objects, reports an error at the ring that exceeds it, and throws InputError with all errors
/// that were reported so far.
void check_rings(const JsonCursor& root);

}  // namespace troupe::worldio
