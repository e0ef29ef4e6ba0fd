#include "worldio/json/json_parts.hpp"

#include "worldio/images/bitmap.hpp"
#include "worldio/images/ros_map.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/json/json_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace troupe::worldio {
namespace {

using engine::Field;
using engine::FieldTable;
using engine::FieldType;
using engine::PartSpec;
using engine::Unit;
using engine::Value;

constexpr std::size_t k_max_points = 1000;  // of a block: the test for crossings is quadratic
constexpr std::string_view k_path =
    "the path of an image, or of the YAML of a map, relative to the world file";

const Field k_size{.name = "size",
                   .type = FieldType::numbers,
                   .unit = Unit::meters,
                   .min = 0,
                   .max = k_max_size_m,
                   .text = "[x, y, height]",
                   .columns = 3,
                   .above_min = true};
const Field k_extent{.name = "extent",
                     .type = FieldType::numbers,
                     .unit = Unit::meters,
                     .min = 0,
                     .max = 2 * k_max_size_m,
                     .columns = 3};
const Field k_height{.name = "height",
                     .unit = Unit::meters,
                     .fallback = 1.0,
                     .min = 0,
                     .max = k_max_size_m,
                     .above_min = true};
const Field k_margins{
    .name = "margins", .type = FieldType::text, .fallback = "trim", .choices = {"trim", "keep"}};
const Field k_unknown{
    .name = "unknown", .type = FieldType::text, .fallback = "free", .choices = {"free", "solid"}};
const Field k_boundary{.name = "boundary", .type = FieldType::boolean, .fallback = false};
const Field k_z{.name = "z",
                .type = FieldType::numbers,
                .unit = Unit::meters,
                .min = -k_max_size_m,
                .max = k_max_size_m,
                .text = "the heights between which the block stands, [min, max]",
                .columns = 2};
/// In which the points of a block are given.
const Field k_frame{
    .name = "frame", .type = FieldType::text, .fallback = "part", .choices = {"part", "body"}};
/// Whether blocks are stretched to the size, and where their middle is then.
const Field k_fit{.name = "fit", .type = FieldType::boolean, .fallback = false};
const Field k_origin{.name = "origin", .type = FieldType::record, .record = &engine::pose_fields()};
const Field k_pose{.name = "pose", .type = FieldType::record, .record = &engine::pose_fields()};

Solid box(const Eigen::Vector3d& size) {
  const double x = size.x() / 2;
  const double y = size.y() / 2;
  return {{{{-x, -y}, {x, -y}, {x, y}, {-x, y}}}, {0, size.z()}};
}

/// Sign of the turn a -> b -> c.
int turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  const double t = cross(b - a, c - a);
  return t > 0 ? 1 : t < 0 ? -1 : 0;
}

bool within_box(const Vec2& a, const Vec2& b, const Vec2& p) {
  return p.x() >= std::min(a.x(), b.x()) && p.x() <= std::max(a.x(), b.x()) &&
         p.y() >= std::min(a.y(), b.y()) && p.y() <= std::max(a.y(), b.y());
}

/// True when the closed segments share a point.
bool segments_meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const int abc = turn(a, b, c), abd = turn(a, b, d), cda = turn(c, d, a), cdb = turn(c, d, b);
  if (abc * abd < 0 && cda * cdb < 0) return true;
  return (abc == 0 && within_box(a, b, c)) || (abd == 0 && within_box(a, b, d)) ||
         (cda == 0 && within_box(c, d, a)) || (cdb == 0 && within_box(c, d, b));
}

/// Outlines that are taken as they stand: what lies within an odd number of them is solid.
std::vector<Ring> read_contours(const JsonCursor& at) {
  std::vector<Ring> contours;
  const JsonNode::List* list = read_list(at);
  for (std::size_t i = 0; list && i < list->size(); ++i) {
    Ring ring = read_points(JsonCursor(at, i, (*list)[i]), 3);
    if (!ring.empty()) contours.push_back(std::move(ring));
  }
  if (list && list->empty()) at.expected("at least one outline, [[x, y], ...]");
  if (list && contours.size() < list->size()) contours.clear();
  return contours;
}

/// One outline, which must be plain.
std::vector<Ring> read_outline(const JsonCursor& at) {
  Ring points = read_points(at, 3, k_max_points);
  if (points.empty()) return {};
  if (const Result<> outline = check_outline(points); !outline) at.error(outline.error().text);
  if (signed_area(points) < 0) std::ranges::reverse(points);
  return {std::move(points)};
}

