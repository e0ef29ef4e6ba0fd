#pragma once

#include <filesystem>
#include <string>

/// Where the sources and the build are. These are functions and no macros, so that no other object depends on
/// the folder in which it was compiled: ccache then finds it in every clone.
namespace troupe::test {

const std::filesystem::path& source_dir();  ///< the root of the repository
const std::filesystem::path& binary_dir();  ///< the root of the build
const std::string& program();               ///< the path of the program `troupe` of this build

}  // namespace troupe::test
