#pragma once

#include "engine/body_type.hpp"

#include <span>
#include <string>
#include <utility>

namespace troupe::engine {

class World;

/// Text of the exception that is being handled: `threw: no map`, or that it is not a std::exception. Call
/// this only within a catch block.
std::string thrown_text();

/// Throws a StepError in place of the exception that is being handled. It names the tick, the kind whose
/// function threw, and the robot: that of a DecisionError, otherwise that of the first row. A StepError that
/// is being handled is rethrown unchanged, because it already names its robot.
///
/// rows: the rows for which the kind's function was called; may be empty
///@{
[[noreturn]] void throw_step_error(const World& world, std::span<const Row> rows,
                                   const BodyType::Controller& what);
[[noreturn]] void throw_step_error(const World& world, std::span<const Row> rows,
                                   const BodyType::Device& what);
[[noreturn]] void throw_step_error(const World& world, std::span<const Row> rows,
                                   const BodyType::Drive& what);
///@}

/// Calls call(), which calls a function of the kind of a controller, device or drive, and returns its result.
/// An exception is converted by throw_step_error(), because users write kinds, and the exception of a plug-in
/// does not say where it came from.
template <class What, class Call>
auto call_kind(const World& world, std::span<const Row> rows, const What& what, Call&& call) {
  try {
    return std::forward<Call>(call)();
  } catch (...) {
    throw_step_error(world, rows, what);
  }
}

}  // namespace troupe::engine
