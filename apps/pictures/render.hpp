#pragma once

#include "apps/exit_code.hpp"
#include "apps/pictures/picture_options.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}  // namespace CLI

namespace troupe::apps {

/// What the command line of `troupe render` asks for.
struct RenderOptions {
  std::filesystem::path input;  ///< a world, a checkpoint or a recording
  PictureFiles pictures;
  std::vector<std::filesystem::path> plugin_path;
};

/// Adds the options of `render`; parsing fills `options`, which must outlive `command`.
void add_render_options(CLI::App& command, RenderOptions& options);
/// Draws what was asked for.
ExitCode render_pictures(const RenderOptions& options);

}  // namespace troupe::apps
