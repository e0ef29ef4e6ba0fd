#pragma once

#include "engine/observing/frame.hpp"
#include "engine/spec/world_spec.hpp"
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

/// The appearance of a recorded world, for drawing its frames (the states at the recorded times). To read it,
/// only the recording is needed, not the world file, the kinds or the plug-ins of the run. A body consists of
/// parts (rigid pieces), and a type describes bodies of the same construction. A joint moves parts of a body;
/// it is at rest while these parts are where the world file places them. A ranger is a sensor that measures
/// distances along beams. The state of a world, and a recording of it, consists of components (tables with
/// one row per body), such as "pose".
struct RecordedScene {
  /// Beams of a ranger that start at one point and are spread evenly over an angle, symmetric to the heading
  /// of `pose_body_fan`.
  struct Fan {
    Pose pose_body_fan;      ///< start and middle direction of the beams, with all joints at rest
    double range_max_m = 0;  ///< length of a beam that hits nothing
    double fov_rad = 0;  ///< angle between the first and the last beam; for a single beam: its opening angle
    std::size_t beams = 1;  ///< number of beams
  };
  struct Eye {                             ///< a ranger
    std::string name;                      ///< name of the ranger's group in /sensors/<type>
    std::vector<Fan> fans;                 ///< the fans of the ranger, one for each of its transducers
    std::int32_t joint = engine::k_rigid;  ///< index in Type::joints of the joint that moves it, or k_rigid
  };
  struct Joint {  ///< a joint that moves parts and devices of a body
    /// Name of the component with the displacement of the joint from rest, in the joint's frame at rest: a
    /// group in /state of the recording.
    std::string component;
    std::int32_t parent =
        engine::k_rigid;   ///< index of the joint that carries this joint (a lower index); k_rigid: none
    Pose pose_body_joint;  ///< pose of the joint at rest, in the frame of the body
  };
  struct Type {                 ///< a body type
    std::string name;           ///< name of the type in the world; several types may have the same name
    engine::FrameType look;     ///< the shapes (solids) of all parts, with all joints at rest
    std::vector<Eye> eyes;      ///< the rangers of the type
    std::vector<Joint> joints;  ///< the joints of the type, each after its parent
    struct Device {             ///< a sensor or another device of a type, such as a light
      std::string name;         ///< name of the device's group in /sensors/<type>
      std::uint32_t part = 0;   ///< index of the part on which the device is mounted
    };
    std::vector<Device> devices;  ///< all sensors and other devices of the type
    /// The component whose field `shown_color` gives each body its colour (engine/sensing/shown_color.hpp),
    /// such as "sensors/robot/lamp". Empty if no such field was recorded.
    std::string shown_color;
    std::vector<std::int32_t> shape_joints;  ///< for each shape of `look`: joint that moves it; k_rigid: none
    std::vector<std::uint32_t> shape_parts;  ///< for each shape of `look`: index of its part
    /// For each part, the component whose field `shown_color` gives the shapes of this part their colour. The
    /// text is empty if there is no such component. It is also empty for the first part, the body itself:
    /// Type::shown_color has its component.
    std::vector<std::string> part_colors;
  };
  struct Body {              ///< a body of the world, walls included
    std::string name;        ///< name of the body
    std::uint32_t type = 0;  ///< index into RecordedScene::types
    Pose pose_world_body;    ///< pose at the start of the run
    Color color;             ///< colour in the world file
  };
  std::string title;          ///< title of the world
  std::optional<Box> limits;  ///< the region in which robots may be, m; empty: unlimited
  std::vector<Type> types;    ///< indexed by TypeId, the number of a type in the world
  std::vector<Body> bodies;   ///< indexed by BodyId, the number of a body in the world
};

/// Returns the columns of the group /scene of a recording: all bodies of a world, walls included, as the spec
/// (the description of the world) defines them.
RecordingReader::Scene scene_columns(const engine::WorldSpec& spec);

/// Returns the colour of a body in a frame. `parts` is the recorded value of the field `shown_color` of the
/// body, which holds the colour that devices such as lights give it: red, green and blue, each from 0 to 1.
/// The result is opaque. If the body was absent or showed no colour, red, green and blue are NaN: the result
/// is then `of_the_world`, the colour of the body in the world file.
Color shown_color(std::span<const double> parts, const Color& of_the_world);

/// Reads the scene of a recording. Throws Hdf5Error with the file's name if the recording is damaged, or so
/// old that it has no /scene.
RecordedScene recorded_scene(const RecordingReader& recording);

/// Returns the scene of a world that is not read from a recording: in all types, `shown_color` and the texts
/// in `part_colors` are empty. Throws std::runtime_error if JSON cannot represent the world, for example
/// because a number is not finite.
RecordedScene recorded_scene(const engine::WorldSpec& spec, const engine::Registry& registry);

/// Returns the window settings of the recorded world (worldio/window_fields.hpp). Empty if the world has
/// none. Throws Hdf5Error if the file is damaged.
std::optional<engine::Record> recorded_window(const RecordingReader& recording);

}  // namespace troupe::worldio
