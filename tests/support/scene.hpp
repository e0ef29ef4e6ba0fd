#pragma once

#include "engine/kinds/components.hpp"
#include "engine/kinds/sensor_params.hpp"
#include "engine/world/world.hpp"
#include "troupe/registry.hpp"

#include <cstddef>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

/// Functions that build worlds without world files, for tests of the engine.
namespace troupe::test {

/// Returns the registry of all built-in kinds (implementations of drives, sensors, other devices, controllers
/// and measures).
inline const engine::Registry& registry() {
  static const engine::Registry kinds = make_registry();
  return kinds;
}

inline Ring rectangle(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

inline Ring box_ring(double size_x, double size_y) {
  return rectangle(-size_x / 2, -size_y / 2, size_x / 2, size_y / 2);
}

/// Returns a box that stands on the floor, with its centre at x = y = 0. Sizes in m.
inline Solid box(double size_x, double size_y, double height = 1) {
  return {{box_ring(size_x, size_y)}, {0, height}};
}

/// Returns the parameters that `table` describes, as a record (a list of values in the order of the table).
/// The parameters named in `values`, a list of pairs of a name and a value, have the values given there, and
/// all others their defaults. All names must exist in the table.
template <class Values = std::initializer_list<std::pair<std::string_view, engine::Value>>>
engine::Record record(const engine::FieldTable& table, const Values& values) {
  engine::Record out = table.defaults();
  for (const auto& [name, value] : values) out.at(static_cast<std::size_t>(table.find(name))) = value;
  return out;
}

/// A transducer (fan of beams) for ranger(). The pose is in the frame of the ranger. Lengths in m, angles in
/// rad.
struct Transducer {
  Pose pose;
  double range_max = 5;
  double fov = 0;
  int samples = 1;
};

inline engine::DeviceSpec ranger(std::string name, const std::vector<Transducer>& transducers,
                                 bool intensity = false) {
  engine::RangerParams params{.intensity = intensity};
  for (const Transducer& t : transducers)
    params.transducers.push_back(
        {.pose = t.pose, .range_max = t.range_max, .fov = t.fov, .samples = t.samples});
  return {.name = std::move(name), .kind = "ranger", .params = engine::to_record(params), .active = true};
}

/// Returns a device that runs whether a controller uses it or not. Its name is that of its kind. pose: pose
/// of the device in the body frame.
inline engine::DeviceSpec device(std::string kind,
                                 const std::vector<std::pair<std::string_view, engine::Value>>& values = {},
                                 const Pose& pose = {}) {
  return {.name = kind,
          .kind = kind,
          .params = record(registry().device(kind)->params, values),
          .pose_body_device = pose,
          .active = true,
          .where = {}};
}

inline engine::DriveSpec drive(
    std::string kind, std::initializer_list<std::pair<std::string_view, engine::Value>> values = {}) {
  return {.kind = kind, .params = record(registry().drive(kind)->params, values)};
}

inline engine::ControllerSpec controller(
    std::string kind, std::initializer_list<std::pair<std::string_view, engine::Value>> values = {}) {
  return {.kind = kind, .params = record(registry().controller(kind)->params, values)};
}

/// Number of bodies in the world that are disabled or have a fault, such as a broken device.
inline std::size_t count_impaired(const engine::World& world) {
  std::size_t count = 0;
  for (const engine::StateTable& table : world.tables())
    if (table.component() == "condition")
      for (std::size_t row = 0; row < table.rows(); ++row)
        count += !table.as<engine::Condition>(row).is_sound();
  return count;
}

/// Builds a WorldSpec, the engine's description of a world. The world contains the ground (body 0) and the
/// types and bodies that the caller adds.
class SceneBuilder {
 public:
  SceneBuilder() { engine::add_ground(spec); }

  TypeId type(std::string name, std::vector<Solid> solids, engine::Returns returns = {}) {
    engine::TypeSpec t;
    t.name = std::move(name);
    t.parts.push_back({.kind = "model", .solids = std::move(solids), .returns = returns});
    spec.types.push_back(std::move(t));
    return TypeId(spec.types.size() - 1);
  }
  TypeId robot(std::string name, std::vector<Solid> solids, std::string drive_kind = "diff") {
    const TypeId id = type(std::move(name), std::move(solids));
    spec.types[id.index()].drive = drive(std::move(drive_kind));
    return id;
  }
  engine::TypeSpec& operator[](TypeId id) { return spec.types[id.index()]; }

  BodyId body(std::string_view name, TypeId type, Pose pose = {}) {
    spec.bodies.push_back({.name = spec.names.add(name), .type = type, .pose_world_body = pose});
    return BodyId(spec.bodies.size() - 1);
  }
  BodyId wall(double x0, double y0, double x1, double y1, engine::Returns returns = {}) {
    const std::string name = "wall" + std::to_string(spec.bodies.size());
    return body(name, type(name, {Solid{{rectangle(x0, y0, x1, y1)}, {0, 1}}}, returns));
  }

  engine::World world(engine::WorldOptions options = {.threads = 2}) const {
    Diagnostics diagnostics;
    return engine::World(spec, registry(), options, diagnostics);
  }
  /// Returns the error of world(); empty if there is none.
  std::string error() const {
    try {
      world();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  engine::WorldSpec spec;
};

}  // namespace troupe::test
