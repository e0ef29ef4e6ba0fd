#pragma once

#include "engine/world.hpp"
#include "troupe/version.hpp"

#include <Eigen/Core>

#include <array>
#include <atomic>
#include <cstdint>
#include <string_view>
#include <vector>

/// What a plug-in and the program that loads it must agree on. Both sides compile this header: the plug-in
/// writes down what it was compiled with, and the loader (troupe/plugins.cpp) compares that with its own.

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

namespace troupe::plugin {

/// Of struct Library and of what the functions in it mean.
inline constexpr std::uint32_t k_interface = 4;

/// What changes types or bits without changing a header.
inline constexpr const char* k_build = TROUPE_PLUGIN_STANDARD_LIBRARY
    ", " TROUPE_PLUGIN_EIGEN ", EIGEN_MAX_ALIGN_BYTES=" TROUPE_PLUGIN_TEXT(EIGEN_MAX_ALIGN_BYTES);

/// A mixture of the sizes of all that passes between the two: headers of another state of Troupe are
/// detected even where their version is the same.
constexpr std::uint64_t layout() {
  using namespace engine;
  constexpr std::array k_sizes{sizeof(ControllerKind), sizeof(ControllerKind::Prepared),
                               sizeof(DeviceKind),     sizeof(DeviceKind::Prepared),
                               sizeof(DeviceInfo),     sizeof(StateTable),
                               sizeof(StateField),     sizeof(Field),
                               sizeof(FieldTable),     sizeof(Value),
                               sizeof(DecideBatch),    sizeof(Percept),
                               sizeof(Actions),        sizeof(Readings),
                               sizeof(Command),        sizeof(Random),
                               sizeof(DeviceBatch),    sizeof(Effects),
                               sizeof(World),          sizeof(BodyType)};
  std::uint64_t mixture = 0;
  for (const std::size_t size : k_sizes) mixture = mixture * 0x9e3779b97f4a7c15 + size;
  return mixture;
}

/// What a plug-in's one symbol gives. The first two members stay where they are in every version.
struct Library {
  std::uint32_t interface;  ///< k_interface
  const char* version;      ///< k_version
  const char* build;        ///< k_build
  std::uint64_t layout;     ///< layout()
  /// Whether the plug-in's compiler made one operation of a multiplication and an addition.
  bool (*contracts)();
  /// Appends its controllers, and its sensors and other devices, each under its own name.
  void (*list)(std::vector<engine::ControllerKind>& controllers, std::vector<engine::DeviceKind>& devices);
  /// The loader's note of which file this is: a hash of the contents; 0 before the first load. It lies in the
  /// library since that is loaded once in a process, however often it is asked for.
  std::atomic<std::uint64_t>* contents;
};

/// The symbol: a function without arguments that gives a `const Library*`.
inline constexpr const char* k_symbol = "troupe_plugin";
using Symbol = const Library* (*)();

/// A kind's name, or a plug-in's: one word that can be told from a path and from a controller's
/// parameters.
constexpr bool is_name(std::string_view name) {
  return !name.empty() && name.find_first_of("/:=\"\\ \t\n") == std::string_view::npos && name.front() != '.';
}

}  // namespace troupe::plugin
