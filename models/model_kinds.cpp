#include "models/model_kinds.hpp"

namespace troupe::models {

std::vector<engine::ModelKind> model_kinds() {
  // These defaults are those of the code of Stage 4.3, on which world files rely. Its manual states others.
  const Eigen::Vector3d base(0.4, 0.4, 1.0);
  const Color red{1, 0, 0, 1};
  return {
      {.name = "actuator",
       .text = "a joint that moves, with the parts mounted on it",
       .size = base,
       .color = red,
       .device = "actuator"},
      {.name = "blinkenlight",
       .text = "a light that blinks",
       .size = {0.02, 0.02, 0.02},
       .color = {0, 1, 0, 1},
       .device = "blinkenlight"},
      {.name = "blobfinder",
       .text = "finds areas of one colour in its field of view",
       .size = base,
       .color = red,
       .has_default_body = false,
       .device = "blobfinder"},
      {.name = "bumper",
       .text = "detects contact with other models",
       .size = base,
       .color = red,
       .device = "bumper"},
      {.name = "camera",
       .text = "takes pictures",
       .size = {0.1, 0.07, 0.05},
       .color = {0, 0, 0, 1},
       .device = "camera"},
      {.name = "fiducial",
       .text = "finds models in sight that have a fiducial_return",
       .size = {0, 0, 0},
       .color = red,
       .has_default_body = false,
       .device = "fiducial"},
      {.name = "gripper",
       .text = "a base and two paddles, which grip bodies and lift them",
       .size = {0.2, 0.3, 0.2},
       .color = {0.3f, 0.3f, 0.3f, 1},
       .has_default_body = false,
       .device = "gripper"},
      {.name = "lightindicator",
       .text = "a light that controllers switch",
       .size = base,
       .color = red,
       .device = "lightindicator"},
      {.name = "model",
       .text = "a body without a sensor or a drive; models of the other kinds also have the properties of "
               "this kind",
       .size = base,
       .color = red},
      {.name = "position", .text = "a body with a drive", .size = base, .color = red},
      {.name = "radio",
       .text = "sends messages to the radios in range, and receives their messages",
       .size = {0.1, 0.1, 0.1},
       .color = {0, 0, 0, 1},
       .has_default_body = false,
       .device = "radio"},
      {.name = "ranger",
       .text = "a ranging sensor; its sensor( ) blocks describe fans of beams",
       .size = {0.15, 0.15, 0.2},
       .color = {0, 0, 0.5f, 1},
       .has_default_body = false,
       .device = "ranger"},
  };
}

}  // namespace troupe::models
