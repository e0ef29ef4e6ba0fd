#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace troupe::worldio {

/// An image of 8-bit RGBA pixels, row by row from the top.
struct Image {
  int width = 0;                   ///< width, pixels
  int height = 0;                  ///< height, pixels
  std::vector<std::uint8_t> rgba;  ///< red, green, blue and opacity of each pixel: 4 x width x height values
};

/// An image of 16-bit grey values, row by row from the top. In pictures of depth cameras, the values are
/// depths in mm.
struct DepthImage {
  int width = 0;                      ///< width, pixels
  int height = 0;                     ///< height, pixels
  std::vector<std::uint16_t> values;  ///< the grey values, width x height of them
};

/// Each of these functions writes an image to `file` as a PNG, of 8 bits per channel or of 16-bit grey
/// values. It writes under a temporary name in the same folder and renames the file when it is complete, or
/// writes directly into `file` if that is a device or a pipe. `text` holds pairs of a key (1 to 79 characters
/// of Latin-1) and a UTF-8 value. Each pair becomes a tEXt chunk of the PNG, or an iTXt chunk if the value is
/// not ASCII. Throws std::runtime_error with the path and the reason if the file cannot be written, if the
/// image has no pixels, if the number of its values does not match its size, or if libpng reports an error.
void write_png(const std::filesystem::path& file, const Image& image,
               const std::vector<std::pair<std::string, std::string>>& text = {});
void write_png(const std::filesystem::path& file, const DepthImage& image,
               const std::vector<std::pair<std::string, std::string>>& text = {});

}  // namespace troupe::worldio
