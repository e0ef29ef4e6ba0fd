#include "troupe/frame_data.hpp"

#include "base/diagnostics.hpp"
#include "engine/observing/sensed_rows.hpp"
#include "engine/state/kind_calls.hpp"
#include "engine/world/state_tables.hpp"
#include "troupe/value_names.hpp"
#include "worldio/results/recording_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <span>
#include <string_view>

namespace troupe {
namespace {

using engine::BodyType;
using engine::Frame;
using engine::FrameRanger;
using engine::FrameTransducer;
using engine::StateField;
using engine::StateTable;
using engine::World;

/// Returns for each body id the index of the body in Frame::mobile, or 2^32 - 1 if the frame does not contain
/// the body.
std::vector<std::uint32_t> places_of(const World& world, const Frame& frame) {
  std::vector<std::uint32_t> places(world.spec().bodies.size(), std::numeric_limits<std::uint32_t>::max());
  for (std::size_t i = 0; i < frame.mobile.size(); ++i)
    places[frame.mobile[i].id] = static_cast<std::uint32_t>(i);
  return places;
}

bool has_name(const StateTable& table, std::string_view name) {
  return engine::selects(name, table.component());
}

std::set<std::string> value_names(const World& world) {
  std::set<std::string> names;
  const auto add = [&names](const StateTable& table) {
    for (const StateField& field : table.fields())
      names.insert(fmt::format("{}.{}", engine::given_name(table.component()), field.name));
  };
  std::ranges::for_each(world.tables(), add);
  std::ranges::for_each(engine::unused_tables(world.state()), add);
  return names;
}

/// Calls visit(index in Frame::mobile, row, device) for every device of every body of the frame.
template <class Visit>
void for_each_device(const World& world, const Frame& frame, Visit&& visit) {
  for (std::size_t i = 0; i < frame.mobile.size(); ++i) {
    const Row row = world.view().row(BodyId(std::size_t{frame.mobile[i].id}));
    for (const BodyType::Device& device : world.view().type(row).devices)
      visit(static_cast<std::uint32_t>(i), row, device);
  }
}

/// Returns the DeviceSpec from which a device of a body was made.
const engine::DeviceSpec& spec_of(const World& world, BodyId body, const BodyType::Device& device) {
  const std::uint32_t type = world.spec().bodies[body.index()].type.value;
  const auto d = static_cast<std::size_t>(&device - world.view().types()[type].devices.data());
  return world.spec().types[type].devices[d];
}

/// Returns the transducers of a device, in the order of its readings; empty if it has none. spec: the
/// DeviceSpec of the device.
std::vector<FrameTransducer> transducers_of(const engine::DeviceSpec& spec, const BodyType::Device& device) {
  std::vector<FrameTransducer> transducers;
  for (const engine::Transducer& t : device.prepared.transducers)
    transducers.push_back(
        {compose(spec.pose_body_device, t.pose_sensor_transducer), t.range_max, t.fov, t.first, t.samples});
  return transducers;
}

/// A device with transducers, that is, a ranger: the indices of its type and of the device in the type, and
/// the number of its readings.
struct Ranger {
  std::uint32_t type = 0;
  std::size_t device = 0;
  std::size_t readings = 0;
};

/// Returns all rangers, ordered by type and then by device.
std::vector<Ranger> rangers_of(const World& world) {
  std::vector<Ranger> rangers;
  for (std::size_t t = 0; t < world.view().types().size(); ++t) {
    for (std::size_t d = 0; d < world.view().types()[t].devices.size(); ++d) {
      Ranger ranger{static_cast<std::uint32_t>(t), d, 0};
      for (const engine::Transducer& transducer : world.view().types()[t].devices[d].prepared.transducers)
        ranger.readings += transducer.samples;
      if (ranger.readings > 0) rangers.push_back(ranger);
    }
  }
  return rangers;
}

/// Returns the motion, in the body frame, that takes a device from its pose with joints at rest to its
/// present pose.
Pose moved_by_joints(const World& world, Row row, const BodyType::Device& device) {
  if (device.joint == engine::k_rigid) return {};
  return compose(inverse(engine::Mount(world.view().poses()[row.index()])),
                 world.view().mount(row, device.joint))
      .pose();
}

}  // namespace

Result<ChosenValue> find_value(const World& world, const std::string& name) {
  const std::vector<StateTable> unused = engine::unused_tables(world.state());
  for (ChosenValue& reading : readings_of(name)) {
    bool is_resting = true;
    for (const StateTable& table : world.tables()) {
      const StateField* const field = engine::field_named(table.fields(), reading.field);
      if (!field || !has_name(table, reading.component)) continue;
      if (reading.column >= field->columns) return no_such_column(reading, field->columns);
      reading.text = with_unit(name, field->unit);
      is_resting = is_resting && engine::SensedRows(world.view(), table).none_exists(world.view());
    }
    if (!reading.text.empty()) {
      if (is_resting) reading.text += ": the sensor does not run";
      return reading;
    }
    for (const StateTable& table : unused) {
      const StateField* const field = engine::field_named(table.fields(), reading.field);
      if (!field || !has_name(table, reading.component)) continue;
      if (reading.column >= field->columns) return no_such_column(reading, field->columns);
      reading.text = fmt::format("{}: no robot has the value", with_unit(name, field->unit));
      return reading;
    }
  }
  if (const auto right = worldio::name_for_path(world, name))
    return Error{worldio::wrong_spelling("value", name, *right)};
  const std::set<std::string> known = value_names(world);
  return Error{unknown_name("value", name, {known.begin(), known.end()})};
}

std::vector<double> values_of(const World& world, const ChosenValue& value, const Frame& frame) {
  std::vector<double> values(frame.mobile.size(), std::numeric_limits<double>::quiet_NaN());
  const std::vector<std::uint32_t> places = places_of(world, frame);
  for (const StateTable& table : world.tables()) {
    const StateField* const field = engine::field_named(table.fields(), value.field);
    if (!field || !has_name(table, value.component) || value.column >= field->columns) continue;
    const auto index = static_cast<std::size_t>(field - table.fields().data());
    const engine::SensedRows readings(world.view(), table);
    for (std::size_t row = 0; row < table.rows(); ++row) {
      const std::uint32_t place = places[table.ids()[row].index()];
      if (place < values.size() && readings.exist(world.view(), row))
        values[place] = table.number(row, index, value.column);
    }
  }
  return values;
}

std::vector<FrameRanger> frame_rangers(const World& world) {
  std::vector<FrameRanger> rangers;
  for (const Ranger& ranger : rangers_of(world))
    rangers.push_back({ranger.type, ranger.readings,
                       transducers_of(world.spec().types[ranger.type].devices[ranger.device],
                                      world.view().types()[ranger.type].devices[ranger.device])});
  return rangers;
}

void add_scans(const World& world, Frame& frame) {
  if (world.tick() == 0) return;  // no sensor has run yet
  const std::vector<Ranger> rangers = rangers_of(world);
  for (std::size_t i = 0; i < frame.mobile.size(); ++i) {
    const Row row = world.view().row(BodyId(std::size_t{frame.mobile[i].id}));
    const std::uint32_t type = world.spec().bodies[frame.mobile[i].id].type.value;
    for (auto ranger = std::ranges::lower_bound(rangers, type, {}, &Ranger::type);
         ranger != rangers.end() && ranger->type == type; ++ranger) {
      const BodyType::Device& device = world.view().types()[type].devices[ranger->device];
      if (!world.view().runs(row, device)) continue;
      const std::span<const float> ranges =
          world.tables()[device.table].cell<float>(world.view().slot(row), 0);
      frame.scans.push_back({static_cast<std::uint32_t>(i),
                             static_cast<std::uint32_t>(ranger - rangers.begin()), frame.ranges.size(),
                             moved_by_joints(world, row, device)});
      frame.ranges.insert(frame.ranges.end(), ranges.begin(),
                          ranges.begin() + static_cast<std::ptrdiff_t>(ranger->readings));
    }
  }
}

void add_layer(const World& world, engine::FrameLayer layer, Frame& frame) {
  for_each_device(world, frame, [&](std::uint32_t body, Row row, const BodyType::Device& device) {
    const engine::DeviceKind& kind = *device.kind;
    if (kind.layer != layer || !kind.draw) return;
    if (kind.is_sensor() && (world.tick() == 0 || !world.view().runs(row, device))) return;
    const engine::DeviceSpec& spec = spec_of(world, world.view().body(row), device);
    engine::call_hook(world.view(), row, device, [&] {
      kind.draw({world.view(), device.prepared.data, world.tables()[device.table], world.view().slot(row),
                 body, compose(world.view().mount(row, device.joint), spec.pose_body_device)},
                frame);
    });
  });
}

void add_links(const World& world, Frame& frame) {
  if (world.view().counts().carried == 0) return;
  for (const engine::FrameBody& body : frame.mobile) {
    const auto carrier = world.view().carrier(world.view().row(BodyId(std::size_t{body.id})));
    if (!carrier) continue;
    const Pose& to = body.pose_world_body;
    const Pose from = world.view().pose(*carrier);
    frame.links.push_back({engine::FrameTie::Kind::carries, {from.x, from.y, from.z}, {to.x, to.y, to.z}});
  }
}

void add_charges(const World& world, Frame& frame) {
  frame.charges.assign(frame.mobile.size(), std::numeric_limits<double>::quiet_NaN());
  for_each_device(world, frame, [&](std::uint32_t body, Row row, const BodyType::Device& device) {
    double& charge = frame.charges[body];
    if (device.kind->energy && std::isnan(charge))  // the first of several devices
      charge = engine::energy_of(world.view(), row, device).proportion_remaining();
  });
}

void add_names(const World& world, Frame& frame) {
  frame.names.reserve(frame.mobile.size());
  for (const engine::FrameBody& body : frame.mobile)
    frame.names.push_back(world.spec().name(BodyId(std::size_t{body.id})));
}

}  // namespace troupe
