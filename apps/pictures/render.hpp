#pragma once

#include "apps/exit_code.hpp"
#include "apps/options.hpp"
#include "apps/pictures/picture_options.hpp"

#include <string>
#include <vector>

namespace troupe::apps {

/// Options of `troupe render`. The member `world` names a world, a checkpoint (saved state of a run) or a
/// recording (file with the state over time).
struct RenderOptions : WorldCommandOptions {
  PictureFiles pictures;           ///< the pictures and the film to write
  std::vector<std::string> given;  ///< given options that are not allowed for every type of input
};

/// Adds the options of `render`; parsing fills `options`, which must outlive `command`.
void add_render_options(CLI::App& command, RenderOptions& options);
/// `troupe render`: draws the requested pictures of a world, a checkpoint or a recording, and makes the
/// requested film. Returns k_stopped after Ctrl-C, SIGTERM or SIGHUP, else k_finished. Throws InputError or
/// OutputError, for example if the input cannot be loaded or a picture cannot be written.
ExitCode render_pictures(const RenderOptions& options);

}  // namespace troupe::apps
