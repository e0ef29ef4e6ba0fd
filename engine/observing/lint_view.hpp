#pragma once

#include "base/diagnostics.hpp"
#include "engine/fields/fields.hpp"
#include "engine/spec/body_type.hpp"
#include "engine/spec/world_spec.hpp"

#include <algorithm>
#include <any>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <typeindex>
#include <utility>
#include <vector>

namespace troupe::engine {

class World;

/// A world in which `troupe lint` looks for probable mistakes.
class LintWorld {
 public:
  explicit LintWorld(const World& world);  ///< `world` must outlive this object

  const WorldSpec& spec;            ///< the world file after expansion
  std::span<const BodyType> types;  ///< the compiled types, in the order of WorldSpec::types
  std::vector<std::size_t> bodies;  ///< for each type, the number of its bodies, including unborn ones
  /// For each type, the heights of its bodies (m, world frame), each with the number of bodies. A body that
  /// an intervention moves to another height counts at both heights.
  std::vector<std::map<double, std::size_t>> levels;

  /// Whether an intervention `set` changes one of these parameters of a drive, device or controller, so that
  /// the value in its type does not hold for the whole run. params: DriveSpec::params, DeviceSpec::params or
  /// ControllerSpec::params in `spec`
  bool is_set(const Record& params, std::initializer_list<std::string_view> names) const;
  /// The values that interventions `set` give a parameter, as in is_set().
  std::vector<const Value*> set_values(const Record& params, std::string_view name) const;

  /// Calls visit(type, device, data) for each device of each type that has bodies, if the data of the device
  /// (DeviceKind::Prepared::data) are of the class C. type, device: indices into `types` and
  /// BodyType::devices
  template <class C, class Visit>
  void for_devices(Visit&& visit) const {
    for (std::uint32_t t = 0; t < types.size(); ++t)
      for (std::size_t d = 0; d < types[t].devices.size() && bodies[t] > 0; ++d)
        if (const auto* data = std::any_cast<C>(&types[t].devices[d].prepared.data)) visit(t, d, *data);
  }

  /// An object of the class T that is made from this world, by T(const LintWorld&), when it is first asked
  /// for. Hooks use it for data that are the same for all devices, so that the time is not quadratic.
  template <class T>
  const T& shared() const {
    std::any& made = shared_[typeid(T)];
    if (!made.has_value()) made = T(*this);
    return *std::any_cast<T>(&made);
  }

 private:
  void add_levels_of_interventions(const World& world);
  void collect_set_params();

  // The record, the name of the parameter, and the new values.
  std::multimap<std::pair<const Record*, std::string_view>, const Value*> set_params_;
  mutable std::map<std::type_index, std::any> shared_;
};

/// What a finding of a hook `lint` is about. `troupe lint` lists findings about one line of a file in this
/// order, so that those about one topic are together, also if a whole world is written in one line.
enum class LintTopic : std::uint8_t {
  drive,     ///< what a drive does
  energy,    ///< stored energy
  charging,  ///< exchange of energy
  decision,  ///< what a controller does
  goal,      ///< where a controller drives to
  sight,     ///< bodies that a sensor detects
  light,     ///< lights that a sensor sees
  ground,    ///< ground that a sensor sees
  color,     ///< colours that a sensor looks for
  message,   ///< messages that a device receives
  grip,      ///< bodies that a device holds
  other,     ///< anything else
};

/// A finding of a hook `lint`.
struct LintFinding {
  LintTopic topic;   ///< what it is about
  Where where;       ///< its position in the file
  std::string text;  ///< one sentence, without a place and without a full stop
};

/// The argument of the hooks `lint`: a drive, a device or a controller of a type that has bodies.
struct LintView {
  const LintWorld& world;              ///< the world
  std::uint32_t type = 0;              ///< index of its type
  std::size_t index = 0;               ///< index of the device or controller in its type; 0 for a drive
  const Record& params;                ///< its parameters in LintWorld::spec
  Where where;                         ///< its position in the file
  std::vector<LintFinding>& findings;  ///< receives the findings

  const TypeSpec& type_spec() const { return world.spec.types[type]; }  ///< its type in the world file
  const BodyType& body_type() const { return world.types[type]; }       ///< its type, compiled
  /// The device, in the world file and compiled. If two devices of a type have one name, only the compiled
  /// names differ. Only for devices.
  ///@{
  const DeviceSpec& device_spec() const { return type_spec().devices[index]; }
  const BodyType::Device& device() const { return body_type().devices[index]; }
  ///@}
  /// The controller, in the world file and compiled. Only for controllers.
  ///@{
  const ControllerSpec& controller_spec() const { return type_spec().controllers[index]; }
  const BodyType::Controller& controller() const { return body_type().controllers[index]; }
  ///@}
  /// Reports a probable mistake (LintFinding::text).
  void warn(LintTopic topic, std::string text) const { findings.push_back({topic, where, std::move(text)}); }
  /// LintWorld::is_set() for `params`.
  bool is_set(std::initializer_list<std::string_view> names) const { return world.is_set(params, names); }
  /// Whether the type `of`, which must have a body, has one besides the body that this view is about. Sensors
  /// do not see their own body.
  bool has_other(std::uint32_t of) const { return of != type || world.bodies[of] > 1; }
  /// Whether has_other() is true for one of these types.
  bool has_other_of(std::span<const std::uint32_t> types) const {
    return std::ranges::any_of(types, [&](std::uint32_t of) { return has_other(of); });
  }
};

/// Returns the name of a device for a finding: `ranger "eye" of "bot"`, or `ranger of "bot"` if `name` is
/// empty, because the body itself is the device.
std::string device_text(std::string_view what, std::string_view name, std::string_view type);
/// Returns the beginning of a finding about a sensor: `sensor "eye" of "bot" sees nothing: `, or `sensor
/// "bot" sees nothing: ` if `name` is empty.
std::string sees_nothing_text(std::string_view name, std::string_view type);

}  // namespace troupe::engine
