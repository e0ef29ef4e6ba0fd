#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace troupe::worldio {

/// An image of 8-bit RGBA pixels, row by row from the top.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;
};

/// An image of 16-bit grey values, row by row from the top.
struct DepthImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint16_t> values;
};

/// Writes a PNG under a temporary name next to `file` and renames it when it is complete. `text` holds pairs
/// of a key and a value, which become tEXt chunks of the PNG, or iTXt chunks if the value is not ASCII.
/// Throws std::runtime_error with the path and the reason if the file cannot be written.
void write_png(const std::filesystem::path& file, const Image& image,
               const std::vector<std::pair<std::string, std::string>>& text = {});
void write_png(const std::filesystem::path& file, const DepthImage& image,
               const std::vector<std::pair<std::string, std::string>>& text = {});

}  // namespace troupe::worldio
