#include "engine/world/world.hpp"

#include "partition/simd_target.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

// The parts of World that run once, when the world is made from its spec.

namespace troupe::engine {
namespace {

using Layout = StateTable::Layout;

// Limit on the number of beams of all types together. A beam takes about a hundred bytes of memory.
constexpr double k_most_beams = 10e6;

// A given width of tiles must not make cells so wide that each query visits most bodies, nor give each body a
// tile with far more cells than bodies: each cell of a tile in use takes four bytes, and each tick visits it.
constexpr double k_most_coarsening = 8;        // given tiles may widen the cells by this factor
constexpr unsigned k_most_tile_bits = 8;       // a tile is at most 2^8 cells wide
constexpr double k_most_cells = 1 << 22;       // in all tiles in use, or k_most_cells_per_body
constexpr double k_most_cells_per_body = 256;  // as with tiles of the default width, one for each body
constexpr unsigned k_default_tile_bits = 4;

constexpr double k_least_cell_m = 0.05;

// Cells that are wider than the reach of the sensors requires, by up to this factor, cost little time. If
// they would be even wider, a few wide bodies do not count: bodies that have at most this many entries in the
// spatial index per body of the world, and at most this many huge bodies, each of which every query visits.
constexpr double k_much_wider = 6;
constexpr double k_most_wide_entries = 1;
constexpr double k_most_huge = 16;

// Longest reach that counts for the width of the cells, m. A device may have an infinite reach.
constexpr double k_most_hint = 10'000;

// Bodies in a block of cells share the search for their neighbours, but this search also finds more bodies
// that are out of reach. With so many bodies with sensors in a block, or so many bodies in all, a tick takes
// least time. In worlds of few bodies the cells are therefore wider than their reach requires, by at most
// this factor, because bodies may gather later.
constexpr double k_sensing_per_block = 7;
constexpr double k_bodies_per_block = 21;
constexpr double k_most_widening = 3;

/// The ground on which bodies can be expected: the bounds of the world or, if it has none, the smallest box
/// around the static solids and the bodies at their places at the start, m, world frame.
Box expected_ground(const WorldSpec& spec, std::span<const BodyType> types, std::span<const Vec2> places) {
  if (spec.bounds) return *spec.bounds;
  Box ground;
  for (const Vec2& place : places) ground.extend(place);
  for (const BodySpec& body : spec.bodies) {
    if (types[body.type.index()].runs()) continue;
    for (const PartSpec& part : spec.types[body.type.index()].parts)
      for (const Solid& solid : part.solids)
        for (const Ring& contour : placed(solid, body.pose_world_body).contours)
          ground.extend(bounds(contour));
  }
  return ground;
}

/// Estimates how many bodies there are per square metre around a body. Bodies often start close together and
/// then spread, so the result is the geometric mean of two densities: that around a body at the start,
/// averaged over the bodies, and that of the bodies spread evenly over the ground.
///
/// places  positions of the bodies at the start, m, world frame; if there are none, the result is 0
/// ground  size of the ground, m
/// near_m  width of the squares in which bodies at the start are counted, m
double expected_density(std::span<const Vec2> places, const Vec2& ground, double near_m) {
  if (places.empty()) return 0;
  const partition::GridGeometry squares{near_m, 0};
  std::vector<std::pair<std::int32_t, std::int32_t>> of_places;
  of_places.reserve(places.size());
  for (const Vec2& place : places) {
    const partition::Cell square = squares.cell(place);
    of_places.emplace_back(square.x, square.y);
  }
  std::ranges::sort(of_places);
  double near = 0;  // for each body, the number of bodies in its square, added up
  for (std::size_t i = 0; i < of_places.size();) {
    std::size_t end = i;
    while (end < of_places.size() && of_places[end] == of_places[i]) ++end;
    near += static_cast<double>((end - i) * (end - i));
    i = end;
  }
  const auto count = static_cast<double>(places.size());
  const double at_start = near / count / (near_m * near_m);
  const double spread = count / ((ground.x() + near_m) * (ground.y() + near_m));
  return std::sqrt(at_start * spread);
}

/// The width of the bodies of a type (the diameter of their enclosing circle, m) and their number.
struct BodyWidth {
  double width = 0;
  double bodies = 0;
};

/// Whether the spatial index can list these bodies, which are wider than its cells (m), in little time.
bool are_few(std::span<const BodyWidth> types, double cell_m, double bodies_of_the_world) {
  double entries = 0;
  double huge = 0;
  for (const BodyWidth& type : types) {
    entries += type.bodies * partition::BodyIndex::most_entries(0.5 * type.width, cell_m);
    if (partition::BodyIndex::is_huge(0.5 * type.width, cell_m)) huge += type.bodies;
  }
  return entries <= k_most_wide_entries * bodies_of_the_world && huge <= k_most_huge;
}

/// Returns the least width of cells for these bodies, m: their mean width, weighted by width, so that few
/// bodies are listed in several cells, and an eighth of the largest width, so that no body is listed in more
/// than about a hundred cells. If this is much more than `wanted`, the widest bodies are left out, provided
/// that they are few: one truck must not make the cells so wide that each query of a hundred thousand small
/// robots visits a crowd.
double least_cell(std::vector<BodyWidth> types, double wanted) {
  std::erase_if(types, [](const BodyWidth& type) { return type.bodies == 0; });
  std::ranges::sort(types, std::greater(), &BodyWidth::width);
  std::vector<double> least(types.size() + 1, k_least_cell_m);  // [n]: without the n widest types
  double bodies = 0;
  double sum = 0;
  double sum2 = 0;
  for (std::size_t t = types.size(); t-- > 0;) {
    const auto& [width, count] = types[t];
    bodies += count;
    sum += count * width;
    sum2 += count * width * width;
    // The factor covers the rounding of the sums: if all bodies have the same width, no body is wider than a
    // cell.
    const double mean = sum > 0 ? (1 + 1e-9) * sum2 / sum : 0;
    least[t] = std::max({k_least_cell_m, mean, width / 8});
  }
  const std::span<const BodyWidth> all(types);
  std::size_t left_out = 0;
  while (left_out + 1 < all.size() && least[left_out] > k_much_wider * wanted &&
         are_few(all.first(left_out + 1), std::max(least[left_out + 1], wanted), bodies))
    ++left_out;
  return least[left_out];
}

/// Chooses the cells of the spatial index. Their least width is an eighth of the mean reach of the bodies
/// with rows. The reach of a body is the longest reach of its active devices
/// (DeviceKind::Prepared::cell_hint_m, or reach_m if that is not set) plus its radius; without such devices,
/// it counts as 16 radii. Such cells are small enough to exclude most bodies out of reach. The mean is used,
/// not the maximum, so that a few robots of long range do not coarsen the grid. Where few bodies would share
/// a block of such cells, the cells are wider, so that a query visits fewer of them: see k_bodies_per_block.
/// If `tile_size_m` is positive, tiles have this width, m, and are divided into cells of about the width
/// above. Wide bodies may require wider tiles. Larger tiles than k_most_coarsening allows are made narrower,
/// and tiles with more cells than k_most_cells allows are divided into wider cells.
partition::GridGeometry choose_geometry(const WorldSpec& spec, std::span<const BodyType> types,
                                        double tile_size_m) {
  std::vector<Vec2> places;   // of the bodies at the start
  std::vector<Vec2> sensing;  // of those of them that have active sensors
  double sum = 0;
  std::vector<BodyWidth> widths(types.size());
  double count = 0;
  for (std::size_t b = 0; b < spec.bodies.size(); ++b) {
    const BodySpec& body = spec.bodies[b];
    const BodyType& type = types[body.type.index()];
    if (!type.runs()) continue;
    double reach = 0;
    for (const BodyType::Device& sensor : type.devices)
      if (sensor.active)
        reach = std::max(
            reach, std::min(sensor.prepared.cell_hint_m.value_or(sensor.prepared.reach_m), k_most_hint));
    if (spec.starts(BodyId(b))) {
      places.push_back(body.pose_world_body.position());
      if (reach > 0) sensing.push_back(places.back());
    }
    const double radius = type.radius + type.joint_reach;
    sum += reach > 0 ? 1.001 * (reach + radius) : 16 * radius;
    widths[body.type.index()].width = 2 * radius;
    widths[body.type.index()].bodies += 1;
    ++count;
  }
  const double wanted = count > 0 ? sum / (8 * count) : 1.0;
  const double least = least_cell(std::move(widths), wanted);
  const double narrow = std::max(least, wanted);
  double widening = 1;
  if (!places.empty()) {
    const Vec2 ground = expected_ground(spec, types, places).size();
    const double crowd = std::max(expected_density(sensing, ground, 8 * narrow) / k_sensing_per_block,
                                  expected_density(places, ground, 8 * narrow) / k_bodies_per_block);
    widening = std::clamp(1 / (4 * narrow * std::sqrt(crowd)), 1.0, k_most_widening);
  }
  const double cell = widening * narrow;
  if (!(tile_size_m > 0)) return {cell, k_default_tile_bits};
  const double tile = std::min(tile_size_m, k_most_coarsening * (1u << k_most_tile_bits) * cell);
  const Vec2 ground = spec.bounds.value_or(Box::around(Vec2::Zero(), k_world_reach_m)).size() / tile;
  const double tiles = std::min(count, (ground.x() + 2) * (ground.y() + 2));
  const double most_cells = std::max(k_most_cells, k_most_cells_per_body * count);
  unsigned bits = 0;
  while (bits < k_most_tile_bits && tile / (1u << bits) > cell && tile / (2u << bits) >= least &&
         tiles * static_cast<double>(4u << (2 * bits)) <= most_cells)
    ++bits;
  return {std::max(least, tile / (1u << bits)), bits};
}

/// Adds the tables that every world has, in the order of WorldState::TableIndex.
void add_common_tables(WorldState& state) {
  state.tables.emplace_back(
      "pose", HashGroup::pose, Layout::rows,
      std::vector<StateField>{{"x", Element::f64, 1, "m", "world frame"},
                              {"y", Element::f64, 1, "m", "world frame"},
                              {"z", Element::f64, 1, "m", "world frame"},
                              {"heading", Element::f64, 1, "rad", "counter-clockwise from +x"}},
      state.bodies);
  state.tables.emplace_back(
      "velocity", HashGroup::velocity, Layout::rows,
      std::vector<StateField>{{"x", Element::f64, 1, "m/s", "forward speed, as the drive computed it"},
                              {"y", Element::f64, 1, "m/s", "speed to the left"},
                              {"turn", Element::f64, 1, "rad/s", "turn rate, counter-clockwise"}},
      state.bodies);
  state.tables.emplace_back("command", HashGroup::velocity, Layout::rows, command_fields(), state.bodies,
                            sizeof(Command));
  state.tables.emplace_back(
      "stall", HashGroup::velocity, Layout::columns,
      std::vector<StateField>{
          {"stalled", Element::u8, 1, "",
           "1: last motion was blocked, 2: last motion would have ended out of bounds, 0: neither"}},
      state.bodies);
}

void add_carrier_table(WorldState& state) {
  state.carrier_table = state.tables.size();
  state.tables.emplace_back(
      "carrier", HashGroup::pose, Layout::rows,
      sparse({{"carrier", Element::u32, 1, "", "id of the body that carries this body, plus 1; 0: none"},
              {"joint", Element::u32, 1, "",
               "joint of the carrier that holds this body, counted from 1; 0: none"},
              {"x", Element::f64, 1, "m",
               "position of this body in the frame of the carrier; if `joint` is not 0, this frame moves "
               "with the joint"},
              {"y", Element::f64, 1, "m", "in the same frame as x"},
              {"z", Element::f64, 1, "m", "in the same frame as x"},
              {"heading", Element::f64, 1, "rad", "in the same frame as x"}}),
      state.bodies);
}

void add_contact_table(WorldState& state) {
  state.contact_table = state.tables.size();
  state.tables.emplace_back(
      "contact", HashGroup::velocity, Layout::rows,
      sparse(
          {{"cause", Element::u32, 1, "",
            "what blocked the body in the last tick: 0 nothing, 1 another body, 2 a body that it would have "
            "pushed, 3 the bounds of the world, 4 a body in the way of a joint"},
           {"body", Element::u32, 1, "", "id of the body that blocked the motion, plus 1; 0: none"},
           {"behind", Element::u32, 1, "", "id of the body that stops the pushed body, plus 1; 0: none"}}),
      state.bodies);
}

// The functions below add the tables of one type. These have one row for each of `bodies`, the bodies of the
// type.

void add_joint_tables(BodyType& type, const std::vector<BodyId>& bodies, std::vector<StateTable>& tables) {
  for (BodyType::Joint& joint : type.joints) {
    joint.table = tables.size();
    tables.emplace_back(
        fmt::format("joint/{}", joint.name), HashGroup::pose, Layout::rows,
        std::vector<StateField>{
            {"x", Element::f64, 1, "m", "relative to the joint's rest pose"},
            {"y", Element::f64, 1, "m", "relative to the joint's rest pose"},
            {"z", Element::f64, 1, "m", "relative to the joint's rest pose"},
            {"heading", Element::f64, 1, "rad", "relative to the joint's rest pose; not wrapped"}},
        bodies);
  }
}

void add_odometry_table(BodyType& type, const std::vector<BodyId>& bodies, std::vector<StateTable>& tables) {
  if (!type.drive || type.drive->localization.kind != Localization::Kind::odom) return;
  type.drive->odometry_table = tables.size();
  tables.emplace_back(
      "odometry", HashGroup::memory, Layout::rows,
      std::vector<StateField>{{"x", Element::f64, 1, "m", "estimated position"},
                              {"y", Element::f64, 1, "m", "estimated position"},
                              {"heading", Element::f64, 1, "rad", "estimated heading, counter-clockwise"}},
      bodies);
}

void add_device_tables(BodyType& type, const std::vector<BodyId>& bodies, std::vector<StateTable>& tables) {
  for (BodyType::Device& device : type.devices) {
    const DeviceKind::Prepared& prepared = device.prepared;
    // Component names, which are hashed, do not contain the name of the type. Types only save memory: two
    // files may divide the same bodies into types differently, and the hashes must not depend on that.
    const std::string component = fmt::format("{}/{}", device.kind->name, device.name);
    device.table = tables.size();
    tables.emplace_back(component, HashGroup::sensor, Layout::rows, prepared.percepts, bodies,
                        prepared.percept_bytes);
    if (prepared.commands.empty()) continue;
    device.command_table = tables.size();
    tables.emplace_back(component + "/command", HashGroup::velocity, Layout::rows, prepared.commands, bodies,
                        prepared.command_bytes);
  }
}

void add_memory_tables(BodyType& type, const std::vector<BodyId>& bodies, std::vector<StateTable>& tables) {
  for (std::size_t c = 0; c < type.controllers.size(); ++c) {
    BodyType::Controller& controller = type.controllers[c];
    if (controller.kind->memory.empty()) continue;
    controller.table = tables.size();
    tables.emplace_back(fmt::format("{}/{}", controller.kind->name, c), HashGroup::memory, Layout::rows,
                        controller.kind->memory, bodies, controller.kind->memory_bytes);
  }
}

void add_type_tables(BodyType& type, const std::vector<BodyId>& bodies, std::vector<StateTable>& tables) {
  add_joint_tables(type, bodies, tables);
  add_odometry_table(type, bodies, tables);
  add_device_tables(type, bodies, tables);
  add_memory_tables(type, bodies, tables);
}

}  // namespace

World::World(WorldSpec spec, const Registry& registry, const WorldOptions& options, Diagnostics& diagnostics)
    : parallel_(options.threads), links_(state_, parallel_), movement_(state_, parallel_) {
  state_.spec = std::move(spec);
  if (const auto warning = partition::simd_warning()) diagnostics.warning({}, *warning);
  check_rules(state_.spec, [&](Where where, const std::string& text) { diagnostics.error(where, text); });
  diagnostics.throw_if_errors();
  double beams = 0;
  for (const TypeSpec& type : state_.spec.types) {
    state_.types.push_back(make_body_type(type, state_.spec, registry, diagnostics));
    for (const BodyType::Device& sensor : state_.types.back().devices)
      beams += static_cast<double>(sensor.prepared.beams);
    for (const BodyType::Controller& controller : state_.types.back().controllers)
      has_collective_ = has_collective_ || controller.kind->is_collective;
    if (beams <= k_most_beams) continue;
    diagnostics.error(
        type.parts.front().where,
        fmt::format(
            "too large: the sensors of this type and of the types before it have {:.0f} beams in total (each "
            "type is counted once, however many bodies it has), at most {:.0f} are allowed",
            beams, k_most_beams));
    diagnostics.throw_if_errors();
  }
  check_size(diagnostics);
  check_reserves(diagnostics);
  diagnostics.throw_if_errors();
  const partition::GridGeometry usual = choose_geometry(state_.spec, state_.types, 0);
  state_.geometry =
      options.tile_size_m > 0 ? choose_geometry(state_.spec, state_.types, options.tile_size_m) : usual;
  build_rows(usual);
  movement_.build();
  links_.build();
  build_experiment(registry, diagnostics);
  build_scene();
  build_tables();
  if (state_.spec.ranging == RangingEngine::grid) {
    build_ray_grid(diagnostics);
    redraw_ray_grid();
  }
  report_overlaps(diagnostics);
}

/// Reports an error if the world needs too much memory. A file of a few kilobytes can ask for more memory
/// than the machine has, and the operating system would then kill the process without a message.
void World::check_size(Diagnostics& diagnostics) const {
  constexpr double k_most_bytes = 16e9;
  struct Size {  // of a body of a type
    double fixed_vertices = 0;
    double bytes = 0;
  };
  std::vector<Size> sizes(state_.types.size());
  for (std::size_t t = 0; t < sizes.size(); ++t) {
    const BodyType& type = state_.types[t];
    if (!type.runs()) {
      for (const PartSpec& part : state_.spec.types[t].parts)
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
  for (const BodySpec& body : state_.spec.bodies) {
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

void World::check_reserves(Diagnostics& diagnostics) const {
  std::set<std::string_view> populations;
  for (const ReserveSpec& reserve : state_.spec.reserves) {
    const BodySpec& body = state_.spec.bodies[reserve.first.index()];
    if (!populations.insert(reserve.population).second)
      diagnostics.error(
          body.where,
          fmt::format(
              "here begins a second reserve of population \"{}\", but only the bodies of its first "
              "reserve could be born: models with the same \"reserve_of\" must follow one another and "
              "have the same type, and the population itself must have no \"reserve\"",
              reserve.population));
    if (!state_.types[body.type.index()].runs())
      diagnostics.error(
          body.where, fmt::format("the reserve of population \"{}\" needs a type that has a drive, a device "
                                  "or a controller, or that can be gripped or pushed",
                                  reserve.population));
  }
}

/// Returns the bodies that have rows, in the order of their rows. Bodies that are neighbours in space at tick
/// 0 get rows that are close in memory, and most of them remain neighbours for a long time. With 100,000
/// robots in a building, a step with rows in arbitrary order takes 1.5 times as long. The order affects only
/// the speed. `geometry` is the grid that the world has if WorldOptions::tile_size_m is not set.
std::vector<BodyId> World::rows_by_place(const partition::GridGeometry& geometry) const {
  struct Place {
    std::uint64_t key;
    BodyId body;
  };
  const auto low_bits = [](std::int32_t value, unsigned bits) {
    return static_cast<std::uint64_t>(value) & ((1u << bits) - 1);
  };
  std::vector<Place> places;
  places.reserve(state_.spec.bodies.size());
  for (std::size_t b = 0; b < state_.spec.bodies.size(); ++b) {
    const BodySpec& body = state_.spec.bodies[b];
    if (!state_.types[body.type.index()].runs()) continue;
    if (!state_.spec.starts(BodyId(b))) {  // the body is unborn: its row comes last
      places.push_back({~std::uint64_t{0}, BodyId(b)});
      continue;
    }
    const partition::Cell cell = geometry.cell(body.pose_world_body.position());
    std::uint64_t key = 0;
    const auto append = [&](partition::Cell c, unsigned bits) {
      key = (key << (2 * bits)) | (low_bits(c.y, bits) << bits) | low_bits(c.x, bits);
    };
    append(geometry.tile(cell), 24);
    append(geometry.block(cell), geometry.tile_bits - geometry.block_bits());
    append(cell, geometry.block_bits());
    places.push_back({key, BodyId(b)});
  }
  std::ranges::sort(places, {}, [](const Place& place) { return std::pair(place.key, place.body.value); });
  std::vector<BodyId> bodies;
  bodies.reserve(places.size());
  for (const Place& place : places) bodies.push_back(place.body);
  return bodies;
}

void World::build_rows(const partition::GridGeometry& usual) {
  state_.rows.resize(state_.spec.bodies.size());
  const std::vector<BodyId> bodies = rows_by_place(usual);
  const auto reserve = [&bodies](auto&... columns) { (columns.reserve(bodies.size()), ...); };
  reserve(state_.bodies, state_.ids, state_.row_types, state_.slots, state_.outline_begins);
  state_.pools.resize(state_.types.size());
  for (const BodyId body : bodies) ++state_.pools[state_.spec.bodies[body.index()].type.index()].rows;
  for (WorldState::Pool& pool : state_.pools) pool.slots = pool.rows;
  state_.place_pools();
  std::vector<std::uint32_t> slots(state_.types.size(), 0);
  for (const BodyId body : bodies) {
    const auto t = state_.spec.bodies[body.index()].type.value;
    const BodyType& type = state_.types[t];
    state_.rows[body.index()] = Row(state_.bodies.size());
    state_.bodies.push_back(body);
    state_.ids.push_back(body.value);
    state_.row_types.push_back(t);
    state_.outline_begins.push_back(state_.outline_begin(t, slots[t]));
    state_.slots.push_back(slots[t]++);
    robots_at_start_ += type.drive.has_value() && state_.spec.starts(body);
  }
  state_.own_rows = rows();
  state_.subscribed.resize(rows());
  state_.radii.resize(rows());
  state_.shapes.resize(rows());
  state_.transforms.resize(rows());
  state_.bind_view();
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
  state_.fixed_targets =
      FixedTargets(state_.spec, [this](BodyId body) { return location(body) == RowLocation::none; });
  state_.index = partition::BodyIndex(state_.geometry);
  if (state_.spec.bounds) state_.index.reserve(*state_.spec.bounds);
}

/// The order of the tables is the order of the components in recordings and checkpoints.
void World::build_tables() {
  add_common_tables(state_);
  if (std::ranges::any_of(state_.types, &BodyType::carries)) add_carrier_table(state_);
  build_lives();
  build_conditions();
  const auto reads_contacts = [](const BodyType::Controller& controller) {
    return controller.kind->reads_contacts;
  };
  if (state_.spec.contacts || std::ranges::any_of(state_.types, [&](const BodyType& type) {
        return std::ranges::any_of(type.controllers, reads_contacts);
      }))
    add_contact_table(state_);
  has_collisions_ =
      std::ranges::any_of(state_.types, [](const BodyType& type) { return !type.collision_devices.empty(); });
  if (state_.contact_table || has_collisions_) movement_.find_blocks();

  std::vector<std::vector<BodyId>> bodies(state_.types.size());  // by type
  for (std::size_t r = 0; r < rows(); ++r) bodies[state_.row_types[r]].push_back(state_.bodies[r]);
  std::size_t effects = 0;
  for (std::size_t t = 0; t < state_.types.size(); ++t) {
    if (bodies[t].empty()) continue;
    BodyType& type = state_.types[t];
    add_type_tables(type, bodies[t], state_.tables);
    for (const BodyType::Device& device : type.devices)
      effects += device.prepared.most_effects * bodies[t].size();
  }
  effects_.reserve(effects);
  state_.bind_view();
  start();
}

World::~World() = default;

std::vector<StateTable> World::unused_tables() const {
  std::vector<bool> is_used(state_.types.size(), false);
  for (const BodySpec& body : state_.spec.bodies) is_used[body.type.index()] = true;
  std::vector<StateTable> tables;
  for (std::size_t t = 0; t < is_used.size(); ++t) {
    if (is_used[t] || !state_.types[t].runs()) continue;
    BodyType type = state_.types[t];  // a copy, because the members for indices of tables are set
    add_type_tables(type, {}, tables);
  }
  return tables;
}

}  // namespace troupe::engine