std::optional<Solid> read_block(const JsonCursor& at, const Pose& pose_body_part) {
  JsonObject object(at);
  std::vector<Ring> contours;
  const JsonNode* many = object.find("contours_m");
  const JsonNode* one =
      many ? object.find("points_m") : object.require("points_m", "the outline, [[x, y], ...]");
  if (one) contours = read_outline(JsonCursor(at, "points_m", *one));
  if (many) contours = read_contours(JsonCursor(at, "contours_m", *many));
  if (one && many) at.error_at(many->where, "give \"points_m\" or \"contours_m\", not both");
  const FieldTable table{{k_z, k_frame}};
  const engine::Record record = read_fields(object, table);
  object.finish();
  const Value& z = record[0];
  if (z.given() && (z.numbers()[0] > z.numbers()[1] || (one && z.numbers()[0] == z.numbers()[1])))
    at.error(fmt::format("\"z_m\" must rise from min to max, found {:.10g} and {:.10g}", z.numbers()[0],
                         z.numbers()[1]));
  if (contours.empty() || !z.given()) return {};
  Solid solid{std::move(contours), {z.numbers()[0], z.numbers()[1]}};
  if (pose_body_part == Pose() || record[1].text() == "body") return solid;
  return placed(std::move(solid), pose_body_part);
}

std::vector<Solid> read_blocks(JsonObject& object, const Pose& pose_body_part) {
  std::vector<Solid> solids;
  const JsonNode* node = object.find("blocks");
  if (!node) return solids;
  const JsonCursor blocks(object.at(), "blocks", *node);
  const JsonNode::List* list = read_list(blocks);
  for (std::size_t i = 0; list && i < list->size(); ++i)
    if (auto solid = read_block(JsonCursor(blocks, i, (*list)[i]), pose_body_part))
      solids.push_back(std::move(*solid));
  return solids;
}

JsonNode block_node(const Solid& solid, bool is_in_part_frame) {
  JsonNode::Object object;
  const Ring& ring = solid.contours.front();
  const bool is_plain = solid.contours.size() == 1 && ring.size() >= 3 && ring.size() <= k_max_points &&
                        solid.z.min < solid.z.max && check_outline(ring) && signed_area(ring) >= 0;
  if (is_plain) {
    add_node(object, "points_m", points_node(ring));
  } else {
    JsonNode::List contours;
    for (const Ring& contour : solid.contours) contours.push_back(points_node(contour));
    add_member(object, "contours_m", std::move(contours));
  }
  write_field(k_z, std::vector<double>{solid.z.min, solid.z.max}, object);
  if (!is_in_part_frame) write_field(k_frame, "body", object);
  return json_node(std::move(object));
}

bool same_bits(const Solid& a, const Solid& b) {
  const auto same = [](const Vec2& p, const Vec2& q) {
    return worldio::same_bits(p.x(), q.x()) && worldio::same_bits(p.y(), q.y());
  };
  if (!worldio::same_bits(a.z.min, b.z.min) || !worldio::same_bits(a.z.max, b.z.max)) return false;
  return std::equal(
      a.contours.begin(), a.contours.end(), b.contours.begin(), b.contours.end(),
      [&](const Ring& r, const Ring& s) { return std::equal(r.begin(), r.end(), s.begin(), s.end(), same); });
}

bool same_bits(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return worldio::same_bits(a.x(), b.x()) && worldio::same_bits(a.y(), b.y()) &&
         worldio::same_bits(a.z(), b.z());
}

