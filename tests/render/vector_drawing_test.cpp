#include "render/vector_drawing.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace troupe::render::vector_drawing_test {
namespace {

using engine::Frame;
using engine::FrameScene;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

std::size_t count_of(std::string_view text, std::string_view part) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != text.npos; at += part.size()) ++count;
  return count;
}

/// A wall from -2 to 2, 0.4 m thick, and robots of 1 x 1 m; shown from (-4, -2) to (4, 2) at 100 pixels a
/// metre.
struct Sheet {
  FrameScene scene;
  Frame frame;
  View view{.width = 800, .height = 400, .region = Box{{-4, -2}, {4, 2}}};

  Sheet() {
    const auto box = [](double x, double y, double z) {
      return engine::FrameShape{Solid{{{{-x, -y}, {x, -y}, {x, y}, {-x, y}}}, {0, z}}, std::nullopt};
    };
    scene.types = {{.shapes = {box(0.5, 0.5, 0.2)}, .mobile = true, .radius = 0.71, .name = "bot & co"},
                   {.shapes = {box(2, 0.2, 1)}, .mobile = false, .radius = 2.01, .name = "wall"}};
    scene.fixed = {{1, {0, -1, 0, 0}, {0.3F, 0.3F, 0.3F, 1}, false, 0}};
    frame.mobile = {{0, {1, 0.5, 0, 0}, {0, 0.4F, 0.8F, 1}, false, 1}};
    frame.time_s = 12.5;
  }
  std::string svg(const FileTexts& texts = {}) {
    return Painter(scene).draw_vector(frame, view, VectorFormat::svg, texts);
  }
};

TEST(VectorDrawing, RobotsArePolygonsAndLettersAreLetters) {
  Sheet sheet;
  const std::string svg = sheet.svg({{"world", "a<b.json"}, {"seed", "7"}});
  EXPECT_THAT(svg, StartsWith("<?xml"));
  EXPECT_THAT(svg, HasSubstr("width=\"800\" height=\"400\" viewBox=\"0 0 800 400\""));
  EXPECT_THAT(svg, HasSubstr("xml:space=\"preserve\""));
  EXPECT_THAT(svg, HasSubstr("<desc>world: a&lt;b.json\nseed: 7</desc>"));
  // The robot's top: two triangles of the raster, one polygon here. It stands from (0.5, 0) to (1.5, 1).
  EXPECT_THAT(svg, HasSubstr("<path d=\"M450 200L550 200 550 100 450 100Z\" fill=\"#0066cc\"/>"));
  // Its outline is one closed line.
  EXPECT_EQ(count_of(svg, "d=\"M450 200L550 200 550 100 450 100Z\" fill=\"none\""), 1U) << svg;
  EXPECT_THAT(svg, HasSubstr(">12.5 s</text>"));
  EXPECT_THAT(svg, HasSubstr(">1 m</text>"));
}

TEST(VectorDrawing, WhatIsHigherComesLater) {
  Sheet sheet;
  sheet.scene.types[0].shapes.insert(
      sheet.scene.types[0].shapes.begin(),
      engine::FrameShape{Solid{{{{-0.1, -0.1}, {0.1, -0.1}, {0.1, 0.1}, {-0.1, 0.1}}}, {0.2, 0.3}},
                         Color{1, 1, 0, 1}});
  const std::string svg = sheet.svg();
  EXPECT_LT(svg.find("fill=\"#0066cc\""), svg.find("fill=\"#ffff00\""));
  EXPECT_LT(svg.find("fill=\"#4d4d4d\""), svg.find("fill=\"#0066cc\""));  // walls below robots
}

TEST(VectorDrawing, BackgroundsAreThoseOfPixels) {
  Sheet sheet;
  EXPECT_THAT(sheet.svg(), HasSubstr("<rect width=\"800\" height=\"400\" fill=\"#faf7f0\"/>"));
  sheet.view.background = Background::dark;
  EXPECT_THAT(sheet.svg(), HasSubstr("<rect width=\"800\" height=\"400\" fill=\"#1b1d22\"/>"));
  sheet.view.background = Background::transparent;
  EXPECT_THAT(sheet.svg(), Not(HasSubstr("<rect")));
}

TEST(VectorDrawing, TransparentFansStayApart) {
  Sheet sheet;
  sheet.scene.rangers = {{0, 3, {{.pose_body = {}, .range_max = 1, .fov = 1, .first = 0, .samples = 3}}}};
  sheet.frame.scans = {{0, 0, 0, {}}, {0, 0, 3, {}}};
  sheet.frame.ranges = {1, 1, 1, 0.5F, 0.5F, 0.5F};
  sheet.view.layers.scans = true;
  const std::string svg = sheet.svg();
  EXPECT_EQ(count_of(svg, "fill-opacity=\"0.18\""), 2U) << svg;  // a polygon of four corners each
}

