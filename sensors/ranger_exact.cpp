#include "sensors/ranger_exact.hpp"

#include "engine/sensing/sensing_view.hpp"
#include "partition/nearby_outlines.hpp"
#include "partition/ranging.hpp"
#include "sensors/ranger_noise.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

namespace troupe::sensors {
namespace {

using partition::NearbyOutlines;

/// Casts the beams of rangers. Each thread keeps one object of this class, which keeps its buffers, so that
/// only the first casts allocate memory.
class Caster {
 public:
  void cast(const engine::DeviceBatch& batch, const RangerBeams& ranger) {
    const engine::SensingView& view = batch.view;
    view_ = &view;
    if (view.index().version() != version_) prepare(view);
    joint_ = view.type(batch.rows.front()).devices[batch.device].joint;
    ranger_ = &ranger;
    slack_spread_ = static_cast<float>(ranger.spread * (1 + partition::k_range_slack));
    std::size_t most = 0;
    for (const BeamGroup& group : ranger.groups) most = std::max(most, partition::padded_beams(group.count));
    for (std::vector<float>* array : {&dx_, &dy_, &ox_, &oy_, &limits_, &inverse_, &returns_})
      array->resize(std::max(array->size(), most));
    if (ranger.common_origin)
      for (std::vector<float>* array : {&ox_, &oy_}) std::ranges::fill(*array, 0.0f);
    // The search may find too many circles but never too few: its margins are above the rounding errors.
    nearby_.begin(view.index(), *outlines_, ranger.reach * (1 + partition::k_range_slack) + 1e-6);
    for (std::size_t r = 0; r < batch.rows.size(); ++r) {
      const Row row = batch.rows[r];
      const std::size_t slot = view.slot(row);
      if (ranger.has_angular_noise) random_ = random_of_headings(batch, r);
      for (const BeamGroup& group : ranger.groups) {
        cast(group, row);
        const auto ranges = batch.state.cell<float>(slot, 0).subspan(group.first, group.count);
        partition::ranges_of(fan_, inverse_.data(), group.range_max.data(), ranges.data());
        if (!ranger.intensity) continue;
        const auto intensities = batch.state.cell<float>(slot, 1).subspan(group.first, group.count);
        for (std::size_t i = 0; i < group.count; ++i)
          intensities[i] = inverse_[i] > 1.0f / group.range_max[i] ? returns_[i] : 0;
      }
    }
  }

 private:
  /// Prepares for a world and a tick, whose spatial index tells them from all others. There can be as many
  /// batches in a tick as robots, and as many types, so that no batch may look at all types.
  void prepare(const engine::SensingView& view) {
    version_ = view.index().version();
    linked_ = std::ranges::any_of(view.types(), [](const auto& type) { return type.is_composite(); });
    layer_type_ = nullptr;
    for (const engine::BodyType& type : view.types()) layer_.reserve(type.outlines.size());
    outlines_ = &view.scene().outlines();
    solids_ = view.scene().solids().data();
  }

  /// Casts the beams of a group for one row. Searches from near to far, up to the limit of the longest beam.
  /// In a crowd, near bodies soon shorten all beams, so that the search ends early.
  void cast(const BeamGroup& group, Row row) {
    self_ = row;
    if (joint_ == engine::k_rigid) {
      z_ = view_->poses()[row.index()].z + group.z;
      aim(group, view_->transform(row));
    } else {
      const engine::Mount mount = view_->mount(row, joint_);
      z_ = mount.z + group.z;
      aim(group, mount.transform);
    }
    nearby_.set_block_of(reference_);
    const NearbyOutlines::Band first = nearby_.band(0);
    const auto nearest_shell = std::min(farthest_, static_cast<float>(nearby_.nearest_shell_m()));
    search(first, -std::numeric_limits<float>::infinity(), nearest_shell);
    if (nearest_shell < farthest_) search(first, nearest_shell, farthest_);
    for (std::size_t band = 1; band < nearby_.bands(); ++band) {
      if (farthest_ <= nearby_.radius(band - 1)) break;
      search(nearby_.band(band), static_cast<float>(nearby_.radius(band - 1)), farthest_);
    }
  }

  /// Rotates the group's beams into the world frame and resets their inverse ranges and limits. pose: the
  /// pose, in the world frame, of the frame in which the beams are given.
  void aim(const BeamGroup& group, const Transform& pose) {
    reference_ = pose * ranger_->reference;
    const auto [dx, dy] = group.angular_noise.empty() ? std::pair(group.dx.data(), group.dy.data())
                                                      : noisy_headings_.draw(group, random_);
    partition::turn(pose.rotation, dx, dy, group.count, dx_.data(), dy_.data());
    if (!ranger_->common_origin)
      partition::turn(pose.rotation, group.ox.data(), group.oy.data(), group.count, ox_.data(), oy_.data());
    const std::size_t padded = partition::padded_beams(group.count);
    std::fill_n(inverse_.begin(), padded, 0.0f);
    if (ranger_->intensity) std::fill_n(returns_.begin(), padded, 0.0f);
    range_max_ = group.range_max.data();
    limits_now_ = group.limits.data();
    farthest_ = group.farthest + slack_spread_;
    if (group.scan)
      scan_ = {pose.rotation * group.middle, static_cast<float>(group.fov), static_cast<float>(group.step)};
    fan_ = {dx_.data(),     dy_.data(),
            ox_.data(),     oy_.data(),
            group.count,    ranger_->common_origin,
            group.mirrored, group.scan ? &scan_ : nullptr};
  }

  /// Updates limits_now_, the distance up to which each beam may still hit a surface, and farthest_, the
  /// distance from the reference up to which any beam may still hit one.
  void limit() {
    farthest_ = partition::limits_of(fan_, inverse_.data(), range_max_, limits_.data()) + slack_spread_;
    limits_now_ = limits_.data();
  }