std::vector<double> list_of(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Pose pose_of(const Value& value) {
  const engine::Record& fields = value.records().front();
  const auto number = [&](std::string_view name) {
    return engine::get(engine::pose_fields(), fields, name).number();
  };
  return {number("x"), number("y"), number("z"), number("heading")};
}

Value value_of(const Pose& pose) {
  return std::vector<engine::Record>{{pose.x, pose.y, pose.z, pose.heading}};
}

/// What Stage makes of blocks, in the body's frame.
std::vector<Solid> fitted_solids(const engine::FittedBlocks& fitted, const PartSpec& part) {
  std::vector<Solid> solids = fitted.blocks;
  normalise(solids, part.size);
  const Pose pose_body_frame = compose(part.pose_body_part, fitted.origin);
  for (Solid& solid : solids) solid = placed(std::move(solid), pose_body_frame);
  return solids;
}

/// `size_m`, `blocks`, `fit` and `origin`, where the blocks are to be stretched.
void read_fitted(JsonObject& object, PartSpec& part) {
  const FieldTable table{{k_size}};
  const Value size = read_fields(object, table)[0];
  engine::FittedBlocks fitted;
  if (const Value origin = read_field(object, k_origin); origin.given()) fitted.origin = pose_of(origin);
  fitted.blocks = read_blocks(object, Pose());
  if (!size.given()) return;
  part.size = Eigen::Vector3d::Map(size.numbers().data());
  part.solids = fitted_solids(fitted, part);
  part.fitted = std::move(fitted);
}

/// Whether its blocks make its solids again.
bool is_fitted(const PartSpec& part) {
  if (!part.fitted || part.size.minCoeff() <= 0) return false;
  const std::vector<Solid> solids = fitted_solids(*part.fitted, part);
  return std::equal(solids.begin(), solids.end(), part.solids.begin(), part.solids.end(),
                    [](const Solid& a, const Solid& b) { return same_bits(a, b); });
}

/// The one box that `size_m` would put there.
bool is_box(const PartSpec& part) {
  if (part.solids.size() != 1 || part.size.minCoeff() <= 0) return false;
  Solid expected = box(part.size);
  if (part.pose_body_part != Pose()) expected = placed(std::move(expected), part.pose_body_part);
  return same_bits(part.solids.front(), expected);
}

}  // namespace

Pose read_pose(JsonObject& object, const Pose& fallback) {
  const Value value = read_field(object, k_pose);
  return value.given() ? pose_of(value) : fallback;
}

void write_pose(const Pose& pose, JsonNode::Object& object, const Pose& fallback) {
  if (!worldio::same_bits(value_of(pose), value_of(fallback))) write_field(k_pose, value_of(pose), object);
}

void write_place(const Pose& pose, JsonNode::Object& object) {
  JsonNode::Object place;
  const std::vector<Field>& fields = engine::pose_fields().fields;
  write_field(fields[0], pose.x, place);
  write_field(fields[1], pose.y, place);
  if (!worldio::same_bits(pose.z, 0)) write_field(fields[2], pose.z, place);
  write_field(fields[3], pose.heading, place);
  add_member(object, k_pose.name, std::move(place));
}

bool read_boolean(JsonObject& object, std::string_view name, bool fallback) {
  const Value value = read_field(object, {.name = name, .type = FieldType::boolean});
  return value.given() ? value.boolean() : fallback;
}

engine::Returns read_returns(JsonObject& object) {
  engine::Returns returns;
  returns.obstacle = read_boolean(object, "obstacle", returns.obstacle);
  const Value ranger = read_field(object, {.name = "ranger_return", .min = -1e6, .max = 1e6});
  if (ranger.given()) returns.ranger = static_cast<float>(ranger.number());
  const auto mark = [&](std::string_view name, std::int32_t& member) {
    using Limits = std::numeric_limits<std::int32_t>;
    const Value value = read_field(
        object, {.name = name, .type = FieldType::integer, .min = Limits::min(), .max = Limits::max()});
    if (value.given()) member = static_cast<std::int32_t>(value.integer());
  };
  mark("fiducial_return", returns.fiducial);
  mark("fiducial_key", returns.fiducial_key);
  returns.gripper = read_boolean(object, "gripper_return", returns.gripper);
  returns.blob = read_boolean(object, "blob_return", returns.blob);
  returns.pushable = read_boolean(object, "pushable", returns.pushable);
  return returns;
}

void write_returns(const engine::Returns& returns, JsonNode::Object& object) {
  const engine::Returns usual;
  const auto& [obstacle, ranger, fiducial, fiducial_key, gripper, pushable, blob] = returns;
  if (obstacle != usual.obstacle) add_member(object, "obstacle", obstacle);
  if (ranger != usual.ranger) add_member(object, "ranger_return", short_number(ranger));
  if (fiducial != usual.fiducial) add_member(object, "fiducial_return", std::int64_t{fiducial});
  if (fiducial_key != usual.fiducial_key) add_member(object, "fiducial_key", std::int64_t{fiducial_key});
  if (gripper != usual.gripper) add_member(object, "gripper_return", gripper);
  if (blob != usual.blob) add_member(object, "blob_return", blob);
  if (pushable != usual.pushable) add_member(object, "pushable", pushable);
}

