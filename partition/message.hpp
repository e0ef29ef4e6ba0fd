#pragma once

#include "base/geometry.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace troupe::partition {

/// The bytes of a message from one rank to another. Ranks are the threads or processes that compute one world
/// together. All ranks have the same processor architecture, so numbers are copied as they are in memory.
using Message = std::vector<std::byte>;

/// Appends values to a message.
class MessageWriter {
 public:
  /// Appends the bytes of a number or of a struct without pointers.
  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    put_bytes(std::as_bytes(std::span(&value, 1)));
  }
  /// Appends bytes without their number. The code that reads the message must know how many bytes to read.
  void put_bytes(std::span<const std::byte> bytes) {
    message_.insert(message_.end(), bytes.begin(), bytes.end());
  }
  /// Appends elements: their number (64 bits), then their bytes.
  template <class T>
  void put_all(std::span<const T> all) {
    static_assert(std::is_trivially_copyable_v<T>);
    put(static_cast<std::uint64_t>(all.size()));
    put_bytes(std::as_bytes(all));
  }
  /// Appends a text: its length in bytes (64 bits), then its characters.
  void put_text(std::string_view text) {
    put(static_cast<std::uint64_t>(text.size()));
    put_bytes(std::as_bytes(std::span(text)));
  }
  /// Appends a point: its x and its y.
  void put_point(const Vec2& point) {
    put(point.x());
    put(point.y());
  }
  void reserve(std::size_t bytes) { message_.reserve(bytes); }  ///< allocates room for a whole message
  std::size_t size() const { return message_.size(); }          ///< length so far, bytes
  Message take() { return std::move(message_); }                ///< moves the message out; size() is then 0

 private:
  Message message_;
};

/// Reads values from a message, in the order in which a MessageWriter appended them. The functions whose
/// names begin with `get` throw std::logic_error if the message has fewer bytes left than they read, before
/// they allocate memory. The message must outlive this object.
class MessageReader {
 public:
  MessageReader() = default;  ///< reads an empty message
  explicit MessageReader(std::span<const std::byte> message) : rest_(message) {}

  /// Reads a value that put() appended; T must be the same type.
  template <class T>
  T get() {
    static_assert(std::is_trivially_copyable_v<T>);
    if constexpr (std::is_same_v<T, bool>) {
      return get<std::uint8_t>() != 0;  // a bool must not have any other value than 0 and 1
    } else {
      T value;
      get_bytes(std::as_writable_bytes(std::span(&value, 1)));
      return value;
    }
  }
  /// Reads a number, or an id with a member index(), that put() appended; T must be the same type. Throws
  /// std::logic_error unless it is below `end`, so the caller may use it as an index of `end` elements.
  template <class T>
  T get_below(std::size_t end) {
    const T value = get<T>();
    if constexpr (std::is_integral_v<T>)
      require(value < end);
    else
      require(value.index() < end);
    return value;
  }
  /// Throws std::logic_error if an index that was read from a message, as a part of a struct, is out of
  /// range.
  static void require(bool is_in_range) {
    if (!is_in_range)
      throw std::logic_error(
          "internal error: a message between ranks refers to a body, or to another object, that does not "
          "exist; this is no error of your input: please report it");
  }
  /// Reads a number of elements (64 bits). The elements follow in the message, each with at least
  /// `bytes_each` bytes (not 0). Throws std::logic_error if the rest of the message is too short for them, so
  /// the caller may allocate memory for so many elements.
  std::size_t get_count(std::size_t bytes_each) {
    const auto count = get<std::uint64_t>();
    if (count > rest_.size() / bytes_each) throw_too_short();
    return static_cast<std::size_t>(count);
  }
  /// Reads elements that put_all() appended; T must be the same type.
  template <class T>
  std::vector<T> get_all() {
    std::vector<T> all(get_count(sizeof(T)));
    get_bytes(std::as_writable_bytes(std::span(all)));
    return all;
  }
  /// Fills the whole span `bytes` with the next bytes of the message.
  void get_bytes(std::span<std::byte> bytes) {
    const std::span<const std::byte> from = take(bytes.size());
    if (!from.empty()) std::memcpy(bytes.data(), from.data(), from.size());
  }
  /// Reads a text that put_text() appended.
  std::string get_text() {
    const std::span<const std::byte> text = take(get<std::uint64_t>());
    return {reinterpret_cast<const char*>(text.data()), text.size()};
  }
  /// Reads a point that put_point() appended.
  Vec2 get_point() {
    const auto x = get<double>();
    return {x, get<double>()};
  }
  bool is_done() const { return rest_.empty(); }  ///< whether all bytes have been read

 private:
  [[noreturn]] static void throw_too_short() {
    throw std::logic_error(
        "internal error: a message between ranks is too short; this is no error of your input: please report "
        "it");
  }
  std::span<const std::byte> take(std::size_t bytes) {
    if (bytes > rest_.size()) throw_too_short();
    const std::span<const std::byte> taken = rest_.first(bytes);
    rest_ = rest_.subspan(bytes);
    return taken;
  }

  std::span<const std::byte> rest_;
};

}  // namespace troupe::partition
