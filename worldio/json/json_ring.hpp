#pragma once

#include "worldio/json/json_reader.hpp"

#include <cstddef>
#include <string_view>
#include <vector>

namespace troupe::worldio {

/// Whether an entry of a list, such as `sensors` or `parts`, has the key `ring`. The loader replaces such an
/// entry by several copies, at equal angles on a circle. RingDocument (worldio/json/world_document.hpp)
/// describes the value of the key.
inline bool has_ring(const JsonNode& entry) { return entry.find("ring") != nullptr; }

/// Whether the entries of the list with this key have names, by which types inherit them: `sensors`,
/// `devices` and `parts`.
bool is_named_list(std::string_view key);

/// Returns the copies of the list entry at `at`, which must have the key `ring`. If the ring or the pose of
/// the entry is wrong, reports errors and returns nothing.
///
/// The copies are on a circle around the position of the entry. `radius` of the ring is the radius of the
/// circle, and `count` is the number n of copies. Copies 0, 1, ..., n - 1 follow one another
/// counter-clockwise, 360/n degrees apart. The direction from the centre to copy 0 is the heading of the
/// entry plus `start`. Each copy heads away from the centre and has the z of the entry. Example: an entry at
/// x = y = 0 with heading 0, `count` 4, `radius` 1 m and `start` 0 has copies at (1, 0), (0, 1), (-1, 0) and
/// (0, -1) m, with the headings 0, 90, 180 and 270 degrees.
///
/// The number of a copy is appended to the name of the copy, and to the names of all sensors, devices and
/// parts in the copy. A key `on`, `joint` or `device` inside the copy that names one of these, or a joint of
/// one of these, gets the number, too: it refers to the device in the same copy. A copy does not have the key
/// `ring`.
std::vector<JsonNode> expand_ring(const JsonCursor& at);

/// Greatest number of JSON objects that the rings of a document may create. Each copy counts, and so does
/// each object inside a copy. The limit is needed because the numbers of copies multiply if an entry with a
/// ring is inside another one: a short file could ask for any amount of memory.
inline constexpr std::size_t k_most_ring_objects = 1000000;
/// Checks that the rings of the document at `root` create at most k_most_ring_objects objects. If they create
/// more, reports an error at the first ring that exceeds the limit, and throws InputError with all errors
/// that were reported so far.
void check_rings(const JsonCursor& root);

}  // namespace troupe::worldio
