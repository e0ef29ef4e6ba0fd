#pragma once

#include "engine/frame.hpp"
#include "engine/world_spec.hpp"
#include "worldio/results/recording_reader.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace troupe::engine {
struct Registry;
}  // namespace troupe::engine

namespace troupe::worldio {

/// The appearance of a recorded world, for drawing its frames. It needs neither the world's own file nor the
/// kinds and plug-ins that it ran with.
struct RecordedScene {
  /// Beams of a ranger that leave one point.
  struct Fan {
    Pose pose_body_fan;
    double range_max_m = 0;
    double fov_rad = 0;
    std::size_t beams = 1;
  };
  struct Eye {         ///< a ranger
    std::string name;  ///< as a step of /sensors/<type>/<sensor>
    std::vector<Fan> fans;
    std::int32_t joint = engine::k_rigid;  ///< index of the joint that it is mounted on
  };
  struct Joint {
    std::string component;                  ///< in /state, with its displacement from rest, in its own frame
    std::int32_t parent = engine::k_rigid;  ///< index of the joint that carries it, which comes before it
    Pose pose_body_joint;                   ///< at rest
  };
  struct Type {
    std::string name;
    engine::FrameType look;  ///< joints at rest
    std::vector<Eye> eyes;
    std::vector<Joint> joints;
    std::vector<std::string> body_devices;  ///< of the first part, as steps of /sensors/<type>/<sensor>
    /// Component whose field `shown_color` gives each body its colour (engine/shown_color.hpp):
    /// "sensors/robot/lamp"; empty if none was recorded.
    std::string shown_color;
    std::vector<std::int32_t> shape_joints;  ///< per shape of `look`: index of the joint that it moves with
  };
  struct Body {
    std::string name;
    std::uint32_t type = 0;
    Pose pose_world_body;  ///< at the start, as in the world
    Color color;
  };
  std::string title;
  std::optional<Box> limits;  ///< where robots may go
  std::vector<Type> types;
  std::vector<Body> bodies;  ///< indexed by BodyId
};

/// The columns of /scene for all bodies of a world, walls included, as the world describes them.
RecordingReader::Scene scene_columns(const engine::WorldSpec& spec);

/// Returns the colour of a body from a recorded `shown_color` (red, green, blue, each 0 to 1), or
/// `of_the_world` if the body was absent or shows no colour.
Color shown_color(std::span<const double> parts, const Color& of_the_world);

/// Reads the scene of a recording. Throws Hdf5Error with the file's name if the recording is damaged, or so
/// old that it has no /scene.
RecordedScene recorded_scene(const RecordingReader& recording);

/// The scene of a running world, without recorded colours.
RecordedScene recorded_scene(const engine::WorldSpec& spec, const engine::Registry& registry);

/// Returns the window of the world (worldio/window_fields.hpp), if it has one. Throws Hdf5Error if the file
/// is damaged.
std::optional<engine::Record> recorded_window(const RecordingReader& recording);

}  // namespace troupe::worldio
