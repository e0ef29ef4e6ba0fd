#include "apps/stage_path.hpp"

#include <cstdlib>
#include <sstream>
#include <string>

namespace troupe::apps {

std::vector<std::filesystem::path> stage_path() {
  std::vector<std::filesystem::path> folders;
  const char* value = std::getenv("STAGEPATH");
  std::istringstream list(value ? value : "");
  for (std::string folder; std::getline(list, folder, ':');)
    if (!folder.empty()) folders.emplace_back(folder);
  return folders;
}

}  // namespace troupe::apps
