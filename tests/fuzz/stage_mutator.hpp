#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::fuzz {

/// Returns a randomly changed copy of a world in Stage's syntax, for fuzz tests. The result may be longer
/// than `text`, and depends only on `text` and `seed`. The possible changes are: duplicating, nesting,
/// replacing and deleting blocks (`word ( ... )`); inserting known properties with random values; replacing
/// numbers by edge cases, and words by other known words. Comments are removed. Returns an empty text if
/// `text` has no words or other tokens.
std::string mutate_stage(std::string_view text, std::uint32_t seed);

/// The words of Stage's syntax that mutate_stage() inserts into worlds.
struct StageWords {
  std::vector<std::string> properties;  ///< names of properties, from worldio::stage_rows()
  std::vector<std::string> types;       ///< the types of models, and "sensor", "block" and "window"
  /// Texts that worlds contain in quotes: names of drives, controllers, files and units, and values of
  /// properties.
  std::vector<std::string> texts;
};
const StageWords& stage_words();

}  // namespace troupe::fuzz
