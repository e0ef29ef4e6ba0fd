#include "sensors/ranger_exact.hpp"

#include "partition/ranging.hpp"
#include "partition/surroundings.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

namespace troupe::sensors {
namespace {

using partition::Surroundings;

/// Casts the beams of rangers. A thread keeps one, so that a warm step allocates nothing.
class Caster {
 public:
  void cast(const engine::World& world, const RangerBeams& ranger, std::span<const Row> rows,
            engine::StateTable& percepts) {
    world_ = &world;
    ranger_ = &ranger;
    slack_spread_ = static_cast<float>(ranger.spread * (1 + partition::k_range_slack));
    std::size_t most = 0;
    for (const BeamGroup& group : ranger.groups) most = std::max(most, partition::padded_beams(group.count));
    for (std::vector<float>* array : {&dx_, &dy_, &ox_, &oy_, &range_max_, &limits_, &inverse_, &returns_})
      array->resize(std::max(array->size(), most));
    if (ranger.common_origin)
      for (std::vector<float>* array : {&ox_, &oy_}) std::ranges::fill(*array, 0.0f);
    // Culls may keep too much but never too little: their margins are above what rounding can take away.
    surroundings_.begin(world.index(), world.scene().outlines(), world.geometry(),
                        ranger.reach * (1 + partition::k_range_slack) + 1e-6);
    for (const Row row : rows) {
      const std::size_t slot = world.slot(row);
      for (const BeamGroup& group : ranger.groups) {
        cast(group, row);
        const auto ranges = percepts.cell<float>(slot, 0).subspan(group.first, group.count);
        partition::ranges_of(fan_, inverse_.data(), range_max_.data(), ranges.data());
        if (!ranger.intensity) continue;
        const auto intensities = percepts.cell<float>(slot, 1).subspan(group.first, group.count);
        for (std::size_t i = 0; i < group.count; ++i)
          intensities[i] = inverse_[i] > 1.0f / range_max_[i] ? returns_[i] : 0;
      }
    }
  }

 private:
  /// Looks from near to far, and no farther than some beam still goes: in a crowd, what is near soon hides
  /// everything else.
  void cast(const BeamGroup& group, Row row) {
    self_ = row;
    z_ = world_->poses()[row.index()].z + group.z;
    aim(group, world_->transform(row));
    surroundings_.look_from(reference_);
    limit();
    const Surroundings::Band first = surroundings_.band(0);
    const auto at_hand = std::min(farthest_, static_cast<float>(surroundings_.at_hand()));
    look(first, -std::numeric_limits<float>::infinity(), at_hand);
    if (at_hand < farthest_) look(first, at_hand, farthest_);
    for (std::size_t band = 1; band < surroundings_.bands(); ++band) {
      if (farthest_ <= surroundings_.radius(band - 1)) break;
      look(surroundings_.band(band), -std::numeric_limits<float>::infinity(), farthest_);
    }
  }

  /// Turns the group's beams into the world's frame; nothing is met yet.
  void aim(const BeamGroup& group, const Transform& pose) {
    reference_ = pose * ranger_->reference;
    partition::turn(pose.rotation, &ranger_->dx[group.first], &ranger_->dy[group.first], group.count,
                    dx_.data(), dy_.data());
    if (!ranger_->common_origin)
      partition::turn(pose.rotation, &ranger_->ox[group.first], &ranger_->oy[group.first], group.count,
                      ox_.data(), oy_.data());
    const std::size_t padded = partition::padded_beams(group.count);
    const auto range_max = ranger_->range_max.begin() + static_cast<std::ptrdiff_t>(group.first);
    std::copy_n(range_max, group.count, range_max_.begin());
    for (std::vector<float>* array : {&dx_, &dy_, &ox_, &oy_, &range_max_})
      std::fill(array->begin() + static_cast<std::ptrdiff_t>(group.count),
                array->begin() + static_cast<std::ptrdiff_t>(padded), (*array)[group.count - 1]);
    std::fill_n(inverse_.begin(), padded, 0.0f);
    if (ranger_->intensity) std::fill_n(returns_.begin(), padded, 0.0f);
    fan_ = {dx_.data(),    dy_.data(), ox_.data(), oy_.data(), group.count, ranger_->common_origin,
            group.mirrored};
    is_scan_ = group.scan;
    if (group.scan)
      scan_ = {pose.rotation * group.middle, static_cast<float>(group.fov), static_cast<float>(group.step)};
  }

  /// How far from the reference anything may be for a beam still to meet it.
  void limit() {
    farthest_ =
        partition::limits_of(fan_, inverse_.data(), range_max_.data(), limits_.data()) + slack_spread_;
  }

  /// Projects what lies from low to high away and may be met.
  void look(Surroundings::Band band, float low, float high) {
    const auto& circles = surroundings_.circles();
    const std::size_t count = is_scan_ ? partition::may_meet(circles, band.begin, band.end, reference_, fan_,
                                                             scan_, limits_.data(), low, high, met_)
                                       : partition::may_meet(circles, band.begin, band.end, reference_, fan_,
                                                             limits_.data(), low, high, met_);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t row = met_.row[i];
      if (row >= Surroundings::k_fixed)
        add_fixed(row - Surroundings::k_fixed);
      else if (row != self_.value)
        add_body(Row(row));
    }
    if (edges_.count() == 0) return;
    project();
    limit();
  }

  void add_fixed(std::uint32_t piece) {
    const partition::FixedOutlines& outlines = world_->scene().outlines();
    const partition::FixedSolid& solid = world_->scene().solids()[outlines.solid(piece)];
    if (!solid.solid.z.contains(z_)) return;
    if (edges_.room() < partition::FixedOutlines::k_most_edges) project();
    const auto edges = outlines.edges(piece);
    edges_.add(edges.front().a.data(), edges.size(), solid.ranger_return);
  }

  void add_body(Row body) {
    const std::span<const Vec2> vertices = world_->outline(body);
    const double base = world_->poses()[body.index()].z;
    for (const engine::RayOutline& outline : world_->type(body).outlines) {
      if (!outline.z.shifted(base).contains(z_)) continue;
      const Vec2* before = &vertices[outline.first + outline.count - 1];
      for (const Vec2& vertex : vertices.subspan(outline.first, outline.count)) {
        if (edges_.room() == 0) project();
        edges_.add(*before, vertex, outline.ranger_return);
        before = &vertex;
      }
    }
  }

  void project() {
    float* returns = ranger_->intensity ? returns_.data() : nullptr;
    if (is_scan_)
      partition::project(edges_, reference_, fan_, scan_, inverse_.data(), returns);
    else
      partition::project(edges_, reference_, fan_, inverse_.data(), returns);
    edges_.clear();
  }

  const engine::World* world_ = nullptr;
  const RangerBeams* ranger_ = nullptr;
  float slack_spread_ = 0;
  Surroundings surroundings_;

  Row self_;
  double z_ = 0;
  Vec2 reference_ = Vec2::Zero();  // world frame
  partition::Fan fan_;
  partition::Scan scan_;
  bool is_scan_ = false;
  float farthest_ = 0;
  std::vector<float> dx_, dy_, ox_, oy_, range_max_, limits_, inverse_, returns_;  // a beam each, padded
  partition::CircleArrays met_;
  partition::EdgeBlock edges_;
};

}  // namespace

void cast_exact(const engine::World& world, const RangerBeams& ranger, std::span<const Row> rows,
                engine::StateTable& percepts) {
  thread_local const auto caster = std::make_unique<Caster>();
  caster->cast(world, ranger, rows, percepts);
}

}  // namespace troupe::sensors
