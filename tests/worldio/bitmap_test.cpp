#include "worldio/bitmap.hpp"

#include "worldio/png.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <filesystem>
#include <fstream>

namespace troupe::worldio {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::SizeIs;

Bitmap bitmap_of(const std::vector<std::string>& rows) {
  Bitmap bitmap{.width = static_cast<int>(rows[0].size()), .height = static_cast<int>(rows.size())};
  for (const std::string& row : rows)
    for (const char c : row) bitmap.solid.push_back(c == '#');
  return bitmap;
}

TEST(Bitmap, OnePixelIsASquareWithUpwardY) {
  EXPECT_THAT(bitmap_contours(bitmap_of({"..", ".#"})),
              ElementsAre(Ring{Vec2(1, -1), Vec2(2, -1), Vec2(2, -2), Vec2(1, -2)}));
}

TEST(Bitmap, AHoleIsAContourOfItsOwn) {
  const auto rings = bitmap_contours(bitmap_of({"###", "#.#", "###"}));
  ASSERT_THAT(rings, SizeIs(2));
  EXPECT_FALSE(contains(Solid{rings, {}}, Vec2(1.5, -1.5)));
  EXPECT_TRUE(contains(Solid{rings, {}}, Vec2(0.5, -1.5)));
}

TEST(Bitmap, StraightRunsBecomeOneEdgeButNotAmongTheFirstThreePoints) {
  EXPECT_THAT(bitmap_contours(bitmap_of({"####"})),
              ElementsAre(Ring{Vec2(0, 0), Vec2(1, 0), Vec2(4, 0), Vec2(4, -1), Vec2(0, -1)}));
}

TEST(Bitmap, NothingSolidHasNoContour) { EXPECT_THAT(bitmap_contours(bitmap_of({"..", ".."})), SizeIs(0)); }

// The even-odd region of the contours is the set of solid pixels, whatever touches whatever.
RC_GTEST_PROP(Bitmap, ContoursEncloseTheSolidPixels, ()) {
  const int width = *rc::gen::inRange(1, 12);
  const int height = *rc::gen::inRange(1, 12);
  Bitmap bitmap{.width = width, .height = height};
  bitmap.solid = *rc::gen::container<std::vector<bool>>(static_cast<std::size_t>(width * height),
                                                        rc::gen::arbitrary<bool>());
  const Solid solid{bitmap_contours(bitmap), {0, 1}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) RC_ASSERT(contains(solid, Vec2(x + 0.5, -y - 0.5)) == bitmap.at(x, y));
}

TEST(Normalise, StretchesTheCommonBoxAndKeepsTheRatioOfZ) {
  std::vector<Solid> solids{{{{Vec2(1, 1), Vec2(2, 1), Vec2(2, 2)}}, {0.5, 1}},
                            {{{Vec2(4, 5), Vec2(5, 5), Vec2(5, 9)}}, {0.75, 1}}};
  normalise(solids, {8, 2, 1});
  EXPECT_THAT(solids[0].contours[0], ElementsAre(Vec2(-4, -1), Vec2(-2, -1), Vec2(-2, -0.75)));
  EXPECT_THAT(solids[1].contours[0], ElementsAre(Vec2(2, 0), Vec2(4, 0), Vec2(4, 1)));
  EXPECT_EQ(solids[0].z, (ZInterval{1, 2}));
  EXPECT_EQ(solids[1].z, (ZInterval{1.5, 2}));
  const std::vector<Solid> once = solids;
  normalise(solids, {8, 2, 1});
  EXPECT_EQ(solids, once);
}

TEST(Normalise, LeavesAnExtentOfZeroFinite) {
  std::vector<Solid> solids{{{{Vec2(1, 1), Vec2(1, 2), Vec2(1, 3)}}, {2, 2}}};
  normalise(solids, {8, 2, 1});
  EXPECT_THAT(solids[0].contours[0], ElementsAre(Vec2(0, -1), Vec2(0, 0), Vec2(0, 1)));
  EXPECT_EQ(solids[0].z, (ZInterval{2, 2}));
}

class BitmapFile : public testing::Test {
 protected:
  BitmapFile() { fs::create_directories(folder_); }
  ~BitmapFile() override { fs::remove_all(folder_); }

  std::optional<Bitmap> read(const fs::path& file) {
    diagnostics_ = Diagnostics();
    return read_bitmap(file, {diagnostics_.files()->add("w.world"), 7}, diagnostics_);
  }
  std::string error() const {
    return diagnostics_.findings().empty() ? "" : diagnostics_.text(diagnostics_.findings()[0]);
  }

