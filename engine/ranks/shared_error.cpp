#include "engine/ranks/shared_error.hpp"

#include "base/diagnostics.hpp"
#include "engine/kinds/step_error.hpp"

#include <utility>

namespace troupe::engine {

void SharedError::attempt(std::uint64_t number, const std::function<void()>& step) {
  if (failed_ < number) return;
  try {
    step();
  } catch (const std::exception& thrown) {
    error_ = std::current_exception();
    failed_ = number;
    text_ = exception_text(thrown);
  }
}

/// The error of the first step that failed counts, because a single rank would have met this error. Errors of
/// later steps, on any rank, may be consequences of it.
void SharedError::agree(const RankPost& post) {
  partition::MessageWriter own = post.begin(Order::ended);
  own.put(failed_);
  own.put_text(text_);
  post.send_to_all(std::move(own));
  std::uint64_t first = std::exchange(failed_, k_none);
  std::string text = std::exchange(text_, {});
  std::exception_ptr error = std::exchange(error_, nullptr);
  post.receive_from_all(Order::ended, [&](unsigned, partition::MessageReader& message) {
    const auto number = message.get<std::uint64_t>();
    if (number >= first) return;
    first = number;
    text = message.get_text();
    error = nullptr;
  });
  if (error) std::rethrow_exception(error);
  if (first != k_none) throw StepError(text);
}

}  // namespace troupe::engine
