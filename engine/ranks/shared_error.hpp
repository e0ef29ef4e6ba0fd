#pragma once

#include "engine/ranks/orders.hpp"

#include <cstdint>
#include <exception>
#include <functional>
#include <limits>
#include <string>

namespace troupe::engine {

/// The error of a sequence of steps that several ranks (threads or processes that compute a world together)
/// carry out in turn, or each for its own bodies. An example: applying the effects of a tick (actions of
/// devices on other bodies in a time step). Each step has a number. A rank cannot end the sequence when one
/// of its steps throws, because the other ranks wait for its messages. Instead, the rank leaves out its steps
/// with higher numbers, and at the end of the sequence all ranks throw the error of the first step that
/// failed.
class SharedError {
 public:
  /// Calls step(), unless a step with a lower number has failed on this rank. Catches any std::exception.
  /// Equal numbers on several ranks are one step.
  void attempt(std::uint64_t number, const std::function<void()>& step);
  /// Called on all ranks at the end of the sequence. If a step has failed, throws the error of the one with
  /// the lowest number: the exception itself on a rank where it was thrown, otherwise a StepError with its
  /// text. The next sequence can then begin.
  void agree(const RankPost& post);

 private:
  static constexpr std::uint64_t k_none = std::numeric_limits<std::uint64_t>::max();

  std::uint64_t failed_ = k_none;  // number of the step that failed on this rank
  std::string text_;
  std::exception_ptr error_;
};

}  // namespace troupe::engine
