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

/// The appearance of a recorded world: shapes, colours and start poses of all bodies. It is read from the
/// recording alone. The world file and the plug-ins of the run are not needed.
///
/// A body consists of parts (rigid pieces). A type describes bodies of the same construction. A joint moves
/// parts of a body; the joint is at rest while these parts have the poses that the world file gives them. A
/// ranger is a sensor that measures distances along beams. A component is a table of recorded values with one
/// row per body, such as "pose".
struct RecordedScene {
  /// Beams of a ranger that start at one point. They are spread evenly over the angle `fov_rad`. The heading
  /// of `pose_body_transducer` is the middle of this angle.
  struct Transducer {
    Pose pose_body_transducer;  ///< pose in the body frame, with all joints at rest
    double range_max_m = 0;     ///< length of a beam that hits nothing, m
    double fov_rad = 0;  ///< angle between the first and the last beam; for a single beam: its opening angle
    std::size_t beams = 1;  ///< number of beams
  };
  struct Ranger {
    std::string name;                      ///< name of the ranger's group in /sensors/<type>
    std::vector<Transducer> transducers;   ///< all beams of the ranger, grouped by their start poses
    std::int32_t joint = engine::k_rigid;  ///< index in Type::joints of the ranger's joint; k_rigid: none
  };
  struct Joint {  ///< a joint that moves parts and devices of a body
    /// Name of the component that holds the displacement of the joint from rest, such as "joint/arm". The
    /// displacement is in the frame that the joint has at rest. The component is the group of this name in
    /// /state of the recording.
    std::string component;
    /// Index of the joint that carries this joint (a lower index); k_rigid: none.
    std::int32_t parent = engine::k_rigid;
    Pose pose_body_joint;  ///< pose of the joint at rest, in the frame of the body
  };
  struct Type {                   ///< a body type
    std::string name;             ///< name of the type in the world; several types may have the same name
    engine::FrameType look;       ///< the shapes (solids) of all parts, with all joints at rest
    std::vector<Ranger> rangers;  ///< the rangers of the type
    std::vector<Joint> joints;    ///< the joints of the type, each after its parent
    struct Device {               ///< a sensor or another device of a type, such as a light
      std::string name;           ///< name of the device's group in /sensors/<type>
      std::uint32_t part = 0;     ///< index of the part on which the device is mounted
    };
    std::vector<Device> devices;  ///< all sensors and other devices of the type
    /// Names of the components with the memories of its controllers, such as "wander/0".
    std::vector<std::string> memories;
    /// Name of the component whose field `shown_color` gives each body its colour, such as
    /// "sensors/robot/lamp" (engine/sensing/shown_color.hpp). Empty if no such field was recorded.
    std::string shown_color;
    std::vector<std::int32_t> shape_joints;  ///< for each shape of `look`: index of its joint; k_rigid: none
    std::vector<std::uint32_t> shape_parts;  ///< for each shape of `look`: index of its part
    /// For each part, the name of the component whose field `shown_color` gives the shapes of this part their
    /// colour. The name is empty if there is no such component. It is always empty for the first part, which
    /// is the body itself: Type::shown_color is the component for the body.
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

/// Returns the colour in which to draw a body at a recorded time: the opaque colour in `parts` if its numbers
/// are finite, else `of_the_world`.
/// parts         red, green and blue, each from 0 to 1: the recorded value of the field `shown_color` of the
///               body, in which devices such as lights store a colour; NaN if the body was absent or showed
///               no colour
/// of_the_world  the colour of the body in the world file
Color shown_color(std::span<const double> parts, const Color& of_the_world);

/// Reads the appearance of the recorded world. Throws Hdf5Error with the file's name if the recording is
/// damaged, or so old that it has no group /scene.
RecordedScene recorded_scene(const RecordingReader& recording);

/// Returns the appearance of a world without a recording. In each type, `shown_color` and all names in
/// `part_colors` are empty. `registry` must have the drives, devices and controllers that `spec` names.
/// Throws std::runtime_error if JSON cannot represent the world, for example because a number is not finite.
RecordedScene recorded_scene(const engine::WorldSpec& spec, const engine::Registry& registry);

/// Returns the settings of the key `window` of the recorded world, one value for each parameter in
/// window_fields() (worldio/window_fields.hpp). Returns std::nullopt if the world does not have this key.
/// Throws Hdf5Error if the file is damaged.
std::optional<engine::Record> recorded_window(const RecordingReader& recording);

}  // namespace troupe::worldio
