#pragma once

#include "engine/state/world_state.hpp"

#include <atomic>
#include <cstdint>
#include <span>

namespace troupe::engine {

/// What bodies do in the phase actuate, apart from the hook `act` of their devices: drives compute velocities
/// from commands, and drives and devices that are stopped halt.
class Actuation {
 public:
  /// Lowest id of the robots whose command, velocity or odometry is not finite.
  using Faulty = std::atomic<std::uint32_t>;

  /// `state` must outlive the object.
  explicit Actuation(WorldState& state) : state_(state) {}
  Actuation(const Actuation&) = delete;
  Actuation& operator=(const Actuation&) = delete;

  /// Calls a drive for rows of one type, at most k_row_block of them, and writes their velocities. Lowers
  /// `faulty` to the robots with a number that is not finite; if this is the command or the velocity, they
  /// keep their old velocities.
  void drive(std::span<const Row> rows, const BodyType::Drive& drive, Faulty& faulty);
  /// Throws StepError, which says what is wrong with this robot.
  [[noreturn]] void throw_faulty(BodyId robot) const;
  /// Sets the velocities of robots that are disabled or dropped out by a fault to 0, whatever their commands
  /// are, and those of their drive devices.
  void halt_disabled(std::span<const Row> rows, const BodyType& type);
  /// Sets the velocities of robots whose power supply is empty to 0, whatever their commands are.
  void halt_spent(std::span<const Row> rows, const BodyType::Drive& drive);
  /// Sets the velocity of a drive device to 0 for the enabled bodies whose device is broken or has no power.
  void halt_stopped(std::span<const Row> rows, const BodyType::Device& device);

 private:
  void halt(Row row, const BodyType::Device& device);
  bool store(Row row, const BodyType::Drive& drive, const Command& command, const Velocity& velocity);

  WorldState& state_;
};

}  // namespace troupe::engine
