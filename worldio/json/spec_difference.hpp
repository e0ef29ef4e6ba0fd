#pragma once

#include "engine/spec/world_spec.hpp"

#include <cstdint>
#include <string>

namespace troupe::worldio {

/// Whether spec_difference() also compares places. A place (Where) is the file and the line from which a
/// value of a spec was read. Two places are equal if they have the same file name and line.
enum class Places {
  ignored,  ///< no places are compared
  /// All places are compared, except those in WorldSpec::experiment, because a checkpoint does not store
  /// these.
  compared,
};

/// Compares two specs (descriptions of worlds, from which the engine builds them). Returns the path of the
/// first value that differs in any bit, such as `types[3].parts[1].solids` or `bodies[7].name`. Empty if the
/// specs are equal. Three members are not compared:
/// - PartSpec::image and PartSpec::fitted, the image or the blocks from which the solids of a part were made;
///   the solids themselves are compared
/// - WorldSpec::title, if that of `a` is empty
/// - WorldSpec::files, the list of the files that places refer to
///
/// Names of bodies are compared as texts. (A spec stores a name by the index of a word, and two specs may
/// have different indices for the same word.)
std::string spec_difference(const engine::WorldSpec& a, const engine::WorldSpec& b,
                            Places places = Places::ignored);

/// Whether two parts (rigid pieces of a body) are equal in every bit that spec_difference() compares with
/// Places::ignored.
bool same_part(const engine::PartSpec& a, const engine::PartSpec& b);

/// Returns a byte string that identifies the content of a type (the description of bodies of the same
/// construction). Two types have equal strings if and only if they are equal in every bit that
/// spec_difference() compares with Places::ignored.
std::string compared_bytes(const engine::TypeSpec& type);

/// Returns a hash of all content of a spec that can affect the states of a run. Equal specs have equal
/// hashes. Places, names of files and these members are left out, because they affect no state: the title,
/// `quit_time_s`, `record`, `measures`, `measure_every_s`, `watch` and `window`. WorldSpec::mortal and
/// contacts are left out, because the state hash includes their effects.
std::uint64_t hash_of_content(const engine::WorldSpec& spec);

}  // namespace troupe::worldio
