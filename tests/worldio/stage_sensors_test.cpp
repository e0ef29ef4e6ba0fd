#include "engine/kinds/sensor_params.hpp"
#include "tests/worldio/stage_fixture.hpp"
#include "troupe/registry.hpp"

namespace troupe::worldio::stage_sensors_test {
namespace {

using engine::get;
using testing::ElementsAre;
using testing::IsEmpty;

/// What a Stage world says of the sensors that look at bodies, as parameters of ours.
class StageSensors : public StageTest {
 protected:
  static const engine::Registry& registry() {
    static const engine::Registry all = make_registry();
    return all;
  }
  engine::WorldSpec load_all(std::string_view text) {
    return read(folder() / "w.world", std::string(text), {}, registry());
  }
  /// The one device of the one robot of the world; empty where the load went wrong.
  engine::DeviceSpec device(std::string_view children) {
    const engine::WorldSpec spec = load_all("position( " + std::string(children) + " )");
    if (spec.bodies.size() < 2 || type_of(spec, 1).devices.empty()) return {};
    return type_of(spec, 1).devices[0];
  }
  static const engine::Value& param(const engine::DeviceSpec& device, std::string_view name) {
    return get(registry().device(device.kind)->params, device.params, name);
  }
};

TEST_F(StageSensors, AFiducialFinderStandsOnItsParentWithUnitsAndKey) {
  const auto spec = load_all(
      "unit_length \"cm\"\n"
      "position( size [40 40 30] fiducial_return 3 fiducial_key 2\n"
      " fiducial( range_min 20 apply_range_min 1 range_max 400 range_max_id 150 fov 90 ignore_zloc 1 "
      "fiducial_key 7 ) )");
  const engine::TypeSpec& type = type_of(spec, 1);
  EXPECT_EQ(type.parts[0].returns.fiducial, 3);
  EXPECT_EQ(type.parts[0].returns.fiducial_key, 2);
  ASSERT_EQ(type.devices.size(), 1u);
  const engine::DeviceSpec& finder = type.devices[0];
  EXPECT_EQ(finder.kind, "fiducial");
  EXPECT_DOUBLE_EQ(finder.pose_body_device.z, 0.3);
  EXPECT_DOUBLE_EQ(param(finder, "range_min").number(), 0.2);
  EXPECT_TRUE(param(finder, "apply_range_min").boolean());
  EXPECT_DOUBLE_EQ(param(finder, "range_max").number(), 4);
  EXPECT_DOUBLE_EQ(param(finder, "range_max_id").number(), 1.5);
  EXPECT_DOUBLE_EQ(param(finder, "fov").number(), k_pi / 2);
  EXPECT_TRUE(param(finder, "ignore_zloc").boolean());
  EXPECT_EQ(param(finder, "key").integer(), 7);
}

TEST_F(StageSensors, ARadioIsAsThoseOfStage2) {
  const auto text = [](const engine::DeviceSpec& radio, std::string_view name) {
    return param(radio, name).text();
  };
  const auto number = [](const engine::DeviceSpec& radio, std::string_view name) {
    return param(radio, name).number();
  };
  const engine::DeviceSpec radio = device(
      "wifi( ip \"192.168.0.2\" mac \"08-00-20-ae-fd-7e\" essid \"test\" model \"friis\" power 30 "
      "sensitivity -40 )");
  EXPECT_EQ(radio.kind, "radio");
  EXPECT_EQ(text(radio, "channel"), "test");
  EXPECT_EQ(text(radio, "law"), "friis");
  EXPECT_EQ(text(radio, "walls"), "pass");
  EXPECT_EQ(number(radio, "power_dBm"), 30);
  EXPECT_EQ(number(radio, "sensitivity_dBm"), -40);
  EXPECT_EQ(number(radio, "range"), 1000);
  EXPECT_THAT(messages(), ElementsAre(testing::HasSubstr("ip of a radio, mac of a radio")));
  const engine::DeviceSpec indoor = device("wifi( model \"ITU indoor\" plc 22 )");
  EXPECT_EQ(text(indoor, "law"), "itu_indoor");
  EXPECT_EQ(number(indoor, "power_loss_coefficient"), 22);
  const engine::DeviceSpec distant = device("wifi( model \"log distance\" ple 3 range 50 )");
  EXPECT_EQ(text(distant, "law"), "log_distance");
  EXPECT_EQ(number(distant, "path_loss_exponent"), 3);
  EXPECT_EQ(number(distant, "range"), 50);
  const engine::DeviceSpec traced = device("wifi( model \"raytrace\" wall_factor 100 )");
  EXPECT_EQ(text(traced, "law"), "friis");
  EXPECT_EQ(text(traced, "walls"), "weaken");
  EXPECT_EQ(number(traced, "wall_loss_dB"), 100);
  const engine::DeviceSpec simple = device("wifi( model \"simple\" range 3.5 )");
  EXPECT_EQ(text(simple, "law"), "disc");
  EXPECT_EQ(text(simple, "walls"), "pass");
  EXPECT_EQ(number(simple, "range"), 3.5);
  EXPECT_EQ(number(device("wifi()"), "range"), 5);

  load_all("position( wifi( model \"fries\" ) )");
  EXPECT_THAT(messages(), testing::Contains(testing::HasSubstr(
                              "\"model\" must be one of simple, friis, ITU indoor, log distance, "
                              "raytrace (did you mean \"friis\"?), found \"fries\"")));
}

TEST_F(StageSensors, ARadioSaysInAWorldWhatItSaysInJson) {
  const engine::DeviceSpec radio = device(
      "radio( range 4 hears 6 walls \"block\" bodies \"block\" frequency 5 payload 12 most_heard 3 "
      "drop_rate 0.25 beacon 1 )");
  EXPECT_EQ(param(radio, "range").number(), 4);
  EXPECT_EQ(param(radio, "hears").number(), 6);
  EXPECT_EQ(param(radio, "walls").text(), "block");
  EXPECT_EQ(param(radio, "bodies").text(), "block");
  EXPECT_EQ(param(radio, "frequency_GHz").number(), 5);
  EXPECT_EQ(param(radio, "payload").integer(), 12);
  EXPECT_EQ(param(radio, "most_heard").integer(), 3);
  EXPECT_EQ(param(radio, "drop_rate").number(), 0.25);
  EXPECT_TRUE(param(radio, "beacon").boolean());
}

TEST_F(StageSensors, ABlobfinderFiltersByAsManyColoursAsItCounts) {
  const engine::DeviceSpec finder = device(
      "blobfinder( image [40 20] range 3 fov 90 pan 30 colors_count 2 colors [\"red\" \"blue\" \"green\"] )");
  EXPECT_EQ(param(finder, "image_width").integer(), 40);
  EXPECT_EQ(param(finder, "image_height").integer(), 20);
  EXPECT_EQ(param(finder, "range").number(), 3);
  EXPECT_DOUBLE_EQ(param(finder, "fov").number(), k_pi / 2);
  EXPECT_DOUBLE_EQ(param(finder, "pan").number(), k_pi / 6);
  EXPECT_THAT(param(finder, "colors").numbers(), ElementsAre(1, 0, 0, 0, 0, 1));
  EXPECT_THAT(param(device("blobfinder( colors [\"red\"] )"), "colors").numbers(), IsEmpty());
}

TEST_F(StageSensors, WrongColoursAreErrors) {
  device("blobfinder( colors_count 1 colors [\"rde\"] )");
  EXPECT_THAT(
      messages(),
      ElementsAre("w.world:1: error: unknown colour \"rde\"; colours are X11 names (did you mean \"red\"?)"));
  device("blobfinder( colors_count 3 colors [\"red\" \"blue\"] )");
  EXPECT_THAT(
      messages(),
      ElementsAre(
          "w.world:1: error: \"colors_count\" must be from 0 to 2, the number of \"colors\", found 3"));
  device("blobfinder( image [40.5 20] )");
  EXPECT_THAT(messages(), ElementsAre("w.world:1: error: \"image\" needs whole numbers, found 40.5"));
}

TEST_F(StageSensors, BumpersHaveALengthInCommonOrTheirOwn) {
  const engine::DeviceSpec bumper = device(
      "bumper( size [0.1 0.1 0.1] bcount 2 blength 0.3 blength[1] 0.2 bpose[0] [0.1 0.2 0 45] bpose[1] [0.1 "
      "-0.2 0 -45] )");
  const auto strips = engine::from_record<engine::BumperParams>(bumper.params).bumpers;
  ASSERT_EQ(strips.size(), 2u);
  EXPECT_EQ(strips[0].length, 0.3);
  EXPECT_EQ(strips[1].length, 0.2);
  EXPECT_DOUBLE_EQ(strips[1].pose.y, -0.2);
  EXPECT_DOUBLE_EQ(strips[1].pose.heading, -k_pi / 4);
}

TEST_F(StageSensors, WrongBumpersAreErrors) {
  device(
      "bumper( size [0.1 0.1 0.1] bcount 1 blength 0.3 bpose[0] [0 0 0 0] bpose[1] [0 0 0 90] blength[2] 1 "
      ")");
  EXPECT_THAT(
      messages(),
      ElementsAre(
          "w.world:1: warning: \"bpose[1]\" is ignored: \"bcount\" is 1, and bumpers are numbered from 0",
          "w.world:1: warning: \"blength[2]\" is ignored: \"bcount\" is 1, and bumpers are numbered from 0"));
  device("bumper( size [0.1 0.1 0.1] bcount 2 blength 0.3 bpose[0] [0 0 0 0] )");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:1: warning: bumper 1 (counted from 0) has no \"bpose[1]\": its "
                          "pose is that of the bumper model"));
  device("bumper( size [0.1 0.1 0.1] bcount 2 blength[0] 0.3 bpose[0] [0 0 0 0] bpose[1] [0 0 0 90] )");
  EXPECT_THAT(messages(), ElementsAre("w.world:1: error: bumper 1 (counted from 0) has no length: give "
                                      "\"blength\", for all bumpers, or \"blength[1]\""));
  device("bumper( size [0.1 0.1 0.1] bcount 0 )");
  EXPECT_THAT(messages(), ElementsAre("w.world:1: error: \"bcount\" must be from 1 to 1000, found 0"));
  device("bumper( size [0.1 0.1 0.1] )");
  EXPECT_THAT(messages(), ElementsAre("w.world:1: warning: a bumper without \"bcount\", the number of "
                                      "bumpers, senses nothing: give \"bcount\""));
}

