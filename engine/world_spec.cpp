#include "engine/world_spec.hpp"

#include <algorithm>
#include <map>

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

void add_spare(WorldSpec& spec, std::uint32_t count) {
  struct Population {
    BodySpec like;           // its first body
    std::uint32_t next = 0;  // number of the next
    bool is_of_one_type = true;
  };
  std::map<std::uint32_t, Population> populations;  // by word, in the order in which words came
  for (const BodySpec& body : spec.bodies) {
    if (body.name.number == Name::k_no_number || !is_mobile(spec.types[body.type.index()])) continue;
    Population& population = populations.try_emplace(body.name.word, Population{.like = body}).first->second;
    population.is_of_one_type = population.is_of_one_type && population.like.type == body.type;
    population.next = std::max(population.next, body.name.number + 1);
  }
  for (const auto& [word, population] : populations) {
    const std::string name = spec.names.words()[word];
    if (!population.is_of_one_type || std::ranges::count(spec.reserves, name, &ReserveSpec::population) > 0)
      continue;
    spec.reserves.push_back({name, BodyId(spec.bodies.size()), count});
    for (std::uint32_t i = 0; i < count; ++i) {
      BodySpec& body = spec.bodies.emplace_back(population.like);
      body.name = spec.names.add(name, population.next + i);
      body.pose_world_body = {};
    }
  }
}

}  // namespace troupe::engine
