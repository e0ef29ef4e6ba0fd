#pragma once

#include "apps/exit_code.hpp"
#include "apps/options.hpp"
#include "apps/pictures/picture_options.hpp"

#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}  // namespace CLI

namespace troupe::apps {

/// What the command line of `troupe render` asks for.
struct RenderOptions : WorldOptions {
  PictureFiles pictures;           ///< of `world`: a world, a checkpoint or a recording
  std::vector<std::string> given;  ///< options that say how a world is run, as they were given
};

/// Adds the options of `render`; parsing fills `options`, which must outlive `command`.
void add_render_options(CLI::App& command, RenderOptions& options);
/// Draws what was asked for.
ExitCode render_pictures(const RenderOptions& options);

}  // namespace troupe::apps
