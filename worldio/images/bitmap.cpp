#include "worldio/images/bitmap.hpp"

#include "worldio/files.hpp"
#include "worldio/images/png.hpp"

#define STBI_NO_STDIO
#include <stb/stb_image.h>

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace troupe::worldio {
namespace {

constexpr int k_darkest_free = 128;  // of 255; darker pixels are solid

/// Counts the bytes of the unpacked pixel data of a PNG, without keeping these bytes.
class Unpacked {
 public:
  Unpacked() { inflateInit(&stream_); }
  ~Unpacked() { inflateEnd(&stream_); }
  Unpacked(const Unpacked&) = delete;
  Unpacked& operator=(const Unpacked&) = delete;

  /// Unpacks more data. Stops as soon as the unpacked bytes of all calls are more than `most`.
  void add(std::string_view data, std::size_t most) {
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(data.data()));
    stream_.avail_in = static_cast<uInt>(data.size());
    for (int status = Z_OK; status == Z_OK && stream_.total_out <= most;) {
      stream_.next_out = buffer_.data();
      stream_.avail_out = static_cast<uInt>(buffer_.size());
      status = inflate(&stream_, Z_NO_FLUSH);
    }
  }
  std::size_t bytes() const { return stream_.total_out; }

 private:
  z_stream stream_{};
  std::array<Bytef, 1 << 15> buffer_;
};

/// True if a chunk of a PNG is cut off or does not match its checksum. stb_image does not check this, and a
/// flipped bit would change the pixels. Also true if the unpacked pixel data has far more bytes than the
/// image needs. stb_image would unpack all of these bytes, while this function stops as soon as there are too
/// many. False for a file that is not a PNG.
bool png_is_damaged(std::string_view bytes) {
  constexpr std::string_view k_signature = "\x89PNG\r\n\x1a\n";
  if (!bytes.starts_with(k_signature)) return false;
  const auto number = [&](std::size_t at) {
    std::uint32_t n = 0;
    for (std::size_t i = 0; i < 4; ++i) n = n << 8 | static_cast<unsigned char>(bytes[at + i]);
    return n;
  };
  constexpr std::size_t k_frame = 12;  // bytes of a chunk's length, kind and checksum
  constexpr std::size_t k_most_pixel_bytes = 8;
  std::size_t most = 0;
  Unpacked unpacked;
  for (std::size_t at = k_signature.size(); bytes.size() - at >= k_frame;) {
    const std::size_t length = number(at);
    if (length > bytes.size() - at - k_frame) return true;
    const auto* kind_and_data = reinterpret_cast<const Bytef*>(bytes.data() + at + 4);
    if (crc32(0, kind_and_data, static_cast<uInt>(length + 4)) != number(at + 8 + length)) return true;
    const std::string_view kind = bytes.substr(at + 4, 4);
    if (kind == "IEND") return false;
    if (kind == "IHDR" && length >= 8) {
      const std::size_t width = number(at + 8);
      const std::size_t height = number(at + 12);
      if (static_cast<double>(width) * static_cast<double>(height) <= k_most_pixels)
        most = k_most_pixel_bytes * (width + 1) * (height + 1);
    }
    if (kind == "IDAT" && most > 0) {  // `most` is 0 if the image is too large, which is reported later
      unpacked.add(bytes.substr(at + 8, length), most);
      if (unpacked.bytes() > most) return true;
    }
    at += k_frame + length;
  }
  return true;
}

/// True if the segments of a JPEG do not follow one another, if a Huffman table has more codes than a byte
/// has values, or if a scan uses a table that is not defined. For a table with too many codes, stb_image
/// (2.27, Debian 12) would write beyond its buffer; for a missing table, it would read uninitialized memory.
/// False for a file that is not a JPEG.
bool jpeg_is_damaged(std::string_view bytes) {
  constexpr unsigned k_first_marker = 0xc0, k_huffman = 0xc4, k_first_restart = 0xd0, k_last_restart = 0xd7,
                     k_progressive = 0xc2, k_start = 0xd8, k_end = 0xd9, k_start_of_scan = 0xda;
  std::size_t at = 0;
  const auto byte = [&](std::size_t i) {
    return i < bytes.size() ? static_cast<unsigned>(static_cast<unsigned char>(bytes[i])) : 0;
  };
  // Returns the marker at `at` and moves `at` past it; returns 0 if there is no marker. Any number of bytes
  // 0xff may precede a marker.
  const auto take_marker = [&]() -> unsigned {
    if (byte(at) != 0xff) return 0;
    while (byte(at) == 0xff) ++at;
    return byte(at++);
  };
  if (take_marker() != k_start) return false;
  // The Huffman tables defined so far, one bit per table: [0] for DC coefficients, [1] for AC coefficients.
  unsigned given[2] = {0, 0};
  bool is_progressive = false;
  unsigned marker = take_marker();
  while (marker != k_end) {
    if (marker < k_first_marker || (marker >= k_first_restart && marker <= k_start)) return true;
    const std::size_t length = byte(at) << 8 | byte(at + 1);
    const std::size_t end = at + length;
    if (length < 2 || end > bytes.size()) return true;
    if (marker == k_huffman)
      for (std::size_t table = at + 2; table < end;) {  // 1 byte with the table's number, 16 counts, codes
        given[byte(table) >> 4 & 1] |= 1u << (byte(table) & 15);
        unsigned codes = 0;
        for (std::size_t i = 1; i <= 16; ++i) codes += byte(table + i);
        table += 17 + codes;
        if (codes > 256 || table > end) return true;
      }
    is_progressive = is_progressive || marker == k_progressive;
    if (marker == k_start_of_scan) {  // per component: its id and its two tables; then the coefficient range
      const std::size_t after = at + 3 + 2 * std::size_t{byte(at + 2)};
      if (after + 3 != end) return true;
      const bool needs[] = {!is_progressive || byte(after) == 0, !is_progressive || byte(after + 1) > 0};
      for (std::size_t component = at + 3; component < after; component += 2)
        for (const unsigned kind : {0u, 1u}) {
          const unsigned table = kind == 0 ? byte(component + 1) >> 4 : byte(component + 1) & 15;
          if (table > 3 || (needs[kind] && !(given[kind] >> table & 1))) return true;
        }
    }
    at = end;
    const bool is_scan = marker == k_start_of_scan;
    // After the header of a scan, its pixel data are skipped. Restart markers and other bytes 0xff among them
    // do not end the scan.
    do {
      while (is_scan && at < bytes.size() && byte(at) != 0xff) ++at;
      marker = take_marker();
    } while (is_scan && at < bytes.size() &&
             (marker == 0 || (marker >= k_first_restart && marker <= k_last_restart)));
  }
  return false;
}

/// Whether a file is a PNM, an image of the family PBM, PGM and PPM: P1, P2 and P3 in ASCII, P4, P5 and P6
/// binary.
bool is_pnm(std::string_view bytes) {
  constexpr std::string_view k_after_number = " \t\n\v\f\r#";
  return bytes.size() >= 3 && bytes[0] == 'P' && bytes[1] >= '1' && bytes[1] <= '6' &&
         k_after_number.find(bytes[2]) != bytes.npos;
}

/// Reads the words of a PNM that are numbers, and skips white space and comments between them.
class PnmNumbers {
 public:
  explicit PnmNumbers(std::string_view bytes, std::size_t at) : bytes_(bytes), at_(at) {}

  /// Returns the next number, or the next digit if `is_digit` is true. A number above 1e6 is 1e6. -1: the
  /// next word is no number.
  double next(bool is_digit = false) {
    constexpr std::string_view k_white_space = " \t\n\v\f\r";
    while (at_ < bytes_.size() && (k_white_space.find(bytes_[at_]) != bytes_.npos || bytes_[at_] == '#'))
      if (bytes_[at_] == '#')
        at_ = std::min(bytes_.size(), bytes_.find_first_of("\r\n", at_));
      else
        ++at_;
    double value = -1;
    for (; at_ < bytes_.size() && bytes_[at_] >= '0' && bytes_[at_] <= '9'; ++at_) {
      if (is_digit && value >= 0) break;
      value = std::min(1e6, 10 * std::max(value, 0.0) + (bytes_[at_] - '0'));
    }
    return value;
  }
  std::size_t at() const { return at_; }

 private:
  std::string_view bytes_;
  std::size_t at_;
};

/// The header of a PNM. A number that is missing is -1; a number above 1e6 is 1e6.
struct PnmHeader {
  double width;
  double height;
  double largest;      // value of white; above 255, each channel of a binary PNM has two bytes; 1 for a PBM
  double channels;     // of the whole image
  std::size_t pixels;  // position of the first pixel
  bool is_ascii;
  bool has_bits;  // a PBM: 1 is black
};

PnmHeader pnm_header(std::string_view bytes) {
  PnmNumbers numbers(bytes, 2);
  PnmHeader header{};
  header.is_ascii = bytes[1] <= '3';
  header.has_bits = bytes[1] == '1' || bytes[1] == '4';
  header.width = numbers.next();
  header.height = numbers.next();
  header.largest = header.has_bits ? 1 : numbers.next();
  header.channels = header.width * header.height * (bytes[1] == '3' || bytes[1] == '6' ? 3 : 1);
  header.pixels = numbers.at() + (header.is_ascii ? 0 : 1);  // one blank precedes the pixels
  return header;
}

/// True if a PNM is cut off or has an invalid header. stb_image does not check this, and would read
/// uninitialized memory for missing pixels. False for a file that is not a PNM.
bool pnm_is_damaged(std::string_view bytes) {
  if (!is_pnm(bytes)) return false;
  const PnmHeader header = pnm_header(bytes);
  constexpr double k_most = 999999;  // above it, products overflow an int in stb_image
  for (const double number : {header.width, header.height, header.largest})
    if (number < 1 || number > k_most) return true;
  const double size = header.is_ascii   ? header.channels  // at least
                      : header.has_bits ? std::ceil(header.width / 8) * header.height
                                        : header.channels * (header.largest > 255 ? 2 : 1);
  return header.pixels > bytes.size() || static_cast<double>(bytes.size() - header.pixels) < size;
}

/// Returns a PNM in the only form that stb_image reads: binary, with channels from 0 to 255. Empty if the
/// file is not a PNM or has this form. The file must not be damaged, as far as pnm_is_damaged() can say. The
/// text of an error continues the words `the image NAME`.
Result<std::string> as_read_pnm(std::string_view bytes) {
  constexpr double k_most = 65535;  // stb_image reports an error for a larger value
  if (!is_pnm(bytes)) return std::string();
  const PnmHeader header = pnm_header(bytes);
  const bool is_binary = !header.is_ascii && !header.has_bits;
  if (is_binary && (header.largest == 255 || header.largest > k_most)) return std::string();
  const auto largest = static_cast<unsigned>(header.largest);
  const auto channels = static_cast<std::size_t>(header.channels);
  std::string read = fmt::format("P{} {:.0f} {:.0f} 255\n", bytes[1] == '3' || bytes[1] == '6' ? 6 : 5,
                                 header.width, header.height);
  read.reserve(read.size() + channels);
  PnmNumbers numbers(bytes, header.pixels);
  std::size_t at = header.pixels;
  const auto byte = [&](std::size_t i) {
    return static_cast<unsigned>(static_cast<unsigned char>(bytes[i]));
  };
  const auto width = static_cast<std::size_t>(header.width);
  for (std::size_t i = 0; i < channels; ++i) {
    unsigned value = 0;
    if (header.is_ascii) {
      const double given = numbers.next(header.has_bits);
      if (given < 0)
        return Error{fmt::format("is damaged: after {} of {} values, the next one is missing or no number", i,
                                 channels)};
      value = static_cast<unsigned>(given);
    } else if (header.has_bits) {  // each row begins with a byte of its own
      const std::size_t row = i / width, column = i % width;
      value = byte(at + row * ((width + 7) / 8) + column / 8) >> (7 - column % 8) & 1;
    } else {
      value = byte(at++);
      if (largest > 255) value = value << 8 | byte(at++);  // the high byte is first
    }
    const auto scaled = static_cast<char>((std::min(value, largest) * 255 + largest / 2) / largest);
    read += header.has_bits ? static_cast<char>(~scaled) : scaled;
  }
  return read;
}

/// True if a BMP is shorter than its header says, or than its pixels need. stb_image would fill the missing
/// pixels with black. False for a file that is not a BMP.
bool bmp_is_damaged(std::string_view bytes) {
  if (!bytes.starts_with("BM")) return false;
  const auto number = [&](std::size_t at, std::size_t count) {
    std::uint32_t n = 0;
    for (std::size_t i = 0; i < count && at + i < bytes.size(); ++i)
      n |= std::uint32_t{static_cast<unsigned char>(bytes[at + i])} << (8 * i);
    return n;
  };
  const bool is_old = number(14, 4) == 12;  // the OS/2 header
  const std::uint32_t width = is_old ? number(18, 2) : number(18, 4);
  // Negative if the top row is first.
  const auto height = static_cast<std::int32_t>(is_old ? number(20, 2) : number(22, 4));
  const std::uint32_t bits = is_old ? number(24, 2) : number(28, 2);
  const double row_bytes = 4 * std::ceil(static_cast<double>(width) * bits / 32);
  return static_cast<double>(bytes.size()) <
         std::max<double>(number(2, 4), number(10, 4) + row_bytes * std::abs(static_cast<double>(height)));
}

/// True for a BMP whose pixels are compressed, such as by run-length encoding (RLE).
bool bmp_is_compressed(std::string_view bytes) {
  constexpr std::size_t k_compression_at = 30;
  constexpr char k_uncompressed = 0, k_uncompressed_with_masks = 3;
  constexpr unsigned char k_old_header = 12;  // bytes of the OS/2 header, which has no compression
  if (!bytes.starts_with("BM") || bytes.size() <= k_compression_at || bytes[14] == k_old_header) return false;
  return bytes[k_compression_at] != k_uncompressed && bytes[k_compression_at] != k_uncompressed_with_masks;
}

const stbi_uc* data_of(std::string_view bytes) { return reinterpret_cast<const stbi_uc*>(bytes.data()); }
int size_of(std::string_view bytes) { return static_cast<int>(bytes.size()); }

/// Checks the bytes of an image before it is decoded. The text of an error continues the words `the image
/// NAME`.
Result<> check_encoded(std::string_view bytes, double most_pixels) {
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    return Error{fmt::format("has {} bytes; at most 2^31 - 1 are allowed", bytes.size())};
  if (bmp_is_compressed(bytes))
    return Error{"is a compressed BMP; only BMPs that are not compressed are read: convert the image to PNG"};
  struct Format {
    bool (*is_damaged)(std::string_view bytes);
    std::string_view what;
  };
  constexpr Format k_formats[] = {
      {png_is_damaged,
       "a part is cut off, a checksum does not match, or there is more data than the pixels need"},
      {jpeg_is_damaged, "it violates the JPEG format, or is cut off"},
      {pnm_is_damaged, "its header is invalid, has a number above 999999, or the image is cut off"},
      {bmp_is_damaged, "it is cut off"}};
  for (const auto& [is_damaged, what] : k_formats)
    if (is_damaged(bytes)) return Error{fmt::format("is damaged: {}", what)};
  int width = 0, height = 0, channels = 0;
  if (is_pnm(bytes)) {
    width = static_cast<int>(pnm_header(bytes).width);
    height = static_cast<int>(pnm_header(bytes).height);
  } else {
    stbi_info_from_memory(data_of(bytes), size_of(bytes), &width, &height, &channels);
  }
  if (static_cast<double>(width) * height > most_pixels)
    return Error{fmt::format("is too large: {} x {} pixels; at most {:.0f} million are allowed", width,
                             height, most_pixels / 1e6)};
  // stb_image would read uninitialized memory for an index beyond the palette.
  if (const std::string error = palette_error(bytes); !error.empty())
    return Error{fmt::format("is damaged: {}", error)};
  return {};
}

/// Returns the total number of corners of the outlines of the solid pixels.
std::size_t count_corners(const Bitmap& bitmap) {
  std::size_t count = 0;
  for (int y = 0; y <= bitmap.height; ++y)
    for (int x = 0; x <= bitmap.width; ++x) {
      const bool above_left = bitmap.at(x - 1, y - 1), above = bitmap.at(x, y - 1),
                 left = bitmap.at(x - 1, y), here = bitmap.at(x, y);
      const bool is_diagonal = above_left == here && above == left && here != left;
      count += is_diagonal ? 2 : (above_left != here) != (above != left);
    }
  return count;
}

/// The edges between solid pixels and free pixels. Each edge has the length of one pixel, and a direction in
/// which the solid pixel is on its right, seen in the image. The class stores, for each corner of the pixel
/// lattice (image axes, +y down), the set of directions in which edges leave the corner.
class BoundaryEdges {
 public:
  // The directions are in the order of the corners to which they lead, by x and then by y. If several edges
  // leave a corner, Stage follows the first of them in this order.
  enum Direction : std::uint8_t { left = 1, up = 2, down = 4, right = 8 };

  explicit BoundaryEdges(const Bitmap& bitmap)
      : rows_(static_cast<std::size_t>(bitmap.height) + 1),
        leaving_((static_cast<std::size_t>(bitmap.width) + 1) * rows_, 0) {
    for (int y = 0; y < bitmap.height; ++y)
      for (int x = 0; x < bitmap.width; ++x) {
        if (!bitmap.solid[static_cast<std::size_t>(y) * bitmap.width + x]) continue;
        if (!bitmap.at(x, y - 1)) at(x, y) |= right;
        if (!bitmap.at(x + 1, y)) at(x + 1, y) |= down;
        if (!bitmap.at(x, y + 1)) at(x + 1, y + 1) |= left;
        if (!bitmap.at(x - 1, y)) at(x, y + 1) |= up;
      }
  }

  std::size_t corners() const { return leaving_.size(); }
  /// Position of a corner in the image. Corners are numbered column by column: by x, and then by y.
  int x_of(std::size_t corner) const { return static_cast<int>(corner / rows_); }
  int y_of(std::size_t corner) const { return static_cast<int>(corner % rows_); }
  bool any_leaves(std::size_t corner) const { return leaving_[corner] != 0; }

  /// Removes the first edge that leaves a corner, in the order of Direction, and returns the corner to which
  /// it leads. There must be such an edge.
  std::size_t follow(std::size_t corner) {
    std::uint8_t& set = leaving_[corner];
    const auto first = static_cast<std::uint8_t>(set & (~set + 1));
    set = static_cast<std::uint8_t>(set & ~first);
    switch (first) {
      case left: return corner - rows_;
      case up: return corner - 1;
      case down: return corner + 1;
      default: return corner + rows_;
    }
  }

 private:
  std::uint8_t& at(int x, int y) { return leaving_[static_cast<std::size_t>(x) * rows_ + y]; }

  std::size_t rows_;
  std::vector<std::uint8_t> leaving_;
};

}  // namespace

