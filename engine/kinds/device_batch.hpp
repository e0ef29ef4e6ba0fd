#pragma once

#include "base/geometry.hpp"
#include "base/ids.hpp"
#include "base/pose.hpp"
#include "base/random.hpp"
#include "engine/fields/state_table.hpp"
#include "engine/kinds/commands.hpp"
#include "engine/kinds/effects.hpp"
#include "engine/kinds/mount.hpp"

#include <any>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace troupe::engine {

class CommittedView;
class Links;
class SensingView;

/// Throws std::out_of_range with a message for the author of a controller or device: it used the robot with
/// the index `index` of a batch of `count` robots (DeviceBatch, DecideBatch).
[[noreturn]] void throw_no_robot(std::size_t index, std::size_t count);

/// The argument of the hooks `sense`, `act` and `joints_moved` of a device kind: rows (bodies) of one type
/// for which the hook is called in a tick, with the data of these rows. There is at least one row. The
/// argument `i` of the functions is an index into `rows`. The class of `view`, by which a hook reads the
/// world, is declared in engine/sensing/sensing_view.hpp.
struct DeviceBatch {
  const SensingView& view;     ///< gives access to constants of the world and to the places of all bodies
  const std::any& data;        ///< the compiled parameters of the device (DeviceKind::Prepared::data)
  std::span<const Row> rows;   ///< rows of the batch; all of one type
  StateTable& state;           ///< state of the device, by slot; hooks may write only to the slots of `rows`
  const StateTable* commands;  ///< commands from controllers, by slot; null if the kind takes none
  Effects& effects;            ///< receives the effects of the device: see emit()
  Links& links;                ///< receives the poses to which joints shall move: see move_joint()
  std::uint32_t device = 0;    ///< index of the device within the type
  std::uint32_t stream = 0;    ///< number of the device's random stream: see random()
  /// Period of the device, rounded up to whole ticks, s. The time from one run of the device to the next is
  /// equal to this period, or longer if the device was switched off, broken or without power in between.
  double period_s = 0;

