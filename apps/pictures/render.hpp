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

/// Adds `render` and its options to the program; `options` must outlive `app`.
CLI::App* add_render_command(CLI::App& app, RenderOptions& options);
/// Draws what was asked for.
ExitCode render_pictures(const RenderOptions& options);

}  // namespace troupe::apps
