#pragma once

#include "base/color.hpp"
#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"
#include "worldio/json/json_parts.hpp"
#include "worldio/json/json_reader.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace troupe::worldio {

/// A type as a JSON world describes it.
struct JsonType {
  engine::TypeSpec spec;
  std::optional<Color> color;
};

/// Reads `types/NAME`. What is wrong is reported; the result is then meaningless.
JsonType read_type(const JsonCursor& at, const std::string& name, const engine::Registry& registry,
                   ImageFolder& images);

/// The object that reads back as this type where it stands under `key`. `folder` as for write_shape().
JsonNode type_node(const engine::TypeSpec& type, const std::string& key, const std::optional<Color>& color,
                   const engine::Registry& registry, const std::filesystem::path* folder);

/// How often a drive, a device or a controller runs: `period`, or `update_period` for kinds with a period of
/// their own.
engine::Field period_field(const engine::FieldTable& params);

/// Whether a part that is this device moves with it: an actuator does, a gripper's base does not.
inline bool moves_itself(const engine::DeviceKind& kind) { return !kind.joints.empty() && !kind.body; }

}  // namespace troupe::worldio
