#pragma once

#include "engine/act.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace troupe {

class Simulation;

/// Writes a session: the acts applied to a simulation, for SessionReplay (docs/live.md). Each act is in the
/// file when add() returns.
class SessionLog {
 public:
  /// Makes a new file NAME.session.jsonl in the folder, or NAME.session-2.jsonl, ...; existing files are
  /// never replaced. NAME is the world's file without its ending. Throws std::runtime_error if the file
  /// cannot be made.
  SessionLog(const std::filesystem::path& folder, const Simulation& simulation);
  ~SessionLog();
  SessionLog(const SessionLog&) = delete;
  SessionLog& operator=(const SessionLog&) = delete;

  const std::filesystem::path& file() const;  ///< path of the session
  /// Adds an act that was applied at the simulation's tick. Throws std::runtime_error if it cannot be
  /// written.
  void add(const Simulation& simulation, const engine::Act& act);
  /// Adds the end of the session, at the simulation's tick.
  void end(const Simulation& simulation);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Repeats a session: applies its acts at their ticks, from Simulation::before_tick().
///
///   troupe::Simulation simulation("cave.world", {.seed = 7, .mortal = true});
///   troupe::SessionReplay session("cave.session.jsonl", simulation);
///   simulation.before_tick([&](troupe::Simulation& s) { session.act(s); });
///   simulation.run_for(60);
class SessionReplay {
 public:
  /// Throws InputError, `cave.session.jsonl:1: error: ...`, for a file that is not a session, and for one
  /// that does not fit the simulation: another version, other options, another state at the tick of its
  /// begin, or a simulation before that tick. A simulation after that tick, resumed from a checkpoint,
  /// contains the acts of earlier ticks already.
  SessionReplay(const std::filesystem::path& file, const Simulation& simulation);
  ~SessionReplay();
  SessionReplay(const SessionReplay&) = delete;
  SessionReplay& operator=(const SessionReplay&) = delete;

  /// Applies the acts of the simulation's tick. Throws InputError, with file and line, for an act that is
  /// refused.
  void act(Simulation& simulation);
  /// The tick at which the session ended; empty if the file does not state it.
  std::optional<std::uint64_t> end_tick() const;
  /// Number of remaining acts.
  std::size_t left() const;
  const std::vector<std::string>& warnings() const;  ///< warnings about the file, one line each

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe
