#pragma once

#include "base/assert.hpp"
#include "base/math.hpp"
#include "base/random.hpp"
#include "engine/controller.hpp"
#include "troupe/plugin_library.hpp"

#include <string_view>
#include <utility>
#include <vector>

/// All that a controller in a plug-in includes (docs/controllers.md):
///
///     #include <troupe/plugin.hpp>
///
///     struct Dancer {
///       struct Memory { float turned = 0; TROUPE_FIELDS(turned) };
///       void operator()(Memory&, const troupe::Percept&, troupe::Random&, troupe::Actions&) const;
///     };
///     TROUPE_CONTROLLER("dancer", Dancer)
///
/// The class may also have `static constexpr std::string_view text`, `static FieldTable parameters()` with
/// `static Dancer make(const Record&)`, `choose` and a form that decides for many robots at once
/// (engine/controller.hpp). The library links troupe::plugin, and is called dancer.so.

namespace troupe {

using engine::Actions;
using engine::Command;
using engine::DecideBatch;
using engine::DeviceInfo;
using engine::Field;
using engine::FieldTable;
using engine::FieldType;
using engine::Percept;
using engine::Record;
using engine::Unit;
using engine::Value;

// Hidden: what two plug-ins of one process have of this are two.
#pragma GCC visibility push(hidden)
namespace plugin {

/// A controller of this library, in the list of all of them.
struct Entry {
  using Make = engine::ControllerKind (*)(std::string_view name);  ///< makes the kind

  /// Puts itself in front of the list.
  Entry(std::string_view its_name, Make its_make) : name(its_name), make(its_make), next(first) {
    first = this;
  }

  std::string_view name;                                 ///< of the controller
  Make make;                                             ///< what makes it
  const Entry* next;                                     ///< null: it is the last
  static inline constinit const Entry* first = nullptr;  ///< of the list
};

template <class C>
engine::ControllerKind kind_of(std::string_view name) {
  std::string_view text;
  if constexpr (requires { C::text; }) text = C::text;
  FieldTable parameters;
  if constexpr (requires { C::parameters(); }) {
    static_assert(
        requires(const Record& record) { C::make(record); },
        "a controller with parameters() takes them in `static C make(const Record&)`");
    parameters = C::parameters();
  }
  return engine::make_controller_kind<C>(name, text, std::move(parameters));
}

inline void list(std::vector<engine::ControllerKind>& controllers) {
  for (const Entry* entry = Entry::first; entry != nullptr; entry = entry->next)
    controllers.push_back(entry->make(entry->name));
}

/// Of a product that has to be rounded: 2^-54 is left where it was not. Volatile, so that it is computed as
/// a controller's arithmetic is, not by the compiler.
inline bool contracts() {
  const volatile double factor = 0x1.0000002p0;
  const volatile double rounded_square = 0x1.0000004p0;
  const double x = factor, y = factor, z = rounded_square;
  return x * y - z != 0;
}

inline constinit std::atomic<std::uint64_t> contents = 0;
inline constexpr Library library{k_interface, k_version, k_build, layout(), contracts, list, &contents};

}  // namespace plugin
#pragma GCC visibility pop
}  // namespace troupe

/// What the program that loads a plug-in asks it for: k_symbol.
extern "C" __attribute__((used, visibility("default"))) inline const troupe::plugin::Library*
troupe_plugin() {
  return &troupe::plugin::library;
}

/// Makes a class a controller that world files know by this name. At namespace scope, once a controller; a
/// library may have several.
#define TROUPE_CONTROLLER(name, ...)                                               \
  static_assert(::troupe::plugin::is_name(name),                                   \
                "a controller's name is one word, without / : = and a dot first"); \
  static const ::troupe::plugin::Entry TROUPE_CONTROLLER_ENTRY(__COUNTER__)(       \
      name, ::troupe::plugin::kind_of<__VA_ARGS__>);
#define TROUPE_CONTROLLER_ENTRY(n) TROUPE_CONTROLLER_ENTRY_NAMED(n)
#define TROUPE_CONTROLLER_ENTRY_NAMED(n) troupe_controller_##n
