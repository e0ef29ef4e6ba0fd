#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace troupe {

/// Why something cannot be done: part of a sentence, without the place that it is about and without a full
/// stop. Who reports it adds the place (base/diagnostics.hpp).
struct Error {
  std::string text;  ///< "needs a radio"
};

/// A value, or the error that kept it from being made:
///
///     Result<Image> read_image(...);
///     if (const Result<Image> image = read_image(...))
///       show(*image);
///     else
///       diagnostics.error(where, image.error().text);
template <class T = void>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}      ///< a value
  Result(Error error) : value_(std::move(error)) {}  ///< why there is none

  explicit operator bool() const { return std::holds_alternative<T>(value_); }  ///< whether there is a value
  /// The value. Throws std::bad_variant_access where there is none.
  ///@{
  const T& operator*() const& { return std::get<T>(value_); }
  T& operator*() & { return std::get<T>(value_); }
  T&& operator*() && { return std::get<T>(std::move(value_)); }
  const T* operator->() const { return &**this; }
  T* operator->() { return &**this; }
  ///@}
  /// What went wrong. Throws std::bad_variant_access where there is a value.
  const Error& error() const { return std::get<Error>(value_); }

 private:
  std::variant<T, Error> value_;
};

/// Of a check, or of what makes no value: done, as `return {};` says, or the error that prevented it.
///
///     if (const Result<> fits = check(...); !fits) return fits.error();
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;                                ///< all is well
  Result(Error error) : error_(std::move(error)) {}  ///< why it cannot be done

  explicit operator bool() const { return !error_; }  ///< whether all is well
  /// What went wrong. Throws std::bad_optional_access where all is well.
  const Error& error() const { return error_.value(); }

 private:
  std::optional<Error> error_;
};

}  // namespace troupe
