#include "worldio/stage/stage_body.hpp"

#include "worldio/images/bitmap.hpp"
#include "worldio/json/document_table.hpp"
#include "worldio/json/json_parts.hpp"
#include "worldio/stage/stage_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace troupe::worldio {
namespace {

Solid box(double x_min, double x_max, double y_min, double y_max, double z_min, double z_max) {
  return {{{Vec2(x_min, y_min), Vec2(x_max, y_min), Vec2(x_max, y_max), Vec2(x_min, y_max)}}, {z_min, z_max}};
}

}  // namespace

bool StageBodies::flag(const StageModel& model, std::string_view key) {
  return values_.flag(model.find(document_, key), false);
}

StageBody StageBodies::make(const StageModel& model, const engine::ModelKind& kind, Eigen::Vector3d& size,
                            const std::vector<StageModel>& blocks) {
  std::vector<Solid> solids;
  // While `is_default` is true, the block children of the model replace all solids made so far.
  bool is_default = kind.has_default_body;
  if (is_default) solids.push_back(box(-0.5, 0.5, -0.5, 0.5, 0, 1));
  if (flag(model, "noblocks")) {
    solids.clear();
    is_default = false;
  }
  Box frame;  // the whole image, if its margins are kept
  if (const StageProperty* bitmap = model.find(document_, "bitmap")) {
    if (is_default) solids.clear();
    is_default = false;
    engine::ImageSpec spec{.keeps_margins = flag(model, "bitmap_margins"),
                           .unknown_is_solid = flag(model, "bitmap_unknown"),
                           .boundary = flag(model, "boundary")};
    const FloorImage* image = read_image(*bitmap, spec);
    if (image && image->place) check_map(model, *image, size, blocks);
    if (image && values_.thorough() && !model.find(document_, "bitmap_margins"))
      if (std::string margins = image->margins_text(spec.file, "\"bitmap_margins 1\""); !margins.empty())
        values_.warning_once(values_.where(*bitmap), std::move(margins));
    if (image && (image->place || blocks.empty())) return {image_body(*image, spec, size), spec, {}};
    if (image && spec.keeps_margins) {
      if (!image->contours.empty()) solids.push_back(image->solid(size));
      frame.max = size.head<2>() / 2;
      frame.min = -frame.max;
    } else if (image && !image->contours.empty()) {
      solids.push_back({image->contours, {0, 1}});
    }
  }
  StageBody body;
  if (is_default && blocks.empty() && !flag(model, "boundary")) body.blocks = solids;
  normalise(solids, size, frame);
  if (flag(model, "boundary")) {
    add_boundary(size, solids);
    if (is_default && !blocks.empty())
      values_.warning(
          values_.where(*model.find(document_, "boundary")),
          "\"boundary\" has no effect: as in Stage, a model that has blocks and no \"bitmap\" gets "
          "no walls: remove this property");
  }
  if (is_default && !blocks.empty()) solids.clear();
  const bool is_all_blocks = solids.empty() && frame.empty();
  for (const StageModel& block : blocks) add_block(block, solids);
  if (is_all_blocks) body.blocks = solids;
  normalise(solids, size, frame);
  body.solids = std::move(solids);
  return body;
}

void StageBodies::check_map(const StageModel& model, const FloorImage& map, const Eigen::Vector3d& size,
                            const std::vector<StageModel>& blocks) {
  const Eigen::Vector2d& size_m = map.place->size_m;
  if (const StageProperty* property = model.find(document_, "size"); property && size.head<2>() != size_m)
    values_.warning(
        values_.where(*property),
        fmt::format("only the height (third value) of \"size\" is used: the ROS map is {:g} m x {:g} m, not "
                    "{:g} m x {:g} m",
                    size_m.x(), size_m.y(), size.x(), size.y()));
  if (!blocks.empty())
    values_.error(blocks.front().where,
                  "a model whose \"bitmap\" is a ROS map cannot have blocks: remove the blocks, or put them "
                  "into another model");
}

const FloorImage* StageBodies::read_image(const StageProperty& property, engine::ImageSpec& spec) {
  const auto name = values_.text(property);
  if (!name) return nullptr;
  std::filesystem::path path(*name);
  if (!path.is_absolute()) {
    const std::filesystem::path beside_include = tidied(document_.base_directory / path);
    const std::filesystem::path beside_world = tidied(world_directory_ / path);
    path = find_stage_file(beside_include, {}) ? beside_include : beside_world;
  }
  spec.file = path.string();
  const FloorImage* image = images_.read(path, spec.unknown_is_solid, values_.where(property));
  if (image && image->place && image->place->lacks_unknown)
    values_.warning_once(
        values_.where(property),
        fmt::format(
            "\"bitmap_unknown\" has no effect: the ROS map {} has no unknown cell: remove this property",
            path.string()));
  if (image && image->contours.empty())
    values_.warning_once(values_.where(property), image->unsolid_text(spec));
  return image;
}