  fs::path folder_ = fs::path(testing::TempDir()) / "troupe_bitmap";
  Diagnostics diagnostics_;
};

TEST_F(BitmapFile, SolidIsWhatIsDarkInTheFirstChannel) {
  Image image{.width = 3, .height = 1};
  image.rgba = {127, 255, 255, 255, 128, 0, 0, 255, 0, 255, 255, 0};
  write_png(folder_ / "a.png", image);
  const auto bitmap = read(folder_ / "a.png");
  ASSERT_TRUE(bitmap);
  EXPECT_THAT(bitmap->solid, ElementsAre(true, false, true));  // opacity does not matter
}

TEST_F(BitmapFile, ReadsAPortableGraymap) {
  std::ofstream(folder_ / "a.pgm", std::ios::binary) << "P5 2 2 255\n" << std::string("\x00\xff\xff\x00", 4);
  const auto bitmap = read(folder_ / "a.pgm");
  ASSERT_TRUE(bitmap);
  EXPECT_THAT(bitmap_contours(*bitmap), SizeIs(2));
}

TEST_F(BitmapFile, AMissingFileIsAnError) {
  EXPECT_FALSE(read(folder_ / "no.png"));
  EXPECT_EQ(error(), "w.world:7: error: cannot read the image " + (folder_ / "no.png").string());
}

TEST_F(BitmapFile, ABrokenFileIsAnError) {
  std::ofstream(folder_ / "b.png") << "not an image";
  EXPECT_FALSE(read(folder_ / "b.png"));
  EXPECT_THAT(error(), testing::StartsWith("w.world:7: error: " + (folder_ / "b.png").string() +
                                           " is no PNG, JPEG, BMP or PNM image that can be read ("));
  write_png(folder_ / "c.png",
            Image{.width = 64, .height = 64, .rgba = std::vector<std::uint8_t>(64 * 64 * 4, 9)});
  fs::resize_file(folder_ / "c.png", 60);
  EXPECT_FALSE(read(folder_ / "c.png"));
}

TEST_F(BitmapFile, APngWithOneWrongByteIsAnError) {
  const fs::path file = folder_ / "d.png";
  Image image{.width = 64, .height = 64, .rgba = std::vector<std::uint8_t>(64 * 64 * 4, 255)};
  for (std::size_t i = 0; i < image.rgba.size(); i += 28) image.rgba[i] = 0;
  write_png(file, image);
  std::string bytes;
  {
    std::ifstream in(file, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(in), {});
  }
  ASSERT_TRUE(read(file));
  for (std::size_t at = 8; at < bytes.size(); at += 7) {  // behind the signature every byte counts
    std::string wrong = bytes;
    wrong[at] = static_cast<char>(wrong[at] ^ 0x55);
    std::ofstream(file, std::ios::binary) << wrong;
    EXPECT_FALSE(read(file)) << "byte " << at;
  }
  EXPECT_EQ(error(), "w.world:7: error: the image " + file.string() +
                         " is damaged: a checksum in it does not fit, or it holds more than its pixels");
}

TEST(Bitmap, ConformanceVector13PolygonsAndVertices) {
  const fs::path bitmaps = fs::path(TROUPE_SOURCE_DIR) / "../shared/stage-worlds/bitmaps";
  if (!fs::exists(bitmaps)) GTEST_SKIP() << "Stage's bitmaps are not in " << bitmaps;
  struct Case {
    const char* name;
    std::size_t polygons, vertices;
  };
  std::size_t tried = 0;
  for (const Case& c : {Case{"cave", 15, 1462},
                        Case{"cave_filled", 8, 729},
                        Case{"cave_compact", 17, 357},
                        Case{"hospital", 979, 17357},
                        Case{"hospital_section", 66, 1805},
                        Case{"SFU_1200x615", 32, 12699},
                        Case{"autolab", 5, 94},
                        Case{"uoa_robotics_lab", 2, 76},
                        Case{"mbicp", 38, 1086},
                        Case{"space_invader", 5, 66},
                        Case{"ghost", 3, 70},
                        Case{"889_05", 63, 1665},
                        Case{"SRI-AIC-kwing", 453, 8937},
                        Case{"frieburg", 52, 8145},
                        Case{"human_outline", 1, 368},
                        Case{"rink", 2, 3706},
                        Case{"sal2", 19, 82},
                        Case{"simple_rooms", 2, 60},
                        Case{"submarine", 36, 962},
                        Case{"submarine_small", 29, 517},
                        Case{"table", 2, 682}}) {
    const fs::path file = bitmaps / (std::string(c.name) + ".png");
    if (!fs::exists(file)) continue;
    Diagnostics diagnostics;
    const auto bitmap = read_bitmap(file, {}, diagnostics);
    ASSERT_TRUE(bitmap) << c.name;
    const std::vector<Ring> rings = bitmap_contours(*bitmap);
    std::size_t vertices = 0;
    for (const Ring& ring : rings) vertices += ring.size();
    EXPECT_EQ(rings.size(), c.polygons) << c.name;
    EXPECT_EQ(vertices, c.vertices) << c.name;
    ++tried;
  }
  EXPECT_GE(tried, 7u);
}

}  // namespace
}  // namespace troupe::worldio
