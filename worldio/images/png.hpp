#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace troupe::worldio {

/// An image of 8-bit RGBA pixels, row by row from the top.
struct Image {
  int width = 0;                   ///< pixels
  int height = 0;                  ///< pixels
  std::vector<std::uint8_t> rgba;  ///< red, green, blue and opacity of each pixel: 4 x width x height values
};

/// An image of 16-bit grey values, row by row from the top.
struct DepthImage {
  int width = 0;                      ///< pixels
  int height = 0;                     ///< pixels
  std::vector<std::uint16_t> values;  ///< the grey values, width x height of them
};

/// Write an image to `file` as a PNG, of 8 bits per channel or of 16-bit grey values. The functions write
/// under a temporary name in the same folder and rename the file when it is complete. `text` holds pairs of a
/// key and a UTF-8 value. Each pair becomes a tEXt chunk of the PNG, or an iTXt chunk if the value is not
/// ASCII. The functions throw std::runtime_error with the path and the reason if the file cannot be written,
/// if the image has no pixels, or if the number of its values does not match its size.
void write_png(const std::filesystem::path& file, const Image& image,
               const std::vector<std::pair<std::string, std::string>>& text = {});
void write_png(const std::filesystem::path& file, const DepthImage& image,
               const std::vector<std::pair<std::string, std::string>>& text = {});

}  // namespace troupe::worldio
