#include "engine/world_spec.hpp"

namespace troupe::engine {

void add_ground(WorldSpec& spec) {
  TypeSpec type;
  type.name = "ground";
  type.parts.push_back(
      {.name = "", .kind = "model", .size = {0, 0, 0}, .returns = {.obstacle = false, .ranger = -1}});
  spec.types.push_back(std::move(type));
  spec.bodies.push_back({.name = spec.names.add("_ground_model"), .type = TypeId(spec.types.size() - 1)});
}

bool is_below(const TypeSpec& type, std::uint32_t below, std::uint32_t part) {
  while (below > part) below = type.parts[below].parent;  // parents stand before their children
  return below == part;
}

}  // namespace troupe::engine