std::vector<Vec2> read_points(const JsonCursor& at, std::size_t least, std::size_t most) {
  const JsonNode::List* list = read_list(at);
  if (!list) return {};
  if (list->size() < least || list->size() > most) {
    at.error(least == most ? fmt::format("expected {} points, found {}", least, list->size())
                           : fmt::format("expected {} to {} points, found {}", least, most, list->size()));
    return {};
  }
  const Field field{.name = "point",
                    .type = FieldType::numbers,
                    .unit = Unit::meters,
                    .min = -k_max_size_m,
                    .max = k_max_size_m,
                    .columns = 2};
  std::vector<Vec2> points;
  for (std::size_t i = 0; i < list->size(); ++i) {
    const Value xy = read_value(JsonCursor(at, i, (*list)[i]), field);
    if (xy.given()) points.emplace_back(xy.numbers()[0], xy.numbers()[1]);
  }
  if (points.size() < list->size()) points.clear();
  return points;
}

JsonNode points_node(std::span<const Vec2> points) {
  JsonNode::List list;
  for (const Vec2& point : points) list.push_back(json_numbers(std::array{point.x(), point.y()}));
  return json_node(std::move(list));
}

std::optional<Box> read_box(JsonObject& object, std::string_view key) {
  const JsonNode* node = object.find(key);
  if (!node) return std::nullopt;
  const JsonCursor at(object.at(), key, *node);
  const std::vector<Vec2> corners = read_points(at, 2, 2);
  if (corners.empty()) return std::nullopt;
  Box box;
  box.min = corners[0];
  box.max = corners[1];
  if (!box.empty()) return box;
  at.error("the corners stand the wrong way round: give [[x_min, y_min], [x_max, y_max]]");
  return std::nullopt;
}

Result<> check_outline(const Ring& ring) {
  const std::size_t n = ring.size();
  const auto at = [&](std::size_t i) -> const Vec2& { return ring[i % n]; };
  for (std::size_t i = 0; i < n; ++i)
    if (at(i) == at(i + 1))
      return Error{i + 1 < n ? fmt::format("point {} repeats point {}", i + 1, i)
                             : "the last point repeats the first: the outline is closed anyway"};
  constexpr double k_flat = 1e-12;  // rounding, relative to the extent
  const double widest = bounds(ring).size().maxCoeff();
  if (std::ranges::all_of(ring, [&](const Vec2& p) {
        return std::abs(cross(ring[1] - ring[0], p - ring[0])) <= k_flat * widest * widest;
      }))
    return Error{"the outline has no area"};
  for (std::size_t i = 0; i < n; ++i)
    if (turn(at(i), at(i + 1), at(i + 2)) == 0 && (at(i + 1) - at(i)).dot(at(i + 2) - at(i + 1)) < 0)
      return Error{fmt::format("the outline turns back on itself at point {}", (i + 1) % n)};
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n && j + 1 < n + i; ++j)
      if (segments_meet(at(i), at(i + 1), at(j), at(j + 1)))
        return Error{
            fmt::format("the outline crosses or touches itself: the edges from points {} and {}", i, j)};
  return {};
}

std::optional<JsonImage> read_image(JsonObject& object, FloorImages& images,
                                    const std::filesystem::path& folder) {
  const JsonNode* node = object.require("bitmap", k_path);
  const std::string* path = node ? read_text(JsonCursor(object.at(), "bitmap", *node), k_path) : nullptr;
  const bool is_map = path && is_ros_map(*path);
  const FieldTable table{{k_boundary, is_map ? k_unknown : k_margins, is_map ? k_height : k_size}};
  const engine::Record record = read_fields(object, table);
  if (!path || !record[2].given()) return {};
  JsonImage given;
  given.spec = {.file = (folder / *path).string(),
                .keeps_margins = record[1].text() == "keep",
                .unknown_is_solid = record[1].text() == "solid",
                .boundary = record[0].boolean()};
  given.image = images.read(given.spec.file, given.spec.unknown_is_solid, node->where);
  if (!given.image) return {};
  if (given.image->contours.empty()) {
    JsonCursor(object.at(), "bitmap", *node)
        .error(is_map ? fmt::format("\"{}\" has no occupied cell", *path)
                      : fmt::format("\"{}\" has no dark pixel: nothing of it is solid", *path));
    return {};
  }
  if (is_map)
    given.size << given.image->place->size_m, record[2].number();
  else
    given.size = Eigen::Vector3d::Map(record[2].numbers().data());
  return given;
}

void write_image(const engine::ImageSpec& image, const Eigen::Vector3d& size,
                 const std::filesystem::path& folder, JsonNode::Object& object) {
  namespace fs = std::filesystem;
  const fs::path file = fs::weakly_canonical(image.file);
  const fs::path from = fs::weakly_canonical(folder.empty() ? "." : folder);
  add_member(object, "bitmap", file.lexically_proximate(from).generic_string());
  if (is_ros_map(image.file)) {
    write_field(k_height, size.z(), object);
    if (image.unknown_is_solid) write_field(k_unknown, "solid", object);
  } else {
    write_field(k_size, list_of(size), object);
    if (image.keeps_margins) write_field(k_margins, "keep", object);
  }
  if (image.boundary) write_field(k_boundary, true, object);
}

