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

/// Writes a PNG beside its name and renames it when whole; `text` becomes tEXt chunks.
/// Throws std::runtime_error with the path and the reason when it cannot be written.
void write_png(const std::filesystem::path& file, const Image& image,
               const std::vector<std::pair<std::string, std::string>>& text = {});
void write_png(const std::filesystem::path& file, const DepthImage& image,
               const std::vector<std::pair<std::string, std::string>>& text = {});

}  // namespace troupe::worldio
