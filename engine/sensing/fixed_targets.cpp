#include "engine/sensing/fixed_targets.hpp"

namespace troupe::engine {

FixedTargets::FixedTargets(const WorldSpec& spec, const std::function<bool(BodyId)>& is_fixed) {
  std::vector<Box> boxes;
  for (std::size_t b = 0; b < spec.bodies.size(); ++b) {
    const BodySpec& body = spec.bodies[b];
    const std::vector<PartSpec>& parts = spec.types[body.type.index()].parts;
    for (std::uint32_t p = 0; p < parts.size(); ++p) {
      if (parts[p].returns.fiducial == 0 || !is_fixed(BodyId(b))) continue;
      targets_.push_back({BodyId(b), p, compose(body.pose_world_body, parts[p].pose_body_part)});
      boxes.push_back(Box::around(targets_.back().pose_world_part.position(), 0));
    }
  }
  places_ = partition::BoxGrid(boxes);
}

}  // namespace troupe::engine
