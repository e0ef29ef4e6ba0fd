#include "worldio/json/json_parts.hpp"

#include "base/math.hpp"
#include "base/number_text.hpp"
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
using engine::FieldType;
using engine::PartSpec;
using engine::Unit;
using engine::Value;

constexpr double k_map_height_m = 1;  // default height of the walls of a ROS map

Solid box(const Eigen::Vector3d& size) {
  const double x = size.x() / 2;
  const double y = size.y() / 2;
  return {{{{-x, -y}, {x, -y}, {x, y}, {-x, y}}}, {0, size.z()}};
}

Solid disc(const DiscDocument& document) {
  Solid solid{{{}}, {0, *document.height}};
  for (std::int64_t i = 0; i < document.corners; ++i) {
    const SinCos at = sincos(2 * k_pi * static_cast<double>(i) / static_cast<double>(document.corners));
    solid.contours.front().emplace_back(*document.radius * at.cos, *document.radius * at.sin);
  }
  return solid;
}

/// Returns the direction of the turn at b on the path a, b, c: 1 to the left, -1 to the right, 0 if the three
/// points are on one line.
int turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  const double t = cross(b - a, c - a);
  return t > 0 ? 1 : t < 0 ? -1 : 0;
}

bool within_box(const Vec2& a, const Vec2& b, const Vec2& p) {
  return p.x() >= std::min(a.x(), b.x()) && p.x() <= std::max(a.x(), b.x()) &&
         p.y() >= std::min(a.y(), b.y()) && p.y() <= std::max(a.y(), b.y());
}

/// Whether the closed segments ab and cd share a point.
bool segments_meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const int abc = turn(a, b, c), abd = turn(a, b, d), cda = turn(c, d, a), cdb = turn(c, d, b);
  if (abc * abd < 0 && cda * cdb < 0) return true;
  return (abc == 0 && within_box(a, b, c)) || (abd == 0 && within_box(a, b, d)) ||
         (cda == 0 && within_box(c, d, a)) || (cdb == 0 && within_box(c, d, b));
}

/// Returns the solid that a block describes, in the frame of the body. Empty if the document is incomplete;
/// the reader of documents has then already reported an error.
std::optional<Solid> expand_block(const BlockDocument& document, const Pose& pose_body_part) {
  if (!document.z || (!document.points && !document.contours)) return std::nullopt;
  Solid solid{{}, {(*document.z)[0], (*document.z)[1]}};
  if (document.contours) {
    solid.contours = *document.contours;
  } else {
    solid.contours = {*document.points};
    if (signed_area(solid.contours.front()) < 0) std::ranges::reverse(solid.contours.front());
  }
  if (pose_body_part == Pose() || document.frame == BlockDocument::Frame::body) return solid;
  return placed(std::move(solid), pose_body_part);
}

std::vector<Solid> expand_blocks(std::span<const BlockDocument> blocks, const Pose& pose_body_part) {
  std::vector<Solid> solids;
  for (const BlockDocument& block : blocks)
    if (auto solid = expand_block(block, pose_body_part)) solids.push_back(std::move(*solid));
  return solids;
}

BlockDocument contract_block(const Solid& solid, BlockDocument::Frame frame) {
  BlockDocument document;
  const Ring& ring = solid.contours.front();
  const bool is_plain = solid.contours.size() == 1 && ring.size() >= 3 &&
                        ring.size() <= k_most_block_points && solid.z.min < solid.z.max &&
                        check_outline(ring) && signed_area(ring) >= 0;
  if (is_plain)
    document.points = ring;
  else
    document.contours = solid.contours;
  document.z = {solid.z.min, solid.z.max};
  document.frame = frame;
  return document;
}

