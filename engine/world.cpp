#include "engine/world.hpp"

#include "base/exact_sum.hpp"
#include "base/fp_environment.hpp"
#include "engine/frame.hpp"
#include "engine/kind_errors.hpp"
#include "engine/replica.hpp"
#include "engine/shown_color.hpp"
#include "partition/placed_shape.hpp"
#include "partition/ranging.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace troupe::engine {
namespace {

// Limit on the beams of all types together: a beam takes some hundred bytes.
constexpr double k_most_beams = 10e6;
const Localization k_true_pose;  // the localization of bodies without a drive
constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
constexpr Pose k_nowhere{k_nan, k_nan, k_nan, k_nan};

bool is_finite(const Pose& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) && std::isfinite(p.heading);
}

/// Chooses the cells of the spatial index. Their width is an eighth of the reach of a body (its longest
/// sensor reach plus its radius), averaged over the bodies with rows; the reach of a body without sensors
/// counts as 16 radii. Such cells are small enough to exclude most bodies out of reach, and large enough that
/// a query visits few of them. The mean is used, not the maximum, so that a few robots of long range do not
/// coarsen the grid. If `tile_size_m` is positive, tiles have this width, m, and are divided into cells of
/// about the width above; wide bodies may require wider tiles.
partition::GridGeometry choose_geometry(const WorldSpec& spec, std::span<const BodyType> types,
                                        double tile_size_m) {
  double sum = 0;
  double widths = 0;
  double widths2 = 0;
  double count = 0;
  double width = 0;
  for (const BodySpec& body : spec.bodies) {
    const BodyType& type = types[body.type.index()];
    if (!type.runs()) continue;
    double reach = 0;
    for (const BodyType::Device& sensor : type.devices)
      if (sensor.active)
        reach = std::max(reach, sensor.prepared.cell_hint_m.value_or(sensor.prepared.reach_m));
    const double radius = type.radius + type.joint_reach;
    sum += reach > 0 ? 1.001 * (reach + radius) : 16 * radius;
    widths += 2 * radius;
    widths2 += 4 * radius * radius;
    width = std::max(width, 2 * radius);
    ++count;
  }
  // Cells are at least as wide as the bodies that cover most of the ground (mean width, weighted by width),
  // so that few bodies overlap several cells. They are also at least an eighth as wide as the widest body, so
  // that no body overlaps more than some hundred cells. The factor 1 + 1e-9 covers the rounding of the sums:
  // if all bodies have the same width, they fit into a cell.
  const double own_width = widths > 0 ? (1 + 1e-9) * widths2 / widths : 0;
  const double least = std::max({0.05, own_width, width / 8});
  const double cell = std::max(least, count > 0 ? sum / (8 * count) : 1.0);
  constexpr unsigned k_tile_bits = 4;
  if (!(tile_size_m > 0)) return {cell, k_tile_bits};
  unsigned bits = 0;
  while (bits < 8 && tile_size_m / (1u << bits) > cell && tile_size_m / (2u << bits) >= least) ++bits;
  return {std::max(least, tile_size_m / (1u << bits)), bits};
}

}  // namespace

World::World(WorldSpec spec, const Registry& registry, const WorldOptions& options, Diagnostics& diagnostics)
    : parallel_(options.threads), links_(state_, parallel_), movement_(state_, parallel_) {
  state_.spec = std::move(spec);
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
            "too large: the sensors of this type and of the types before it have more than {:.0f} beams "
            "in total (each type is counted once, however many bodies it has)",
            k_most_beams));
    diagnostics.throw_if_errors();
  }
  check_size(diagnostics);
  check_reserves(diagnostics);
  diagnostics.throw_if_errors();
  state_.geometry = choose_geometry(state_.spec, state_.types, options.tile_size_m);
  build_rows();
  movement_.build();
  links_.build();
  build_experiment(registry, diagnostics);
  build_scene();
  build_tables();
  if (state_.spec.ranging == RangingEngine::grid) build_ray_grid(diagnostics);
  report_overlaps(diagnostics);
}

/// Reports worlds that need too much memory. A file of some kilobytes can ask for more memory than the
/// machine has, and the operating system would then kill the process without a message.
void World::check_size(Diagnostics& diagnostics) const {
  constexpr double k_most_bytes = 16e9;
  double fixed_vertices = 0;
  double bytes = 0;
  Where where;
  std::vector<double> vertices;
  for (const TypeSpec& type : state_.spec.types) {
    double count = 0;
    for (const PartSpec& part : type.parts) count += static_cast<double>(count_vertices(part.solids));
    vertices.push_back(count);
  }
  for (const BodySpec& body : state_.spec.bodies) {
    const BodyType& type = state_.types[body.type.index()];
    if (!type.runs()) {
      fixed_vertices += vertices[body.type.index()];
    } else {
      bytes += type.row_bytes();
    }
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
        fmt::format("too large: with this body, the sensor readings, controller memories and outlines of all "
                    "bodies take more than {:.0f} GB",
                    k_most_bytes / 1e9));
}

