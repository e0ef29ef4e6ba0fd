#pragma once

#include "base/result.hpp"
#include "engine/kinds/controller_kind.hpp"

namespace troupe::engine {

/// Checks what the hook `prepare` of a kind of device returned, so that a mistake in a kind is an error when
/// the world is built, and not memory that is overwritten during the run. Checks these rules:
/// - Fields of percepts and commands have unique names without "/". In a struct they are aligned, do not
///   overlap, and end within the size that the kind gives.
/// - Reach and hint for the cells are not negative or NaN, and the hint is finite. Power and poses of joints
///   are finite. There is one pose per joint, or none.
/// - A ranger has one bearing per range, and each of its fans has readings that exist.
/// - The command struct of a drive device is a Command, and its state has room for the Pose with which it
///   must begin.
/// - A kind with effects has the hook `act`, from which they must be emitted, and declares at most 1,000,000.
///
/// The text of the error continues the words `device "NAME"`.
Result<> check_prepared(const DeviceKind& kind, const DeviceKind::Prepared& prepared);

/// Checks the memory struct of a kind of controller (ControllerKind::memory and memory_bytes), by the rules
/// for the fields of percepts and commands. A kind with a memory must also give the size of its struct. The
/// text of the error continues the words `controller "NAME"`.
Result<> check_memory(const ControllerKind& kind);

}  // namespace troupe::engine
