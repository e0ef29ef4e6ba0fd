#include "render/draw.hpp"

#include "base/fp_environment.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cfenv>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>

namespace troupe::render::draw_test {
namespace {

using engine::Frame;
using engine::FrameBody;
using engine::FrameScene;
using engine::FrameShape;
using engine::FrameType;
using ::testing::HasSubstr;

using Pixel = std::array<int, 3>;
constexpr Pixel k_paper = {250, 247, 240};
constexpr Pixel k_white = {255, 255, 255};
constexpr Pixel k_blue_pixel = {0, 51, 204};
constexpr Color k_blue = {0, 0.2F, 0.8F, 1};
constexpr Color k_gray30 = {0.302F, 0.302F, 0.302F, 1};
constexpr Pixel k_gray30_pixel = {77, 77, 77};

Ring rectangle(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

FrameType type_of(std::vector<Ring> contours, bool mobile, double height = 0.2) {
  FrameType type;
  double radius = 0;
  for (const Ring& ring : contours) {
    for (const Vec2& p : ring) radius = std::max(radius, p.norm());
  }
  type.shapes = {FrameShape{Solid{std::move(contours), {0, height}}, std::nullopt}};
  type.mobile = mobile;
  type.radius = radius;
  return type;
}

FrameBody body_at(std::uint32_t type, Pose pose, Color color) { return {type, pose, color, false}; }

/// Type 0: a robot of 1 x 1 m. Shown from (-4, -2) to (4, 2) at 100 pixels a metre.
struct Stage {
  FrameScene scene;
  Frame frame;
  View view{800, 400, Box{{-4, -2}, {4, 2}}};
  Picture picture;

  Stage() { scene.types = {type_of({rectangle(-0.5, -0.5, 0.5, 0.5)}, true)}; }

  std::uint32_t add_fixed(std::vector<Ring> contours, double height = 1) {
    scene.types.push_back(type_of(std::move(contours), false, height));
    const auto type = static_cast<std::uint32_t>(scene.types.size() - 1);
    scene.fixed.push_back(body_at(type, {}, k_gray30));
    return type;
  }
  void draw() { picture = render::draw(scene, frame, view); }

  Pixel pixel(int column, int row) const {
    const std::size_t i = 4 * (static_cast<std::size_t>(row) * picture.width + column);
    EXPECT_EQ(picture.rgba[i + 3], 255);
    return {picture.rgba[i], picture.rgba[i + 1], picture.rgba[i + 2]};
  }
  /// The pixel that holds a world point, at 100 pixels a metre with (-4, 2) in the upper left corner.
  Pixel at(double x, double y) const {
    return pixel(static_cast<int>(std::floor((x + 4) * 100)), static_cast<int>(std::floor((2 - y) * 100)));
  }
  int count(const std::function<bool(const Pixel&)>& wanted) const {
    int n = 0;
    for (int row = 0; row < picture.height; ++row) {
      for (int column = 0; column < picture.width; ++column) n += wanted(pixel(column, row));
    }
    return n;
  }
};

TEST(Draw, RobotsHaveTheirColourAndAMarkAtTheFront) {
  Stage stage;
  stage.frame.mobile = {body_at(0, {1.05, 0.55, 0, k_pi / 2}, k_blue)};  // looks up
  stage.draw();
  EXPECT_EQ(stage.at(1.05, 0.55), k_blue_pixel);
  EXPECT_EQ(stage.at(1.05, 0.75), k_white);       // ahead
  EXPECT_EQ(stage.at(1.05, 0.35), k_blue_pixel);  // behind
  EXPECT_EQ(stage.at(1.25, 0.55), k_blue_pixel);  // right
  EXPECT_EQ(stage.at(0.85, 0.55), k_blue_pixel);  // left
  EXPECT_EQ(stage.at(1.05, 1.25), k_paper);
}

TEST(Draw, MarksAreDarkOnLightRobotsAndFollowTheColourUnderThem) {
  Stage stage;
  FrameType with_laser = stage.scene.types[0];
  with_laser.shapes.insert(
      with_laser.shapes.begin(),
      FrameShape{Solid{{rectangle(0, -0.3, 0.4, 0.3)}, {0.2, 0.3}}, Color{0, 0, 0.4F, 1}});
  stage.scene.types.push_back(with_laser);
  stage.frame.mobile = {body_at(0, {-2.5, 0.5, 0, 0}, Color{1, 1, 0, 1}),
                        body_at(1, {2.5, 0.5, 0, 0}, Color{1, 1, 0, 1})};
  stage.draw();
  EXPECT_EQ(stage.at(-2.25, 0.5), (Pixel{38, 36, 33}));
  EXPECT_EQ(stage.at(2.25, 0.5), (Pixel{255, 255, 0}));
  EXPECT_EQ(stage.at(2.53, 0.7),
            (Pixel{0, 0, 102}));  // the laser, higher, though it stands first in the type
  EXPECT_EQ(stage.at(2.75, 0.5), k_white);
}

TEST(Draw, MarksAreOnTheBodyOfARobotWithPaddles) {
  Stage stage;
  FrameType& robot = stage.scene.types[0];
  robot.shapes = {FrameShape{Solid{{rectangle(-0.5, -0.5, 0.2, 0.5)}, {0, 0.3}}, std::nullopt},
                  FrameShape{Solid{{rectangle(0.2, 0.35, 0.9, 0.5)}, {0, 0.2}}, std::nullopt},
                  FrameShape{Solid{{rectangle(0.2, -0.5, 0.9, -0.35)}, {0, 0.2}}, std::nullopt}};
  robot.radius = 1.03;
  stage.frame.mobile = {body_at(0, {0.05, 0.05, 0, 0}, k_blue)};
  stage.draw();
  EXPECT_EQ(stage.at(0.02, 0.05), k_white);
  EXPECT_EQ(stage.at(0.65, 0.05), k_paper) << "between the paddles";
}

TEST(Draw, FixedBodiesHaveNoMark) {
  Stage stage;
  stage.scene.fixed = {body_at(0, {0.5, 0.5, 0, 0}, k_blue)};
  stage.scene.types[0].mobile = false;
  stage.draw();
  EXPECT_EQ(stage.at(0.75, 0.5), k_blue_pixel);
}

TEST(Draw, OutlinesAreDarkerAndRedWhenStalled) {
  Stage stage;
  stage.frame.mobile = {body_at(0, {-1.5, 0.5, 0, 0}, k_blue), body_at(0, {1.5, 0.5, 0, 0}, k_blue)};
  stage.frame.mobile[1].stalled = true;
  stage.draw();
  const Pixel edge = stage.pixel(299, 150);  // the last inside the right side of the first, x = -1
  EXPECT_LT(edge[2], 180);
  const Pixel stalled = stage.pixel(599, 150);
  EXPECT_GT(stalled[0], 150);
  EXPECT_EQ(stage.at(1.5, 0.5), k_blue_pixel);
}

// At 100 pixels a metre, this shape is 3 pixels wide.
TEST(Draw, SmallShapesAreNotHiddenByTheirOutlines) {
  Stage stage;
  stage.scene.types[0].shapes.push_back(
      FrameShape{Solid{{rectangle(-0.205, -0.205, -0.175, -0.175)}, {0.2, 0.3}}, Color{0, 1, 0, 1}});
  stage.frame.mobile = {body_at(0, {0.5, 0.5, 0, 0}, k_blue)};
  stage.draw();
  EXPECT_EQ(stage.at(0.31, 0.31), (Pixel{0, 255, 0}));
  EXPECT_EQ(stage.at(0.5, 0.5), k_blue_pixel);
}

TEST(Draw, RobotsOfSmallShapesOnlyHaveOutlines) {
  Stage stage;
  stage.scene.types = {type_of({rectangle(-0.2, -0.02, -0.16, 0.02)}, true)};
  stage.scene.types[0].shapes.push_back(
      FrameShape{Solid{{rectangle(0.16, -0.02, 0.2, 0.02)}, {0, 0.2}}, std::nullopt});
  stage.frame.mobile = {body_at(0, {0.5, 0.5, 0, 0}, k_blue)};
  stage.frame.mobile[0].stalled = true;
  stage.draw();
  EXPECT_GT(stage.count([](const Pixel& p) { return p[0] > 150 && p[1] < 80 && p[2] < 80; }), 0);
}

TEST(Draw, ShapesOfAColourOfTheirOwnAreOutlinedInRedToo) {
  Stage stage;
  stage.scene.types[0].shapes[0].color = Color{0, 1, 0, 1};
  stage.frame.mobile = {body_at(0, {0.5, 0.5, 0, 0}, k_blue)};
  const auto red = [&] {
    stage.draw();
    return stage.count([](const Pixel& p) { return p[0] > 150 && p[1] < 80 && p[2] < 80; });
  };
  EXPECT_EQ(red(), 0);
  stage.frame.mobile[0].stalled = true;
  EXPECT_GT(red(), 40);
}

TEST(Draw, AStalledRobotIsSeenWhateverItsColour) {
  const std::array<Color, 4> colors = {Color{0.88F, 0.13F, 0.13F, 1}, Color{1, 1, 1, 1}, k_blue,
                                       Color{0, 0, 0, 1}};
  for (const Color& color : colors) {
    Stage stage;
    stage.frame.mobile = {body_at(0, {0.5, 0.5, 0, 0}, color)};
    stage.draw();
    const Picture moving = stage.picture;
    stage.frame.mobile[0].stalled = true;
    stage.draw();
    // On the robot, along its side: pixels that differ much from what they are of one that moves.
    int marked = 0;
    for (int row = 110; row < 190; ++row) {
      int in_row = 0;
      for (int column = 400; column < 410; ++column) {
        const std::size_t i = 4 * (static_cast<std::size_t>(row) * 800 + static_cast<std::size_t>(column));
        int difference = 0;
        for (std::size_t k = 0; k < 3; ++k)
          difference = std::max(difference, std::abs(stage.picture.rgba[i + k] - moving.rgba[i + k]));
        in_row += difference > 90;
      }
      marked += in_row > 0;
    }
    EXPECT_GE(marked, 75) << color.r << " " << color.g << " " << color.b;
  }
}

TEST(Draw, BackgroundsChangeWhatIsNoBody) {
  Stage stage;
  stage.frame.mobile = {body_at(0, {0.5, 0.5, 0, 0}, k_blue)};
  stage.view.background = Background::dark;
  stage.draw();
  EXPECT_EQ(stage.at(-3.3, 1.3), (Pixel{27, 29, 34}));
  EXPECT_EQ(stage.at(0.5, 0.5), k_blue_pixel);
  stage.view.background = Background::transparent;
  stage.draw();
  const auto opacity = [&](double x, double y) {
    const auto column = static_cast<std::size_t>((x + 4) * 100);
    const auto row = static_cast<std::size_t>((2 - y) * 100);
    return stage.picture.rgba[4 * (row * 800 + column) + 3];
  };
  EXPECT_EQ(opacity(-3.3, 1.3), 0);
  EXPECT_EQ(opacity(0.5, 0.5), 255);
  EXPECT_EQ(stage.at(0.5, 0.5), k_blue_pixel);
}

TEST(Draw, TransparentColorsAreBlended) {
  // Opaque layers are drawn without blending, so each way to give a body a transparent colour is tested.
  const Color half{0, 0.2F, 0.8F, 0.5F};
  const Pixel on_paper{125, 149, 222};  // the mean of the colours of body and floor
  const auto expect_near = [](const Pixel& found, const Pixel& expected, const char* what) {
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(found[k], expected[k], 1) << what << ", part " << k;
  };
  Stage stage;
  stage.view.layers.headings = stage.view.layers.shadows = false;
  stage.frame.mobile = {body_at(0, {0, 0, 0, 0}, half), body_at(0, {2, 0, 0, 0}, k_blue)};
  stage.draw();
  expect_near(stage.at(0.2, 0.2), on_paper, "a body of a map");
  EXPECT_EQ(stage.at(2.2, 0.2), k_blue_pixel);

  stage.view.camera.pitch = 1e-3;  // not a map, but nearly seen from above
  stage.draw();
  expect_near(stage.at(0.2, 0.2), on_paper, "a solid");

  Stage shaped;
  shaped.view.layers.headings = shaped.view.layers.shadows = false;
  shaped.scene.types[0].shapes[0].color = half;
  shaped.frame.mobile = {body_at(0, {0, 0, 0, 0}, k_gray30)};
  shaped.draw();
  expect_near(shaped.at(0.2, 0.2), on_paper, "a shape of a map");
  shaped.view.camera.pitch = 1e-3;
  shaped.draw();
  expect_near(shaped.at(0.2, 0.2), on_paper, "a shape of a solid");

  Stage far;  // robots are dots
  far.view.layers.grid = false;
  far.view.region = Box{{-400, -200}, {400, 200}};
  far.frame.mobile = {body_at(0, {0, 0, 0, 0}, half)};
  far.draw();
  far.view.region = Box{{-4, -2}, {4, 2}};  // at() counts 100 pixels per metre
  expect_near(far.at(0, 0), on_paper, "a dot");
}

TEST(Draw, ColoursOfTransparentPicturesAreNotMultipliedByTheOpacity) {
  Stage stage;
  stage.view.background = Background::transparent;
  stage.view.layers.headings = stage.view.layers.shadows = stage.view.layers.grid = false;
  stage.frame.mobile = {body_at(0, {-2, 0, 0, 0}, Color{0, 0.2F, 0.8F, 0.5F}),
                        body_at(0, {2, 0, 0, 0.3}, Color{1, 0, 0, 1})};
  for (const double pitch : {0.0, 1e-3}) {  // a map; solids, nearly seen from above
    stage.view.camera.pitch = pitch;
    stage.draw();
    const auto value = [&](int column, int row, int part) {
      return stage.picture
          .rgba[4 * static_cast<std::size_t>(row * 800 + column) + static_cast<std::size_t>(part)];
    };
    EXPECT_NEAR(value(200, 200, 0), 0, 1);
    EXPECT_NEAR(value(200, 200, 1), 51, 1);
    EXPECT_NEAR(value(200, 200, 2), 204, 1);
    EXPECT_NEAR(value(200, 200, 3), 128, 1);
    // Pixels that the outline, which is darker than the body, covers in part.
    int on_edges = 0;
    for (int row = 100; row < 300; ++row) {
      for (int column = 500; column < 700; ++column) {
        if (value(column, row, 3) == 0 || value(column, row, 3) == 255) continue;
        ++on_edges;
        EXPECT_NEAR(value(column, row, 0), 165, 3) << column << ", " << row;
      }
    }
    EXPECT_GT(on_edges, 100);
  }
}

TEST(Draw, BoundsAreALineAndInThePicture) {
  Stage stage;
  stage.scene.limits = Box{{-3, -1}, {3, 1}};
  stage.draw();
  const Pixel line = stage.at(-2.5, 1.0);
  EXPECT_LT(line[0], 130);
  EXPECT_EQ(stage.at(-2.55, 1.05), k_paper);
  stage.view.layers.bounds = false;
  stage.draw();
  EXPECT_GT(stage.at(-2.5, 1.0)[0], 220);

  stage.view = {.width = 800, .height = 400};  // framed by itself: robots may go there
  stage.scene.bounds = {{-0.5, -0.5}, {0.5, 0.5}};
  stage.draw();
  const int dark = stage.count([](const Pixel& p) { return p[0] < 130; });
  EXPECT_GT(dark, 1500);
}

TEST(Draw, XPointsRightAndYUp) {
  Stage stage;
  const std::array colors = {Color{0, 0.4F, 0, 1}, Color{0.4F, 0, 0, 1}, Color{0, 0, 0.4F, 1},
                             Color{0.4F, 0, 0.4F, 1}};
  stage.frame.mobile = {body_at(0, {3, 1, 0, 0}, colors[0]), body_at(0, {-3, 1, 0, 0}, colors[1]),
                        body_at(0, {-3, -1, 0, 0}, colors[2]), body_at(0, {3, -1, 0, 0}, colors[3])};
  stage.draw();
  EXPECT_EQ(stage.pixel(700 - 20, 100), (Pixel{0, 102, 0}));
  EXPECT_EQ(stage.pixel(100 - 20, 100), (Pixel{102, 0, 0}));
  EXPECT_EQ(stage.pixel(100 - 20, 300), (Pixel{0, 0, 102}));
  EXPECT_EQ(stage.pixel(700 - 20, 300), (Pixel{102, 0, 102}));
}

TEST(Draw, FloorPlansAreEvenOddRegions) {
  Stage stage;
  // A wall with a room in it, and a pillar in the room; rings wind any way.
  Ring room = rectangle(-2.5, -0.5, -0.5, 1.5);
  std::ranges::reverse(room);
  stage.add_fixed({rectangle(-3, -1, 0, 2), room, rectangle(-1.8, 0.2, -1.2, 0.8)});
  stage.draw();
  for (const double x : {-2.75, -0.25, -1.5}) EXPECT_EQ(stage.at(x, 0.45), k_gray30_pixel) << x;
  for (const double x : {-3.3, -2.25, -0.75, 0.3}) EXPECT_EQ(stage.at(x, 0.45), k_paper) << x;
  for (const double y : {-0.75, 1.75}) EXPECT_EQ(stage.at(-1.5, y), k_gray30_pixel) << y;
}

TEST(Draw, ThinWallsStayVisible) {
  Stage stage;
  stage.view = {100, 50, Box{{-400, -200}, {400, 200}}};
  stage.add_fixed({rectangle(-300, 10, 300, 10.01)});
  stage.draw();
  EXPECT_GT(stage.count([](const Pixel& p) { return p[0] < 180; }), 60);
}

TEST(Draw, WallsThrowALightShadowToTheLowerRight) {
  Stage stage;
  stage.add_fixed({rectangle(-0.5, -0.5, 0.5, 0.5)});
  stage.draw();
  EXPECT_EQ(stage.pixel(451, 240), (Pixel{226, 220, 207}));
  EXPECT_EQ(stage.pixel(348, 240), k_paper);
}

TEST(Draw, ConcaveAndHollowRobotsShowTheFloor) {
  Stage stage;
  stage.scene.types.push_back(
      type_of({{{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0}, {0, 0}, {0, 0.5}, {-0.5, 0.5}}}, false));
  stage.scene.types.push_back(
      type_of({rectangle(-0.5, -0.5, 0.5, 0.5), rectangle(-0.3, -0.3, 0.3, 0.3)}, false));
  stage.frame.mobile = {body_at(1, {-2.5, 0.5, 0, 0}, k_blue), body_at(2, {2.5, 0.5, 0, 0}, k_blue)};
  stage.draw();
  EXPECT_EQ(stage.at(-2.25, 0.75), k_paper);
  EXPECT_EQ(stage.at(-2.75, 0.75), k_blue_pixel);
  EXPECT_EQ(stage.at(-2.25, 0.25), k_blue_pixel);
  EXPECT_EQ(stage.at(2.5, 0.5), k_paper);
  EXPECT_EQ(stage.at(2.1, 0.5), k_blue_pixel);
}

TEST(Draw, TheHigherCoversTheLowerAndRobotsCoverTheFloorPlan) {
  Stage stage;
  stage.add_fixed({rectangle(-3.5, -0.5, -0.5, 1.5)}, 3);
  const Color green = {0, 0.4F, 0, 1};
  stage.frame.mobile = {body_at(0, {2.5, 0.5, 1, 0}, k_blue), body_at(0, {2.8, 0.5, 0, 0}, green),
                        body_at(0, {-2.5, 0.5, 0, 0}, green)};
  stage.draw();
  EXPECT_EQ(stage.at(2.35, 0.5), k_blue_pixel);
  EXPECT_EQ(stage.at(2.45, 0.8), k_blue_pixel);  // both are here
  EXPECT_EQ(stage.at(3.2, 0.8), (Pixel{0, 102, 0}));
  EXPECT_EQ(stage.at(-2.7, 0.5), (Pixel{0, 102, 0}));
}

TEST(Draw, ScansCoverZonesOnTheFloorButNotWalls) {
  Stage stage;
  stage.add_fixed({rectangle(-3.5, -0.5, 3.5, 0.5)}, 0.01);
  stage.add_fixed({rectangle(2, -1, 3, 1)}, 1);
  stage.scene.rangers = {{0, 2, {{.range_max = 6, .fov = k_pi / 4, .first = 0, .samples = 2}}}};
  stage.frame.mobile = {body_at(0, {-3, 0, 0, 0}, k_blue)};
  stage.frame.scans = {{0, 0, 0, {}}};
  stage.frame.ranges = {6, 6};
  stage.view.layers.grid = false;
  stage.draw();
  EXPECT_EQ(stage.at(0, 0), k_gray30_pixel);
  stage.view.layers.scans = true;
  stage.draw();
  EXPECT_GT(stage.at(0, 0)[2], k_gray30_pixel[2] + 10);  // the zone, under the blue scan
  EXPECT_LT(stage.at(0, 1)[0], k_paper[0] - 10);         // the floor
  EXPECT_EQ(stage.at(2.5, 0), k_gray30_pixel);           // the wall
}

TEST(Draw, BodiesAreBlendedByTheirOpacity) {
  Stage stage;
  stage.frame.mobile = {body_at(0, {0.5, 0.5, 0, 0}, Color{0, 0, 0, 0.5F})};
  stage.draw();
  EXPECT_NEAR(stage.at(0.35, 0.5)[0], 125, 2);
}

TEST(Draw, TheRegionReachesThePicturesEdges) {
  Stage stage;
  stage.add_fixed({rectangle(-4, -2, -3.8, -1.8), rectangle(3.8, -2, 4, -1.8), rectangle(3.8, 1.8, 4, 2),
                   rectangle(-4, 1.8, -3.8, 2)});
  stage.draw();
  for (const int column : {2, 797}) {
    for (const int row : {2, 397})
      EXPECT_EQ(stage.pixel(column, row), k_gray30_pixel) << column << ", " << row;
  }
  for (const int column : {30, 770}) EXPECT_EQ(stage.pixel(column, 2), k_paper) << column;
}

TEST(Draw, ShapesKeepTheirProportions) {
  Stage stage;
  // Half as wide as the picture: more of the world is seen on both sides.
  stage.view.region = Box{{-2, -2}, {2, 2}};
  stage.frame.mobile = {body_at(0, {3.5, 0.5, 0, 0}, k_blue)};
  stage.draw();
  EXPECT_EQ(stage.at(3.4, 0.5), k_blue_pixel);
  // 1 m^2, less the inner half of the outline and the mark.
  EXPECT_NEAR(stage.count([](const Pixel& p) { return p == k_blue_pixel; }), 10000 - 400 - 880, 100);
}

TEST(Draw, TheWholeSceneIsSeenByDefault) {
  for (const auto& [width, height] : {std::pair{300, 900}, std::pair{900, 300}, std::pair{100, 100}}) {
    Stage stage;
    stage.view = {width, height, std::nullopt};
    stage.scene.bounds = {{100, -20}, {140, 20}};
    stage.add_fixed({rectangle(100, -20, 140, 20), rectangle(101, -19, 139, 19)});
    stage.draw();
    const auto dark = [](const Pixel& p) { return p[0] < 150 && p[0] == p[1]; };
    int left = width, right = 0, top = height, bottom = 0;
    for (int row = 0; row < height - (width > 240 ? 40 : 0); ++row) {
      for (int column = 0; column < width; ++column) {
        if (!dark(stage.pixel(column, row))) continue;
        left = std::min(left, column), right = std::max(right, column);
        top = std::min(top, row), bottom = std::max(bottom, row);
      }
    }
    EXPECT_NEAR(right - left, bottom - top, 2);
    EXPECT_GT(std::max<double>(right - left, bottom - top), 0.8 * std::min(width, height));
    EXPECT_GE(left, 2);
    EXPECT_GE(top, 2);
    EXPECT_LT(right, width - 2);
    EXPECT_NEAR(left, width - 1 - right, 2);
  }
}

TEST(Draw, SmallRobotsStayVisibleInAHugeWorld) {
  Stage stage;
  stage.view = {800, 400, std::nullopt};
  stage.scene.bounds = {{-1e6, -5e5}, {1e6, 5e5}};
  stage.frame.mobile = {body_at(0, {0, 0, 0, 0}, k_blue), body_at(0, {8e5, 3e5, 0, 0}, k_blue)};
  stage.draw();
  const int blueish = stage.count([](const Pixel& p) { return p[2] > p[0] + 60; });
  EXPECT_GE(blueish, 8);
  EXPECT_LE(blueish, 60);
}

TEST(Draw, WhatLiesOutsideIsLeftOut) {
  Stage stage;
  stage.frame.mobile = {body_at(0, {4.4, 0.5, 0, 0}, k_blue), body_at(0, {50, 0, 0, 0}, k_blue),
                        body_at(0, {1e12, -1e12, 0, 0}, k_blue)};
  stage.draw();
  EXPECT_EQ(stage.pixel(797, 150), k_blue_pixel);  // the first reaches into the picture
  EXPECT_LT(stage.count([](const Pixel& p) { return p[2] > p[0] + 60; }), 11 * 104);  // 0.1 m and its outline
}

TEST(Draw, AnEmptyWorldIsAFloor) {
  const Picture picture = draw({}, {}, {64, 48, std::nullopt});
  EXPECT_EQ(picture.width, 64);
  EXPECT_EQ(picture.height, 48);
  ASSERT_EQ(picture.rgba.size(), 64U * 48 * 4);
  EXPECT_EQ(picture.rgba[0], 250);
  EXPECT_EQ(draw({}, {}, {1, 1, std::nullopt}).rgba.size(), 4U);
}

TEST(Draw, ASceneWithoutExtentIsDrawn) {
  Stage stage;
  stage.view = {200, 200, std::nullopt};
  stage.scene.bounds = Box::around({3, 3}, 0);
  stage.frame.mobile = {body_at(0, {3, 3, 0, 0}, k_blue)};
  stage.draw();
  EXPECT_EQ(stage.pixel(90, 100), k_blue_pixel);
}

TEST(Draw, BodiesWithoutShapesAreNothing) {
  Stage stage;
  stage.scene.types.push_back({{}, true, 0.5});
  stage.draw();
  const Picture empty = stage.picture;
  stage.frame.mobile = {body_at(1, {0, 0, 0, 0}, k_blue)};
  stage.scene.fixed = {body_at(1, {0, 0, 0, 0}, k_blue)};
  stage.draw();
  EXPECT_EQ(stage.picture.rgba, empty.rgba);
}

TEST(Draw, TheTimeStandsInTheLowerRightCorner) {
  Stage stage;
  stage.draw();
  const Picture before = stage.picture;
  stage.frame.time_s = 12.5;
  stage.draw();
  int left = 800, top = 400;
  for (int i = 0; i < 800 * 400; ++i) {
    if (std::equal(&before.rgba[4 * i], &before.rgba[4 * i] + 4, &stage.picture.rgba[4 * i])) continue;
    left = std::min(left, i % 800);
    top = std::min(top, i / 800);
  }
  EXPECT_GT(left, 700);
  EXPECT_LT(left, 800);
  EXPECT_GT(top, 360);
}

TEST(Draw, PicturesLargerThanATileHaveNoSeams) {
  Stage stage;
  stage.view = {2300, 2100, Box{{0, 0}, {23, 21}}};
  stage.add_fixed({rectangle(0.5, 0.5, 22.5, 20.5)});
  stage.draw();
  EXPECT_EQ(stage.picture.rgba.size(), 2300U * 2100 * 4);
  int wrong = 0;
  for (int row = 60; row < 2020; ++row) {  // above the scale bar
    for (int column = 60; column < 2240; ++column) wrong += stage.pixel(column, row) != k_gray30_pixel;
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(stage.pixel(2280, 1000), k_paper);
}

TEST(Draw, FewAndManyVerticesGiveTheSamePixels) {
  Stage few;
  few.add_fixed({rectangle(-3.9, -1.51, 0, -1.42)});
  few.scene.fixed.back().pose_world_body.heading = 0.03;  // edges between the pixels
  for (int i = 0; i < 5; ++i)
    few.frame.mobile.push_back(body_at(0, {-3.3 + 1.2 * i, 0.3 * i - 0.4, 0, 0.37 * i}, k_blue));
  few.draw();
  Stage many = few;
  for (int i = 0; i < 3000; ++i) many.frame.mobile.push_back(body_at(0, {3.3, 1.3, 0, 0.1 * i}, k_blue));
  many.draw();
  int most = 0;
  int shades = 0;
  for (int row = 0; row < 400; ++row) {
    for (int column = 0; column < 600; ++column) {
      const Pixel a = few.pixel(column, row);
      const Pixel b = many.pixel(column, row);
      for (std::size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(a[c] - b[c]));
      shades += a != k_paper && a != k_blue_pixel && a != k_white && a != k_gray30_pixel;
    }
  }
  EXPECT_LE(most, 1) << "one is drawn once per sample, the other with multisampling";
  EXPECT_GT(shades, 1000) << "the edges are smooth";
}

TEST(Draw, TenThousandRobots) {
  Stage stage;
  stage.view = {1000, 1000, Box{{-100, -100}, {100, 100}}};
  stage.scene.types.assign(1, type_of({rectangle(-0.05, -0.05, 0.05, 0.05)}, true));
  for (int i = 0; i < 10000; ++i) {
    stage.frame.mobile.push_back(
        body_at(0, {-99.0 + 2 * (i % 100), -99.0 + 2 * (i / 100), 0, 0.1 * i}, k_blue));
  }
  stage.draw();
  int seen = 0;  // in the rows above the scale bar
  for (int i = 0; i < 9500; ++i) seen += stage.pixel(5 + 10 * (i % 100), 5 + 10 * (i / 100))[2] > 180;
  EXPECT_EQ(seen, 9500);
}

TEST(Draw, TheSameInputGivesTheSameBytesOnAnyThread) {
  Stage stage;
  stage.add_fixed({rectangle(-3, -1, 0, 2), rectangle(-2, 0, -1, 1)});
  for (int i = 0; i < 300; ++i) {
    stage.frame.mobile.push_back(body_at(0, {0.02 * i - 3, 0.01 * i - 1.5, 0, 0.1 * i}, k_blue));
  }
  stage.draw();
  const Picture first = stage.picture;
  stage.draw();
  EXPECT_EQ(first.rgba, stage.picture.rgba);
  std::thread([&] { stage.draw(); }).join();
  EXPECT_EQ(first.rgba, stage.picture.rgba);
}

TEST(Draw, LeavesTheFloatingPointEnvironmentAlone) {
  Stage stage;
  stage.frame.mobile = {body_at(0, {0.1, 0.1, 0, 1}, k_blue)};
  std::feclearexcept(FE_ALL_EXCEPT);
  stage.draw();
  EXPECT_EQ(std::fetestexcept(FE_ALL_EXCEPT), 0);
  EXPECT_TRUE(check_fp_environment());
}

std::string error_of(const View& view) {
  try {
    draw({}, {}, view);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Draw, NamesTheLimitOfTheDriver) {
  EXPECT_THAT(error_of({1'000'000, 10, std::nullopt}),
              ::testing::MatchesRegex(
                  "cannot draw a picture of 1000000 x 10 pixels: each side must be at least 1, and this "
                  "OpenGL driver draws at most [0-9]+ x [0-9]+"));
  EXPECT_THAT(error_of({10, 1'000'000, std::nullopt}), HasSubstr("10 x 1000000 pixels"));
  EXPECT_THAT(error_of({0, 10, std::nullopt}), HasSubstr("0 x 10 pixels: each side must be at least 1"));
  EXPECT_THAT(error_of({10, -1, std::nullopt}), HasSubstr("10 x -1 pixels: each side must be at least 1"));
}

TEST(Draw, RefusesRegionsWithoutASize) {
  const std::string text = "cannot draw: the region of the view must be finite and of positive size";
  EXPECT_THAT(error_of({10, 10, Box{}}), HasSubstr(text));
  EXPECT_EQ(error_of({10, 10, Box{{0, 0}, {1, 0}}}), text + ", found [[0, 0], [1, 0]]");
  EXPECT_THAT(error_of({10, 10, Box{{0, 0}, {std::nan(""), 1}}}), HasSubstr(text));
}

}  // namespace
}  // namespace troupe::render::draw_test
