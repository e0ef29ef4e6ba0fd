#pragma once

#include "engine/body_type.hpp"

#include <span>
#include <string>
#include <utility>

namespace troupe::engine {

class World;

/// What the exception that is being handled says: `threw: no map`, or that it is no std::exception. Only
/// within a handler.
std::string thrown_text();

/// Throws, in place of the exception that is being handled, a StepError that names the tick, what threw, and
/// the robot: the one that a DecisionError names, else the first of the rows. A StepError comes out as it is:
/// it names its robot itself. rows: for which the kind's function was called; empty: for none in particular.
///@{
[[noreturn]] void throw_step_error(const World& world, std::span<const Row> rows,
                                   const BodyType::Controller& what);
[[noreturn]] void throw_step_error(const World& world, std::span<const Row> rows,
                                   const BodyType::Device& what);
[[noreturn]] void throw_step_error(const World& world, std::span<const Row> rows,
                                   const BodyType::Drive& what);
///@}

/// call(), a function of the kind of a controller, a device or a drive: what it throws comes out as of
/// throw_step_error(). Kinds are written by users, and a plug-in's exception tells nothing of where it came
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
