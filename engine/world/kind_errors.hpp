#pragma once

#include "engine/spec/body_type.hpp"

#include <span>
#include <string>
#include <utility>

namespace troupe::engine {

class World;

/// Returns a text about the exception that the calling catch block handles: `threw: TEXT`, where TEXT is
/// what() of a std::exception, or `threw an exception that is not a std::exception`. Outside a catch block
/// the call ends the program (std::terminate()).
std::string thrown_text();

/// Throws a StepError in place of the exception that the calling catch block handles. A StepError is the
/// exception with which a step of the world fails. Its text names the tick (time step), the kind whose
/// function threw, and a robot. A kind is a table of functions that implements one sort of controller, device
/// or drive. A DecisionError (engine/kinds/kinds.hpp) is an exception of a controller that contains the row
/// of a robot: the text then names that robot. For any other exception, the text names the robot of the first
/// row, and gives the number of rows if there are several. A StepError is rethrown unchanged, because its
/// text already names a robot. Outside a catch block the call ends the program (std::terminate()).
///
/// rows    rows (indices of bodies in the state tables) for which the function was called; empty: the text
/// names no robot
/// what    the controller, device or drive whose function was called
///@{
[[noreturn]] void throw_step_error(const World& world, std::span<const Row> rows,
                                   const BodyType::Controller& what);
[[noreturn]] void throw_step_error(const World& world, std::span<const Row> rows,
                                   const BodyType::Device& what);
[[noreturn]] void throw_step_error(const World& world, std::span<const Row> rows,
                                   const BodyType::Drive& what);
///@}

/// Returns the result of call(), which must call a function of the kind of `what` (a controller, device or
/// drive) for the given rows. If call() throws, throw_step_error() throws a StepError in place of the
/// exception, because the exception of a plug-in does not say for which robot and in which tick the function
/// was called.
template <class What, class Call>
auto call_kind(const World& world, std::span<const Row> rows, const What& what, Call&& call) {
  try {
    return std::forward<Call>(call)();
  } catch (...) {
    throw_step_error(world, rows, what);
  }
}

}  // namespace troupe::engine
