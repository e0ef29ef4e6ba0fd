#pragma once

#include "engine/world_spec.hpp"
#include "worldio/json/json_reader.hpp"
#include "worldio/load.hpp"

#include <string_view>

namespace troupe::worldio {

/// What of a JSON world is an error unless it says otherwise; else it is a warning.
struct JsonChecks {
  bool overlaps = true;    ///< bodies that overlap at the start
  bool same_names = true;  ///< bodies of one name
};

/// What a JSON world says beside what stands in it: the format's version, title, seed, times, ray engine,
/// bounds, what is recorded, how it is watched, which checks it wants.
JsonChecks read_settings(JsonObject& object, const LoadOptions& options, engine::WorldSpec& spec);

/// The same keys; a title that is `default_title` is left out, and so are the bounds where `with_bounds` is
/// false.
void write_settings(const engine::WorldSpec& spec, const JsonChecks& checks, std::string_view default_title,
                    bool with_bounds, JsonNode::Object& object);

}  // namespace troupe::worldio
