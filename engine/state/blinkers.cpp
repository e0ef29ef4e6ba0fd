#include "engine/state/blinkers.hpp"

#include "engine/kinds/step_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

namespace troupe::engine {

Blinkers::Blinkers(WorldState& state)
    : state_(state),
      transforms_(state.transforms),
      outlines_(state.outlines),
      radii_(state.radii),
      shapes_(state.shapes),
      joint_mounts_(state.joint_mounts),
      roots_(state.roots),
      tables_(state.tables),
      index_(state.geometry) {}

/// Returns for each state table 1 if a kind of device may read the rows of other bodies in the table,
/// otherwise 0. Every kind may read the tables from which the places of bodies follow (`pose`, `carrier`,
/// `life` and those of joints), and the tables of the data that it declares (DeviceKind::reads).
std::vector<std::uint8_t> Blinkers::tables_read_by(const DeviceKind& kind) const {
  std::vector<std::uint8_t> reads(state_.tables.size(), 0);
  const auto declares = [&](std::string_view name) {
    return std::ranges::find(kind.reads, name) != kind.reads.end();
  };
  reads[WorldState::k_pose] = 1;
  for (const auto& table : {state_.carrier_table, state_.life_table})
    if (table) reads[*table] = 1;
  const bool runs = declares(k_runs_of_others);
  reads[WorldState::k_velocity] = declares(k_velocity_of_others);
  reads[WorldState::k_command] = runs || declares(k_command_of_others);
  if (state_.condition_table) reads[*state_.condition_table] = runs;
  for (std::size_t t = 0; t < state_.types.size(); ++t) {
    if (std::ranges::find(state_.row_types, t) == state_.row_types.end())
      continue;  // a type without rows has no tables
    for (const BodyType::Joint& joint : state_.types[t].joints) reads[joint.table] = 1;
    for (const BodyType::Device& device : state_.types[t].devices) {
      const std::span<const StateField> fields = state_.tables[device.table].fields();
      reads[device.table] = declares(device.kind->name) || (runs && device.kind->is_spent != nullptr) ||
                            (!fields.empty() && declares(fields.front().name));
      if (device.command_table)
        reads[*device.command_table] =
            declares(std::string(device.kind->name) + "/command") || (runs && device.kind->drives);
    }
  }
  return reads;
}

void Blinkers::hide_from(Row row, const DeviceKind& kind, double reach) {
  const auto [reads, is_new] = reads_.try_emplace(&kind);
  if (is_new) reads->second = tables_read_by(kind);
  constexpr double k_slack_m = 1e-6;  // margin for the rounding of a distance and a radius
  const Vec2 origin = state_.view.transform(row).position;
  hidden_.clear();
  for (std::size_t r = 0; r < state_.row_count(); ++r) {
    const Row other(r);
    if (!state_.view.is_there(other)) {
      hidden_.push_back(other);
      continue;
    }
    if (state_.view.same_tree(other, row)) continue;
    if ((state_.view.transform(other).position - origin).norm() - state_.radii[r] > reach + k_slack_m)
      hidden_.push_back(other);
  }
  for (const Row other : hidden_) {
    const std::size_t r = other.index();
    transforms_[r] =
        std::exchange(state_.transforms[r], Transform({k_nan, k_nan}, Rotation(SinCos{k_nan, k_nan})));
    radii_[r] = std::exchange(state_.radii[r], partition::k_not_there);
    shapes_[r] = std::exchange(state_.shapes[r], &k_no_shape);
    for (std::size_t v = state_.outline_begins[r];
         v < state_.outline_begins[r] + state_.type(other).outline_vertices.size(); ++v)
      outlines_[v] = std::exchange(state_.outlines[v], Vec2(k_nan, k_nan));
    for_joints_of(other, [&](std::size_t j) {
      joint_mounts_[j] =
          std::exchange(state_.joint_mounts[j],
                        Mount(Transform({k_nan, k_nan}, Rotation(SinCos{k_nan, k_nan})), k_nan, k_nan));
    });
    if (!state_.roots.empty())
      roots_[r] = std::exchange(state_.roots[r], std::numeric_limits<std::uint32_t>::max());
    state_.for_tables_of(other, [&](std::size_t t, std::size_t at) {
      tables_[t].copy_row(at, state_.tables[t]);
      state_.tables[t].fill_row(at, std::byte{0xff});  // a floating-point field is then NaN
    });
  }
  for_other_tables(row, reads->second, [&](std::size_t t, std::size_t at) {
    tables_[t].copy_row(at, state_.tables[t]);
    state_.tables[t].fill_row(at, std::byte{0xff});
  });
  std::swap(state_.index, index_);
  state_.index.rebuild(state_.transforms, state_.radii, serial_);
}

/// Calls visit(j) for each index j into WorldState::joint_mounts of a joint of the row's body.
template <class Visit>
void Blinkers::for_joints_of(Row row, Visit&& visit) const {
  if (state_.joint_begins.empty()) return;
  const std::size_t begin = state_.joint_begins[row.index()];
  for (std::size_t j = begin; j < begin + state_.type(row).joints.size(); ++j) visit(j);
}

/// Calls visit(t, i) for row i of table t if the table is not to be read (reads[t] == 0) and the row belongs
/// to a body that is not hidden and is not the body of `row`.
template <class Visit>
void Blinkers::for_other_tables(Row row, std::span<const std::uint8_t> reads, Visit&& visit) {
  std::size_t hidden = 0;  // index of the next hidden row in hidden_, which is in ascending order
  for (std::size_t r = 0; r < state_.row_count(); ++r) {
    const std::vector<Row>& all = hidden_;
    if (hidden < all.size() && all[hidden].index() == r) {
      ++hidden;
      continue;
    }
    if (r == row.index()) continue;
    state_.for_tables_of(Row(r), [&](std::size_t t, std::size_t at) {
      if (reads[t] == 0) visit(t, at);
    });
  }
}

void Blinkers::show_hidden(Row row, const DeviceKind& kind) {
  std::swap(state_.index, index_);
  for_other_tables(row, reads_[&kind],
                   [&](std::size_t t, std::size_t at) { state_.tables[t].copy_row(at, tables_[t]); });
  for (const Row other : hidden_) {
    const std::size_t r = other.index();
    state_.transforms[r] = transforms_[r];
    state_.radii[r] = radii_[r];
    state_.shapes[r] = shapes_[r];
    for (std::size_t v = state_.outline_begins[r];
         v < state_.outline_begins[r] + state_.type(other).outline_vertices.size(); ++v)
      state_.outlines[v] = outlines_[v];
    for_joints_of(other, [&](std::size_t j) { state_.joint_mounts[j] = joint_mounts_[j]; });
    if (!state_.roots.empty()) state_.roots[r] = roots_[r];
    state_.for_tables_of(other,
                         [&](std::size_t t, std::size_t at) { state_.tables[t].copy_row(at, tables_[t]); });
  }
}

void Blinkers::check_targets(const BodyType::Device& device, std::span<const Effect> emitted) const {
  if (device.kind->scope != ApplyScope::trees) return;
  for (const Effect& effect : emitted) {
    if (!effect.target.valid() || effect.target.index() >= state_.rows.size()) continue;
    const Row target = state_.view.row(effect.target);
    if (!target.valid() || !std::ranges::binary_search(hidden_, target)) continue;
    throw StepError(fmt::format(
        "tick {}: device \"{}\" ({}) of \"{}\" requested an effect on \"{}\", which is {}", state_.now.tick,
        device.name, device.kind->name, state_.spec.name(effect.source), state_.spec.name(effect.target),
        state_.view.is_there(target)
            ? "farther away than the kind of the device declares: declare a larger reach "
              "(DeviceKind::Prepared::reach_m) or a wider scope (DeviceKind::scope)"
            : "not in the world: a device may change only bodies that it can find"));
  }
}

void Blinkers::begin_effect(const Effect& effect) {
  before_ = state_.tables;
  inside_ = trees_of(effect);
}

/// Returns for each row 1 if its body is in the tree of the source or of the target of an effect, otherwise
/// 0. An effect may have no target.
std::vector<std::uint8_t> Blinkers::trees_of(const Effect& effect) const {
  const Row source = state_.view.row(effect.source);
  const bool has_target = effect.target.valid() && effect.target.index() < state_.rows.size() &&
                          state_.view.row(effect.target).valid();
  const Row target = has_target ? state_.view.row(effect.target) : source;
  std::vector<std::uint8_t> inside(state_.row_count());
  for (std::size_t r = 0; r < inside.size(); ++r)
    inside[r] = state_.view.same_tree(Row(r), source) || state_.view.same_tree(Row(r), target);
  return inside;
}

void Blinkers::end_effect(const BodyType::Device& device, const Effect& effect) {
  if (device.kind->scope == ApplyScope::anything) return;
  const std::vector<std::uint8_t> inside = trees_of(effect);
  for (std::size_t r = 0; r < inside.size(); ++r) {
    if (inside_[r] != 0 || inside[r] != 0) continue;
    state_.for_tables_of(Row(r), [&](std::size_t t, std::size_t at) {
      if (state_.tables[t].hash_row(at) == before_[t].hash_row(at)) return;
      throw StepError(fmt::format(
          "tick {}: device \"{}\" ({}) of \"{}\" changed the component \"{}\" of \"{}\", a body "
          "that is neither the body of the device nor the target of its effect, nor moves together with one "
          "of them: if this is intended, set DeviceKind::scope to ApplyScope::anything",
          state_.now.tick, device.name, device.kind->name, state_.spec.name(effect.source),
          state_.tables[t].component(), state_.spec.name(state_.bodies[r])));
    });
  }
}

}  // namespace troupe::engine
