#pragma once

#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"
#include "worldio/json/json_reader.hpp"

#include <span>
#include <string>

namespace troupe::worldio {

/// The keys `stop_when`, `at` and `faults` of a world whose types are read (docs/experiments.md). type_keys:
/// beside spec.types, what each is called there; empty of one that cannot be named. Who is meant by the name
/// of a population or a model is known once the world is built.
void read_experiment(JsonObject& object, std::span<const std::string> type_keys,
                     const engine::Registry& registry, engine::WorldSpec& spec);

/// The same keys; nothing where the world has no such thing.
void write_experiment(const engine::WorldSpec& spec, std::span<const std::string> type_keys,
                      const engine::Registry& registry, JsonNode::Object& object);

}  // namespace troupe::worldio