  /// Projects on the beams those outlines of a band that a beam may hit and whose nearest point may be from
  /// low to high (m) away from the reference.
  void search(NearbyOutlines::Band band, float low, float high) {
    if (linked_)
      search_outlines<true>(band, low, high);
    else
      search_outlines<false>(band, low, high);
  }

  /// k_linked: whether some bodies of the world have joints or may carry others. Otherwise the heights of
  /// joints and the carriers of bodies need not be looked up.
  template <bool k_linked>
  void search_outlines(NearbyOutlines::Band band, float low, float high) {
    const auto& circles = nearby_.circles();
    const std::size_t count =
        partition::may_meet(circles, band.begin, band.end, reference_, fan_, limits_now_, low, high, met_);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t row = met_.row[i];
      if (row >= NearbyOutlines::k_fixed)
        add_fixed(row - NearbyOutlines::k_fixed, met_.beams[i]);
      else if (row != self_.value && !(k_linked && view_->same_tree(Row(row), self_)))
        add_body<k_linked>(Row(row), met_.beams[i]);
    }
    if (edges_.empty()) return;
    project();
    limit();
  }

  void add_fixed(std::uint32_t piece, partition::BeamSet met_by) {
    const partition::FixedSolid& solid = solids_[outlines_->solid(piece)];
    if (!solid.solid.z.contains(z_)) return;
    const std::span<const Vec2> chain = outlines_->chain(piece);
    add_chain(chain.front(), chain.subspan(1), solid.ranger_return, met_by);
  }

  template <bool k_linked>
  void add_body(Row body, partition::BeamSet met_by) {
    const Vec2* vertices = view_->outline(body).data();
    const double base = view_->poses()[body.index()].z;
    const engine::BodyType& type = view_->type(body);
    const auto add = [&](const engine::RayOutline& outline) {
      const std::span<const Vec2> ring(vertices + outline.first, outline.count);
      add_chain(ring.back(), ring, outline.ranger_return, met_by);
    };
    if (!k_linked && type.outlines.size() > 1) {
      if (&type != layer_type_ || base != layer_base_ || z_ != layer_z_) find_layer(type, base);
      for (const engine::RayOutline* outline : layer_) add(*outline);
      return;
    }
    for (const engine::RayOutline& outline : type.outlines) {
      const double height = k_linked ? base + view_->lift(body, outline.joint) : base;
      if (outline.z.shifted(height).contains(z_)) add(outline);
    }
  }

  void find_layer(const engine::BodyType& type, double base) {
    layer_.clear();
    for (const engine::RayOutline& outline : type.outlines)
      if (outline.z.shifted(base).contains(z_)) layer_.push_back(&outline);
    layer_type_ = &type;
    layer_base_ = base;
    layer_z_ = z_;
  }

  /// Adds the edges from `first` to rest[0], to rest[1] and so on. Projects the buffered edges first if there
  /// is no room for more.
  void add_chain(const Vec2& first, std::span<const Vec2> rest, float ranger_return,
                 partition::BeamSet met_by) {
    if (edges_.room() < rest.size()) [[unlikely]]
      return add_in_parts(first, rest, ranger_return, met_by);
    edges_.add(first, rest.data(), rest.size(), ranger_return, met_by);
  }
  void add_in_parts(const Vec2& first, std::span<const Vec2> rest, float ranger_return,
                    partition::BeamSet met_by) {
    const Vec2* before = &first;
    while (!rest.empty()) {
      project();
      const std::span<const Vec2> part = rest.first(std::min(rest.size(), edges_.room()));
      edges_.add(*before, part.data(), part.size(), ranger_return, met_by);
      before = &part.back();
      rest = rest.subspan(part.size());
    }
  }

  void project() {
    partition::project(edges_, reference_, fan_, inverse_.data(),
                       ranger_->intensity ? returns_.data() : nullptr);
    edges_.clear();
  }

  std::uint64_t version_ = 0;  // of the spatial index for which prepare() was called
  const engine::SensingView* view_ = nullptr;
  const RangerBeams* ranger_ = nullptr;
  const partition::FixedOutlines* outlines_ = nullptr;
  const partition::FixedSolid* solids_ = nullptr;
  float slack_spread_ = 0;
  NearbyOutlines nearby_;

  NoisyHeadings noisy_headings_;
  Random random_{0, 0, 0, 0};
  Row self_;
  std::int32_t joint_ = engine::k_rigid;
  bool linked_ = false;
  double z_ = 0;
  Vec2 reference_ = Vec2::Zero();  // world frame
  partition::Fan fan_;
  partition::Scan scan_;
  float farthest_ = 0;
  const float* range_max_ = nullptr;
  const float* limits_now_ = nullptr;  // current limits of the beams: those of the group, then limits_
  std::vector<float> dx_, dy_, ox_, oy_, limits_, inverse_, returns_;  // per beam, padded
  // A cache for the last type that was looked up: layer_ lists the outlines of layer_type_ that are at the
  // height layer_z_ of the beams if the body is at the height layer_base_. Most bodies with many outlines
  // have the same type and z.
  std::vector<const engine::RayOutline*> layer_;
  const engine::BodyType* layer_type_ = nullptr;
  double layer_base_ = 0;
  double layer_z_ = 0;
  partition::MetCircles met_;
  partition::EdgeBlock edges_;
};

}  // namespace

void cast_exact(const engine::DeviceBatch& batch, const RangerBeams& ranger) {
  thread_local const auto caster = std::make_unique<Caster>();
  caster->cast(batch, ranger);
}

}  // namespace troupe::sensors
