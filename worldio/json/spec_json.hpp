#pragma once

#include "base/diagnostics.hpp"
#include "engine/kinds/registry.hpp"
#include "engine/spec/world_spec.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Stores specs in the form in which checkpoints contain them, and restores them. A spec (engine::WorldSpec)
/// is the description from which the engine builds a world. The id of a body is its index in
/// WorldSpec::bodies. A type describes bodies of the same construction. A kind is a sort of drive, device,
/// controller, measure or fault, with parameters of its own; the engine::Registry lists all kinds. A place
/// (Where) is the file and the line of a value.
namespace troupe::worldio {

/// The bodies of a spec as arrays, one per member of BodySpec, because there may be millions of bodies. Entry
/// i of an array belongs to the body with id i; in `pose` and `color`, these are the entries 4 i to 4 i + 3.
/// The arrays whose names begin with `alias_` do not belong to bodies, but to aliases (second names of
/// bodies).
struct BodyColumns {
  /// Name of the body: an index into the words of the spec (engine::Names::words()), and the number that
  /// follows the word. For "r17", they are the index of "r" and the number 17 (engine::Name).
  std::vector<std::uint32_t> word, number;
  std::vector<std::uint32_t> type;  ///< index into WorldSpec::types
  std::vector<double> pose;         ///< 4 per body: x, y, z (m) and heading (rad), world frame
  std::vector<float> color;         ///< 4 per body: red, green, blue, opacity (0 to 1)
  /// BodySpec::fiducial, the number that fiducial finders (sensors that detect marked bodies) read from the
  /// body. Empty if all numbers are 0.
  std::vector<std::int32_t> fiducial;
  std::vector<std::uint32_t> file, line;  ///< BodySpec::where; `file` is a file's number in WorldSpec::files
  /// The aliases, one entry per alias. `alias_word` and `alias_number` give the second name, in the same form
  /// as `word` and `number`. `alias_body` is the id of the body.
  std::vector<std::uint32_t> alias_word, alias_number, alias_body;
};

/// Returns the bodies of a spec as arrays.
BodyColumns body_columns(const engine::WorldSpec& spec);

/// A stored world: a whole spec, in the form in which checkpoints contain it. No other file is needed to
/// restore the spec: it contains the types of included files, and the solids (extruded outlines) that were
/// made from images. restore_spec() returns a spec in which spec_difference() finds no difference from the
/// stored one. Not stored are the images (PartSpec::image) and blocks (PartSpec::fitted) from which solids
/// were made, and the places of the values in WorldSpec::experiment.
struct StoredSpec {
  std::string json;    ///< JSON text from spec_to_json()
  BodyColumns bodies;  ///< the bodies, which are not in `json`
};
/// Returns a spec as a stored world. Throws the exceptions of spec_to_json().
StoredSpec store_spec(const engine::WorldSpec& spec, const engine::Registry& registry);

/// Returns a spec as JSON text, without its bodies and aliases, which BodyColumns stores. The JSON object
/// contains the settings, the types with their solids and parameters, the experiment, the names of parts, a
/// list `files` of file names, and a list `words` of the words of which names consist.
/// - A number is in SI units. The unit is part of the key, as in `period_s`.
/// - A place is written as [file, line], where `file` is an index into the list `files`.
/// - A name or a path that is not UTF-8 is written as {"latin1": TEXT}: each character of TEXT, U+0000 to
///   U+00FF, stands for one byte.
///
/// Throws std::runtime_error if a number is not finite, if a text among the parameters of a kind is not
/// UTF-8, or if a kind is not in `registry`.
std::string spec_to_json(const engine::WorldSpec& spec, const engine::Registry& registry);

/// Returns the texts "0", "1", ..., one for each type of the spec. The experiment of a stored world (stop
/// conditions, interventions and faults) uses these texts in place of the names of types.
std::vector<std::string> numbers_of_types(const engine::WorldSpec& spec);

/// The values of a stored world that `troupe resume --set` may change, as a text for messages. The text lists
/// JSON pointers, where N is an index from 0, and `...` is any rest of a pointer. restore_spec() refuses all
/// other pointers.
inline constexpr std::string_view k_changeable =
    "/seed, /quit_time_s, /stop_when, /ranging, /resolution_m, /bounds_m; in /types/N: /drive/period_s, "
    "/drive/params/..., "
    "/sensors/N/active, /sensors/N/period_s, /sensors/N/params/..., /controllers/N/params/...";

/// A change of parameters by `troupe resume --set`.
struct ParameterChange {
  std::string pointer;          ///< the JSON pointer of the first changed parameter, for errors
  engine::SettingSpec setting;  ///< the changed parameters of one drive, device or controller
};

/// Restores a spec from a stored world. Each entry of `changes` is a JSON pointer into StoredSpec::json and
/// the new value as JSON text, as in `troupe resume --set`. A pointer that is not in k_changeable is an
/// error. `where` is the file from which `stored` was read; errors in the stored world are reported there. An
/// error in a change is reported at `--set POINTER` instead. Do not use the result if there are errors.
///
/// Changes of parameters (`.../params/...`) are not made in the spec. They are added to `parameters`, one
/// entry for each drive, device or controller, so that the caller can pass them to World::set() at the tick
/// of the checkpoint. In the spec, they would change the values at tick 0, and earlier interventions `set`
/// would override them.
engine::WorldSpec restore_spec(const StoredSpec& stored, const engine::Registry& registry,
                               std::span<const std::pair<std::string, std::string>> changes, Where where,
                               Diagnostics& diagnostics, std::vector<ParameterChange>& parameters);

}  // namespace troupe::worldio
