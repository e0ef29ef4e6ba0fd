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

/// How the world of a recording looks, for those who draw its frames: without the world's own file, and
/// without the kinds and plug-ins that it ran with.
struct RecordedScene {
  /// Beams of a ranger that leave one point, as a fan.
  struct Fan {
    Pose pose_body_fan;
    double range_max_m = 0;
    double fov_rad = 0;
    std::size_t beams = 1;
  };
  struct Eye {         ///< a ranger
    std::string name;  ///< as a step of /sensors/<type>/<sensor>
    std::vector<Fan> fans;
    std::int32_t joint = engine::k_rigid;  ///< index of the joint that it stands on
  };
  struct Joint {
    std::string component;                  ///< of /state, with its displacement from rest, in its own frame
    std::int32_t parent = engine::k_rigid;  ///< index of the joint that it stands on, which comes before it
    Pose pose_body_joint;                   ///< at rest
  };
  struct Type {
    std::string name;
    engine::FrameType look;  ///< joints at rest
    std::vector<Eye> eyes;
    std::vector<Joint> joints;
    std::vector<std::string> body_devices;  ///< those of the first part, as steps of /sensors/<type>/<sensor>
    /// Component whose field `shown_color` gives each body its colour (engine/shown_color.hpp):
    /// "sensors/robot/lamp"; empty where none was recorded.
    std::string shown_color;
    std::vector<std::int32_t> shape_joints;  ///< beside look.shapes: index of the joint that each moves with
  };
  struct Body {
    std::string name;
    std::uint32_t type = 0;
    Pose pose_world_body;  ///< as the world says
    Color color;
  };
  std::string title;
  std::optional<Box> limits;  ///< where robots may go
  std::vector<Type> types;
  std::vector<Body> bodies;  ///< by BodyId
};

/// Every body as the world says it, walls too: what else it takes to draw a frame.
RecordingReader::Scene scene_columns(const engine::WorldSpec& spec);

/// Red, green and blue of a body, each 0 to 1, from a recorded `shown_color`; the colour of the world where
/// the body was not there, or has none.
Color shown_color(std::span<const double> parts, const Color& of_the_world);

/// Throws Hdf5Error, with the file's name: a recording from before /scene was kept, or a damaged one.
RecordedScene recorded_scene(const RecordingReader& recording);

/// The same of a world that runs, without recorded colours.
RecordedScene recorded_scene(const engine::WorldSpec& spec, const engine::Registry& registry);

/// The window through which the world asks to be seen (worldio/window_fields.hpp), where it has one. Throws
/// Hdf5Error for a damaged file.
std::optional<engine::Record> recorded_window(const RecordingReader& recording);

}  // namespace troupe::worldio