TEST(VectorDrawing, LegendsAndBoundsAreDrawn) {
  Sheet sheet;
  sheet.view.layers.types = true;
  EXPECT_THAT(sheet.svg(), HasSubstr(">bot &amp; co (1)</text>"));
  EXPECT_THAT(sheet.svg(), Not(HasSubstr("stroke=\"#3c3832\"")));
  sheet.scene.limits = Box{{-3, -1.5}, {3, 1.5}};
  EXPECT_THAT(sheet.svg(),
              HasSubstr("M100 350L700 350 700 50 100 50 100 350\" fill=\"none\" stroke=\"#3c3832\""));
  sheet.frame.values = {3};
  sheet.frame.value_name = "velocity.x (m/s)";
  sheet.view.values = std::pair(0.0, 5.0);
  const std::string svg = sheet.svg();
  EXPECT_THAT(svg, HasSubstr(">velocity.x (m/s)</text>"));
  EXPECT_THAT(svg, HasSubstr("text-anchor=\"end\""));
  EXPECT_THAT(svg, HasSubstr(">5</text>"));
  EXPECT_THAT(svg, Not(HasSubstr("bot &amp; co")));
}

TEST(VectorDrawing, LegendsCountAllRobotsOfTheirTypes) {
  Sheet sheet;
  sheet.view.layers.types = true;
  const engine::FrameBody first = sheet.frame.mobile[0];
  for (int i = 0; i < 200; ++i) {  // more colours than the legend compares
    sheet.frame.mobile.push_back(first);
    sheet.frame.mobile.back().color = {1, static_cast<float>(i) / 255.0F, 0, 1};
  }
  sheet.frame.mobile.insert(sheet.frame.mobile.end(), 4, first);
  EXPECT_THAT(sheet.svg(), HasSubstr(">bot &amp; co (5)</text>"));
}

TEST(VectorDrawing, LongLegendsEndAboveTheScaleBar) {
  Sheet sheet;
  sheet.view.layers.types = true;
  sheet.frame.mobile.clear();
  for (std::uint32_t i = 0; i < 20; ++i)  // outside of the picture, whose only red is that of the legend
    sheet.frame.mobile.push_back({0, {100, 0, 0, 0}, {1, static_cast<float>(i) / 255, 0, 1}, false, i + 1});
  const auto entries = [&](int width, int height) {
    sheet.view.width = width;
    sheet.view.height = height;
    const std::string svg = sheet.svg();
    EXPECT_EQ(count_of(svg, ">and more</text>"), 1U);
    EXPECT_EQ(count_of(svg, "fill=\"#ff"), count_of(svg, ">bot &amp; co (1)</text>")) << "one swatch each";
    return count_of(svg, ">bot &amp; co (1)</text>");
  };
  EXPECT_EQ(entries(800, 400), 11U);
  EXPECT_EQ(entries(240, 160), 4U);
  EXPECT_EQ(entries(1600, 1800), 11U);
}

TEST(VectorDrawing, NamesThatAreNoTextAreMadeOne) {
  Sheet sheet;
  sheet.view.layers.names = true;
  sheet.frame.names = {"a\x01<\xff\xc3\xa9\xed\xa0\x80"};
  EXPECT_THAT(sheet.svg(), HasSubstr(">a?&lt;?\xc3\xa9???"
                                     "</text>"));
  // Noncharacters, an overlong form and a character above U+10FFFF; but U+FFFD and U+10000 are text.
  sheet.frame.names = {
      "\xef\xbf\xbf|\xef\xb7\x90|\xf0\x9f\xbf\xbe|\xc0\xa0|\xf4\x90\x80\x80|\xef\xbf\xbd\xf0\x90\x80\x80"};
  EXPECT_THAT(sheet.svg(), HasSubstr(">???|???|????|??|????|\xef\xbf\xbd\xf0\x90\x80\x80</text>"));
  EXPECT_THAT(sheet.svg({{"world", "a\x01\xff.json"}}), HasSubstr("<desc>world: a??.json</desc>"));
}

TEST(VectorDrawing, OnlyMapsCanBeDrawnAsPaths) {
  Sheet sheet;
  sheet.view.camera.perspective = true;
  EXPECT_THROW(sheet.svg(), std::runtime_error);
}

TEST(VectorDrawing, APictureWithoutPixelsIsAnError) {
  for (const auto& [width, height] : {std::pair(0, 400), std::pair(800, 0), std::pair(-1, 400)}) {
    Sheet sheet;
    sheet.view.width = width;
    sheet.view.height = height;
    try {
      sheet.svg();
      FAIL() << width << " x " << height;
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(error.what(), fmt::format("cannot draw a picture of {} x {} pixels: each side must be at "
                                          "least 1",
                                          width, height));
    }
  }
}

TEST(VectorDrawing, APdfHoldsThePage) {
  Sheet sheet;
  sheet.frame.names = {"\xff\xef\xbf\xbf"};
  sheet.view.layers.names = true;
  std::string pdf;
  try {
    pdf = Painter(sheet.scene)
              .draw_vector(sheet.frame, sheet.view, VectorFormat::pdf, {{"world", "\xff.json"}});
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("apt install libcairo2"));
    GTEST_SKIP() << error.what();
  }
  EXPECT_THAT(pdf, StartsWith("%PDF-1."));
  EXPECT_THAT(pdf, HasSubstr("%%EOF"));
  EXPECT_THAT(pdf, HasSubstr("/MediaBox [ 0 0 600 300 ]"));  // 800 x 400 pixels of 1/96 inch, in points
  EXPECT_THAT(pdf, Not(HasSubstr("Date"))) << "equal input gives equal bytes, at any time";
}

}  // namespace
}  // namespace troupe::render::vector_drawing_test
