#include "models/controllers/rasterize.hpp"

#include "engine/kinds/mount.hpp"
#include "engine/spec/world_spec.hpp"
#include "partition/placed_shape.hpp"

#include <utility>
#include <vector>

namespace troupe::models {
namespace {

using engine::DeviceInfo;
using engine::PartSpec;
using engine::TypeSpec;
using engine::WorldSpec;

struct Rasterize {
  using Memory = RasterizeMemory;
  static constexpr bool needs_drive = false;
  Memory raster;

  std::vector<std::size_t> choose(std::span<const DeviceInfo>, std::vector<bool>&) { return {}; }

  Result<> bind_world(const WorldSpec&, const TypeSpec& type, std::uint32_t p) {
    const std::vector<Ring> outlines = outlines_of(type.parts[p]);
    Box box;
    for (const Ring& ring : outlines) box.extend(bounds(ring));
    if (box.empty()) return {};
    const Vec2 cell = box.size().cwiseQuotient(Vec2(k_raster_columns, k_raster_rows));
    for (std::uint32_t i = 0; i < raster.cells.size(); ++i) {
      const Vec2 low = box.min + cell.cwiseProduct(Vec2(i % k_raster_columns, i / k_raster_columns));
      raster.cells[i] = is_crossed(outlines, low, low + cell);
    }
    return {};
  }
  void operator()(Memory& memory, const engine::Percept&, Random&, engine::Actions&) const {
    memory = raster;
  }

 private:
  /// The outlines of the solids of a part, m, in the frame of the part.
  static std::vector<Ring> outlines_of(const PartSpec& part) {
    const Transform part_body = inverse(engine::Mount(part.pose_body_part)).transform;
    std::vector<Ring> outlines;
    for (const Solid& solid : part.solids)
      for (Ring ring : solid.contours) {
        for (Vec2& vertex : ring) vertex = part_body * vertex;
        outlines.push_back(std::move(ring));
      }
    return outlines;
  }
  /// Whether an outline touches the cell with the corners `low` and `high` (m, frame of the part), including
  /// the border of the cell.
  static bool is_crossed(const std::vector<Ring>& outlines, const Vec2& low, const Vec2& high) {
    const Vec2 margin = 1e-6 * (high - low);
    const Vec2 a = low - margin, b = high + margin;
    const std::array<Vec2, 4> square{a, Vec2(b.x(), a.y()), b, Vec2(a.x(), b.y())};
    for (const Ring& ring : outlines)
      for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++)
        if (partition::segment_overlap(ring[j], ring[i], square)) return true;
    return false;
  }
};

}  // namespace

engine::ControllerKind rasterize_controller() {
  return engine::make_controller_kind<Rasterize>(
      "rasterize", "store a raster image of the model's outlines in the controller's memory");
}

}  // namespace troupe::models
