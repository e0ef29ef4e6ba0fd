#pragma once

#include "engine/kinds.hpp"
#include "worldio/load.hpp"

#include <cstddef>
#include <filesystem>
#include <string>

namespace troupe::worldio {

/// A world as the text of a file in another format.
struct ConvertedWorld {
  std::string text;        ///< content of that file
  std::size_t bodies = 0;  ///< number of bodies, without the ground
  std::size_t types = 0;   ///< number of types that these bodies use
};

/// Converts the world file `from` to the text of a file `to`. Each name must end in `.world` or `.json`,
/// which selects the format. Writes no file; paths of images in the text are relative to the folder of `to`.
/// - To JSON: a run of the result has the same hash log. Macros of a `.world` and presets of a JSON world are
///   expanded, and populations become one model per body.
/// - To `.world`: likewise, for everything that Stage can express. Anything else is an error at its place; a
///   value that changes in its last bits is a warning.
/// Do not use the result if `diagnostics` has errors.
ConvertedWorld convert_world(const std::filesystem::path& from, const std::filesystem::path& to,
                             const engine::Registry& registry, const LoadOptions& options,
                             Diagnostics& diagnostics);

}  // namespace troupe::worldio
