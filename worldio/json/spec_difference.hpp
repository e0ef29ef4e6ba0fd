#pragma once

#include "engine/world_spec.hpp"

#include <string>

namespace troupe::worldio {

/// Whether places in files are compared, by file name and line.
enum class Places {
  ignored,
  compared,  ///< except those of an experiment, which stored worlds do not keep
};

/// The path of the first value in which two worlds differ in any bit: `types[3].parts[1].solids`,
/// `bodies[7].name`. Empty if they are equal. Sources of parts (images, blocks) are not compared, nor is the
/// title if that of `a` is empty. Names are compared as texts, not by the words that they consist of.
std::string spec_difference(const engine::WorldSpec& a, const engine::WorldSpec& b,
                            Places places = Places::ignored);

/// Whether two parts of a type are equal in the sense of spec_difference().
bool same_part(const engine::PartSpec& a, const engine::PartSpec& b);

/// The values of a type that spec_difference() compares, as bytes: equal for equal types.
std::string compared_bytes(const engine::TypeSpec& type);

}  // namespace troupe::worldio
