#pragma once

#include "base/geometry.hpp"
#include "engine/kinds/kinds.hpp"
#include "engine/spec/world_spec.hpp"
#include "worldio/images/floor_image.hpp"
#include "worldio/stage/stage_models.hpp"
#include "worldio/stage/stage_values.hpp"

#include <Eigen/Core>

#include <filesystem>
#include <optional>
#include <vector>

/// Reads the shapes of models in `.world` files, the world files of Stage. Stage is an older robot simulator.
/// A model is a body or a part of a body. A block is an upright prism. A solid (Solid) is an extruded
/// outline.
namespace troupe::worldio {

/// The solids of a Stage model, in the frame of the model, and their source.
struct StageBody {
  std::vector<Solid> solids;               ///< the solids, scaled, m; empty: the model has no shape
  std::optional<engine::ImageSpec> image;  ///< the image, if all solids come from one image
  /// If all solids come from blocks, or from the default box of the model type: these, before scaling. Else
  /// empty.
  std::vector<Solid> blocks;
};

/// Makes the solids of Stage models from their blocks, bitmaps (images) and boundaries (four walls), or from
/// the default box of the model type. `world_directory` is the folder of the world file.
class StageBodies {
 public:
  StageBodies(const StageDocument& document, std::filesystem::path world_directory, StageValues& values,
              Diagnostics& diagnostics)
      : document_(document),
        world_directory_(std::move(world_directory)),
        values_(values),
        images_(diagnostics) {}

  /// Returns the body of a model in the frame of the model, before the property `origin` is applied. The body
  /// is scaled along each axis to `size`, m, and centred in x and y; z is not shifted. `kind` has the
  /// defaults of the type of the model, such as its default box. `blocks` are the blocks in the model, with
  /// their macros applied. A ROS map (an image in the format of ROS's map_server) is not scaled: it keeps its
  /// own pose and its own extent in x and y, and the function stores this extent in `size`. Errors in the
  /// properties are reported; the parts of the body that have errors are then missing.
  StageBody make(const StageModel& model, const engine::ModelKind& kind, Eigen::Vector3d& size,
                 const std::vector<StageModel>& blocks);

 private:
  bool flag(const StageModel& model, std::string_view key);
  /// Reads the image of a `bitmap` and sets the path in `spec`. If the image cannot be read or has no solid
  /// pixel, reports an error and returns null.
  const FloorImage* read_image(const StageProperty& property, engine::ImageSpec& spec);
  /// Warns if the property `size` of the model differs from the size of the ROS map in x or y, because the
  /// map keeps its own size. Reports an error if the model has blocks, because a model cannot have both a ROS
  /// map and blocks.
  void check_map(const StageModel& model, const FloorImage& map, const Eigen::Vector3d& size,
                 const std::vector<StageModel>& blocks);
  void add_block(const StageModel& block, std::vector<Solid>& solids);

  const StageDocument& document_;
  std::filesystem::path world_directory_;
  StageValues& values_;
  FloorImages images_;
};

}  // namespace troupe::worldio
