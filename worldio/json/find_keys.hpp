#pragma once

#include "engine/kinds/registry.hpp"
#include "worldio/json/key_row.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace troupe::worldio {

/// A key of the JSON objects of a world, as find_keys() finds it.
struct FoundKey {
  /// Where the key is: "populations[].place.pitch_m". The marks are those of the headings of
  /// docs/world-format.md: `[]` stands for a list of objects, and `{}` for an object whose keys are names.
  /// For a parameter of a kind, the kind follows: "types{}.sensors[].range_m (kind radio)". Several paths if
  /// objects at several places have the key with the same description.
  std::vector<std::string> paths;
  KeyRow row;  ///< description of the key
  /// If the value is an object, or a list or map of objects: the keys of these objects. Empty otherwise.
  std::vector<KeyRow> keys;
  std::string_view what;  ///< word for the kinds of these objects, such as "drive"; empty: they have no kinds
  std::vector<std::string_view> kinds;  ///< names of these kinds and of their presets
};

/// Returns the keys of JSON worlds to which `name` refers, those of outer objects first. The list is empty if
/// there is none. It contains the parameters of the kinds in `registry`, because they are keys of objects;
/// parameters of plug-ins (shared libraries) are not found.
///
/// name: one of
/// - the name of a key, with or without the unit: "populations", "pitch_cm", "pitch"
/// - several names, separated by dots; each is a key of the objects in the value of the key before it:
///   "populations.place", "populations[].place.pitch_m", "sensors.range_m"
/// - the name of a kind or of a preset, followed by keys of its parameters; keys of outer objects may be left
///   out: "ranger.transducers.samples", "ranger.samples", "diff.turn_max"
/// - a JSON pointer, as in errors and in the option --set: "/types/bot/sensors/0/range_m"
std::vector<FoundKey> find_keys(const engine::Registry& registry, std::string_view name);

/// Returns the last of several names that are separated by dots, such as "ranger" for "sensors.ranger", if
/// the names before it are those of a key whose objects have kinds. There may be no kind of this name. Empty
/// if there is no such key.
std::string_view kind_in_path(const engine::Registry& registry, std::string_view name);

/// Returns the names of all keys that find_keys() finds, sorted, without duplicates. Each key has the unit
/// that the documentation states first.
std::vector<std::string> key_names(const engine::Registry& registry);

/// Returns the names that are possible in place of `name`, for suggestions. If only the last of several names
/// is wrong, these are the keys at its place, each with the names before it. Otherwise these are key_names().
std::vector<std::string> names_near(const engine::Registry& registry, std::string_view name);

}  // namespace troupe::worldio
