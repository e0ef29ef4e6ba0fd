#include "engine/world/actuation.hpp"

#include "base/atomic_extremes.hpp"
#include "engine/kinds/finite.hpp"
#include "engine/kinds/localization.hpp"
#include "engine/kinds/step_error.hpp"
#include "engine/state/batches.hpp"
#include "engine/state/kind_calls.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>

namespace troupe::engine {
namespace {

/// Returns what is wrong with a command that is_command() rejects. Continues the words `robot "NAME" was
/// commanded`.
std::string_view wrong_command_text(ControlMode mode) {
  switch (mode) {
    case ControlMode::velocity: break;
    case ControlMode::acceleration: return "an acceleration that is not a finite number";
    case ControlMode::position: return "to drive to a goal pose that is not finite";
    default: return "in a mode that is no value of ControlMode";
  }
  return "a speed that is not a finite number";
}

bool is_command(const Command& command) {
  return is_finite(command) && static_cast<std::size_t>(command.mode) < k_control_modes;
}

Velocity scaled(const Velocity& v, double by) { return {v.x * by, v.y * by, v.turn * by}; }

/// Whether the odometry estimate of a robot stays finite if the robot turns by `turn`, rad, in a tick. True
/// if the robot has no odometry. Other motions cannot make the estimate infinite, because they end within the
/// bounds of the world.
bool keeps_odometry_finite(const WorldState& state, Row row, const BodyType::Drive& drive, double turn) {
  constexpr double k_large = 1e300;  // rad: with smaller turns, no error that is allowed has this effect
  return !drive.odometry_table || std::abs(turn) < k_large ||
         std::isfinite(turn *
                       (1 + drive.localization.error_of(state.spec.seed, state.bodies[row.index()]).turn));
}

}  // namespace

void Actuation::drive(std::span<const Row> rows, const BodyType::Drive& drive, Faulty& faulty) {
  std::array<Command, k_row_block> commands;
  std::array<Velocity, k_row_block> velocities;
  std::array<Pose, k_row_block> estimates;
  bool speeds_only = true;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    commands[i] = state_.as<Command>(WorldState::k_command)[rows[i].index()];
    speeds_only = speeds_only && commands[i].mode == ControlMode::velocity;
  }
  const bool has_slow = state_.now.impaired > 0;
  DriveBatch batch{.commands = {commands.data(), rows.size()},
                   .velocities = {velocities.data(), rows.size()},
                   .estimates = {},
                   .elapsed_s = static_cast<double>(drive.period) * state_.spec.tick_s};
  if (!speeds_only && !rows.empty()) {
    const Estimates all = state_.view.estimates(state_.type(rows.front()));
    batch.estimates = {estimates.data(), rows.size()};
    for (std::size_t i = 0; i < rows.size(); ++i) {
      velocities[i] = state_.as<Velocity>(WorldState::k_velocity)[rows[i].index()];
      if (has_slow) velocities[i] = scaled(velocities[i], 1 / state_.condition(rows[i]).scale());
      estimates[i] = all.of(rows[i], state_.slots[rows[i].index()]);
    }
  }
  call_kind(state_.view, rows, drive, [&] { drive.kind->drive(drive.data, batch); });
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double scale = has_slow ? state_.condition(rows[i]).scale() : 1;
    // A command is tested too: a drive may clamp an infinite one.
    const Velocity velocity = has_slow ? scaled(velocities[i], scale) : velocities[i];
    if (!store(rows[i], drive, commands[i], velocity)) lower_to(faulty, state_.bodies[rows[i].index()].value);
  }
}

/// Stores the velocity of a robot, if it and the command are finite. Returns whether they are, and the
/// odometry estimate also stays finite.
bool Actuation::store(Row row, const BodyType::Drive& drive, const Command& command, const Velocity& v) {
  const Velocity motion = scaled(v, state_.spec.tick_s);
  if (!is_command(command) || !is_finite(motion)) return false;
  // + 0.0 turns -0 into 0, so that equal velocities have equal bits.
  state_.as<Velocity>(WorldState::k_velocity)[row.index()] = {v.x + 0.0, v.y + 0.0, v.turn + 0.0};
  return keeps_odometry_finite(state_, row, drive, motion.turn);
}

void Actuation::throw_faulty(BodyId robot) const {
  const Row row = state_.view.row(robot);
  const Command& command = state_.view.command(row);
  const double turn = state_.view.velocity(row).turn * state_.spec.tick_s;
  const std::string& name = state_.spec.name(robot);
  const std::string wrong =
      !is_command(command)
          ? fmt::format("robot \"{}\" was commanded {}", name, wrong_command_text(command.mode))
      : !keeps_odometry_finite(state_, row, *state_.type(row).drive, turn)
          ? fmt::format(
                "the odometry of robot \"{}\" computed a heading that is not a finite number, from a "
                "turn of {:g} rad in a tick and the error of the turn in `odom_error`",
                name, turn)
          : fmt::format("the drive of robot \"{}\" computed a velocity that is not a finite number", name);
  throw StepError(fmt::format("tick {}: {}", state_.now.tick, wrong), robot);
}

void Actuation::halt_disabled(std::span<const Row> rows, const BodyType& type) {
  for (const Row row : rows) {
    if (state_.condition(row).out == 0) continue;
    state_.as<Velocity>(WorldState::k_velocity)[row.index()] = {};
    for (const BodyType::Device& device : type.devices)
      if (device.kind->halt) halt(row, device);
  }
}

void Actuation::halt_spent(std::span<const Row> rows, const BodyType::Drive& drive) {
  for (const Row row : rows)
    if (!state_.view.is_supplied(row, drive.supply))
      state_.as<Velocity>(WorldState::k_velocity)[row.index()] = {};
}

void Actuation::halt_stopped(std::span<const Row> rows, const BodyType::Device& device) {
  for (const Row row : rows)
    if (!state_.view.works(row, device) || !state_.view.is_supplied(row, device.supply)) halt(row, device);
}

void Actuation::halt(Row row, const BodyType::Device& device) {
  call_kind(state_.view, {&row, 1}, device,
            [&] { device.kind->halt(state_.tables[device.table], state_.slots[row.index()]); });
}

}  // namespace troupe::engine
