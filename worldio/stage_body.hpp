#pragma once

#include "base/geometry.hpp"
#include "engine/kinds.hpp"
#include "worldio/stage_models.hpp"
#include "worldio/stage_values.hpp"

#include <Eigen/Core>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace troupe::worldio {

/// Makes the solids of models: default bodies, bitmaps, boundaries and blocks.
class StageBodies {
 public:
  StageBodies(const StageDocument& document, std::filesystem::path world_directory, StageValues& values,
              Diagnostics& diagnostics)
      : document_(document),
        world_directory_(std::move(world_directory)),
        values_(values),
        diagnostics_(diagnostics) {}

  /// The body of a model, whose blocks have been resolved, in its own frame before its origin: stretched to
  /// `size` and centred in x and y; z keeps its ratio.
  std::vector<Solid> make(const StageModel& model, const engine::ModelKind& kind, const Eigen::Vector3d& size,
                          const std::vector<StageModel>& blocks);

 private:
  void add_bitmap(const StageProperty& property, std::vector<Solid>& solids);
  void add_block(const StageModel& block, std::vector<Solid>& solids);

  const StageDocument& document_;
  std::filesystem::path world_directory_;
  StageValues& values_;
  Diagnostics& diagnostics_;
  std::map<std::string, std::vector<Ring>> contours_;  // of each image, in pixels; empty after an error
};

}  // namespace troupe::worldio
