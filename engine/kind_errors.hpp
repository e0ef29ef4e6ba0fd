#pragma once

#include "engine/body_type.hpp"

#include <span>
#include <string>
#include <utility>

namespace troupe::engine {

class World;

/// Describes the exception that is being handled: `threw: TEXT` with the text of a std::exception, otherwise
/// that the exception is of another type. Call this only within a catch block.
std::string thrown_text();

/// Throws a StepError in place of the exception that is being handled. Its text names the tick, the kind
/// whose function threw, and a robot: that of a DecisionError, and otherwise that of the first row. A
/// StepError is rethrown unchanged, because it already names its robot.
///
/// rows: the rows for which the function of the kind was called; may be empty
/// what: the controller, device or drive whose kind has the function
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