void World::check_reserves(Diagnostics& diagnostics) const {
  for (const ReserveSpec& reserve : state_.spec.reserves) {
    const BodySpec& body = state_.spec.bodies[reserve.first.index()];
    if (!state_.types[body.type.index()].runs())
      diagnostics.error(
          body.where, fmt::format("the reserve of population \"{}\" needs a type that has a drive, a device "
                                  "or a controller, or that can be gripped or pushed",
                                  reserve.population));
  }
}

/// Returns the bodies that have rows, in the order of their rows. Bodies that are neighbours in space at tick
/// 0 become neighbours in memory, and remain so for a long time. With 100,000 robots in a building, a step
/// with rows in arbitrary order takes 1.5 times as long. The order affects only the speed. It is computed
/// with the default cells, whatever WorldOptions::tile_size_m is.
std::vector<BodyId> World::rows_by_place() const {
  struct Place {
    std::uint64_t key;
    BodyId body;
  };
  const partition::GridGeometry geometry = choose_geometry(state_.spec, state_.types, 0);
  const auto low_bits = [](std::int32_t value, unsigned bits) {
    return static_cast<std::uint64_t>(value) & ((1u << bits) - 1);
  };
  std::vector<Place> places;
  places.reserve(state_.spec.bodies.size());
  for (std::size_t b = 0; b < state_.spec.bodies.size(); ++b) {
    const BodySpec& body = state_.spec.bodies[b];
    if (!state_.types[body.type.index()].runs()) continue;
    if (!state_.spec.starts(BodyId(b))) {  // the body is unborn, and its place of birth is unknown
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

void World::build_rows() {
  state_.rows.resize(state_.spec.bodies.size());
  const std::vector<BodyId> bodies = rows_by_place();
  const auto reserve = [&bodies](auto&... columns) { (columns.reserve(bodies.size()), ...); };
  reserve(state_.bodies, state_.ids, state_.row_types, state_.slots, state_.outline_begins);
  std::vector<std::uint32_t> slots(state_.types.size(), 0);
  std::size_t vertices = 0;
  for (const BodyId body : bodies) {
    const auto t = state_.spec.bodies[body.index()].type.value;
    const BodyType& type = state_.types[t];
    state_.rows[body.index()] = Row(state_.bodies.size());
    state_.bodies.push_back(body);
    state_.ids.push_back(body.value);
    state_.row_types.push_back(t);
    state_.slots.push_back(slots[t]++);
    state_.outline_begins.push_back(vertices);
    vertices += type.outline_vertices.size();
    robots_at_start_ += type.drive.has_value() && state_.spec.starts(body);
  }
  state_.subscribed.resize(rows());
  state_.radii.resize(rows());
  state_.shapes.resize(rows());
  state_.transforms.resize(rows());
  state_.outlines.resize(vertices + partition::EdgeBlock::k_piece,
                         Vec2::Zero());  // padding: rangers copy k_piece vertices at a time
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
  state_.fixed_targets = FixedTargets(state_.spec, [this](BodyId body) { return !row(body).valid(); });
  state_.index = partition::BodyIndex(state_.geometry);
  if (state_.spec.bounds) state_.index.reserve(*state_.spec.bounds);
}

void World::build_tables() {
  using Layout = StateTable::Layout;
  state_.tables.emplace_back(
      "pose", HashGroup::pose, Layout::rows,
      std::vector<StateField>{{"x", Element::f64, 1, "m", "world frame"},
                              {"y", Element::f64, 1, "m", "world frame"},
                              {"z", Element::f64, 1, "m", "world frame"},
                              {"heading", Element::f64, 1, "rad", "counter-clockwise from +x"}},
      state_.bodies);
  state_.tables.emplace_back(
      "velocity", HashGroup::velocity, Layout::rows,
      std::vector<StateField>{{"x", Element::f64, 1, "m/s", "forward, as the drive computed it"},
                              {"y", Element::f64, 1, "m/s", "left"},
                              {"turn", Element::f64, 1, "rad/s", "counter-clockwise"}},
      state_.bodies);
  state_.tables.emplace_back("command", HashGroup::velocity, Layout::rows, command_fields(), state_.bodies,
                             sizeof(Command));
  state_.tables.emplace_back(
      "stall", HashGroup::velocity, Layout::columns,
      std::vector<StateField>{
          {"stalled", Element::u8, 1, "",
           "1: last motion was blocked, 2: last motion would have ended out of bounds, 0: neither"}},
      state_.bodies);

  if (std::ranges::any_of(state_.types, &BodyType::carries)) {
    state_.carrier_table = state_.tables.size();
    state_.tables.emplace_back(
        "carrier", HashGroup::pose, Layout::rows,
        sparse({{"carrier", Element::u32, 1, "", "id of the body that carries this body, plus 1; 0: none"},
                {"joint", Element::u32, 1, "",
                 "joint of the carrier that holds this body, counted from 1; 0: none"},
                {"x", Element::f64, 1, "m", "in the frame of the carrier, displaced by its joint `joint`"},
                {"y", Element::f64, 1, "m", "in the same frame as x"},
                {"z", Element::f64, 1, "m", "in the same frame as x"},
                {"heading", Element::f64, 1, "rad", "in the same frame as x"}}),
        state_.bodies);
  }

  build_lives();
  build_conditions();

  std::vector<std::vector<BodyId>> bodies(state_.types.size());
  for (std::size_t r = 0; r < rows(); ++r) bodies[state_.row_types[r]].push_back(state_.bodies[r]);
  std::size_t effects = 0;
  for (std::size_t t = 0; t < state_.types.size(); ++t) {
    if (bodies[t].empty()) continue;
    for (BodyType::Joint& joint : state_.types[t].joints) {
      joint.table = state_.tables.size();
      state_.tables.emplace_back(
          fmt::format("joint/{}", joint.name), HashGroup::pose, Layout::rows,
          std::vector<StateField>{
              {"x", Element::f64, 1, "m", "relative to the joint's rest pose"},
              {"y", Element::f64, 1, "m", "relative to the joint's rest pose"},
              {"z", Element::f64, 1, "m", "relative to the joint's rest pose"},
              {"heading", Element::f64, 1, "rad", "relative to the joint's rest pose; not wrapped"}},
          bodies[t]);
    }
    if (auto& drive = state_.types[t].drive; drive && drive->localization.kind == Localization::Kind::odom) {
      drive->odometry_table = state_.tables.size();
      state_.tables.emplace_back("odometry", HashGroup::memory, Layout::rows,
                                 std::vector<StateField>{{"x", Element::f64, 1, "m", "estimated position"},
                                                         {"y", Element::f64, 1, "m", "estimated position"},
                                                         {"heading", Element::f64, 1, "rad",
                                                          "estimated heading, counter-clockwise"}},
                                 bodies[t]);
    }
    for (BodyType::Device& sensor : state_.types[t].devices) {
      sensor.table = state_.tables.size();
      // Component names do not contain the name of the type: types only save memory, and two files may divide
      // the same bodies into types differently.
      const std::string component = fmt::format("{}/{}", sensor.kind->name, sensor.name);
      state_.tables.emplace_back(component, HashGroup::sensor, Layout::rows, sensor.prepared.percepts,
                                 bodies[t], sensor.prepared.percept_bytes);
      effects += sensor.prepared.most_effects * bodies[t].size();
      if (sensor.prepared.commands.empty()) continue;
      sensor.command_table = state_.tables.size();
      state_.tables.emplace_back(component + "/command", HashGroup::velocity, Layout::rows,
                                 sensor.prepared.commands, bodies[t], sensor.prepared.command_bytes);
    }
    for (std::size_t c = 0; c < state_.types[t].controllers.size(); ++c) {
      BodyType::Controller& controller = state_.types[t].controllers[c];
      if (controller.kind->memory.empty()) continue;
      controller.table = state_.tables.size();
      state_.tables.emplace_back(fmt::format("{}/{}", controller.kind->name, c), HashGroup::memory,
                                 Layout::rows, controller.kind->memory, bodies[t],
                                 controller.kind->memory_bytes);
    }
  }
  effects_.reserve(effects);
  state_.bind_view();
  movement_.draw_odometry_errors();
  start();
}

void World::start() {
  const Completion completion(*this);
  state_.now.tick = 0;
  beams_ = conflict_rounds_ = 0;
  derive_experiment();  // first: bodies start with the parameters of tick 0
  for (StateTable& table : state_.tables) table.clear();
  for (std::size_t r = 0; r < rows(); ++r) {
    const BodyId body = state_.bodies[r];
    if (state_.spec.starts(body))
      start(Row(r), state_.spec.bodies[body.index()].pose_world_body);
    else
      state_.life(Row(r)).presence = static_cast<std::uint8_t>(Presence::unborn);
  }
  derive();
}

void World::start(Row row, const Pose& p) {
  const BodyType& type = this->type(row);
  for (const BodyType::Device& device : type.devices)
    if (device.kind->start)
      call_kind(*this, {&row, 1}, device,
                [&] { device.kind->start(device.prepared.data, state_.tables[device.table], slot(row)); });
  for (const std::size_t d : type.joint_devices) {
    const BodyType::Device& device = type.devices[d];
    const std::vector<Pose>& joints = device.prepared.joints;
    for (std::size_t n = 0; n < joints.size(); ++n)
      state_.tables[type.joints[static_cast<std::size_t>(device.moves) + n].table].as<Pose>(slot(row)) =
          joints[n];
  }
  for (const BodyType::Controller& controller : type.controllers)
    if (controller.table)
      call_kind(*this, {&row, 1}, controller,
                [&] { controller.kind->start(state_.tables[*controller.table].row(slot(row))); });
  state_.poses()[row.index()] = {p.x + 0.0, p.y + 0.0, p.z + 0.0, wrap_angle(p.heading) + 0.0};
  if (type.drive) start(row, *type.drive);
}

void World::start(Row row, const BodyType::Drive& drive) {
  if (drive.kind->start)
    state_.as<Velocity>(WorldState::k_velocity)[row.index()] = drive.kind->start(drive.data);
  if (!drive.odometry_table) return;
  const Pose& pose = poses()[row.index()];
  const Pose believed = relative_to(drive.localization.origin.value_or(pose), pose);
  state_.as<Odometry>(*drive.odometry_table)[slot(row)] = {believed.x, believed.y, believed.heading};
}

void World::derive() {
  derive_experiment();
  derive_state();
}

void World::derive_state() {
  derive_lives();
  count_impaired();
  movement_.count_stalls();
  links_.derive();
  for (std::size_t r = 0; r < rows(); ++r) derive(Row(r));
  effects_.clear();
  begin_placing();
  placed_before_.clear();
  index_bodies();
}

void World::derive(Row row) {
  movement_.rest(row);
  state_.update_presence(row);
  if (links_.any()) {
    links_.rest_joints(row);
    links_.reshape(row.value);
  }
  state_.update_outlines(row, type(row), Transform(poses()[row.index()]));
}

void World::forget() {
  constexpr std::uint32_t k_junk = 0x5a5a5a5a;
  std::ranges::fill(state_.transforms, Transform{{k_nan, k_nan}, Rotation(SinCos{k_nan, k_nan})});
  std::fill_n(state_.outlines.begin(), state_.outlines.size() - partition::EdgeBlock::k_piece,
              Vec2(k_nan, k_nan));
  std::ranges::fill(state_.radii, k_nan);
  std::ranges::fill(state_.shapes, nullptr);
  std::ranges::fill(state_.not_drawn, std::uint8_t{0x5a});
  std::ranges::fill(next_born_, k_junk);
  for (std::size_t* count : {&robots_, &state_.now.absent, &state_.now.impaired}) *count = k_junk;
  links_.forget();
  std::ranges::fill(grid_lifts_, k_nan);
  experiment_.fault_events.clear();
  experiment_.due = 0;
  state_.index = partition::BodyIndex(state_.geometry);
  movement_.forget();
  placed_before_.assign(1, {Row(0), k_nowhere});
  derive();
  movement_.forget_motions();
}

void World::build_ray_grid(Diagnostics& diagnostics) {
  std::vector<partition::MovingOutline> outlines;
  for (std::uint32_t r = 0; r < rows(); ++r)
    for (const RayOutline& outline : type(Row(r)).outlines)
      outlines.push_back({r, static_cast<std::uint32_t>(state_.outline_begins[r]) + outline.first,
                          outline.count, outline.z, outline.ranger_return});
  if (links_.any()) grid_lifts_.resize(outlines.size());
  try {
    state_.ray_grid = std::make_unique<partition::RayGrid>(state_.scene.solids(), std::move(outlines),
                                                           state_.outlines, state_.spec.resolution_m);
  } catch (const std::length_error& fault) {
    diagnostics.error(state_.spec.resolution_where, fmt::format("the grid ray engine: {}", fault.what()));
    diagnostics.throw_if_errors();
  }
  state_.bind_view();
  redraw_ray_grid();
}

void World::redraw_ray_grid() {
  std::size_t o = 0;
  for (std::uint32_t r = 0; !grid_lifts_.empty() && r < rows(); ++r)
    for (const RayOutline& outline : type(Row(r)).outlines)
      if (outline.count > 0) grid_lifts_[o++] = lift(Row(r), outline.joint);
  partition::RayGrid::Linked linked{.lifts = grid_lifts_, .groups = {}, .absent = {}};
  if (state_.now.carried > 0) linked.groups = state_.roots;
  if (state_.now.absent > 0) linked.absent = state_.not_drawn;
  state_.ray_grid->redraw(state_.outlines, poses(), parallel_, linked);
}

/// Reports bodies that overlap at tick 0. Thousands of bodies at one place are millions of pairs, and
/// counting them all would take a minute. The search therefore ends once it has found more than
/// k_most_counted pairs. The number of pairs found by then does not depend on the number of threads.
void World::report_overlaps(Diagnostics& diagnostics) {
  constexpr std::size_t k_most_counted = 10'000;
  constexpr std::size_t k_most_listed = 100;
  constexpr std::size_t k_bodies = 256;  // per task
  constexpr std::size_t k_tasks = 64;    // per parallel loop
  for (const Row row : state_.rows)
    if (row.valid() && !state_.shapes[row.index()]->empty() &&
        state_.shapes[row.index()]->z.min + poses()[row.index()].z < 0)
      diagnostics.warning_once(state_.spec.bodies[body(row).index()].where,
                               "a body extends below the floor (z = 0); the floor itself is not an obstacle");

  const std::size_t most = diagnostics.thorough() ? k_most_listed : 1;
  using Pair = std::pair<BodyId, BodyId>;
  struct Found {  // the result of one task
    std::size_t pairs = 0;
    std::vector<Pair> listed;    // the first pairs
    std::vector<BodyId> others;  // scratch memory: bodies near the present one
    void add(BodyId body, BodyId other, std::size_t most_listed) {
      ++pairs;
      if (listed.size() < most_listed) listed.emplace_back(body, other);
    }
  };
  const auto look_at = [&](std::size_t b, Found& found) {
    const Row row = state_.rows[b];
    if (!row.valid() || state_.shapes[row.index()]->empty()) return;
    const auto z_of = [&](Row of) { return poses()[of.index()].z; };
    const partition::ObstacleShape& shape = *state_.shapes[row.index()];
    const ZInterval z = shape.z.shifted(z_of(row));
    const partition::PlacedShape placed(shape, transform(row), z_of(row));
    // Static bodies first, then the others by id: the order must not depend on the grid.
    if (state_.scene.has_obstacles())
      for (const BodyId wall : state_.scene.overlapping(shape, poses()[row.index()]))
        found.add(BodyId(b), wall, most);
    found.others.clear();
    state_.index.for_each_near(Box::around(transform(row).position, shape.radius),
                               [&](const partition::BodyCircle& other) {
                                 const partition::ObstacleShape& theirs = *state_.shapes[other.row];
                                 if (state_.ids[other.row] > b && !theirs.empty() &&
                                     z.overlaps(theirs.z.shifted(z_of(Row(other.row)))))
                                   found.others.push_back(state_.bodies[other.row]);
                               });
    std::ranges::sort(found.others);
    for (const BodyId other : found.others) {
      if (found.pairs > k_most_counted) return;
      const Row r = state_.rows[other.index()];
      if (overlap(placed, partition::PlacedShape(*state_.shapes[r.index()], transform(r), z_of(r))))
        found.add(BodyId(b), other, most);
    }
  };
  std::size_t pairs = 0;
  std::vector<Pair> listed;
  for (std::size_t first = 0; first < state_.rows.size() && pairs <= k_most_counted;
       first += k_bodies * k_tasks) {
    const std::size_t end = std::min(state_.rows.size(), first + k_bodies * k_tasks);
    std::vector<Found> tasks((end - first + k_bodies - 1) / k_bodies);
    parallel_.for_each(tasks.size(), [&](std::size_t t) {
      const std::size_t from = first + t * k_bodies;
      for (std::size_t b = from; b < std::min(end, from + k_bodies); ++b) {
        if (tasks[t].pairs > k_most_counted) return;
        look_at(b, tasks[t]);
      }
    });
    for (const Found& found : tasks) {
      pairs += found.pairs;
      for (std::size_t i = 0; i < found.listed.size() && listed.size() < most; ++i)
        listed.push_back(found.listed[i]);
    }
  }
  if (pairs == 0) return;
  const auto where = [this](BodyId body) { return state_.spec.bodies[body.index()].where; };
  const bool are_more = pairs > k_most_counted;  // the search ended early
  const auto count_of = [&](std::size_t count, std::string_view what) {
    return are_more     ? fmt::format("more than {} {}pairs of bodies overlap", count, what)
           : count == 1 ? fmt::format("1 {}pair of bodies overlaps", what)
                        : fmt::format("{} {}pairs of bodies overlap", count, what);
  };
  const std::size_t counted = std::min(pairs, k_most_counted);
  if (!diagnostics.thorough()) {
    const auto [first, second] = listed.front();
    diagnostics.warning(
        where(first),
        fmt::format("{} at the start{} \"{}\" and \"{}\"; bodies that overlap may move apart, but "
                    "not closer",
                    count_of(counted, ""), counted == 1 ? ":" : ", for example", state_.spec.name(first),
                    state_.spec.name(second)));
    return;
  }
  for (const auto& [first, second] : listed)
    diagnostics.warning(
        where(first),
        fmt::format("\"{}\" {} \"{}\" at the start", state_.spec.name(first),
                    row(second).valid() ? "overlaps" : "overlaps the static body", state_.spec.name(second)));
  if (const std::size_t more = counted - listed.size(); more > 0)
    diagnostics.warning(where(listed.back().first), fmt::format("{} at the start", count_of(more, "more ")));
}

BodyId World::find(std::string_view name) const {
  const std::optional<Name> wanted = state_.spec.names.find(name);
  if (!wanted) return {};
  std::call_once(names_made_, [this] {
    names_.reserve(state_.spec.bodies.size() + state_.spec.aliases.size());
    for (const NamedBody& alias : state_.spec.aliases) names_.set(alias.name, alias.body);
    for (std::size_t b = 0; b < state_.spec.bodies.size(); ++b)
      names_.set(state_.spec.bodies[b].name, BodyId(b));
  });
  return names_.find(*wanted);
}

Estimates World::estimates(const BodyType& type) const {
  if (!type.drive) return {&k_true_pose, poses(), {}};
  Estimates estimates{&type.drive->localization, poses(), {}};
  if (type.drive->odometry_table) estimates.odometries = state_.as<Odometry>(*type.drive->odometry_table);
  return estimates;
}

void World::set_estimate(Row row, const Pose& pose) {
  require_whole();
  const auto& drive = type(row).drive;
  if (!drive || !drive->odometry_table)
    throw std::logic_error(
        fmt::format("\"{}\" has no odometry: its estimated pose is its true pose and cannot be set",
                    state_.spec.name(body(row))));
  if (!is_finite(pose)) throw std::invalid_argument("the numbers of an estimated pose must be finite");
  touch();
  state_.as<Odometry>(*drive->odometry_table)[slot(row)] = {pose.x + 0.0, pose.y + 0.0,
                                                            wrap_angle(pose.heading) + 0.0};
}

void World::set_poses(std::span<const Placed> placed) {
  require_whole();
  restore_fp_environment();  // a library may have changed it, see step()
  const Box inside = state_.bounds();
  for (const Placed& place : placed) {
    const Pose& p = place.pose;
    if (!is_there(place.row))
      throw std::invalid_argument(
          fmt::format("\"{}\" cannot be placed: it is not in the world", state_.spec.name(body(place.row))));
    if (!is_finite(p) || !inside.contains(p.position()))
      throw std::invalid_argument(
          fmt::format("\"{}\" cannot be placed at x {}, y {}, z {} (m), heading {} (rad): {}",
                      state_.spec.name(body(place.row)), p.x, p.y, p.z, p.heading,
                      is_finite(p) ? "outside the world's bounds" : "the numbers must be finite"));
    if (const std::optional<BodyId> by = carrier(place.row))
      throw std::invalid_argument(fmt::format("\"{}\" cannot be placed: \"{}\" carries it",
                                              state_.spec.name(body(place.row)), state_.spec.name(*by)));
  }
  touch();
  for (const auto& [row, p] : placed) {
    const Pose pose{p.x + 0.0, p.y + 0.0, p.z + 0.0, wrap_angle(p.heading) + 0.0};
    state_.poses()[row.index()] = pose;
    state_.stalls()[row.index()] = WorldState::k_free;
    movement_.rest(row);
    state_.update_outlines(row, type(row), Transform(pose));
  }
  if (links_.any()) links_.carry();
  for (const Placed& place : placed) remember_placed(place.row);
  for (std::size_t r = 0; state_.now.carried > 0 && r < rows(); ++r)
    if (carrier(Row(r))) remember_placed(Row(r));
  movement_.count_stalls();
  index_bodies();
}

void World::remember_placed(Row row) {
  placed_at_.resize(rows());
  std::uint32_t& at = placed_at_[row.index()];
  if (at == 0) {
    placed_.push_back({row, {}});
    at = static_cast<std::uint32_t>(placed_.size());
  }
  placed_[at - 1].pose = poses()[row.index()];
}

/// Makes the poses that were set since the last step placed_before_, and clears placed_. Called when a step
/// begins.
void World::begin_placing() {
  for (const Placed& place : placed_) placed_at_[place.row.index()] = 0;
  placed_before_.swap(placed_);
  placed_.clear();
}

bool World::is_free(Row row, const Pose& pose) const {
  require_whole();
  if (!is_finite(pose) || !state_.bounds().contains(pose.position())) return false;
  const partition::ObstacleShape& shape = is_there(row) ? *state_.shapes[row.index()] : type(row).obstacle;
  if (shape.empty()) return true;
  if (state_.scene.has_obstacles() && state_.scene.blocked(shape, pose)) return false;
  bool free = true;
  const auto look_at = [&](std::uint32_t r) {
    if (!free || r == row.index() || state_.shapes[r]->empty()) return;
    // The body with the lower id is the first argument, as in conflict resolution, so that both agree.
    free = state_.ids[row.index()] < state_.ids[r] ? !overlap(shape, pose, *state_.shapes[r], poses()[r])
                                                   : !overlap(*state_.shapes[r], poses()[r], shape, pose);
  };
  state_.index.for_each_near(Box::around(pose.position(), shape.radius),
                             [&](const partition::BodyCircle& other) { look_at(other.row); });
  for (const Row other : newborn_) look_at(other.value);
  return free;
}

bool World::stalled(Row row) const { return state_.stalls()[row.index()] != WorldState::k_free; }
bool World::is_out_of_bounds(Row row) const {
  return state_.stalls()[row.index()] == WorldState::k_out_of_bounds;
}

void World::throw_half_made() const {
  throw std::logic_error(fmt::format(
      "the step to tick {} failed and left an incomplete state: call reset() before anything else",
      state_.now.tick));
}

void World::reset() {
  restore_fp_environment();  // a library may have changed it, see step()
  if (replica_) replica_->reset();
  forget_settings();
  start();
}

void World::restart(std::uint64_t seed, std::span<const BodySpec> bodies, const Registry& registry) {
  restore_fp_environment();  // a library may have changed it, see step()
  if (replica_) replica_->restart(seed, bodies);
  bool has_scene_changed = false;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    has_scene_changed =
        has_scene_changed ||
        (!state_.rows[b].valid() && bodies[b].pose_world_body != state_.spec.bodies[b].pose_world_body);
  state_.spec.seed = seed;
  std::ranges::copy(bodies, state_.spec.bodies.begin());
  Diagnostics diagnostics(state_.spec.files);  // stays empty: the constructor has made the same checks
  if (has_scene_changed) build_scene();
  movement_.draw_odometry_errors();
  build_faults(registry, diagnostics);
  forget_settings();
  start();
  if (has_scene_changed && state_.ray_grid) build_ray_grid(diagnostics);
}

bool World::restore(std::uint64_t tick, const Counters& counters, std::uint64_t state_hash,
                    const Fill& fill) {
  restore_fp_environment();  // a library may have changed it, see step()
  is_half_made_ = false;
  if (replica_) replica_->replace();
  for (StateTable& table : state_.tables) table.clear();
  try {
    fill(state_.tables);
  } catch (...) {
    start();
    throw;
  }
  constexpr double k_reach = 2e6;  // m: beyond any bounds, and cell numbers still fit 32 bits
  const auto stands_somewhere = [](const Pose& pose) {
    return std::abs(pose.x) < k_reach && std::abs(pose.y) < k_reach && std::isfinite(pose.z) &&
           std::isfinite(pose.heading);
  };
  const auto has_mode = [](const Command& command) {
    return static_cast<std::size_t>(command.mode) < k_control_modes;
  };
  if (hashes().state != state_hash || !std::ranges::all_of(poses(), stands_somewhere) ||
      !std::ranges::all_of(commands(), has_mode) || !lives_hold(tick) || !conditions_hold() ||
      !links_.hold()) {
    start();
    return false;
  }
  state_.now.tick = tick;
  beams_ = counters.beams;
  conflict_rounds_ = counters.conflict_rounds;
  derive();
  return true;
}

std::vector<BodyId> World::subscribed() const {
  std::vector<BodyId> bodies;
  for (std::size_t b = 0; b < state_.rows.size(); ++b)
    if (const Row r = state_.rows[b]; r.valid() && state_.subscribed[r.index()] != 0)
      bodies.push_back(BodyId(b));
  return bodies;
}

std::uint64_t World::hash(const StateTable& table) {
  require_whole();
  gather();
  constexpr std::size_t k_block = 1024;  // rows per task
  const std::size_t blocks = (table.rows() + k_block - 1) / k_block;
  std::atomic<std::uint64_t> sum = 0;
  parallel_.for_each(blocks, [&](std::size_t b) {
    sum.fetch_add(table.hash_rows(b * k_block, std::min(table.rows(), (b + 1) * k_block)),
                  std::memory_order_relaxed);
  });
  return sum;
}

Hashes World::hashes() {
  require_whole();
  if (replica_)
    if (const std::optional<Hashes> sum = replica_->hashes()) return *sum;
  constexpr std::size_t k_block = 512;  // rows per task, in all tables: a loop per table would cost more
  std::size_t rows = 0;
  for (const StateTable& table : state_.tables) rows = std::max(rows, table.rows());
  std::array<std::atomic<std::uint64_t>, k_hash_groups> sums{};
  parallel_.for_each((rows + k_block - 1) / k_block, [&](std::size_t b) {
    for (const StateTable& table : state_.tables)
      if (const std::size_t first = b * k_block; first < table.rows())
        sums[static_cast<std::size_t>(table.group())].fetch_add(
            table.hash_rows(first, std::min(table.rows(), first + k_block)), std::memory_order_relaxed);
  });
  Hashes hashes;
  for (std::size_t g = 0; g < k_hash_groups; ++g) hashes.state += hashes.groups[g] = sums[g];
  return hashes;
}

double World::mean_displacement() const {
  require_whole();
  ExactSum sum;
  for (std::size_t r = 0; r < rows(); ++r)
    if (type(Row(r)).drive && is_there(Row(r))) sum.add((transform(Row(r)).position - origin(Row(r))).norm());
  return robots_ > 0 ? sum.value() / static_cast<double>(robots_) : 0;
}

/// Returns the shapes and the radius of the body of `row` as they are drawn, with its joints where they are
/// now. If `row` is not valid, the joints are at rest. `t`: index of the body's type.
FrameType World::look_of(std::size_t t, Row row) const {
  FrameType look{.mobile = state_.types[t].drive.has_value(),
                 .radius = state_.types[t].radius,
                 .name = state_.spec.types[t].name};
  for (const PartSpec& part : state_.spec.types[t].parts)
    for (const Solid& solid : part.solids) {
      look.shapes.push_back({solid, part.color});
      if (part.joint == k_rigid || !row.valid()) continue;
      const Mount& now = state_.mounts(row)[static_cast<std::size_t>(part.joint)];
      Solid& moved = look.shapes.back().solid;
      for (Ring& ring : moved.contours)
        for (Vec2& point : ring) point = now.transform * point;
      moved.z = moved.z.shifted(now.z);
    }
  if (row.valid()) look.radius = state_.radii[row.index()];
  return look;
}

FrameScene World::frame_scene() const {
  FrameScene scene;
  scene.title = state_.spec.title;
  for (std::size_t t = 0; t < state_.types.size(); ++t) scene.types.push_back(look_of(t, Row()));
  scene.bounds = state_.scene.bounds();
  scene.tile_m = state_.geometry.tile_m();
  scene.cell_m = state_.geometry.cell_m;
  scene.limits = state_.spec.bounds;
  for (std::size_t b = 0; b < state_.spec.bodies.size(); ++b) {
    const BodySpec& body = state_.spec.bodies[b];
    if (!state_.rows[b].valid())
      scene.fixed.push_back(
          {body.type.value, body.pose_world_body, body.color, false, static_cast<std::uint32_t>(b)});
    else if (state_.spec.starts(BodyId(b)))
      scene.bounds.extend(
          Box::around(body.pose_world_body.position(), state_.types[body.type.index()].radius));
  }
  return scene;
}

Frame World::frame() const {
  require_whole();
  gather();  // devices that are drawn read their state
  Frame frame{time_s(), state_.now.tick, {}};
  frame.mobile.reserve(rows());
  for (std::size_t b = 0; b < state_.rows.size(); ++b) {
    const BodySpec& body = state_.spec.bodies[b];
    const Row r = state_.rows[b];
    if (!r.valid() || !is_there(r)) continue;
    const Color color = shown_color(state_.view, r, 0).value_or(body.color);
    frame.mobile.push_back(
        {body.type.value, poses()[r.index()], color, stalled(r), static_cast<std::uint32_t>(b)});
    const auto has_moved = [](const Mount& joint) {
      return joint.transform.position != Vec2::Zero() || joint.z != 0 || joint.heading != 0;
    };
    if (type(r).joints.empty() || std::ranges::none_of(state_.mounts(r), has_moved)) continue;
    frame.mobile.back().type = static_cast<std::uint32_t>(state_.types.size() + frame.types.size());
    frame.types.push_back(look_of(body.type.value, r));
  }
  return frame;
}

}  // namespace troupe::engine
