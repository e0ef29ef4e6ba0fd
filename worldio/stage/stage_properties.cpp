#include "worldio/stage/stage_properties.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <unordered_map>

namespace troupe::worldio {
namespace {

using enum StageSupport;

// One row per property: the source of the documentation, the warnings and the spelling suggestions.
constexpr auto k_rows = std::to_array<StageRow>({
    {"world", "name", honoured, "title of the world; the file's path unless given"},
    {"world", "interval_sim", honoured, "the tick, ms; at least 0.001"},
    {"world", "quit_time", honoured, "s; when a run ends, unless an option says otherwise"},
    {"world", "unit_length", fixed, "\"m\", \"cm\" or \"mm\"; anything else is an error"},
    {"world", "unit_angle", fixed, "\"degrees\" or \"radians\"; anything else is an error"},
    {"world", "wrap_headings", honoured,
     "an addition: 0 keeps headings of transducers and bumpers beyond half a turn, which Stage wraps"},
    {"world", "seed", honoured, "an addition: the seed of all random numbers; 1 unless given"},
    {"world", "resolution", honoured,
     "m, from 0.0001 to 100: cell size of the grid ray engine; the exact one, and collisions, have no cells"},
    {"world", "threads", no_effect,
     "the number of threads is an option of the run and never changes a result"},
    {"world", "test", no_effect, "a debugging aid of Stage's parser"},
    {"world", "show_clock", fixed,
     "lines on standard error, as with `--clock`; Stage's program overrides it"},
    {"world", "show_clock_interval", honoured, "ticks from one line to the next"},
    {"world", "speedup", fixed,
     "the pace of `troupe run --rate world`; without that option, or at 0, a run is as fast as possible; "
     "Stage uses it only with a window"},
    {"world", "paused", window_only, "a run starts at once: without a window, nothing could resume it"},
    {"world", "confirm_on_quit", window_only, ""},
    {"world", "size", obsolete, ""},
    {"world", "interval_real", obsolete, ""},
    {"world", "gui_interval", obsolete, ""},
    {"world", "gui_disable", obsolete, ""},
    {"world", "gui_menu_interval", obsolete, ""},
    {"world", "threadpool", obsolete, ""},

    {"model", "name", honoured, "`/name` is a global name, not one below the parent's"},
    {"model", "pose", honoured,
     "[x y z heading] in the parent's frame; the older [x y heading] is read with a warning"},
    {"model", "size", honoured,
     "[x y z], above 0 if there is a body; the older [x y] has the type's default height, with a warning"},
    {"model", "origin", honoured, "offset of the body from the pose; children do not inherit it"},
    {"model", "update_interval", fixed, "ms; 0 is every tick, where Stage hangs"},
    {"model", "color", fixed,
     "X11 name; \"random\" depends on the seed and the body, for a child on its name"},
    {"model", "color_rgba", honoured, "used if `color` is not given"},
    {"model", "bitmap", fixed,
     "the outline of the solid pixels, stretched to `size`; its inside is solid too; or a ROS map"},
    {"model", "bitmap_margins", honoured,
     "an addition: the whole image fills `size`, not only its solid pixels; 0 unless given"},
    {"model", "bitmap_unknown", honoured,
     "an addition: unknown cells of a ROS map are solid too; 0 unless given"},
    {"model", "noblocks", honoured, ""},
    {"model", "boundary", honoured,
     "four walls of 0.01 m; explicit blocks without a bitmap discard them, with a warning"},
    {"model", "stack_children", honoured, ""},
    {"model", "obstacle_return", fixed, "whole regions block, not only their outlines"},
    {"model", "ranger_return", fixed, "bodies of any size are seen, however small"},
    {"model", "fiducial_return", honoured, "the number that fiducial finders read; 0: they do not find it"},
    {"model", "fiducial_key", honoured, "the key of the finders that can find it"},
    {"model", "gripper_return", fixed, "grippers sense it, and take the whole body; held bodies do not jump"},
    {"model", "blob_return", fixed, "0: blob finders do not see its colour; Stage never reads it"},
    {"model", "ctrl", fixed, "names a controller of Troupe with its arguments: `\"expand speed=0.2\"`"},
    {"model", "alwayson", honoured, "its sensor runs even if no controller reads it"},
    {"model", "event_queue", no_effect, "Stage overwrites it"},
    {"model", "friction", no_effect, "Stage stores it and does not use it"},
    {"model", "map_resolution", no_effect, "Stage stores it and does not use it"},
    {"model", "debug", no_effect, "Stage prints a line"},
    {"model", "mass", honoured,
     "kg, of a top-level position model: its drive draws 1 W, and 10 W per kg and m/s"},
    {"model", "watts", fixed,
     "W, drawn while the model runs, at any tick; ignored for models whose draw follows from what they do: "
     "position, ranger (0.2 W a sensor), blobfinder (2), bumper (0.1), actuator (2), camera (100)"},
    {"model", "joules", fixed,
     "J, a full power pack; below 0 it never runs out. An empty pack stops what it supplies: see "
     "`when_empty`"},
    {"model", "kjoules", fixed, "as `joules`, in kJ"},
    {"model", "joules_capacity", honoured,
     "J, what the pack can hold; without `joules` it is empty at the start"},
    {"model", "kjoules_capacity", honoured, "as `joules_capacity`, in kJ"},
    {"model", "when_empty", honoured,
     "an addition: \"stop\" (sensors keep their readings, drives stand still) or, as in Stage, \"nothing\""},
    {"model", "give_watts", fixed,
     "W, to each body that touches it (0.02 m) and takes energy, while the model runs; whole regions touch"},
    {"model", "take_watts", honoured, "W, at most, from each body that touches it and gives energy"},
    {"model", "say", window_only, ""},
    {"model", "gui_nose", window_only, ""},
    {"model", "gui_outline", window_only, ""},
    {"model", "gui_grid", window_only, ""},
    {"model", "gui_move", window_only, ""},
    {"model", "trail_length", window_only, ""},
    {"model", "trail_interval", window_only, ""},
    {"model", "laser_return", obsolete, "replaced by `ranger_return`"},
    {"model", "blobfinder_return", obsolete, "replaced by `blob_return`"},
    {"model", "shape", obsolete, ""},
    {"model", "polygons", obsolete, "replaced by `block` entities"},
    {"model", "polygon[k]", obsolete, ""},
    {"model", "polygon[k].points", obsolete, ""},
    {"model", "polygon[k].point[k]", obsolete, ""},
    {"model", "polygon[k].filled", obsolete, ""},
    {"model", "blocks", obsolete, "replaced by `block` entities"},
    {"model", "block[k]", obsolete, ""},
    {"model", "block[k].points", obsolete, ""},
    {"model", "block[k].point[k]", obsolete, ""},
    {"model", "block[k].z", obsolete, ""},
    {"model", "block[k].z_range", obsolete, ""},
    {"model", "block[k].color", obsolete, ""},
    {"model", "size3", obsolete, ""},
    {"model", "offset", obsolete, ""},
    {"model", "gui_movemask", obsolete, ""},
    {"model", "view", obsolete, ""},
    {"model", "scount", obsolete, "replaced by `sensor` entities"},
    {"model", "spose[k]", obsolete, ""},
    {"model", "ssize", obsolete, ""},
    {"model", "sview", obsolete, ""},
    {"model", "fill_polygons", obsolete, ""},
    {"model", "show_waypoints", obsolete, ""},
    {"model", "rangerdata", obsolete, ""},
    {"model", "ip", obsolete, ""},
    {"model", "mac", obsolete, ""},
    {"model", "essid", obsolete, ""},
    {"model", "model", obsolete, ""},
    {"model", "range", obsolete, ""},
    {"model", "power", obsolete, ""},
    {"model", "sensitivity", obsolete, ""},
    {"model", "plc", obsolete, ""},
    {"model", "ple", obsolete, ""},
    {"model", "wall_factor", obsolete, ""},
    {"model", "range_db", obsolete, ""},
    {"model", "range3", obsolete, ""},

    {"block", "points", honoured, "at least 3"},
    {"block", "point[k]", honoured,
     "[x y] in any scale: all blocks of a model together are stretched to its `size`"},
    {"block", "z", honoured,
     "[min max], in the same scale; a block without it has no height, with a warning"},

    {"position", "drive", fixed, "\"diff\", \"omni\" or \"car\"; anything else is an error"},
    {"position", "velocity_bounds", fixed,
     "[xmin xmax ymin ymax zmin zmax amin amax]; turn rates do not wrap at 180 degrees"},
    {"position", "wheelbase", honoured, "of a car; above 0"},
    {"position", "velocity", fixed,
     "[x y z a]: its velocity until its first update, which with the default `update_interval` comes before "
     "the first motion; turn rates do not wrap at 180 degrees"},
    {"position", "acceleration_bounds", fixed,
     "[xmin xmax ymin ymax zmin zmax amin amax]: bounds commanded accelerations, not speeds, as in Stage; "
     "also of a `car`, and over the time since the last update"},
    {"position", "localization", fixed,
     "\"gps\" or \"odom\"; anything else is an error. Odometry counts true motion: it does not change while "
     "the robot is stalled, misses no tick between updates, and counts motion to the left"},
    {"position", "localization_origin", honoured,
     "of \"odom\"; ignored by \"gps\", as in Stage, with a warning, unless `gps_origin` is 1"},
    {"position", "gps_origin", honoured, "an addition: 1 gives \"gps\" poses in the frame of the origin"},
    {"position", "odom_error", fixed,
     "[x y z a], the last in `unit_angle`, as in Stage; unless given, drawn for each robot from the world's "
     "seed, not from the clock"},
    {"position", "odom_heading", honoured,
     "an addition: \"new\", as in Stage, adds the motion of a tick along the heading after its turn; \"old\" "
     "along the heading before it, as robots move, so that without error the estimate is exact"},
    {"position", "odom", obsolete, ""},

    {"ranger", "intensity", honoured,
     "an addition: 1 also reads the `ranger_return` of the body that each beam hits; Stage always does"},

    {"sensor", "pose", honoured, "[x y z heading] in the ranger's frame, its origin included"},
    {"sensor", "size", honoured, "half of its height is added to the height of the beams"},
    {"sensor", "range", honoured,
     "[min max]; as in Stage the minimum is kept but not applied, unless `apply_range_min`"},
    {"sensor", "fov", honoured, "angle from the first sample to the last"},
    {"sensor", "samples", honoured, "one sample looks straight ahead; for cones see `beam_width`"},
    {"sensor", "noise", fixed,
     "[variance share angle], each 0 or above; readings stay within 0 and the maximum, and the random "
     "numbers follow from the seed"},
    {"sensor", "beam_width", honoured,
     "an addition: opening angle of each beam, which reads the nearest surface within it; 0 unless given"},
    {"sensor", "apply_range_min", honoured, "an addition: 1 raises readings below the minimum to it"},
    {"sensor", "color", window_only, ""},
    {"sensor", "color_rgba", window_only, ""},
    {"sensor", "view", obsolete, ""},

    {"laser", "samples", honoured,
     "an alias of older files: a ranger that is its own sensor; 180 unless given"},
    {"laser", "fov", honoured, "180 degrees unless given"},
    {"laser", "range", honoured, "[min max]; as `range_min` and `range_max`"},
    {"laser", "range_min", honoured, "0 unless given; kept but not applied"},
    {"laser", "range_max", honoured, "8 m unless given"},
    {"sonar", "samples", honoured,
     "an alias of older files: a ranger that is its own sensor; 1 unless given"},
    {"sonar", "fov", honoured, "0.1 rad unless given"},
    {"sonar", "range", honoured, "[min max]; as `range_min` and `range_max`"},
    {"sonar", "range_min", honoured, "0 unless given; kept but not applied"},
    {"sonar", "range_max", honoured, "5 m unless given"},

    {"fiducial", "range_min", honoured, "as in Stage it is kept but not applied, unless `apply_range_min`"},
    {"fiducial", "apply_range_min", honoured, "an addition: 1: nearer targets are not found"},
    {"fiducial", "range_max", honoured, "targets whose origins are nearer than this are found"},
    {"fiducial", "range_max_id", honoured, "ids of targets nearer than this are read"},
    {"fiducial", "fov", honoured, "in the file's unit of angles"},
    {"fiducial", "ignore_zloc", fixed, "a body behind a target does not hide it"},

    {"radio", "essid", honoured,
     "an addition, as are all of `radio`: radios of one `essid` hear one another"},
    {"radio", "model", honoured,
     "\"simple\", \"friis\", \"ITU indoor\", \"log distance\" or \"raytrace\": how signals weaken with "
     "distance; the last is friis with walls that weaken"},
    {"radio", "power", honoured, "dBm; 20 unless given"},
    {"radio", "sensitivity", honoured, "dBm; -80 unless given"},
    {"radio", "plc", honoured, "of \"ITU indoor\": dB per tenfold distance; 30 unless given"},
    {"radio", "ple", honoured, "of \"log distance\": the exponent; 4 unless given"},
    {"radio", "wall_factor", honoured, "dB lost at each wall, where walls weaken; 10 unless given"},
    {"radio", "range", honoured,
     "how far it is heard; 5 m with \"simple\", 1000 m with others, unless given"},
    {"radio", "hears", honoured, "how far it hears; `range` unless given"},
    {"radio", "walls", honoured,
     "\"block\", \"weaken\" or \"pass\"; \"weaken\" with \"raytrace\", \"pass\" with others, unless given"},
    {"radio", "bodies", honoured, "\"block\" or \"pass\""},
    {"radio", "frequency", honoured, "GHz; 2.4 unless given"},
    {"radio", "payload", honoured, "bytes of a message, at most"},
    {"radio", "most_heard", honoured, "messages heard per tick, at most: the nearest"},
    {"radio", "drop_rate", honoured, "the fraction of messages to it that is lost at random"},
    {"radio", "beacon", honoured, "1: it sends an empty message until a controller sends another"},
    {"radio", "ip", no_effect, "messages go to all in range"},
    {"radio", "mac", no_effect, "messages go to all in range"},

    {"blobfinder", "image", fixed,
     "[columns rows]; a single column looks straight ahead, where Stage divides by 0"},
    {"blobfinder", "range", honoured, "m, whatever the file's unit of lengths"},
    {"blobfinder", "fov", fixed, "no column is skipped between two blobs"},
    {"blobfinder", "pan", honoured, "added to its heading"},
    {"blobfinder", "colors_count", honoured,
     "how many of `colors` are used; without it every colour is reported"},
    {"blobfinder", "colors", fixed, "X11 names; an unknown one is an error"},
    {"blobfinder", "channel_count", obsolete, "replaced by `colors_count`"},
    {"blobfinder", "channels", obsolete, "replaced by `colors`"},

    {"bumper", "bcount", honoured, "without it there are none"},
    {"bumper", "blength", honoured, "length of the bumpers without a `blength[k]`; above 0"},
    {"bumper", "blength[k]", honoured, ""},
    {"bumper", "bpose[k]", honoured,
     "[x y z heading] of its middle; it runs across its heading and is 0.02 m thick"},

    {"gripper", "paddle_size", fixed,
     "paddles move as solid parts of the body, where those of Stage jump; they stop at what they touch"},
    {"gripper", "paddle_state", fixed,
     "[\"open\" or \"closed\" \"up\" or \"down\"]; a held body rises with the paddles and stays where it is "
     "released"},
    {"gripper", "autosnatch", honoured, "closes while a beam is broken, opens while none is"},

    {"actuator", "type", fixed,
     "\"linear\" or \"rotational\"; it moves, with its children, where Stage's do not move"},
    {"actuator", "axis", fixed, "[x y z] in the model's frame; x if its length is 0"},
    {"actuator", "min_position", fixed, "m or rad, whatever the file's units"},
    {"actuator", "max_position", fixed,
     "m or rad, whatever the file's units; at least `min_position`, and linear ones reach 1000 m at most"},
    {"actuator", "max_speed", fixed, "m/s or rad/s, whatever the file's units"},
    {"actuator", "start_position", fixed,
     "m or rad from the model's pose, which Stage overwrites with it instead"},

    {"camera", "resolution", fixed, "[width height]; any, where Stage's window limits it"},
    {"camera", "range", honoured, "[near far]"},
    {"camera", "fov", honoured, "[horizontal vertical], degrees whatever the file's unit"},
    {"camera", "pantilt", fixed,
     "[pan tilt], degrees: to the right, and upwards; from the camera's own heading, where Stage takes its "
     "parent's"},
    {"camera", "width", obsolete, ""},
    {"camera", "height", obsolete, ""},
    {"camera", "horizfov", obsolete, ""},
    {"camera", "vertfov", obsolete, ""},
    {"camera", "yaw", obsolete, ""},
    {"camera", "pitch", obsolete, ""},

    {"blinkenlight", "period", fixed, "ms; it blinks, where Stage's draws nothing"},
    {"blinkenlight", "dutycycle", fixed, "fraction of the period for which it is lit"},
    {"blinkenlight", "enabled", fixed, "0: dark until a controller switches it; Stage never reads it"},

    {"window", "size", window_only, "[width height], pixels; below 0: the whole screen"},
    {"window", "center", window_only, "[x y], m whatever `unit_length` says"},
    {"window", "rotate", window_only, "[pitch yaw], degrees"},
    {"window", "scale", window_only, "pixels per metre"},
    {"window", "pcam_loc", window_only, "[x y z]"},
    {"window", "pcam_angle", window_only, "[pitch yaw], degrees whatever `unit_angle` says, as in Stage"},
    {"window", "pcam_on", window_only, ""},
    {"window", "interval", window_only, "ms"},
    {"window", "screenshot_skip", window_only, ""},
    {"window", "screenshots", window_only, ""},
    {"window", "follow_model", window_only, ""},
    {"window", "show_data", window_only, ""},
    {"window", "show_blocks", window_only, ""},
    {"window", "show_clock", window_only, ""},
    {"window", "show_flags", window_only, ""},
    {"window", "show_grid", window_only, ""},
    {"window", "show_follow", window_only, ""},
    {"window", "show_footprints", window_only, ""},
    {"window", "show_boundingboxes", window_only, ""},
    {"window", "show_occupancy", window_only, ""},
    {"window", "show_trailarrows", window_only, ""},
    {"window", "show_trailrise", window_only, ""},
    {"window", "show_trailfast", window_only, ""},
    {"window", "show_trailblur", window_only, ""},
    {"window", "show_status", window_only, ""},
    {"window", "show_voxels", window_only, ""},
    {"window", "vis_all", window_only, ""},
    {"window", "show_ranger_ranges", window_only, ""},
    {"window", "show_ranger_strikes", window_only, ""},
    {"window", "show_ranger_fov", window_only, ""},
    {"window", "show_ranger_transducers", window_only, ""},
    {"window", "show_fiducial", window_only, ""},
    {"window", "show_fiducial_fov", window_only, ""},
    {"window", "show_gripper_data", window_only, ""},
    {"window", "show_camera", window_only, ""},
    {"window", "show_blinken", window_only, ""},
    {"window", "show_bumper_hits", window_only, ""},
    {"window", "show_position_waypoints", window_only, ""},
    {"window", "show_position_coords", window_only, ""},
    {"window", "ranger_vis", window_only, ""},
    {"window", "blobfinder_vis", window_only, ""},
    {"window", "raster_vis", window_only, ""},
    {"window", "energy_dissipation", window_only, ""},
    {"window", "energy_input", window_only, ""},
    {"window", "energy_stored", window_only, ""},
});

/// Whether an entity is a model: only models share the rows of `model`.
bool is_model(std::string_view type) {
  return type != "world" && type != "block" && type != "sensor" && type != "window";
}

/// `point[12]` -> `point[k]`.
std::string without_numbers(std::string_view name) {
  std::string out;
  for (std::size_t i = 0; i < name.size(); ++i) {
    out += name[i];
    if (name[i] != '[') continue;
    const std::size_t end = std::min(name.size(), name.find_first_not_of("0123456789", i + 1));
    if (end == i + 1) continue;
    out += 'k';
    i = end - 1;
  }
  return out;
}

std::string_view status(StageSupport support) {
  switch (support) {
    case honoured: return "honoured";
    case fixed: return "honoured, with a fix";
    case no_effect: return "accepted, no effect";
    case window_only: return "accepted, window only";
    case obsolete: break;
  }
  return "accepted, obsolete";
}

/// The rows of a property name in all entities.
std::span<const StageRow* const> rows_of_name(std::string_view written) {
  using Index = std::unordered_map<std::string_view, std::vector<const StageRow*>>;
  static const Index index_of_rows = [] {
    Index index;
    for (const StageRow& row : k_rows) index[row.name].push_back(&row);
    return index;
  }();
  std::string numberless;
  if (written.find('[') != std::string_view::npos) {
    numberless = without_numbers(written);
    written = numberless;
  }
  const auto it = index_of_rows.find(written);
  if (it == index_of_rows.end()) return {};
  return it->second;
}

}  // namespace

std::span<const StageRow> stage_rows() { return k_rows; }

const StageRow* find_stage_row(std::string_view type, std::string_view written) {
  if (type == "wifi") type = "radio";
  // The lasers and sonars of older files are rangers and also their own sensors.
  const bool is_both = type == "laser" || type == "sonar";
  const auto row_of = [&](std::string_view wanted) -> const StageRow* {
    for (const StageRow* row : rows_of_name(written))
      if (row->type == wanted) return row;
    return nullptr;
  };
  const StageRow* row = row_of(type);
  if (!row && is_both) row = row_of("ranger");
  if (!row && is_model(type)) row = row_of("model");
  if (!row && is_both) row = row_of("sensor");
  return row;
}

bool is_without_effect(std::string_view name) {
  const std::span<const StageRow* const> rows = rows_of_name(name);
  return !rows.empty() && std::ranges::none_of(rows, [](const StageRow* row) {
    return row->support == honoured || row->support == fixed;
  });
}

std::vector<std::string_view> stage_property_names(std::string_view type) {
  if (type == "wifi") type = "radio";
  std::vector<std::string_view> names;
  for (const StageRow& row : k_rows)
    if (row.support != obsolete && (row.type == type || (row.type == "model" && is_model(type))))
      names.push_back(row.name);
  return names;
}

std::string stage_property_table() {
  std::string out = "| in | property | status | notes |\n|---|---|---|---|\n";
  for (const StageRow& row : k_rows)
    out += fmt::format("| {} | `{}` | {} | {} |\n", row.type, row.name, status(row.support), row.note);
  return out;
}

}  // namespace troupe::worldio
