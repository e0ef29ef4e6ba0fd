#pragma once

#include "base/color.hpp"
#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"
#include "worldio/json_reader.hpp"

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace troupe::worldio {

inline constexpr double k_max_size_m = 100000;

/// A type as a JSON world describes it.
struct JsonType {
  engine::TypeSpec spec;
  std::optional<Color> color;
};

/// Reads `types/NAME`. What is wrong is reported; the result is then meaningless.
JsonType read_type(const JsonCursor& at, const std::string& name, const engine::Registry& registry);

/// The key `pose` of an object; the identity where it is absent.
Pose read_pose(JsonObject& object);
/// The keys `obstacle` and `ranger_return`.
engine::Returns read_returns(JsonObject& object);
/// Pairs of metres: [[x, y], ...]. Empty, and reported, where they are wrong or number fewer or more than
/// asked.
std::vector<Vec2> read_points(const JsonCursor& at, std::size_t least,
                              std::size_t most = std::numeric_limits<std::size_t>::max());

/// What is wrong with a ring as the outline of a block: repeated points, crossing edges, no area. Empty:
/// nothing.
std::string outline_fault(const Ring& ring);

}  // namespace troupe::worldio
