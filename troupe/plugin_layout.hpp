#pragma once

#include "engine/fields/description.hpp"
#include "engine/kinds/measure_kind.hpp"
#include "engine/links/effect_views.hpp"
#include "engine/rows/measured_world.hpp"
#include "engine/sensing/sensing_view.hpp"

#include <cstddef>
#include <cstdint>
#include <initializer_list>

/// This header defines layout(), which returns a hash of the layouts of all types that a plug-in and the
/// program exchange. A plug-in is a shared library with controllers, sensors, other devices or measures.

// TROUPE_PLUGIN_EACH(DO, T, a, b, ...) expands to DO(T, a) DO(T, b) ..., for up to 64 names.
#define TROUPE_PLUGIN_PARENTHESES ()
#define TROUPE_PLUGIN_EXPAND(...) \
  TROUPE_PLUGIN_EXPAND_16(        \
      TROUPE_PLUGIN_EXPAND_16(TROUPE_PLUGIN_EXPAND_16(TROUPE_PLUGIN_EXPAND_16(__VA_ARGS__))))
#define TROUPE_PLUGIN_EXPAND_16(...) \
  TROUPE_PLUGIN_EXPAND_4(TROUPE_PLUGIN_EXPAND_4(TROUPE_PLUGIN_EXPAND_4(TROUPE_PLUGIN_EXPAND_4(__VA_ARGS__))))
#define TROUPE_PLUGIN_EXPAND_4(...) \
  TROUPE_PLUGIN_EXPAND_1(TROUPE_PLUGIN_EXPAND_1(TROUPE_PLUGIN_EXPAND_1(TROUPE_PLUGIN_EXPAND_1(__VA_ARGS__))))
#define TROUPE_PLUGIN_EXPAND_1(...) __VA_ARGS__
#define TROUPE_PLUGIN_EACH(DO, T, ...) \
  __VA_OPT__(TROUPE_PLUGIN_EXPAND(TROUPE_PLUGIN_EACH_AGAIN(DO, T, __VA_ARGS__)))
#define TROUPE_PLUGIN_EACH_AGAIN(DO, T, name, ...) \
  DO(T, name) __VA_OPT__(TROUPE_PLUGIN_EACH_NEXT TROUPE_PLUGIN_PARENTHESES(DO, T, __VA_ARGS__))
#define TROUPE_PLUGIN_EACH_NEXT() TROUPE_PLUGIN_EACH_AGAIN

#define TROUPE_PLUGIN_OFFSET(T, name) __builtin_offsetof(T, name),
// Size, alignment and member offsets of an aggregate. All members must be listed.
#define TROUPE_PLUGIN_MEMBERS(T, ...) \
  of_members<T>({TROUPE_PLUGIN_EACH(TROUPE_PLUGIN_OFFSET, T, __VA_ARGS__)})

