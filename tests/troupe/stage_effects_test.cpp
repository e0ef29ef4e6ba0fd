#include "engine/world/world.hpp"
#include "tests/support/scratch.hpp"
#include "troupe/registry.hpp"
#include "troupe/simulation.hpp"
#include "worldio/convert.hpp"
#include "worldio/images/png.hpp"
#include "worldio/json/spec_json.hpp"
#include "worldio/stage/stage_properties.hpp"

#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace troupe::stage_effects_test {
namespace {

using worldio::StageRow;
using worldio::StageSupport;

/// Two worlds that differ in one property alone: `world` with `property` in place of its @, and without.
/// A property that is no longer honoured makes them equal.
struct Effect {
  enum class Where {
    run,    ///< in the state at some tick
    grid,   ///< the same, with the ray engine that has cells
    loaded  ///< in what is loaded: names, colours, and what a viewer or the run itself goes by
  };
  std::string_view type, name;  ///< as in the table of properties
  std::string_view world;
  std::string_view property;
  Where where = Where::run;
};

using enum Effect::Where;

// What looks at a box in front of it, what drives, and what drives by what it sees.
constexpr std::string_view k_macros =
    "define eye position( size [0.2 0.2 0.2]\n"
    "  ranger( alwayson 1 sensor( range [0 8] fov 180 samples 19 ) ) )\n"
    "define mover position( size [0.2 0.2 0.2] ctrl \"script wave\" )\n"
    "define wanderer position( size [0.2 0.2 0.2] ctrl \"wander\"\n"
    "  ranger( sensor( range [0 8] fov 180 samples 19 ) ) )\n";

constexpr Effect k_effects[] = {
    {"world", "name", "@", "name \"arena\"", loaded},
    {"world", "interval_sim", "@ mover()", "interval_sim 50"},
    {"world", "quit_time", "@", "quit_time 7", loaded},
    {"world", "unit_length", "@ mover( pose [1 0 0 0] )", "unit_length \"cm\""},
    {"world", "unit_angle", "@ mover( pose [0 0 0 1] )", "unit_angle \"radians\""},
    {"world", "wrap_headings",
     "@ position( size [0.2 0.2 0.2] ctrl \"expand\" ranger( sensor( pose [0 0 0 190] )\n"
     "  sensor( pose [0 0 0 250] ) sensor( pose [0 0 0 340] ) ) ) model( pose [-2 0 0 0] )",
     "wrap_headings 0"},
    {"world", "show_clock", "@", "show_clock 1", loaded},
    {"world", "show_clock_interval", "@", "show_clock_interval 10", loaded},
    {"world", "speedup", "@", "speedup 4", loaded},
    {"world", "seed", "@ wanderer() model( pose [0.5 0.1 0 0] )", "seed 7"},
    {"world", "resolution", "@ eye() model( pose [2 0.3 0 10] )", "resolution 0.3", grid},

    {"model", "name", "model( @ )", "name \"x\"", loaded},
    {"model", "pose", "eye() model( pose [2 0 0 0] @ )", "pose [2 0 0 30]"},
    {"model", "size", "eye() model( pose [2 0 0 0] @ )", "size [1 1 1]"},
    {"model", "origin", "eye() model( pose [2 0 0 0] @ )", "origin [0.1 0 0 0]"},
    {"model", "update_interval", "mover( @ )", "update_interval 300"},
    {"model", "color", "model( @ )", "color \"blue\"", loaded},
    {"model", "color_rgba", "model( @ )", "color_rgba [0 0 1 1]", loaded},
    {"model", "bitmap", "eye() model( pose [2 0 0 0] @ )", "bitmap \"corner.png\""},
    {"model", "bitmap_margins", "eye() model( pose [2 0 0 0] bitmap \"dot.png\" @ )", "bitmap_margins 1"},
    {"model", "bitmap_unknown", "eye() model( pose [2 0 0 180] bitmap \"map.yaml\" @ )", "bitmap_unknown 1"},
    {"model", "noblocks", "eye() model( pose [2 0 0 0] @ )", "noblocks 1"},
    {"model", "boundary", "eye() model( size [4 4 1] noblocks 1 @ )", "boundary 1"},
    {"model", "stack_children", "eye() model( pose [2 0 0 0] noblocks 1 model() @ )", "stack_children 0"},
    {"model", "obstacle_return", "mover() model( pose [0.5 0 0 0] @ )", "obstacle_return 0"},
    {"model", "ranger_return", "eye() model( pose [2 0 0 0] @ )", "ranger_return -1"},
    {"model", "fiducial_return", "model( @ )", "fiducial_return 7", loaded},
    {"model", "fiducial_key", "model( @ )", "fiducial_key 7", loaded},
    {"model", "gripper_return",
     "gripper( alwayson 1 autosnatch 1 ) model( size [0.1 0.1 0.1] pose [0.04 0 0 0] @ )",
     "gripper_return 1"},
    {"model", "blob_return", "model( @ )", "blob_return 0", loaded},
    {"model", "ctrl", "position( @ )", "ctrl \"script line\""},
    {"model", "alwayson", "position( ranger( sensor() @ ) )", "alwayson 1"},
    {"model", "mass", "mover( joules 100 @ )", "mass 5"},
    {"model", "watts", "model( joules 100 alwayson 1 @ )", "watts 5"},
    {"model", "joules", "mover( @ )", "joules 1"},
    {"model", "kjoules", "mover( @ )", "kjoules 1"},
    {"model", "joules_capacity", "mover( joules 100 @ )", "joules_capacity 200"},
    {"model", "kjoules_capacity", "mover( joules 100 @ )", "kjoules_capacity 1"},
    {"model", "when_empty", "mover( joules 0.3 @ )", "when_empty \"nothing\""},
    {"model", "give_watts",
     "model( joules -1 alwayson 1 @ ) model( pose [1 0 0 0] size [2 1 1] joules 5 joules_capacity 9 "
     "take_watts 3 )",
     "give_watts 5"},
    {"model", "take_watts",
     "model( joules -1 alwayson 1 give_watts 5 ) model( pose [1 0 0 0] size [2 1 1] joules_capacity 9 @ )",
     "take_watts 3"},

    {"block", "points",
     "eye() model( pose [2 0 0 0] block( points 3 point[0] [0 -1] point[1] [1 -1] point[2] [1 0]\n"
     "  point[3] [0 1] z [0 1] @ ) )",
     "points 4"},
    {"block", "point[k]",
     "eye() model( pose [2 0 0 0] block( points 3 point[0] [0 0] point[1] [1 -1] point[2] [1 1] z [0 1] @ ) "
     ")",
     "point[0] [0 -1]"},
    {"block", "z",
     "eye() model( pose [2 0 0 0] block( points 3 point[0] [0 0] point[1] [1 -1] point[2] [1 1] z [0 1] @ ) "
     ")",
     "z [0.5 1]"},

    {"position", "drive", "mover( @ )", "drive \"car\""},
    {"position", "velocity_bounds", "mover( @ )", "velocity_bounds [0 0.1 0 0 0 0 -10 10]"},
    {"position", "wheelbase", "mover( drive \"car\" @ )", "wheelbase 0.3"},
    {"position", "velocity", "mover( update_interval 300 @ )", "velocity [0.1 0 0 0]"},
    {"position", "acceleration_bounds", "mover( @ )", "acceleration_bounds [0 0.1 0 0 0 0 -10 10]", loaded},
    {"position", "localization", "mover( @ )", "localization \"odom\""},
    {"position", "localization_origin", "mover( localization \"odom\" @ )", "localization_origin [1 0 0 0]"},
    {"position", "gps_origin", "mover( localization_origin [1 0 0 0] @ )", "gps_origin 1", loaded},
    {"position", "odom_error", "mover( localization \"odom\" @ )", "odom_error [0.1 0 0 0]"},
    {"position", "goal_bounds", "mover( @ )", "goal_bounds [0.1 10]", loaded},
    {"bumper", "crashes", "mover( bumper( bcount 1 blength 0.1 @ ) )", "crashes 1", loaded},
    {"position", "odom_heading", "mover( localization \"odom\" @ )", "odom_heading \"old\""},

    {"sensor", "pose",
     "position( size [0.2 0.2 0.2] ranger( alwayson 1 sensor( @ ) ) ) model( pose [1 0 0 0] )",
     "pose [0.1 0 0 0]"},
    {"sensor", "size",
     "position( size [0.2 0.2 0.2] ranger( alwayson 1 sensor( @ ) ) ) model( pose [1 0 0 0] size [1 1 0.4] )",
     "size [0.1 0.1 0.6]"},
    {"sensor", "range", "position( size [0.2 0.2 0.2] ranger( alwayson 1 sensor( @ ) ) )", "range [0 3]"},
    {"sensor", "fov",
     "position( size [0.2 0.2 0.2] ranger( alwayson 1 sensor( samples 3 @ ) ) ) model( pose [1 0 0 0] )",
     "fov 90"},
    {"sensor", "samples", "position( size [0.2 0.2 0.2] ranger( alwayson 1 sensor( @ ) ) )", "samples 3"},

    {"laser", "samples", "position( size [0.2 0.2 0.2] laser( alwayson 1 @ ) ) model( pose [1 0 0 0] )",
     "samples 7"},
    {"laser", "fov", "position( size [0.2 0.2 0.2] laser( alwayson 1 samples 3 @ ) ) model( pose [1 0 0 0] )",
     "fov 20"},
    {"laser", "range", "position( laser( alwayson 1 @ ) )", "range [0 3]"},
    {"laser", "range_max", "position( laser( alwayson 1 @ ) )", "range_max 3"},
    {"laser", "range_min", "position( laser( alwayson 1 @ ) )", "range_min 1", loaded},
    {"sonar", "samples", "position( size [0.2 0.2 0.2] sonar( alwayson 1 @ ) ) model( pose [1 0 0 0] )",
     "samples 7"},
    {"sonar", "fov", "position( size [0.2 0.2 0.2] sonar( alwayson 1 samples 3 @ ) ) model( pose [1 0 0 0] )",
     "fov 20"},
    {"sonar", "range", "position( sonar( alwayson 1 @ ) )", "range [0 3]"},
    {"sonar", "range_max", "position( sonar( alwayson 1 @ ) )", "range_max 3"},
    {"sonar", "range_min", "position( sonar( alwayson 1 @ ) )", "range_min 1", loaded},

    {"blinkenlight", "period", "position( blinkenlight( alwayson 1 dutycycle 0.5 @ ) )", "period 300"},
    {"blinkenlight", "dutycycle", "position( blinkenlight( alwayson 1 @ ) )", "dutycycle 0.5"},
    {"blinkenlight", "enabled", "position( blinkenlight( alwayson 1 @ ) )", "enabled 0"},

    {"gripper", "paddle_size", "eye() gripper( pose [1 0 0 180] size [0.5 0.5 1] @ )",
     "paddle_size [0.3 0.1 0.4]"},

    {"ranger", "intensity",
     "position( size [0.2 0.2 0.2] ranger( alwayson 1 @ sensor( range [0 8]  ) ) ) model( pose [2 0 0 0] )",
     "intensity 1"},
    {"sensor", "noise",
     "position( size [0.2 0.2 0.2] ranger( alwayson 1  sensor( range [0 8] @ ) ) ) model( pose [2 0 0 0] )",
     "noise [0.01 0 0]"},
    {"sensor", "beam_width",
     "position( size [0.2 0.2 0.2] ranger( alwayson 1  sensor( range [0 8] @ ) ) ) model( pose [2 0.6 0 0] )",
     "beam_width 40"},
    {"sensor", "apply_range_min",
     "position( size [0.2 0.2 0.2] ranger( alwayson 1  sensor( range [3 8] @ ) ) ) model( pose [2 0 0 0] )",
     "apply_range_min 1"},
    {"fiducial", "range_min",
     "fiducial( pose [0 0 0.1 0] alwayson 1 apply_range_min 1 @ ) model( pose [2 0 0 0] fiducial_return 7 )",
     "range_min 3"},
    {"fiducial", "apply_range_min",
     "fiducial( pose [0 0 0.1 0] alwayson 1 range_min 3 @ ) model( pose [2 0 0 0] fiducial_return 7 )",
     "apply_range_min 1"},
    {"fiducial", "range_max",
     "fiducial( pose [0 0 0.1 0] alwayson 1 @ ) model( pose [2 0 0 0] fiducial_return 7 )", "range_max 1"},
    {"fiducial", "range_max_id",
     "fiducial( pose [0 0 0.1 0] alwayson 1 @ ) model( pose [2 0 0 0] fiducial_return 7 )", "range_max_id 1"},
    {"fiducial", "fov", "fiducial( pose [0 0 0.1 0] alwayson 1 @ ) model( pose [2 2 0 0] fiducial_return 7 )",
     "fov 20"},
    {"fiducial", "ignore_zloc",
     "fiducial( pose [0 0 1.5 0] alwayson 1 @ ) model( pose [2 0 0 0] fiducial_return 7 )", "ignore_zloc 1"},
    {"radio", "essid", "radio( alwayson 1 beacon 1 pose [2 0 0 0] ) radio( alwayson 1 @ )", "essid \"a\""},
    {"radio", "model", "radio( alwayson 1 beacon 1 pose [2 0 0 0] ) radio( alwayson 1 @ )",
     "model \"friis\""},
    {"radio", "power", "radio( alwayson 1 beacon 1 pose [2 0 0 0] ) radio( alwayson 1 beacon 1 @ )",
     "power 30"},
    {"radio", "sensitivity",
     "radio( alwayson 1 beacon 1 pose [2 0 0 0] ) radio( alwayson 1 model \"friis\" @ )", "sensitivity -40"},
    {"radio", "plc", "radio( alwayson 1 beacon 1 pose [2 0 0 0] ) radio( alwayson 1 model \"ITU indoor\" @ )",
     "plc 20"},
    {"radio", "ple",
     "radio( alwayson 1 beacon 1 pose [2 0 0 0] ) radio( alwayson 1 model \"log distance\" @ )", "ple 2"},
    {"radio", "wall_factor",
     "radio( alwayson 1 beacon 1 pose [2 0 0 0] ) radio( alwayson 1 model \"raytrace\" @ ) model( pose [1 0 "
     "0 0] size [0.1 2 1] )",
     "wall_factor 3"},
    {"radio", "range", "radio( alwayson 1 beacon 1 pose [2 0 0 0] ) radio( alwayson 1 beacon 1 @ )",
     "range 1"},
    {"radio", "hears", "radio( alwayson 1 beacon 1 pose [2 0 0 0] ) radio( alwayson 1 @ )", "hears 1"},
    {"radio", "walls",
     "radio( alwayson 1 beacon 1 pose [2 0 0 0] ) radio( alwayson 1 @ ) model( pose [1 0 0 0] size [0.1 2 1] "
     ")",
     "walls \"block\""},
    {"radio", "bodies",
     "radio( alwayson 1 beacon 1 pose [2 0 0 0] ) radio( alwayson 1 @ ) position( pose [1 0 0 0] )",
     "bodies \"block\""},
    {"radio", "frequency",
     "radio( alwayson 1 beacon 1 pose [2 0 0 0] ) radio( alwayson 1 model \"friis\" @ )", "frequency 5"},
    {"radio", "payload", "radio( alwayson 1 beacon 1 pose [2 0 0 0] ) radio( alwayson 1 @ )", "payload 4"},
    {"radio", "most_heard", "radio( alwayson 1 beacon 1 pose [2 0 0 0] ) radio( alwayson 1 @ )",
     "most_heard 4"},
    {"radio", "drop_rate", "radio( alwayson 1 beacon 1 pose [2 0 0 0] ) radio( alwayson 1 @ )",
     "drop_rate 1"},
    {"radio", "beacon", "radio( alwayson 1 pose [2 0 0 0] ) radio( alwayson 1 @ )", "beacon 1"},
    {"blobfinder", "image",
     "blobfinder( pose [0 0 0.1 0] alwayson 1 @ ) model( pose [2 0 0 0] color \"red\" )", "image [40 20]"},
    {"blobfinder", "range",
     "blobfinder( pose [0 0 0.1 0] alwayson 1 @ ) model( pose [2 0 0 0] color \"red\" )", "range 1"},
    {"blobfinder", "fov", "blobfinder( pose [0 0 0.1 0] alwayson 1 @ ) model( pose [2 0 0 0] color \"red\" )",
     "fov 20"},
    {"blobfinder", "pan", "blobfinder( pose [0 0 0.1 0] alwayson 1 @ ) model( pose [2 0 0 0] color \"red\" )",
     "pan 90"},
    {"blobfinder", "colors_count",
     "blobfinder( pose [0 0 0.1 0] alwayson 1 colors [\"blue\"] @ ) model( pose [2 0 0 0] color \"red\" )",
     "colors_count 1"},
    {"blobfinder", "colors",
     "blobfinder( pose [0 0 0.1 0] alwayson 1 colors_count 1 colors [\"red\"] @ ) model( pose [2 0 0 0] "
     "color \"red\" )",
     "colors [\"blue\"]"},
    {"bumper", "bcount",
     "bumper( size [0.1 0.1 0.1] alwayson 1 blength 1 bpose[0] [0 0 0 0] @ ) model( pose [0 0.1 0 0] )",
     "bcount 1"},
    {"bumper", "blength",
     "bumper( size [0.1 0.1 0.1] alwayson 1 bcount 1 bpose[0] [0 0 0 0] blength 0.1 @ ) model( pose [0 0.5 0 "
     "0] )",
     "blength 1.5"},
    {"bumper", "blength[k]",
     "bumper( size [0.1 0.1 0.1] alwayson 1 bcount 1 bpose[0] [0 0 0 0] blength 0.1 @ ) model( pose [0 0.5 0 "
     "0] )",
     "blength[0] 1.5"},
    {"bumper", "bpose[k]",
     "bumper( size [0.1 0.1 0.1] alwayson 1 bcount 1 blength 0.5 @ ) model( pose [0 0.8 0 0] )",
     "bpose[0] [0 0.6 0 0]"},
    {"camera", "resolution", "camera( pose [0 0 0.3 0] alwayson 1 @ ) model( pose [2 0 0 0] )",
     "resolution [16 16]"},
    {"camera", "range", "camera( pose [0 0 0.3 0] alwayson 1 @ ) model( pose [2 0 0 0] )", "range [0.2 1]"},
    {"camera", "fov", "camera( pose [0 0 0.3 0] alwayson 1 @ ) model( pose [2 0 0 0] )", "fov [30 20]"},
    {"camera", "pantilt", "camera( pose [0 0 0.3 0] alwayson 1 @ ) model( pose [2 0 0 0] )",
     "pantilt [30 0]"},

    {"gripper", "paddle_state", "eye() gripper( pose [1 0 0 180] size [0.5 0.5 1] @ )",
     "paddle_state [\"closed\" \"down\"]"},
    {"gripper", "autosnatch",
     "gripper( alwayson 1 @ ) model( size [0.1 0.1 0.1] pose [0.04 0 0 0] gripper_return 1 )",
     "autosnatch 1"},

    {"actuator", "type", "actuator( start_position 0.5 @ )", "type \"rotational\""},
    {"actuator", "axis", "actuator( start_position 0.5 @ )", "axis [0 1 0]"},
    {"actuator", "min_position", "actuator( start_position 0 @ )", "min_position 0.1"},
    {"actuator", "max_position", "actuator( start_position 1 @ )", "max_position 0.7"},
    {"actuator", "max_speed", "actuator( @ ctrl \"operate :go_to:1@0\" )", "max_speed 0.1"},
    {"actuator", "start_position", "actuator( @ )", "start_position 0.5"},
};

class StageEffects : public test::ScratchTest {
 protected:
  StageEffects() {
    worldio::Image corner{.width = 2, .height = 2, .rgba = std::vector<std::uint8_t>(16, 255)};
    for (const std::size_t pixel : {1u, 2u, 3u}) corner.rgba[4 * pixel] = 0;
    worldio::write_png(folder_ / "corner.png", corner);
    worldio::Image dot{.width = 2, .height = 1, .rgba = std::vector<std::uint8_t>(8, 255)};
    dot.rgba[4] = 0;
    worldio::write_png(folder_ / "dot.png", dot);
    write("map.pgm", "P5 2 1 255\n" + std::string("\x00\xcd", 2));
    write("map.yaml", "image: map.pgm\nresolution: 0.3\norigin: [0, 0, 0]\n");
  }

