#pragma once

#include "engine/world_spec.hpp"

#include <string>

namespace troupe::worldio {

/// Whether places in files are compared, by the names of the files and the lines.
enum class Places {
  ignored,
  compared,  ///< but for those of an experiment, which no stored world has
};

/// In what two worlds differ: the path of the first value that is not the same to the last bit, as in
/// `types[3].parts[1].solids`, `bodies[7].name`. Empty: they are the same. What parts are made from (images,
/// blocks) and a title that is empty are not compared; names are, not the words that they are made of.
std::string spec_difference(const engine::WorldSpec& a, const engine::WorldSpec& b,
                            Places places = Places::ignored);

/// Whether two parts of a type are the same in the same sense.
bool same_part(const engine::PartSpec& a, const engine::PartSpec& b);

/// What spec_difference() compares of a type, as bytes: those of two types are equal where the types are the
/// same.
std::string compared_bytes(const engine::TypeSpec& type);

}  // namespace troupe::worldio
