#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace troupe::worldio {

/// 8-bit RGBA, row 0 on top.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;
};

/// 16-bit grey, row 0 on top.
struct DepthImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint16_t> values;
};

/// Writes a PNG under a temporary name next to `file` and renames it when it is complete. `text` becomes tEXt
/// chunks, or iTXt chunks if it is not ASCII. Throws std::runtime_error with the path and the reason if it
/// cannot be written.
void write_png(const std::filesystem::path& file, const Image& image,
               const std::vector<std::pair<std::string, std::string>>& text = {});
void write_png(const std::filesystem::path& file, const DepthImage& image,
               const std::vector<std::pair<std::string, std::string>>& text = {});

}  // namespace troupe::worldio
