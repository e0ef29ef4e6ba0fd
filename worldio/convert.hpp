#pragma once

#include "engine/kinds.hpp"
#include "worldio/load.hpp"

#include <cstddef>
#include <filesystem>
#include <string>

namespace troupe::worldio {

/// A world in the format of another file.
struct ConvertedWorld {
  std::string text;        ///< of that file
  std::size_t bodies = 0;  ///< without the ground
  std::size_t types = 0;   ///< of these bodies
};

/// The world in `from` as the text of `to`, each in the format that its name ends in: `.world` or `.json`.
/// Nothing is written: `to` is where the text will lie, which the paths of images are made relative to.
/// - as JSON: a run of it has the same hash log. Nothing of a `.world` is lost but its macros, of JSON its
///   presets, and its populations, which are listed one by one.
/// - as `.world`: the same, as far as Stage has words for it. What it has none for is an error at its place;
///   what comes out otherwise in its last bits, a warning.
/// The result is meaningless when `diagnostics` has errors.
ConvertedWorld convert_world(const std::filesystem::path& from, const std::filesystem::path& to,
                             const engine::Registry& registry, const LoadOptions& options,
                             Diagnostics& diagnostics);

}  // namespace troupe::worldio