bool is_dark(std::span<const std::uint8_t> channels) { return channels[0] < k_darkest_free; }

std::optional<Bitmap> read_bitmap(const std::filesystem::path& file, Where where, Diagnostics& diagnostics,
                                  const PixelRule& is_solid) {
  const std::optional<std::string> bytes = read_file(file);
  if (bytes) return decode_bitmap(*bytes, file.string(), where, diagnostics, k_most_pixels, is_solid);
  const Result<> readable = check_readable(file, k_most_input_bytes);
  diagnostics.error(where, fmt::format("cannot read the image {}{}", file.string(),
                                       readable ? "" : ": " + readable.error().text));
  return {};
}

std::optional<Bitmap> decode_bitmap(std::string_view bytes, std::string_view name, Where where,
                                    Diagnostics& diagnostics, double most_pixels, const PixelRule& is_solid) {
  const auto refuse = [&](std::string message) {
    diagnostics.error(where, std::move(message));
    return std::nullopt;
  };
  if (const Result<> checked = check_encoded(bytes, most_pixels); !checked)
    return refuse(fmt::format("the image {} {}", name, checked.error().text));
  const Result<std::string> pnm = as_read_pnm(bytes);
  if (!pnm) return refuse(fmt::format("the image {} {}", name, pnm.error().text));
  if (!pnm->empty()) bytes = *pnm;
  Bitmap bitmap;
  int channels = 0;
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(data_of(bytes), size_of(bytes), &bitmap.width, &bitmap.height, &channels, 0),
      stbi_image_free);
  if (!pixels)
    return refuse(fmt::format("{} is not a readable PNG, JPEG, BMP, PBM, PGM or PPM image ({})", name,
                              stbi_failure_reason()));
  const std::size_t count = static_cast<std::size_t>(bitmap.width) * static_cast<std::size_t>(bitmap.height);
  bitmap.solid.resize(count);
  const auto stride = static_cast<std::size_t>(channels);
  for (std::size_t i = 0; i < count; ++i)
    bitmap.solid[i] = is_solid(std::span<const std::uint8_t>(pixels.get() + i * stride, stride));
  if (const std::size_t corners = count_corners(bitmap); corners > k_most_corners)
    return refuse(
        fmt::format("the image {} is too large: its outlines have {} corners; at most {} are allowed: use a "
                    "drawing of the walls, not a photograph",
                    name, corners, k_most_corners));
  return bitmap;
}

