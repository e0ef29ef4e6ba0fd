#pragma once

#include "engine/ranks/orders.hpp"

#include <cstdint>
#include <exception>
#include <functional>
#include <limits>
#include <string>

namespace troupe::engine {

/// The error of a sequence of numbered steps that several ranks carry out together. Ranks are threads or
/// processes that compute a world together. For example, the steps apply the effects of a tick: the actions
/// of devices on other bodies in one time step. Each step runs on one rank or on several ranks.
///
/// If a step throws, its rank cannot end the sequence at once, because the other ranks wait for messages from
/// this rank. The rank therefore only skips its steps with higher numbers. At the end of the sequence, all
/// ranks throw the error of the failed step with the lowest number.
class SharedError {
 public:
  /// Calls step(), unless a step with a lower number has failed on this rank. If step() throws a
  /// std::exception, catches and stores it. A step that runs on several ranks must have the same number on
  /// all of them.
  void attempt(std::uint64_t number, const std::function<void()>& step);
  /// Called on all ranks at the end of the sequence. If steps have failed, throws the error of the failed
  /// step with the lowest number. On a rank where this step has thrown, the error is the exception itself. On
  /// the other ranks, it is a StepError with the text of that exception. Afterwards the next sequence can
  /// begin.
  void agree(const RankPost& post);

 private:
  static constexpr std::uint64_t k_none = std::numeric_limits<std::uint64_t>::max();

  std::uint64_t failed_ = k_none;  // number of the step that failed on this rank
  std::string text_;
  std::exception_ptr error_;
};

}  // namespace troupe::engine
