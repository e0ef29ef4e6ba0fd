#pragma once

#include "engine/body_type.hpp"

#include <span>
#include <string>
#include <utility>

namespace troupe::engine {

class World;

/// Text of the exception that is being handled: `threw: no map`, or that it is not a std::exception. Call it
/// only within a handler.
std::string thrown_text();

/// Throws, in place of the exception that is being handled, a StepError that names the tick, the kind that
/// threw, and the robot: that of a DecisionError, else the first of the rows. A StepError is rethrown as it
/// is: it names its robot already. rows: those that the kind's function was called for; may be empty.
///@{
[[noreturn]] void throw_step_error(const World& world, std::span<const Row> rows,
                                   const BodyType::Controller& what);
[[noreturn]] void throw_step_error(const World& world, std::span<const Row> rows,
                                   const BodyType::Device& what);
[[noreturn]] void throw_step_error(const World& world, std::span<const Row> rows,
                                   const BodyType::Drive& what);
///@}

/// Calls call(), a function of the kind of a controller, device or drive. Converts its exceptions by
/// throw_step_error(): kinds are written by users, and the exception of a plug-in does not say where it came
/// from.
template <class What, class Call>
auto call_kind(const World& world, std::span<const Row> rows, const What& what, Call&& call) {
  try {
    return std::forward<Call>(call)();
  } catch (...) {
    throw_step_error(world, rows, what);
  }
}

}  // namespace troupe::engine
