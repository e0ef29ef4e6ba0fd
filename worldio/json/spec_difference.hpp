#pragma once

#include "engine/spec/world_spec.hpp"

#include <string>

namespace troupe::worldio {

/// Whether spec_difference() compares the places in files (Where) that values come from. Two places are equal
/// if they have the same file name and line.
enum class Places {
  ignored,  ///< no places are compared
  /// All places are compared, except those of WorldSpec::experiment: stored worlds
  /// (worldio/json/spec_json.hpp) do not contain them.
  compared,
};

/// Returns the path of the first value that differs in any bit between two specs (descriptions of worlds,
/// from which the engine builds them), such as `types[3].parts[1].solids` or `bodies[7].name`. Empty if the
/// specs are equal. Three things are not compared: the images and blocks (upright prisms) from which the
/// solids of parts were made, the title if `a` has none, and the list of the files that the places refer to.
/// Names are compared as texts, because a name is stored as the index of a word and a number, and two worlds
/// may have different indices for the same word.
std::string spec_difference(const engine::WorldSpec& a, const engine::WorldSpec& b,
                            Places places = Places::ignored);

/// Whether two parts (rigid pieces of a body type) are equal in the sense of spec_difference() with
/// Places::ignored.
bool same_part(const engine::PartSpec& a, const engine::PartSpec& b);

/// Returns all values of a type (the description of bodies of the same construction) that spec_difference()
/// compares with Places::ignored, as one byte string. Two types have equal strings if and only if all these
/// values are equal in every bit.
std::string compared_bytes(const engine::TypeSpec& type);

}  // namespace troupe::worldio
