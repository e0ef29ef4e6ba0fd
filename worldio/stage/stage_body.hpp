#pragma once

#include "base/geometry.hpp"
#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"
#include "worldio/images/floor_image.hpp"
#include "worldio/stage/stage_models.hpp"
#include "worldio/stage/stage_values.hpp"

#include <Eigen/Core>

#include <filesystem>
#include <optional>
#include <vector>

namespace troupe::worldio {

/// What a model shows of itself, and the image, or the blocks, that it is made from, where these are all of
/// it.
struct StageBody {
  std::vector<Solid> solids;
  std::optional<engine::ImageSpec> image;
  std::vector<Solid> blocks;
};

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
  StageBody make(const StageModel& model, const engine::ModelKind& kind, Eigen::Vector3d& size,
                 const std::vector<StageModel>& blocks);

 private:
  bool flag(const StageModel& model, std::string_view key);
  /// Null, with an error, where there is no image that can be read or nothing of it is solid.
  const FloorImage* read_image(const StageProperty& property, engine::ImageSpec& spec);
  /// A map of ROS says itself how large it is and where it lies.
  void check_map(const StageModel& model, const FloorImage& map, const Eigen::Vector3d& size,
                 const std::vector<StageModel>& blocks);
  void add_block(const StageModel& block, std::vector<Solid>& solids);

  const StageDocument& document_;
  std::filesystem::path world_directory_;
  StageValues& values_;
  FloorImages images_;
};

}  // namespace troupe::worldio
