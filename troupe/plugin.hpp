#pragma once

#include "base/assert.hpp"
#include "base/math.hpp"
#include "base/random.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/kinds/make_device_kind.hpp"
#include "engine/kinds/measure_kind.hpp"
#include "engine/links/effect_views.hpp"
#include "engine/observing/robot_sums.hpp"
#include "engine/rows/measured_world.hpp"
#include "engine/sensing/sensing_view.hpp"
#include "engine/sensing/sight.hpp"
#include "sensors/ranger.hpp"
#include "troupe/plugin_library.hpp"

#include <string_view>
#include <utility>
#include <vector>

/// A plug-in is a shared library with kinds: implementations of controllers, measures, sensors or other
/// devices (docs/controllers.md). This header is all that the sources of the library must include. The
/// library links the CMake target troupe::plugin. Troupe looks for a kind "dancer" in a library file
/// dancer.so.
///
/// A controller is a class whose objects are called to decide on the commands of one robot:
///
///     #include <troupe/plugin.hpp>
///
///     struct Dancer {
///       struct Memory { float turned = 0; TROUPE_FIELDS(turned) };
///       void operator()(Memory&, const troupe::Percept&, troupe::Random&, troupe::Actions&) const;
///     };
///     TROUPE_CONTROLLER("dancer", Dancer)
///
/// The class may also have:
/// - a description: `static constexpr std::string_view text`;
/// - parameters: `struct Params` (engine/fields/description.hpp);
/// - a function `choose`, which selects the devices that the controller uses (engine/kinds/controller.hpp);
/// - instead of the operator() above, an operator() that decides for many robots in one call
///   (engine/kinds/controller.hpp).
///
/// A sensor or another device is a function that returns a DeviceKind (docs/extending.md). make_device_kind()
/// makes one from a class (engine/kinds/make_device_kind.hpp); a function can also fill the members itself:
///
///     troupe::DeviceKind compass() { return troupe::make_device_kind<Compass>("compass", "..."); }
///     TROUPE_DEVICE("compass", compass)
///
/// A measure is a class (docs/measures.md):
///
///     struct Crowding : troupe::Measure {
///       static constexpr std::string_view text = "...";
///       Crowding(const troupe::MeasuredWorld& world, std::vector<troupe::BodyId> robots);
///       double value(const troupe::MeasuredWorld& world) override;
///     };
///     TROUPE_MEASURE("crowding", Crowding)
///
/// Sensors and other devices read the world through the functions in engine/sensing/sensing_view.hpp and
/// engine/sensing/sight.hpp. Measures read it through the class MeasuredWorld
/// (engine/rows/measured_world.hpp), and the function `draw` of a DeviceKind through CommittedView. The
/// functions `apply` and `born` of a DeviceKind see and change it through the views in
/// engine/links/effect_views.hpp.

namespace troupe {

using engine::Actions;
using engine::Command;
using engine::CommittedView;
using engine::DecideBatch;
using engine::Description;
using engine::DeviceBatch;
using engine::DeviceExchange;
using engine::DeviceInfo;
using engine::DeviceKind;
using engine::Field;
using engine::FieldTable;
using engine::FieldType;
using engine::first_met;
using engine::from_record;
using engine::Gripping;
using engine::make_device_kind;
using engine::Measure;
using engine::MeasuredWorld;
using engine::MeasureKind;
using engine::memory_fields;
using engine::OwnDevice;
using engine::Percept;
using engine::RayHit;
using engine::Record;
using engine::SenseBatch;
using engine::SensingView;
using engine::SightRay;
using engine::StateField;
using engine::StateTable;
using engine::Transducer;
using engine::TypeSpec;
using engine::Unit;
using engine::Value;
using sensors::Ranger;
using sensors::ranger_kind;
namespace facts = engine::facts;

// Hidden symbols, so that each plug-in in a process has its own copy of the following definitions. With
// visible symbols the dynamic linker would merge them, and each plug-in would list the kinds of all plug-ins.
#pragma GCC visibility push(hidden)
namespace plugin {

/// An element of a linked list of the kinds that this library registers. There are three lists: of
/// controllers, of devices and of measures. `Kind` is ControllerKind, DeviceKind or MeasureKind.
template <class Kind>
struct Entry {
  using Make = Kind (*)(std::string_view name);  ///< a function that returns a kind and gives it this name

  /// Adds this element to the front of the list of kinds of the type `Kind`.
  Entry(std::string_view its_name, Make its_make) : name(its_name), make(its_make), next(first) {
    first = this;
  }

