#include "troupe/frame_data.hpp"

#include "base/diagnostics.hpp"
#include "models/devices/gripper.hpp"
#include "models/devices/power.hpp"
#include "sensors/blobfinder.hpp"
#include "sensors/fiducial.hpp"
#include "troupe/value_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <utility>

namespace troupe {
namespace {

using engine::BodyType;
using engine::Element;
using engine::Frame;
using engine::FrameRanger;
using engine::FrameTransducer;
using engine::StateField;
using engine::StateTable;
using engine::World;

/// The place of each body in Frame::mobile, by its id.
std::vector<std::uint32_t> places_of(const World& world, const Frame& frame) {
  std::vector<std::uint32_t> places(world.spec().bodies.size(), std::numeric_limits<std::uint32_t>::max());
  for (std::size_t i = 0; i < frame.mobile.size(); ++i)
    places[frame.mobile[i].id] = static_cast<std::uint32_t>(i);
  return places;
}

/// `ranger` for `ranger/ir`.
std::string_view kind_of(std::string_view component) { return component.substr(0, component.find('/')); }

bool has_name(const StateTable& table, std::string_view name) {
  return table.component() == name || kind_of(table.component()) == name;
}

const StateField* field_of(const StateTable& table, std::string_view name) {
  const auto found = std::ranges::find(table.fields(), name, &StateField::name);
  return found == table.fields().end() ? nullptr : &*found;
}

double number_of(const StateTable& table, std::size_t row, std::size_t field, std::size_t column) {
  const auto as = [&]<class T>(T) { return static_cast<double>(table.cell<T>(row, field)[column]); };
  switch (table.fields()[field].element) {
    case Element::f64: return as(double{});
    case Element::f32: return as(float{});
    case Element::i64: return as(std::int64_t{});
    case Element::i32: return as(std::int32_t{});
    case Element::u64: return as(std::uint64_t{});
    case Element::u32: return as(std::uint32_t{});
    case Element::u8: return as(std::uint8_t{});
  }
  return std::numeric_limits<double>::quiet_NaN();
}

std::vector<std::string> value_names(const World& world) {
  std::vector<std::string> names;
  for (const StateTable& table : world.tables()) {
    for (const StateField& field : table.fields()) {
      std::string name = fmt::format("{}.{}", table.component(), field.name);
      if (std::ranges::find(names, name) == names.end()) names.push_back(std::move(name));
    }
  }
  return names;
}

/// visit(place among the bodies, row, device, its spec) for every device of a kind that a body in the picture
/// carries.
template <class Visit>
void for_each_device(const World& world, const Frame& frame, std::string_view kind, Visit&& visit) {
  for (std::size_t i = 0; i < frame.mobile.size(); ++i) {
    const Row row = world.row(BodyId(std::size_t{frame.mobile[i].id}));
    const BodyType& type = world.type(row);
    for (std::size_t d = 0; d < type.devices.size(); ++d)
      if (type.devices[d].kind->name == kind)
        visit(static_cast<std::uint32_t>(i), row, type.devices[d],
              world.spec().types[world.spec().bodies[frame.mobile[i].id].type.index()].devices[d]);
  }
}

/// Where a device is now, world frame.
Pose placed(const World& world, Row row, const BodyType::Device& device, const engine::DeviceSpec& spec) {
  return compose(world.mount(row, device.joint), spec.pose_body_sensor);
}

Eigen::Vector3d at(const Pose& frame, double x, double y, double z) {
  const Vec2 p = Transform(frame) * Vec2(x, y);
  return {p.x(), p.y(), frame.z + z};
}

/// The transducers of a device, where its kind has such; in the order of its readings.
std::vector<FrameTransducer> transducers_of(const engine::DeviceSpec& spec, const BodyType::Device& device) {
  const engine::FieldTable& table = device.kind->params;
  const int place = table.find("transducers");
  if (place < 0 || device.prepared.bearings.empty()) return {};
  const engine::Field& field = table.fields[static_cast<std::size_t>(place)];
  for (const std::string_view name : {"pose", "samples", "range_max", "fov"})
    if (field.record == nullptr || field.record->find(name) < 0) return {};  // a plug-in's, of another sense
  std::vector<FrameTransducer> transducers;
  std::size_t first = 0;
  for (const engine::Record& record : spec.params[static_cast<std::size_t>(place)].records()) {
    const auto value = [&](std::string_view name) { return engine::get(*field.record, record, name); };
    const engine::Record pose = value("pose").records().front();
    const auto number = [&](std::string_view name) {
      return engine::get(engine::pose_fields(), pose, name).number();
    };
    const Pose pose_sensor{number("x"), number("y"), number("z"), number("heading")};
    const auto samples = static_cast<std::size_t>(value("samples").integer());
    transducers.push_back({compose(spec.pose_body_sensor, pose_sensor), value("range_max").number(),
                           value("fov").number(), first, samples});
    first += samples;
  }
  return transducers;
}

/// A device that has transducers.
struct Ranger {
  std::uint32_t type = 0;
  std::size_t device = 0;
  std::size_t readings = 0;
};

/// By type, then by device.
std::vector<Ranger> rangers_of(const World& world) {
  std::vector<Ranger> rangers;
  for (std::size_t t = 0; t < world.types().size(); ++t) {
    for (std::size_t d = 0; d < world.types()[t].devices.size(); ++d) {
      Ranger ranger{static_cast<std::uint32_t>(t), d, 0};
      for (const FrameTransducer& transducer :
           transducers_of(world.spec().types[t].devices[d], world.types()[t].devices[d]))
        ranger.readings += transducer.samples;
      if (ranger.readings > 0) rangers.push_back(ranger);
    }
  }
  return rangers;
}

/// Takes what is described on a joint at rest to where that has carried it, in the body's frame.
Pose moved_by_joints(const World& world, Row row, const BodyType::Device& device) {
  if (device.joint == engine::k_rigid) return {};
  return compose(inverse(engine::Mount(world.poses()[row.index()])), world.mount(row, device.joint)).pose();
}

}  // namespace

std::optional<ChosenValue> find_value(const World& world, const std::string& name, std::string& fault) {
  for (ChosenValue& reading : readings_of(name)) {
    for (const StateTable& table : world.tables()) {
      const StateField* const field = field_of(table, reading.field);
      if (!field || !has_name(table, reading.component)) continue;
      if (reading.column >= field->columns) {
        fault = columns_fault(reading, field->columns);
        return std::nullopt;
      }
      reading.text = with_unit(name, field->unit);
      return reading;
    }
  }
  if (!fault.empty()) return std::nullopt;
  const std::vector<std::string> known = value_names(world);
  fault = unknown_name("value", name, {known.begin(), known.end()});
  return std::nullopt;
}

std::vector<double> values_of(const World& world, const ChosenValue& value, const Frame& frame) {
  std::vector<double> values(frame.mobile.size(), std::numeric_limits<double>::quiet_NaN());
  const std::vector<std::uint32_t> places = places_of(world, frame);
  for (const StateTable& table : world.tables()) {
    const StateField* const field = field_of(table, value.field);
    if (!field || !has_name(table, value.component) || value.column >= field->columns) continue;
    const auto index = static_cast<std::size_t>(field - table.fields().data());
    for (std::size_t row = 0; row < table.rows(); ++row) {
      const std::uint32_t place = places[table.ids()[row].index()];
      if (place < values.size()) values[place] = number_of(table, row, index, value.column);
    }
  }
  return values;
}

std::vector<FrameRanger> frame_rangers(const World& world) {
  std::vector<FrameRanger> rangers;
  for (const Ranger& ranger : rangers_of(world))
    rangers.push_back({ranger.type, ranger.readings,
                       transducers_of(world.spec().types[ranger.type].devices[ranger.device],
                                      world.types()[ranger.type].devices[ranger.device])});
  return rangers;
}

void add_scans(const World& world, Frame& frame) {
  if (world.tick() == 0) return;  // nobody has looked yet
  const std::vector<Ranger> rangers = rangers_of(world);
  for (std::size_t i = 0; i < frame.mobile.size(); ++i) {
    const Row row = world.row(BodyId(std::size_t{frame.mobile[i].id}));
    const std::uint32_t type = world.spec().bodies[frame.mobile[i].id].type.value;
    for (auto ranger = std::ranges::lower_bound(rangers, type, {}, &Ranger::type);
         ranger != rangers.end() && ranger->type == type; ++ranger) {
      const BodyType::Device& device = world.types()[type].devices[ranger->device];
      if (!world.runs(row, device)) continue;
      const std::span<const float> ranges = world.percepts(device).cell<float>(world.slot(row), 0);
      frame.scans.push_back({static_cast<std::uint32_t>(i),
                             static_cast<std::uint32_t>(ranger - rangers.begin()), frame.ranges.size(),
                             moved_by_joints(world, row, device)});
      frame.ranges.insert(frame.ranges.end(), ranges.begin(),
                          ranges.begin() + static_cast<std::ptrdiff_t>(ranger->readings));
    }
  }
}

void add_sights(const World& world, Frame& frame) {
  if (world.tick() == 0) return;
  for_each_device(
      world, frame, "fiducial",
      [&](std::uint32_t body, Row row, const BodyType::Device& device, const engine::DeviceSpec& spec) {
        if (!world.runs(row, device)) return;
        const StateTable& table = world.percepts(device);
        const std::size_t slot = world.slot(row);
        const std::span<const double> poses = table.cell<double>(slot, sensors::k_fiducial_pose);
        const std::size_t count =
            std::min<std::size_t>(table.cell<std::uint32_t>(slot, sensors::k_fiducial_count)[0],
                                  table.fields()[sensors::k_fiducial_id].columns);
        const Pose eye = placed(world, row, device, spec);
        for (std::size_t k = 0; k < count; ++k)
          frame.sights.push_back(
              {body, {eye.x, eye.y, eye.z}, {poses[4 * k], poses[4 * k + 1], poses[4 * k + 2]}});
      });
}

void add_blobs(const World& world, Frame& frame) {
  if (world.tick() == 0) return;
  const auto add = [&](std::uint32_t body, Row row, const BodyType::Device& device,
                       const engine::DeviceSpec& spec) {
    if (!world.runs(row, device)) return;
    const auto param = [&](std::string_view name) {
      return engine::get(device.kind->params, spec.params, name);
    };
    const auto columns = static_cast<double>(param("image_width").integer());
    const double fov = param("fov").number();
    const StateTable& table = world.percepts(device);
    const std::size_t slot = world.slot(row);
    const auto integers = [&](std::size_t field) { return table.cell<std::int32_t>(slot, field); };
    const std::span<const float> ranges = table.cell<float>(slot, sensors::k_blob_range);
    const std::span<const std::uint8_t> colors = table.cell<std::uint8_t>(slot, sensors::k_blob_color);
    const std::size_t count =
        std::min<std::size_t>(table.cell<std::uint32_t>(slot, sensors::k_blob_count)[0], ranges.size());
    const Pose eye = placed(world, row, device, spec);
    const double ahead = eye.heading + param("pan").number();
    // The image's columns count from the left, each as wide as the angle from one ray to the next.
    const auto end = [&](double column, double range) {
      const double bearing = columns > 1 ? fov * (0.5 - column / columns) : 0;
      const Vec2 way = Rotation(ahead + bearing) * Vec2(range, 0);
      return Eigen::Vector3d(eye.x + way.x(), eye.y + way.y(), eye.z);
    };
    for (std::size_t k = 0; k < count; ++k) {
      const auto part = [&](std::size_t i) { return static_cast<float>(colors[4 * k + i]) / 255; };
      frame.blobs.push_back({body,
                             {eye.x, eye.y, eye.z},
                             end(integers(sensors::k_blob_right)[k] + 1.0, ranges[k]),
                             end(integers(sensors::k_blob_left)[k], ranges[k]),
                             {part(0), part(1), part(2), 1}});
    }
  };
  for_each_device(world, frame, "blobfinder", add);
}

void add_grips(const World& world, Frame& frame) {
  using engine::FrameTie;
  const auto add = [&](std::uint32_t, Row row, const BodyType::Device& device,
                       const engine::DeviceSpec& spec) {
    const auto& state = world.percepts(device).as<models::GripperState>(world.slot(row));
    const auto numbers = [&](std::string_view name) {
      return engine::get(device.kind->params, spec.params, name).numbers();
    };
    const std::vector<double> size = numbers("size");
    const std::vector<double> paddle = numbers("paddle_size");
    const Pose base = placed(world, row, device, spec);
    const double inner_face =
        (1 - state.paddle_position) * (size[1] / 2 - paddle[1] * size[1]);  // models/devices/gripper.hpp
    const double height = state.lift_position * (1 - paddle[2]) * size[2];
    for (const auto& [behind_tips, broken] :
         {std::pair(0.165, state.beam_outer), std::pair(0.495, state.beam_inner)}) {
      const double x = size[0] * (0.5 - behind_tips);
      frame.grips.push_back({broken != 0 ? FrameTie::Kind::broken_beam : FrameTie::Kind::beam,
                             at(base, x, inner_face, height), at(base, x, -inner_face, height)});
    }
    if (state.held == 0) return;
    const Pose held = world.pose(BodyId(std::size_t{state.held} - 1));
    frame.grips.push_back(
        {FrameTie::Kind::holds, at(base, 0, 0, height), Eigen::Vector3d(held.x, held.y, held.z)});
  };
  for_each_device(world, frame, "gripper", add);
}

void add_links(const World& world, Frame& frame) {
  if (world.carried_count() == 0) return;
  for (const engine::FrameBody& body : frame.mobile) {
    const auto carrier = world.carrier(world.row(BodyId(std::size_t{body.id})));
    if (!carrier) continue;
    const Pose& to = body.pose_world_body;
    const Pose from = world.pose(*carrier);
    frame.links.push_back({engine::FrameTie::Kind::carries, {from.x, from.y, from.z}, {to.x, to.y, to.z}});
  }
}

void add_charges(const World& world, Frame& frame) {
  frame.charges.assign(frame.mobile.size(), std::numeric_limits<double>::quiet_NaN());
  for_each_device(
      world, frame, "power_pack",
      [&](std::uint32_t body, Row row, const BodyType::Device& device, const engine::DeviceSpec&) {
        const auto& pack = world.percepts(device).as<models::PowerPackState>(world.slot(row));
        double& charge = frame.charges[body];
        if (std::isnan(charge)) charge = pack.proportion_remaining();  // of several the first
      });
}

void add_names(const World& world, Frame& frame) {
  frame.names.reserve(frame.mobile.size());
  for (const engine::FrameBody& body : frame.mobile)
    frame.names.push_back(world.spec().name(BodyId(std::size_t{body.id})));
}

}  // namespace troupe