namespace troupe::plugin {
namespace detail {

constexpr std::uint64_t mixed(std::initializer_list<std::uint64_t> numbers) {
  std::uint64_t mixture = 0;
  for (const std::uint64_t number : numbers)
    mixture = (mixture ^ (mixture >> 29)) * 0x9e3779b97f4a7c15 + number;
  return mixture;
}

template <class T, std::size_t N>
constexpr std::uint64_t of_members(const std::size_t (&offsets)[N]) {
  static_assert(N == engine::detail::member_count<T>(), "the list must have every member of the struct");
  std::uint64_t mixture = mixed({sizeof(T), alignof(T)});
  for (const std::size_t offset : offsets) mixture = mixed({mixture, offset});
  return mixture;
}

template <class... T>
constexpr std::uint64_t of_sizes() {
  return mixed({mixed({sizeof(T), alignof(T)})...});
}

}  // namespace detail

// offsetof() is defined for all of these types by the compilers that Troupe supports, although the standard
// guarantees it only for types of standard layout.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Winvalid-offsetof"
/// Returns a hash of the layouts of all types that plug-in and program exchange: sizes, alignments, and the
/// offsets of public members. These types include those that inline functions of the classes SensingView and
/// MeasuredWorld access, because a plug-in reads the world through these functions. If plug-in and program
/// have the same version of the plug-in interface but different hashes, they were compiled with headers of
/// different revisions of Troupe. tests/plugins/layouts.txt has the hash of each version of the interface.
constexpr std::uint64_t layout() {
  using namespace engine;
  using namespace detail;
  return mixed(
      {// Kinds (the implementations of controllers, devices and measures) and the arguments of their
       // functions, the structs that a SensingView refers to, and the definition of the world.
       TROUPE_PLUGIN_MEMBERS(ControllerKind, name, text, params, needs_drive, switches, reads_contacts,
                             is_collective, memory, memory_bytes, start, prepare, bind_world, brings, decide,
                             lint),
       TROUPE_PLUGIN_MEMBERS(ControllerKind::Prepared, data, devices),
       TROUPE_PLUGIN_MEMBERS(DeviceKind, name, text, params, joints, carries, drives, reads, scope, body,
                             prepare, bind_part, bind_world, reach_m, start, sense, act, halt, joints_moved,
                             collide, apply, born, is_spent, needs_supply, energy, flags, shows_color, layer,
                             draw, lint),
       TROUPE_PLUGIN_MEMBERS(DeviceKind::Prepared, data, percepts, percept_bytes, commands, command_bytes,
                             reach_m, cell_hint_m, beams, most_effects, feels_collisions, ends_lives, watts,
                             joints, joint_reach_m, bearings, transducers, camera),
       TROUPE_PLUGIN_MEMBERS(StateField, name, element, columns, unit, text, offset, sparse, appearance,
                             is_bool),
       TROUPE_PLUGIN_MEMBERS(Field, name, type, unit, fallback, in_json, min, max, text, columns, choices,
                             record, above_min, counts_readings, optional, mirror, fixed, provenance, sparse,
                             used_if, appearance, member, offset),
       TROUPE_PLUGIN_MEMBERS(FieldCondition, field, value, is),
       TROUPE_PLUGIN_MEMBERS(MemberType, type, columns, min, max, optional, is_unsigned, is_bool,
                             has_whole_numbers, choices, table, get, set, size, resize, block, each, is_state,
                             element),
       TROUPE_PLUGIN_MEMBERS(FieldTable, fields), TROUPE_PLUGIN_MEMBERS(Value, v),
       TROUPE_PLUGIN_MEMBERS(DecideBatch, tick, time_s, tick_s, period_s, seed, stream, rows, ids, slots,
                             commands, stalls, contacts, estimates, percepts, device_commands, switches,
                             devices, memories, drive_commands, drive_state),
       TROUPE_PLUGIN_MEMBERS(Effect, source, device, sequence, verb, target, payload, reserve),
       TROUPE_PLUGIN_MEMBERS(MeasureKind, name, unit, text, definition, formula, same_as, is_foreign, params,
                             make),
       TROUPE_PLUGIN_MEMBERS(Command, x, y, turn, mode, off),
       TROUPE_PLUGIN_MEMBERS(PublicColumns, spec, scene, fixed_targets, geometry, types, bodies, rows,
                             row_types, slots, outline_begins, joint_begins, index, ray_grid, poses,
                             transforms, outlines, radii, joint_mounts, roots, carriers, lives, stalls,
                             contacts, velocities, commands, conditions, tables, subscribed, now),
       TROUPE_PLUGIN_MEMBERS(TickCounts, tick, absent, impaired, carried, stalled, out_of_bounds),
       TROUPE_PLUGIN_MEMBERS(BodyType, name, obstacle, obstacle_joints, grip, grip_joints, outline_vertices,
                             outlines, hidden_outlines, radius, joint_reach, targets, joints, drive, pushable,
                             devices, joint_devices, collision_devices, carries, controllers),
       TROUPE_PLUGIN_MEMBERS(BodyType::Device, name, kind, prepared, period, active, part, joint, moves,
                             stream, supply, table, command_table, switch_bit),
       TROUPE_PLUGIN_MEMBERS(BodyType::Drive, kind, data, period, localization, odometry_table, supply,
                             pushes, turns_when_blocked),
       TROUPE_PLUGIN_MEMBERS(BodyType::Joint, name, parent, at_rest, to_body, table),
       TROUPE_PLUGIN_MEMBERS(RayOutline, first, count, z, ranger_return, part, solid, joint),
       TROUPE_PLUGIN_MEMBERS(Pose, x, y, z, heading), TROUPE_PLUGIN_MEMBERS(Velocity, x, y, turn),
       TROUPE_PLUGIN_MEMBERS(Carried, carrier, joint, pose),
       TROUPE_PLUGIN_MEMBERS(Contact, cause, body, behind),
       TROUPE_PLUGIN_MEMBERS(Life, birth, x, y, presence), TROUPE_PLUGIN_MEMBERS(Condition, speed, dead, out),
       TROUPE_PLUGIN_MEMBERS(WorldSpec, title, files, seed, tick_s, quit_time_s, record, ranging,
                             resolution_m, resolution_where, bounds, types, names, bodies, reserves,
                             empty_populations, mortal, contacts, aliases, part_aliases, measures,
                             measure_every_s, watch, window, experiment),
       TROUPE_PLUGIN_MEMBERS(TypeSpec, name, parts, joints, drive, devices, controllers),
       TROUPE_PLUGIN_MEMBERS(PartSpec, name, alias, kind, parent, joint, pose_body_part, size, solids,
                             returns, floor_plan, image, fitted, color, where),
       TROUPE_PLUGIN_MEMBERS(BodySpec, name, type, pose_world_body, color, fiducial, where),
       TROUPE_PLUGIN_MEMBERS(FixedTargets::Target, body, part, pose_world_part),
       TROUPE_PLUGIN_MEMBERS(partition::FixedSolid, solid, body, obstacle, ranger_return, part),
       TROUPE_PLUGIN_MEMBERS(partition::BodyCircle, x, y, radius, row),
       TROUPE_PLUGIN_MEMBERS(partition::GridGeometry, cell_m, tile_bits),
       // Types with private members or references: only sizes and alignments.
       of_sizes<DeviceInfo, Percept, Actions, Readings, Random, DeviceBatch, SenseBatch, Effects, DeviceView,
                Measure, StateTable, SensingView, CommittedView, Transform, Mount, FixedTargets,
                partition::StaticScene, partition::FixedOutlines, partition::BodyIndex,
                partition::TileDirectory, partition::RayGrid>(),
       of_sizes<MeasuredWorld, EffectContext, OwnDevice, DeviceExchange, Gripping>()});
}
#pragma GCC diagnostic pop

}  // namespace troupe::plugin

#undef TROUPE_PLUGIN_MEMBERS
#undef TROUPE_PLUGIN_OFFSET
#undef TROUPE_PLUGIN_EACH
#undef TROUPE_PLUGIN_EACH_AGAIN
#undef TROUPE_PLUGIN_EACH_NEXT
#undef TROUPE_PLUGIN_EXPAND
#undef TROUPE_PLUGIN_EXPAND_16
#undef TROUPE_PLUGIN_EXPAND_4
#undef TROUPE_PLUGIN_EXPAND_1
#undef TROUPE_PLUGIN_PARENTHESES
