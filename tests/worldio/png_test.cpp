#include "worldio/images/png.hpp"

#include "tests/support/scratch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>
#include <sys/resource.h>

#include <csignal>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>

namespace troupe::worldio::png_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Pair;
using ::testing::UnorderedElementsAre;

class WritePng : public test::ScratchTest {
 protected:
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& entry : fs::directory_iterator(folder_)) all.push_back(entry.path().filename().string());
    return all;
  }
};

/// Noise, which does not compress.
Image noise(int width, int height) {
  Image image{width, height, {}};
  std::uint32_t state = 1;
  for (int i = 0; i < 4 * width * height; ++i) {
    state = state * 1664525U + 1013904223U;
    image.rgba.push_back(static_cast<std::uint8_t>(state >> 24));
  }
  return image;
}

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

struct ReadBack {
  Image image;
  std::map<std::string, std::string> text;
  std::map<std::string, int> compression;
};

ReadBack read_back(const fs::path& file) {
  ReadBack result;
  std::FILE* in = std::fopen(file.c_str(), "rb");
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, in);
  png_read_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
  EXPECT_EQ(png_get_bit_depth(png, info), 8);
  EXPECT_EQ(png_get_color_type(png, info), PNG_COLOR_TYPE_RGB_ALPHA);
  result.image.width = static_cast<int>(png_get_image_width(png, info));
  result.image.height = static_cast<int>(png_get_image_height(png, info));
  png_bytepp rows = png_get_rows(png, info);
  for (int row = 0; row < result.image.height; ++row) {
    result.image.rgba.insert(result.image.rgba.end(), rows[row], rows[row] + 4 * result.image.width);
  }
  png_textp texts = nullptr;
  int count = 0;
  png_get_text(png, info, &texts, &count);
  for (int i = 0; i < count; ++i) {
    result.text[texts[i].key] = texts[i].text;
    result.compression[texts[i].key] = texts[i].compression;
  }
  png_destroy_read_struct(&png, &info, nullptr);
  std::fclose(in);
  return result;
}

std::string error_of(const fs::path& file, const Image& image, const std::string& key = "Title") {
  try {
    write_png(file, image, {{key, "x"}});
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "no error";
}

TEST_F(WritePng, IsReadBackPixelForPixel) {
  const Image image = noise(37, 23);
  write_png(folder_ / "a.png", image);
  const ReadBack back = read_back(folder_ / "a.png");
  EXPECT_EQ(back.image.width, 37);
  EXPECT_EQ(back.image.height, 23);
  EXPECT_EQ(back.image.rgba, image.rgba);
  EXPECT_THAT(names(), ::testing::ElementsAre("a.png"));
}

TEST_F(WritePng, CarriesText) {
  write_png(folder_ / "a.png", noise(2, 2), {{"Title", "hospital"}, {"Author", "Zoë"}, {"Comment", ""}});
  const ReadBack back = read_back(folder_ / "a.png");
  EXPECT_THAT(back.text,
              UnorderedElementsAre(Pair("Title", "hospital"), Pair("Author", "Zoë"), Pair("Comment", "")));
  EXPECT_EQ(back.compression.at("Title"), PNG_TEXT_COMPRESSION_NONE);
  EXPECT_EQ(back.compression.at("Author"), PNG_ITXT_COMPRESSION_NONE);
}

TEST_F(WritePng, TheSameImageGivesTheSameBytes) {
  write_png(folder_ / "a.png", noise(50, 50), {{"Title", "x"}});
  write_png(folder_ / "b.png", noise(50, 50), {{"Title", "x"}});
  EXPECT_EQ(bytes_of(folder_ / "a.png"), bytes_of(folder_ / "b.png"));
}

TEST_F(WritePng, DepthsHaveSixteenBits) {
  const DepthImage image{3, 2, {0, 1, 255, 256, 4660, 65535}};
  const fs::path file = folder_ / "depth.png";
  write_png(file, image, {{"unit", "mm"}});
  std::FILE* in = std::fopen(file.c_str(), "rb");
  ASSERT_NE(in, nullptr);
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, in);
  png_read_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
  EXPECT_EQ(png_get_bit_depth(png, info), 16);
  EXPECT_EQ(png_get_color_type(png, info), PNG_COLOR_TYPE_GRAY);
  EXPECT_EQ(png_get_image_width(png, info), 3u);
  ASSERT_EQ(png_get_image_height(png, info), 2u);
  png_bytepp rows = png_get_rows(png, info);
  std::vector<std::uint16_t> values;
  for (int row = 0; row < 2; ++row)
    for (int column = 0; column < 3; ++column)
      values.push_back(static_cast<std::uint16_t>(rows[row][2 * column] << 8 | rows[row][2 * column + 1]));
  EXPECT_EQ(values, image.values);
  png_destroy_read_struct(&png, &info, nullptr);
  std::fclose(in);
  EXPECT_THROW(write_png(file, DepthImage{3, 2, {0, 1}}), std::runtime_error);
}

TEST_F(WritePng, ReplacesWhatWasThere) {
  write_png(folder_ / "a.png", noise(50, 50));
  write_png(folder_ / "a.png", noise(3, 4));
  EXPECT_EQ(read_back(folder_ / "a.png").image.height, 4);
}

TEST_F(WritePng, SaysThatTheFolderIsMissing) {
  const fs::path file = folder_ / "nowhere" / "a.png";
  EXPECT_EQ(error_of(file, noise(2, 2)), file.string() + ": error: cannot be written: there is no folder " +
                                             (folder_ / "nowhere").string());
  EXPECT_THAT(names(), ::testing::IsEmpty());
}

TEST_F(WritePng, LeavesNothingWhenTheNameIsTaken) {
  const fs::path file = folder_ / "a.png";
  fs::create_directories(file / "full");
  EXPECT_EQ(error_of(file, noise(2, 2)), file.string() + ": error: cannot be written: Is a directory");
  EXPECT_THAT(names(), ::testing::ElementsAre("a.png"));
}

TEST_F(WritePng, KeepsTheOldFileWhenTheDiskIsFull) {
  const fs::path file = folder_ / "a.png";
  write_png(file, noise(8, 8));
  const std::string before = bytes_of(file);

  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{20'000, old.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  const std::string error = error_of(file, noise(200, 200));
  setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, old_handler);

  EXPECT_EQ(error, file.string() + ": error: cannot be written: File too large");
  EXPECT_EQ(bytes_of(file), before);
  EXPECT_THAT(names(), ::testing::ElementsAre("a.png"));
}

TEST_F(WritePng, RefusesWhatIsNoImage) {
  const fs::path file = folder_ / "a.png";
  EXPECT_EQ(error_of(file, {0, 5, {}}),
            file.string() +
                ": error: cannot be written: the image has 0 x 5 pixels and 0 bytes; "
                "expected at least 1 x 1 pixels and exactly 4 bytes per pixel");
  EXPECT_THAT(error_of(file, {2, 2, std::vector<std::uint8_t>(15)}), HasSubstr("2 x 2 pixels and 15 bytes"));
  EXPECT_THAT(names(), ::testing::IsEmpty());
}

TEST_F(WritePng, PassesOnWhatLibpngRefuses) {
  const fs::path file = folder_ / "a.png";
  EXPECT_THAT(error_of(file, noise(2, 2), ""),
              HasSubstr(file.string() + ": error: cannot be written: libpng: "));
  EXPECT_THAT(names(), ::testing::IsEmpty());
}

}  // namespace
}  // namespace troupe::worldio::png_test
