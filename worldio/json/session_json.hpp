#pragma once

#include "base/diagnostics.hpp"
#include "engine/act.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Sessions: what was done to a running world, as JSON Lines (docs/live.md).
namespace troupe::worldio {

inline constexpr int k_session_format = 1;

/// The first line of a session.
struct SessionHeader {
  std::string version;     ///< version_line() of the program that wrote it
  std::uint64_t tick = 0;  ///< at which it began
  std::string hash;        ///< of the state then: 16 lower-case hex digits
  /// Options of the run, Simulation::effective_options().
  std::vector<std::pair<std::string, std::string>> options;
};

/// An act with its place in the run.
struct LoggedAct {
  std::uint64_t tick = 0;  ///< it was done when this one had ended
  std::uint64_t n = 0;     ///< number in the session, from 1
  engine::Act act;
  Where where;  ///< its line
};

/// A whole session.
struct Session {
  SessionHeader header;
  std::vector<LoggedAct> acts;       ///< by tick and n
  std::optional<std::uint64_t> end;  ///< tick at which it ended; not given: its writer was killed
  std::vector<std::string> warnings;
};

/// Lines without their ends. Throw std::invalid_argument for a text that is no UTF-8.
///@{
std::string header_line(const SessionHeader& header);
std::string act_line(std::uint64_t tick, std::uint64_t n, const engine::Act& act);
std::string end_line(std::uint64_t tick, std::uint64_t n);
///@}

/// The act that a JSON object says: `{"do": "move", "robot": "r0", "pose": [1, 2, 0, 0.5]}`. Keys of `also`
/// may stand beside its own. Nothing, with errors at `where`, for what is none.
std::optional<engine::Act> read_act(std::string_view json, const std::vector<std::string_view>& also,
                                    Where where, Diagnostics& diagnostics);

/// Reads a session. A last line that was cut off, as by a kill, is left out with a warning. Throws InputError
/// that lists what is wrong, with lines.
Session load_session(const std::filesystem::path& file);

}  // namespace troupe::worldio
