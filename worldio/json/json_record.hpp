#pragma once

#include "engine/world_spec.hpp"
#include "worldio/json/json_reader.hpp"

namespace troupe::worldio {

/// The world's `record` object: `{"file": "run.h5", "every_s": 0.1, "fields": ["pose", "ranges"]}`, each key
/// as you like. Which fields a world has is known once it is built.
engine::RecordSpec read_record(const JsonCursor& at);
JsonNode record_node(const engine::RecordSpec& record);

}  // namespace troupe::worldio
