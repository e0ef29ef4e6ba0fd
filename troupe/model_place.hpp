#pragma once

#include "engine/world/world.hpp"
#include "troupe/simulation.hpp"

#include <string>
#include <string_view>

namespace troupe {

/// What a Model, which is only a handle, refers to: a body of a world, or a part of a body. A device is a
/// sensor or other equipment on a part. `part` is the index of the part; 0: the body itself. `name` is the
/// result of Model::name().
struct Model::Place {
  engine::World* world;
  BodyId body;
  std::size_t part;
  std::string name;

  /// Returns the row (index) of the body in the state tables, which hold the state of all bodies that are not
  /// static. Throws std::logic_error for static geometry, which has no row, and if the state is incomplete
  /// after a failed step.
  Row row() const;
  /// Returns the result of row(), for functions that do not apply to parts: also throws std::logic_error if
  /// this model is a part.
  Row whole() const;
  const engine::BodyType& type() const { return world->type(body); }
  /// Returns the index of the body in the state tables that only bodies of its type have, such as those of
  /// devices. Throws as row() does.
  std::size_t slot() const { return world->slot(row()); }
  /// Returns the device `wheels` that drives this part; null if the part has none, and for the body itself,
  /// whose drive is not a device.
  const engine::BodyType::Device* wheels() const {
    for (const engine::BodyType::Device& device : type().devices)
      if (part > 0 && device.part == part && device.kind->drives) return &device;
    return nullptr;
  }
  /// Whether a device belongs to this model: a body owns the devices of all its parts, a part only its own.
  bool owns(const engine::BodyType::Device& device) const {
    const auto& parts = world->spec().type(body).parts;
    return part == 0 || device.name == parts[part].name;
  }
  /// Returns the first device of this model that satisfies `wanted`; null if there is none.
  template <class Wanted>
  const engine::BodyType::Device* find(Wanted&& wanted) const {
    for (const engine::BodyType::Device& device : type().devices)
      if (owns(device) && wanted(device)) return &device;
    return nullptr;
  }
  /// Throws std::out_of_range for a device `wanted` that this model does not have: `"r0" has no sensor "eye";
  /// it has: ...`. what: what was searched, such as "sensor". The text lists the devices of this model that
  /// satisfy `counted`.
  template <class Counted>
  [[noreturn]] void throw_unknown(std::string_view what, std::string_view wanted, Counted&& counted) const;
  /// Throws std::logic_error if `sensor`, a sensor of this model, does not run. A sensor runs only if the
  /// world file, a controller of the robot or Simulation::subscribe() makes it run.
  void check_running(const engine::BodyType::Device& sensor) const;
  /// Returns the ranger (range sensor) named `wanted` of this model, or its first ranger if `wanted` is
  /// empty. Throws std::out_of_range, with the known names, if there is none, and std::logic_error if the
  /// ranger does not run.
  const engine::BodyType::Device& ranger(std::string_view wanted) const;
  /// Returns the device named `wanted` of this model. Throws std::out_of_range, with the known names, if
  /// there is none.
  const engine::BodyType::Device& device(std::string_view wanted) const;
  /// Returns the device of this model that is named `wanted` and takes commands. Throws std::out_of_range,
  /// with the known names, if there is none.
  const engine::BodyType::Device& commanded(std::string_view wanted) const;
};

}  // namespace troupe
