#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace troupe::worldio {

/// An image of 8-bit RGBA pixels, row by row from the top.
struct Image {
  int width = 0;   ///< pixels
  int height = 0;  ///< pixels
  std::vector<std::uint8_t> rgba;
};

/// An image of 16-bit grey values, row by row from the top.
struct DepthImage {
  int width = 0;   ///< pixels
  int height = 0;  ///< pixels
  std::vector<std::uint16_t> values;
};

/// Writes an image to `file` as a PNG. It writes under a temporary name in the same folder and renames the
/// file when it is complete. `text` holds pairs of a key and a value. They become tEXt chunks of the PNG, or
/// iTXt chunks if the value is not ASCII. Throws std::runtime_error with the path and the reason if the file
/// cannot be written.
void write_png(const std::filesystem::path& file, const Image& image,
               const std::vector<std::pair<std::string, std::string>>& text = {});
void write_png(const std::filesystem::path& file, const DepthImage& image,
               const std::vector<std::pair<std::string, std::string>>& text = {});

}  // namespace troupe::worldio
