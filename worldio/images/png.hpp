#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
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

/// Writes an image to `file` as a PNG. The PNG has 8 bits per channel for an Image, and 16-bit grey values
/// for a DepthImage. The function writes a temporary file in the same folder and renames it when it is
/// complete. If `file` is a device or a pipe, the function writes directly into it.
///
/// `text` holds pairs of a key (1 to 79 characters of Latin-1) and a UTF-8 value. Each pair is stored as a
/// tEXt chunk of the PNG, or as an iTXt chunk if the value is not ASCII.
///
/// Throws std::runtime_error with a message such as `a.png: error: cannot be written: Is a directory` if
/// - the file cannot be written,
/// - the image has no pixels, or the number of its values does not match its size,
/// - libpng reports an error.
void write_png(const std::filesystem::path& file, const Image& image,
               const std::vector<std::pair<std::string, std::string>>& text = {});
void write_png(const std::filesystem::path& file, const DepthImage& image,
               const std::vector<std::pair<std::string, std::string>>& text = {});
/// Returns the bytes of the PNG that write_png() writes. Throws as write_png() does, but the message has only
/// the reason.
std::string encode_png(const Image& image, const std::vector<std::pair<std::string, std::string>>& text = {});

/// Returns what is wrong with the pixels of a PNG that has a palette: `a pixel has the palette index 5, but
/// the palette has 2 colours`, or the error of libpng. Empty if nothing is wrong, or if `bytes`, the content
/// of a file, is no PNG with a palette. Decodes all pixels, so check the size of the image before.
std::string palette_error(std::string_view bytes);

}  // namespace troupe::worldio
