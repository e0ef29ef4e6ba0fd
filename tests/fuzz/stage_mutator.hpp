#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::fuzz {

/// Returns a mutation of a world in Stage's syntax, which depends only on the text and the seed. The mutation
/// duplicates, nests, replaces or deletes blocks, inserts known properties with random values, or replaces
/// numbers by edge cases and words by other known words. It may be longer than the text. Returns an empty
/// text if the text has no token.
std::string mutate_stage(std::string_view text, std::uint32_t seed);

/// The words of worlds in Stage's syntax.
struct StageWords {
  std::vector<std::string> properties;  ///< the properties of worldio::stage_rows()
  std::vector<std::string> types;       ///< the types of models, and "sensor", "block" and "window"
  /// Texts that stand in quotes: names of drives, controllers, files and units, and values of properties.
  std::vector<std::string> texts;
};
const StageWords& stage_words();

}  // namespace troupe::fuzz
