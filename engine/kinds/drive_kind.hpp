#pragma once

#include "base/pose.hpp"
#include "base/result.hpp"
#include "engine/fields/fields.hpp"
#include "engine/kinds/commands.hpp"
#include "engine/kinds/localization.hpp"

#include <any>
#include <cstdint>
#include <span>
#include <string_view>

namespace troupe::engine {

struct LintView;  // engine/observing/lint_view.hpp

// The hooks of kinds: see DeviceKind.

/// The argument of the hook DriveKind::drive: robots of one type whose drives run in this tick. There may be
/// no robots. Entry i of each span belongs to robot i, but `estimates` may be empty.
struct DriveBatch {
  std::span<const Command> commands;  ///< the commands to the drives
  /// Output: the velocities that the drives produce from this tick on. If `estimates` is not empty, each
  /// entry contains on input the velocity that the drive computed last. If `estimates` is empty, the input
  /// has no meaning.
  std::span<Velocity> velocities;
  std::span<const Pose> estimates;  ///< estimated poses of the robots; empty if all commands are speeds
  double elapsed_s = 0;             ///< time from one run of these drives to the next, s
};

/// A kind of drive, which computes velocities from commands.
struct DriveKind {
  std::string_view name = {};  ///< name in files: "diff"
  std::string_view text = {};  ///< description in one sentence, which `troupe describe` prints
  FieldTable params = {};      ///< table of the parameters of a drive of this kind
  /// Compiles the parameters to the argument `data` of the other hooks. The hook must accept all parameters
  /// within the limits of `params`, because the engine calls it even if `check` returned an error. If this
  /// hook, `check` or one of those that compute settings throws, building the world reports an error at the
  /// position of the drive in the world file.
  std::any (*prepare)(const Record& params) = nullptr;
  /// Checks that the parameters are consistent. The error says which parameters are inconsistent, and why.
  Result<> (*check)(const Record& params) = nullptr;
  /// Computes the velocities of a batch from the commands, within the limits of the drive. If a computed
  /// velocity, or a command, is not finite, World::step() throws a StepError that names the robot.
  void (*drive)(const std::any& data, const DriveBatch& batch) = nullptr;
  /// Returns the velocity that a robot has until its drive runs for the first time. Null: 0. If it is not
  /// finite, making the world, or the birth of the robot, throws a StepError that names the robot.
  Velocity (*start)(const std::any& data) = nullptr;
  /// Hooks that compute settings from the parameters. The engine itself, not the kind, applies these
  /// settings.
  ///@{
  /// Returns how robots with this drive estimate their poses. The error says why the parameters are
  /// inconsistent. Null: the estimates are the true poses, world frame.
  Result<Localization> (*localization)(const Record& params) = nullptr;
  /// Returns the number of pushable bodies that a robot can push at once. The engine limits the number to the
  /// range from 0 to k_most_pushed. Null: 0.
  std::int64_t (*pushes)(const Record& params) = nullptr;
  /// Whether a robot whose motion is blocked may still turn on the spot (class Conflicts, `turning`). Null:
  /// no.
  bool (*turns_when_blocked)(const Record& params) = nullptr;
  /// Returns the highest speed that the limits of the drive allow, m/s. Null: unknown.
  double (*top_speed)(const Record& params) = nullptr;
  ///@}
  /// The same as DeviceKind::lint, for a drive.
  void (*lint)(const std::any& data, const LintView& view) = nullptr;
};

}  // namespace troupe::engine
