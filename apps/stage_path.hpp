#pragma once

#include <filesystem>
#include <vector>

namespace troupe::apps {

/// The folders of STAGEPATH, as Stage's users have them: separated by colons.
std::vector<std::filesystem::path> stage_path();

}  // namespace troupe::apps