bool same_solid(const Solid& a, const Solid& b) {
  const auto same = [](const Vec2& p, const Vec2& q) {
    return worldio::same_bits(p.x(), q.x()) && worldio::same_bits(p.y(), q.y());
  };
  if (!worldio::same_bits(a.z.min, b.z.min) || !worldio::same_bits(a.z.max, b.z.max)) return false;
  return std::equal(
      a.contours.begin(), a.contours.end(), b.contours.begin(), b.contours.end(),
      [&](const Ring& r, const Ring& s) { return std::equal(r.begin(), r.end(), s.begin(), s.end(), same); });
}

bool same_size(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return worldio::same_bits(a.x(), b.x()) && worldio::same_bits(a.y(), b.y()) &&
         worldio::same_bits(a.z(), b.z());
}

/// Returns the blocks, scaled to the size of the part as Stage does it, in the frame of the body.
std::vector<Solid> fitted_solids(const engine::FittedBlocks& fitted, const PartSpec& part) {
  std::vector<Solid> solids = fitted.blocks;
  normalise(solids, part.size);
  const Pose pose_body_frame = compose(part.pose_body_part, fitted.origin);
  for (Solid& solid : solids) solid = placed(std::move(solid), pose_body_frame);
  return solids;
}

/// Sets the shape of a part that has the key `fit`: its blocks, scaled together to its size.
void expand_fitted(const PartDocument& document, PartSpec& part) {
  engine::FittedBlocks fitted;
  fitted.origin = document.origin.value_or(Pose());
  if (document.blocks) fitted.blocks = expand_blocks(*document.blocks, Pose());
  if (!document.image.size) return;
  part.size = *document.image.size;
  part.solids = fitted_solids(fitted, part);
  part.fitted = std::move(fitted);
}

/// Whether the fitted blocks of a part give exactly its present solids.
bool is_fitted(const PartSpec& part) {
  if (!part.fitted || part.size.minCoeff() <= 0) return false;
  const std::vector<Solid> solids = fitted_solids(*part.fitted, part);
  return std::equal(solids.begin(), solids.end(), part.solids.begin(), part.solids.end(), same_solid);
}

/// Whether the only solid of a part is the box that the key `size_m` would give it.
bool is_box(const PartSpec& part) {
  if (part.solids.size() != 1 || part.size.minCoeff() <= 0) return false;
  Solid expected = box(part.size);
  if (part.pose_body_part != Pose()) expected = placed(std::move(expected), part.pose_body_part);
  return same_solid(part.solids.front(), expected);
}

}  // namespace

const engine::Field& point_field() {
  static const Field field{.name = "point",
                           .type = FieldType::numbers,
                           .unit = Unit::meters,
                           .min = -k_max_size_m,
                           .max = k_max_size_m,
                           .columns = 2};
  return field;
}