  Simulation load(const Effect& effect, std::string_view property) {
    std::string text = std::string(k_macros) + std::string(effect.world) + "\n";
    text.replace(text.find('@'), 1, property);
    SimulationOptions options{.threads = 1};
    if (effect.where == grid) options.ranging = RangingEngine::grid;
    return Simulation(write("w.world", text), options);
  }

  /// What of the world `effect.where` speaks of.
  std::vector<std::string> shown(const Effect& effect, std::string_view property) {
    Simulation simulation = load(effect, property);
    if (effect.where == loaded) {
      const engine::WorldSpec& spec = simulation.world().spec();
      std::vector<std::string> all{worldio::spec_to_json(spec, simulation.registry())};
      for (const engine::BodySpec& body : spec.bodies) {
        all.push_back(spec.names.text(body.name));
        for (const float part : {body.color.r, body.color.g, body.color.b})
          all.push_back(std::to_string(part));
      }
      return all;
    }
    std::vector<std::string> states;
    for (int tick = 0; tick < 40; ++tick) {
      states.push_back(std::to_string(simulation.state_hash()));
      simulation.step();
    }
    return states;
  }
};

TEST_F(StageEffects, EachHonouredPropertyChangesTheWorld) {
  for (const Effect& effect : k_effects) {
    const auto name = std::string(effect.type) + " " + std::string(effect.name);
    ASSERT_NO_THROW({
      EXPECT_TRUE(shown(effect, effect.property) != shown(effect, "")) << name << " is without effect";
      EXPECT_TRUE(shown(effect, "") == shown(effect, "")) << name << ": the worlds differ without it, too";
    }) << name;
  }
}

/// The state after each of some ticks.
std::vector<std::uint64_t> states_of(const std::filesystem::path& world, RangingEngine ranging) {
  Simulation simulation(world, {.threads = 1, .ranging = ranging});
  std::vector<std::uint64_t> states;
  for (int tick = 0; tick < 10; ++tick) {
    states.push_back(simulation.state_hash());
    simulation.step();
  }
  return states;
}

TEST_F(StageEffects, EachHonouredPropertyIsConvertedToJsonAndBack) {
  const engine::Registry registry = make_registry();
  const auto convert = [&](const std::filesystem::path& from, const char* to) {
    Diagnostics diagnostics;
    const auto world = worldio::convert_world(from, folder_ / to, registry, {}, diagnostics);
    diagnostics.throw_if_errors();
    return write(to, world.text);
  };
  for (const Effect& effect : k_effects) {
    SCOPED_TRACE(std::string(effect.type) + " " + std::string(effect.name));
    std::string text = std::string(k_macros) + std::string(effect.world) + "\n";
    text.replace(text.find('@'), 1, effect.property);
    const RangingEngine ranging = effect.where == grid ? RangingEngine::grid : RangingEngine::exact;
    const std::filesystem::path world = write("w.world", text);
    try {
      const auto states = states_of(world, ranging);
      const std::filesystem::path json = convert(world, "w.json");
      EXPECT_EQ(states_of(json, ranging), states) << content(json);
      EXPECT_EQ(states_of(convert(json, "back.world"), ranging), states) << content(folder_ / "back.world");
    } catch (const InputError& error) {
      ADD_FAILURE() << error.what() << "\n" << content(folder_ / "w.json");
    }
  }
}

TEST_F(StageEffects, EachHonouredPropertyIsTried) {
  std::set<std::tuple<std::string_view, std::string_view>> tried;
  for (const Effect& effect : k_effects) tried.emplace(effect.type, effect.name);
  for (const StageRow& row : worldio::stage_rows()) {
    const bool is_honoured = row.support == StageSupport::honoured || row.support == StageSupport::fixed;
    EXPECT_EQ(tried.contains({row.type, row.name}), is_honoured)
        << row.type << " " << row.name
        << (is_honoured ? " is honoured: give k_effects a world in which it shows"
                        : " is tried here, but the table says that it has no effect");
  }
}

}  // namespace
}  // namespace troupe::stage_effects_test
