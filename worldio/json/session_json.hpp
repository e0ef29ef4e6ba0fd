#pragma once

#include "base/diagnostics.hpp"
#include "engine/kinds/act.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// A session is a file in the format JSON Lines that lists the actions that users performed on a running
/// world (docs/live.md). An *act* is one such action: a body was moved, a command was given, ... A *tick* is
/// a simulation step.
namespace troupe::worldio {

inline constexpr int k_session_format = 1;  ///< the only version of the format

/// The first line of a session.
struct SessionHeader {
  std::string version;     ///< version and compiler (version_line()) of the program that wrote the session
  std::uint64_t tick = 0;  ///< tick at which the session began
  std::string hash;        ///< hash of the state at that tick: 16 lower-case hex digits
  /// Options of the run and their values, from Simulation::effective_options().
  std::vector<std::pair<std::string, std::string>> options;
};

/// An act, and the time at which it was performed.
struct LoggedAct {
  std::uint64_t tick = 0;  ///< number of ticks that were completed when the act was performed
  std::uint64_t n = 0;     ///< number of the act in the session, from 1
  engine::Act act;         ///< what the user did
  Where where;             ///< line of the act in the file
};

/// A whole session.
struct Session {
  SessionHeader header;         ///< the first line
  std::vector<LoggedAct> acts;  ///< ordered by tick and n
  /// Tick at which the session ended. Empty: the program that wrote the session did not end it, for example
  /// because it was killed.
  std::optional<std::uint64_t> end;
  std::vector<std::string> warnings;  ///< warnings from reading the session, each with file and line
};

/// These functions return the header, the line of an act, and the last line of a session, without line ends.
/// `tick` is the number of ticks that were completed when the act was performed or the session ended. `n` is
/// the number of the line; the first line after the header has number 1. The functions throw
/// std::invalid_argument for text that is not UTF-8. Numbers of the act must be finite, and Act::setting must
/// be valid JSON if the act sets parameters (`"do": "set"`).
///@{
std::string header_line(const SessionHeader& header);
std::string act_line(std::uint64_t tick, std::uint64_t n, const engine::Act& act);
std::string end_line(std::uint64_t tick, std::uint64_t n);
///@}

/// Reads an act: `{"do": "move", "robot": "r0", "pose": [1, 2, 0, 0.5]}`. The keys in `also` are allowed and
/// ignored. If `json` is not an act, reports errors at `where` and returns nothing. Does not check whether
/// the world has the bodies, devices and parameters that the act names.
std::optional<engine::Act> read_act(std::string_view json, const std::vector<std::string_view>& also,
                                    Where where, Diagnostics& diagnostics);

/// Reads a session. A last line without a line end, which a killed writer left, is skipped with a warning,
/// unless it is the header. If the file cannot be read or has errors, throws InputError with all errors and
/// their lines; after an error in the header, the other lines are not read.
Session load_session(const std::filesystem::path& file);

}  // namespace troupe::worldio
