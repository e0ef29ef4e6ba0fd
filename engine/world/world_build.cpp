#include "engine/conflicts/overlaps.hpp"
#include "engine/world/grid_choice.hpp"
#include "engine/world/state_tables.hpp"
#include "engine/world/world.hpp"
#include "partition/simd_target.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

// The parts of World that run once, when the world is made from its spec.

namespace troupe::engine {
namespace {

// Limit on the number of beams of all types together. A beam takes about a hundred bytes of memory.
constexpr double k_most_beams = 10e6;

/// Reports an error if the world needs too much memory. A file of a few kilobytes can ask for more memory
/// than the machine has, and the operating system would then kill the process without a message.
void check_size(const WorldState& state, Diagnostics& diagnostics) {
  constexpr double k_most_bytes = 16e9;
  struct Size {  // of a body of a type
    double fixed_vertices = 0;
    double bytes = 0;
  };
  std::vector<Size> sizes(state.types.size());
  for (std::size_t t = 0; t < sizes.size(); ++t) {
    const BodyType& type = state.types[t];
    if (!type.runs()) {
      for (const PartSpec& part : state.spec.types[t].parts)
        sizes[t].fixed_vertices += static_cast<double>(count_vertices(part.solids));
      continue;
    }
    sizes[t].bytes = type.row_bytes();
    for (const BodyType::Device& device : type.devices)
      sizes[t].bytes += static_cast<double>(device.prepared.most_effects) * sizeof(Effect);
  }
  double fixed_vertices = 0;
  double bytes = 0;
  Where where;
  for (const BodySpec& body : state.spec.bodies) {
    fixed_vertices += sizes[body.type.index()].fixed_vertices;
    bytes += sizes[body.type.index()].bytes;
    where = body.where;
    if (fixed_vertices > k_most_vertices || bytes > k_most_bytes) break;
  }
  if (fixed_vertices > k_most_vertices)
    diagnostics.error(
        where,
        fmt::format(
            "too large: with this body, the outlines of all static bodies have more than {} corners in "
            "total",
            k_most_vertices));
  if (bytes > k_most_bytes)
    diagnostics.error(
        where,
        fmt::format(
            "too large: with this body, the sensor readings, controller memories, outlines and effects "
            "of all bodies take more than {:.0f} GB",
            k_most_bytes / 1e9));
}

void check_reserves(const WorldState& state, Diagnostics& diagnostics) {
  std::set<std::string_view> populations;
  for (const ReserveSpec& reserve : state.spec.reserves) {
    const BodySpec& body = state.spec.bodies[reserve.first.index()];
    if (!populations.insert(reserve.population).second)
      diagnostics.error(
          body.where,
          fmt::format(
              "here begins a second reserve of population \"{}\", but only the bodies of its first "
              "reserve could be born: models with the same \"reserve_of\" must follow one another and "
              "have the same type, and the population itself must have no \"reserve\"",
              reserve.population));
    if (!state.types[body.type.index()].runs())
      diagnostics.error(
          body.where, fmt::format("the reserve of population \"{}\" needs a type that has a drive, a device "
                                  "or a controller, or that can be gripped or pushed",
                                  reserve.population));
  }
}

}  // namespace

World::World(WorldSpec spec, const Registry& registry, const WorldOptions& options, Diagnostics& diagnostics)
    : parallel_(options.threads) {
  state_.spec = std::move(spec);
  if (const auto warning = partition::simd_warning()) diagnostics.warning({}, *warning);
  check_rules(state_.spec, [&](Where where, const std::string& text) { diagnostics.error(where, text); });
  diagnostics.throw_if_errors();
  double beams = 0;
  for (const TypeSpec& type : state_.spec.types) {
    state_.types.push_back(make_body_type(type, state_.spec, registry, diagnostics));
    for (const BodyType::Device& sensor : state_.types.back().devices)
      beams += static_cast<double>(sensor.prepared.beams);
    if (beams <= k_most_beams) continue;
    diagnostics.error(
        type.parts.front().where,
        fmt::format(
            "too large: the sensors of this type and of the types before it have {:.0f} beams in total (each "
            "type is counted once, however many bodies it has), at most {:.0f} are allowed",
            beams, k_most_beams));
    diagnostics.throw_if_errors();
  }
  check_size(state_, diagnostics);
  check_reserves(state_, diagnostics);
  diagnostics.throw_if_errors();
  const partition::GridGeometry usual = choose_grid(state_.spec, state_.types, 0);
  state_.geometry =
      options.tile_size_m > 0 ? choose_grid(state_.spec, state_.types, options.tile_size_m) : usual;
  rows_.build(usual);
  movement_.build();
  links_.build();
  interventions_.build(registry, diagnostics);
  build_scene();
  build_tables();
  if (state_.spec.ranging == RangingEngine::grid) {
    places_.build_ray_grid(diagnostics);
    places_.redraw_ray_grid();
  }
  report_overlaps(state_, parallel_, diagnostics);
}

void World::build_scene() {
  std::vector<partition::FixedSolid> solids;
  for (std::size_t b = 0; b < state_.spec.bodies.size(); ++b) {
    const BodySpec& body = state_.spec.bodies[b];
    if (state_.types[body.type.index()].runs()) continue;
    const std::vector<PartSpec>& parts = state_.spec.types[body.type.index()].parts;
    for (std::uint32_t p = 0; p < parts.size(); ++p)
      for (const Solid& solid : parts[p].solids)
        solids.push_back({placed(solid, body.pose_world_body), BodyId(b), parts[p].returns.obstacle,
                          parts[p].returns.ranger, p});
  }
  state_.scene = partition::StaticScene(std::move(solids), state_.geometry.cell_m);
  state_.fixed_targets = FixedTargets(
      state_.spec, [this](BodyId body) { return state_.view.location(body) == RowLocation::none; });
  state_.index = partition::BodyIndex(state_.geometry);
  if (state_.spec.bounds) state_.index.reserve(*state_.spec.bounds);
}

/// The order of the tables is the order of the components in recordings and checkpoints.
void World::build_tables() {
  add_common_tables(state_);
  lives_.build();
  interventions_.build_conditions();
  add_contact_table(state_);
  add_tables_of_types(state_);
  tick_.build();
  state_.bind_view();
  start();
}

World::~World() = default;

}  // namespace troupe::engine