std::vector<Ring> bitmap_contours(const Bitmap& bitmap) {
  BoundaryEdges edges(bitmap);
  std::vector<Ring> rings;
  for (std::size_t start = 0; start < edges.corners(); ++start)
    while (edges.any_leaves(start)) {
      Ring ring;
      std::size_t corner = start;
      do {
        const Vec2 point(edges.x_of(corner), -edges.y_of(corner));
        // Collinear edges become one edge, except, as in Stage, edges among the first three points of the
        // ring.
        const std::size_t n = ring.size();
        if (n > 2 && cross(ring[n - 1] - ring[n - 2], point - ring[n - 1]) == 0)
          ring.back() = point;
        else
          ring.push_back(point);
        corner = edges.follow(corner);
      } while (corner != start);
      rings.push_back(std::move(ring));
    }
  return rings;
}

void fit_image(int width, int height, const Eigen::Vector3d& size, std::vector<Ring>& contours) {
  for (Ring& ring : contours)
    for (Vec2& p : ring) p = {(p.x() / width - 0.5) * size.x(), ((p.y() + height) / height - 0.5) * size.y()};
}

void add_boundary(const Eigen::Vector3d& size, std::vector<Solid>& solids) {
  constexpr double k_thickness = 0.01;  // m, as in Stage
  const double x = size.x() / 2;
  const double y = size.y() / 2;
  const double t = std::min({k_thickness, x, y});
  const auto wall = [&](double x0, double y0, double x1, double y1) {
    solids.push_back({{{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}}, {0, size.z()}});
  };
  wall(-x, -y, -x + t, y);
  wall(x - t, -y, x, y);
  wall(-x, -y, x, -y + t);
  wall(-x, y - t, x, y);
}

void normalise(std::vector<Solid>& solids, const Eigen::Vector3d& size, const Box& frame) {
  Box box = frame;
  ZInterval z{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const Solid& solid : solids) {
    for (const Ring& ring : solid.contours)
      for (const Vec2& point : ring) box.extend(point);
    z.min = std::min(z.min, solid.z.min);
    z.max = std::max(z.max, solid.z.max);
  }
  if (box.empty()) return;
  const auto scale = [](double wanted, double extent) { return extent > 0 ? wanted / extent : 1.0; };
  const Vec2 center = box.center();
  const Vec2 factor(scale(size.x(), box.size().x()), scale(size.y(), box.size().y()));
  const double factor_z = scale(size.z(), z.max - z.min);
  for (Solid& solid : solids) {
    for (Ring& ring : solid.contours)
      for (Vec2& point : ring) point = (point - center).cwiseProduct(factor);
    solid.z = {solid.z.min * factor_z, solid.z.max * factor_z};
  }
}

}  // namespace troupe::worldio
