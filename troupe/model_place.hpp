#pragma once

#include "engine/world/world.hpp"
#include "troupe/simulation.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe {

/// The body, or the part of a body, to which a Model refers. `part` is the index of the part; 0 is the body
/// itself. `name` is the result of Model::name(). A device is a sensor or other equipment; each device
/// belongs to a part of the body.
struct Model::Place {
  engine::World* world;
  BodyId body;
  std::size_t part;
  std::string name;

  /// Returns the row of the body, which is its index in the state tables. These tables hold the state of all
  /// bodies that are not static. Throws std::logic_error for static geometry, which has no row, and after a
  /// step that threw, because the state is then incomplete.
  Row row() const;
  /// Returns the row of the body, for functions that do not apply to parts. Throws std::logic_error if this
  /// model is a part, and for static geometry. Does not check whether the last step threw, unlike row().
  Row whole() const;
  /// Returns the body, for functions that do not apply to parts but apply to static geometry. Throws
  /// std::logic_error if this model is a part.
  BodyId of_body() const;
  const engine::BodyType& type() const { return world->view().type(body); }
  /// Returns the slot of the body, which is its index in the state tables that only bodies of its type have,
  /// such as those of devices. Throws as row() does.
  std::size_t slot() const { return world->view().slot(row()); }
  /// Returns the device `wheels` of this part, a drive that moves only this part. Returns null if the part
  /// has none. Also returns null for the body itself, because the drive of a body is not a device.
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
  /// Whether a controller, given by its index in TypeSpec::controllers, belongs to this model.
  bool owns_controller(std::size_t controller) const {
    return part == 0 || world->spec().type(body).controllers[controller].part == part;
  }
  /// Returns the first device of this model for which wanted(device) is true; null if there is none.
  template <class Wanted>
  const engine::BodyType::Device* find(Wanted&& wanted) const {
    for (const engine::BodyType::Device& device : type().devices)
      if (owns(device) && wanted(device)) return &device;
    return nullptr;
  }
  /// Returns the names of the devices of this model for which counted(device) is true.
  template <class Counted>
  std::vector<std::string_view> names_of(Counted&& counted) const;
  /// Throws std::out_of_range with the text `"r0" has no ranger "eye"; it has: ...`.
  /// what: the sort of device that was searched for; in this example "ranger"
  /// wanted: the name that was searched for; in this example "eye"
  /// known: names that the text lists, and of which it suggests one that is similar to `wanted`
  [[noreturn]] void throw_unknown(std::string_view what, std::string_view wanted,
                                  std::span<const std::string_view> known) const;
  /// Throws std::logic_error if `sensor`, a sensor of this model, does not run. A sensor runs only if the
  /// world file, a controller of the robot or Simulation::subscribe() makes it run.
  void check_running(const engine::BodyType::Device& sensor) const;
  /// Returns the ranger (range sensor) named `wanted` of this model, or its first ranger if `wanted` is
  /// empty. Throws std::out_of_range, with the known names, if there is none.
  const engine::BodyType::Device& ranger(std::string_view wanted) const;
  /// A state that readings() reads: that of a device, or the memory of a controller.
  struct State {
    const engine::BodyType::Device* device = nullptr;  ///< null: the memory of a controller
    const engine::StateTable* table = nullptr;

    /// The name by which readings() selects this state.
    std::string_view name() const {
      return device != nullptr ? std::string_view(device->name) : table->component();
    }
    /// `device "eye"` or `controller "wander/0"`, for messages.
    std::string text() const;
  };
  /// Returns the state of the device named `wanted` of this model or, if there is none, the memory of a
  /// controller of this model whose component of the state is `wanted`. Throws std::out_of_range, with the
  /// known names, if there is no such memory either.
  State state(std::string_view wanted) const;
  /// A field of such a state.
  struct Reading {
    State state;
    std::size_t index = 0;  ///< index of the field in the table

    const engine::StateField& field() const { return state.table->fields()[index]; }
  };
  /// Returns the field named `field` of state(wanted) or, if `wanted` is empty, of the first device of this
  /// model that has such a field. Throws std::out_of_range, with the known names, if there is no such state
  /// or field.
  Reading reading(std::string_view field, std::string_view wanted) const;
  /// Returns the device of this model that is named `wanted` and takes commands. Throws std::out_of_range,
  /// with the known names, if there is none.
  const engine::BodyType::Device& commanded(std::string_view wanted) const;
};

/// Throws std::logic_error because a sensor of the model or robot `owner` does not run.
[[noreturn]] void refuse_stopped(const engine::BodyType::Device& sensor, std::string_view owner);
/// Returns the field of the command of a device that is called `name`. Throws std::out_of_range, with the
/// known names, if there is none. fields: all fields of the command. whose: the beginning of the message,
/// such as `device "lamp"`
const engine::StateField& command_field(std::span<const engine::StateField> fields, std::string_view name,
                                        std::string_view whose);
/// Throws std::logic_error if sensors can no longer be subscribed, because the world has made a step.
void check_subscribable(const engine::World& world);

}  // namespace troupe
