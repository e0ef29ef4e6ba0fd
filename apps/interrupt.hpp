#pragma once

#include <cstdint>
#include <filesystem>

namespace troupe::apps {

/// Installs the signal handlers. The first Ctrl-C or SIGTERM only makes stop_requested() true, and runs end
/// after their current tick (simulation step); the second ends the program immediately. SIGXFSZ is ignored,
/// so that a file that exceeds the size limit is reported as a write error instead of killing the program.
void stop_on_signals();
/// Whether Ctrl-C or SIGTERM has arrived.
bool stop_requested();
/// Starts to count the signal SIGUSR1, by which users request a checkpoint (a file with the state of the
/// run). Without this call, the signal ends the program.
void count_save_requests();
/// How often SIGUSR1 has arrived since the last call of count_save_requests(), which resets the number to 0.
std::uint32_t save_requests();
/// Sets the file, such as an unfinished film, that a second Ctrl-C or SIGTERM removes before it ends the
/// program. Replaces the file of the previous call. An empty name, or one of 4,096 bytes or more: no file.
void remove_when_killed(const std::filesystem::path& file);

}  // namespace troupe::apps
