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

/// A session file lists the actions that users performed on a running world (docs/live.md). Its format is
/// JSON Lines: one JSON object per line. The first line is the header. Each further line is an *act*, which
/// is one action of a user: a body was moved, a command was given, ... The last line marks the end of the
/// session. A *tick* is a time step.
namespace troupe::worldio {

inline constexpr int k_session_format = 1;  ///< the only version of the format

/// The first line of a session file.
struct SessionHeader {
  std::string version;     ///< version and compiler (version_line()) of the program that wrote the session
  std::uint64_t tick = 0;  ///< tick at which the session began
  std::string hash;        ///< hash of the state at that tick: 16 lower-case hex digits
  /// hash_of_content() of the spec of the world: 16 lower-case hex digits. Empty in sessions that older
  /// versions wrote.
  std::string world_hash;
  /// Names of the options of the run and their values, from Simulation::effective_options().
  std::vector<std::pair<std::string, std::string>> options;
};

/// An act, and the time at which it was performed.
struct LoggedAct {
  std::uint64_t tick = 0;  ///< number of ticks that were completed when the act was performed
  std::uint64_t n = 0;     ///< number of the act in the session, from 1
  engine::Act act;         ///< what the user did
  Where where;             ///< line of the act in the file
};

/// The content of a session file.
struct Session {
  SessionHeader header;         ///< the first line
  std::vector<LoggedAct> acts;  ///< ordered by tick and n
  /// Tick at which the session ended. Empty if the file has no line that marks the end, for example because
  /// the program that wrote the file was killed.
  std::optional<std::uint64_t> end;
  std::vector<std::string> warnings;  ///< warnings from reading the session, each with file and line
};

/// These functions return lines of a session file, without line ends: the header, an act, and the line that
/// marks the end. `tick` is the number of ticks that were completed when the act was performed or the session
/// ended. `n` numbers the lines after the header: 1, 2, 3, ... The functions throw std::invalid_argument for
/// text that is not UTF-8. The values in the act, such as a pose, must be finite. For an act of the kind
/// Act::Kind::set, Act::setting must be the text of a JSON object.
///@{
std::string header_line(const SessionHeader& header);
std::string act_line(std::uint64_t tick, std::uint64_t n, const engine::Act& act);
std::string end_line(std::uint64_t tick, std::uint64_t n);
///@}

/// Reads an act from the text of a JSON object, such as
/// `{"do": "move", "robot": "r0", "pose": [1, 2, 0, 0.5]}`. The object may also have the keys in `also`,
/// which are ignored. If `json` is not an act, reports errors at `where` and returns nothing. Does not check
/// that the world has the bodies, devices and parameters that the act names.
std::optional<engine::Act> read_act(std::string_view json, const std::vector<std::string_view>& also,
                                    Where where, Diagnostics& diagnostics);

/// Reads a session file. A last line without a line end is incomplete, because the writer was killed; the
/// line is skipped, and Session::warnings gets a warning. (A header is read even without a line end.) If the
/// file cannot be read or has errors, throws InputError with all errors and their lines. After an error in
/// the header, the other lines are not read.
Session load_session(const std::filesystem::path& file);

}  // namespace troupe::worldio