std::nullopt_t StageBodies::refuse(Where where, std::string message) {
  values_.error(where, std::move(message));
  return std::nullopt;
}

std::optional<std::int64_t> StageBodies::corner_count(const StageModel& block) {
  constexpr std::int64_t k_most_points = 100000;
  constexpr std::int64_t k_most_missing = 1000;
  const StageProperty* points = block.find(document_, "points");
  if (!points) return refuse(block.where, "a block needs \"points\", the number of its corners");
  const auto count = values_.integer(*points);
  if (!count) return std::nullopt;
  if (*count < 3 || *count > k_most_points)
    return refuse(values_.where(*points),
                  fmt::format("\"points\" must be from 3 to {}, found {}", k_most_points, *count));
  std::int64_t written = 0;
  for (const StageEntity* layer : block.layers) written += layer->properties.count;
  if (*count > written + k_most_missing)
    return refuse(values_.where(*points),
                  fmt::format("\"points\" is {}, but the block has only {} properties, and each corner needs "
                              "a property \"point[...]\": set \"points\" to the number of corners",
                              *count, written));
  return count;
}

std::vector<const StageProperty*> StageBodies::corner_properties(const StageModel& block,
                                                                 std::int64_t count) {
  std::vector<const StageProperty*> given(static_cast<std::size_t>(count));
  for (const StageEntity* layer : block.layers)
    for (const StageProperty& property : document_.properties(*layer)) {
      const auto number = index_in(document_.key(property), "point");
      if (!number) continue;
      if (*number >= 0 && *number < count)
        given[static_cast<std::size_t>(*number)] = &property;
      else
        values_.warning(values_.where(property),
                        fmt::format("\"{}\" is ignored: the block has {} corners, numbered from 0",
                                    document_.key(property), count));
    }
  return given;
}

std::optional<Ring> StageBodies::outline(const StageModel& block) {
  const auto count = corner_count(block);
  if (!count) return std::nullopt;
  const std::vector<const StageProperty*> given = corner_properties(block, *count);
  Ring ring(given.size(), Vec2::Zero());
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (!given[i]) continue;
    const auto v = values_.tuple(*given[i], 2, 2, "[x y]");
    if (!v) return std::nullopt;
    for (const double coordinate : *v)
      if (!values_.is_within(*given[i], point_field(), coordinate * values_.length_unit(), coordinate))
        return std::nullopt;
    ring[i] = Vec2((*v)[0], (*v)[1]) * values_.length_unit();
  }
  if (const auto missing = std::ranges::count(given, nullptr); missing > 0)
    values_.warning(
        values_.where(*block.find(document_, "points")),
        fmt::format("\"point[k]\" is missing for {} of the {} corners; as in Stage, a corner without this "
                    "property is at [0 0]: give all properties from \"point[0]\" to \"point[{}]\"",
                    missing, *count, *count - 1));
  return ring;
}

std::optional<ZInterval> StageBodies::heights(const StageModel& block) {
  const StageProperty* property = block.find(document_, "z");
  if (!property) return ZInterval();
  const auto v = values_.tuple(*property, 2, 2, "[min max]");
  if (!v) return std::nullopt;
  const ZInterval z{(*v)[0] * values_.length_unit(), (*v)[1] * values_.length_unit()};
  const engine::Field& limits = document_table<BlockDocument>().find("z")->field;
  if (!values_.is_within(*property, limits, z.min, (*v)[0]) ||
      !values_.is_within(*property, limits, z.max, (*v)[1]))
    return std::nullopt;
  if (z.min > z.max)
    return refuse(values_.where(*property),
                  fmt::format("\"z\" needs [min max] with min at most max, found [{} {}]", (*v)[0], (*v)[1]));
  return z;
}

void StageBodies::add_block(const StageModel& block, std::vector<Solid>& solids) {
  std::optional<Ring> ring = outline(block);
  if (!ring) return;
  const double area = signed_area(*ring);
  // The parts of an outline that crosses itself may have opposite signed areas.
  if (area == 0)
    values_.warning(block.where, is_on_one_line(*ring)
                                     ? "this block has no area: check its corners, \"point[k]\""
                                     : "the outline of this block crosses or touches itself: check the order "
                                       "of its corners, \"point[k]\"");
  if (area < 0) std::ranges::reverse(*ring);
  const std::optional<ZInterval> z = heights(block);
  if (!z) return;
  if (z->min == z->max)
    values_.warning(block.where,
                    "this block has no height: give the block a \"z\" [min max], with min below max");
  solids.push_back({{*std::move(ring)}, *z});
}

}  // namespace troupe::worldio
