#include "worldio/images/png.hpp"

#include "worldio/files.hpp"
#include "worldio/whole_file.hpp"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <new>
#include <span>
#include <stdexcept>
#include <system_error>

namespace troupe::worldio {
namespace {

using Message = std::array<char, 128>;

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  auto& text = *static_cast<Message*>(png_get_error_ptr(png));
  std::snprintf(text.data(), text.size(), "%s", message);
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

void append(png_structp png, png_bytep data, std::size_t size) {
  try {
    static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(data), size);
  } catch (const std::bad_alloc&) {
    png_error(png, "out of memory");
  }
}

/// The pixels of an image, row by row from the top, in the byte layout that libpng expects.
struct Rows {
  int width;
  int height;
  std::span<const std::uint8_t> bytes;
  int color_type;
  int bits;                 // bits per channel
  std::size_t pixel_bytes;  // bytes per pixel, all channels together
};

/// Encodes the image as a PNG with `texts` as its text chunks. Returns false if libpng reports an error,
/// which it does by longjmp(). No local variable may have a destructor, because the jump would skip it.
bool encode_rows(png_structp png, png_infop info, const Rows& image, std::vector<png_text>& texts) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height),
               image.bits, image.color_type, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  if (!texts.empty()) png_set_text(png, info, texts.data(), static_cast<int>(texts.size()));
  png_write_info(png, info);
  const std::size_t stride = image.pixel_bytes * static_cast<std::size_t>(image.width);
  for (int row = 0; row < image.height; ++row) png_write_row(png, image.bytes.data() + stride * row);
  png_write_end(png, info);
  return true;
}

std::string encode(const Rows& image, const std::vector<std::pair<std::string, std::string>>& text) {
  if (image.width < 1 || image.height < 1 ||
      image.bytes.size() != image.pixel_bytes * static_cast<std::size_t>(image.width) * image.height) {
    throw std::runtime_error(
        fmt::format("the image has {} x {} pixels and {} bytes; expected at least 1 x 1 pixels and "
                    "exactly {} bytes per pixel",
                    image.width, image.height, image.bytes.size(), image.pixel_bytes));
  }
  std::vector<png_text> texts;
  for (const auto& [key, value] : text) {
    // tEXt is Latin-1. Text beyond ASCII is UTF-8, which needs iTXt.
    const bool ascii = std::ranges::all_of(value, [](char c) { return static_cast<unsigned char>(c) < 128; });
    png_text entry{};
    entry.compression = ascii ? PNG_TEXT_COMPRESSION_NONE : PNG_ITXT_COMPRESSION_NONE;
    entry.key = const_cast<png_charp>(key.c_str());
    entry.text = const_cast<png_charp>(value.c_str());
    entry.text_length = value.size();
    texts.push_back(entry);
  }
  Message message{};
  std::string bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &message, on_error, on_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  if (info) png_set_write_fn(png, &bytes, append, nullptr);
  const bool whole = info && encode_rows(png, info, image, texts);
  png_destroy_write_struct(&png, &info);
  if (!whole) throw std::runtime_error(fmt::format("libpng: {}", message.data()));
  return bytes;
}

void take_png_bytes(png_structp png, png_bytep data, std::size_t size) {
  auto& rest = *static_cast<std::string_view*>(png_get_io_ptr(png));
  if (size > rest.size()) png_error(png, "the file is cut off");
  std::memcpy(data, rest.data(), size);
  rest.remove_prefix(size);
}

struct PaletteIndices {
  std::vector<std::uint8_t> row;  // one byte per pixel, of the row that was read last
  int largest = 0;
  int colors = 0;  // number of colours in the palette
};

/// Reads all palette indices. Not inlined into the function with setjmp(), so that none of the variables is
/// live there. No local variable may have a destructor, see encode_rows().
[[gnu::noinline]] void read_palette_rows(png_structp png, png_infop info, PaletteIndices& indices) {
  // The caller has limited the size of the image and of the file. Only the chunks of the pixels are unpacked.
  png_set_user_limits(png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
  png_set_chunk_malloc_max(png, 0);
  png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
  png_read_info(png, info);
  png_set_packing(png);
  const int passes = png_set_interlace_handling(png);
  png_read_update_info(png, info);
  png_colorp palette = nullptr;
  png_get_PLTE(png, info, &palette, &indices.colors);
  const png_uint_32 rows = png_get_image_height(png, info);
  for (int pass = 0; pass < passes; ++pass)
    for (png_uint_32 row = 0; row < rows; ++row) {
      // A pass of an interlaced image sets only some of the pixels.
      indices.row.assign(png_get_rowbytes(png, info), 0);
      png_read_row(png, indices.row.data(), nullptr);
      indices.largest = std::max(indices.largest, int{*std::ranges::max_element(indices.row)});
    }
}

/// Reads all palette indices. Returns false if libpng reports an error.
bool read_palette_indices(png_structp png, png_infop info, PaletteIndices& indices) {
  if (setjmp(png_jmpbuf(png))) return false;
  read_palette_rows(png, info, indices);
  return true;
}

Rows rows_of(const Image& image) {
  return {image.width, image.height, image.rgba, PNG_COLOR_TYPE_RGB_ALPHA, 8, 4};
}

void write_rows(const std::filesystem::path& file, const Rows& image,
                const std::vector<std::pair<std::string, std::string>>& text) {
  try {
    write_whole(file, {encode(image, text)});
  } catch (const std::system_error& error) {
    throw std::runtime_error(fmt::format("{}: error: cannot be written: {}", file.string(),
                                         write_failure(file, error.code().message())));
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format("{}: error: cannot be written: {}", file.string(), error.what()));
  }
}

}  // namespace

void write_png(const std::filesystem::path& file, const Image& image,
               const std::vector<std::pair<std::string, std::string>>& text) {
  write_rows(file, rows_of(image), text);
}

void write_png(const std::filesystem::path& file, const DepthImage& image,
               const std::vector<std::pair<std::string, std::string>>& text) {
  std::vector<std::uint8_t> bytes;  // big-endian
  bytes.reserve(2 * image.values.size());
  for (const std::uint16_t value : image.values) {
    bytes.push_back(static_cast<std::uint8_t>(value >> 8));
    bytes.push_back(static_cast<std::uint8_t>(value & 0xff));
  }
  write_rows(file, {image.width, image.height, bytes, PNG_COLOR_TYPE_GRAY, 16, 2}, text);
}

std::string encode_png(const Image& image, const std::vector<std::pair<std::string, std::string>>& text) {
  return encode(rows_of(image), text);
}

std::string palette_error(std::string_view bytes) {
  constexpr std::size_t k_color_type = 25;  // offset in the file
  if (!bytes.starts_with("\x89PNG\r\n\x1a\n") || bytes.size() <= k_color_type ||
      bytes[k_color_type] != PNG_COLOR_TYPE_PALETTE)
    return {};
  Message message{};
  PaletteIndices indices;
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &message, on_error, on_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  if (info) png_set_read_fn(png, &bytes, take_png_bytes);
  const bool whole = info && read_palette_indices(png, info, indices);
  png_destroy_read_struct(&png, &info, nullptr);
  if (!whole) return fmt::format("libpng: {}", message.data());
  if (indices.largest < indices.colors) return {};
  return fmt::format("a pixel has the palette index {}, but the palette has {} colour{}", indices.largest,
                     indices.colors, indices.colors == 1 ? "" : "s");
}

}  // namespace troupe::worldio