  /// Row i of the batch. Throws std::out_of_range if i is not below the number of rows, as all functions
  /// below do that have an argument `i`.
  Row row(std::size_t i) const {
    if (i >= rows.size()) throw_no_robot(i, rows.size());
    return rows[i];
  }
  BodyId body(std::size_t i) const;       ///< id of the row's body
  std::size_t slot(std::size_t i) const;  ///< index of the row in `state` and `commands`
  /// The random numbers of a row in this tick: a function of the seed of the world, `stream`, the id of the
  /// body and the tick. Each call returns the same sequence from its beginning.
  Random random(std::size_t i) const;
  /// The random numbers of a row in this tick, from a stream that `name` selects. They are independent of the
  /// numbers of random(i). For example, a kind that adds noise to the readings of another kind draws from a
  /// stream of its own: the other kind then gets the same random numbers as without the noise.
  Random random(std::size_t i, std::string_view name) const;
  /// Transform that gives the present pose of the device of row i in the world frame: compose(mount(i), p).
  /// Here, p is the argument `pose_body_device` of DeviceKind::prepare: the pose of the device in the body
  /// frame, with all joints at rest. For a device on no joint, the transform is the pose of the body. For a
  /// device on a joint, it also contains the present displacement of the joint from rest.
  Mount mount(std::size_t i) const;
  /// Velocity that the drive of the row's body computed last, body frame, m/s and rad/s. If a fault slows
  /// down the drive, this is the reduced velocity. It is 0 if the body has no drive or the drive has no
  /// power. The drives run before the hook `act`: if the drive is due in this tick, `act` gets the new
  /// velocity.
  const Velocity& velocity(std::size_t i) const;
  /// Command to the drive of the row's body. The numbers have no meaning if the body has no drive.
  const Command& command(std::size_t i) const;
  /// Whether a device of the row's body is in use. A device is in use if a controller uses it, if the world
  /// file makes it active (BodyType::Device::active), or if a program called World::subscribe() for the body.
  /// Here and below, `its_device` is the index of the device in BodyType::devices; std::out_of_range is
  /// thrown if there is no such device.
  bool senses(std::size_t i, std::size_t its_device) const;
  /// Whether a device of the row's body is switched on. A device is on unless a controller has switched it
  /// off.
  bool is_on(std::size_t i, std::size_t its_device) const;
  /// Whether a device of the row's body runs in the ticks in which it is due (once per period). The device
  /// runs if senses() and is_on() are true, no fault has broken it, it has power, and its body is neither
  /// disabled nor stopped by a fault.
  bool runs(std::size_t i, std::size_t its_device) const;
  /// State table of the device `its_device` of the bodies of this type. The state of row i of the batch is in
  /// row slot(i) of the table. A hook may read only the states of rows of the batch.
  const StateTable& percepts(std::size_t its_device) const;
  /// Present pose of joint n relative to its rest pose, m and rad. Here and below, joint n is the joint with
  /// the index n in DeviceKind::joints. The four functions throw StepError if the kind has no joint n.
  const Pose& joint(std::size_t i, std::size_t n) const;
  /// Sets the goal of joint n for this tick: a pose relative to the rest pose of the joint, m and rad. The
  /// heading is not wrapped. A second call in the same tick replaces the goal. Only the hook `act` may call
  /// this. Throws StepError if a number of `to` is not finite.
  ///
  /// After the bodies have moved, the joints of the device move to their goals together. If an obstacle
  /// blocks one of these joints, none of them moves. A blocked motion can also stop joints of bodies that
  /// this body carries, or of bodies that carry it: see Links::resolve_joints().
  void move_joint(std::size_t i, std::size_t n, const Pose& to) const;
  /// Whether the hook `act` set a goal of joint n with move_joint() in this tick. Only the hook
  /// `joints_moved` may call this.
  bool asked_joint(std::size_t i, std::size_t n) const;
  /// Whether joint n is at its goal of this tick. The result is also true if the joint already was at the
  /// goal. It is false if the joint has no goal. Only the hook `joints_moved` may call this.
  bool moved_joint(std::size_t i, std::size_t n) const;
  /// Emits an effect of row i: a record of an action of the device on a body. After all bodies have moved,
  /// the hook DeviceKind::apply applies the effect. Only the hook `act` may call this. Throws
  /// std::length_error if all devices of the world together emit more effects in a tick than their kinds
  /// declare (DeviceKind::Prepared::most_effects). World::step() throws a StepError if there is no body with
  /// the id `target`, or if the kind has no hook `apply`.
  ///
  /// sequence: number that orders the effects of the device of one body in a tick; each of these effects must
  /// have a different number
  /// verb, payload: the kind defines their meaning; the verb must be neither k_birth nor k_death
  /// target: the affected body; not valid() if there is none. It may be a static body, which has no row
  void emit(std::size_t i, std::uint32_t sequence, std::uint32_t verb, BodyId target,
            const std::array<double, 4>& payload = {}) const {
    effects.emit({body(i), device, sequence, verb, target, payload});
  }
  /// Requests the birth of the next body of a reserve. Only the hook `act` may call this. The birth comes
  /// after all other effects and all deaths of the tick. Then the hook DeviceKind::born receives the result,
  /// which says whether a body was born. If the body of row i dies in this tick, there is no birth, and
  /// `born` is not called.
  ///
  /// The request counts as an effect: std::length_error is thrown as in emit(). World::step() throws a
  /// StepError if the reserve does not exist.
  ///
  /// sequence: as in emit(); each effect of the device of one body in a tick must have a different number
  /// reserve: index into WorldSpec::reserves; must exist
  /// at: pose at birth, world frame, m and rad
  void emit_birth(std::size_t i, std::uint32_t sequence, std::uint32_t reserve, const Pose& at) const {
    effects.emit({body(i), device, sequence, k_birth, BodyId(), {at.x, at.y, at.z, at.heading}, reserve});
  }
  /// Requests the death of the body `whose`. Only the hook `act` may call this. The hook `prepare` of the
  /// kind must have set DeviceKind::Prepared::ends_lives. Nothing happens if the body is static or is not in
  /// the world. The request counts as an effect: std::length_error is thrown as in emit().
  ///
  /// sequence: as in emit(); each effect of the device of one body in a tick must have a different number
  void emit_death(std::size_t i, std::uint32_t sequence, BodyId whose) const {
    effects.emit({body(i), device, sequence, k_death, whose});
  }
};

/// The argument of the hook `sense`. In addition to the data of a DeviceBatch, it gives access to the
/// velocities, commands and device states of all bodies at the end of the last tick, except the states of
/// sensors, which other threads are writing. If a class C does not read these additional data, it may declare
/// `sense(const DeviceBatch&)`: make_device_kind() accepts both.
struct SenseBatch : DeviceBatch {
  /// View of the same world as `view`. It also gives access to the velocities, commands and device states of
  /// all bodies. The states of sensors must not be read.
  const CommittedView& committed;
};

}  // namespace troupe::engine
