#pragma once

#include "engine/kinds/components.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/kinds/controller_kind.hpp"
#include "engine/kinds/measure_kind.hpp"
#include "troupe/plugin_layout.hpp"
#include "troupe/version.hpp"

#include <Eigen/Core>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

/// This header lets the loader check that a plug-in matches the program. A plug-in is a shared library with
/// kinds (implementations of controllers, sensors, other devices or measures). Plug-in and program both
/// compile this header. The plug-in stores the versions and settings with which it was compiled (struct
/// Library), and the loader (troupe/plugins.cpp) compares them with those of the program.

#if defined(_LIBCPP_VERSION)
#define TROUPE_PLUGIN_STANDARD_LIBRARY "libc++"
#elif defined(_GLIBCXX_DEBUG)
#define TROUPE_PLUGIN_STANDARD_LIBRARY "libstdc++ with _GLIBCXX_DEBUG"
#elif defined(_GLIBCXX_USE_CXX11_ABI) && !_GLIBCXX_USE_CXX11_ABI
#define TROUPE_PLUGIN_STANDARD_LIBRARY "libstdc++ with _GLIBCXX_USE_CXX11_ABI=0"
#else
#define TROUPE_PLUGIN_STANDARD_LIBRARY "libstdc++"
#endif
#if defined(EIGEN_DONT_VECTORIZE)
#define TROUPE_PLUGIN_EIGEN "EIGEN_DONT_VECTORIZE"
#else
#define TROUPE_PLUGIN_EIGEN "vectorized Eigen"
#endif
#define TROUPE_PLUGIN_TEXT_OF(x) #x
#define TROUPE_PLUGIN_TEXT(x) TROUPE_PLUGIN_TEXT_OF(x)
#define TROUPE_PLUGIN_BUILD      \
  TROUPE_PLUGIN_STANDARD_LIBRARY \
  ", " TROUPE_PLUGIN_EIGEN ", EIGEN_MAX_ALIGN_BYTES=" TROUPE_PLUGIN_TEXT(EIGEN_MAX_ALIGN_BYTES)

namespace troupe::plugin {

/// Version of the plug-in interface, which consists of struct Library, the functions that it points to, and
/// the layouts of the types that plug-in and program exchange (layout()). A test fails if the layouts have
/// changed but the version has not.
inline constexpr std::uint32_t k_interface = 20;

namespace detail {
/// A struct that compilers lay out without padding only with -fpack-struct, for which they define no macro.
struct Padded {
  char first;
  double second;
};
inline constexpr bool k_is_packed = sizeof(Padded) < 2 * sizeof(double);
}  // namespace detail

/// Build settings that change the layout of types or the bits of results even if plug-in and program include
/// the same headers.
inline constexpr const char* k_build =
    detail::k_is_packed ? TROUPE_PLUGIN_BUILD ", -fpack-struct" : TROUPE_PLUGIN_BUILD;

/// The interface of a plug-in. The first two members have the same offsets in every version, so that a loader
/// can always read them. The members up to `layout` also have the same offsets if the plug-in was compiled
/// with -fpack-struct.
struct Library {
  std::uint32_t interface;  ///< version of the plug-in interface: k_interface
  std::uint32_t : 32;       // the padding that compilers insert without -fpack-struct
  const char* version;      ///< version of Troupe: k_version
  const char* build;        ///< build settings: k_build
  std::uint64_t layout;     ///< hash of the layouts of types: layout()
  /// Returns whether the plug-in's compiler contracts a product and a sum to one fused multiply-add. The
  /// loader rejects such a plug-in, because the contraction changes the bits of results.
  bool (*contracts)();
  /// Appends the controllers, the devices and the measures of the library to the lists, each under the name
  /// that was given to the macro TROUPE_CONTROLLER, TROUPE_DEVICE or TROUPE_MEASURE.
  void (*list)(std::vector<engine::ControllerKind>& controllers, std::vector<engine::DeviceKind>& devices,
               std::vector<engine::MeasureKind>& measures);
  /// Points to a variable of the plug-in that holds a hash of the bytes of the library file. The variable is
  /// 0 until the loader sets it at the first load. A process loads a library only once, even if its file
  /// changes. At each later load, the loader therefore compares the variable with the hash of the file. If
  /// they differ, the file was rebuilt in the meantime, and the loader rejects it.
  std::atomic<std::uint64_t>* contents;
};
static_assert(offsetof(Library, version) == 8 && offsetof(Library, build) == 16);

/// Name of the symbol that a plug-in exports: a function without arguments that returns a `const Library*`.
inline constexpr const char* k_symbol = "troupe_plugin";
using Symbol = const Library* (*)();

using engine::is_name;

}  // namespace troupe::plugin
