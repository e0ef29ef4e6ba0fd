#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::fuzz {

/// A mutation of a Stage world by its blocks and tokens, a pure function of text and seed: blocks are
/// duplicated, nested, swapped and deleted, properties of the known list inserted with values of their kind,
/// numbers become edge values, words others that mean something. Empty where the text has no token. May be
/// longer than the text.
std::string mutate_stage(std::string_view text, std::uint32_t seed);

/// What Stage worlds are made of: the properties of worldio::stage_rows(), model types, and the names of
/// drives, controllers and presets.
struct StageWords {
  std::vector<std::string> properties;
  std::vector<std::string> types;  ///< of models, and "sensor", "block", "define", "include"
  std::vector<std::string> texts;  ///< what stands in quotes
};
const StageWords& stage_words();

}  // namespace troupe::fuzz
