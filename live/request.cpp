#include "live/request.hpp"

#include "base/diagnostics.hpp"
#include "troupe/acts.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace troupe::live {
namespace {

using Json = nlohmann::ordered_json;

/// The JSON text of a value of a request, for error messages, cut after 60 bytes.
std::string text_of_value(const Json& value) {
  constexpr std::size_t k_most_bytes = 60;
  const std::string text = value.dump(-1, ' ', true);  // ASCII, so it can be cut anywhere
  return text.size() <= k_most_bytes ? text : text.substr(0, k_most_bytes) + "...";
}

}  // namespace

Request::Request(const std::string& text) : json_(Json::parse(text)), what_(json_["do"].get<std::string>()) {}

double Request::number(const char* key, double least, double most) const {
  const Json value = json_.value(key, Json());
  if (!value.is_number() || !(value.get<double>() >= least && value.get<double>() <= most))
    throw ActRefused(fmt::format("\"{}\" must be a number from {} to {}, found {}", key, least, most,
                                 text_of_value(value)));
  return value.get<double>();
}

std::uint64_t Request::whole(const char* key, std::uint64_t least, std::uint64_t most) const {
  const Json value = json_.value(key, Json());
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() < least || value.get<std::uint64_t>() > most)
    throw ActRefused(fmt::format("\"{}\" must be a whole number from {} to {}, found {}", key, least, most,
                                 text_of_value(value)));
  return value.get<std::uint64_t>();
}

std::string Request::name(const char* key) const {
  const Json value = json_.value(key, Json());
  if (value.is_null()) return {};
  if (!value.is_string())
    throw ActRefused(fmt::format("\"{}\" must be a name, found {}", key, text_of_value(value)));
  return value.get<std::string>();
}

std::vector<std::string> Request::layers(const char* key, std::span<const std::string_view> known) const {
  const Json list = json_.value(key, Json());
  std::vector<std::string> names;
  if (!list.is_array())
    throw ActRefused(fmt::format("\"{}\" must be a list of names, found {}", key, text_of_value(list)));
  for (const Json& one : list) {
    const std::string name = one.is_string() ? one.get<std::string>() : "";
    if (std::ranges::find(known, name) == known.end())
      throw ActRefused(unknown_name("layer", name, {known.begin(), known.end()}));
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  return names;
}

}  // namespace troupe::live
