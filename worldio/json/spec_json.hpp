#pragma once

#include "base/diagnostics.hpp"
#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::worldio {

/// The bodies of a spec, which may be millions: an entry each, in the order of their ids.
struct BodyColumns {
  std::vector<std::uint32_t> word, number;  ///< engine::Name
  std::vector<std::uint32_t> type;
  std::vector<double> pose;               ///< x, y, z (m) and heading (rad), world frame
  std::vector<float> color;               ///< red, green, blue, opacity
  std::vector<std::int32_t> fiducial;     ///< BodySpec::fiducial; empty where all are 0
  std::vector<std::uint32_t> file, line;  ///< Where
  /// Other names of bodies, an entry each.
  std::vector<std::uint32_t> alias_word, alias_number, alias_body;
};

/// A world as it is kept, which needs no file beside it: everything its spec says, expanded. What comes back
/// is the same to the last bit.
struct StoredSpec {
  std::string json;  ///< of spec_to_json()
  BodyColumns bodies;
};
StoredSpec store_spec(const engine::WorldSpec& spec, const engine::Registry& registry);

/// Everything but the bodies: settings, types with their solids and parameters (under the names and SI units
/// of their field tables), the words of names, names of parts, and the files that a `where`, [file, line],
/// points into. Throws std::runtime_error for what JSON cannot say: a number that is not finite, a parameter
/// that is no UTF-8.
std::string spec_to_json(const engine::WorldSpec& spec, const engine::Registry& registry);

/// What its types are called in a stored world: "0", "1", ...
std::vector<std::string> numbers_of_types(const engine::WorldSpec& spec);

/// What a change of a stored world may name: whatever keeps the shape of the state.
inline constexpr std::string_view k_changeable =
    "/seed, /quit_time_s, /stop_when, /ranging, /resolution_m, /bounds_m; of /types/N: /drive/period_s, "
    "/drive/params/..., "
    "/sensors/N/active, /sensors/N/period_s, /sensors/N/params/..., /controllers/N/params/...";

/// `changes`: JSON pointer into the text -> value, as --set gives them; pointers beside k_changeable are
/// errors. Errors are reported at `where`, the file that the world was kept in, or at `--set POINTER`; the
/// result is meaningless when there are any.
engine::WorldSpec restore_spec(const StoredSpec& stored, const engine::Registry& registry,
                               std::span<const std::pair<std::string, std::string>> changes, Where where,
                               Diagnostics& diagnostics);

}  // namespace troupe::worldio
