#include "worldio/results/hdf5_file.hpp"

namespace troupe::worldio {

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

}  // namespace troupe::worldio
