#pragma once

#include "base/geometry.hpp"
#include "engine/kinds/registry.hpp"
#include "engine/spec/world_spec.hpp"
#include "worldio/images/floor_image.hpp"
#include "worldio/stage/stage_models.hpp"
#include "worldio/stage/stage_values.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// Makes solids from the shapes of models in `.world` files, the world files of Stage. Stage is an older
/// robot simulator. A model is a body or a part of a body. A block is an upright prism in such a file. A
/// solid (Solid) is an outline that is extruded along z.
namespace troupe::worldio {

/// The shape of a Stage model: its solids, in the frame of the model, and the image or the blocks that they
/// are made from.
struct StageBody {
  std::vector<Solid> solids;               ///< the solids, scaled, m; empty: the model has no shape
  std::optional<engine::ImageSpec> image;  ///< the image, if all solids come from one image
  /// The solids before scaling, if all of them come from blocks or from the default box of the model type;
  /// otherwise empty.
  std::vector<Solid> blocks;
};

/// Makes the solids of Stage models. Each solid comes from a block, the `bitmap` (an image) or the `boundary`
/// (four walls) of the model, or from the default box of the model type. `world_directory` is the folder of
/// the world file. An image with a relative path is searched for first in StageDocument::base_directory and
/// then in `world_directory`.
class StageBodies {
 public:
  StageBodies(const StageDocument& document, std::filesystem::path world_directory, StageValues& values,
              Diagnostics& diagnostics)
      : document_(document),
        world_directory_(std::move(world_directory)),
        values_(values),
        images_(diagnostics) {}

  /// Returns the shape of a model in the frame of the model, before the property `origin` is applied.
  /// kind    the type of the model, which has defaults such as a default box
  /// size    size of the model along x, y and z, m
  /// blocks  the blocks in the model, with their macros applied
  /// The shape is scaled to `size` along each axis and centred in x and y. It is not moved in z.
  ///
  /// A ROS map (an image in the format of ROS's map_server) is not scaled or centred in x and y. It keeps its
  /// own pose and its own extent, and the function stores this extent in `size`.
  ///
  /// Errors in properties are reported. Blocks and images with errors are missing in the result.
  StageBody make(const StageModel& model, const engine::ModelKind& kind, Eigen::Vector3d& size,
                 const std::vector<StageModel>& blocks);

 private:
  bool flag(const StageModel& model, std::string_view key);
  /// Reads the image that the property `bitmap` names, and stores the path of the image in spec.file. If the
  /// image cannot be read, reports an error and returns null. Warns if it has no solid pixel.
  const FloorImage* read_image(const StageProperty& property, engine::ImageSpec& spec);
  /// Checks a model whose `bitmap` is a ROS map. Warns if the property `size` of the model has another x or y
  /// than the map, because the map keeps its own size. Reports an error if there are blocks, because a model
  /// cannot have both a ROS map and blocks.
  void check_map(const StageModel& model, const FloorImage& map, const Eigen::Vector3d& size,
                 const std::vector<StageModel>& blocks);
  std::nullopt_t refuse(Where where, std::string message);  // reports an error
  /// Each of these reads properties of a block. If one is wrong, reports an error and returns nothing.
  ///@{
  std::optional<std::int64_t> corner_count(const StageModel& block);
  std::optional<Ring> outline(const StageModel& block);
  std::optional<ZInterval> heights(const StageModel& block);
  ///@}
  /// Returns, for each corner of a block, the property that gives its position; null if there is none.
  std::vector<const StageProperty*> corner_properties(const StageModel& block, std::int64_t count);
  void add_block(const StageModel& block, std::vector<Solid>& solids);

  const StageDocument& document_;
  std::filesystem::path world_directory_;
  StageValues& values_;
  FloorImages images_;
};

}  // namespace troupe::worldio
