#pragma once

#include "apps/exit_code.hpp"
#include "apps/options.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace troupe::apps {

struct ViewOptions : WorldCommandOptions {
  std::uint16_t port = 0;          ///< TCP port to listen on; 0: any free port
  std::string bind;                ///< IP address to listen on; empty: the loopback addresses
  std::vector<std::string> hosts;  ///< host names of proxies, accepted in the HTTP header `Host`
  double rate = 1;                 ///< limit of the speed, in multiples of real time; 0: none
  /// Folder for checkpoints, recordings and the session file, which lists the actions of the users. Empty:
  /// the working folder.
  std::filesystem::path folder;
  bool open = false;  ///< open the page in the default browser
};

/// Adds the options of `view` to `command`. Parsing fills `options`, which must outlive `command`.
void add_view_options(CLI::App& command, ViewOptions& options);
/// `troupe view`: shows a world or a checkpoint (saved state of a run) in browsers. It ends on Ctrl-C, at the
/// time of --for, or when a condition in the key `stop_when` of the world file holds. Returns k_stopped after
/// Ctrl-C, SIGTERM or SIGHUP, else k_finished. Throws InputError if the world cannot be loaded or an option
/// is wrong.
ExitCode view_world(const ViewOptions& options);

}  // namespace troupe::apps
