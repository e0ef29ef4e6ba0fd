#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace troupe::apps {

/// Installs the signal handlers of the program. The first Ctrl-C or SIGTERM only makes stop_requested()
/// return true; runs then end after their current tick (time step). The second one ends the program
/// immediately. SIGHUP, which the program gets when its terminal is closed, also makes stop_requested()
/// return true, but does not count as the first or second signal; if SIGHUP is ignored, as under nohup, it
/// remains so. SIGPIPE is ignored: if the reader of a pipe ends, writing to the pipe is an error, after which
/// a run can still save its state.
///
/// what: what the first Ctrl-C or SIGTERM does, such as "troupe run: stopping after the current tick". The
/// signal prints a line on standard error with this text, and that a second one ends the program. The line is
/// left out if `what` is empty, or if writing would have to wait, for example because a pipe is full
void stop_on_signals(std::string_view what = {});
/// Whether Ctrl-C, SIGTERM or SIGHUP has arrived since the start of the program.
bool stop_requested();
/// Requests a stop because another process of the run got one of these signals: stop_requested() returns
/// true, and the line of stop_on_signals() is printed. Does not count as the first or second signal.
void request_stop();
/// Starts to count the signal SIGUSR1, with which users request a checkpoint (a file with the state of the
/// run). Each call sets the count to 0. Before the first call, the signal ends the program.
void count_save_requests();
/// Returns how often SIGUSR1 has arrived since the last call of count_save_requests().
std::uint32_t save_requests();
/// Sets a file, such as an unfinished film, that a second Ctrl-C or SIGTERM removes before it ends the
/// program. Each call replaces the file of the previous call. If the name is empty or has 4,096 bytes or
/// more, no file will be removed.
void remove_when_killed(const std::filesystem::path& file);

}  // namespace troupe::apps
