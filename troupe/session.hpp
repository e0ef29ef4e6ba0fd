#pragma once

#include "engine/kinds/act.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace troupe {

class Simulation;

/// Writes a session file: the acts that were applied to a running simulation, and the ticks (time steps) at
/// which they were applied (docs/live.md). An act is a change by a user or a program, such as moving a robot
/// (troupe/acts.hpp). SessionReplay repeats the acts from the file. When add() returns, the act has been
/// passed to the operating system: it is not lost if the process dies.
class SessionLog {
 public:
  /// Creates the file NAME.session.jsonl in `folder`, where NAME is the name of the world file without its
  /// ending. If this file exists, creates NAME.session-2.jsonl instead (or -3, ...). Throws
  /// std::runtime_error if the file cannot be created or written, or if an option of the simulation, such as
  /// the path of its world, is not UTF-8.
  SessionLog(const std::filesystem::path& folder, const Simulation& simulation);
  /// Creates the file as the constructor does, but leaves it empty until begin() is called. If begin()
  /// is not called or fails, the destructor removes the file. Throws as the constructor does.
  static std::unique_ptr<SessionLog> create(const std::filesystem::path& folder,
                                            const Simulation& simulation);
  ~SessionLog();
  SessionLog(const SessionLog&) = delete;
  SessionLog& operator=(const SessionLog&) = delete;

  const std::filesystem::path& file() const;  ///< path of the session file
  /// Writes the first line, for a session that begins at the present state. Call it once, after create() and
  /// before add(); the constructor has already called it. Throws std::logic_error if it was called before,
  /// and std::runtime_error if the file cannot be written.
  void begin(const Simulation& simulation);
  /// Appends an act that was applied at the current tick of the simulation. Throws std::logic_error if
  /// begin() has not been called, and std::runtime_error if the file cannot be written. Part of the line may
  /// then be in the file. Therefore this function, begin() and end() write nothing after an error, and throw
  /// the same error again.
  void add(const Simulation& simulation, const engine::Act& act);
  /// Appends an entry which states that the session ended at this tick. Throws as add() does. Without this
  /// entry, SessionReplay::end_tick() is empty.
  void end(std::uint64_t tick);

 private:
  struct Impl;
  explicit SessionLog(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Repeats a session: a run with acts that SessionLog wrote to a file. Applies each act at the tick at which
/// it was applied in the original run. Call act() in the callback of Simulation::before_tick(), which is
/// called in every tick before sensors and robots are computed:
///
///   troupe::Simulation simulation("cave.world", {.seed = 7, .mortal = true});  // as in the original run
///   troupe::SessionReplay session("cave.session.jsonl", simulation);
///   simulation.before_tick([&](troupe::Simulation& s) { session.act(s); });
///   simulation.run_for(60);
class SessionReplay {
 public:
  /// Reads a session file. Throws InputError, `cave.session.jsonl:1: error: ...`, in these cases:
  /// - The file is not a session file.
  /// - The session was recorded with another version of Troupe, or with other values of options that affect
  ///   results.
  /// - The simulation has not reached the first tick of the session.
  /// - The session ends after the longest time of a run, engine::k_longest_run_s.
  /// - The simulation is at the first tick of the session, but the content of its world (bodies, walls,
  ///   types, parameters, interventions) differs. Sessions that older versions of Troupe wrote lack the hash
  ///   of the content, and it is not compared.
  /// - The simulation is at the first tick of the session, but its state hash (a hash of the whole state of
  ///   the world) is not the one in the file.
  ///
  /// A simulation past the first tick of the session must have been resumed from a checkpoint of the session.
  /// Its state then already contains the acts of earlier ticks, so the constructor skips these acts. The
  /// state hash and the content of the world are not checked in this case.
  SessionReplay(const std::filesystem::path& file, const Simulation& simulation);
  ~SessionReplay();
  SessionReplay(const SessionReplay&) = delete;
  SessionReplay& operator=(const SessionReplay&) = delete;

  /// Applies the acts of the current tick of the simulation; does nothing if the session has none for this
  /// tick. Call it in every tick. If a tick with acts is missed, these acts and all later acts are never
  /// applied. Throws InputError, with file and line, if an act is impossible.
  void act(Simulation& simulation);
  /// The tick at which the session ended. std::nullopt if the file does not state this tick, because the
  /// process died before SessionLog::end().
  std::optional<std::uint64_t> end_tick() const;
  /// The earliest tick at which the session may have ended: that after its last act, or its first tick if it
  /// has no act.
  std::uint64_t least_end_tick() const;
  /// Number of acts of the session that act() has not applied. Acts that the constructor skipped do not
  /// count.
  std::size_t left() const;
  const std::vector<std::string>& warnings() const;  ///< warnings about the file, one line each

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe
