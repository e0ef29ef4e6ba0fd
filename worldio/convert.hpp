#pragma once

#include "engine/kinds.hpp"
#include "worldio/load.hpp"

#include <cstddef>
#include <filesystem>
#include <string>

namespace troupe::worldio {

/// The result of convert_world(): a world as the text of a file in another format.
struct ConvertedWorld {
  std::string text;        ///< content of the new file
  std::size_t bodies = 0;  ///< number of bodies, without the ground
  std::size_t types = 0;   ///< number of types that these bodies use
};

/// Converts the world file `from` to the text of a file `to`. Both names must end in `.world` (Stage's
/// syntax) or `.json`; the ending selects the format. No file is written. Paths of images in the text are
/// relative to the folder of `to`. Macros of a `.world` and presets of a JSON world are expanded, and
/// populations become one model per body. A run of the new world has the same hash log as a run of the old
/// one. When it converts to `.world`, it reports an error at the place of everything that Stage cannot
/// express, and a warning for a value that changes in its last bits. Do not use the result if `diagnostics`
/// has errors.
ConvertedWorld convert_world(const std::filesystem::path& from, const std::filesystem::path& to,
                             const engine::Registry& registry, const LoadOptions& options,
                             Diagnostics& diagnostics);

}  // namespace troupe::worldio
