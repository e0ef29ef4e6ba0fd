#include "worldio/window_fields.hpp"

#include "base/limits.hpp"
#include "base/math.hpp"

#include <string_view>
#include <vector>

namespace troupe::worldio {
namespace {

using engine::FieldTable;
using engine::FieldType;
using engine::Unit;

constexpr double k_most_window_px = 16384;
constexpr double k_most_turn = 100;  // greatest camera angle, rad

/// A parameter that switches a layer of the picture on or off.
struct Switch {
  std::string_view name;
  bool is_on;  ///< Stage's default
  std::string_view text = "a switch of Stage's window, without effect in Troupe";
};

constexpr Switch k_switches[] = {
    {"show_data", false,
     "sensor data are drawn: those that `show_ranger_ranges`, `show_fiducial`, `show_gripper_data` and "
     "`blobfinder_vis` switch on"},
    {"show_blocks", true},
    {"show_clock", true, "the simulated time is drawn"},
    {"show_flags", true},
    {"show_grid", true, "the grid of the floor is drawn"},
    {"show_follow", false},
    {"show_footprints", false, "the outlines of the bodies are drawn on the floor"},
    {"show_boundingboxes", false},
    {"show_occupancy", false, "the cells of the spatial index that contain robots are drawn"},
    {"show_trailarrows", false},
    {"show_trailrise", false},
    {"show_trailfast", false},
    {"show_trailblur", false},
    {"show_ranger_ranges", true, "with `show_data`: the readings of the rangers are drawn"},
    {"show_ranger_strikes", false},
    {"show_ranger_fov", false},
    {"show_ranger_transducers", false},
    {"show_fiducial", true, "with `show_data`: the detected fiducials are drawn"},
    {"show_fiducial_fov", false},
    {"show_gripper_data", true, "with `show_data`: the state of the grippers is drawn"},
    {"show_camera", true},
    {"show_blinken", true},
    {"show_bumper_hits", true},
    {"show_position_waypoints", true},
    {"show_position_coords", false},
    {"ranger_vis", true},
    {"blobfinder_vis", true, "with `show_data`: the detected blobs are drawn"},
    {"raster_vis", false},
    {"energy_dissipation", false},
    {"energy_input", false},
    {"energy_stored", false},
};

FieldTable make_window_fields() {
  FieldTable table{{
      {.name = "size_px",
       .type = FieldType::numbers,
       .fallback = std::vector<double>{400, 300},
       .min = -k_most_window_px,
       .max = k_most_window_px,
       .text = "width and height of the window; a negative number: full screen in Stage, the default picture "
               "size in Troupe",
       .columns = 2},
      {.name = "center",
       .type = FieldType::numbers,
       .unit = Unit::meters,
       .fallback = std::vector<double>{0, 0},
       .min = -k_world_reach_m,
       .max = k_world_reach_m,
       .text = "centre of the orthographic view: x, y",
       .columns = 2},
      {.name = "rotate",
       .type = FieldType::numbers,
       .unit = Unit::radians,
       .fallback = std::vector<double>{0, 0},
       .min = -k_most_turn,
       .max = k_most_turn,
       .text = "pitch (0 looks straight down) and yaw of the orthographic view",
       .columns = 2},
      {.name = "scale_px_per_m",
       .fallback = 15.0,
       .min = 0,
       .max = 1e6,
       .text = "scale of the orthographic view",
       .above_min = true},
      {.name = "camera",
       .type = FieldType::numbers,
       .unit = Unit::meters,
       .fallback = std::vector<double>{0, -4, 3},
       .min = -k_world_reach_m,
       .max = k_world_reach_m,
       .text = "camera position of the perspective view: x, y, z",
       .columns = 3},
      {.name = "camera_angle",
       .type = FieldType::numbers,
       .unit = Unit::radians,
       .fallback = std::vector<double>{radians(70), 0},
       .min = -k_most_turn,
       .max = k_most_turn,
       .text = "pitch (0 looks straight down) and yaw of the perspective view",
       .columns = 2},
      {.name = "perspective",
       .type = FieldType::boolean,
       .fallback = false,
       .text = "true: the perspective view is used; false: the orthographic view"},
      {.name = "interval",
       .unit = Unit::seconds,
       .fallback = 0.04,
       .min = 0,
       .max = 1e6,
       .text = "time between two updates of Stage's window, without effect in Troupe",
       .above_min = true},
      {.name = "screenshots",
       .type = FieldType::boolean,
       .fallback = false,
       .text = "true: Stage saves screenshots; without effect in Troupe"},
      {.name = "screenshot_skip",
       .type = FieldType::integer,
       .fallback = 1,
       .min = 1,
       .max = 1e9,
       .text = "n: Stage saves only every n-th screenshot; without effect in Troupe"},
      {.name = "follow",
       .type = FieldType::text,
       .fallback = "",
       .text = "name of the model that the view follows"},
  }};
  for (const auto& [name, is_on, text] : k_switches)
    table.fields.push_back({.name = name, .type = FieldType::boolean, .fallback = is_on, .text = text});
  return table;
}

}  // namespace

const FieldTable& window_fields() {
  static const FieldTable table = make_window_fields();
  return table;
}

}  // namespace troupe::worldio
