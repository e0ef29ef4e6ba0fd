#pragma once

#include "apps/options.hpp"
#include "apps/profile.hpp"
#include "troupe/recording.hpp"

#include <filesystem>

namespace troupe::apps {

/// What the command line of `troupe run` asks for.
struct RunOptions : WorldOptions {
  std::filesystem::path hash_log;  ///< empty: none
  std::filesystem::path snapshot;  ///< empty: none
  std::filesystem::path profile;   ///< empty: none
  ProfileLimits profile_limits;
  std::filesystem::path record;  ///< empty: where the world says, if it does
  RecordingOptions recording;
  bool force = false;  ///< outputs that exist may be replaced
  int width = 1280;
  int height = 720;
  bool json = false;
  bool quiet = false;
};

/// Adds `run` and its options to the program; parsing fills `options`, which must outlive `app`.
/// A value that is not what an option takes is a CLI::ValidationError that says what would be right.
CLI::App* add_run_command(CLI::App& app, RunOptions& options);

}  // namespace troupe::apps
