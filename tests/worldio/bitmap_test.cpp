#include "worldio/images/bitmap.hpp"

#include "tests/support/paths.hpp"
#include "tests/support/scratch.hpp"
#include "worldio/images/png.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

namespace troupe::worldio::bitmap_test {
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

class BitmapFile : public test::ScratchTest {
 protected:
  std::optional<Bitmap> read(const fs::path& file) {
    diagnostics_ = Diagnostics();
    return read_bitmap(file, {diagnostics_.files()->add("w.world"), 7}, diagnostics_);
  }
  std::string error() const {
    return diagnostics_.findings().empty() ? "" : diagnostics_.text(diagnostics_.findings()[0]);
  }

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

/// A binary PNM, one row high, whose channels have these values of `largest`.
std::string pnm(std::string_view format, unsigned largest, const std::vector<unsigned>& channels) {
  const std::size_t width = channels.size() / (format == "P6" ? 3 : 1);
  std::string bytes =
      std::string(format) + " " + std::to_string(width) + " 1 " + std::to_string(largest) + "\n";
  for (const unsigned value : channels) {
    if (largest > 255) bytes += static_cast<char>(value >> 8);
    bytes += static_cast<char>(value & 255);
  }
  return bytes;
}

/// The channels of all pixels, 0 to 255, as the image is read.
std::vector<int> channels_of(const std::string& bytes) {
  std::vector<int> all;
  Diagnostics diagnostics;
  EXPECT_TRUE(decode_bitmap(bytes, "map", {}, diagnostics, k_most_pixels,
                            [&all](std::span<const std::uint8_t> channels) {
                              all.insert(all.end(), channels.begin(), channels.end());
                              return is_dark(channels);
                            }));
  return all;
}

TEST(Bitmap, TheLargestValueOfAPortableGraymapOrPixmapIsWhite) {
  for (const std::string_view format : {"P5", "P6"}) {
    EXPECT_THAT(channels_of(pnm(format, 1, {0, 1, 1})), ElementsAre(0, 255, 255));
    for (const unsigned white : {5u, 100u, 255u, 65535u})
      EXPECT_THAT(
          channels_of(pnm(format, white, {0, white / 5, white / 5 * 2, white / 5 * 3, white / 5 * 4, white})),
          ElementsAre(0, 51, 102, 153, 204, 255))
          << white;
  }
  EXPECT_THAT(channels_of(pnm("P5", 100, {50, 200})), ElementsAre(128, 255));  // rounded; at most white
}

TEST_F(BitmapFile, AMissingFileIsAnError) {
  EXPECT_FALSE(read(folder_ / "no.png"));
  EXPECT_EQ(error(), "w.world:7: error: cannot read the image " + (folder_ / "no.png").string() +
                         ": there is no such file");
}

TEST_F(BitmapFile, ABrokenFileIsAnError) {
  std::ofstream(folder_ / "b.png") << "not an image";
  EXPECT_FALSE(read(folder_ / "b.png"));
  EXPECT_THAT(error(), testing::StartsWith("w.world:7: error: " + (folder_ / "b.png").string() +
                                           " is not a readable PNG, JPEG, BMP, PBM, PGM or PPM image ("));
  write_png(folder_ / "c.png",
            Image{.width = 64, .height = 64, .rgba = std::vector<std::uint8_t>(64 * 64 * 4, 9)});
  fs::resize_file(folder_ / "c.png", 60);
  EXPECT_FALSE(read(folder_ / "c.png"));
}

TEST(Bitmap, PortableImagesInAsciiAndOfBitsAreRead) {
  // Comments stand anywhere; the digits of a P1 need no blanks between them; 1 is black in P1 and P4.
  EXPECT_THAT(channels_of("P1\n# plan\n3 2 # wide\n1 0 1\n# second row\n010\n"),
              ElementsAre(0, 255, 0, 255, 0, 255));
  EXPECT_THAT(channels_of("P2 # plan\n3 1\n255\n0 # left\n 128\t255"), ElementsAre(0, 128, 255));
  EXPECT_THAT(channels_of("P2\r\n2 2\r\n4\r\n0 1\r\n2 9\r\n"), ElementsAre(0, 64, 128, 255));
  EXPECT_THAT(channels_of("P2 3 1 65535 0 32768 65535"), ElementsAre(0, 128, 255));
  EXPECT_THAT(channels_of("P2 2 1 1 0 1"), ElementsAre(0, 255));
  EXPECT_THAT(channels_of("P2 2 1 100000 0 100000"), ElementsAre(0, 255));
  EXPECT_THAT(channels_of("P3\n2 1\n15\n0 0 15  15 3 0\n"), ElementsAre(0, 0, 255, 255, 51, 0));
  EXPECT_THAT(channels_of(std::string("P4\n10 2\n\xaa\x40\x01\x80", 13)),
              ElementsAre(0, 255, 0, 255, 0, 255, 0, 255, 255, 0,  //
                          255, 255, 255, 255, 255, 255, 255, 0, 0, 255));
}

TEST(Bitmap, APortableImageInAsciiIsThatInBinary) {
  const std::vector<unsigned> values{0, 17, 120, 127, 128, 130, 254, 255};
  std::string ascii = "P2 8 1 255\n";
  for (const unsigned value : values) ascii += std::to_string(value) + "\n";
  EXPECT_EQ(channels_of(ascii), channels_of(pnm("P5", 255, values)));
}

TEST_F(BitmapFile, ADamagedPnmInAsciiIsAnError) {
  const std::string header =
      "is damaged: its header is invalid, has a number above 999999, or the image is cut off";
  for (const auto& [text, message] : std::vector<std::pair<std::string, std::string>>{
           {"P2\n3 1\n255\n0 1 x3\n",
            "is damaged: after 2 of 3 values, the next one is missing or no number"},
           {"P2\n3 1\n255\n0 1    \n",
            "is damaged: after 2 of 3 values, the next one is missing or no number"},
           {"P1\n2 1\n1 -1\n", "is damaged: after 1 of 2 values, the next one is missing or no number"},
           {"P2\n3 1\n0\n0 0 0\n", header},
           {"P2\n3\n", header},
           {"P3\n1 1\n255\n0", header},
           {"P4\n9 2\n\xaa\xaa\xaa", header},
           {"P1\n20000 20000\n1", header}}) {
    std::ofstream(folder_ / "m.pgm", std::ios::binary) << text;
    EXPECT_FALSE(read(folder_ / "m.pgm"));
    EXPECT_EQ(error(), "w.world:7: error: the image " + (folder_ / "m.pgm").string() + " " + message);
  }
  Diagnostics diagnostics;
  EXPECT_FALSE(decode_bitmap("P1\n100 100\n" + std::string(10000, '0'), "m.pbm", {}, diagnostics, 9999));
  EXPECT_THAT(diagnostics.findings()[0].message, testing::HasSubstr("is too large: 100 x 100 pixels"));
}

/// A PNG with a palette. `header` is the end of the chunk IHDR from the width on, `rest` is the file after
/// it, both in hexadecimal digits.
std::string palette_png(const std::string& header, const std::string& rest) {
  const std::string digits = "89504e470d0a1a0a0000000d49484452" + header + rest + "0000000049454e44ae426082";
  std::string bytes;
  for (std::size_t i = 0; i < digits.size(); i += 2)
    bytes += static_cast<char>(std::stoi(digits.substr(i, 2), nullptr, 16));
  return bytes;
}

TEST(Bitmap, APaletteIndexBeyondThePaletteIsAnError) {
  const std::string black_and_white = "00000006504c5445000000ffffffa5d99fdd";
  const auto error = [](const std::string& bytes) {
    Diagnostics diagnostics;
    decode_bitmap(bytes, "plan.png", {}, diagnostics);
    return diagnostics.has_errors() ? diagnostics.findings()[0].message : "";
  };
  const std::string square = "000000020000000208030000004568fd16" + black_and_white;
  const std::string right = palette_png(square, "0000000e49444154789c6360606460640400000d00043c8fb58d");
  EXPECT_EQ(error(right), "");
  EXPECT_THAT(channels_of(right), ElementsAre(0, 0, 0, 255, 255, 255, 255, 255, 255, 255, 255, 255));
  EXPECT_EQ(error(palette_png(square, "0000000e49444154789c6360606460640200000e00059f97d85f")),
            "the image plan.png is damaged: a pixel has the palette index 2, but the palette has 2 colours");
  // Interlaced.
  EXPECT_EQ(error(palette_png("00000002000000020803000001326fcd80" + black_and_white,
                              "0000000f49444154789c6360606064606407000014000a6a35e31f")),
            "the image plan.png is damaged: a pixel has the palette index 7, but the palette has 2 colours");
  // Two pixels in a byte.
  EXPECT_EQ(
      error(palette_png("00000003000000010403000000e9ce0987",
                        "00000003504c5445ffffffa7c41bc80000000b49444154789c6360100000001300115554595c")),
      "the image plan.png is damaged: a pixel has the palette index 1, but the palette has 1 colour");
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
                         " is damaged: a part is cut off, a checksum does not match, or there is more data "
                         "than the pixels need");
}

/// What an image comes to: its size in pixels, the contours of what is solid in it with their vertices, and
/// the box of that, in pixels from the upper left corner.
struct Counted {
  std::string name;
  int width, height;
  std::size_t polygons, vertices;
  double left, right, top, bottom;
};

std::size_t vertices_of(const std::vector<Ring>& rings) {
  std::size_t vertices = 0;
  for (const Ring& ring : rings) vertices += ring.size();
  return vertices;
}

void expect_counts(const fs::path& file, const Counted& expected) {
  Diagnostics diagnostics;
  const auto bitmap = read_bitmap(file, {}, diagnostics);
  ASSERT_TRUE(bitmap) << expected.name;
  EXPECT_EQ(bitmap->width, expected.width) << expected.name;
  EXPECT_EQ(bitmap->height, expected.height) << expected.name;
  const std::vector<Ring> rings = bitmap_contours(*bitmap);
  EXPECT_EQ(rings.size(), expected.polygons) << expected.name;
  EXPECT_EQ(vertices_of(rings), expected.vertices) << expected.name;
  Box box;
  for (const Ring& ring : rings) box.extend(bounds(ring));
  EXPECT_EQ(box.min.x(), expected.left) << expected.name;
  EXPECT_EQ(box.max.x(), expected.right) << expected.name;
  EXPECT_EQ(-box.max.y(), expected.top) << expected.name;
  EXPECT_EQ(-box.min.y(), expected.bottom) << expected.name;
}

// Bitmaps of our own, counted by tests/stage_like/bitmaps.py.
TEST(Conformance13, PolygonsVerticesAndBoxesOfOurOwnBitmaps) {
  const fs::path source = test::source_dir();
  std::ifstream in(source / "tests/stage_like/bitmaps.txt");
  std::size_t tried = 0;
  for (Counted expected;
       in >> expected.name >> expected.width >> expected.height >> expected.polygons >> expected.vertices >>
       expected.left >> expected.right >> expected.top >> expected.bottom;
       ++tried)
    expect_counts(source / expected.name, expected);
  EXPECT_EQ(tried, 5u);
}

const auto k_stage_bitmaps = std::to_array<Counted>({
    {"cave", 500, 500, 15, 1462, 0, 500, 0, 500},
    {"cave_filled", 500, 500, 8, 729, 0, 500, 0, 500},
    {"cave_compact", 113, 113, 17, 357, 0, 113, 0, 113},
    {"hospital", 3117, 1189, 979, 17357, 1, 3117, 1, 1189},
    {"hospital_section", 1086, 443, 66, 1805, 4, 1086, 0, 443},
    {"SFU_1200x615", 1200, 615, 32, 12699, 2, 1198, 4, 613},
    {"autolab", 809, 689, 5, 94, 2, 807, 2, 687},
    {"uoa_robotics_lab", 566, 1262, 2, 76, 30, 535, 22, 1240},
    {"mbicp", 420, 300, 38, 1086, 64, 336, 55, 198},
    {"space_invader", 122, 101, 5, 66, 13, 109, 13, 83},
    {"ghost", 23, 20, 3, 70, 4, 18, 3, 17},
    {"889_05", 1086, 443, 63, 1665, 4, 1086, 0, 443},
    {"SRI-AIC-kwing", 856, 293, 453, 8937, 15, 849, 44, 235},
    {"frieburg", 1000, 898, 52, 8145, 27, 919, 30, 817},
    {"human_outline", 200, 200, 1, 368, 22, 177, 2, 183},
    {"rink", 805, 805, 2, 3706, 6, 801, 4, 799},
    {"sal2", 887, 407, 19, 82, 0, 885, 60, 405},
    {"simple_rooms", 400, 300, 2, 60, 0, 400, 0, 300},
    {"submarine", 200, 99, 36, 962, 4, 195, 3, 98},
    {"submarine_small", 100, 50, 29, 517, 2, 97, 1, 49},
    {"table", 676, 288, 2, 682, 2, 675, 3, 285},
});

TEST(Conformance13, PolygonsVerticesAndBoxesOfStagesBitmaps) {
  const fs::path bitmaps = test::source_dir() / "../shared/stage-worlds/bitmaps";
  if (!fs::exists(bitmaps)) GTEST_SKIP() << "Stage's data are not in " << bitmaps;
  std::size_t tried = 0;
  for (const Counted& expected : k_stage_bitmaps) {
    const fs::path file = bitmaps / (std::string(expected.name) + ".png");
    if (!fs::exists(file)) continue;
    expect_counts(file, expected);
    ++tried;
  }
  EXPECT_GE(tried, 7u);
}

// Worked out by hand: contours begin at their leftmost, of those their uppermost corner and go clockwise
// around what is solid; of two ways on at a corner the one to the smaller (x, y) comes first; what lies on a
// straight line vanishes, but never the second of the first three corners.
TEST(Conformance13, PolygonsAndVerticesOfSmallImages) {
  struct Small {
    std::vector<std::string> rows;
    std::size_t polygons, vertices;
  };
  for (const Small& small : {
           Small{{"#"}, 1, 4},
           Small{{"##"}, 1, 5},           // (0 0) (1 0) (2 0) (2 1) (0 1)
           Small{{"####"}, 1, 5},         // (0 0) (1 0) (4 0) (4 1) (0 1)
           Small{{"#", "#", "#"}, 1, 5},  // (0 0) (1 0) (1 3) (0 3) (0 1)
           Small{{"##", "##"}, 1, 6},     // and (0 1), which ends it
           Small{{"###", "###", "###"}, 1, 6},
           Small{{"###", "#.#", "###"}, 2, 10},  // a hole of one pixel has 4
           Small{{"#####", "#...#", "#...#", "#...#", "#####"}, 2, 12},
           Small{{"#.", "##"}, 1, 7},
           Small{{"#.", ".#"}, 2, 8},  // left before right: they come apart
           Small{{".#", "#."}, 1, 8},  // up before down: they hang together
           Small{{"#.#", "...", "#.#"}, 4, 16},
       }) {
    const std::vector<Ring> rings = bitmap_contours(bitmap_of(small.rows));
    EXPECT_EQ(rings.size(), small.polygons) << testing::PrintToString(small.rows);
    EXPECT_EQ(vertices_of(rings), small.vertices) << testing::PrintToString(small.rows);
  }
}

}  // namespace
}  // namespace troupe::worldio::bitmap_test