std::vector<Solid> read_solids(JsonObject& object, const Pose& pose_body_part) {
  std::vector<Solid> solids;
  if (const Value size = read_field(object, k_size); size.given()) {
    solids.push_back(box(Eigen::Vector3d::Map(size.numbers().data())));
    if (pose_body_part != Pose()) solids.back() = placed(std::move(solids.back()), pose_body_part);
  }
  for (Solid& solid : read_blocks(object, pose_body_part)) solids.push_back(std::move(solid));
  return solids;
}

void measure_part(PartSpec& part) {
  Box extent;
  ZInterval z;
  for (const Solid& solid : part.solids) {
    for (const Ring& ring : solid.contours) extent.extend(bounds(ring));
    z = {std::min(z.min, solid.z.min), std::max(z.max, solid.z.max)};
  }
  if (!extent.empty()) part.size = {extent.size().x(), extent.size().y(), z.max - z.min};
}

std::vector<Solid> image_solids(const FloorImage& image, PartSpec& part) {
  std::vector<Solid> solids = image_body(image, *part.image, part.size);
  const Pose pose_body_image = compose(part.pose_body_part, part.image->origin);
  if (pose_body_image != Pose())
    for (Solid& solid : solids) solid = placed(std::move(solid), pose_body_image);
  return solids;
}

bool read_shape(JsonObject& object, ImageFolder& images, PartSpec& part) {
  const bool has_image = object.find("bitmap") != nullptr;
  bool is_given = has_image;
  if (has_image) {
    const Value origin = read_field(object, k_origin);
    if (const auto given = read_image(object, images.images, images.folder)) {
      part.size = given->size;
      part.image = given->spec;
      if (origin.given()) part.image->origin = pose_of(origin);
      part.solids = image_solids(*given->image, part);
    }
  } else if (read_boolean(object, "fit", false)) {
    is_given = true;
    read_fitted(object, part);
  } else {
    const bool has_blocks = object.find("blocks") != nullptr;
    part.solids = read_solids(object, part.pose_body_part);
    is_given = has_blocks || !part.solids.empty();
    measure_part(part);
    // A box is as large as it says, wherever it stands.
    if (!has_blocks && !part.solids.empty())
      part.size = Eigen::Vector3d::Map(read_field(object, k_size).numbers().data());
  }
  part.floor_plan = read_boolean(object, "floor_plan", has_image);
  return is_given;
}

Eigen::Vector3d write_shape(const PartSpec& part, const std::filesystem::path* folder,
                            JsonNode::Object& object) {
  const bool as_image = part.image && folder;
  PartSpec read = part;  // what a reader makes of it
  if (as_image) {
    write_image(*part.image, part.size, *folder, object);
    if (part.image->origin != Pose()) write_field(k_origin, value_of(part.image->origin), object);
  } else if (is_box(part)) {
    write_field(k_size, list_of(part.size), object);
  } else if (is_fitted(part)) {
    write_field(k_size, list_of(part.size), object);
    write_field(k_fit, true, object);
    if (part.fitted->origin != Pose()) write_field(k_origin, value_of(part.fitted->origin), object);
    JsonNode::List blocks;
    for (const Solid& block : part.fitted->blocks) blocks.push_back(block_node(block, true));
    add_member(object, "blocks", std::move(blocks));
  } else {
    JsonNode::List blocks;
    const bool is_in_part_frame = part.pose_body_part == Pose();
    for (const Solid& solid : part.solids) blocks.push_back(block_node(solid, is_in_part_frame));
    add_member(object, "blocks", std::move(blocks));
    read.size = PartSpec().size;
    measure_part(read);
  }
  if (part.floor_plan != as_image) add_member(object, "floor_plan", part.floor_plan);
  return read.size;
}

bool read_extent(JsonObject& object, PartSpec& part) {
  const Value extent = read_field(object, k_extent);
  if (extent.given()) part.size = Eigen::Vector3d::Map(extent.numbers().data());
  return extent.given();
}

void write_extent(const PartSpec& part, const Eigen::Vector3d& size_read, JsonNode::Object& object) {
  if (!same_bits(part.size, size_read)) write_field(k_extent, list_of(part.size), object);
}

}  // namespace troupe::worldio
