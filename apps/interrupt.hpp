#pragma once

#include <filesystem>

namespace troupe::apps {

/// From here on Ctrl-C and SIGTERM end what runs after the current tick; a second one ends it at once. A file
/// that grows beyond what the system allows is an error in writing it, not the end of the program.
void stop_on_signals();
/// Whether one has come.
bool stop_requested();
/// A file that a second signal removes before it ends the program, in place of the one before; empty: none.
/// Names of 4,096 bytes or more are not remembered.
void remove_when_killed(const std::filesystem::path& file);

}  // namespace troupe::apps
