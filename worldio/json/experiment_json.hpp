#pragma once

#include "engine/kinds/registry.hpp"
#include "engine/spec/world_spec.hpp"
#include "worldio/json/json_reader.hpp"
#include "worldio/json/world_document.hpp"

#include <optional>
#include <span>
#include <string>
#include <string_view>

/// Converts measures and experiments between JSON documents and specs.
///
/// document    a struct with the content of a JSON object (worldio/json/world_document.hpp)
/// spec        the description that the engine uses (engine/spec/world_spec.hpp)
/// measure     a number that is computed from the state of a run, such as the covered area
/// experiment  stop conditions (comparisons of measures with numbers), interventions (changes of the world at
///             given times) and faults (failures of robots)
/// type        a description of bodies of the same construction
/// kind        a sort of drive, device, controller, measure or fault, with its own parameters; the
///             engine::Registry lists all kinds
namespace troupe::worldio {

/// Returns the spec of the measure that a document describes. It copies the values and checks nothing.
engine::MeasureSpec expand_measure(const MeasureDocument& document);
/// Returns the document from which expand_measure() makes this measure.
MeasureDocument contract_measure(const engine::MeasureSpec& measure);

/// Adds the stop conditions, interventions and faults (docs/experiments.md) of a document to spec.experiment.
/// spec.types must be set before the call.
///
/// world      path of the JSON object that `document` was read from, for errors
/// where_at   place (file and line) of the key `at` of this object, the list of interventions, for errors
/// type_keys  for each type in spec.types, the key of this type in the document; empty for a type without a
///            key
///
/// An intervention `set`, which changes parameters of a type, is an error if there is no such type or if the
/// type does not have these parameters. Names of populations and models are checked later, when the engine
/// builds the world.
void expand_experiment(const ExperimentDocument& document, const DocumentPath& world, Where where_at,
                       std::span<const std::string> type_keys, const engine::Registry& registry,
                       engine::WorldSpec& spec);

/// The inverse of expand_experiment(): fills `document`, which must be empty, from spec.experiment.
/// `type_keys` has, for each type in spec.types, its key in the document.
void contract_experiment(const engine::WorldSpec& spec, std::span<const std::string> type_keys,
                         const engine::Registry& registry, ExperimentDocument& document);

/// Reads new parameters of a type from JSON: {"drive": {...}}, {"device": {"name": ..., ...}} or
/// {"controller": {"kind": ..., ...}}. The intervention `set` of a world file has the same form. type:
/// TypeSpec::name of a type of `spec`; if several types have this name, the first is used. Returns nothing,
/// and reports errors, if the JSON is wrong, if there is no such type, or if the type does not have these
/// parameters. The errors have no file and no line.
std::optional<engine::SettingSpec> read_setting(std::string_view type, std::string_view json,
                                                const engine::Registry& registry,
                                                const engine::WorldSpec& spec, Diagnostics& diagnostics);
/// Returns the parameters of a type as JSON on one line. The JSON is a list of objects such as those that
/// read_setting() reads: one for the drive, one for each device and one for each controller. A drive, device
/// or controller whose kind has no parameters has no object. Values that are not finite are left out, as are
/// parameters that are objects or lists of objects (FieldType::record and records). Throws std::runtime_error
/// for a text that is not UTF-8.
std::string parameters_json(const engine::TypeSpec& type, const engine::Registry& registry);

/// Reads an experiment from the keys `stop_when`, `at` and `faults` of `object`, and adds it to
/// spec.experiment with expand_experiment(). `object` is a JSON object of a stored world
/// (worldio/json/spec_json.hpp). Errors are reported to object.at().diagnostics(). Other keys of the object
/// are neither read nor reported. spec.types must be set before the call. `type_keys` has, for each type in
/// spec.types, the text that stands for the type in the object, such as its index.
void read_experiment(JsonObject& object, std::span<const std::string> type_keys,
                     const engine::Registry& registry, engine::WorldSpec& spec);
/// The inverse of read_experiment(): adds the keys `stop_when`, `at` and `faults` for spec.experiment to
/// `object`. Adds nothing for a world without an experiment. `type_keys` is as in read_experiment().
void write_experiment(const engine::WorldSpec& spec, std::span<const std::string> type_keys,
                      const engine::Registry& registry, JsonNode::Object& object);

}  // namespace troupe::worldio
