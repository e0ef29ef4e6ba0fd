#include "worldio/results/hdf5_file.hpp"

#include <algorithm>
#include <array>

namespace troupe::worldio {
namespace {

struct NameCode {
  std::string_view text;
  char character;
};
constexpr std::array k_name_codes{NameCode{"%2F", '/'}, NameCode{"%25", '%'}, NameCode{"%00", '\0'},
                                  NameCode{"%2E", '.'}};

}  // namespace

std::string hdf5_name(std::string_view name) {
  if (name.empty()) return "%";
  if (name == "." || name == "..") return name == "." ? "%2E" : "%2E%2E";
  std::string step;
  for (const char c : name) {
    switch (c) {
      case '/': step += "%2F"; break;
      case '%': step += "%25"; break;
      case '\0': step += "%00"; break;
      default: step += c;
    }
  }
  return step;
}

std::string text_of_hdf5_name(std::string_view name) {
  if (name == "%") return {};
  std::string text;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const auto code = std::ranges::find(k_name_codes, name.substr(i, 3), &NameCode::text);
    text += code == k_name_codes.end() ? name[i] : code->character;
    if (code != k_name_codes.end()) i += code->text.size() - 1;
  }
  return text;
}

}  // namespace troupe::worldio
