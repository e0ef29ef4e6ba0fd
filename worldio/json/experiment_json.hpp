#pragma once

#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"
#include "worldio/json/json_reader.hpp"
#include "worldio/json/world_document.hpp"

#include <span>
#include <string>

namespace troupe::worldio {

/// The document's measure, as it is measured.
engine::MeasureSpec expand_measure(const MeasureDocument& document);
/// The document that expands to this measure.
MeasureDocument contract_measure(const engine::MeasureSpec& measure);

/// What is measured to stop a run, and what happens in it, of a world whose types are expanded
/// (docs/experiments.md). world: path of the object whose keys it stands under; where_at: of the key `at`;
/// type_keys: beside spec.types, what each is called in the document; empty of one that cannot be named.
/// Which bodies the name of a population or a model means is known once the world is built.
void expand_experiment(const ExperimentDocument& document, const DocumentPath& world, Where where_at,
                       std::span<const std::string> type_keys, const engine::Registry& registry,
                       engine::WorldSpec& spec);

/// Puts the same into a document.
void contract_experiment(const engine::WorldSpec& spec, std::span<const std::string> type_keys,
                         const engine::Registry& registry, ExperimentDocument& document);

/// The keys of an experiment among others of an object, of stored worlds: read and expanded.
void read_experiment(JsonObject& object, std::span<const std::string> type_keys,
                     const engine::Registry& registry, engine::WorldSpec& spec);
/// The same keys; nothing where the world has no such thing.
void write_experiment(const engine::WorldSpec& spec, std::span<const std::string> type_keys,
                      const engine::Registry& registry, JsonNode::Object& object);

}  // namespace troupe::worldio
