#pragma once

#include <filesystem>

namespace troupe::apps {

/// Installs the signal handlers. The first Ctrl-C or SIGTERM ends a run after the current tick; the second
/// ends the program immediately. SIGXFSZ is ignored, so that a file that exceeds the size limit is reported
/// as a write error instead of killing the program.
void stop_on_signals();
/// Whether Ctrl-C or SIGTERM has arrived.
bool stop_requested();
/// Sets the file that a second signal removes before it ends the program; replaces the previous one. Empty:
/// no file. Names of 4,096 bytes or more are ignored.
void remove_when_killed(const std::filesystem::path& file);

}  // namespace troupe::apps
