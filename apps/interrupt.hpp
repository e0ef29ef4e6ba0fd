#pragma once

namespace troupe::apps {

/// From here on Ctrl-C and SIGTERM end what runs after the current tick; a second one ends it at once. A file
/// that grows beyond what the system allows is an error in writing it, not the end of the program.
void stop_on_signals();
/// Whether one has come.
bool stop_requested();

}  // namespace troupe::apps