std::vector<Vec2> read_points(const JsonCursor& at, std::size_t least, std::size_t most) {
  const JsonNode::List* list = read_list(at);
  if (!list) return {};
  if (list->size() < least || list->size() > most) {
    const bool has_most = most != std::numeric_limits<std::size_t>::max();
    at.error(fmt::format("expected {} points, found {}",
                         least == most ? fmt::format("{}", least)
                         : has_most    ? fmt::format("{} to {}", least, most)
                                       : fmt::format("at least {}", least),
                         list->size()));
    return {};
  }
  std::vector<Vec2> points;
  for (std::size_t i = 0; i < list->size(); ++i) {
    const Value xy = read_value(JsonCursor(at, i, (*list)[i]), point_field());
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

std::optional<Box> read_box(const JsonCursor& at) {
  const std::vector<Vec2> corners = read_points(at, 2, 2);
  if (corners.empty()) return std::nullopt;
  Box box;
  box.min = corners[0];
  box.max = corners[1];
  if (!box.empty()) return box;
  at.error(fmt::format(
      "the corners are in the wrong order: expected [[x_min, y_min], [x_max, y_max]], found [[{}, {}], "
      "[{}, {}]]",
      plain_number(box.min.x()), plain_number(box.min.y()), plain_number(box.max.x()),
      plain_number(box.max.y())));
  return std::nullopt;
}

bool is_on_one_line(const Ring& ring) {
  constexpr double k_flat = 1e-12;  // tolerance for rounding errors, relative to the extent
  const double widest = bounds(ring).size().maxCoeff();
  return std::ranges::all_of(ring, [&](const Vec2& p) {
    return std::abs(cross(ring[1] - ring[0], p - ring[0])) <= k_flat * widest * widest;
  });
}

Result<> check_outline(const Ring& ring) {
  const std::size_t n = ring.size();
  const auto at = [&](std::size_t i) -> const Vec2& { return ring[i % n]; };
  for (std::size_t i = 0; i < n; ++i)
    if (at(i) == at(i + 1))
      return Error{i + 1 < n
                       ? fmt::format("point {} repeats point {} (points are counted from 0): remove one "
                                     "of the two",
                                     i + 1, i)
                       : "the last point repeats the first: omit the last point, because outlines are "
                         "closed automatically"};
  if (is_on_one_line(ring)) return Error{"the outline has no area: all its points lie on one line"};
  for (std::size_t i = 0; i < n; ++i)
    if (turn(at(i), at(i + 1), at(i + 2)) == 0 && (at(i + 1) - at(i)).dot(at(i + 2) - at(i + 1)) < 0)
      return Error{fmt::format(
          "the outline turns back on itself at point {}, counted from 0: remove this point", (i + 1) % n)};
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n && j + 1 < n + i; ++j)
      if (segments_meet(at(i), at(i + 1), at(j), at(j + 1)))
        return Error{
            fmt::format("the outline crosses or touches itself: the edges that begin at points {} and {}, "
                        "counted from 0, meet",
                        i, j)};
  return {};
}

std::optional<ExpandedImage> expand_image(const ImageDocument& document, const Placed& object,
                                          const DocumentPath& at, ImageFolder& images) {
  const bool is_map = is_ros_map(document.bitmap);
  if (document.bitmap.empty() || (!is_map && !document.size)) return std::nullopt;
  ExpandedImage made;
  made.spec = {.file = (images.folder / document.bitmap).string(),
               .keeps_margins = !is_map && document.margins == ImageDocument::Margins::keep,
               .unknown_is_solid = is_map && document.unknown == ImageDocument::Unknown::solid,
               .boundary = document.boundary};
  const Where where = object.where_of("bitmap");
  made.image = images.images.read(made.spec.file, made.spec.unknown_is_solid, where);
  if (!made.image) return std::nullopt;
  if (made.image->contours.empty())
    DocumentPath(at, "bitmap", where).warning(made.image->unsolid_text(made.spec));
  const bool says_margins =
      std::ranges::find(object.keys, "margins", &Placed::Key::name) != object.keys.end();
  if (at.diagnostics().thorough() && !says_margins)
    if (const std::string margins = made.image->margins_text(made.spec.file, "\"margins\": \"keep\"");
        !margins.empty())
      DocumentPath(at, "bitmap", where).warning(margins);
  if (is_map && made.image->place->lacks_unknown) {
    const DocumentPath unknown(at, "unknown", object.where_of("unknown"));
    unknown.diagnostics().warning(
        unknown.where(),
        fmt::format(
            "{}: \"solid\" has no effect, because the ROS map \"{}\" has no unknown cell: remove this key",
            unknown.pointer(), document.bitmap));
  }
  if (is_map)
    made.size << made.image->place->size_m, document.height.value_or(k_map_height_m);
  else
    made.size = *document.size;
  return made;
}

ImageDocument contract_image(const engine::ImageSpec& image, const Eigen::Vector3d& size,
                             const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  const auto resolved = [](const fs::path& path) { return fs::weakly_canonical(path.empty() ? "." : path); };
  // The file itself is not resolved: if it is a symbolic link to the YAML file of a map, the path of the
  // map's image is relative to the folder of the link.
  const fs::path file(image.file);
  ImageDocument document;
  document.bitmap =
      (resolved(file.parent_path()) / file.filename()).lexically_proximate(resolved(folder)).generic_string();
  if (is_ros_map(image.file)) {
    document.height = size.z();
    if (image.unknown_is_solid) document.unknown = ImageDocument::Unknown::solid;
  } else {
    document.size = size;
    if (image.keeps_margins) document.margins = ImageDocument::Margins::keep;
  }
  document.boundary = image.boundary;
  return document;
}

std::vector<Solid> expand_solids(const std::optional<Eigen::Vector3d>& size,
                                 std::span<const BlockDocument> blocks, const Pose& pose_body_part) {
  std::vector<Solid> solids;
  if (size) {
    solids.push_back(box(*size));
    if (pose_body_part != Pose()) solids.back() = placed(std::move(solids.back()), pose_body_part);
  }
  for (Solid& solid : expand_blocks(blocks, pose_body_part)) solids.push_back(std::move(solid));
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

bool expand_shape(const PartDocument& document, const DocumentPath& at, ImageFolder& images, PartSpec& part) {
  const bool has_image = !document.image.bitmap.empty();
  bool is_given = has_image || document.fit;
  if (has_image) {
    if (const auto made = expand_image(document.image, document, at, images)) {
      part.size = made->size;
      part.image = made->spec;
      part.image->origin = document.origin.value_or(Pose());
      part.solids = image_solids(*made->image, part);
    }
  } else if (document.fit) {
    expand_fitted(document, part);
  } else {
    const std::span<const BlockDocument> blocks =
        document.blocks ? std::span<const BlockDocument>(*document.blocks) : std::span<const BlockDocument>();
    part.solids = expand_solids(document.image.size, blocks, part.pose_body_part);
    if (document.disc && document.disc->radius && document.disc->height) {
      part.solids.push_back(disc(*document.disc));
      if (part.pose_body_part != Pose())
        part.solids.back() = placed(std::move(part.solids.back()), part.pose_body_part);
    }
    is_given = document.blocks || !part.solids.empty();
    measure_part(part);
    // The size in the document is used, because the extent of the placed box has rounding errors.
    if (!document.blocks && !document.disc && document.image.size) part.size = *document.image.size;
  }
  part.floor_plan = document.floor_plan.value_or(has_image);
  return is_given;
}

Eigen::Vector3d contract_shape(const PartSpec& part, const std::filesystem::path* folder,
                               PartDocument& document) {
  const bool as_image = part.image && folder;
  PartSpec expanded = part;
  const auto set_origin = [&](const Pose& origin) {
    if (origin != Pose()) document.origin = origin;
  };
  if (as_image) {
    document.image = contract_image(*part.image, part.size, *folder);
    set_origin(part.image->origin);
  } else if (is_box(part)) {
    document.image.size = part.size;
  } else if (is_fitted(part)) {
    document.image.size = part.size;
    document.fit = true;
    set_origin(part.fitted->origin);
    document.blocks.emplace();
    for (const Solid& block : part.fitted->blocks)
      document.blocks->push_back(contract_block(block, BlockDocument::Frame::part));
  } else {
    const bool is_in_part_frame = part.pose_body_part == Pose();
    document.blocks.emplace();
    for (const Solid& solid : part.solids)
      document.blocks->push_back(
          contract_block(solid, is_in_part_frame ? BlockDocument::Frame::part : BlockDocument::Frame::body));
    expanded.size = PartSpec().size;
    measure_part(expanded);
  }
  if (part.floor_plan != as_image) document.floor_plan = part.floor_plan;
  return expanded.size;
}

void contract_extent(const PartSpec& part, const Eigen::Vector3d& size_expanded, PartDocument& document) {
  if (!same_size(part.size, size_expanded)) document.extent = part.size;
}

}  // namespace troupe::worldio