  std::string_view name;                                 ///< name of the kind
  Make make;                                             ///< function that makes the kind
  const Entry* next;                                     ///< next element of the list; null at its end
  static inline constinit const Entry* first = nullptr;  ///< first element of the list; null: empty list
};

template <class C>
engine::ControllerKind kind_of(std::string_view name) {
  std::string_view text;
  if constexpr (requires { C::text; }) text = C::text;
  static_assert(
      !requires { C::parameters(); },
      "parameters() is not called any more: describe a `struct Params` instead (docs/controllers.md)");
  return engine::make_controller_kind<C>(name, text);
}

template <engine::DeviceKind (*k_make)()>
engine::DeviceKind device_of(std::string_view name) {
  engine::DeviceKind kind = k_make();
  kind.name = name;
  return kind;
}

template <class Kind>
void list_all(std::vector<Kind>& kinds) {
  for (const Entry<Kind>* entry = Entry<Kind>::first; entry != nullptr; entry = entry->next)
    kinds.push_back(entry->make(entry->name));
}

template <class M>
engine::MeasureKind measure_of(std::string_view name) {
  engine::Unit unit = engine::Unit::none;
  if constexpr (requires { M::unit; }) unit = M::unit;
  std::string_view definition;
  if constexpr (requires { M::definition; }) definition = M::definition;
  std::string_view formula;
  if constexpr (requires { M::formula; }) formula = M::formula;
  return engine::make_measure_kind<M>(name, unit, M::text, definition, formula);
}

inline void list(std::vector<engine::ControllerKind>& controllers, std::vector<engine::DeviceKind>& devices,
                 std::vector<engine::MeasureKind>& measures) {
  list_all(controllers);
  list_all(devices);
  list_all(measures);
}

/// Whether the compiler contracts x * y + z to one fused multiply-add, which changes bits of results because
/// it rounds only once. The test computes x * y - z, where z is the product x * y rounded to a double.
/// Without contraction, the difference is 0. With contraction, it is the rounding error of the product. The
/// operands are volatile so that the processor computes the difference at run time, like the arithmetic of a
/// controller.
inline bool contracts() {
  const volatile double factor = 0x1.0000002p0;
  const volatile double rounded_square = 0x1.0000004p0;
  const double x = factor, y = factor, z = rounded_square;
  return x * y - z != 0;
}

inline constinit std::atomic<std::uint64_t> contents = 0;
// Aligned as the program expects, even with -fpack-struct.
alignas(std::uint64_t) inline constexpr Library library{k_interface, k_version, k_build,  layout(),
                                                        contracts,   list,      &contents};

}  // namespace plugin
#pragma GCC visibility pop
}  // namespace troupe

/// The exported function, named by plugin::k_symbol, that the program calls after loading the plug-in.
extern "C" __attribute__((used, visibility("default"))) inline const troupe::plugin::Library*
troupe_plugin() {
  return &troupe::plugin::library;
}

/// Registers a class as the controller of this name. Use the macro at namespace scope, once per controller. A
/// library may have several controllers.
#define TROUPE_CONTROLLER(name, ...)                                                                       \
  static_assert(::troupe::plugin::is_name(name),                                                           \
                "a controller's name is one word without / : = \\ \" and without a leading dot");          \
  static const ::troupe::plugin::Entry<::troupe::engine::ControllerKind> TROUPE_PLUGIN_ENTRY(__COUNTER__)( \
      name, ::troupe::plugin::kind_of<__VA_ARGS__>);

/// Registers a function `DeviceKind make()` as the sensor or other device of this name. World files use this
/// name, which replaces the name in the returned DeviceKind. Use the macro at namespace scope, once per
/// device. A library may have several devices and controllers.
#define TROUPE_DEVICE(name, make)                                                                      \
  static_assert(::troupe::plugin::is_name(name),                                                       \
                "a device's name is one word without / : = \\ \" and without a leading dot");          \
  static const ::troupe::plugin::Entry<::troupe::engine::DeviceKind> TROUPE_PLUGIN_ENTRY(__COUNTER__)( \
      name, ::troupe::plugin::device_of<make>);

/// Registers a class derived from Measure as the measure of this name. Use the macro at namespace scope, once
/// per measure. The class must have
/// - a description: `static constexpr std::string_view text`;
/// - a constructor with the arguments (world, robots). If the class has parameters (a `struct Params`,
///   engine/fields/description.hpp), the arguments are (world, params, robots).
///
/// It may have static members `unit`, `definition` and `formula`, which set the members of MeasureKind with
/// the same names (engine/kinds/measure_kind.hpp).
#define TROUPE_MEASURE(name, ...)                                                                       \
  static_assert(::troupe::plugin::is_name(name),                                                        \
                "a measure's name is one word without / : = \\ \" and without a leading dot");          \
  static const ::troupe::plugin::Entry<::troupe::engine::MeasureKind> TROUPE_PLUGIN_ENTRY(__COUNTER__)( \
      name, ::troupe::plugin::measure_of<__VA_ARGS__>);

#define TROUPE_PLUGIN_ENTRY(n) TROUPE_PLUGIN_ENTRY_NAMED(n)
#define TROUPE_PLUGIN_ENTRY_NAMED(n) troupe_plugin_entry_##n
