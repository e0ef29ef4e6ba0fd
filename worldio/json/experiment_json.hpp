#pragma once

#include "engine/kinds/kinds.hpp"
#include "engine/spec/world_spec.hpp"
#include "worldio/json/json_reader.hpp"
#include "worldio/json/world_document.hpp"

#include <optional>
#include <span>
#include <string>
#include <string_view>

/// Converts measures and experiments between JSON documents and specs. A measure is a number that is computed
/// from the state of a run, such as the covered area. An experiment consists of stop conditions (comparisons
/// of measures with numbers), interventions (changes of the world at given times) and faults (failures of
/// robots). A document is a struct with the content of a JSON object (worldio/json/world_document.hpp). A
/// spec is the description that the engine uses (engine/spec/world_spec.hpp). A type describes bodies of the
/// same construction. A kind is a sort of drive, device, controller, measure or fault, with its own
/// parameters; the engine::Registry lists all kinds.
namespace troupe::worldio {

/// Returns the spec of the measure that a document describes. It copies the values and checks nothing.
engine::MeasureSpec expand_measure(const MeasureDocument& document);
/// Returns the document from which expand_measure() makes this measure.
MeasureDocument contract_measure(const engine::MeasureSpec& measure);

/// Adds the stop conditions, interventions and faults (docs/experiments.md) of a document to spec.experiment.
/// The types of `spec` must be set already.
/// world      path of the object that has the keys, for errors
/// where_at   place of the key `at`, the list of interventions, for errors
/// type_keys  for each type in spec.types, its key in the document; empty for a type without a key
/// The intervention `set` changes parameters of a type: an unknown type, and parameters that the type does
/// not have, are errors. Names of populations and models are resolved later, when the world is built.
void expand_experiment(const ExperimentDocument& document, const DocumentPath& world, Where where_at,
                       std::span<const std::string> type_keys, const engine::Registry& registry,
                       engine::WorldSpec& spec);

/// The inverse of expand_experiment(): fills `document`, which must be empty, from spec.experiment.
/// `type_keys` has, for each type in spec.types, its key in the document.
void contract_experiment(const engine::WorldSpec& spec, std::span<const std::string> type_keys,
                         const engine::Registry& registry, ExperimentDocument& document);

/// Reads new parameters of a type from JSON: {"drive": {...}}, {"device": {"name": ..., ...}} or
/// {"controller": {"kind": ..., ...}}, as in the intervention `set` of a world file. type: TypeSpec::name of
/// a type of `spec`; if several types have this name, the first is used. If the JSON is wrong, there is no
/// such type, or the type does not have these parameters, returns nothing and reports errors, which name no
/// file.
std::optional<engine::SettingSpec> read_setting(std::string_view type, std::string_view json,
                                                const engine::Registry& registry,
                                                const engine::WorldSpec& spec, Diagnostics& diagnostics);
/// Returns the parameters of a type as JSON on one line: a list of the objects that read_setting() reads, one
/// for the drive and for each device and controller whose kind has parameters. Values that are not finite,
/// and parameters that are objects or lists of objects (FieldType::record and records), are left out. Throws
/// std::runtime_error for a text that is not UTF-8.
std::string parameters_json(const engine::TypeSpec& type, const engine::Registry& registry);

/// Reads the keys of an experiment (`stop_when`, `at`, `faults`) from `object`, the JSON object of a stored
/// world (worldio/json/spec_json.hpp), and adds the experiment to spec.experiment with expand_experiment().
/// Errors are reported to the diagnostics of object.at(), the path of the object. Other keys of the object
/// are neither read nor reported. The types of `spec` must be set already: `type_keys` has, for each type,
/// the text by which the object refers to the type.
void read_experiment(JsonObject& object, std::span<const std::string> type_keys,
                     const engine::Registry& registry, engine::WorldSpec& spec);
/// The inverse of read_experiment(): adds the keys of spec.experiment to `object`. Adds nothing for a world
/// without an experiment. `type_keys` is as in read_experiment().
void write_experiment(const engine::WorldSpec& spec, std::span<const std::string> type_keys,
                      const engine::Registry& registry, JsonNode::Object& object);

}  // namespace troupe::worldio
