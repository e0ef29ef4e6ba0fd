#pragma once

#include "base/diagnostics.hpp"
#include "engine/kinds/kinds.hpp"
#include "engine/spec/world_spec.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::worldio {

/// The bodies of a spec (engine::WorldSpec) as columns, one array per member, because there may be millions
/// of bodies. Each column has one entry per body, in the order of the ids; `pose` and `color` have four
/// entries per body. The aliases, which are second names of bodies, have columns of their own.
struct BodyColumns {
  /// The name of the body, as in engine::Name: "r17" is the word "r", given by its index, and the number 17.
  std::vector<std::uint32_t> word, number;
  std::vector<std::uint32_t> type;  ///< index into WorldSpec::types
  std::vector<double> pose;         ///< x, y, z (m) and heading (rad), world frame
  std::vector<float> color;         ///< red, green, blue, opacity
  /// BodySpec::fiducial, the number that fiducial finders read; empty if all are 0.
  std::vector<std::int32_t> fiducial;
  std::vector<std::uint32_t> file, line;  ///< BodySpec::where; `file` is a file's number in WorldSpec::files
  /// The aliases: the two members of engine::Name, and the id of the body (its number in the world, from 0).
  /// One entry per alias.
  std::vector<std::uint32_t> alias_word, alias_number, alias_body;
};

/// A stored world: the whole spec of a world, in the form in which checkpoints contain it. No other file is
/// needed to restore the spec: it contains the types of included files, and the solids (extruded outlines)
/// that were made from images. restore_spec() returns a spec that is equal to the stored one in every bit in
/// the sense of spec_difference(). Not stored are the paths and options of these images, the blocks (upright
/// prisms) from which solids were made, and the places (file and line) of the values of the experiment.
struct StoredSpec {
  std::string json;    ///< JSON text from spec_to_json()
  BodyColumns bodies;  ///< the bodies, which are not in `json`
};
/// Returns a spec as a stored world. Throws like spec_to_json().
StoredSpec store_spec(const engine::WorldSpec& spec, const engine::Registry& registry);

/// Returns a spec without its bodies as JSON: settings, body types with their solids and parameters, the
/// words that names consist of, names of parts, the experiment, and a list of file names. A place in a file
/// is written as `where`: [file, line], in which `file` is an index into this list. Parameters have the names
/// and SI units of their field tables. Names and paths that are not UTF-8 are stored as {"latin1": ...}.
/// Throws std::runtime_error for a number that is not finite and for a parameter that is not UTF-8, because
/// JSON cannot represent these. Throws the same exception for a kind (sort of drive, device, controller, ...)
/// that is not in `registry`.
std::string spec_to_json(const engine::WorldSpec& spec, const engine::Registry& registry);

/// Returns the keys that the body types of a world have in a stored world: their indices "0", "1", ...
std::vector<std::string> numbers_of_types(const engine::WorldSpec& spec);

/// JSON pointers to the values of a stored world that `troupe resume --set` may change, for messages. N is an
/// index from 0, and `...` stands for the rest of the pointer. restore_spec() refuses all other pointers. It
/// does not refuse a parameter that determines the number of readings of a sensor, such as the number of
/// beams: the state of the checkpoint then does not fit, and restoring the state is an error.
inline constexpr std::string_view k_changeable =
    "/seed, /quit_time_s, /stop_when, /ranging, /resolution_m, /bounds_m; in /types/N: /drive/period_s, "
    "/drive/params/..., "
    "/sensors/N/active, /sensors/N/period_s, /sensors/N/params/..., /controllers/N/params/...";

/// Restores a spec from a stored world. `changes` are pairs of a JSON pointer into StoredSpec::json and a new
/// value as JSON text, as in --set; a pointer that is not in k_changeable is an error. Errors about the
/// stored world are reported at `where`, which is the file that it was read from; errors about a change, at
/// `--set POINTER`. Do not use the result if there are errors.
engine::WorldSpec restore_spec(const StoredSpec& stored, const engine::Registry& registry,
                               std::span<const std::pair<std::string, std::string>> changes, Where where,
                               Diagnostics& diagnostics);

}  // namespace troupe::worldio
