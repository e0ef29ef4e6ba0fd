#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace troupe {

/// The reason for a failure, as part of a sentence without a full stop. The text does not name the place in
/// the input: the caller that reports the error adds the file and the line (base/diagnostics.hpp).
struct Error {
  std::string text;  ///< for example "needs a radio"
};

/// A value, or an error that says why there is no value:
///
///     Result<Image> read_image(...);
///     if (const Result<Image> image = read_image(...))
///       show(*image);
///     else
///       diagnostics.error(where, image.error().text);
template <class T = void>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}      ///< a success, with this value
  Result(Error error) : value_(std::move(error)) {}  ///< a failure, for this reason

  explicit operator bool() const { return std::holds_alternative<T>(value_); }  ///< whether there is a value
  /// Returns the value. Throws std::bad_variant_access if there is none.
  ///@{
  const T& operator*() const& { return std::get<T>(value_); }
  T& operator*() & { return std::get<T>(value_); }
  T&& operator*() && { return std::get<T>(std::move(value_)); }
  const T* operator->() const { return &**this; }
  T* operator->() { return &**this; }
  ///@}
  /// Returns the error. Throws std::bad_variant_access if there is a value.
  const Error& error() const { return std::get<Error>(value_); }

 private:
  std::variant<T, Error> value_;
};

/// The result of a function that returns no value: success, written `return {};`, or an error.
///
///     if (const Result<> fits = check(...); !fits) return fits.error();
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;                                ///< a success
  Result(Error error) : error_(std::move(error)) {}  ///< a failure, for this reason

  explicit operator bool() const { return !error_; }  ///< true: a success; false: a failure
  /// Returns the error. Throws std::bad_optional_access after success.
  const Error& error() const { return error_.value(); }

 private:
  std::optional<Error> error_;
};

}  // namespace troupe
