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

/// Throws a StepError in place of the exception that the calling catch block handles. The text of the
/// StepError names the tick, the kind whose function threw, and a robot. For a DecisionError
/// (engine/kinds/kinds.hpp), this is the robot that the DecisionError names. For any other exception, it is
/// the robot of the first row, and the text also gives the number of rows if there are several. A StepError
/// is rethrown unchanged, because its text already names a robot. Outside a catch block the call ends the
/// program (std::terminate()).
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
/// drive) for the given rows. If call() throws, throw_step_error() replaces the exception by a StepError,
/// because the exception of a plug-in does not say where it came from.
template <class What, class Call>
auto call_kind(const World& world, std::span<const Row> rows, const What& what, Call&& call) {
  try {
    return std::forward<Call>(call)();
  } catch (...) {
    throw_step_error(world, rows, what);
  }
}

}  // namespace troupe::engine
