#pragma once

#include "base/geometry.hpp"
#include "engine/kinds.hpp"
#include "worldio/floor_image.hpp"
#include "worldio/stage_models.hpp"
#include "worldio/stage_values.hpp"

#include <Eigen/Core>

#include <filesystem>
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
        images_(diagnostics) {}

  /// The body of a model, whose blocks have been resolved, in its own frame before its origin: stretched to
  /// `size` and centred in x and y; z keeps its ratio. A map of ROS has its own size in x and y, which is
  /// put into `size`, and its own place.
  std::vector<Solid> make(const StageModel& model, const engine::ModelKind& kind, Eigen::Vector3d& size,
                          const std::vector<StageModel>& blocks);

 private:
  bool flag(const StageModel& model, std::string_view key);
  /// Null, with an error, where there is no image that can be read or nothing of it is solid.
  const FloorImage* read_image(const StageModel& model, const StageProperty& property);
  std::vector<Solid> map(const StageModel& model, const FloorImage& image, Eigen::Vector3d& size,
                         const std::vector<StageModel>& blocks);
  void add_block(const StageModel& block, std::vector<Solid>& solids);

  const StageDocument& document_;
  std::filesystem::path world_directory_;
  StageValues& values_;
  FloorImages images_;
};

}  // namespace troupe::worldio
