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

/// Writes a session: what is done to a simulation, so that SessionReplay repeats it (docs/live.md). Each act
/// is in the file when add() returns.
class SessionLog {
 public:
  /// A new file NAME.session.jsonl in the folder, or NAME.session-2.jsonl, ...: one that is there is never
  /// replaced. NAME is the world's file without its ending. Throws std::runtime_error where it cannot be
  /// made.
  SessionLog(const std::filesystem::path& folder, const Simulation& simulation);
  ~SessionLog();
  SessionLog(const SessionLog&) = delete;
  SessionLog& operator=(const SessionLog&) = delete;

  const std::filesystem::path& file() const;  ///< that it writes
  /// An act that was done at the simulation's tick. Throws std::runtime_error where it cannot be written.
  void add(const Simulation& simulation, const engine::Act& act);
  /// The session is over at the simulation's tick.
  void end(const Simulation& simulation);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Repeats a session: does its acts at their ticks, from Simulation::before_tick().
///
///   troupe::Simulation simulation("cave.world", {.seed = 7, .mortal = true});
///   troupe::SessionReplay session("cave.session.jsonl", simulation);
///   simulation.before_tick([&](troupe::Simulation& s) { session.act(s); });
///   simulation.run_for(60);
class SessionReplay {
 public:
  /// Throws InputError, `cave.session.jsonl:1: error: ...`, for a file that is no session, and one that does
  /// not fit the simulation: another version, other options, another state at the tick at which it began, or
  /// a simulation that is not there yet. Of one that is past that tick, resumed from a checkpoint, acts of
  /// earlier ticks are in the state already.
  SessionReplay(const std::filesystem::path& file, const Simulation& simulation);
  ~SessionReplay();
  SessionReplay(const SessionReplay&) = delete;
  SessionReplay& operator=(const SessionReplay&) = delete;

  /// Does what was done when the simulation's tick had ended. Throws InputError, with file and line, for an
  /// act that is refused.
  void act(Simulation& simulation);
  /// The tick at which the session ended, where it says so.
  std::optional<std::uint64_t> end_tick() const;
  /// How many acts are still to be done.
  std::size_t left() const;
  const std::vector<std::string>& warnings() const;  ///< of the file, a line each

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe
