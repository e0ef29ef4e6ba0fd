#include "sensors/blobfinder.hpp"

#include "engine/kinds/make_device_kind.hpp"
#include "engine/observing/frame.hpp"
#include "engine/observing/lint_view.hpp"
#include "engine/sensing/shown_color.hpp"
#include "engine/sensing/visibility_query.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <tuple>
#include <vector>

namespace troupe::sensors {
namespace {

using engine::CommittedView;
using engine::DeviceKind;
using engine::Element;
using engine::SenseBatch;

struct BlobFinder {
  struct Params {
    std::uint32_t image_width = 80;
    std::int32_t image_height = 60;
    double range = 12;
    double fov = radians(60);
    double pan = 0;
    std::vector<Color> colors;
    bool use_blob_return = true;
    std::uint32_t most_blobs = 16;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      using enum engine::Unit;
      constexpr double k_most_pixels = 10000;  // per edge
      d.member<&Params::image_width>("image_width", within(1, k_most_pixels),
                                     "number of columns of the image; one ray is cast for each");
      d.member<&Params::image_height>(
          "image_height", within(1, k_most_pixels),
          "number of rows of the image, to which `top` and `bottom` of a blob refer");
      d.member<&Params::range>("range", meters, above(0), at_most(10000), "length of the rays");
      d.member<&Params::fov>("fov", radians, above(0), at_most(2 * k_pi),
                             "angle between the first column and the last");
      d.member<&Params::pan>(
          "pan", radians, within(-2 * k_pi, 2 * k_pi),
          "angle from the sensor's heading to the middle of the image; positive: to the left");
      d.member<&Params::colors>("colors", "only blobs of these colours are reported; []: all blobs");
      d.member<&Params::use_blob_return>(
          "use_blob_return",
          "true: models whose blob_return is false are not reported, but hide what is behind them");
      d.member<&Params::most_blobs>(
          "most_blobs", within(1, 1000),
          "greatest number of blobs that the readings list, from right to left; `count` may be larger");
    }
  };

  static constexpr std::array reads{engine::k_shown_color};

  Params params;
  Pose pose_body_sensor;           // pan included
  std::vector<Rotation> bearings;  // of the rays, one per column, from right to left

  static DeviceKind::Prepared prepare(const Params& params, const Pose& pose_body_sensor);
  std::uint64_t sense(const SenseBatch& batch) const;

  static constexpr engine::FrameLayer layer = engine::FrameLayer::blobs;
  void draw(const engine::DeviceView& view, engine::Frame& frame) const;
  void lint(const engine::LintView& view) const;
};

struct Blob {
  Color color;
  std::size_t first = 0;  ///< index of its first ray; ray 0 is the rightmost
  std::size_t last = 0;   ///< index of its last ray
  double sum = 0;         ///< sum of the ranges of its rays, m
};

/// Computes the first and the last image row of a blob at this range (m). As in Stage, all bodies count as
/// 0.6 m tall, and a pixel covers a vertical angle of fov / image_height.
void write_rows(const BlobFinder::Params& params, double range, std::int32_t& top, std::int32_t& bottom) {
  constexpr double k_half_height = 0.3;  // m
  const std::int32_t height = params.image_height;
  const double pixel = params.fov / height;
  const double half = std::min(atan2(k_half_height, range) / pixel, static_cast<double>(height));
  top = std::max(0, height / 2 - static_cast<int>(half));
  bottom = std::min(height, height / 2 + static_cast<int>(half));
}

class Writer {
 public:
  Writer(const BlobFinder::Params& params, engine::StateTable& state, std::size_t slot)
      : params_(params), state_(state), slot_(slot) {}

  void add(const Blob& blob) {
    const auto& colors = params_.colors;
    if (!colors.empty() &&
        std::ranges::none_of(colors, [&](const Color& c) { return is_same_color(c, blob.color); }))
      return;
    if (const std::size_t i = count_++; i < params_.most_blobs) set(i, blob);
  }
  void finish() {
    state_.cell<std::uint32_t>(slot_, k_blob_count)[0] = static_cast<std::uint32_t>(count_);
    for (std::size_t i = count_; i < params_.most_blobs; ++i) {
      for (const std::size_t field : {k_blob_left, k_blob_right, k_blob_top, k_blob_bottom})
        state_.cell<std::int32_t>(slot_, field)[i] = 0;
      state_.cell<float>(slot_, k_blob_range)[i] = 0;
      for (std::uint8_t& part : state_.cell<std::uint8_t>(slot_, k_blob_color).subspan(4 * i, 4)) part = 0;
    }
  }

 private:
  void set(std::size_t i, const Blob& blob) {
    const auto cell = [&](std::size_t field) -> std::int32_t& {
      return state_.cell<std::int32_t>(slot_, field)[i];
    };
    const double range = blob.sum / static_cast<double>(blob.last - blob.first + 1);
    // Columns are counted from the left.
    cell(k_blob_left) = static_cast<std::int32_t>(params_.image_width - 1 - blob.last);
    cell(k_blob_right) = static_cast<std::int32_t>(params_.image_width - 1 - blob.first);
    write_rows(params_, range, cell(k_blob_top), cell(k_blob_bottom));
    state_.cell<float>(slot_, k_blob_range)[i] = static_cast<float>(range);
    const auto parts = state_.cell<std::uint8_t>(slot_, k_blob_color).subspan(4 * i, 4);
    const std::array<float, 4> from{blob.color.r, blob.color.g, blob.color.b, blob.color.a};
    for (std::size_t k = 0; k < from.size(); ++k) parts[k] = to_byte(from[k]);
  }

  const BlobFinder::Params& params_;
  engine::StateTable& state_;
  std::size_t slot_;
  std::size_t count_ = 0;
};

/// The rays of an image. Each thread keeps one object, so that only the first images allocate memory.
struct Rays {
  engine::VisibilityQuery query;
  std::vector<engine::SightLine> lines;  // per column, from right to left
  std::vector<engine::RayHit> first;     // per line: the first surface along it
};

/// Finds the blobs that the finder on the body with the row (index in the state tables) `own` sees, and
/// passes them to the writer. body: the transform from the frame in which the finder's pose is given to the
/// world frame.
void find_blobs(const CommittedView& view, const BlobFinder& finder, Row own, const Transform& body,
                Rays& rays, Writer& writer) {
  rays.lines.clear();
  for (const Rotation& bearing : finder.bearings)
    rays.lines.push_back({body.rotation * (bearing * Vec2::UnitX()), finder.params.range});
  rays.first.resize(std::max(rays.first.size(), rays.lines.size()));
  rays.query.first_met(view, body * finder.pose_body_sensor.position(), own, std::nullopt, rays.lines,
                       std::span(rays.first).first(rays.lines.size()));
  std::optional<Blob> blob;
  for (std::size_t ray = 0; ray < finder.params.image_width; ++ray) {
    const engine::RayHit& first = rays.first[ray];
    const bool is_seen =
        first.met() && (!finder.params.use_blob_return || engine::part_of(view, first).returns.blob);
    const Color color = is_seen ? color_of(view, first) : Color();
    const bool goes_on = blob && is_seen && is_same_color(color, blob->color);
    if (blob && !goes_on) {
      writer.add(*blob);
      blob.reset();
    }
    if (!is_seen) continue;
    if (!goes_on) blob = Blob{color, ray, ray, 0};
    blob->last = ray;
    blob->sum += first.range_m;
  }
  if (blob) writer.add(*blob);
}

DeviceKind::Prepared BlobFinder::prepare(const Params& params, const Pose& pose_body_sensor) {
  BlobFinder finder{.params = params, .pose_body_sensor = compose(pose_body_sensor, {0, 0, 0, params.pan})};
  for (std::uint32_t i = 0; i < params.image_width; ++i) {
    const double across = params.image_width == 1 ? 0.5 : i / (params.image_width - 1.0);
    finder.bearings.emplace_back(finder.pose_body_sensor.heading + (across - 0.5) * params.fov);
  }
  const std::uint32_t n = params.most_blobs;
  return {.data = std::move(finder),
          .percepts = {{"count", Element::u32, 1, "",
                        "number of blobs whose colour is in `colors` (empty: of all blobs)"},
                       {"left", Element::i32, n, "", "leftmost column of each blob"},
                       {"right", Element::i32, n, "", "rightmost column of each blob"},
                       {"top", Element::i32, n, "", "top row of each blob"},
                       {"bottom", Element::i32, n, "", "bottom row of each blob"},
                       {"range", Element::f32, n, "m", "mean distance of each blob"},
                       {"color", Element::u8, 4 * n, "", "colour of each blob: red, green, blue, opacity"}},
          .reach_m = pose_body_sensor.position().norm() + params.range,
          .watts = 2};  // as in Stage
}

std::uint64_t BlobFinder::sense(const SenseBatch& batch) const {
  thread_local const auto rays = std::make_unique<Rays>();
  for (std::size_t i = 0; i < batch.rows.size(); ++i) {
    Writer writer(params, batch.state, batch.slot(i));
    find_blobs(batch.committed, *this, batch.rows[i], batch.mount(i).transform, *rays, writer);
    writer.finish();
  }
  return batch.rows.size() * params.image_width;
}

void BlobFinder::draw(const engine::DeviceView& view, engine::Frame& frame) const {
  const double columns = params.image_width;
  const std::span<const std::int32_t> left = view.state.cell<std::int32_t>(view.slot, k_blob_left);
  const std::span<const std::int32_t> right = view.state.cell<std::int32_t>(view.slot, k_blob_right);
  const std::span<const float> ranges = view.state.cell<float>(view.slot, k_blob_range);
  const std::span<const std::uint8_t> colors = view.state.cell<std::uint8_t>(view.slot, k_blob_color);
  const std::size_t count =
      std::min<std::size_t>(view.state.cell<std::uint32_t>(view.slot, k_blob_count)[0], ranges.size());
  // Columns count from the left of the image. Each is drawn with the width fov / columns, so that all of them
  // fill the field of view; the ray of a column is within this width.
  const auto end = [&](double column, double range) {
    const double bearing = columns > 1 ? params.fov * (0.5 - column / columns) : 0;
    const Vec2 way = Rotation(params.pan + bearing) * Vec2(range, 0);
    return view.at(way.x(), way.y(), 0);
  };
  for (std::size_t k = 0; k < count; ++k) {
    const auto part = [&](std::size_t i) { return static_cast<float>(colors[4 * k + i]) / 255; };
    frame.blobs.push_back({view.body,
                           view.at(0, 0, 0),
                           end(right[k] + 1.0, ranges[k]),
                           end(left[k], ranges[k]),
                           {part(0), part(1), part(2), 1}});
  }
}

/// The colours that bodies have in the world file.
struct ShownColors {
  struct IsLess {
    bool operator()(const Color& a, const Color& b) const {
      return std::tie(a.r, a.g, a.b) < std::tie(b.r, b.g, b.b);
    }
  };
  std::set<Color, IsLess> colors;
  bool may_change = false;  // LEDs and similar devices may show any colour

  explicit ShownColors(const engine::LintWorld& world) {
    for (const engine::BodySpec& body : world.spec.bodies) {
      for (const engine::PartSpec& part : world.spec.types[body.type.index()].parts)
        if (!part.solids.empty()) colors.insert(part.color.value_or(body.color));
      for (const engine::BodyType::Device& device : world.types[body.type.index()].devices)
        may_change = may_change || device.kind->shows_color;
    }
  }
};

/// Warns if the finder looks for colours that no body has.
void BlobFinder::lint(const engine::LintView& view) const {
  const ShownColors& shown = view.world.shared<ShownColors>();
  if (params.colors.empty() || shown.may_change || view.is_set({"colors"})) return;
  const auto is_sought = [&](const Color& color) {
    return std::ranges::any_of(params.colors, [&](const Color& one) { return is_same_color(one, color); });
  };
  if (std::ranges::none_of(shown.colors, is_sought))
    view.warn(engine::LintTopic::color,
              engine::sees_nothing_text(view.device_spec().name, view.type_spec().name) +
                  "no body has one of the colours in its \"colors\"");
}

}  // namespace

bool is_same_color(const Color& a, const Color& b) {
  constexpr float k_near = 1e-5f;  // as in Stage; opacity is ignored
  return std::abs(a.r - b.r) < k_near && std::abs(a.g - b.g) < k_near && std::abs(a.b - b.b) < k_near;
}

DeviceKind blobfinder_kind() {
  return engine::make_device_kind<BlobFinder>(
      "blobfinder", "reports blobs: runs of neighbouring image columns that show the same colour");
}

}  // namespace troupe::sensors
