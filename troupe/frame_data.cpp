#include "troupe/frame_data.hpp"

#include "base/diagnostics.hpp"
#include "engine/ticks.hpp"
#include "models/power.hpp"
#include "sensors/fiducial.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
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

constexpr double k_trail_s = 20;
constexpr std::size_t k_trail_points = 50;

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

/// Splits off what stands behind the last dot; nothing where there is none.
std::optional<std::pair<std::string, std::string>> split_last(const std::string& name) {
  const auto dot = name.rfind('.');
  if (dot == name.npos) return std::nullopt;
  return std::pair(name.substr(0, dot), name.substr(dot + 1));
}

/// A name of a field and its column, as somebody may have meant it.
std::vector<ChosenValue> readings_of(const std::string& name) {
  std::vector<ChosenValue> readings;
  const auto whole = split_last(name);
  if (!whole) return readings;
  readings.push_back({whole->first, whole->second, 0, {}});
  std::size_t column = 0;
  const std::string& last = whole->second;
  const auto [end, fault] = std::from_chars(last.data(), last.data() + last.size(), column);
  if (fault != std::errc() || end != last.data() + last.size()) return readings;
  if (const auto field = split_last(whole->first))
    readings.push_back({field->first, field->second, column, {}});
  return readings;
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

/// The transducers of a device, where its kind has such; in the order of its readings.
std::vector<FrameTransducer> transducers_of(const engine::DeviceSpec& spec, const BodyType::Device& device) {
  const engine::FieldTable& table = device.kind->params;
  const int place = table.find("transducers");
  if (place < 0) return {};
  const engine::Field& field = table.fields[static_cast<std::size_t>(place)];
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

}  // namespace

std::optional<ChosenValue> find_value(const World& world, const std::string& name, std::string& fault) {
  for (ChosenValue& reading : readings_of(name)) {
    for (const StateTable& table : world.tables()) {
      const StateField* const field = field_of(table, reading.field);
      if (!field || !has_name(table, reading.component)) continue;
      if (reading.column >= field->columns) {
        fault = fmt::format("\"{}\" has the columns 0 to {}", reading.component + "." + reading.field,
                            field->columns - 1);
        return std::nullopt;
      }
      reading.text = field->unit.empty() ? name : fmt::format("{} ({})", name, field->unit);
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
  for (std::size_t t = 0; t < world.types().size(); ++t) {
    for (std::size_t d = 0; d < world.types()[t].devices.size(); ++d) {
      FrameRanger ranger{static_cast<std::uint32_t>(t), 0,
                         transducers_of(world.spec().types[t].devices[d], world.types()[t].devices[d])};
      for (const FrameTransducer& transducer : ranger.transducers) ranger.readings += transducer.samples;
      if (ranger.readings > 0) rangers.push_back(std::move(ranger));
    }
  }
  return rangers;
}

void add_scans(const World& world, const engine::FrameScene& scene, Frame& frame) {
  if (world.tick() == 0) return;  // nobody has looked yet
  // The rangers of a type follow one another in the scene, as they do among its devices.
  for (std::size_t i = 0; i < frame.mobile.size(); ++i) {
    const Row row = world.row(BodyId(std::size_t{frame.mobile[i].id}));
    const BodyType& type = world.type(row);
    const std::uint32_t type_index = world.spec().bodies[frame.mobile[i].id].type.value;
    auto ranger = std::ranges::find(scene.rangers, type_index, &FrameRanger::type);
    for (const BodyType::Device& device : type.devices) {
      if (ranger == scene.rangers.end() || ranger->type != type_index) break;
      if (device.kind->params.find("transducers") < 0) continue;
      if (world.runs(row, device)) {
        const std::span<const float> ranges = world.percepts(device).cell<float>(world.slot(row), 0);
        frame.scans.push_back({static_cast<std::uint32_t>(i),
                               static_cast<std::uint32_t>(ranger - scene.rangers.begin()),
                               frame.ranges.size()});
        frame.ranges.insert(frame.ranges.end(), ranges.begin(),
                            ranges.begin() + static_cast<std::ptrdiff_t>(ranger->readings));
      }
      ++ranger;
    }
  }
}

void add_sights(const World& world, Frame& frame) {
  if (world.tick() == 0) return;
  for (std::size_t i = 0; i < frame.mobile.size(); ++i) {
    const Row row = world.row(BodyId(std::size_t{frame.mobile[i].id}));
    const BodyType& type = world.type(row);
    for (std::size_t d = 0; d < type.devices.size(); ++d) {
      const BodyType::Device& device = type.devices[d];
      if (device.kind->name != "fiducial" || !world.runs(row, device)) continue;
      const StateTable& table = world.percepts(device);
      const std::size_t slot = world.slot(row);
      const std::span<const double> poses = table.cell<double>(slot, sensors::k_fiducial_pose);
      const std::size_t count =
          std::min<std::size_t>(table.cell<std::uint32_t>(slot, sensors::k_fiducial_count)[0],
                                table.fields()[sensors::k_fiducial_id].columns);
      const Pose& sensor = world.spec()
                               .types[world.spec().bodies[frame.mobile[i].id].type.index()]
                               .devices[d]
                               .pose_body_sensor;
      const Pose eye = compose(frame.mobile[i].pose_world_body, sensor);
      for (std::size_t k = 0; k < count; ++k)
        frame.sights.push_back({static_cast<std::uint32_t>(i),
                                {eye.x, eye.y, eye.z},
                                {poses[4 * k], poses[4 * k + 1], poses[4 * k + 2]}});
    }
  }
}

void add_charges(const World& world, Frame& frame) {
  frame.charges.assign(frame.mobile.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < frame.mobile.size(); ++i) {
    const Row row = world.row(BodyId(std::size_t{frame.mobile[i].id}));
    for (const BodyType::Device& device : world.type(row).devices) {
      if (device.kind->name != "power_pack") continue;
      const auto& pack = world.percepts(device).as<models::PowerPackState>(world.slot(row));
      frame.charges[i] = pack.proportion_remaining();
      break;
    }
  }
}

void add_names(const World& world, Frame& frame) {
  frame.names.reserve(frame.mobile.size());
  for (const engine::FrameBody& body : frame.mobile)
    frame.names.push_back(world.spec().name(BodyId(std::size_t{body.id})));
}

void Trails::see(const World& world) {
  const std::uint64_t every =
      engine::period_ticks(k_trail_s / static_cast<double>(k_trail_points), world.tick_s());
  if (!seen_.empty() && world.tick() < seen_.back().tick) seen_.clear();  // the run began anew
  if (!seen_.empty() && (world.tick() == seen_.back().tick || world.tick() % every != 0)) return;
  Seen now{world.tick(), {}};
  for (const engine::FrameBody& body : world.frame().mobile)
    now.places.emplace_back(body.pose_world_body.x, body.pose_world_body.y, body.pose_world_body.z);
  seen_.push_back(std::move(now));
  if (seen_.size() > k_trail_points) seen_.pop_front();
}

void Trails::add_to(Frame& frame) const {
  for (std::size_t i = 0; i < frame.mobile.size(); ++i) {
    engine::FrameTrail trail{static_cast<std::uint32_t>(i), {}};
    for (const Seen& seen : seen_)
      if (i < seen.places.size()) trail.points.push_back(seen.places[i]);
    const Pose& pose = frame.mobile[i].pose_world_body;
    trail.points.emplace_back(pose.x, pose.y, pose.z);
    frame.trails.push_back(std::move(trail));
  }
}

}  // namespace troupe
