#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::live {

/// A request of a viewer: a JSON object. Its key `do` has the name of the request; the other keys are the
/// arguments. A function that returns an argument throws ActRefused, with a message for the viewer, if the
/// argument is missing or invalid.
class Request {
 public:
  /// text: a JSON object whose value of `do` is a text and whose value of `id` is missing or a number; the
  /// caller has checked this
  explicit Request(const std::string& text);

  const std::string& what() const { return what_; }  ///< the name of the request
  /// Whether the request has an argument that is not null.
  bool has(const char* key) const { return json_.contains(key) && !json_[key].is_null(); }
  /// The number that the answer repeats, so that the viewer can match answers to requests; 0: none.
  std::uint64_t id() const { return json_.value("id", std::uint64_t{0}); }
  /// Returns an argument that must be a number from `least` to `most`.
  double number(const char* key, double least, double most) const;
  /// Returns an argument that must be a whole number from `least` to `most`.
  std::uint64_t whole(const char* key, std::uint64_t least, std::uint64_t most) const;
  /// Returns an argument that must be a text. If it is null or missing, returns an empty text.
  std::string name(const char* key) const;
  /// Returns an argument that must be a list of layers of the picture, each one of `known`. The result has
  /// each layer once.
  std::vector<std::string> layers(const char* key, std::span<const std::string_view> known) const;

 private:
  nlohmann::ordered_json json_;
  std::string what_;
};

}  // namespace troupe::live
