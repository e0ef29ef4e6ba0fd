#include "engine/state/world_state.hpp"

#include "base/capacity.hpp"
#include "base/limits.hpp"
#include "base/number_text.hpp"
#include "partition/ranging.hpp"

#include <fmt/format.h>

#include <cstddef>

namespace troupe::engine {

const partition::ObstacleShape k_no_shape;

std::string outside_text(const Box& bounds) {
  return fmt::format("outside the world's bounds ({})", extent_text(bounds));
}

std::span<const std::uint32_t> rows_within(std::span<const std::uint32_t> order, const RowRange& range,
                                           std::vector<std::uint32_t>& rows) {
  rows.resize(order.size());
  std::size_t count = 0;
  for (const std::uint32_t row : order) {  // no branch on the range, because it would be unpredictable
    rows[count] = row;
    count += row >= range.first && row < range.end;
  }
  return std::span(rows).first(count);
}

void WorldState::place_pools() {
  std::size_t vertices = 0;
  std::size_t joints = 0;
  for (std::size_t t = 0; t < types.size(); ++t) {
    pools[t].outlines = vertices;
    pools[t].joints = static_cast<std::uint32_t>(joints);
    vertices += pools[t].slots * types[t].outline_vertices.size();
    joints += pools[t].slots * types[t].joints.size();
  }
  constexpr std::size_t k_padding = partition::EdgeBlock::k_piece;  // rangers copy k_piece vertices at a time
  resize_with_capacity<Vec2>(outlines, vertices + k_padding, Vec2::Zero());
}

void WorldState::bind_view() {
  PublicColumns columns{.spec = &spec,
                        .scene = &scene,
                        .fixed_targets = &fixed_targets,
                        .geometry = &geometry,
                        .types = types,
                        .bodies = bodies,
                        .rows = rows,
                        .row_types = row_types,
                        .slots = slots,
                        .outline_begins = outline_begins,
                        .joint_begins = joint_begins,
                        .index = &index,
                        .ray_grid = ray_grid.get(),
                        .transforms = transforms,
                        .outlines = outlines,
                        .radii = radii,
                        .joint_mounts = joint_mounts,
                        .roots = roots,
                        .tables = tables,
                        .subscribed = subscribed,
                        .now = &now};
  if (!tables.empty()) {
    columns.poses = as<Pose>(k_pose);
    columns.velocities = as<Velocity>(k_velocity);
    columns.commands = as<Command>(k_command);
    columns.stalls = stalls();
  }
  if (carrier_table) columns.carriers = as<Carried>(*carrier_table);
  if (life_table) columns.lives = as<Life>(*life_table);
  if (condition_table) columns.conditions = as<Condition>(*condition_table);
  if (has_contacts()) columns.contacts = contact_table ? as<Contact>(*contact_table) : contacts;
  view = CommittedView(columns);
}

Box WorldState::bounds() const { return spec.bounds.value_or(Box::around(Vec2::Zero(), k_world_reach_m)); }

void WorldState::update_presence(Row row) {
  const bool there = view.is_there(row);
  shapes[row.index()] = there ? &type(row).obstacle : &k_no_shape;
  radii[row.index()] = there ? type(row).radius : partition::k_not_there;
  if (!not_drawn.empty()) not_drawn[row.index()] = !there;
}

/// Computes the outlines of a row whose body has joints, in the world frame. `transform`: pose of the body,
/// world frame.
void WorldState::update_jointed_outlines(Row row, const BodyType& type, const Transform& transform) {
  Vec2* out = outlines.data() + outline_begins[row.index()];
  const std::span<const Mount> all = mounts(row);
  const auto transform_outline = [&](const RayOutline& outline) {
    Transform at = transform;
    if (outline.joint != k_rigid)
      at = compose(Mount(transform, 0, 0), all[static_cast<std::size_t>(outline.joint)]).transform;
    for (std::uint32_t v = 0; v < outline.count; ++v) *out++ = at * type.outline_vertices[outline.first + v];
  };
  for (const RayOutline& outline : type.outlines) transform_outline(outline);
  for (const RayOutline& outline : type.hidden_outlines) transform_outline(outline);
}

void WorldState::clear(Row row) {
  for_tables_of(row, [this](std::size_t t, std::size_t at) { tables[t].clear_row(at); });
  if (!contacts.empty()) contacts[row.index()] = {};
}

}  // namespace troupe::engine
