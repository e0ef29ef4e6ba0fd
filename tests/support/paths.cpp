#include "tests/support/paths.hpp"

namespace troupe::test {

const std::filesystem::path& source_dir() {
  static const std::filesystem::path folder(TROUPE_SOURCE_DIR);
  return folder;
}

const std::filesystem::path& binary_dir() {
  static const std::filesystem::path folder(TROUPE_BINARY_DIR);
  return folder;
}

const std::string& program() {
  static const std::string file = (binary_dir() / "bin" / "troupe").string();
  return file;
}

}  // namespace troupe::test