TEST_F(StageSensors, ACameraIsWrittenInDegrees) {
  const engine::WorldSpec spec = load_all(
      "unit_length \"cm\" unit_angle \"radians\"\n"
      "position( camera( resolution [64 48] range [10 500] fov [60 45] pantilt [30 -10] alwayson 1 ) )");
  ASSERT_EQ(type_of(spec, 1).devices.size(), 1u);
  const engine::DeviceSpec& camera = type_of(spec, 1).devices[0];
  EXPECT_EQ(param(camera, "width").integer(), 64);
  EXPECT_EQ(param(camera, "height").integer(), 48);
  EXPECT_DOUBLE_EQ(param(camera, "range_near").number(), 0.1);
  EXPECT_DOUBLE_EQ(param(camera, "range_far").number(), 5);
  EXPECT_DOUBLE_EQ(param(camera, "fov_horizontal").number(), radians(60));
  EXPECT_DOUBLE_EQ(param(camera, "fov_vertical").number(), radians(45));
  EXPECT_DOUBLE_EQ(param(camera, "pan").number(), radians(30));
  EXPECT_DOUBLE_EQ(param(camera, "tilt").number(), radians(-10));
}

TEST_F(StageSensors, ABlinkenlightHasItsPeriodInMilliseconds) {
  const engine::DeviceSpec light = device("blinkenlight( period 250 dutycycle 0.4 enabled 0 )");
  EXPECT_DOUBLE_EQ(param(light, "period").number(), 0.25);
  EXPECT_EQ(param(light, "dutycycle").number(), 0.4);
  EXPECT_FALSE(param(light, "enabled").boolean());
}

TEST_F(StageSensors, NoiseIsAVarianceAShareAndAPartOfTheAngleBetweenBeams) {
  const engine::DeviceSpec ranger = device(
      "ranger( intensity 1 sensor( fov 180 samples 181 range [0.1 4] noise [0.01 0.2 10] beam_width 15 "
      "apply_range_min 1 ) )");
  const auto params = engine::from_record<engine::RangerParams>(ranger.params);
  const engine::TransducerParams& transducer = params.transducers.at(0);
  EXPECT_DOUBLE_EQ(transducer.noise_stddev, 0.1);
  EXPECT_EQ(transducer.noise_proportional, 0.2);
  EXPECT_DOUBLE_EQ(transducer.noise_angular, 0.5 * radians(1) * radians(10));
  EXPECT_DOUBLE_EQ(transducer.beam_width, radians(15));
  EXPECT_TRUE(transducer.apply_range_min);
  EXPECT_TRUE(params.intensity);
  device("ranger( sensor( noise [-1 0 0] ) )");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:1: error: \"noise\" needs values of 0 or above, [variance share angle], "
                          "found [-1 0 0]"));
}

}  // namespace
}  // namespace troupe::worldio::stage_sensors_test
