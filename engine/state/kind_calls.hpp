#pragma once

#include "engine/sensing/sensing_view.hpp"
#include "engine/spec/body_type.hpp"

#include <span>
#include <utility>

namespace troupe::engine {

/// Converts the exception that the calling catch block handles into a StepError, and throws it. A StepError
/// is the exception with which a step of the world fails. The handled exception is nested in it
/// (std::nested_exception), so that a language binding can find the exception of its own. It must come from a
/// function of a *kind*: a table of functions that implements one sort of controller, device or drive.
/// Outside a catch block the call ends the program (std::terminate()).
///
/// The text of the StepError names the tick (time step), the controller, device or drive, a robot, and the
/// exception. The robot depends on the exception:
/// - A DecisionError (engine/kinds/device_kind.hpp) contains the row of a robot. The text names that robot.
/// - A StepError already names a robot. It is thrown again unchanged.
/// - For any other exception, the text names the robot of the first row. If there are several rows, it also
///   gives their number.
///
/// rows    rows (indices of bodies in the state tables) for which the function was called; empty: the text
///         names no robot
/// what    the controller, device or drive whose function was called
///@{
[[noreturn]] void throw_step_error(const CommittedView& world, std::span<const Row> rows,
                                   const BodyType::Controller& what);
[[noreturn]] void throw_step_error(const CommittedView& world, std::span<const Row> rows,
                                   const BodyType::Device& what);
[[noreturn]] void throw_step_error(const CommittedView& world, std::span<const Row> rows,
                                   const BodyType::Drive& what);
///@}

/// Returns the result of call(). If call() throws, converts the exception as throw_step_error() does, so that
/// the error names the tick and the robot. `what` is a controller, a device or a drive. call() must call a
/// function of its kind for `rows`.
template <class What, class Call>
auto call_kind(const CommittedView& world, std::span<const Row> rows, const What& what, Call&& call) {
  try {
    return std::forward<Call>(call)();
  } catch (...) {
    throw_step_error(world, rows, what);
  }
}

/// Converts the exception that the calling catch block handles into a std::runtime_error, and throws it. The
/// exception must come from a hook of a device that is not a part of a step: DeviceKind::draw, energy or
/// flags. It is nested in the std::runtime_error, whose text names the tick, the device, the robot and the
/// exception. Outside a catch block the call ends the program (std::terminate()).
[[noreturn]] void throw_hook_error(const CommittedView& world, Row row, const BodyType::Device& what);

/// Returns the result of call(). If call() throws, converts the exception as throw_hook_error() does. call()
/// must call a hook of the kind of `what` for `row`.
template <class Call>
auto call_hook(const CommittedView& world, Row row, const BodyType::Device& what, Call&& call) {
  try {
    return std::forward<Call>(call)();
  } catch (...) {
    throw_hook_error(world, row, what);
  }
}

/// Returns the result of the hook DeviceKind::energy of a device, called as call_hook() does. The kind of the
/// device must have this hook.
Energy energy_of(const CommittedView& world, Row row, const BodyType::Device& device);

}  // namespace troupe::engine
