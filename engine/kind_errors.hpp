#pragma once

#include "engine/body_type.hpp"

#include <span>
#include <string>
#include <utility>

namespace troupe::engine {

class World;

/// Returns a text about the exception that is being handled: `threw: TEXT`, where TEXT is what() of a
/// std::exception, or `threw an exception that is not a std::exception`. Call this only within a catch block.
std::string thrown_text();

/// Throws a StepError in place of the exception that is being handled. Its text names the tick, the kind
/// whose function threw, and a robot: the robot of a DecisionError, and for other exceptions the robot of the
/// first row. A StepError is rethrown unchanged, because its text already names a robot.
///
/// rows: the rows (indices of bodies in the state tables) for which the function of the kind was called; may
/// be empty what: the controller, device or drive whose function was called
///@{
[[noreturn]] void throw_step_error(const World& world, std::span<const Row> rows,
                                   const BodyType::Controller& what);
[[noreturn]] void throw_step_error(const World& world, std::span<const Row> rows,
                                   const BodyType::Device& what);
[[noreturn]] void throw_step_error(const World& world, std::span<const Row> rows,
                                   const BodyType::Drive& what);
///@}

/// Calls call(), which must call a function of the kind of `what` (a controller, device or drive), and
/// returns the result. If call() throws, throw_step_error() converts the exception: users write kinds, and
/// the exception of a plug-in does not say where it came from.
template <class What, class Call>
auto call_kind(const World& world, std::span<const Row> rows, const What& what, Call&& call) {
  try {
    return std::forward<Call>(call)();
  } catch (...) {
    throw_step_error(world, rows, what);
  }
}

}  // namespace troupe::engine
